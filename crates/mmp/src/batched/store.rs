//! The windows of all half-edges, those of each contiguous in memory.

use geobench_window::blocks::{FreeBlocks, GROUP, larger_class, room};
use geobench_window::{Window, prefetch};

use crate::eviction::Evictable;

/// A window of a list, in 40 bytes.
///
/// The sign of `py` tells whether it waits: the source lies below the edge until the window has
/// been propagated, and is mirrored above it from then on. Distances on the edge are the same.
#[derive(Clone, Copy, Debug)]
pub(super) struct StoredWindow {
    pub(super) window: Window,
}

impl StoredWindow {
    /// Fills unused room.
    const NONE: Self = Self {
        window: Window {
            b0: 0.0,
            b1: 0.0,
            px: 0.0,
            py: 0.0,
            sigma: 0.0,
        },
    };

    /// A window that waits to be propagated.
    #[inline]
    pub(super) fn waiting(window: Window) -> Self {
        let py = -window.py.abs();
        Self {
            window: Window { py, ..window },
        }
    }

    /// Marks it as propagated.
    #[inline]
    fn settle(&mut self) {
        self.window.py = self.window.py.abs();
    }

    /// Whether it waits to be propagated.
    #[inline]
    pub(super) fn waits(&self) -> bool {
        self.window.py.is_sign_negative()
    }

    /// Its part between `b0` and `b1`.
    #[inline]
    pub(super) fn cut(&self, b0: f64, b1: f64) -> Self {
        Self {
            window: Window {
                b0,
                b1,
                ..self.window
            },
        }
    }

    /// The label of `cut`, a part of it, if it waits and the label differs from its own.
    #[inline]
    pub(super) fn later(&self, cut: &Self) -> Option<f64> {
        let grows = cut.window.nearest_abscissa() != self.window.nearest_abscissa();
        (grows && self.waits()).then(|| cut.window.min_distance())
    }
}

/// The list of one half-edge: a block in the array of all windows.
#[derive(Clone, Copy, Debug)]
struct ListBlock {
    start: u32,
    len: u32,
    /// Size class of its block; 0 without any.
    class: u8,
    /// Whether its windows have been evicted.
    closed: bool,
    /// The label under which it is queued, at most that of any waiting window; infinite if it is
    /// not queued.
    queued: f64,
}

impl Default for ListBlock {
    fn default() -> Self {
        Self {
            start: 0,
            len: 0,
            class: 0,
            closed: false,
            queued: f64::INFINITY,
        }
    }
}

/// The windows of all half-edges. Those of one list are in ascending order and have disjoint
/// intervals; gaps are normal.
///
/// A list is a block of 4, 8, 12, 16, 24 ... windows of 40 bytes each. Freed blocks are reused
/// first.
#[derive(Clone, Debug, Default)]
pub(super) struct Store {
    lists: Vec<ListBlock>,
    first_gate: usize,
    windows: Vec<StoredWindow>,
    /// The level in the sequence tree of each window; empty unless levels are kept.
    levels: Vec<u32>,
    keeps_levels: bool,
    free_blocks: FreeBlocks,
    stored: usize,
    evicted: usize,
}

impl Store {
    /// Bytes of one stored window.
    pub(super) const WINDOW_BYTES: usize = size_of::<StoredWindow>();

    /// `count` empty lists, followed by `gates` that are evicted at all times.
    pub(super) fn new(count: usize, gates: usize) -> Self {
        let mut store = Self {
            lists: vec![ListBlock::default(); count + gates],
            first_gate: count,
            ..Self::default()
        };
        store.clear(false);
        store
    }

    /// Changes the numbers of lists and gates. All lists are emptied by the next
    /// [`clear`](Self::clear).
    pub(super) fn set_count(&mut self, count: usize, gates: usize) {
        self.lists.resize(count + gates, ListBlock::default());
        self.first_gate = count;
    }

