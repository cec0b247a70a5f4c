//! Where a new window is shorter than those of its list, as far as that is in one piece.

use geobench_window::Window;

use crate::duel::{Duel, duel, is_sliver, matters};
use crate::lists::Place;

/// A new window that takes one range, and what this leaves of the windows that it meets.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wedge {
    pub(crate) start: f64,
    pub(crate) end: f64,
    /// The windows that lose something, counted from the first one that the new window may meet.
    pub(crate) first: usize,
    pub(crate) behind: usize,
    /// Whether the first of them keeps its part before `start`, and the last one its part behind `end`.
    pub(crate) keeps_left: bool,
    pub(crate) keeps_right: bool,
}

/// What becomes of a new window, as far as it is simple.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Fate {
    /// It is nowhere shorter.
    Nowhere,
    /// In one piece.
    Here(Wedge),
    /// Perhaps in several.
    Open,
}

impl Fate {
    /// Where `new` is shorter than the windows at `places`, of which the first is the first that it may meet.
    #[inline]
    pub(crate) fn of(windows: &[Window], places: &[Place], new: &Window, l: f64) -> Self {
        let mut wedge = Wedge {
            start: new.b0,
            end: new.b1,
            first: 0,
            behind: 0,
            keeps_left: false,
            keeps_right: false,
        };
        // Whether it has gained anything, and lost it again.
        let (mut gained, mut over) = (false, false);
        // Up to here everything has been decided.
        let mut decided = new.b0;
        for place in places {
            let w = &windows[place.slot as usize];
            if w.b0 >= new.b1 {
                break;
            }
            let (lo, hi) = (w.b0.max(new.b0), w.b1.min(new.b1));
            if decided < lo && !is_sliver(new, decided, lo, l) {
                if over {
                    return Self::Open;
                }
                if !gained {
                    (gained, wedge.start) = (true, decided);
                }
            }
            decided = decided.max(hi);
            let outcome = if matters(w, new, lo, hi, l) {
                duel(w, new, lo, hi, l)
            } else {
                Duel::Old
            };
            match outcome {
                Duel::Old if gained && !over => (over, wedge.end) = (true, lo),
                Duel::Old => {
                    if !gained {
                        wedge.first += 1;
                        wedge.behind += 1;
                        wedge.start = decided;
                    }
                }
                Duel::New | Duel::NewOld(_) if !over => {
                    if !gained {
                        (gained, wedge.start, wedge.keeps_left) = (true, lo, w.b0 < lo);
                    }
                    wedge.behind += 1;
                    wedge.keeps_right = hi < w.b1;
                    if let Duel::NewOld(tie) = outcome {
                        (over, wedge.end, wedge.keeps_right) = (true, tie, true);
                    }
                }
                Duel::OldNew(tie) if !gained => {
                    (gained, wedge.start, wedge.keeps_left) = (true, tie, true);
                    wedge.behind += 1;
                    wedge.keeps_right = hi < w.b1;
                }
                _ => return Self::Open,
            }
            if w.b1 >= new.b1 {
                // The next one begins behind it, and need not be looked at.
                break;
            }
        }
        if decided < new.b1 && !over && !gained {
            (gained, wedge.start) = (true, decided);
        } else if decided < new.b1 && over && !is_sliver(new, decided, new.b1, l) {
            return Self::Open;
        }
        if gained && !is_sliver(new, wedge.start, wedge.end, l) {
            Self::Here(wedge)
        } else {
            Self::Nowhere
        }
    }
}
