//! Slow and simple geodesic distances, to test solvers against.
//!
//! A solver is fast because it deletes windows, and each of its rules can be wrong. The oracle of
//! this crate deletes nothing that could still matter. From every point where a shortest path can
//! start or bend it follows *all* straight lines over the surface, triangle after triangle, and
//! keeps the least length found at each vertex. It is exact. On rough surfaces it takes
//! exponentially longer than the solvers, so it is meant for meshes of up to some thousand
//! vertices.
//!
//! The oracle shares no code with the solvers. From bare triangles with positions or edge lengths
//! it builds its own adjacency, its own unfolded triangles, and its own test for points where a
//! path bends. It is generic over the scalar: [`f64`], or [`DoubleDouble`] with some 31 digits,
//! which separates rounding errors from mistakes.
//!
//! * [`PreciseSurface`]: the triangles, from positions or from edge lengths.
//! * [`distances`]: the oracle; [`search`] is the same with a limit on its work.
//! * [`edge_graph_distances`], [`steiner_distances`], [`euclidean_distances`]: two upper bounds and
//!   a lower bound that use no unfolding.
//! * [`judge_path`], [`judge_geodesic`]: whether a path is shortest, or locally shortest.
//! * [`closed_forms`]: surfaces with formulas for their distances.
//! * [`zoo`]: small surfaces with all features that have broken geodesic programs.
//! * [`nasty`]: random meshes of kinds that break such programs.
//! * [`Transform`]: changes of a mesh that do not change its distances.

mod bounds;
pub mod closed_forms;
mod double_double;
mod flood;
mod model;
pub mod nasty;
mod path;
mod random;
pub mod reference;
mod scalar;
mod subdivide;
mod surface;
mod transform;
pub mod zoo;

pub use bounds::{edge_graph_distances, euclidean_distances, steiner_distances};
pub use double_double::DoubleDouble;
pub use flood::{GaveUp, Search, distances, search};
pub use model::{Geometry, Model};
pub use path::{JudgedPoint, PathFlaw, judge_geodesic, judge_path};
pub use random::Random;
pub use scalar::RealNumber;
pub use subdivide::{Subdivision, subdivide};
pub use surface::PreciseSurface;
pub use transform::{Transform, Transformed};

/// Distances rounded to `f64`; infinite where no path leads.
pub fn rounded<S: RealNumber>(distances: &[Option<S>]) -> Vec<f64> {
    distances
        .iter()
        .map(|d| d.map_or(f64::INFINITY, RealNumber::to_f64))
        .collect()
}