    /// Empties all lists for a new run.
    pub(super) fn clear(&mut self, keeps_levels: bool) {
        self.lists.fill(ListBlock::default());
        for gate in &mut self.lists[self.first_gate..] {
            gate.closed = true;
        }
        self.windows.clear();
        self.levels.clear();
        self.keeps_levels = keeps_levels;
        self.free_blocks.clear();
        (self.stored, self.evicted) = (0, 0);
    }

    /// Number of stored windows.
    pub(super) fn stored(&self) -> usize {
        self.stored
    }

    /// Number of windows that would be stored without eviction.
    pub(super) fn stored_in_all(&self) -> usize {
        self.stored + self.evicted
    }

    /// The windows of list `i`.
    #[inline]
    pub(super) fn windows(&self, i: usize) -> &[StoredWindow] {
        let ListBlock { start, len, .. } = self.lists[i];
        &self.windows[start as usize..][..len as usize]
    }

    /// The windows of list `i`, to be cut in place, and their levels if they are kept.
    #[inline]
    pub(super) fn windows_and_levels(&mut self, i: usize) -> (&mut [StoredWindow], &[u32]) {
        let ListBlock { start, len, .. } = self.lists[i];
        let block = start as usize..(start + len) as usize;
        let levels = if self.keeps_levels {
            &self.levels[block.clone()]
        } else {
            &[]
        };
        (&mut self.windows[block], levels)
    }

    /// The levels of the windows of list `i`, if they are kept.
    pub(super) fn levels(&self, i: usize) -> &[u32] {
        let ListBlock { start, len, .. } = self.lists[i];
        &self.levels[start as usize..][..len as usize]
    }

    /// All waiting windows.
    pub(super) fn waiting(&self) -> impl Iterator<Item = &Window> {
        let queued = |i: &usize| self.lists[*i].queued < f64::INFINITY;
        let lists = (0..self.lists.len()).filter(queued);
        let waiting = lists.flat_map(|i| self.windows(i)).filter(|w| w.waits());
        waiting.map(|stored| &stored.window)
    }

    /// Number of waiting windows of list `i`.
    pub(super) fn waiting_in(&self, i: usize) -> usize {
        self.windows(i).iter().filter(|w| w.waits()).count()
    }

    /// The label under which list `i` is queued; infinite if it is not.
    #[inline]
    pub(super) fn queued(&self, i: usize) -> f64 {
        self.lists[i].queued
    }

    /// Sets the label under which list `i` is queued.
    #[inline]
    pub(super) fn set_queued(&mut self, i: usize, label: f64) {
        self.lists[i].queued = label;
    }

    /// How many windows of list `i` end at `x` or before.
    #[inline]
    pub(super) fn ending_by(&self, i: usize, x: f64) -> usize {
        let ListBlock {
            start, len, class, ..
        } = self.lists[i];
        let len = len as usize;
        if len == 0 {
            return 0;
        }
        let block = &self.windows[start as usize..][..room(class)];
        let mut count = 0;
        // Binary search over groups.
        let mut groups = len.div_ceil(GROUP);
        while groups > 1 {
            let half = groups / 2;
            let last = count + half * GROUP - 1;
            count += usize::from(block[last].window.b1 <= x) * half * GROUP;
            groups -= half;
        }
        // Branch-free count within the group.
        let group = block[count..count + GROUP].iter().zip(count..);
        let ends = group.map(|(w, k)| usize::from(w.window.b1 <= x) & usize::from(k < len));
        count + ends.sum::<usize>()
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
        let ListBlock { start, len, .. } = self.lists[i];
        let block = start as usize..(start + len) as usize;
        let mut rest = f64::INFINITY;
        taken.reserve(len as usize);
        for (stored, k) in self.windows[block.clone()].iter_mut().zip(block) {
            if !stored.waits() {
                continue;
            }
            let label = stored.window.min_distance();
            if is_due(label) {
                taken.push(stored.window);
                stored.settle();
                if self.keeps_levels {
                    levels.push(self.levels[k]);
                }
            } else if label < rest {
                rest = label;
            }
        }
        rest
    }

