//! Windows whose source is on the line of their edge: all directions pass through one point, the
//! foot.
//!
//! Trimming compares distances along the edge. A source V on the edge itself, behind a face of no
//! area, sends rays of all directions through its foot, where its distance is σ. Through all other
//! points of the edge it sends grazing rays only. Let a window of another source arrive along the
//! edge, with V on its path. It ties with V at the foot and beyond, and has one direction only. If
//! it took the foot from V, or half of the foot by rounding, the other directions would be lost.
//!
//! So the foot of a window is a piece of its own, as wide as rounding moves it. It is compared with
//! other windows as a whole, at the foot, and yields only to one that is shorter there: then V is
//! not on a shortest path to its own foot, and none of its directions is needed. Among equal
//! windows the foot stays, since it holds every direction that they have.

use super::compare::is_sent_again;
use crate::precision::{GRAIN, PLACE};
use crate::window::Window;

/// Half the width of a foot, as a fraction of the edge. Over it the distance of the source hardly
/// grows beyond rounding.
const HALF_WIDTH: f64 = 7.5 * PLACE;

/// How far an interval must reach beyond the foot on both sides to hold all directions, as a
/// fraction of the edge: a few units in the last place of an abscissa.
const CLEARANCE: f64 = 0.25 * PLACE;

/// The greatest height of a source that counts as on the edge, as a fraction of the edge.
const CLOSE: f64 = 2.5 * PLACE;

/// What a source above the edge adds to [`HALF_WIDTH`] and [`CLEARANCE`], in heights of the source.
/// Rays that meet the edge farther away graze it.
const STEEP: f64 = 20.0;

/// The foot of `w` on an edge of length `l`. `None` if the source is farther from the edge than 2.5
/// [`PLACE`] of its length, or if `w` does not hold all directions of the source: an interval that
/// ends at the foot has only some of them, and rounding hides which.
#[inline]
pub fn foot(w: &Window, l: f64) -> Option<[f64; 2]> {
    grazes(w, l).then(|| whole_foot(w, l))?
}

#[cold]
fn whole_foot(w: &Window, l: f64) -> Option<[f64; 2]> {
    let clear = CLEARANCE * l + STEEP * w.py.abs();
    let is_whole = w.b0 <= (w.px - clear).max(0.0) && (w.px + clear).min(l) <= w.b1;
    let half = HALF_WIDTH * l + STEEP * w.py.abs();
    let (start, end) = ((w.px - half).max(w.b0), (w.px + half).min(w.b1));
    (is_whole && start < end).then_some([start, end])
}

/// Whether the source of `w` is on the edge. Beside its foot, `w` then has one direction only.
#[inline]
pub(super) fn grazes(w: &Window, l: f64) -> bool {
    w.py.abs() <= CLOSE * l
}

/// Whether all of `w` is a foot.
#[inline]
fn is_foot(w: &Window, l: f64) -> bool {
    foot(w, l) == Some([w.b0, w.b1])
}

/// Whether a common range of two windows with this width may be part of a foot.
#[inline]
pub(super) fn may_be_foot(width: f64, l: f64) -> bool {
    width <= 2.5 * (HALF_WIDTH + STEEP * CLOSE) * l
}

/// Whether `new` gets the whole range that it shares with `old`, if one of them is a foot; `None`
/// if neither is.
#[cold]
pub(super) fn does_new_win(old: &Window, new: &Window, l: f64) -> Option<bool> {
    if is_foot(old, l) {
        Some(is_sent_again(old, new) || is_shorter_at_foot(new, old, l))
    } else if is_foot(new, l) {
        Some(!is_shorter_at_foot(old, new, l))
    } else {
        None
    }
}

/// Whether `w` contains the foot of `foot` and is shorter there by more than rounding.
fn is_shorter_at_foot(w: &Window, foot: &Window, l: f64) -> bool {
    let x = foot.px;
    let d = foot.distance(x);
    w.b0 <= x && x <= w.b1 && w.distance(x) < d - (GRAIN * d + PLACE * l)
}

/// The pieces of a window: its foot first, if it has one, then the parts on the left and right.
pub fn pieces(w: &Window, l: f64) -> impl Iterator<Item = Window> {
    let [start, end] = foot(w, l).unwrap_or([w.b0, w.b1]);
    let ranges = [[start, end], [w.b0, start], [end, w.b1]];
    let w = *w;
    let pieces = ranges.map(move |[b0, b1]| Window { b0, b1, ..w });
    pieces.into_iter().filter(|piece| piece.b0 < piece.b1)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ON_EDGE: Window = Window {
        b0: 0.25,
        b1: 1.0,
        px: 0.5,
        py: -1e-30,
        sigma: 1.0,
    };

    #[test]
    fn a_window_on_the_edge_is_its_foot_and_what_lies_beside() {
        let all: Vec<Window> = pieces(&ON_EDGE, 1.0).collect();
        let [foot, left, right] = all[..] else {
            panic!("{all:?}")
        };
        assert!(is_foot(&foot, 1.0) && !is_foot(&left, 1.0) && !is_foot(&right, 1.0));
        assert_eq!((left.b0, left.b1), (0.25, foot.b0));
        assert_eq!((right.b0, right.b1), (foot.b1, 1.0));
        let above = Window {
            py: -1e-9,
            ..ON_EDGE
        };
        assert_eq!(pieces(&above, 1.0).collect::<Vec<_>>(), [above]);
    }

    #[test]
    fn a_foot_yields_to_a_shorter_window_only() {
        let foot = pieces(&ON_EDGE, 1.0).next().unwrap();
        let along = |sigma: f64| Window {
            px: -1.0,
            sigma,
            b0: 0.0,
            ..ON_EDGE
        };
        // At the foot the distance of the other window is its σ plus 1.5.
        for (sigma, shorter) in [(-0.5, false), (-0.5 - 1e-9, true), (-0.5 + 1e-9, false)] {
            assert_eq!(does_new_win(&foot, &along(sigma), 1.0), Some(shorter));
            assert_eq!(does_new_win(&along(sigma), &foot, 1.0), Some(!shorter));
        }
        assert_eq!(does_new_win(&foot, &foot, 1.0), Some(false));
        assert_eq!(does_new_win(&along(0.0), &along(1.0), 1.0), None);
    }
}
