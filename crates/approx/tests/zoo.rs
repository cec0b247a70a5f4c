//! Small surfaces with all features that break geodesic programs: no method panics, and all results
//! are distances.

use geobench_approx::{Boundary, Dijkstra, Fmm, FmmUntidy, Heat, HeatOptions, Vsp};
use geobench_mesh::{Mesh, VertexId};
use geobench_oracle::{Model, zoo};
use geobench_window::Solver;

#[path = "../../oracle/tests/support/mesh.rs"]
mod oracle_mesh;

fn solvers(mesh: &Mesh) -> Vec<(String, Box<dyn Solver>)> {
    let mut all: Vec<(String, Box<dyn Solver>)> = Vec::new();
    all.push(("vsp".to_owned(), Box::new(Vsp::new(mesh, 1))));
    for unfold in [true, false] {
        all.push((format!("fmm {unfold}"), Box::new(Fmm::new(mesh, unfold))));
        for width in [1e-3, 0.1, 1e6] {
            let untidy = FmmUntidy::new(mesh, unfold, width);
            all.push((format!("fmm-untidy {unfold} {width}"), Box::new(untidy)));
        }
    }
    for time in [1e-3, 1.0, 1e6] {
        for boundary in [Boundary::Average, Boundary::Insulated, Boundary::Cold] {
            for delaunay in [false, true] {
                for shift in [0.0, 1e-6] {
                    let options = HeatOptions {
                        time,
                        boundary,
                        delaunay,
                        shift,
                    };
                    all.push((format!("{options:?}"), Box::new(Heat::new(mesh, options))));
                }
            }
        }
    }
    all
}

fn check(model: &Model) {
    let mesh = oracle_mesh::mesh_of(model).unwrap();
    let last = VertexId::new(mesh.vertex_count() as u32 - 1);
    let first = VertexId::new(model.sources[0]);
    for (name, mut solver) in solvers(&mesh) {
        for sources in [vec![first], vec![last, first, last]] {
            let reached = Dijkstra::new(&mesh).solve(&sources).unwrap().distances;
            let found = solver.solve(&sources).unwrap().distances;
            for (v, (d, reached)) in found.iter().zip(&reached).enumerate() {
                let place = || format!("{}: {name}: {v} at {d}", model.name);
                assert!(*d >= 0.0, "{}", place());
                assert_eq!(d.is_finite(), reached.is_finite(), "{}", place());
            }
            assert!(sources.iter().all(|s| found[s.index()] == 0.0));
        }
    }
}

#[test]
fn small_surfaces_get_distances() {
    for model in zoo::small() {
        for scale in [1.0, 1e-6, 1e6] {
            check(&model.clone().scaled(scale));
        }
    }
}

#[test]
fn a_source_on_a_cold_boundary_gave_no_distances() {
    let mesh = Mesh::generate("grid,n=10").unwrap();
    let options = HeatOptions {
        boundary: Boundary::Cold,
        ..HeatOptions::default()
    };
    let mut heat = Heat::new(&mesh, options);
    // The faces around corner 10 have no inner vertex.
    for (source, opposite) in [(0, 120), (10, 110)] {
        let found = heat.solve(&[VertexId::new(source)]);
        let farthest = found.unwrap().distances[opposite];
        let expected = 10.0 * 2.0_f64.sqrt();
        // The boundary distorts the distances beside it.
        assert!(
            farthest > 0.5 * expected && farthest < 1.5 * expected,
            "{farthest}"
        );
    }
    // A strip has no inner vertex.
    let strip = Mesh::generate("strip").unwrap();
    let found = Heat::new(&strip, options).solve(&[VertexId::new(0)]);
    assert!(found.unwrap().distances[1..].iter().all(|&d| d > 0.0));
}
