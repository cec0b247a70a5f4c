//! Windows that arrive at an edge together, merged into its list in one pass.

use geobench_window::trimming::{OverlapRange, is_sliver, matters};

use crate::store::{Changes, Stored};

/// One pass over the list of an edge, in ascending order, that inserts windows.
///
/// What takes the place of the windows passed is collected and copied back at the end. A stored
/// window that loses its left part is cut in place.
pub(crate) struct Sweep<'a> {
    list: &'a mut [Stored],
    l: f64,
    pieces: &'a mut Vec<Stored>,
    changes: &'a mut Changes,
    /// The first window that the pieces replace.
    base: usize,
    /// The first window that has not been passed; the pieces replace those before it.
    next: usize,
}

impl<'a> Sweep<'a> {
    /// Starts behind the windows of `list` that end at `x` or before; `pieces` is scratch space.
    #[inline]
    pub(crate) fn start(
        list: &'a mut [Stored],
        x: f64,
        l: f64,
        pieces: &'a mut Vec<Stored>,
        changes: &'a mut Changes,
    ) -> Self {
        let next = list.partition_point(|s| s.window.b1 <= x);
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

    /// Inserts windows of `batch` from number `k` on. Returns the number of the first one that is
    /// left, and whether that one needs a division of the whole overlap.
    ///
    /// The pass does not compare a window with those that it has inserted: it ends before a window
    /// that begins within the last one.
    #[inline]
    pub(crate) fn insert_all(&mut self, batch: &[Stored], mut k: usize) -> (usize, bool) {
        let mut covered = batch[k].window.b0;
        let mut last = k;
        while let Some(new) = batch.get(k) {
            let mut new = *new;
            if new.window.b0 < covered {
                let (before, end) = (&batch[last].window, covered.min(new.window.b1));
                if matters(before, &new.window, new.window.b0, end, self.l) {
                    return (k, false);
                }
                // They touch; the overlap is rounding.
                new.window.b0 = covered;
                if new.window.b0 >= new.window.b1 {
                    self.changes.dropped += 1;
                    k += 1;
                    continue;
                }
            }
            self.pass(new.window.b0);
            if !self.insert(&new) {
                return (k, true);
            }
            (last, covered) = (k, new.window.b1);
            k += 1;
        }
        (k, false)
    }

    /// Passes the windows that end at `x` or before.
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

    /// Inserts `new`, which begins at or behind the end of the windows passed. Returns false, and
    /// changes nothing, if several parts of it may be shorter than stored windows.
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
        // Number of stored windows that keep a part, and the place of the first one met.
        let (mut kept, first) = (0, self.next);
        if let Some(old) = self.list.get(self.next)
            && old.window.b0 < start
            && !is_sliver(&old.window, old.window.b0, start, self.l)
        {
            self.pieces.push(old.cut(old.window.b0, start));
            kept += 1;
        }
        let piece = new.cut(start, end);
        self.changes.keep(&piece);
        self.pieces.push(piece);
        while let Some(old) = self.list.get(self.next)
            && old.window.b1 <= end
        {
            self.next += 1;
        }
        let mut met = self.next - first;
        if let Some(old) = self.list.get_mut(self.next)
            && old.window.b0 < end
        {
            met += 1;
            if is_sliver(&old.window, end, old.window.b1, self.l) {
                self.next += 1;
            } else {
                if kept == 1 && self.next == first {
                    // A second part of the window whose left part stays, too.
                    self.changes.split += usize::from(old.waits());
                } else {
                    kept += 1;
                }
                *old = old.cut(end, old.window.b1);
            }
        }
        self.changes.trimmed += kept;
        self.changes.removed += met - kept;
        true
    }

    /// The range of the list that the pieces replace.
    #[inline]
    pub(crate) fn end(self) -> std::ops::Range<usize> {
        if self.pieces.is_empty() {
            0..0
        } else {
            self.base..self.next
        }
    }
}
