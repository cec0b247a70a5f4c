//! Geodesic Voronoi diagrams: which of several sources is the nearest, at every point of a surface.
//!
//! # Example
//!
//! The cells of two opposite corners of a square meet on the diagonal between the other two:
//!
//! ```
//! use geobench_mesh::Mesh;
//! use geobench_voronoi::{Diagram, FieldSolver, WindowVtp};
//!
//! let mesh = Mesh::generate("grid,n=4")?;
//! let corners = [0.into(), 24.into()];
//! let mut solver = WindowVtp::new(&mesh);
//! let field = solver.field(&corners)?;
//! assert!(field.distances()[12] > 2.8); // The centre, as far from both.
//! let diagram = Diagram::new(&field, corners.len());
//! let [one, other] = [0, 1].map(|i| diagram.cells()[i].area);
//! assert!((one - 8.0).abs() < 1e-12 && (other - 8.0).abs() < 1e-12);
//! let is_border = |sources: [u32; 2]| sources.contains(&0) && sources.contains(&1);
//! assert!(diagram.arcs().iter().all(|arc| is_border(arc.sources)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Parts
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
