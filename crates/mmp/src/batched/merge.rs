//! Merges the windows that arrive together into a list: sorted, disjoint, trimmed at tie points.

// Inlining keeps windows in registers while they are compared.
#![allow(clippy::inline_always)]

use geobench_window::{Counter, Probe, Window};

use super::store::{Store, StoredWindow};
use geobench_window::trimming::{
    Overlap, OverlapRange, Owner, Segment, foot, is_sliver, matters, pieces,
};

/// Windows that arrive at one half-edge together.
#[derive(Clone, Debug, Default)]
pub(super) struct Batch {
    /// In the order of arrival, which is mostly, but not always, that of their intervals.
    pub(super) windows: Vec<Window>,
    /// Their levels in the sequence tree. Counted runs only.
    pub(super) levels: Vec<u32>,
}

impl Batch {
    pub(super) fn clear(&mut self) {
        self.windows.clear();
        self.levels.clear();
    }

    /// The same windows, those with a [foot] split at it.
    #[cold]
    fn with_feet_apart(&self, l: f64) -> Self {
        let mut batch = Self::default();
        for (k, w) in self.windows.iter().enumerate() {
            for piece in pieces(w, l) {
                batch.windows.push(piece);
                batch.levels.extend(self.levels.get(k));
            }
        }
        batch
    }

    /// The same windows, except those that `drops` names.
    pub(super) fn without(&self, drops: impl Fn(&Window) -> bool) -> Self {
        let mut batch = Self::default();
        for (k, w) in self.windows.iter().enumerate().filter(|(_, w)| !drops(w)) {
            batch.windows.push(*w);
            batch.levels.extend(self.levels.get(k));
        }
        batch
    }

    /// The same windows, [mirrored](Window::mirrored); `l` is the length of the edge.
    pub(super) fn mirrored(&self, l: f64) -> Self {
        let mut batch = Self::default();
        for (k, w) in self.windows.iter().enumerate().rev() {
            let mirrored = w.mirrored(l);
            if mirrored.b0 < mirrored.b1 {
                batch.windows.push(mirrored);
                batch.levels.extend(self.levels.get(k));
            }
        }
        batch
    }

    fn level(&self, k: usize) -> u32 {
        self.levels.get(k).copied().unwrap_or(0)
    }
}

/// The result of a merge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Merged {
    /// The least distance of the surviving new windows; infinite if there is none.
    pub(super) least: f64,
    /// How many of the new windows survive. Counted runs only.
    pub(super) kept: u64,
}

/// Merges batches into lists; owns the buffers.
#[derive(Clone, Debug, Default)]
pub(super) struct Merger {
    overlap: Overlap,
    met: Vec<Window>,
    pieces: Replacement,
}

/// The windows that replace those that a sweep has passed.
#[derive(Clone, Debug, Default)]
struct Replacement {
    windows: Vec<StoredWindow>,
    /// Counted runs only.
    levels: Vec<u32>,
}

impl Replacement {
    fn clear(&mut self) {
        self.windows.clear();
        self.levels.clear();
    }
}

impl Merger {
    /// Merges `batch` into list `i`, whose edge has length `l`. Calls `weigh` with the label of
    /// every window that now waits under a new label: the surviving new windows, and trimmed stored
    /// ones whose least distance grew.
    ///
    /// Each stored window that a new one overlaps is split at the tie points in the common range,
    /// of which there may be two. Each part goes to the window that is shorter there, to the stored
    /// one where they are equal. Ranges without a stored window go to the new one. The result is
    /// that of inserting the windows one after the other: windows in ascending order share one
    /// sweep over the list, and one out of order starts another. A sweep takes O(log k + m) for m
    /// windows met among k, and moves those behind them.
    #[inline]
    pub(super) fn merge<P: Probe>(
        &mut self,
        store: &mut Store,
        i: usize,
        batch: &Batch,
        l: f64,
        weigh: &mut impl FnMut(f64),
        probe: &mut P,
    ) -> Merged {
        let mut merged = Merged {
            least: f64::INFINITY,
            kept: 0,
        };
        let apart;
        let has_feet = batch.windows.iter().any(|w| foot(w, l).is_some());
        let all = if has_feet {
            apart = batch.with_feet_apart(l);
            &apart
        } else {
            batch
        };
        self.sweep(store, i, all, l, &mut merged, weigh, probe);
        // Several pieces of one window may survive.
        merged.kept = merged.kept.min(batch.windows.len() as u64);
        merged
    }

