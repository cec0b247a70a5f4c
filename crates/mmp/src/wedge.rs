//! Where a new window is shorter than those of its list, as far as that is in one piece.

use geobench_window::Window;

use geobench_window::trimming::{Duel, is_sliver};

/// What becomes of a new window, as far as it is simple.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Fate {
    /// It is nowhere shorter.
    Nowhere,
    /// In one piece, from here to there.
    Here(f64, f64),
    /// Perhaps in several.
    Open,
}

impl Fate {
    /// Where `new` is shorter than `behind`, the stored windows from the first on that it may meet.
    #[inline(always)]
    #[allow(clippy::inline_always)] // The window is not to pass through memory.
    pub(crate) fn of<'a>(behind: impl Iterator<Item = &'a Window>, new: &Window, l: f64) -> Self {
        // What it has won so far: nothing while it has no width.
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
                // No window holds that.
                if end == decided && start < end {
                    end = lo;
                } else if !is_sliver(new, decided, lo, l) {
                    if start < end {
                        return Self::Open;
                    }
                    (start, end) = (decided, lo);
                }
            }
            // The first ones may end before it, up to the rounding of a search.
            decided = if hi > decided { hi } else { decided };
            match Duel::between(w, new, lo, hi, l) {
                Duel::Won(from, to) => {
                    if start >= end {
                        start = from;
                    } else if end != from {
                        return Self::Open;
                    }
                    end = to;
                }
                Duel::Lost => {}
                Duel::Open => return Self::Open,
            }
            if w.b1 >= new.b1 {
                // The next one begins behind it, and need not be looked at.
                break;
            }
        }
        if decided < new.b1 {
            if end == decided {
                // From the beginning, or joined.
                end = new.b1;
            } else if !is_sliver(new, decided, new.b1, l) {
                if start < end {
                    return Self::Open;
                }
                (start, end) = (decided, new.b1);
            }
        }
        if start >= end || is_sliver(new, start, end, l) {
            Self::Nowhere
        } else {
            Self::Here(start, end)
        }
    }
}
