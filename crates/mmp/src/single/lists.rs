//! The windows of all half-edges, found by slot or by list.

use std::ops::Range;

use geobench_window::blocks::{BlockLists, number};
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

impl Direction {
    /// A window of an edge of length `l` in the frame of the half-edge by which it crosses, or one
    /// of that half-edge in the frame of the edge.
    #[inline]
    pub(crate) fn turned(self, window: &Window, l: f64) -> Window {
        match self {
            Self::Forward => *window,
            Self::Reverse => window.reversed(l),
        }
    }
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct ListEntry {
    /// Where the window is.
    pub(crate) slot: Slot,
    /// The [key](end_key) of its right end.
    end: u32,
}

/// The upper 32 bits of an abscissa that is not negative. Keys have the order of the abscissae up
/// to a millionth.
#[inline]
fn end_key(x: f64) -> u32 {
    (x.to_bits() >> 32) as u32
}

/// The windows of all half-edges, or of all edges in the frame of one of their half-edges. Those of
/// one list are in ascending order and have disjoint intervals; gaps are normal.
///
/// A list holds 8 bytes for each window. An insertion moves these, not windows, and the queue
/// reaches a window by its slot. A search reads the lists only: their keys give the right ends to a
/// millionth, and the windows that the new one may overlap are read afterwards.
#[derive(Clone, Debug)]
pub(crate) struct Lists {
    /// The note is the number of windows that wait in the queue.
    places: BlockLists<ListEntry, u32>,
    slots: Slots,
}

/// All windows by slot. Freed slots are reused first.
#[derive(Clone, Debug, Default)]
pub(super) struct Slots {
    windows: Vec<Window>,
    states: Vec<SlotFlags>,
    free: Vec<Slot>,
    waiting: usize,
}

impl Lists {
    /// Bytes of one stored window.
    pub(crate) const WINDOW_BYTES: usize = size_of::<Window>();

    /// `count` empty lists, followed by `gates` that are evicted at all times.
    pub(crate) fn new(count: usize, gates: usize) -> Self {
        Self {
            places: BlockLists::new(count, gates),
            slots: Slots::default(),
        }
    }

    /// Changes the numbers of lists and gates. The next [`clear`](Self::clear) makes all lists
    /// empty.
    pub(crate) fn set_count(&mut self, count: usize, gates: usize) {
        self.places.set_count(count, gates);
    }

    /// Makes all lists empty.
    pub(crate) fn clear(&mut self) {
        self.places.clear();
        self.slots.clear();
    }

    /// Makes all lists empty, of which no others than `lists` hold windows.
    pub(crate) fn clear_at(&mut self, lists: impl Iterator<Item = usize>) {
        self.places.clear_at(lists);
        self.slots.clear();
    }

    /// Number of windows that wait in the queue.
    pub(crate) fn waiting(&self) -> usize {
        self.slots.waiting
    }

    /// Number of windows that are stored.
    pub(crate) fn stored(&self) -> usize {
        self.places.stored()
    }

    /// Number of windows in list `i`.
    #[inline]
    pub(crate) fn len(&self, i: usize) -> usize {
        self.places.len(i)
    }

    /// The windows of list `i`, by their slots.
    #[inline]
    pub(crate) fn places(&self, i: usize) -> &[ListEntry] {
        self.places.entries(i)
    }

    /// The windows of list `i` by their slots, how many of them wait, and all windows.
    #[inline]
    pub(super) fn parts(&mut self, i: usize) -> (&mut [ListEntry], &mut u32, &mut Slots) {
        let (places, waiting) = self.places.entries_mut(i);
        (places, waiting, &mut self.slots)
    }

    /// A lower bound of the number of windows of list `i` that end before `x`. Ends within a
    /// millionth of `x` may not be counted.
    #[inline]
    pub(crate) fn ending_before(&self, i: usize, x: f64) -> usize {
        let key = end_key(x);
        self.places.leading(i, |place| place.end < key)
    }

    /// Replaces the windows `old` of list `i` by `new`.
    #[inline]
    pub(super) fn replace(&mut self, i: usize, old: Range<usize>, new: &[ListEntry]) {
        self.places.replace(i, old, new);
    }

    /// All windows by slot, free slots included.
    #[inline]
    pub(crate) fn windows(&self) -> &[Window] {
        &self.slots.windows
    }

    /// The direction in which the window crosses its edge.
    #[inline]
    pub(crate) fn direction(&self, slot: Slot) -> Direction {
        self.slots.direction(slot)
    }

    /// Whether the window waits in the queue.
    #[inline]
    pub(crate) fn waits(&self, slot: Slot) -> bool {
        self.slots.waits(slot)
    }

