//! The bounds of [`geobench_window::precision`] in the comparisons of rules 1, 2 and 3.

pub(crate) use geobench_window::precision::{MARGIN, RESOLUTION};

/// Fraction of the coordinates' size by which a point must lie off a ray to count as beside it.
pub(crate) const CLEARANCE: f64 = MARGIN;

/// What the length of a path is multiplied by before another one is compared with it that shall be
/// shorter beyond doubt.
pub(crate) const WINS: f64 = 1.0 - MARGIN;

/// The size of the face that the windows on an edge of length `l` have just crossed, whose third
/// vertex is `behind`.
///
/// The sources of these windows are known to rounding of their own coordinates and of this, which
/// is more where a source is nearer than the face is long.
#[inline]
pub(crate) const fn extent(l: f64, [x, y]: [f64; 2]) -> f64 {
    l + x.abs() + y.abs()
}
