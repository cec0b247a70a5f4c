//! The margins of [`geobench_window::precision`] in the comparisons of rules 1, 2 and 3.

pub(crate) use geobench_window::precision::{MARGIN, RESOLUTION};

/// Distance from a ray, as a fraction of the size of the coordinates, beyond which a point counts
/// as beside it.
pub(crate) const CLEARANCE: f64 = MARGIN;

/// The factor of a path's length before it is compared with another one that must be clearly
/// shorter.
pub(crate) const WINS: f64 = 1.0 - MARGIN;

/// Bound of the rounding error of sources, in addition to that of their own coordinates, on a mesh
/// with edges up to `longest`.
///
/// The error is relative to the longest side that the window has crossed. That may exceed both the
/// coordinates and the face that the window has crossed last: between short edges, windows come
/// past the tips of long triangles.
#[inline]
pub(crate) const fn blur(longest: f64) -> f64 {
    CLEARANCE * longest
}
