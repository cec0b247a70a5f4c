//! Saddle vertex graphs against exact distances.

mod support;

use geobench_approx::{SaddleVertexGraph, SvgBuilder, SvgOptions};
use geobench_mesh::Mesh;
use geobench_window::{Goal, SolveError, Solver};
use support::cases;

const BUILDERS: [SvgBuilder; 3] = [SvgBuilder::IchFast, SvgBuilder::Ich, SvgBuilder::FwpMmp];

#[test]
fn a_graph_of_all_direct_geodesics_is_exact() {
    for case in cases() {
        for builder in BUILDERS {
            let options = SvgOptions {
                k: None,
                builder,
                threads: 1,
            };
            let mut graph = SaddleVertexGraph::new(&case.mesh, options);
            case.check(&mut graph, 0.0, &format!("{options:?}"));
        }
    }
}

#[test]
fn a_graph_of_near_vertices_is_never_too_short() {
    for case in cases() {
        for builder in BUILDERS {
            for k in [0, 1, 7, 50] {
                let options = SvgOptions {
                    k: Some(k),
                    builder,
                    threads: 1,
                };
                let mut graph = SaddleVertexGraph::new(&case.mesh, options);
                // No longer than a path along edges, which is at most this much longer.
                case.check(&mut graph, f64::MAX, &format!("{options:?}"));
            }
        }
    }
}

#[test]
fn errors_shrink_as_k_grows() {
    let mesh = Mesh::generate("terrain,n=40,seed=3").unwrap();
    let exact = geobench_mmp::mmp(&mesh).distances_from(0).unwrap();
    let errors = [5, 20, 80].map(|k| {
        let options = SvgOptions {
            k: Some(k),
            ..SvgOptions::default()
        };
        let found = SaddleVertexGraph::new(&mesh, options)
            .distances_from(0)
            .unwrap();
        let errors = found
            .iter()
            .zip(&exact)
            .skip(1)
            .map(|(d, exact)| d / exact - 1.0);
        errors.sum::<f64>() / exact.len() as f64
    });
    assert!(
        errors[0] > 1.5 * errors[1] && errors[1] > 1.5 * errors[2],
        "{errors:?}"
    );
    assert!(errors[2] < 5e-3, "{errors:?}");
}

#[test]
fn the_graph_does_not_depend_on_the_threads() {
    let mesh = Mesh::generate("torus,faces=2000,bump=0.1,seed=7").unwrap();
    let of = |threads| {
        let options = SvgOptions {
            threads,
            ..SvgOptions::default()
        };
        SaddleVertexGraph::new(&mesh, options)
    };
    let [mut one, mut three] = [1, 3].map(of);
    assert_eq!((one.edges(), one.bytes()), (three.edges(), three.bytes()));
    for source in [0, 500] {
        assert_eq!(one.distances_from(source), three.distances_from(source));
    }
}

#[test]
fn distances_are_the_same_both_ways() {
    let mesh = Mesh::generate("terrain,n=20,seed=3").unwrap();
    let mut graph = SaddleVertexGraph::new(&mesh, SvgOptions::default());
    for (a, b) in [(0, 440), (17, 230)] {
        let [there, back] =
            [(a, b), (b, a)].map(|(a, b)| graph.distances_from(a).unwrap()[b as usize]);
        assert!((there - back).abs() <= 1e-12 * there, "{there} {back}");
    }
}

#[test]
fn a_query_with_a_goal_ends_early() {
    let mesh = Mesh::generate("terrain,n=20,seed=3").unwrap();
    let mut graph = SaddleVertexGraph::new(&mesh, SvgOptions::default());
    let all = graph.distances_from(0).unwrap();
    let goal = Goal::targets([5]);
    let near = graph.solve_until(&[0.into()], &goal).unwrap().distances;
    assert_eq!(near[5], all[5]);
    assert!(near.contains(&f64::INFINITY) && !all.contains(&f64::INFINITY));
    let refused = graph.trace(&[0.into()], &goal).unwrap_err();
    assert_eq!(refused, SolveError::NoPaths);
}
