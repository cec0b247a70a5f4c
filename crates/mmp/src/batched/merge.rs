//! Merges the windows that arrive together into a list: sorted, disjoint, trimmed at tie points.

use std::ops::Range;

use geobench_window::trimming::{PieceOrigin, TrimmedList, Trimmer, closing_gaps, is_near, pieces};
use geobench_window::{Counter, Probe, Window};

use super::store::{Store, waiting, waits};

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

    /// The same windows, those whose source [`is_near`] in [`pieces`]. They arrive at a list with
    /// the windows `stored`.
    #[cold]
    fn in_pieces(&self, l: f64, stored: &[Window]) -> Self {
        let mut batch = Self::default();
        for (k, w) in self.windows.iter().enumerate() {
            let w = closing_gaps(w, l, &self.windows);
            for piece in pieces(&w, l, stored) {
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
    trimmer: Trimmer<Window>,
}

impl Merger {
    /// Merges `batch` into list `i`, whose edge has length `l`. Calls `weigh` with the label of
    /// every window that now waits under a new label: the surviving new windows, and trimmed stored
    /// ones whose least distance grew.
    ///
    /// A pass over the list takes O(log k + m) for m windows met among k, and moves those behind
    /// them.
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
        let has_near = batch.windows.iter().any(|w| is_near(w, l));
        let all = if has_near {
            apart = batch.in_pieces(l, store.windows(i));
            &apart
        } else {
            batch
        };
        let (mut k, mut dropped) = (0, 0);
        while let Some(new) = all.windows.get(k) {
            let first = store.ending_by(i, new.b0);
            let mut arrivals = BatchArrivals {
                windows: store.windows_mut(i),
                batch: all,
                least: &mut merged.least,
                dropped: &mut dropped,
                weigh,
                probe,
            };
            let (old, next) = self.trimmer.insert(&mut arrivals, first, k, l);
            if P::COUNTS {
                self.replace_levels(store, i, old.clone(), &all.levels);
            }
            store.replace(i, old, self.trimmer.pieces());
            k = next;
        }
        // Several pieces of one window may survive.
        let survivors = all.windows.len() - dropped;
        merged.kept = survivors.min(batch.windows.len()) as u64;
        merged
    }

    /// Replaces the levels of the windows `old` of list `i` by those of the pieces; `new` are those
    /// of the new windows.
    fn replace_levels(&self, store: &mut Store, i: usize, old: Range<usize>, new: &[u32]) {
        let level = |origin: &PieceOrigin| match *origin {
            PieceOrigin::New(k) => new[k],
            PieceOrigin::Old(k) => store.levels(i)[k],
        };
        let levels = self.trimmer.origins().iter().map(level).collect();
        store.replace_levels(i, old, levels);
    }
}

/// The arrival of a batch at a list.
struct BatchArrivals<'a, F, P> {
    windows: &'a mut [Window],
    batch: &'a Batch,
    /// The least distance of the surviving new windows.
    least: &'a mut f64,
    /// Number of new windows that do not survive. Counted runs only.
    dropped: &'a mut usize,
    weigh: &'a mut F,
    probe: &'a mut P,
}

impl<F: FnMut(f64), P: Probe> TrimmedList for BatchArrivals<'_, F, P> {
    type Entry = Window;

    const RECORDS_ORIGINS: bool = P::COUNTS;

    #[inline]
    fn entries(&self) -> &[Window] {
        self.windows
    }

    #[inline]
    fn entries_mut(&mut self) -> &mut [Window] {
        self.windows
    }

    #[inline]
    fn window<'a>(&'a self, entry: &'a Window) -> &'a Window {
        entry
    }

    #[inline]
    fn arriving(&self, k: usize) -> Option<Window> {
        self.batch.windows.get(k).copied()
    }

    #[inline]
    fn keep(&mut self, _: usize, part: Window) -> Window {
        let label = part.min_distance();
        (self.weigh)(label);
        if label < *self.least {
            *self.least = label;
        }
        waiting(part)
    }

    #[inline]
    fn drop_new(&mut self, _: usize) {
        self.probe.add(Counter::Filtered, 1);
        if P::COUNTS {
            *self.dropped += 1;
        }
    }

    #[inline]
    fn cut(&mut self, old: &Window, b0: f64, b1: f64) -> Window {
        self.probe.add(Counter::Trimmed, 1);
        let part = old.cut(b0, b1);
        if waits(old) && part.nearest_abscissa() != old.nearest_abscissa() {
            (self.weigh)(part.min_distance());
            self.probe.add(Counter::Reinserted, 1);
        }
        part
    }

    #[inline]
    fn split(&mut self, old: &Window, b0: f64, b1: f64) -> Window {
        let part = old.cut(b0, b1);
        if waits(old) {
            (self.weigh)(part.min_distance());
            self.probe.add(Counter::Reinserted, 1);
        }
        part
    }

    #[inline]
    fn remove(&mut self, _: &Window) {
        self.probe.add(Counter::Filtered, 1);
    }
}

#[cfg(test)]
mod tests;
