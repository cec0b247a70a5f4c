//! The windows of all half-edges, found by slot or by list.

use geobench_window::blocks::{FreeBlocks, GROUP, larger_class, number, room};
use geobench_window::continuous::Dequeued;
use geobench_window::{Window, prefetch};

use crate::eviction::Evictable;

/// Which way a window crosses the edge of its list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    /// From below the edge to above it, as in the frame of a window of its own half-edge.
    Forward,
    /// The other way, from a source above the edge.
    Reverse,
}

/// The number of a window, by which lists and the queue refer to it. It stays the same while the
/// window is stored, also when its interval is cut.
pub(crate) type Slot = u32;

/// Flags of the window in a slot.
#[derive(Clone, Copy, Debug, Default)]
struct SlotFlags(u8);

impl SlotFlags {
    /// It waits in the queue, where it has exactly one event.
    const WAITS: u8 = 1;
    /// Its least distance has grown since it was queued.
    const OUTDATED: u8 = 2;
    /// It was removed while it waited. The slot is free once its event has come out of the queue.
    const GONE: u8 = 4;
    /// It travels against the half-edge whose frame its list uses.
    const REVERSED: u8 = 8;

    #[inline]
    fn has(self, flag: u8) -> bool {
        self.0 & flag != 0
    }
}

/// A window of a list, with the key that a search compares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ListEntry {
    /// Where the window is.
    pub(crate) slot: Slot,
    /// The [key](end_key) of its right end.
    end: u32,
}

impl ListEntry {
    /// A place without a window, behind all others.
    const NONE: Self = Self {
        slot: 0,
        end: u32::MAX,
    };
}

/// The upper 32 bits of an abscissa that is not negative. Keys have the order of the abscissae up
/// to a millionth.
#[inline]
fn end_key(x: f64) -> u32 {
    (x.to_bits() >> 32) as u32
}

/// The list of one half-edge: a block in the array of all places.
#[derive(Clone, Copy, Debug, Default)]
struct ListHead {
    start: u32,
    len: u32,
    /// Number of its windows that wait in the queue.
    waiting: u32,
    /// Size class of its block; 0 without any.
    class: u8,
    /// Whether its windows have been evicted.
    closed: bool,
}

/// The windows of all half-edges, or of all edges in the frame of one of their half-edges. Those of
/// one list are in ascending order and have disjoint intervals; gaps are normal.
///
/// A list is a block of 4, 8, 12, 16, 24, 32, 48 ... places of 8 bytes. An insertion moves places,
/// not windows, and the queue reaches a window by its slot. A search reads the places only: their
/// keys give the right ends to a millionth, and the windows that the new one may overlap are read
/// afterwards. Freed slots and blocks are reused first.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lists {
    heads: Vec<ListHead>,
    first_gate: usize,
    places: Vec<ListEntry>,
    free_blocks: FreeBlocks,
    windows: Vec<Window>,
    states: Vec<SlotFlags>,
    free: Vec<Slot>,
    waiting: usize,
    stored: usize,
}

/// Fewer places than this are moved one by one.
const SHORT: usize = 8;

impl Lists {
    /// Bytes of one stored window.
    pub(crate) const WINDOW_BYTES: usize = size_of::<Window>();

    /// `count` empty lists, followed by `gates` that are evicted at all times.
    pub(crate) fn new(count: usize, gates: usize) -> Self {
        let mut lists = Self {
            heads: vec![ListHead::default(); count + gates],
            first_gate: count,
            ..Self::default()
        };
        lists.clear();
        lists
    }

    /// Changes the numbers of lists and gates. The next [`clear`](Self::clear) makes all lists
    /// empty.
    pub(crate) fn set_count(&mut self, count: usize, gates: usize) {
        self.heads.resize(count + gates, ListHead::default());
        self.first_gate = count;
    }

    /// Makes all lists empty.
    pub(crate) fn clear(&mut self) {
        self.heads.fill(ListHead::default());
        for gate in &mut self.heads[self.first_gate..] {
            gate.closed = true;
        }
        self.clear_windows();
    }

    /// Makes all lists empty, of which no others than `lists` hold windows.
    pub(crate) fn clear_at(&mut self, lists: impl Iterator<Item = usize>) {
        for i in lists {
            self.heads[i] = ListHead::default();
        }
        self.clear_windows();
    }

