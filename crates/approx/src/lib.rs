//! Approximate geodesic distances on triangle meshes, for comparison with exact algorithms.
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
//! None of these algorithms serves as a reference, and tables mark them as approximate. Each is a
//! [`Solver`](geobench_window::Solver): set-up is separate from solves, distances are infinite
//! where no path leads, and several sources give the distance from the nearest.
//!
//! | type | method | error |
//! |---|---|---|
//! | [`Dijkstra`] | shortest paths along edges | too long, whatever the resolution |
//! | [`Fmm`], [`FmmUntidy`] | fast marching | about the length of an edge |
//! | [`Vsp`] | virtual source propagation | some 0.2 % in the mean |
//! | `Heat`, with the feature `heat` | the heat method | about the length of an edge |
//! | [`SaddleVertexGraph`] | a graph of direct geodesics | too long; none if the graph is complete |
//! | [`mmp_approx`], [`avtp`] | windows replaced by vertices | too long, at most by the given factor |

mod attached;
mod dijkstra;
mod fmm;
#[cfg(feature = "heat")]
mod heat;
mod order;
mod relayed;
mod svg;
mod vsp;

pub use dijkstra::Dijkstra;
pub use fmm::{Fmm, FmmUntidy};
#[cfg(feature = "heat")]
pub use heat::{Boundary, Heat, HeatOptions};
pub use relayed::{Avtp, MmpApprox, avtp, mmp_approx, mmp_approx_from};
pub use svg::{SaddleVertexGraph, SvgBuilder, SvgOptions};
pub use vsp::Vsp;
