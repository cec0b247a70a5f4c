//! Slow, plain geodesic distances to judge the solvers by.
//!
//! A solver is fast because it discards windows; each rule by which it does so can be wrong. The
//! oracle of this crate discards nothing that could still matter: from every point where a shortest
//! path can start or bend it follows *all* straight lines over the surface, triangle after
//! triangle, and keeps the smallest length that it meets at each vertex. It is exact, takes
//! exponentially longer than the solvers on rough surfaces, and is meant for meshes of up to some
//! thousand vertices.
//!
//! To be a judge it shares no code with what it judges: it builds its own adjacency, its own
//! unfolded triangles and its own test for the points where a path bends, from bare triangles with
//! either positions or edge lengths. It is generic over the scalar, [`f64`] or [`DoubleDouble`]
//! with some 31 digits, which tells rounding errors from mistakes.
//!
//! * [`PreciseSurface`]: the triangles, from positions or from edge lengths.
//! * [`distances`]: the oracle; [`search`] is the same with a bound on its work.
//! * [`edge_graph_distances`], [`steiner_distances`], [`euclidean_distances`]: bounds from above,
//!   from above and from below that share nothing with unfolding.
//! * [`closed_forms`]: surfaces whose distances are known by formulas.
//! * [`zoo`]: small surfaces with every feature that has broken a geodesic program.
//! * [`nasty`]: random meshes of the sorts that break such programs.

mod bounds;
pub mod closed_forms;
mod double_double;
mod flood;
mod model;
pub mod nasty;
mod random;
pub mod reference;
mod scalar;
mod subdivide;
mod surface;
pub mod zoo;

pub use bounds::{edge_graph_distances, euclidean_distances, steiner_distances};
pub use double_double::DoubleDouble;
pub use flood::{GaveUp, Search, distances, search};
pub use model::{Geometry, Model};
pub use random::Random;
pub use scalar::Scalar;
pub use subdivide::{Subdivision, subdivide};
pub use surface::PreciseSurface;

/// Distances rounded to `f64`, infinite where there is no path.
pub fn rounded<S: Scalar>(distances: &[Option<S>]) -> Vec<f64> {
    distances
        .iter()
        .map(|d| d.map_or(f64::INFINITY, Scalar::to_f64))
        .collect()
}
