//! Approximate geodesic distances on triangle meshes: what exact algorithms are compared with.
//!
//! ```
//! use geobench_approx::Dijkstra;
//! use geobench_mesh::Mesh;
//! use geobench_window::Solver;
//!
//! let mesh = Mesh::generate("grid,n=4")?;
//! let distances = Dijkstra::new(&mesh).distances_from(0)?;
//! assert!(distances[7] > 5.0_f64.sqrt()); // Edges go no straight way to it.
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! None of these algorithms is a reference, and tables mark them as approximate. Each is a
//! [`Solver`](geobench_window::Solver): set-up is apart from the solves, distances are infinite
//! where no path leads, and of several sources the nearest counts.

mod dijkstra;
mod fmm;
#[cfg(feature = "heat")]
mod heat;
mod order;
mod relayed;
mod svg;

pub use dijkstra::Dijkstra;
pub use fmm::{Fmm, FmmUntidy};
#[cfg(feature = "heat")]
pub use heat::{Boundary, Heat, HeatOptions};
pub use relayed::{Avtp, MmpApprox, avtp, mmp_approx};
pub use svg::{SaddleVertexGraph, SvgBuilder, SvgOptions};
