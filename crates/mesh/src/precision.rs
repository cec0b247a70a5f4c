//! Bounds on rounding, from which all tolerances of the solvers follow.
//!
//! The documentation of `geobench_window::precision` derives them.

/// How much shorter one path must be than another, relatively, to be shorter despite rounding.
///
/// The unit roundoff of `f64` is 1.1e-16. The error of a path across n faces is a few times n units
/// at worst, and a few times √n in practice. 1e-12 leaves room for a million faces in a row.
pub const MARGIN: f64 = 1e-12;

/// Bound of the rounding error of the length of a path, relative to it: 500 ulps, for paths across
/// a hundred faces and more.
///
/// Paths that differ by less count as equal. One of two equal windows may be dropped, so the bound
/// is as small as rounding allows.
pub const GRAIN: f64 = 1e-13;

/// Bound of the rounding error of a position on an edge, relative to the edge: some 20 ulps. A path
/// around a needle accumulates a few in each of its faces before it meets the edge again.
pub const PLACE: f64 = 4e-15;

/// The angle, in radians, below which the lengths of paths do not distinguish two directions:
/// √[`MARGIN`], because a bend by the angle δ lengthens a path by at most δ²/2 of itself.
pub const RESOLUTION: f64 = 1e-6;

/// Height of a face, relative to its longest edge, below which its corners become pseudo-sources.
///
/// Two paths that meet behind such a face meet at an angle of at most twice its height over its
/// sides. That is below [`RESOLUTION`]. A comparison takes them for one path, and may drop the only
/// one that leads behind a corner of the face.
pub const SLIVER_HEIGHT: f64 = 2.0 * RESOLUTION;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bend_by_the_resolution_is_within_the_margin() {
        assert!((RESOLUTION * RESOLUTION / MARGIN - 1.0).abs() < 1e-12);
    }
}
