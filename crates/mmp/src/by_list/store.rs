//! Where the windows of all half-edges are kept, those of each in one piece.

use geobench_window::{Window, prefetch};

use crate::blocks::{FreeBlocks, GROUP, room, roomier};
use crate::forgetting::Past;

/// A window of a list, in no more than its 40 bytes.
///
/// Whether it waits is told by the side on which its source lies: below the edge, where it belongs,
/// until it has been propagated, and above from then on. The distances on the edge are the same.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stored {
    pub(super) window: Window,
}

impl Stored {
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

    /// A window that is to be propagated.
    #[inline]
    pub(super) fn waiting(window: Window) -> Self {
        let py = -window.py.abs();
        Self {
            window: Window { py, ..window },
        }
    }

    /// It has been propagated.
    #[inline]
    fn settle(&mut self) {
        self.window.py = self.window.py.abs();
    }

    /// Whether it is to be propagated.
    #[inline]
    pub(super) fn waits(&self) -> bool {
        self.window.py.is_sign_negative()
    }

    /// What is left of it between `b0` and `b1`.
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

    /// The label for which `cut`, a part of it, waits, if that is another one than its own.
    #[inline]
    pub(super) fn later(&self, cut: &Self) -> Option<f64> {
        let grows = cut.window.nearest_abscissa() != self.window.nearest_abscissa();
        (grows && self.waits()).then(|| cut.window.min_distance())
    }
}

/// The list of one half-edge: a block in the array of all windows.
#[derive(Clone, Copy, Debug)]
struct List {
    start: u32,
    len: u32,
    /// Size class of its block; 0 without any.
    class: u8,
    /// Whether its windows have been given up.
    closed: bool,
    /// The label under which it is in the queue, which is at most that of any window that waits;
    /// infinite if it is not.
    queued: f64,
}

impl Default for List {
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
/// A list is a block of 4, 8, 12, 16, 24 ... windows of 40 bytes each. Blocks that were given back
/// are the first to be taken again.
#[derive(Clone, Debug, Default)]
pub(super) struct Store {
    lists: Vec<List>,
    windows: Vec<Stored>,
    /// The level in the sequence tree of each window; empty unless it is to be kept.
    levels: Vec<u32>,
    keeps_levels: bool,
    free_blocks: FreeBlocks,
    stored: usize,
    forgotten: usize,
}

impl Store {
    /// Bytes of one stored window.
    pub(super) const WINDOW_BYTES: usize = size_of::<Stored>();

    pub(super) fn new(count: usize) -> Self {
        Self {
            lists: vec![List::default(); count],
            ..Self::default()
        }
    }

    /// Makes all lists empty, for a run that keeps levels or does not.
    pub(super) fn clear(&mut self, keeps_levels: bool) {
        self.lists.fill(List::default());
        self.windows.clear();
        self.levels.clear();
        self.keeps_levels = keeps_levels;
        self.free_blocks.clear();
        (self.stored, self.forgotten) = (0, 0);
    }

    /// Number of windows that are stored.
    pub(super) fn stored(&self) -> usize {
        self.stored
    }

    /// Number of windows that would be stored if none had been given up with its list.
    pub(super) fn stored_in_all(&self) -> usize {
        self.stored + self.forgotten
    }

    /// The windows of list `i`.
    #[inline]
    pub(super) fn windows(&self, i: usize) -> &[Stored] {
        let List { start, len, .. } = self.lists[i];
        &self.windows[start as usize..][..len as usize]
    }

    /// The windows of list `i`, of which each may be cut at its place, and their levels if they are
    /// kept.
    #[inline]
    pub(super) fn windows_and_levels(&mut self, i: usize) -> (&mut [Stored], &[u32]) {
        let List { start, len, .. } = self.lists[i];
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
        let List { start, len, .. } = self.lists[i];
        &self.levels[start as usize..][..len as usize]
    }

    /// All windows that wait.
    pub(super) fn waiting(&self) -> impl Iterator<Item = &Window> {
        let queued = |i: &usize| self.lists[*i].queued < f64::INFINITY;
        let lists = (0..self.lists.len()).filter(queued);
        let waiting = lists.flat_map(|i| self.windows(i)).filter(|w| w.waits());
        waiting.map(|stored| &stored.window)
    }

    /// Number of windows of list `i` that wait.
    pub(super) fn waiting_in(&self, i: usize) -> usize {
        self.windows(i).iter().filter(|w| w.waits()).count()
    }

    /// The label under which list `i` is in the queue; infinite if it is not.
    #[inline]
    pub(super) fn queued(&self, i: usize) -> f64 {
        self.lists[i].queued
    }

