//! Comparison of two windows of one edge: the range on which each is shorter.

// Which of two conditions fails is unpredictable, and both are cheap: one branch for both is
// mispredicted less often than two.
#![allow(clippy::needless_bitwise_bool)]

use std::cmp::Ordering;

use super::contender::Contender;
use super::foot::{does_new_win, may_be_foot};
use crate::precision::{GRAIN, PLACE};
use crate::tie::{TiePoints, tie_points};
use crate::window::{Window, greater, less};

/// The least difference of two distances at a point of an edge of length `l` that counts. `d` is
/// one of them.
///
/// A new window must be shorter by this much to take a range from a stored one. The stored window
/// wins ties, unless the new one [has been sent again](is_sent_again). So a window that arrives
/// twice is not stored twice, and one that has wound around a needle is not stored at all. The
/// second term covers sources much nearer than the edge is long: their position is known only to
/// the rounding of the edge.
#[inline(always)]
#[allow(clippy::inline_always)] // Twice in each comparison.
pub(super) fn doubt(d: f64, l: f64) -> f64 {
    GRAIN * d + PLACE * l
}

/// The part of [`GRAIN`] that suffices beside the foot of a window; see [`is_new_shorter`].
const LESS: f64 = 1.0 / 16.0;

/// Width below which the remainder of a trimmed window is dropped, as a fraction of the edge or of
/// the distance of the source, whichever is less.
///
/// Windows that meet along a ray overlap by rounding. Trimming then leaves slivers of 1e-17 to
/// 1e-11 of an edge, a third of all windows on scans, while true windows are wider than 1e-9. The
/// bent paths of a sliver's neighbours are as short as its own, to far below rounding. The
/// exception is a source on the edge, behind a face of no area: rays of all directions pass through
/// so small a width. Hence the limit by the distance of the source.
pub(super) const SLIVER: f64 = 1e-10;

/// Width on which the distances of a window are taken to be linear, in units of the height of its
/// source over the edge: some √(2·[`GRAIN`]). See [`is_straight`].
const STRAIGHT: f64 = 4e-7;

/// The part of a common range on which a new window is shorter than an old one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ShorterPart {
    /// The new window is shorter on this range.
    Won(f64, f64),
    /// The new window is nowhere shorter.
    Lost,
    /// The distances at the ends do not decide.
    Open,
}

/// Whether the remainder `start..end` of `w`, on an edge of length `l`, is so narrow that trimming
/// drops it.
#[inline]
pub fn is_sliver(w: &Window, start: f64, end: f64, l: f64) -> bool {
    let width = end - start;
    width <= SLIVER * l && is_narrow(w, start, end)
}

/// The second condition of [`is_sliver`], which is rarely reached.
#[cold]
fn is_narrow(w: &Window, start: f64, end: f64) -> bool {
    let beside = (start - w.px).max(w.px - end).max(0.0);
    end - start <= SLIVER * (beside + w.py.abs())
}

/// Whether `start..end` is not a sliver of both windows.
#[inline]
pub(super) fn matters(old: &Window, new: &Window, start: f64, end: f64, l: f64) -> bool {
    start < end && !(is_sliver(old, start, end, l) && is_sliver(new, start, end, l))
}

impl ShorterPart {
    /// Compares the windows on `lo..hi`, on an edge of length `l`. A range that is a sliver of both
    /// stays with the old one.
    ///
    /// The distances at both ends decide, unless there may be two tie points or the windows are
    /// equal at the ends: these cases are [open](ShorterPart::Open).
    #[inline(always)]
    #[allow(clippy::inline_always)] // Keeps the window in registers.
    pub(super) fn between(old: &Window, new: &Window, lo: f64, hi: f64, l: f64) -> Self {
        if hi - lo <= SLIVER * l {
            return Self::on_narrow(old, new, lo, hi, l);
        }
        Self::on_wide(old, new, lo, hi, l)
    }

    /// As [`between`](Self::between) for a range that may be a sliver or a foot.
    #[cold]
    #[inline(never)]
    fn on_narrow(old: &Window, new: &Window, lo: f64, hi: f64, l: f64) -> Self {
        if !matters(old, new, lo, hi, l) {
            return Self::Lost;
        }
        if may_be_foot(hi - lo, l)
            && let Some(wins) = does_new_win(old, new, l)
        {
            return if wins { Self::Won(lo, hi) } else { Self::Lost };
        }
        Self::on_wide(old, new, lo, hi, l)
    }