    /// [`merge`](Self::merge) for windows without a [foot], or split at it.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)] // Private, and one step of `merge`.
    fn sweep<P: Probe>(
        &mut self,
        store: &mut Store,
        i: usize,
        batch: &Batch,
        l: f64,
        merged: &mut Merged,
        weigh: &mut impl FnMut(f64),
        probe: &mut P,
    ) {
        let windows = &batch.windows;
        let mut k = 0;
        while k < windows.len() {
            let mut sweep = ListSweep::start(store, i, windows[k].b0, &mut self.pieces);
            let mut is_open = sweep.insert(&windows[k], batch.level(k), l, merged, weigh, probe);
            // A sweep does not compare a window with those it inserted: the next window must begin
            // behind the last one.
            let mut last = &windows[k];
            k += 1;
            while !is_open && k < windows.len() {
                let mut new = windows[k];
                if new.b0 < last.b1 {
                    if matters(last, &new, new.b0, last.b1.min(new.b1), l) {
                        break;
                    }
                    // They touch; the overlap is rounding.
                    new.b0 = last.b1;
                    if new.b0 >= new.b1 {
                        probe.add(Counter::Filtered, 1);
                        k += 1;
                        continue;
                    }
                }
                last = &windows[k];
                sweep.pass(new.b0);
                is_open = sweep.insert(&new, batch.level(k), l, merged, weigh, probe);
                k += 1;
            }
            let ListSweep { base, next, .. } = sweep;
            let Replacement {
                windows: pieces,
                levels,
            } = &self.pieces;
            if !pieces.is_empty() {
                store.replace(i, base, next - base, pieces, levels);
            }
            if is_open {
                let new = &windows[k - 1];
                self.divide(store, i, new, batch.level(k - 1), l, merged, weigh, probe);
            }
        }
    }

    /// Inserts `new` by dividing the whole overlap; several of its intervals may survive.
    #[cold]
    #[allow(clippy::too_many_arguments)] // Private, and one step of `merge`.
    fn divide<P: Probe>(
        &mut self,
        store: &mut Store,
        i: usize,
        new: &Window,
        level: u32,
        l: f64,
        merged: &mut Merged,
        weigh: &mut impl FnMut(f64),
        probe: &mut P,
    ) {
        let first = store.ending_by(i, new.b0);
        let stored = &store.windows(i)[first..];
        self.met.clear();
        let behind = stored.iter().map(|w| w.window);
        self.met.extend(behind.take_while(|w| w.b0 < new.b1));
        self.overlap.share_out(&self.met, new, l);
        let segments = self.overlap.segments();
        if !segments.iter().any(|s| s.owner == Owner::New) {
            probe.add(Counter::Filtered, 1);
            return;
        }
        merged.kept += 1;
        self.pieces.clear();
        // The stored windows before this one are done.
        let mut next_old = 0;
        for &Segment { start, end, owner } in segments {
            let (piece, level) = match owner {
                Owner::New => {
                    let piece = StoredWindow::waiting(Window {
                        b0: start,
                        b1: end,
                        ..*new
                    });
                    let label = piece.window.min_distance();
                    weigh(label);
                    merged.least = merged.least.min(label);
                    (piece, level)
                }
                Owner::Old(k) => {
                    let piece = stored[k].cut(start, end);
                    if k < next_old {
                        // A second part of a window whose left part stays, too.
                        if piece.waits() {
                            weigh(piece.window.min_distance());
                            probe.add(Counter::Reinserted, 1);
                        }
                    } else {
                        probe.add(Counter::Filtered, (k - next_old) as u64);
                        next_old = k + 1;
                        if piece.window != stored[k].window {
                            probe.add(Counter::Trimmed, 1);
                        }
                        report_growth(&stored[k], &piece, weigh, probe);
                    }
                    let levels = P::COUNTS.then(|| store.levels(i)[first + k]);
                    (piece, levels.unwrap_or(0))
                }
            };
            self.pieces.windows.push(piece);
            if P::COUNTS {
                self.pieces.levels.push(level);
            }
        }
        let met = self.met.len();
        probe.add(Counter::Filtered, (met - next_old) as u64);
        store.replace(i, first, met, &self.pieces.windows, &self.pieces.levels);
    }
}