    /// Takes a window of list `i` whose event came out of the queue. The window stays stored and no
    /// longer waits, unless its least distance has grown.
    #[inline(always)] // Keeps the window in registers on its way to its crossing.
    #[allow(clippy::inline_always)] // Called for every window, and small.
    pub(crate) fn take(&mut self, i: usize, slot: Slot) -> Dequeued<()> {
        let slots = &mut self.slots;
        let state = &mut slots.states[slot as usize];
        if state.has(SlotFlags::GONE) {
            slots.free.push(slot);
            return Dequeued::Stale;
        }
        let window = slots.windows[slot as usize];
        if state.has(SlotFlags::OUTDATED) {
            state.0 &= !SlotFlags::OUTDATED;
            return Dequeued::Requeue(window.min_distance());
        }
        state.0 &= !SlotFlags::WAITS;
        slots.waiting -= 1;
        *self.places.note_mut(i) -= 1;
        Dequeued::Propagate(window, ())
    }

    /// Prefetches what [`take`](Self::take) reads.
    #[inline]
    pub(crate) fn announce(&self, i: usize, slot: Slot) {
        prefetch(&self.slots.windows, slot as usize);
        prefetch(&self.slots.states, slot as usize);
        self.places.prefetch_head(i);
    }
}

impl Slots {
    fn clear(&mut self) {
        self.windows.clear();
        self.states.clear();
        self.free.clear();
        self.waiting = 0;
    }

    /// The window in `slot`.
    #[inline]
    pub(super) fn window(&self, slot: Slot) -> &Window {
        &self.windows[slot as usize]
    }

    #[inline]
    pub(super) fn direction(&self, slot: Slot) -> Direction {
        if self.states[slot as usize].has(SlotFlags::REVERSED) {
            Direction::Reverse
        } else {
            Direction::Forward
        }
    }

    #[inline]
    pub(super) fn waits(&self, slot: Slot) -> bool {
        self.states[slot as usize].has(SlotFlags::WAITS)
    }

    /// Stores a window; `waiting` is the number of windows of its list that wait.
    #[inline]
    pub(super) fn store(
        &mut self,
        window: Window,
        direction: Direction,
        waits: bool,
        waiting: &mut u32,
    ) -> ListEntry {
        let mut state = SlotFlags::default();
        if direction == Direction::Reverse {
            state.0 |= SlotFlags::REVERSED;
        }
        if waits {
            state.0 |= SlotFlags::WAITS;
            *waiting += 1;
            self.waiting += 1;
        }
        let slot = if let Some(slot) = self.free.pop() {
            self.windows[slot as usize] = window;
            self.states[slot as usize] = state;
            slot
        } else {
            self.windows.push(window);
            self.states.push(state);
            number(self.windows.len() - 1)
        };
        let end = end_key(window.b1);
        ListEntry { slot, end }
    }

    /// Cuts a window down to `b0..b1`. Returns its new entry, and whether it waits and its least
    /// distance has grown.
    #[inline]
    pub(super) fn cut(&mut self, slot: Slot, b0: f64, b1: f64) -> (ListEntry, bool) {
        let window = &mut self.windows[slot as usize];
        let nearest = window.nearest_abscissa();
        (window.b0, window.b1) = (b0, b1);
        let state = &mut self.states[slot as usize];
        let grows = window.nearest_abscissa() != nearest && state.has(SlotFlags::WAITS);
        if grows {
            state.0 |= SlotFlags::OUTDATED;
        }
        let end = end_key(b1);
        (ListEntry { slot, end }, grows)
    }

    /// Removes a window; the caller takes it out of its list, of which `waiting` windows wait.
    #[inline]
    pub(super) fn remove(&mut self, slot: Slot, waiting: &mut u32) {
        let state = &mut self.states[slot as usize];
        if state.has(SlotFlags::WAITS) {
            state.0 = SlotFlags::GONE;
            *waiting -= 1;
            self.waiting -= 1;
        } else {
            self.free.push(slot);
        }
    }
}

impl Evictable for Lists {
    #[inline]
    fn is_waited_for(&self, i: usize) -> bool {
        *self.places.note(i) > 0
    }

    #[inline]
    fn is_evicted(&self, i: usize) -> bool {
        self.places.is_closed(i)
    }

    fn evict(&mut self, i: usize) {
        let slots = self.places.entries(i).iter().map(|place| place.slot);
        self.slots.free.extend(slots);
        self.places.remove_all(i, true);
    }

    fn reopen(&mut self, i: usize) {
        self.places.open(i);
    }
}

#[cfg(test)]
mod tests;
