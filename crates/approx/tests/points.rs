//! Points in faces and on edges as sources and targets of approximate algorithms, which no solver
//! is set up anew for.

mod support;

use geobench_approx::{
    Boundary, Dijkstra, Fmm, FmmUntidy, Heat, HeatOptions, SaddleVertexGraph, SvgBuilder,
    SvgOptions, Vsp,
};
use geobench_mesh::{FaceId, Mesh, Refined, SplitMix64, SurfacePoint};
use geobench_mmp::mmp;
use geobench_window::{Goal, Solver, at_points, precision};
use support::cases;

fn graph(mesh: &Mesh, k: Option<usize>, builder: SvgBuilder) -> SaddleVertexGraph {
    let threads = 1;
    SaddleVertexGraph::new(
        mesh,
        SvgOptions {
            k,
            builder,
            threads,
        },
    )
}

fn solvers(mesh: &Mesh) -> Vec<(&'static str, Box<dyn Solver>)> {
    let heat = |boundary| {
        let options = HeatOptions {
            boundary,
            ..HeatOptions::default()
        };
        Box::new(Heat::new(mesh, options))
    };
    vec![
        ("dijkstra", Box::new(Dijkstra::new(mesh))),
        ("fmm", Box::new(Fmm::new(mesh, true))),
        ("fmm-untidy", Box::new(FmmUntidy::new(mesh, true, 0.5))),
        ("svg", Box::new(graph(mesh, Some(50), SvgBuilder::IchFast))),
        ("heat", heat(Boundary::Average)),
        ("heat, cold", heat(Boundary::Cold)),
        ("vsp", Box::new(Vsp::new(mesh, 1))),
    ]
}

/// Calls `run` with the points inserted, and asserts that `solver` is as before afterwards.
fn at<T>(
    solver: &mut dyn Solver,
    mesh: &Mesh,
    points: &[SurfacePoint],
    run: impl FnOnce(&mut dyn Solver, &Refined) -> T,
) -> T {
    let before = solver.solve(&[0.into()]);
    let insertion = mesh.insertion(points).unwrap();
    let anew = |_: &Mesh| panic!("set up anew");
    let result = at_points(solver, insertion, anew, run);
    assert_eq!(solver.solve(&[0.into()]), before);
    result
}

/// Points in faces, on edges, and two in one face.
fn points(mesh: &Mesh, random: &mut SplitMix64) -> Vec<SurfacePoint> {
    let in_face = |face, random: &mut SplitMix64| {
        let [u, v, w] = [0; 3].map(|_| 0.05 + random.unit());
        let sum = u + v + w;
        mesh.point_in_face(face, [u / sum, v / sum, w / sum])
            .unwrap()
    };
    let face = |random: &mut SplitMix64| FaceId::new(random.below(mesh.face_count()) as u32);
    let [f, g] = [face(random), face(random)];
    let [a, b, _] = mesh.face_vertices(g);
    let on_edge = mesh
        .point_on_edge([a, b], 0.05 + 0.9 * random.unit())
        .unwrap();
    vec![
        in_face(f, random),
        in_face(f, random),
        on_edge,
        in_face(g, random),
    ]
}

#[test]
fn dijkstra_has_the_distances_of_the_refined_mesh() {
    let mesh = Mesh::generate("terrain,n=12,seed=2").unwrap();
    let mut solver = Dijkstra::new(&mesh);
    let mut random = SplitMix64::new(1);
    for _ in 0..20 {
        let points = points(&mesh, &mut random);
        let refined = mesh.with_points(&points).unwrap();
        let mut anew = Dijkstra::new(&refined.mesh);
        let found = at(&mut solver, &mesh, &points, |solver, refined| {
            solver.trace(&refined.vertices[..1], &Goal::everything())
        });
        let found = found.unwrap();
        let expected = anew
            .trace(&refined.vertices[..1], &Goal::everything())
            .unwrap();
        assert_eq!(found.0, expected.0);
        assert_eq!(format!("{:?}", found.1), format!("{:?}", expected.1));
    }
}

#[test]
fn a_graph_of_all_direct_geodesics_is_exact_from_and_to_points() {
    let mut random = SplitMix64::new(2);
    for case in cases().step_by(3) {
        let faces = case.mesh.faces().len();
        if faces == 0 {
            continue;
        }
        for builder in [SvgBuilder::IchFast, SvgBuilder::Ich, SvgBuilder::FwpMmp] {
            let mut solver = graph(&case.mesh, None, builder);
            let points = points(&case.mesh, &mut random);
            let refined = case.mesh.with_points(&points).unwrap();
            let exact = mmp(&refined.mesh)
                .solve(&refined.vertices[..1])
                .unwrap()
                .distances;
            let mut added = (case.mesh.vertex_count()..exact.len()).map(|v| (v as u32).into());
            // Beside slivers the graph is built anew.
            if precision::doubt(&refined.mesh, &exact).is_some()
                || added.any(|v| refined.mesh.is_pseudo_source(v))
            {
                continue;
            }
            let found = at(&mut solver, &case.mesh, &points, |solver, refined| {
                solver.solve(&refined.vertices[..1]).unwrap().distances
            });
            let longest = case.mesh.half_edges().map(|h| case.mesh.length(h));
            let place = precision::PLACE * longest.fold(0.0, f64::max);
            for (v, (d, exact)) in found.iter().zip(&exact).enumerate() {
                let fits = d == exact || (d - exact).abs() <= 1e-9 * exact + place;
                assert!(
                    fits,
                    "{}, {points:?}, vertex {v}: {d} for {exact}",
                    case.name
                );
            }
        }
    }
}

