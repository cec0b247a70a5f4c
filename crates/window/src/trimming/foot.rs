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
//!
//! A source a little above the edge has a wide foot, with the feet of other sources in it. Each of
//! two such feet is compared at its own place.

use super::compare::{doubt, is_sent_again};
use super::contender::Contender;
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

/// The greatest height of a source, as a fraction of the edge, over which a gap of rounding between
/// two of its windows turns a ray by more than [`ALONG`].
const NEAR: f64 = CLEARANCE / ALONG;

/// The greatest turn of a ray that closes a gap between two windows. The path bends by as much, at
/// most as far from the source as the gap, and is longer by 5e-13 of that way.
const TURN: f64 = 1e-6;

/// Whether `w`, on an edge of length `l`, is to arrive in [`pieces`]: its source is so near to the
/// edge that it may have a foot, or rays that rounding has turned.
#[inline]
pub fn is_near(w: &Window, l: f64) -> bool {
    w.py.abs() <= NEAR * l
}

/// The foot of `w` on an edge of length `l`. `None` if the source is farther from the edge than 2.5
/// [`PLACE`] of its length, or if `w` does not hold all directions of the source: an interval that
/// ends at the foot has only some of them, and rounding hides which.
#[inline]
fn foot(w: &Window, l: f64) -> Option<[f64; 2]> {
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
pub(super) fn is_foot(w: &Window, l: f64) -> bool {
    foot(w, l) == Some([w.b0, w.b1])
}

/// Whether a common range of two windows with this width may be part of a foot.
#[inline]
pub(super) fn may_be_foot(width: f64, l: f64) -> bool {
    width <= 2.5 * (HALF_WIDTH + STEEP * CLOSE) * l
}

/// Whether `new` gets the whole range that it shares with `old`, if one of them is a foot; `None`
/// if neither is, and if both are and each is shorter at its place.
#[cold]
pub(super) fn does_new_win(old: &Window, new: &Window, l: f64) -> Option<bool> {
    if is_foot(old, l) {
        if is_sent_again(old, new) || is_shorter_at_foot(new, old, l) {
            return Some(true);
        }
        let is_needed = is_foot(new, l) && is_shorter_at(new.px, new, old, l);
        if is_needed && is_shorter_at(old.px, old, new, l) {
            return None;
        }
        Some(is_needed)
    } else if is_foot(new, l) {
        Some(!is_shorter_at_foot(old, new, l))
    } else {
        None
    }
}

/// Whether `w` contains the foot of `foot` and is shorter there by more than rounding.
pub(super) fn is_shorter_at_foot<W: Contender>(w: &W, foot: &Window, l: f64) -> bool {
    let [b0, b1] = w.interval();
    b0 <= foot.px && foot.px <= b1 && is_shorter_at(foot.px, w, foot, l)
}

/// Whether `w` is shorter than `other` at abscissa `x` by more than rounding.
fn is_shorter_at<W: Contender>(x: f64, w: &W, other: &Window, l: f64) -> bool {
    let d = other.distance(x);
    w.offers(x) < d - (GRAIN * d + PLACE * l)
}

/// The greatest slope at which a ray to the edge runs along it. A path that bends by so much is
/// longer by 5e-19 of its length, a hundredth of its rounding.
pub(super) const ALONG: f64 = 1e-9;

/// `w`, whose source is on the edge, with the ends of the edge to which its outermost rays lead.
///
/// Behind the end of a ray along the edge, the way goes on along the edge and bends by less than
/// [`ALONG`]. A window that ended there would leave a gap, although its source is on the same edge.
/// Windows around a needle without area would fill it, turn by turn, by the width of the needle.
fn along_edge(w: &Window, l: f64) -> Window {
    let leads = |end: f64| w.py.abs() <= ALONG * (end - w.px).abs();
    let b0 = if leads(w.b0) { 0.0 } else { w.b0 };
    let b1 = if leads(w.b1) { l } else { w.b1 };
    w.cut(b0, b1)
}

/// `w` with the gaps closed that rounding has left between it and those of `stored` that it meets
/// along a ray: they have equal distances there.
///
/// Two windows that meet along a ray may be some units in the last place of the edge apart. Where
/// the source is far nearer than the edge is long, such a gap is wide from the source. It grows on
/// the way to a vertex, and behind a face of no area the bent path to that vertex goes along the
/// edge, by half of the width. Windows are not widened elsewhere: around a needle, they would go
/// around for a few units in the last place.
#[must_use]
pub fn closing_gaps<'a>(
    w: &Window,
    l: f64,
    stored: impl IntoIterator<Item = &'a Window>,
) -> Window {
    let widest = CLEARANCE * l;
    let turns_little = |end: f64| {
        let x = end - w.px;
        widest * w.py.abs() <= TURN * (x * x + w.py * w.py)
    };
    let [closes_left, closes_right] = [w.b0, w.b1].map(turns_little);
    let (mut b0, mut b1) = (w.b0, w.b1);
    let meets = |old: &Window, x: f64| {
        let d = w.distance(x);
        (old.distance(x) - d).abs() <= doubt(d, l)
    };
    for old in stored {
        if closes_left && old.b1 < w.b0 && w.b0 - old.b1 <= widest && meets(old, w.b0) {
            b0 = b0.min(old.b1);
        }
        if closes_right && w.b1 < old.b0 && old.b0 - w.b1 <= widest && meets(old, w.b1) {
            b1 = b1.max(old.b0);
        }
    }
    w.cut(b0, b1)
}

