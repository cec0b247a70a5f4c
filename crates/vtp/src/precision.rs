//! The margins of [`geobench_window::precision`] in the comparisons of rules 1, 2 and 3.

pub(crate) use geobench_window::precision::{MARGIN, RESOLUTION};

/// Distance from a ray, as a fraction of the size of the coordinates, beyond which a point counts
/// as beside it.
pub(crate) const CLEARANCE: f64 = MARGIN;

/// The factor of a path's length before it is compared with another one that must be clearly
/// shorter.
pub(crate) const WINS: f64 = 1.0 - MARGIN;

/// The size of the face that the windows on an edge of length `l` have just crossed. `behind` is
/// its third vertex.
///
/// The rounding error of the sources of these windows is relative to their coordinates and to this
/// size, which exceeds the coordinates where a source is nearer than the face is long.
#[inline]
pub(crate) const fn extent(l: f64, [x, y]: [f64; 2]) -> f64 {
    l + x.abs() + y.abs()
}
