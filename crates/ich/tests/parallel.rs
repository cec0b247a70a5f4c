//! PCH against ICH.

use geobench_ich::{Pch, ich};
use geobench_mesh::{Mesh, TriangleSoup, VertexId};
use geobench_oracle::{distances, nasty, rounded, zoo};
use geobench_window::{Counter, Goal, Solver, precision};

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

fn mesh_of(model: &geobench_oracle::Model) -> Option<Mesh> {
    let positions = model.positions()?.to_vec();
    let soup = TriangleSoup::new(positions, model.triangles.clone());
    let mesh = Mesh::from_soup(soup).ok().map(|(mesh, _)| mesh);
    mesh.filter(|mesh| !mesh.has_junctions())
}

/// In buckets of the usual width, and level by level.
fn solvers(mesh: &Mesh) -> [Pch; 2] {
    [Pch::new(mesh, 2), Pch::with_bucket(mesh, 1, 1e6)]
}

#[test]
fn surfaces_that_have_broken_a_program_match_the_oracle() {
    let mut solved = 0;
    for model in zoo::small() {
        let Some(mesh) = mesh_of(&model) else {
            continue;
        };
        for &source in &model.sources {
            let exact = rounded(&distances(&model.surface::<f64>(), &[source]));
            // Two vertices in one place may be told the rounding of the largest distance apart.
            let furthest = exact.iter().copied().filter(|d| d.is_finite());
            let floor = 1e-15 * furthest.fold(0.0, f64::max);
            for mut solver in solvers(&mesh) {
                let found = solver.distances_from(source).unwrap();
                let mut pairs = found.iter().zip(&exact);
                let fits = pairs.all(|(a, b)| a == b || (a - b).abs() <= floor.max(1e-12 * b));
                assert!(fits, "{} from {source}: {found:?} {exact:?}", model.name);
                solved += 1;
            }
        }
    }
    assert!(solved > 100, "{solved}");
}

#[test]
fn random_surfaces_take_the_distances_and_about_the_windows_of_ich() {
    let mut solved = 0;
    for model in (0..600).map(|seed| nasty::mesh(seed).model) {
        let Some(mesh) = mesh_of(&model) else {
            continue;
        };
        let sources: Vec<VertexId> = model.sources.iter().map(|&s| s.into()).collect();
        let (exact, counters) = ich(&mesh).count(&sources).unwrap();
        if precision::doubt(&mesh, &exact.distances).is_some() {
            continue;
        }
        let lengths = mesh.half_edges().map(|h| mesh.length(h));
        let place = precision::PLACE * lengths.fold(0.0, f64::max);
        let most = 10 * counters.get(Counter::Propagated).unwrap().max(200);
        for mut solver in solvers(&mesh) {
            let (found, counters) = solver.count(&sources).unwrap();
            for (a, b) in found.distances.iter().zip(&exact.distances) {
                let fits = a == b || (a - b).abs() <= 1e-9 * b + place;
                assert!(fits, "{}: {a} for {b}", model.name);
            }
            assert!(
                counters.get(Counter::Propagated).unwrap() <= most,
                "{}",
                model.name
            );
            solved += 1;
        }
    }
    assert!(solved > 500, "{solved}");
}
