//! The windows of all half-edges, those of each contiguous in memory.

use std::ops::Range;

use geobench_window::Window;
use geobench_window::blocks::BlockLists;

use crate::eviction::Evictable;

/// The label under which a list is queued, at most that of any waiting window; infinite if it is
/// not queued.
#[derive(Clone, Copy, Debug)]
struct QueuedLabel(f64);

impl Default for QueuedLabel {
    fn default() -> Self {
        Self(f64::INFINITY)
    }
}

/// The windows of all half-edges. Those of one list are in ascending order and have disjoint
/// intervals; gaps are normal.
///
/// The sign of `py` tells whether a window [waits](waits): the source lies below the edge until the
/// window has been propagated, and is mirrored above it from then on. Distances on the edge are the
/// same.
#[derive(Clone, Debug)]
pub(super) struct Store {
    lists: BlockLists<Window, QueuedLabel>,
    /// The levels in the sequence tree of the windows of each list; empty unless levels are kept.
    levels: Vec<Vec<u32>>,
    evicted: usize,
}

/// `window` as one that waits to be propagated.
#[inline]
pub(super) fn waiting(window: Window) -> Window {
    let py = -window.py.abs();
    Window { py, ..window }
}

/// Whether a stored window waits to be propagated.
#[inline]
pub(super) fn waits(stored: &Window) -> bool {
    stored.py.is_sign_negative()
}

impl Store {
    /// Bytes of one stored window.
    pub(super) const WINDOW_BYTES: usize = size_of::<Window>();

    /// `count` empty lists, followed by `gates` that are evicted at all times.
    pub(super) fn new(count: usize, gates: usize) -> Self {
        Self {
            lists: BlockLists::new(count, gates),
            levels: Vec::new(),
            evicted: 0,
        }
    }

    /// Changes the numbers of lists and gates. All lists are emptied by the next
    /// [`clear`](Self::clear).
    pub(super) fn set_count(&mut self, count: usize, gates: usize) {
        self.lists.set_count(count, gates);
    }

    /// Empties all lists for a new run.
    pub(super) fn clear(&mut self, keeps_levels: bool) {
        self.lists.clear();
        self.levels.clear();
        if keeps_levels {
            self.levels.resize(self.lists.count(), Vec::new());
        }
        self.evicted = 0;
    }

    /// Number of stored windows.
    pub(super) fn stored(&self) -> usize {
        self.lists.stored()
    }

    /// Number of windows that would be stored without eviction.
    pub(super) fn stored_in_all(&self) -> usize {
        self.stored() + self.evicted
    }

    /// The windows of list `i`.
    #[inline]
    pub(super) fn windows(&self, i: usize) -> &[Window] {
        self.lists.entries(i)
    }

    /// The windows of list `i`, to be cut in place.
    #[inline]
    pub(super) fn windows_mut(&mut self, i: usize) -> &mut [Window] {
        self.lists.entries_mut(i).0
    }

    /// The levels of the windows of list `i`, if they are kept.
    pub(super) fn levels(&self, i: usize) -> &[u32] {
        self.levels.get(i).map_or(&[], Vec::as_slice)
    }

    /// All waiting windows, with the numbers of their lists.
    pub(super) fn waiting(&self) -> impl Iterator<Item = (usize, &Window)> {
        let lists = (0..self.lists.count()).filter(|&i| self.queued(i) < f64::INFINITY);
        let windows = lists.flat_map(|i| self.windows(i).iter().map(move |w| (i, w)));
        windows.filter(|(_, w)| waits(w))
    }

    /// Number of waiting windows of list `i`.
    pub(super) fn waiting_in(&self, i: usize) -> usize {
        self.windows(i).iter().filter(|w| waits(w)).count()
    }

    /// The label under which list `i` is queued; infinite if it is not.
    #[inline]
    pub(super) fn queued(&self, i: usize) -> f64 {
        self.lists.note(i).0
    }

    /// Sets the label under which list `i` is queued.
    #[inline]
    pub(super) fn set_queued(&mut self, i: usize, label: f64) {
        self.lists.note_mut(i).0 = label;
    }

    /// How many windows of list `i` end at `x` or before.
    #[inline]
    pub(super) fn ending_by(&self, i: usize, x: f64) -> usize {
        self.lists.leading(i, |w| w.b1 <= x)
    }

    /// Appends the due windows of list `i` to `taken`, and their levels to `levels` if they are
    /// kept; they stay stored and no longer wait. Returns the least label of those that still
    /// wait.
    #[inline]
    pub(super) fn take(
        &mut self,
        i: usize,
        taken: &mut Vec<Window>,
        levels: &mut Vec<u32>,
        is_due: impl Fn(f64) -> bool,
    ) -> f64 {
        let (windows, _) = self.lists.entries_mut(i);
        let mut rest = f64::INFINITY;
        taken.reserve(windows.len());
        for (k, stored) in windows.iter_mut().enumerate() {
            if !waits(stored) {
                continue;
            }
            let label = stored.min_distance();
            if is_due(label) {
                taken.push(*stored);
                stored.py = stored.py.abs();
                levels.extend(self.levels.get(i).map(|levels| levels[k]));
            } else if label < rest {
                rest = label;
            }
        }
        rest
    }

    /// Replaces the windows `old` of list `i` by `pieces`.
    #[inline]
    pub(super) fn replace(&mut self, i: usize, old: Range<usize>, pieces: &[Window]) {
        self.lists.replace(i, old, pieces);
    }

    /// Replaces the levels of the windows `old` of list `i`.
    pub(super) fn replace_levels(&mut self, i: usize, old: Range<usize>, by: Vec<u32>) {
        self.levels[i].splice(old, by);
    }

    /// Prefetches the header of list `i`.
    #[inline]
    pub(super) fn announce(&self, i: usize) {
        self.lists.prefetch_head(i);
    }

    /// Prefetches the middle windows of a list that was [announced](Self::announce) before; a
    /// search starts there.
    #[inline]
    pub(super) fn prepare(&self, i: usize) {
        (self.lists).prefetch_entries(i, |len| std::iter::once(len / 2));
    }
}

impl Evictable for Store {
    #[inline]
    fn is_waited_for(&self, i: usize) -> bool {
        self.queued(i) < f64::INFINITY
    }

    #[inline]
    fn is_evicted(&self, i: usize) -> bool {
        self.lists.is_closed(i)
    }

    fn evict(&mut self, i: usize) {
        self.evicted += self.lists.len(i);
        self.lists.remove_all(i, true);
        if let Some(levels) = self.levels.get_mut(i) {
            levels.clear();
        }
    }

    fn reopen(&mut self, i: usize) {
        self.lists.open(i);
    }
}

#[cfg(test)]
mod tests;
