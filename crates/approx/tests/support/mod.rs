//! Small difficult meshes with their exact distances.

// Each test file uses its part.
#![allow(dead_code)]

use geobench_mesh::{Mesh, VertexId};
use geobench_mmp::mmp;
use geobench_oracle::{Model, distances, nasty, rounded, zoo};
use geobench_window::{Solver, precision};

#[path = "../../../oracle/tests/support/mesh.rs"]
mod oracle_mesh;

/// A mesh with sources and the exact distances from them.
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) mesh: Mesh,
    pub(crate) sources: Vec<VertexId>,
    pub(crate) exact: Vec<f64>,
}

/// Random meshes of these seeds; about three of four are valid.
const SEEDS: std::ops::Range<u64> = 0..400;

/// The small models of the zoo from each of their sources, and random meshes that `f64` leaves in
/// no doubt.
pub(crate) fn cases() -> impl Iterator<Item = Case> {
    zoo::small()
        .into_iter()
        .flat_map(|model| of_zoo(&model))
        .chain(SEEDS.filter_map(of_seed))
}

fn of_zoo(model: &Model) -> Vec<Case> {
    let Some(mesh) = mesh_of(model) else {
        panic!("{} is refused", model.name);
    };
    let surface = model.surface::<f64>();
    let of = |&source: &u32| Case {
        name: format!("{} from {source}", model.name),
        mesh: mesh.clone(),
        sources: vec![source.into()],
        exact: rounded(&distances(&surface, &[source])),
    };
    model.sources.iter().map(of).collect()
}

fn of_seed(seed: u64) -> Option<Case> {
    let model = nasty::mesh(seed).model;
    let mesh = mesh_of(&model)?;
    let sources: Vec<VertexId> = model.sources.iter().map(|&s| s.into()).collect();
    let exact = mmp(&mesh).solve(&sources).ok()?.distances;
    precision::doubt(&mesh, &exact).is_none().then_some(Case {
        name: model.name,
        mesh,
        sources,
        exact,
    })
}

fn mesh_of(model: &Model) -> Option<Mesh> {
    let mesh = oracle_mesh::mesh_of(model).ok();
    mesh.filter(|mesh| !mesh.has_junctions())
}

impl Case {
    /// Solves, and asserts that no distance is less than the exact one, or more than 1 + `error`
    /// times it.
    pub(crate) fn check(&self, solver: &mut impl Solver, error: f64, what: &str) {
        const ROUNDING: f64 = 1e-9;
        // No path is known better than a place on the longest edge.
        let lengths = self.mesh.half_edges().map(|h| self.mesh.length(h));
        let place = precision::PLACE * lengths.fold(0.0, f64::max);
        let found = solver.solve(&self.sources).unwrap().distances;
        assert_eq!(found.len(), self.exact.len());
        for (v, (&d, &exact)) in found.iter().zip(&self.exact).enumerate() {
            let [least, most] = [
                exact * (1.0 - ROUNDING),
                exact * (1.0 + error) * (1.0 + ROUNDING),
            ];
            let fits = d == exact || least - place <= d && d <= most + place;
            assert!(fits, "{}, {what}, vertex {v}: {d} for {exact}", self.name);
        }
    }
}