    /// As [`between`](Self::between) for a range that is neither a sliver nor a foot.
    #[inline(always)]
    #[allow(clippy::inline_always)] // As `between`.
    fn on_wide(old: &Window, new: &Window, lo: f64, hi: f64, l: f64) -> Self {
        let held = [old.distance(lo), old.distance(hi)];
        let gains = [held[0] - new.distance(lo), held[1] - new.distance(hi)];
        let width = hi - lo;
        // The distance at the other end is at most this.
        let doubt = doubt(held[0] + width, l);
        let wins = greater(gains[0], gains[1]) > doubt;
        let loses = less(gains[0], gains[1]) < -doubt;
        if wins & loses {
            let tie = tie_between(old, new, lo, hi);
            // Rounding may put the bisector outside the range.
            if !(lo < tie && tie < hi) {
                return Self::Open;
            }
            let wins_first = gains[0] > 0.0;
            let (start, end) = if wins_first { (lo, tie) } else { (tie, hi) };
            let narrow = SLIVER * l;
            if (tie - lo > narrow) & (hi - tie > narrow) {
                return Self::Won(start, end);
            }
            return Self::beside(
                wins_first,
                [matters(old, new, lo, tie, l), matters(old, new, tie, hi, l)],
                [lo, tie, hi],
            );
        }
        if !(wins | loses) {
            return if is_sent_again(old, new) {
                Self::Won(lo, hi)
            } else if is_straight(old, new, width) {
                Self::Lost
            } else {
                Self::Open
            };
        }
        // Distances change by at most the way along the edge, and differences by at most twice
        // that.
        if (gains[0] + gains[1]).abs() < 2.0 * width
            && may_tie_twice(old, new, lo, hi)
            && within(tie_points(old, new).as_slice(), lo, hi).count() > 0
        {
            Self::Open
        } else if wins {
            Self::Won(lo, hi)
        } else {
            Self::Lost
        }
    }

    /// As [`between`](Self::between), where a tie is close to one of the ends.
    #[cold]
    fn beside(wins_first: bool, matters: [bool; 2], [lo, tie, hi]: [f64; 3]) -> Self {
        match (wins_first, matters[0], matters[1]) {
            (true, true, true) => Self::Won(lo, tie),
            (false, true, true) => Self::Won(tie, hi),
            (true, true, false) | (false, false, true) => Self::Won(lo, hi),
            (true, false, true) | (false, true, false) => Self::Lost,
            (_, false, false) => Self::Open,
        }
    }
}

/// Whether the distances of both windows are linear over `width`, to a fourth of the
/// [margin](GRAIN). Windows that are equal at the ends are then equal between them.
///
/// The second derivative of √(x² + y²) is at most 1/|y|, so the curve deviates from a line by at
/// most width²/(8|y|), and the distances are at least |y|. Windows that meet along a ray overlap by
/// such small widths, by which rounding has moved the ray. They are a tenth of all windows on
/// scans.
#[inline]
fn is_straight(old: &Window, new: &Window, width: f64) -> bool {
    width <= STRAIGHT * old.py.abs().min(new.py.abs())
}

/// The tie point of two windows of which one is shorter at `lo` and the other at `hi`.
///
/// The formulas are those of [`tie_points`]. One root is between `lo` and `hi`, and hardly ever
/// both.
#[inline(always)]
#[allow(clippy::inline_always)] // As `between`.
fn tie_between(old: &Window, new: &Window, lo: f64, hi: f64) -> f64 {
    let a = new.px - old.px;
    let delta = new.sigma - old.sigma;
    let leading = (a - delta) * (a + delta);
    let b = 0.5 * (leading + (old.py - new.py) * (old.py + new.py));
    if delta == 0.0 {
        // The bisector.
        return new.px - b / a;
    }
    let y = new.py;
    let root = delta * (b * b + leading * y * y).sqrt();
    let greater = -a * b + root.abs().copysign(-a * b);
    let roots = [
        greater / leading,
        (b - delta * y) * (b + delta * y) / greater,
    ];
    let [first, second] = roots.map(|u| (lo < new.px + u) & (new.px + u < hi));
    let u = if first { roots[0] } else { roots[1] };
    let scaled = a * u + b;
    let is_tie = (scaled * delta >= 0.0) & ((delta * delta + scaled) * delta >= 0.0);
    if (first != second) & is_tie {
        new.px + u
    } else {
        bisected(|x| old.distance(x) - new.distance(x), lo, hi)
    }
}

