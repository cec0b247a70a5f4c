//! PCH against ICH.

use geobench_ich::{Pch, ich};
use geobench_mesh::{Mesh, VertexId};
use geobench_window::{Counter, Goal, Solver};

const MODELS: [&str; 5] = [
    "terrain,n=60,seed=3",
    "torus,faces=3000,bump=0.1,seed=7",
    "anisotropic,g=4,faces=4000",
    "grid,n=30",
    "sphere,subdiv=4",
];

fn meshes() -> impl Iterator<Item = Mesh> {
    MODELS.into_iter().map(|spec| Mesh::generate(spec).unwrap())
}

fn agree(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-12 * b)
}

#[test]
fn distances_are_those_of_ich_in_buckets_of_any_width() {
    for mesh in meshes() {
        let sources = [[0].as_slice(), &[7, 400]];
        for sources in sources.map(|s| s.iter().map(|&v| VertexId::new(v)).collect::<Vec<_>>()) {
            let exact = ich(&mesh).solve(&sources).unwrap().distances;
            for bucket in [0.0, 1e-3, Pch::BUCKET, 1.0, f64::INFINITY] {
                let found = Pch::with_bucket(&mesh, 1, bucket).solve(&sources).unwrap();
                assert!(agree(&found.distances, &exact), "{bucket}");
            }
        }
    }
}

#[test]
fn distances_and_counts_do_not_depend_on_the_threads() {
    for mesh in meshes() {
        let of = |threads| {
            let mut solver = Pch::with_bucket(&mesh, threads, 1.0);
            solver.count(&[VertexId::new(0)]).unwrap()
        };
        let (one, three) = (of(1), of(3));
        assert_eq!(one, three);
        assert!(one.1.get(Counter::KPeak) > Some(512), "more than one task");
    }
}

#[test]
fn a_solver_is_as_new_after_a_run_that_ended_early() {
    let mesh = Mesh::generate(MODELS[0]).unwrap();
    let mut solver = Pch::new(&mesh, 2);
    let all = solver.distances_from(0).unwrap();
    let goal = Goal::targets([70]);
    let near = solver.solve_until(&[0.into()], &goal).unwrap().distances;
    assert_eq!(near[70], all[70]);
    assert!(near.contains(&f64::INFINITY));
    assert_eq!(solver.distances_from(0).unwrap(), all);
}