/// Reports the new label of a stored window that was cut and whose least distance grew.
#[inline(always)]
fn report_growth<P: Probe>(
    old: &StoredWindow,
    cut: &StoredWindow,
    weigh: &mut impl FnMut(f64),
    probe: &mut P,
) {
    if let Some(label) = old.later(cut) {
        weigh(label);
        probe.add(Counter::Reinserted, 1);
    }
}

/// One pass over a list in ascending order that inserts windows.
///
/// Replaced ranges are collected and copied back at the end. A stored window that loses its left
/// part is cut in place.
struct ListSweep<'a> {
    pieces: &'a mut Replacement,
    windows: &'a mut [StoredWindow],
    levels: &'a [u32],
    /// The first window that the pieces replace.
    base: usize,
    /// The first window that has not been passed; the pieces replace those before it.
    next: usize,
}

impl<'a> ListSweep<'a> {
    /// Starts behind the windows of list `i` that end at `x` or before.
    #[inline(always)]
    fn start(store: &'a mut Store, i: usize, x: f64, pieces: &'a mut Replacement) -> Self {
        let next = store.ending_by(i, x);
        pieces.clear();
        let (windows, levels) = store.windows_and_levels(i);
        Self {
            pieces,
            windows,
            levels,
            base: next,
            next,
        }
    }

    /// Passes the windows that end at `x` or before.
    #[inline(always)]
    fn pass(&mut self, x: f64) {
        while let Some(stored) = self.windows.get(self.next)
            && stored.window.b1 <= x
        {
            if !self.pieces.windows.is_empty() {
                self.pieces.windows.push(*stored);
                self.pieces.levels.extend(self.levels.get(self.next));
            }
            self.next += 1;
        }
    }

    /// Inserts `new`, which begins at or behind the end of the windows passed. Returns true, and
    /// changes nothing, if `new` needs the whole overlap to be [divided](Merger::divide).
    #[inline(always)]
    fn insert<P: Probe>(
        &mut self,
        new: &Window,
        level: u32,
        l: f64,
        merged: &mut Merged,
        weigh: &mut impl FnMut(f64),
        probe: &mut P,
    ) -> bool {
        let behind = self.windows[self.next..].iter().map(|w| &w.window);
        let (start, end) = match OverlapRange::of(behind, new, l) {
            OverlapRange::Empty => {
                probe.add(Counter::Filtered, 1);
                return false;
            }
            OverlapRange::Single(start, end) => (start, end),
            OverlapRange::Undecided => return true,
        };
        self.pass(start);
        if self.pieces.windows.is_empty() {
            self.base = self.next;
        }
        // Number of stored windows that keep a part, and the place of the one that keeps its left
        // part.
        let (mut kept, first) = (0, self.next);
        if let Some(old) = self.windows.get(self.next)
            && old.window.b0 < start
            && !is_sliver(&old.window, old.window.b0, start, l)
        {
            let piece = old.cut(old.window.b0, start);
            report_growth(old, &piece, weigh, probe);
            kept += 1;
            self.pieces.windows.push(piece);
            self.pieces.levels.extend(self.levels.get(first));
        }
        let piece = StoredWindow::waiting(Window {
            b0: start,
            b1: end,
            ..*new
        });
        let label = piece.window.min_distance();
        weigh(label);
        if label < merged.least {
            merged.least = label;
        }
        self.pieces.windows.push(piece);
        if P::COUNTS {
            self.pieces.levels.push(level);
            merged.kept += 1;
        }
        while let Some(old) = self.windows.get(self.next)
            && old.window.b1 <= end
        {
            self.next += 1;
        }
        let mut met = self.next - first;
        if let Some(old) = self.windows.get_mut(self.next)
            && old.window.b0 < end
        {
            met += 1;
            if is_sliver(&old.window, end, old.window.b1, l) {
                self.next += 1;
            } else {
                let piece = old.cut(end, old.window.b1);
                if kept == 1 && self.next == first {
                    // A second part of the window whose left part stays, too.
                    if piece.waits() {
                        weigh(piece.window.min_distance());
                        probe.add(Counter::Reinserted, 1);
                    }
                } else {
                    report_growth(old, &piece, weigh, probe);
                    kept += 1;
                }
                *old = piece;
            }
        }
        probe.add(Counter::Trimmed, kept);
        probe.add(Counter::Filtered, met as u64 - kept);
        false
    }
}

#[cfg(test)]
mod tests;