    /// Replaces the windows `first..first + old` of list `i` by `pieces`, with these levels if they
    /// are kept.
    #[inline]
    pub(super) fn replace(
        &mut self,
        i: usize,
        first: usize,
        old: usize,
        pieces: &[StoredWindow],
        levels: &[u32],
    ) {
        let new = pieces.len();
        if old != new {
            self.resize(i, first, old, new);
        }
        let at = self.lists[i].start as usize + first;
        match (&mut self.windows[at..at + new], pieces) {
            // The most frequent cases, too short for a call.
            ([place], [piece]) => *place = *piece,
            ([place, next], [piece, other]) => (*place, *next) = (*piece, *other),
            (places, pieces) => places.copy_from_slice(pieces),
        }
        if self.keeps_levels {
            self.levels[at..at + new].copy_from_slice(levels);
        }
    }

    /// Resizes the range of `old` windows to `new`.
    #[inline]
    fn resize(&mut self, i: usize, first: usize, old: usize, new: usize) {
        let ListBlock {
            start, len, class, ..
        } = self.lists[i];
        let (start, len) = (start as usize, len as usize);
        let longer = len - old + new;
        let behind = start + first + old..start + len;
        if longer > room(class) {
            let to = self.relocate(i, longer);
            self.copy(start..start + first, to);
            self.copy(behind, to + first + new);
        } else {
            self.copy(behind, start + first + new);
        }
        self.stored = self.stored + new - old;
        self.lists[i].len = longer as u32;
    }

    /// Copies windows from one place to another.
    #[inline]
    fn copy(&mut self, from: std::ops::Range<usize>, to: usize) {
        if from.is_empty() {
            return;
        }
        if self.keeps_levels {
            self.levels.copy_within(from.clone(), to);
        }
        self.windows.copy_within(from, to);
    }

    /// Moves list `i` to a block for `len` windows and returns where it starts. The old block is
    /// freed, but not written to before the next call.
    #[inline(never)]
    fn relocate(&mut self, i: usize, len: usize) -> usize {
        let ListBlock { start, class, .. } = self.lists[i];
        let larger = larger_class(class, len);
        let to = self
            .free_blocks
            .take(larger, &mut self.windows, StoredWindow::NONE);
        if self.keeps_levels {
            self.levels.resize(self.windows.len(), 0);
        }
        self.free_blocks.give(class, start);
        let list = &mut self.lists[i];
        (list.start, list.class) = (to, larger);
        to as usize
    }

    /// Prefetches the header of list `i`.
    #[inline]
    pub(super) fn announce(&self, i: usize) {
        prefetch(&self.lists, i);
    }

    /// Prefetches the middle windows of a list that was [announced](Self::announce) before; a
    /// search starts there.
    #[inline]
    pub(super) fn prepare(&self, i: usize) {
        let ListBlock { start, len, .. } = self.lists[i];
        prefetch(&self.windows, (start + len / 2) as usize);
    }
}

impl Evictable for Store {
    #[inline]
    fn is_waited_for(&self, i: usize) -> bool {
        self.lists[i].queued < f64::INFINITY
    }

    #[inline]
    fn is_evicted(&self, i: usize) -> bool {
        self.lists[i].closed
    }

    fn evict(&mut self, i: usize) {
        let ListBlock {
            start, len, class, ..
        } = self.lists[i];
        self.stored -= len as usize;
        self.evicted += len as usize;
        self.free_blocks.give(class, start);
        self.lists[i] = ListBlock {
            closed: true,
            ..ListBlock::default()
        };
    }

    fn reopen(&mut self, i: usize) {
        self.lists[i].closed = false;
    }
}

#[cfg(test)]
mod tests;