/// The pieces of a window that arrives at a list with the windows `stored`: its foot first, if it
/// has one, then the parts on the left and right. A window with a foot reaches to the ends of the
/// edge to which its rays lead, and one without to the windows that it meets along a ray.
///
/// If a stored foot holds the place of the new one and stays there, the window has no foot of its
/// own: all its directions pass through that place, where the stored window is no longer. What lies
/// beside the stored foot is compared as elsewhere. Else a window that comes back around a needle,
/// with its source farther from the edge by the width of the needle, would have a wider foot at
/// each turn. The margin would be stored and go around again, until the gathered rounding of all
/// turns exceeds what a comparison allows for one.
pub fn pieces<'a>(
    w: &Window,
    l: f64,
    stored: impl IntoIterator<Item = &'a Window, IntoIter: Clone>,
) -> impl Iterator<Item = Window> {
    let mut stored = stored.into_iter();
    let own = foot(w, l);
    let w = match own {
        Some(_) => along_edge(w, l),
        None => closing_gaps(w, l, stored.clone()),
    };
    let held = own.and_then(|[start, end]| {
        let own = w.cut(start, end);
        let holds = |old: &&Window| {
            let has_place = old.b0 <= w.px && w.px <= old.b1 && is_foot(old, l);
            has_place
                && [own, w]
                    .iter()
                    .all(|new| does_new_win(old, new, l) == Some(false))
        };
        stored.find(holds)
    });
    let [start, end] = match held {
        Some(old) => [old.b0.max(w.b0), old.b1.min(w.b1)],
        None => own.unwrap_or([w.b0, w.b1]),
    };
    let own = held.is_none().then_some([start, end]);
    let ranges = [own, Some([w.b0, start]), Some([end, w.b1])];
    let pieces = ranges.map(move |range| range.map(|[b0, b1]| w.cut(b0, b1)));
    let pieces = pieces.into_iter().flatten();
    pieces.filter(|piece| piece.b0 < piece.b1)
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
    fn a_window_on_the_edge_is_its_foot_and_two_sides() {
        let all: Vec<Window> = pieces(&ON_EDGE, 1.0, []).collect();
        let [foot, left, right] = all[..] else {
            panic!("{all:?}")
        };
        assert!(is_foot(&foot, 1.0) && !is_foot(&left, 1.0) && !is_foot(&right, 1.0));
        assert_eq!((left.b0, left.b1), (0.0, foot.b0));
        assert_eq!((right.b0, right.b1), (foot.b1, 1.0));
        let above = Window {
            py: -1e-9,
            ..ON_EDGE
        };
        assert_eq!(pieces(&above, 1.0, []).collect::<Vec<_>>(), [above]);
    }

    #[test]
    fn a_source_that_comes_again_has_no_foot_of_its_own() {
        let stored: Vec<Window> = pieces(&ON_EDGE, 1.0, []).collect();
        let again = Window {
            py: -5e-15,
            ..ON_EDGE
        };
        let [_, left, right] = stored[..] else {
            panic!("{stored:?}")
        };
        let beside: Vec<Window> = pieces(&again, 1.0, &stored).collect();
        let ranges: Vec<[f64; 2]> = beside.iter().map(|w| [w.b0, w.b1]).collect();
        assert_eq!(ranges, [[left.b0, left.b1], [right.b0, right.b1]]);
        // One that is shorter takes the place.
        let shorter = Window {
            sigma: 0.5,
            ..again
        };
        let foot = pieces(&shorter, 1.0, &stored).next().unwrap();
        assert!(is_foot(&foot, 1.0) && foot.b0 < left.b1 && right.b0 < foot.b1);
    }

    /// The source of the new window is nearer, and on the path to the stored one. It lost its foot,
    /// and all that it sends became longer by 55 times the rounding of the edge.
    #[test]
    fn a_nearer_foot_in_a_wide_one_stays() {
        let high = Window {
            py: -CLOSE,
            ..ON_EDGE
        };
        let stored: Vec<Window> = pieces(&high, 1.0, []).collect();
        let apart = 50.0 * PLACE;
        let beside = |sigma: f64| Window {
            px: high.px + apart,
            sigma,
            ..ON_EDGE
        };
        let nearer = beside(1.0 - apart);
        let own = pieces(&nearer, 1.0, &stored).next().unwrap();
        assert!(stored[0].b0 < own.b0 && own.b1 < stored[0].b1);
        assert!(is_foot(&own, 1.0));
        assert_eq!(does_new_win(&stored[0], &own, 1.0), Some(true));
        // As near, at another place: each is shorter at its own.
        let other = pieces(&beside(1.0), 1.0, &stored).next().unwrap();
        assert_eq!(does_new_win(&stored[0], &other, 1.0), None);
        // Behind the stored one.
        let farther = pieces(&beside(1.0 + apart), 1.0, &stored).next().unwrap();
        assert_eq!(farther.b1, stored[0].b0);
    }

    #[test]
    fn a_ray_along_the_edge_leads_to_its_end() {
        let near = Window {
            b0: 0.5 - 1e-13,
            b1: 0.5 + 1e-13,
            ..ON_EDGE
        };
        let ranges = |w: &Window| -> Vec<[f64; 2]> {
            let mut pieces: Vec<[f64; 2]> = pieces(w, 1.0, []).map(|w| [w.b0, w.b1]).collect();
            pieces.sort_by(|a, b| a[0].total_cmp(&b[0]));
            pieces
        };
        let reached = ranges(&near);
        assert_eq!((reached[0][0], reached[2][1]), (0.0, 1.0));
        // These rays leave the edge.
        let steep = Window { py: -1e-15, ..near };
        let reached = ranges(&steep);
        assert_eq!((reached[0][0], reached[2][1]), (near.b0, near.b1));
    }

    #[test]
    fn a_foot_yields_to_a_shorter_window_only() {
        let foot = pieces(&ON_EDGE, 1.0, []).next().unwrap();
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
