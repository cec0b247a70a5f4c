//! Shortest paths over the surface of a mesh.
//!
//! [`Solver::trace`](geobench_window::Solver::trace) records an origin for each vertex: the last
//! straight piece of its shortest path. The piece runs along an edge, or from the image of a source
//! or of a vertex at which the path bends. [`Paths`] follows these origins back to the sources:
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
//! A straight piece is traced from the vertex towards the image. In the plane into which the faces
//! on the way are unfolded, the image stays fixed. Among near duplicates of vertices, slivers and
//! faces of very different sizes, an image may err by more than vertices are apart, and the line
//! miss its vertex. Then a search finds the path from the distances alone: it sends windows back
//! from the target, in the band where a shortest path can run, and takes the straight lines that
//! attain the distance and meet at vertices without a shortcut.
//!
//! The length of a path equals the distance of its target to 1e-12 and the rounding of the longest
//! edge. A path is straight across every edge and bends only at vertices, with an angle of at least
//! π on both sides, up to rounding; at an edge of several faces, on every way around the vertex
//! from face to face. It crosses no face twice. If a vertex has several shortest paths, the path is
//! the one that the solver found first.
//!
//! [`Path::shortened`] makes a path locally shortest that was joined from several, and [`Through`]
//! joins them. [`line()`] follows a direction instead: the straightest geodesic from a point.
//! [`Paths::log_map`] gives all vertices the direction in which their path starts.

mod lines;
mod log_map;
mod onto;
mod path;
mod shorten;
mod straightest;
mod through;
mod trace;
mod turn;

pub use path::{Path, PathPlace, Point};
pub use straightest::{LineError, line};
pub use through::Through;
pub use trace::{PathError, Paths, TraceError};
