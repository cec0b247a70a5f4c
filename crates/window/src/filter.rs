//! The vertex filter: deletes windows that a path through a known vertex beats everywhere.

use crate::precision::MARGIN;
use crate::window::{Window, norm};

/// Whether windows are dropped that a path through a known vertex beats on all rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VertexFilter {
    /// As in ICH: theorem 3.2 of Xin and Wang 2009, with all three tests or those that the
    /// algorithm names.
    #[default]
    On,
    /// As in CH and MMP. Without the filter, a branch of CH ends only when it loses its last split,
    /// or after as many triangles as the mesh has: no shortest path crosses a triangle twice.
    Off,
}

/// How much shorter a path through a vertex must be to delete a window, as a fraction of the path
/// and of the edge. Rounding must never delete one of two equal paths. The rounding may be that of
/// the edge, where the vertex is much nearer than the edge is long.
const SLACK: f64 = MARGIN;

/// Whether paths along the edge from one of its ends beat every ray of `w` (Xin and Wang 2009,
/// theorem 3.2, first two tests).
///
/// `l` is the length of the edge. `d0` and `d1` are the distances known at its tail and its head;
/// upper bounds will do, infinite ones too. A path from the tail along the edge to `b1` crosses
/// every ray of the window, so the window is beaten if d0 + b1 < σ + |p b1|. The test from the head
/// to `b0` is symmetric. The comparison is made without a square root.
#[inline]
#[allow(clippy::needless_bitwise_bool)] // Most windows are beaten by neither: one branch for both.
pub fn is_beaten_from_ends(w: &Window, l: f64, d0: f64, d1: f64) -> bool {
    let d0 = d0 + (d0 + l) * SLACK;
    let d1 = d1 + (d1 + l) * SLACK;
    is_shorter(d0 + w.b1 - w.sigma, w.b1 - w.px, w.py)
        | is_shorter(d1 + (l - w.b0) - w.sigma, w.b0 - w.px, w.py)
}

/// Whether a path across the last triangle, from its vertex that is not on the edge, beats every
/// ray of `w`: the third test of the theorem.
///
/// `opposite` is that vertex in the frame of the window's half-edge, below it, and `d` its
/// distance. `end` is the end of the interval that a path from the vertex reaches only by crossing
/// the whole window: `b0` if the window came as a left child, `b1` if as a right child.
#[inline]
pub(crate) fn is_beaten_across(w: &Window, end: f64, opposite: [f64; 2], d: f64) -> bool {
    let reach = norm(end - opposite[0], opposite[1]);
    let path = d + reach;
    is_shorter(path + path * SLACK - w.sigma, end - w.px, w.py)
}

/// Whether `r` is less than the length of the vector `(x, y)`; false if `r` is +∞ or NaN.
#[inline]
fn is_shorter(r: f64, x: f64, y: f64) -> bool {
    // With its sign, the square tells both whether `r` is negative and whether it is less.
    r * r.abs() < x * x + y * y
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::tests::windows;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn a_window_beaten_from_an_end_loses_everywhere(
            w in windows(), d0 in 0.0..6.0f64, d1 in 0.0..6.0f64, t in 0.0..=1.0f64,
        ) {
            let x = w.b0 + t * (w.b1 - w.b0);
            let through_ends = (d0 + x).min(d1 + 1.0 - x);
            if is_beaten_from_ends(&w, 1.0, d0, d1) {
                prop_assert!(through_ends < w.distance(x) * (1.0 + 1e-14));
            }
        }

        #[test]
        fn a_window_beaten_across_loses_at_the_far_end(
            w in windows(), d in 0.0..6.0f64, x in -1.0..2.0f64, y in -2.0..-0.1f64,
        ) {
            let beaten = is_beaten_across(&w, w.b0, [x, y], d);
            let path = d + norm(w.b0 - x, y);
            prop_assert_eq!(beaten, path * (1.0 + 1e-14) < w.distance(w.b0));
        }

        /// Regression test: the slack was once a fraction of the vertex's distance alone. The
        /// detour through a vertex beside the source is longer by less than rounding, so needed
        /// windows were dropped.
        #[test]
        fn a_vertex_beside_the_source_beats_no_window_that_leaves_it_at_a_small_angle(
            distance in -9.0..0.0f64, angle in -9.0..-2.0f64, end in 0.0..1.0f64, is_head: bool,
        ) {
            let (sin, cos) = 10f64.powf(angle).sin_cos();
            let from_vertex = 10f64.powf(distance) * cos;
            let w = Window {
                b0: if is_head { 1.0 - end } else { 0.0 },
                b1: if is_head { 1.0 } else { end },
                px: if is_head { 1.0 + from_vertex } else { -from_vertex },
                py: -10f64.powf(distance) * sin,
                sigma: 0.0,
            };
            let at_vertex = norm(from_vertex, w.py);
            let ends = if is_head { [f64::INFINITY, at_vertex] } else { [at_vertex, f64::INFINITY] };
            prop_assert!(!is_beaten_from_ends(&w, 1.0, ends[0], ends[1]));
        }
    }

    #[test]
    fn unknown_distances_beat_nothing() {
        let w = Window {
            b0: 0.0,
            b1: 1.0,
            px: 0.5,
            py: -1.0,
            sigma: 1e6,
        };
        assert!(!is_beaten_from_ends(&w, 1.0, f64::INFINITY, f64::INFINITY));
        assert!(!is_beaten_across(&w, 0.0, [0.5, -1.0], f64::INFINITY));
    }

    #[test]
    fn a_tie_beats_nothing() {
        // The window of vertex A itself, along whose edge the path is exactly as long.
        let w = Window {
            b0: 0.0,
            b1: 1.0,
            px: 0.0,
            py: 0.0,
            sigma: 0.7,
        };
        assert!(!is_beaten_from_ends(&w, 1.0, 0.7, f64::INFINITY));
    }
}