/// A zero of `gain` between `lo` and `hi`, where its signs differ: the tie point where a formula
/// cannot tell the roots apart. Where both σ are equal up to rounding, so are the roots, and their
/// signs are rounding errors.
#[cold]
#[inline(never)]
pub(super) fn bisected(gain: impl Fn(f64) -> f64, mut lo: f64, mut hi: f64) -> f64 {
    let wins_first = gain(lo) > 0.0;
    loop {
        let middle = 0.5 * (lo + hi);
        if middle <= lo || middle >= hi {
            return middle;
        }
        if (gain(middle) > 0.0) == wins_first {
            lo = middle;
        } else {
            hi = middle;
        }
    }
}

/// The points between `lo` and `hi`, on an edge of length `l`, at which the shorter of two windows
/// may change.
///
/// As [`tie_points`], but never empty if one window is shorter at `lo` and the other at `hi`.
pub fn ties_between(old: &Window, new: &Window, lo: f64, hi: f64, l: f64) -> TiePoints {
    let gains = [lo, hi].map(|x| old.distance(x) - new.distance(x));
    let doubt = doubt(old.distance(lo) + (hi - lo), l);
    if greater(gains[0], gains[1]) > doubt && less(gains[0], gains[1]) < -doubt {
        // One window is shorter at each end, so one tie is between the ends.
        TiePoints::one(tie_between(old, new, lo, hi))
    } else {
        tie_points(old, new)
    }
}

/// The elements of `ties` between `lo` and `hi`.
#[inline]
fn within(ties: &[f64], lo: f64, hi: f64) -> impl Iterator<Item = f64> {
    ties.iter().copied().filter(move |&t| lo < t && t < hi)
}

/// Whether the distances of the windows may cross twice between `lo` and `hi`, where one window is
/// shorter at both.
///
/// The [tie points](tie_points) are roots of A·u² + 2ab·u + (b² - D²·y1²). Two roots lie on both
/// sides of the parabola's vertex. If it has no real roots, or its vertex is not between `lo` and
/// `hi`, there are no two crossings.
#[inline]
fn may_tie_twice(old: &Window, new: &Window, lo: f64, hi: f64) -> bool {
    let a = new.px - old.px;
    let delta = new.sigma - old.sigma;
    let leading = (a - delta) * (a + delta);
    let b = 0.5 * (leading + (old.py - new.py) * (old.py + new.py));
    let slope = |x: f64| leading * (x - new.px) + a * b;
    let sides = slope(lo) * slope(hi);
    let lack = -(b * b + leading * new.py * new.py);
    // Neither may be positive. Which one is, is unpredictable: one branch for both.
    let greater = if sides > lack { sides } else { lack };
    greater <= 0.0 && delta != 0.0
}

/// Whether `new` is `old` with a smaller σ: its source has been reached by a shorter path since,
/// and has sent its windows again.
///
/// Images of one source that have crossed the same faces are equal bit for bit, so no rounding is
/// in the comparison. The new window takes everything, however little it gains. Else each
/// pseudo-source of a chain would keep a little of the longer path to the one before. The side of
/// the edge does not matter: it tells which way the window goes, or whether it has been propagated.
#[inline]
pub(super) fn is_sent_again(old: &Window, new: &Window) -> bool {
    new.px == old.px && new.py.abs() == old.py.abs() && new.sigma < old.sigma
}

