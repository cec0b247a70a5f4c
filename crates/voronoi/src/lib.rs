//! Geodesic Voronoi diagrams: which of several sources is the nearest, at every point of a surface.

mod diagram;
mod field;
mod lct11;
mod merge;
mod remesh;
mod removal;
mod store;
#[cfg(test)]
mod tests;
mod wave;
mod window_vtp;

use geobench_mesh::VertexId;
use geobench_window::SolveError;

pub use diagram::{
    Bisector, BorderArc, Cell, Diagram, Dual, Node, NodeKind, Obstacle, Part, Vertex,
};
pub use field::{Field, FieldSolver, NO_SOURCE};
pub use lct11::Lct11;
pub use remesh::{Deviation, Quality, RemeshError, RemeshOptions, Remeshed, remesh};
pub use removal::Removal;
pub use window_vtp::{Options, WindowVtp};

/// Refuses a run without sources or from a vertex that does not exist.
fn check_sources(vertices: usize, sources: &[VertexId]) -> Result<(), SolveError> {
    match sources.iter().find(|v| v.index() >= vertices) {
        Some(&vertex) => Err(SolveError::NoSuchVertex { vertex, vertices }),
        None if sources.is_empty() => Err(SolveError::NoSource),
        None => Ok(()),
    }
}
