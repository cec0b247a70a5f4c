//! Geodesic Voronoi diagrams: which of several sources is the nearest, at every point of a surface.
//!
//! * A [`FieldSolver`] ([`WindowVtp`] or [`Lct11`]) finds the nearest source of each vertex, and
//!   stores windows on the edges near the borders of cells. Its result is a [`LabelledField`].
//! * [`Diagram`] is computed from a field: cells, borders, Voronoi vertices. [`Diagram::dual`]
//!   connects the sources of neighbouring cells to triangles.
//! * [`remesh()`] makes a new mesh for a surface: the dual of the diagram of evenly spread sources.

mod diagram;
mod field;
mod lct11;
mod remesh;
mod removal;
mod store;
#[cfg(test)]
mod tests;
mod wave;
mod window_vtp;

pub use diagram::{
    Bisector, BorderArc, CellPart, Diagram, Dual, NoTriangulation, Node, NodeKind, Obstacle,
    Vertex, VoronoiCell,
};
pub use field::{FieldSolver, LabelledField, NO_SOURCE};
pub use lct11::Lct11;
pub use remesh::{Quality, RemeshError, RemeshOptions, Remeshed, SurfaceDeviation, remesh};
pub use removal::Removal;
pub use window_vtp::{WindowVtp, WindowVtpOptions};
