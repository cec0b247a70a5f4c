//! Shortest paths over the surface of a mesh.
//!
//! A solver that [traces](geobench_window::Solver::trace) remembers of every vertex where its
//! distance comes from: along an edge, or straight from the image of a source or of a vertex at
//! which the path bends. [`Paths`] follows these back to the sources:
//!
//! ```
//! use geobench_mesh::Mesh;
//! use geobench_paths::Paths;
//! use geobench_vtp::VtpFast;
//! use geobench_window::Goal;
//!
//! let mesh = Mesh::generate("grid,n=4")?;
//! let mut solver = VtpFast::new(&mesh);
//! let paths = Paths::find(&mut solver, &mesh, 0, &Goal::targets([7]))?;
//! let path = paths.to(7.into())?.expect("the grid is in one piece");
//! assert!((path.length - 5.0_f64.sqrt()).abs() < 1e-12);
//! // From vertex 0 across some edges to vertex 7.
//! let ends: Vec<_> = path.vertices().collect();
//! assert_eq!(ends, [0.into(), 7.into()]);
//! assert_eq!(path.edges().count(), path.points.len() - 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A path aims at the image, which does not move as faces are unfolded on the way. It has the
//! length of the distance to 1e-12 of it, crosses every edge straight, and bends only at vertices
//! with an angle of at least π on both sides, up to rounding. Of several shortest paths it is the
//! one that the solver met first.

mod onto;
mod path;
mod trace;

pub use path::{Path, Place, Point};
pub use trace::{PathError, Paths, TraceError};