    fn clear_windows(&mut self) {
        self.places.clear();
        self.free_blocks.clear();
        self.windows.clear();
        self.states.clear();
        self.free.clear();
        (self.waiting, self.stored) = (0, 0);
    }

    /// Number of windows that wait in the queue.
    pub(crate) fn waiting(&self) -> usize {
        self.waiting
    }

    /// Number of windows that are stored.
    pub(crate) fn stored(&self) -> usize {
        self.stored
    }

    /// Number of windows in list `i`.
    #[inline]
    pub(crate) fn len(&self, i: usize) -> usize {
        self.heads[i].len as usize
    }

    /// The windows of list `i`, by their slots.
    #[inline]
    pub(crate) fn places(&self, i: usize) -> &[ListEntry] {
        let ListHead { start, len, .. } = self.heads[i];
        &self.places[start as usize..][..len as usize]
    }

    /// A lower bound of the number of windows of list `i` that end before `x`. Ends within a
    /// millionth of `x` may not be counted.
    #[inline]
    pub(crate) fn ending_before(&self, i: usize, x: f64) -> usize {
        let ListHead {
            start, len, class, ..
        } = self.heads[i];
        let block = &self.places[start as usize..][..room(class)];
        let key = end_key(x);
        let mut count = 0;
        // Binary search over groups.
        let mut groups = len as usize / GROUP;
        while groups > 1 {
            let half = groups / 2;
            let last = count + half * GROUP - 1;
            count += usize::from(block[last].end < key) * half * GROUP;
            groups -= half;
        }
        // Branch-free counts within the last groups.
        for group in block[count..].chunks_exact(GROUP) {
            let before = group.iter().map(|place| u32::from(place.end < key));
            let before = before.sum::<u32>() as usize;
            count += before;
            if before < GROUP {
                break;
            }
        }
        count
    }

    /// All windows by slot, free slots included.
    #[inline]
    pub(crate) fn windows(&self) -> &[Window] {
        &self.windows
    }

    /// The direction in which the window crosses its edge.
    #[inline]
    pub(crate) fn direction(&self, slot: Slot) -> Direction {
        if self.states[slot as usize].has(SlotFlags::REVERSED) {
            Direction::Reverse
        } else {
            Direction::Forward
        }
    }

    /// Whether the window waits in the queue.
    #[inline]
    pub(crate) fn waits(&self, slot: Slot) -> bool {
        self.states[slot as usize].has(SlotFlags::WAITS)
    }

    /// Takes a window of list `i` whose event came out of the queue. The window stays stored and no
    /// longer waits, unless its least distance has grown.
    #[inline(always)] // Keeps the window in registers on its way to its crossing.
    #[allow(clippy::inline_always)] // Called for every window, and small.
    pub(crate) fn take(&mut self, i: usize, slot: Slot) -> Dequeued<()> {
        let state = &mut self.states[slot as usize];
        if state.has(SlotFlags::GONE) {
            self.free.push(slot);
            return Dequeued::Stale;
        }
        let window = self.windows[slot as usize];
        if state.has(SlotFlags::OUTDATED) {
            state.0 &= !SlotFlags::OUTDATED;
            return Dequeued::Requeue(window.min_distance());
        }
        state.0 &= !SlotFlags::WAITS;
        self.heads[i].waiting -= 1;
        self.waiting -= 1;
        Dequeued::Propagate(window, ())
    }

    /// Stores a window of list `i` in a slot, which the caller puts into the list.
    #[inline]
    pub(crate) fn store(
        &mut self,
        i: usize,
        window: Window,
        direction: Direction,
        waits: bool,
    ) -> Slot {
        let mut state = SlotFlags::default();
        if direction == Direction::Reverse {
            state.0 |= SlotFlags::REVERSED;
        }
        if waits {
            state.0 |= SlotFlags::WAITS;
            self.heads[i].waiting += 1;
            self.waiting += 1;
        }
        self.stored += 1;
        if let Some(slot) = self.free.pop() {
            self.windows[slot as usize] = window;
            self.states[slot as usize] = state;
            slot
        } else {
            self.windows.push(window);
            self.states.push(state);
            number(self.windows.len() - 1)
        }
    }