#[test]
fn errors_from_points_are_those_from_vertices() {
    for spec in ["sphere,subdiv=4", "torus,faces=3000,bump=0.2,seed=1"] {
        let mesh = Mesh::generate(spec).unwrap();
        let edge =
            mesh.half_edges().map(|h| mesh.length(h)).sum::<f64>() / mesh.half_edge_count() as f64;
        // The mean error in mean edge lengths, beyond two edges from the source.
        let error = |found: &[f64], exact: &[f64]| {
            let far = found.iter().zip(exact).filter(|(_, d)| **d > 2.0 * edge);
            let errors: Vec<f64> = far.map(|(d, exact)| (d - exact).abs() / edge).collect();
            errors.iter().sum::<f64>() / errors.len() as f64
        };
        let mut exact = mmp(&mesh);
        for (name, mut solver) in solvers(&mesh) {
            let mut random = SplitMix64::new(3);
            // From a vertex, from a face, from an edge, and to points.
            let mut sums = [0.0; 4];
            for _ in 0..8 {
                let v = [(random.below(mesh.vertex_count()) as u32).into()];
                let found = solver.solve(&v).unwrap().distances;
                sums[0] += error(&found, &exact.solve(&v).unwrap().distances) / 8.0;
                let points = points(&mesh, &mut random);
                let refined = mesh.with_points(&points).unwrap();
                let mut exact = mmp(&refined.mesh);
                for (k, from) in [(1, 0), (2, 2)] {
                    let from = &refined.vertices[from..=from];
                    let exact = exact.solve(from).unwrap().distances;
                    let found = at(&mut *solver, &mesh, &points, |solver, _| {
                        solver.solve(from).unwrap().distances
                    });
                    sums[k] += error(&found, &exact) / 8.0;
                    let split = found.len() - points.len();
                    sums[3] += error(&found[split..], &exact[split..]) / 16.0;
                }
            }
            let most = 1.5 * sums[0] + 0.05;
            assert!(
                sums[1..].iter().all(|&sum| sum < most),
                "{spec}, {name}: {sums:?}"
            );
        }
    }
}

#[test]
fn a_point_in_the_face_of_the_source_is_at_its_straight_distance() {
    let mesh = Mesh::generate("terrain,n=12,seed=2").unwrap();
    for (name, mut solver) in solvers(&mesh) {
        let [a, b] = [[0.2, 0.3, 0.5], [0.1, 0.7, 0.2]];
        let points = [a, b].map(|weights| mesh.point_in_face(40.into(), weights).unwrap());
        let corners = mesh
            .face_vertices(40.into())
            .map(|v| mesh.positions()[v.index()]);
        let place = |w: [f64; 3]| [0, 1, 2].map(|i| (0..3).map(|k| w[k] * corners[k][i]).sum());
        let [p, q]: [[f64; 3]; 2] = [place(a), place(b)];
        let straight = (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>().sqrt();
        let found = at(&mut *solver, &mesh, &points, |solver, refined| {
            let found = solver.solve(&refined.vertices[..1]).unwrap().distances;
            [0, 1].map(|i| found[refined.vertices[i].index()])
        });
        assert_eq!(found[0], 0.0, "{name}");
        assert!(
            (found[1] - straight).abs() < 1e-4 * straight,
            "{name}: {found:?} {straight}"
        );
    }
}

#[test]
fn final_distances_do_not_depend_on_the_goal() {
    let mesh = Mesh::generate("terrain,n=20,seed=5").unwrap();
    let mut random = SplitMix64::new(4);
    for (name, mut solver) in solvers(&mesh) {
        for _ in 0..10 {
            let points = points(&mesh, &mut random);
            at(&mut *solver, &mesh, &points, |solver, refined| {
                let [from, to] = [0, 3].map(|i| refined.vertices[i]);
                let whole = solver.solve(&[from]).unwrap().distances;
                let near = solver.solve_until(&[from], &Goal::targets([to])).unwrap();
                assert_eq!(near.distances[to.index()], whole[to.index()], "{name}");
                let radius = whole[to.index()] * 0.7;
                let near = solver.solve_until(&[from], &Goal::everything().within(radius));
                for (d, whole) in near.unwrap().distances.into_iter().zip(whole) {
                    let expected = if whole > radius { f64::INFINITY } else { whole };
                    // What is within rounding of the radius may count as beyond it.
                    assert!(
                        d == expected || d.is_infinite() && whole > 0.999 * radius,
                        "{name}"
                    );
                }
            });
        }
    }
}

#[test]
fn points_close_to_a_vertex_are_like_the_vertex() {
    let mesh = Mesh::generate("torus,faces=1000").unwrap();
    let corner = mesh.face_vertices(77.into())[0];
    let close = mesh
        .point_in_face(77.into(), [1.0 - 2e-9, 1e-9, 1e-9])
        .unwrap();
    for (name, mut solver) in solvers(&mesh) {
        let at_vertex = solver.solve(&[corner]).unwrap().distances;
        let found = at(&mut *solver, &mesh, &[close], |solver, refined| {
            solver.solve(&refined.vertices).unwrap().distances
        });
        for (v, (d, expected)) in found.iter().zip(&at_vertex).enumerate() {
            assert!((d - expected).abs() < 1e-5, "{name}, {v}: {d} {expected}");
        }
    }
}
