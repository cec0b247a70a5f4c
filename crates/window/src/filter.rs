//! The vertex filter: a window is useless if a path through a known vertex is shorter everywhere.

use crate::window::{Window, norm};

/// How much shorter a path through a vertex must be, relatively, before it deletes a window:
/// rounding must never delete both of two equal paths.
const MARGIN: f64 = 1.0 + 1e-14;

/// Whether paths along the edge from one of its ends beat every ray of `w` (Xin and Wang 2009,
/// theorem 3.2, first two tests).
///
/// `l` is the length of the edge, `d0` and `d1` the distances known at its tail and its head (upper
/// bounds will do, infinite ones too). A path from the tail along the edge to `b1` crosses every
/// ray of the window, so the window dies if d0 + b1 < σ + |p b1|; likewise from the head to `b0`.
/// The comparison is made without a square root.
#[inline]
pub fn is_beaten_from_ends(w: &Window, l: f64, d0: f64, d1: f64) -> bool {
    is_shorter(d0 * MARGIN + w.b1 - w.sigma, w.b1 - w.px, w.py)
        || is_shorter(d1 * MARGIN + (l - w.b0) - w.sigma, w.b0 - w.px, w.py)
}

/// Whether a path across the last triangle, from its vertex that is not on the edge, beats every
/// ray of `w` (the third test of the theorem).
///
/// `opposite` is that vertex in the frame of the window's half-edge (below it), `d` its distance.
/// `end` is the end of the interval that its rays must cross the whole window to reach: `b0` if
/// the window came as a left child, `b1` if as a right child.
#[inline]
pub fn is_beaten_across(w: &Window, end: f64, opposite: [f64; 2], d: f64) -> bool {
    let reach = norm(end - opposite[0], opposite[1]);
    is_shorter(d * MARGIN + reach - w.sigma, end - w.px, w.py)
}

/// Whether `r` is less than the length of the vector `(x, y)`; false if `r` is infinite or NaN.
#[inline]
fn is_shorter(r: f64, x: f64, y: f64) -> bool {
    r < 0.0 || r * r < x * x + y * y
}
