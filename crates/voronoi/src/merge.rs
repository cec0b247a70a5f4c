//! Merges windows that arrive at an edge together into its list, in one pass.

use geobench_window::trimming::{OverlapRange, is_sliver, matters};

use crate::store::{Changes, Stored};

/// Up to this length, all windows of a list are compared, instead of a binary search.
const SHORT: usize = 16;

/// One pass over the list of an edge, in ascending order, that inserts new windows.
///
/// The windows that replace a range of the list are collected as pieces. The caller copies them
/// into the list at the [end](Self::end). A stored window that loses its left part is cut in place.
pub(crate) struct Sweep<'a> {
    list: &'a mut [Stored],
    /// Length of the edge.
    l: f64,
    pieces: &'a mut Vec<Stored>,
    changes: &'a mut Changes,
    /// The first window that the pieces replace.
    base: usize,
    /// The first window that has not been passed. The pieces replace those from `base` up to it.
    next: usize,
}

impl<'a> Sweep<'a> {
    /// Starts after the windows of `list` that end at or before `x`. `pieces` is scratch space.
    #[inline]
    pub(crate) fn start(
        list: &'a mut [Stored],
        x: f64,
        l: f64,
        pieces: &'a mut Vec<Stored>,
        changes: &'a mut Changes,
    ) -> Self {
        // The loads of a linear search do not depend on each other, as those of a binary search do.
        let next = if list.len() <= SHORT {
            list.iter().map(|s| usize::from(s.window.b1 <= x)).sum()
        } else {
            list.partition_point(|s| s.window.b1 <= x)
        };
        pieces.clear();
        Self {
            list,
            l,
            pieces,
            changes,
            base: next,
            next,
        }
    }

    /// Inserts the windows of `batch` from index `k` on, as long as they are in ascending order.
    /// Returns the index of the first window that is not inserted, and whether that window needs
    /// the general case: an `Overlap` with all windows that it meets.
    #[inline]
    pub(crate) fn insert_all(&mut self, batch: &[Stored], mut k: usize) -> (usize, bool) {
        // All windows that end at or before this abscissa have been passed.
        let mut passed = batch[k].window.b0;
        while let Some(new) = batch.get(k) {
            let mut new = *new;
            if new.window.b0 < passed {
                break;
            }
            passed = new.window.b0;
            let is_decided = match self.pieces.last() {
                Some(last) if new.window.b0 < last.window.b1 => {
                    let end = last.window.b1;
                    let shared = end.min(new.window.b1);
                    if matters(&last.window, &new.window, new.window.b0, shared, self.l) {
                        if new.window.b0 < last.window.b0 {
                            break;
                        }
                        self.insert_over_last(&new)
                    } else if end < new.window.b1 {
                        // They only touch: the overlap is due to rounding.
                        new.window.b0 = end;
                        self.insert(&new)
                    } else {
                        self.changes.dropped += 1;
                        true
                    }
                }
                _ => {
                    self.pass(new.window.b0);
                    self.insert(&new)
                }
            };
            if !is_decided {
                return (k, true);
            }
            k += 1;
        }
        (k, false)
    }

    /// Passes the windows that end at or before `x`.
    #[inline]
    fn pass(&mut self, x: f64) {
        while let Some(stored) = self.list.get(self.next)
            && stored.window.b1 <= x
        {
            if !self.pieces.is_empty() {
                self.pieces.push(*stored);
            }
            self.next += 1;
        }
    }

    /// Inserts `new`, which begins at or after the end of the passed windows and of the pieces.
    /// Returns false and changes nothing if several parts of `new` may be shorter than stored
    /// windows.
    #[inline]
    fn insert(&mut self, new: &Stored) -> bool {
        let behind = self.list[self.next..].iter().map(|s| &s.window);
        let (start, end) = match OverlapRange::of(behind, &new.window, self.l) {
            OverlapRange::Empty => {
                self.changes.dropped += 1;
                return true;
            }
            OverlapRange::Single(start, end) => (start, end),
            OverlapRange::Undecided => return false,
        };
        self.pass(start);
        if self.pieces.is_empty() {
            self.base = self.next;
        }
        // The index of the stored window that keeps a part on the left of the new one.
        let mut halved = None;
        if let Some(old) = self.list.get(self.next)
            && old.window.b0 < start
            && !is_sliver(&old.window, old.window.b0, start, self.l)
        {
            self.pieces.push(old.cut(old.window.b0, start));
            self.changes.trimmed += 1;
            halved = Some(self.next);
        }
        self.put(new, start, end, halved);
        true
    }

    /// [`insert`](Self::insert) for a window that begins within the last piece.
    #[inline(never)]
    fn insert_over_last(&mut self, new: &Stored) -> bool {
        let Some(&last) = self.pieces.last() else {
            return false;
        };
        let behind = self.list[self.next..].iter().map(|s| &s.window);
        let met = std::iter::once(&last.window).chain(behind);
        let (start, end) = match OverlapRange::of(met, &new.window, self.l) {
            OverlapRange::Empty => {
                self.changes.dropped += 1;
                return true;
            }
            OverlapRange::Single(start, end) => (start, end),
            OverlapRange::Undecided => return false,
        };
        let (b0, b1) = (last.window.b0, last.window.b1);
        if b1 <= start {
            self.pass(start);
            return self.insert(&new.cut(start, end));
        }
        self.pieces.pop();
        let keeps_left = b0 < start && !is_sliver(&last.window, b0, start, self.l);
        let keeps_right = end < b1 && !is_sliver(&last.window, end, b1, self.l);
        if keeps_left {
            self.pieces.push(last.cut(b0, start));
        }
        if keeps_right {
            let piece = new.cut(start, end);
            self.changes.keep(&piece);
            self.pieces.push(piece);
            self.pieces.push(last.cut(end, b1));
            self.changes.split += usize::from(keeps_left && last.waits());
        } else {
            self.put(new, start, end, None);
        }
        let keeps = keeps_left || keeps_right;
        self.changes.trimmed += usize::from(keeps);
        self.changes.removed += usize::from(!keeps);
        true
    }

    /// Appends `start..end` of `new` to the pieces, and removes the range that it covers from the
    /// windows that have not been passed. `halved` is the index of the window whose left part is a
    /// piece already.
    #[inline]
    fn put(&mut self, new: &Stored, start: f64, end: f64, halved: Option<usize>) {
        let piece = new.cut(start, end);
        self.changes.keep(&piece);
        self.pieces.push(piece);
        let first = self.next;
        while let Some(old) = self.list.get(self.next)
            && old.window.b1 <= end
        {
            self.next += 1;
        }
        if let Some(old) = self.list.get_mut(self.next)
            && old.window.b0 < end
        {
            if is_sliver(&old.window, end, old.window.b1, self.l) {
                self.next += 1;
            } else {
                if halved == Some(self.next) {
                    self.changes.split += usize::from(old.waits());
                } else {
                    self.changes.trimmed += 1;
                }
                *old = old.cut(end, old.window.b1);
            }
        }
        let keeps_left = halved.is_some_and(|k| k < self.next);
        self.changes.removed += self.next - first - usize::from(keeps_left);
    }

    /// The range of the list that the pieces replace; empty if there are none.
    #[inline]
    pub(crate) fn end(self) -> std::ops::Range<usize> {
        if self.pieces.is_empty() {
            0..0
        } else {
            self.base..self.next
        }
    }
}
