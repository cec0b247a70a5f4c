//! The range on which a new window is shorter than the windows of its list.

use super::compare::{ShorterPart, is_sliver};
use crate::window::Window;

/// The part of a new window that is shorter than the windows it overlaps. Nearly always it is at
/// most one interval, which one pass finds without an [`Overlap`](super::Overlap).
#[derive(Clone, Copy, Debug)]
pub(super) enum OverlapRange {
    /// The new window is nowhere shorter.
    Empty,
    /// One interval, from here to there.
    Single(f64, f64),
    /// Possibly several intervals.
    Undecided,
}

impl OverlapRange {
    /// Compares `new` with `behind`, the stored windows from the first one on that it may overlap,
    /// on an edge of length `l`.
    #[inline(always)]
    #[allow(clippy::inline_always)] // The window is not to pass through memory.
    pub(super) fn of<'a>(behind: impl Iterator<Item = &'a Window>, new: &Window, l: f64) -> Self {
        // The interval won so far; empty while it has no width.
        let (mut start, mut end) = (new.b0, new.b0);
        // Up to here everything has been decided.
        let mut decided = new.b0;
        for w in behind {
            if w.b0 >= new.b1 {
                break;
            }
            let lo = if w.b0 > new.b0 { w.b0 } else { new.b0 };
            let hi = if w.b1 < new.b1 { w.b1 } else { new.b1 };
            if decided < lo {
                // No stored window covers that range.
                if end == decided && start < end {
                    end = lo;
                } else if !is_sliver(new, decided, lo, l) {
                    if start < end {
                        return Self::Undecided;
                    }
                    (start, end) = (decided, lo);
                }
            }
            // The first ones may end before `new` begins, by the rounding of the search.
            decided = if hi > decided { hi } else { decided };
            match ShorterPart::between(w, new, lo, hi, l) {
                ShorterPart::Won(from, to) => {
                    if start >= end {
                        start = from;
                    } else if end != from {
                        return Self::Undecided;
                    }
                    end = to;
                }
                ShorterPart::Lost => {}
                ShorterPart::Open => return Self::Undecided,
            }
            if w.b1 >= new.b1 {
                // The next one begins behind `new`.
                break;
            }
        }
        if decided < new.b1 {
            if end == decided {
                // From the beginning, or joined to the interval won.
                end = new.b1;
            } else if !is_sliver(new, decided, new.b1, l) {
                if start < end {
                    return Self::Undecided;
                }
                (start, end) = (decided, new.b1);
            }
        }
        if start >= end || is_sliver(new, start, end, l) {
            Self::Empty
        } else {
            Self::Single(start, end)
        }
    }
}

/// Whether the windows `behind`, as in [`OverlapRange::of`], cover all of `new` and are nowhere
/// longer.
pub(super) fn loses_everywhere<'a>(
    behind: impl Iterator<Item = &'a Window>,
    new: &Window,
    l: f64,
) -> bool {
    let mut covered = new.b0;
    for w in behind.take_while(|w| w.b0 < new.b1) {
        let (lo, hi) = (w.b0.max(new.b0), w.b1.min(new.b1));
        if covered < lo && !is_sliver(new, covered, lo, l)
            || ShorterPart::between(w, new, lo, hi, l) != ShorterPart::Lost
        {
            return false;
        }
        covered = hi;
    }
    is_sliver(new, covered, new.b1, l)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_window_is_shorter_on_its_side_of_the_tie() {
        // The sources lie below both ends of an edge of length 1.
        let old = Window {
            b0: 0.0,
            b1: 1.0,
            px: 0.0,
            py: -1.0,
            sigma: 0.0,
        };
        let new = Window { px: 1.0, ..old };
        let range = OverlapRange::of([old].iter(), &new, 1.0);
        assert!(matches!(range, OverlapRange::Single(start, 1.0) if (start - 0.5).abs() < 1e-15));
    }
}
