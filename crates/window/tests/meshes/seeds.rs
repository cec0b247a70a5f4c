//! Random nasty meshes, by their seeds, on which solvers were wrong or propagated far too many
//! windows.
//!
//! For the tests of crates that use the oracle. The meshes of the parent module do not need it.

#![allow(dead_code)] // Each crate has its own seeds.

use geobench_mesh::{Mesh, Tolerance, TriangleSoup, VertexId};
use geobench_oracle::{DoubleDouble, Model, Search, nasty, rounded, search};
use geobench_window::{Counter, Solver, precision};

/// The solvers of a crate, set up for a mesh, with their names.
pub(crate) type Solvers = Vec<(&'static str, Box<dyn Solver>)>;

/// Far more beams than the oracle needs for any mesh here.
const MOST_BEAMS: u64 = 100_000;

/// The mesh of a seed, its sources, and the right distances.
fn case(seed: u64) -> (Mesh, Vec<VertexId>, Vec<f64>) {
    let model = nasty::mesh(seed).model;
    let positions = model.positions().unwrap().to_vec();
    let soup = TriangleSoup::new(positions.clone(), model.triangles.clone());
    let (mesh, _) = Mesh::from_soup(soup).unwrap();
    // The mesh has its faces oriented consistently.
    let faces = mesh.faces().map(|f| mesh.face_vertices(f));
    let faces = faces.map(|corners| corners.map(VertexId::raw)).collect();
    let surface = Model::new("", positions, faces).surface::<DoubleDouble>();
    let found = search(&surface, &model.sources, Search::pruned(MOST_BEAMS)).unwrap();
    let sources = model.sources.into_iter().map(VertexId::new).collect();
    (mesh, sources, rounded(&found))
}

/// The largest error of a wrong distance; `None` if all distances are right.
fn error(mesh: &Mesh, found: &[f64], expected: &[f64]) -> Option<f64> {
    let rule = Tolerance::on(mesh, expected);
    let wrong = rule.wrong(found, expected);
    wrong
        .map(|v| (found[v] - expected[v]).abs())
        .reduce(f64::max)
}

/// Checks that all `solvers` are right on the mesh of `seed`, and that none propagates more than
/// `most` windows. `most` should be ten times the number of `mmp-fast`, and at least 200.
pub(crate) fn check(seed: u64, most: u64, solvers: impl Fn(&Mesh) -> Solvers) {
    let (mesh, sources, expected) = case(seed);
    for (name, mut solver) in solvers(&mesh) {
        let (solution, counters) = solver.count(&sources).unwrap();
        let error = error(&mesh, &solution.distances, &expected);
        assert_eq!(error, None, "{name}, seed {seed}");
        let propagated = counters.get(Counter::Propagated).unwrap();
        assert!(
            propagated <= most,
            "{name}, seed {seed}: {propagated} windows"
        );
    }
}

/// Checks that all `solvers` are right on the mesh of `seed`, up to the doubt that the solve
/// reports.
pub(crate) fn check_doubtful(seed: u64, solvers: impl Fn(&Mesh) -> Solvers) {
    let (mesh, sources, expected) = case(seed);
    for (name, mut solver) in solvers(&mesh) {
        let found = solver.solve(&sources).unwrap().distances;
        let doubt = precision::doubt(&mesh, &found);
        let bound = doubt.map(|doubt| doubt.bound);
        let bound = bound.unwrap_or_else(|| panic!("{name}, seed {seed}: without a doubt"));
        let error = error(&mesh, &found, &expected).unwrap_or(0.0);
        assert!(error <= bound, "{name}, seed {seed}: off by {error}");
    }
}
