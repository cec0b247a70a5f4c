//! Division of the overlap of a new window and the stored windows that it meets, in the general
//! case.

use super::compare::is_new_shorter;
use super::contender::Contender;
use super::foot::may_be_foot;
use crate::rays::Rays;
use crate::window::Window;

/// The window that is shorter on a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Owner {
    /// The new window.
    New,
    /// The stored window with this index among those that the new one meets.
    Old(usize),
}

/// A range of the half-edge and its owner.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    /// Where it begins.
    pub start: f64,
    /// Where it ends.
    pub end: f64,
    /// The window that is shorter on it.
    pub owner: Owner,
}

/// The ranges that a new window and stored ones cover together, ascending, each with its owner.
///
/// ```
/// use geobench_window::Window;
/// use geobench_window::trimming::{Overlap, Owner};
///
/// // The sources lie below both ends of an edge of length 1.
/// let old = Window { b0: 0.0, b1: 1.0, px: 0.0, py: -1.0, sigma: 0.0 };
/// let new = Window { px: 1.0, ..old };
/// let mut overlap = Overlap::default();
/// overlap.share_out(&[old], &new, 1.0);
/// let owners: Vec<Owner> = overlap.segments().iter().map(|s| s.owner).collect();
/// assert_eq!(owners, [Owner::Old(0), Owner::New]);
/// assert!((overlap.segments()[0].end - 0.5).abs() < 1e-15);
/// ```
#[derive(Clone, Debug, Default)]
pub struct Overlap {
    segments: Vec<Segment>,
}

impl Overlap {
    /// The ranges, ascending.
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Divides the union of `met` and `new`, on an edge of length `l`, into ranges with one owner
    /// each. Slivers are left out.
    pub fn share_out(&mut self, met: &[Window], new: &Window, l: f64) {
        self.divide(met, new, l);
    }

    /// As [`share_out`](Self::share_out), for windows of points and of segments.
    pub fn share_out_rays(&mut self, met: &[Rays], new: &Rays, l: f64) {
        self.divide(met, new, l);
    }

    fn divide<W: Contender>(&mut self, met: &[W], new: &W, l: f64) {
        self.segments.clear();
        let [b0, b1] = new.interval();
        let mut covered = b0;
        for (i, w) in met.iter().enumerate() {
            let old = Owner::Old(i);
            let [first, last] = w.interval();
            let (lo, hi) = (first.max(b0), last.min(b1));
            self.grant(covered, first, Owner::New);
            self.grant(first, lo, old);
            // Ranges that are slivers of both windows are not worth a trim.
            let matters = |start: f64, end: f64| {
                start < end && !(w.is_sliver(start, end, l) && new.is_sliver(start, end, l))
            };
            let winner = |start, end| {
                if is_new_shorter(w, new, start, end, l) {
                    Owner::New
                } else {
                    old
                }
            };
            let mut start = lo;
            if may_be_foot(hi - lo, l)
                && let Some(wins) = W::does_new_win(w, new, l)
            {
                self.grant(lo, hi, if wins { Owner::New } else { old });
            } else if matters(lo, hi) {
                for &tie in W::ties_between(w, new, lo, hi, l).as_slice() {
                    if matters(start, tie) && matters(tie, hi) {
                        self.grant(start, tie, winner(start, tie));
                        start = tie;
                    }
                }
                self.grant(start, hi, winner(start, hi));
            } else {
                self.grant(start, hi, old);
            }
            self.grant(hi, last, old);
            covered = hi;
        }
        self.grant(covered, b1, Owner::New);
        self.segments.retain(|s| {
            let owner = match s.owner {
                Owner::New => new,
                Owner::Old(k) => &met[k],
            };
            !owner.is_sliver(s.start, s.end, l)
        });
    }

    /// Gives `start..end` to `owner`.
    fn grant(&mut self, start: f64, end: f64, owner: Owner) {
        if start < end {
            match self.segments.last_mut() {
                Some(last) if last.owner == owner => last.end = end,
                _ => self.segments.push(Segment { start, end, owner }),
            }
        }
    }
}