    /// Cuts window `k` of list `i` down to `b0..b1`. Returns whether it waits and its least
    /// distance has grown.
    #[inline]
    pub(crate) fn cut(&mut self, i: usize, k: usize, b0: f64, b1: f64) -> bool {
        let place = &mut self.places[self.heads[i].start as usize + k];
        place.end = end_key(b1);
        let slot = place.slot;
        let window = &mut self.windows[slot as usize];
        let nearest = window.nearest_abscissa();
        (window.b0, window.b1) = (b0, b1);
        let state = &mut self.states[slot as usize];
        let grows = window.nearest_abscissa() != nearest && state.has(SlotFlags::WAITS);
        if grows {
            state.0 |= SlotFlags::OUTDATED;
        }
        grows
    }

    /// Removes a window of list `i`; the caller takes its slot out of the list.
    #[inline]
    pub(crate) fn remove(&mut self, i: usize, slot: Slot) {
        self.stored -= 1;
        let state = &mut self.states[slot as usize];
        if state.has(SlotFlags::WAITS) {
            state.0 = SlotFlags::GONE;
            self.heads[i].waiting -= 1;
            self.waiting -= 1;
        } else {
            self.free.push(slot);
        }
    }

    /// Replaces the slots `first..first + old` of list `i` by `new`.
    #[inline]
    pub(crate) fn replace(&mut self, i: usize, first: usize, old: usize, new: &[Slot]) {
        if old != new.len() {
            self.resize(i, first, old, new.len());
        }
        let start = self.heads[i].start as usize + first;
        for (to, &slot) in self.places[start..start + new.len()].iter_mut().zip(new) {
            let end = end_key(self.windows[slot as usize].b1);
            *to = ListEntry { slot, end };
        }
    }

    /// Makes room for `new` slots in the place of `old` ones.
    #[inline]
    fn resize(&mut self, i: usize, first: usize, old: usize, new: usize) {
        let ListHead {
            start, len, class, ..
        } = self.heads[i];
        let (start, len) = (start as usize, len as usize);
        let longer = len - old + new;
        let behind = start + first + old..start + len;
        if longer > room(class) {
            let to = self.relocate(i, longer);
            // Often empty; then no call is needed.
            if first > 0 {
                self.places.copy_within(start..start + first, to);
            }
            if !behind.is_empty() {
                self.places.copy_within(behind, to + first + new);
            }
        } else {
            let to = start + first + new;
            if new == old + 1 && behind.len() < SHORT {
                // The most frequent case, too short for a call.
                let places = &mut self.places[behind.start..=behind.end];
                for k in (1..places.len()).rev() {
                    places[k] = places[k - 1];
                }
            } else {
                self.places.copy_within(behind, to);
                if longer < len {
                    self.places[start + longer..start + len].fill(ListEntry::NONE);
                }
            }
        }
        self.heads[i].len = longer as u32;
    }

    /// Moves list `i` to a block for `len` places and returns where it starts. The old block is
    /// freed, but not written to before the next call.
    #[inline(never)]
    fn relocate(&mut self, i: usize, len: usize) -> usize {
        let ListHead { start, class, .. } = self.heads[i];
        let larger = larger_class(class, len);
        let to = self
            .free_blocks
            .take(larger, &mut self.places, ListEntry::NONE);
        self.places[to as usize + len..][..room(larger) - len].fill(ListEntry::NONE);
        self.free_blocks.give(class, start);
        let list = &mut self.heads[i];
        (list.start, list.class) = (to, larger);
        to as usize
    }

    /// Prefetches what [`take`](Self::take) reads.
    #[inline]
    pub(crate) fn announce(&self, i: usize, slot: Slot) {
        prefetch(&self.windows, slot as usize);
        prefetch(&self.states, slot as usize);
        prefetch(&self.heads, i);
    }
}

impl Evictable for Lists {
    #[inline]
    fn is_waited_for(&self, i: usize) -> bool {
        self.heads[i].waiting > 0
    }

    #[inline]
    fn is_evicted(&self, i: usize) -> bool {
        self.heads[i].closed
    }

    fn evict(&mut self, i: usize) {
        let ListHead {
            start, len, class, ..
        } = self.heads[i];
        let places = &self.places[start as usize..][..len as usize];
        self.stored -= places.len();
        self.free.extend(places.iter().map(|place| place.slot));
        self.free_blocks.give(class, start);
        self.heads[i] = ListHead {
            closed: true,
            ..ListHead::default()
        };
    }

    fn reopen(&mut self, i: usize) {
        self.heads[i].closed = false;
    }
}

#[cfg(test)]
mod tests;
