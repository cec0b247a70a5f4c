//! The bounds on rounding from which all tolerances of the solvers follow.
//!
//! The reasoning stands in the documentation of `geobench_window::precision`, which has what follows for windows.

/// How much shorter one path must be than another, relatively, to be shorter beyond doubt.
///
/// An `f64` holds 1.1e-16 of a number. A path that crosses n faces gathers some √n times that in its length, and n times that at worst: 1e-12
/// leaves room for ten thousand faces in the worst case.
pub const MARGIN: f64 = 1e-12;

/// How far rounding may have moved a place on an edge, as a fraction of the length of the edge: some 50 units in the last place.
///
/// It is no more than that since all that a comparison takes for equal may be lost: what is too long by it is so by the rounding of the
/// longest edges, however short the distance is.
pub const GRAIN: f64 = 1e-14;

/// The angle, in radians, below which two directions cannot be told apart by the lengths of paths: √[`MARGIN`], since a bend by the angle δ
/// lengthens a path by at most δ²/2 of itself.
pub const RESOLUTION: f64 = 1e-6;

/// Height of a face, relative to its longest edge, below which its corners send windows of their own.
///
/// Where two paths through such a face meet, they do so at an angle of at most twice its height over its sides, which [`RESOLUTION`] does
/// not tell from 0: a comparison takes them for one, and the one that is dropped may be the only one to reach what lies
/// behind a corner of the face.
pub const SLIVER_HEIGHT: f64 = 2.0 * RESOLUTION;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bend_by_the_resolution_is_within_the_margin() {
        assert!((RESOLUTION * RESOLUTION / MARGIN - 1.0).abs() < 1e-12);
    }
}
