//! Whole runs on small surfaces.

mod diagram;
#[path = "../../../oracle/tests/support/mesh.rs"]
mod oracle_mesh;
mod propagation;
mod remesh;

use geobench_mesh::{Mesh, SplitMix64, VertexId};
use geobench_oracle::Model;
use geobench_vtp::VtpFast;
use geobench_window::Solver;

/// Relative difference of distances that rounding explains.
pub(super) const ROUNDING: f64 = 1e-12;

/// The mesh of `model`; `None` if it has a defect that no program accepts.
pub(super) fn try_mesh_of(model: &Model) -> Option<Mesh> {
    let mesh = oracle_mesh::mesh_of(model).ok();
    mesh.filter(|mesh| !mesh.has_junctions())
}

pub(super) fn mesh_of(model: &Model) -> Mesh {
    try_mesh_of(model).unwrap_or_else(|| panic!("{}", model.name))
}

/// `count` different random vertices, or all if there are fewer.
pub(super) fn some_vertices(mesh: &Mesh, count: usize, seed: u64) -> Vec<VertexId> {
    let mut random = SplitMix64::new(seed);
    let mut all: Vec<u32> = (0..mesh.vertex_count() as u32).collect();
    for i in (1..all.len()).rev() {
        all.swap(i, (random.next() % (i as u64 + 1)) as usize);
    }
    all.truncate(count);
    all.into_iter().map(VertexId::new).collect()
}

/// The distances from each of `sources` alone.
pub(super) fn one_by_one(mesh: &Mesh, sources: &[VertexId]) -> Vec<Vec<f64>> {
    let mut solver = VtpFast::new(mesh);
    let solve = |&s| solver.solve(&[s]).unwrap().distances;
    sources.iter().map(solve).collect()
}