    /// List `i` is in the queue under this label.
    #[inline]
    pub(super) fn set_queued(&mut self, i: usize, label: f64) {
        self.lists[i].queued = label;
    }

    /// How many windows of list `i` end at `x` or before.
    #[inline]
    pub(super) fn ending_by(&self, i: usize, x: f64) -> usize {
        let List {
            start, len, class, ..
        } = self.lists[i];
        let len = len as usize;
        if len == 0 {
            return 0;
        }
        let block = &self.windows[start as usize..][..room(class)];
        let mut count = 0;
        // Groups that end before it are passed over, half of what is left at a time.
        let mut groups = len.div_ceil(GROUP);
        while groups > 1 {
            let half = groups / 2;
            let last = count + half * GROUP - 1;
            count += usize::from(block[last].window.b1 <= x) * half * GROUP;
            groups -= half;
        }
        // Of the others all are compared, so that no branch depends on where it is.
        let group = block[count..count + GROUP].iter().zip(count..);
        let ends = group.map(|(w, k)| usize::from(w.window.b1 <= x) & usize::from(k < len));
        count + ends.sum::<usize>()
    }

    /// Copies the windows of list `i` that are due to the end of `taken`, which they leave waiting
    /// no more, and their levels to that of `levels` if they are kept. Returns the least label of
    /// those that still wait.
    #[inline]
    pub(super) fn take(
        &mut self,
        i: usize,
        taken: &mut Vec<Window>,
        levels: &mut Vec<u32>,
        is_due: impl Fn(f64) -> bool,
    ) -> f64 {
        let List { start, len, .. } = self.lists[i];
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

    /// Puts `pieces`, which have these levels if they are kept, in the place of the windows
    /// `first..first + old` of list `i`.
    #[inline]
    pub(super) fn replace(
        &mut self,
        i: usize,
        first: usize,
        old: usize,
        pieces: &[Stored],
        levels: &[u32],
    ) {
        let new = pieces.len();
        if old != new {
            self.resize(i, first, old, new);
        }
        let at = self.lists[i].start as usize + first;
        match (&mut self.windows[at..at + new], pieces) {
            // The most frequent cases, and too little for a call.
            ([place], [piece]) => *place = *piece,
            ([place, next], [piece, other]) => (*place, *next) = (*piece, *other),
            (places, pieces) => places.copy_from_slice(pieces),
        }
        if self.keeps_levels {
            self.levels[at..at + new].copy_from_slice(levels);
        }
    }

    /// Makes room for `new` windows in the place of `old` ones.
    #[inline]
    fn resize(&mut self, i: usize, first: usize, old: usize, new: usize) {
        let List {
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

    /// Gives list `i` a block for `len` windows and returns where it starts. The old one goes to
    /// whoever wants it: it is not written to before the next call.
    #[inline(never)]
    fn relocate(&mut self, i: usize, len: usize) -> usize {
        let List { start, class, .. } = self.lists[i];
        let larger = roomier(class, len);
        let to = self.free_blocks.take(larger).unwrap_or_else(|| {
            let to = self.windows.len();
            self.windows.resize(to + room(larger), Stored::NONE);
            if self.keeps_levels {
                self.levels.resize(self.windows.len(), 0);
            }
            to as u32
        });
        self.free_blocks.give(class, start);
        let list = &mut self.lists[i];
        (list.start, list.class) = (to, larger);
        to as usize
    }

    /// List `i` is likely to be looked at soon: asks for where it is.
    #[inline]
    pub(super) fn announce(&self, i: usize) {
        prefetch(&self.lists, i);
    }

    /// Asks for windows of a list that was [announced](Self::announce) before, those in its middle,
    /// by which a search goes.
    #[inline]
    pub(super) fn prepare(&self, i: usize) {
        let List { start, len, .. } = self.lists[i];
        prefetch(&self.windows, (start + len / 2) as usize);
    }
}

impl Past for Store {
    #[inline]
    fn is_waited_for(&self, i: usize) -> bool {
        self.lists[i].queued < f64::INFINITY
    }

    #[inline]
    fn is_closed(&self, i: usize) -> bool {
        self.lists[i].closed
    }

    fn forget(&mut self, i: usize) {
        let List {
            start, len, class, ..
        } = self.lists[i];
        self.stored -= len as usize;
        self.forgotten += len as usize;
        self.free_blocks.give(class, start);
        self.lists[i] = List {
            closed: true,
            ..List::default()
        };
    }

    fn reopen(&mut self, i: usize) {
        self.lists[i].closed = false;
    }
}

#[cfg(test)]
#[path = "store_tests.rs"]
mod tests;