/// Whether the new one of two windows is shorter on a range without a tie.
///
/// The midpoint decides, unless the windows are equal there. Two sources on the line of the edge
/// are equal all along one side, on which one source is behind the other, and differ beyond the
/// nearer source: then the ends decide. If the windows are equal at the ends as well, the old one
/// stays, with one exception. If the source of the old one is on the edge and that of the new one
/// is not, a smaller difference is enough: all directions of the old one pass through its foot, and
/// the rest of it has one direction, along the edge.
pub(super) fn is_new_shorter<W: Contender>(old: &W, new: &W, start: f64, end: f64, l: f64) -> bool {
    if W::is_sent_again(old, new) {
        return true;
    }
    let compare = |x: f64| {
        let (held, offered) = (old.offers(x), new.offers(x));
        if held - offered > doubt(held, l) {
            Ordering::Less
        } else if offered - held > doubt(held, l) {
            Ordering::Greater
        } else {
            Ordering::Equal
        }
    };
    let middle = compare(0.5 * (start + end));
    match middle {
        Ordering::Equal => {
            let ends = [compare(start), compare(end)];
            if ends == [Ordering::Equal; 2] {
                let x = 0.5 * (start + end);
                let (held, offered) = (old.offers(x), new.offers(x));
                old.grazes(l) && !new.grazes(l) && held - offered > LESS * GRAIN * held + PLACE * l
            } else {
                ends.contains(&Ordering::Less) && !ends.contains(&Ordering::Greater)
            }
        }
        _ => middle == Ordering::Less,
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn windows() -> impl Strategy<Value = Window> {
        (-2.0..3.0f64, -4.0..4.0f64, 0.0..2.0f64).prop_map(|(px, py, sigma)| Window {
            b0: 0.0,
            b1: 1.0,
            px,
            py,
            sigma,
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(5000))]

        #[test]
        fn a_comparison_is_won_by_the_shorter_one(
            old in windows(), new in windows(), lo in 0.0..0.5f64, width in 0.001..0.5f64, at in 0.0..1.0f64,
        ) {
            let hi = lo + width;
            let x = lo + at * width;
            let new_wins = match ShorterPart::between(&old, &new, lo, hi, 1.0) {
                ShorterPart::Open => return Ok(()),
                ShorterPart::Lost => false,
                ShorterPart::Won(start, end) => start <= x && x <= end,
            };
            let (held, offered) = (old.distance(x), new.distance(x));
            let least = held.min(offered);
            let won = if new_wins { offered } else { held };
            prop_assert!(won <= least * (1.0 + 1e-9), "{won} {least}");
        }

        /// Windows that meet along a ray overlap by rounding. A tenth of all comparisons on scans
        /// were of this kind, and all of them took the slow path for two ties.
        #[test]
        fn windows_that_meet_along_a_ray_are_told_apart_at_once(
            old in windows(), lo in 0.0..1.0f64, slope in -1.0..1.0f64, width in 1e-10..1e-7f64, at in 0.0..1.0f64,
        ) {
            let width = width * old.py.abs();
            let (x, y) = (lo - old.px, old.py);
            // A source elsewhere on the same ray.
            let t = 0.5 + 0.25 * slope;
            let new = Window {
                px: lo - t * x,
                py: t * y,
                sigma: old.sigma + (1.0 - t) * x.hypot(y),
                ..old
            };
            let outcome = ShorterPart::between(&old, &new, lo, lo + width * t, 1.0);
            prop_assert_ne!(outcome, ShorterPart::Open);
            let x = lo + at * width * t;
            let (held, offered) = (old.distance(x), new.distance(x));
            match outcome {
                ShorterPart::Lost => prop_assert!(held <= offered * (1.0 + 2e-12)),
                ShorterPart::Won(start, end) if start <= x && x <= end => {
                    prop_assert!(offered <= held * (1.0 + 2e-12));
                }
                _ => {}
            }
        }

        /// Windows of one direction, as in lists of half-edges: nearly all comparisons are decided
        /// by the ends.
        #[test]
        fn comparisons_of_one_direction_are_seldom_open(old in windows(), new in windows()) {
            let below = |w: Window| Window { py: -w.py.abs(), ..w };
            let open = ShorterPart::between(&below(old), &below(new), 0.0, 1.0, 1.0) == ShorterPart::Open;
            let ties = tie_points(&below(old), &below(new));
            let inside = ties.as_slice().iter().filter(|&&t| (0.0..=1.0).contains(&t)).count();
            prop_assert!(!open || inside != 1);
        }
    }
}
