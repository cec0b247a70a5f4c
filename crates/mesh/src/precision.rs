//! Bounds on rounding, from which all tolerances of the solvers follow.
//!
//! The documentation of `geobench_window::precision` derives them.

/// How much shorter one path must be than another, relatively, to be shorter beyond doubt.
///
/// An `f64` holds 1.1e-16 of a number. A path across n faces gathers n times a few of these at
/// worst, and √n times in practice: 1e-12 leaves room for a million faces in a row.
pub const MARGIN: f64 = 1e-12;

/// How far rounding may have moved the length of a path, as a fraction of itself: 500 units in the
/// last place, for paths across a hundred faces and more.
///
/// Paths that differ by less count as equal. One of two equal windows may be dropped, so the number
/// is as small as rounding allows.
pub const GRAIN: f64 = 1e-13;

/// How far rounding may have moved a place on an edge, as a fraction of the edge: some 20 units in
/// the last place, since a path around a needle gathers a few in each of its faces before it comes
/// to the edge again.
pub const PLACE: f64 = 4e-15;

/// The angle, in radians, below which two directions cannot be told apart by the lengths of paths:
/// √[`MARGIN`], since a bend by the angle δ lengthens a path by at most δ²/2 of itself.
pub const RESOLUTION: f64 = 1e-6;

/// Height of a face, relative to its longest edge, below which its corners send windows of their
/// own.
///
/// Two paths that meet behind such a face meet at an angle of at most twice its height over its
/// sides, which [`RESOLUTION`] cannot tell from 0. A comparison takes them for one path and may
/// drop the only one that leads behind a corner of the face.
pub const SLIVER_HEIGHT: f64 = 2.0 * RESOLUTION;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bend_by_the_resolution_is_within_the_margin() {
        assert!((RESOLUTION * RESOLUTION / MARGIN - 1.0).abs() < 1e-12);
    }
}
