//! Where the windows of all half-edges are kept.

use geobench_window::continuous::Turn;
use geobench_window::{Window, prefetch};

use crate::blocks::{FreeBlocks, GROUP, room, roomier};
use crate::forgetting::Past;

/// Which way a window crosses the edge of its list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    /// From below the edge to above it, as in the frame of a window of its own half-edge.
    Forward,
    /// The other way, from a source above the edge.
    Reverse,
}

/// The number of a window, by which lists and the queue know it: it stays the same while the window
/// is stored, whatever becomes of its interval.
pub(crate) type Slot = u32;

/// What is known of the window in a slot.
#[derive(Clone, Copy, Debug, Default)]
struct State(u8);

impl State {
    /// It waits in the queue, in which it has exactly one entry.
    const WAITS: u8 = 1;
    /// Its least distance has grown since it was queued.
    const OUTDATED: u8 = 2;
    /// It was removed while it waited. The slot is kept until its entry comes out of the queue.
    const GONE: u8 = 4;
    /// It travels against the half-edge whose frame its list uses.
    const REVERSED: u8 = 8;

    #[inline]
    fn has(self, flag: u8) -> bool {
        self.0 & flag != 0
    }
}

/// A window of a list, with what a search needs to know of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Place {
    /// Where the window is.
    pub(crate) slot: Slot,
    /// The [key](end_key) of its right end.
    end: u32,
}

impl Place {
    /// A place without a window, behind all others.
    const NONE: Self = Self {
        slot: 0,
        end: u32::MAX,
    };
}

/// The upper half of the bits of an abscissa that is not negative, in the order of the abscissae up
/// to a millionth.
#[inline]
fn end_key(x: f64) -> u32 {
    (x.to_bits() >> 32) as u32
}

/// The list of one half-edge: a block in the array of all lists.
#[derive(Clone, Copy, Debug, Default)]
struct List {
    start: u32,
    len: u32,
    /// How many of its windows wait in the queue.
    waiting: u32,
    /// Size class of its block; 0 without any.
    class: u8,
    /// Whether its windows have been given up.
    closed: bool,
}

/// The windows of all half-edges, or of all edges in the frame of one of their half-edges. Those of
/// one list are in ascending order and have disjoint intervals; gaps are normal.
///
/// A list is a block of slots, 8 bytes for each window, of a few sizes: 4, 8, 12, 16, 24, 32, 48
/// and so on. To insert a window moves slots only, and the queue finds a window without a look at
/// its list. To search a list reads its block only: where the windows are is known to a millionth,
/// and of them those are read that the new one may meet. Slots and blocks that were given back are
/// the first to be taken again, so that the memory in use is as small as the lists are.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lists {
    heads: Vec<List>,
    places: Vec<Place>,
    free_blocks: FreeBlocks,
    windows: Vec<Window>,
    states: Vec<State>,
    free: Vec<Slot>,
    waiting: usize,
    stored: usize,
}

/// Fewer slots than this are moved one by one.
const SHORT: usize = 8;

impl Lists {
    /// Bytes of one stored window.
    pub(crate) const WINDOW_BYTES: usize = size_of::<Window>();

    pub(crate) fn new(count: usize) -> Self {
        Self {
            heads: vec![List::default(); count],
            ..Self::default()
        }
    }

    /// Makes all lists empty.
    pub(crate) fn clear(&mut self) {
        self.heads.fill(List::default());
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
    pub(crate) fn places(&self, i: usize) -> &[Place] {
        let List { start, len, .. } = self.heads[i];
        &self.places[start as usize..][..len as usize]
    }

    /// How many windows of list `i` end before `x`, for certain: up to rounding, which may leave
    /// some more that do.
    #[inline]
    pub(crate) fn ending_before(&self, i: usize, x: f64) -> usize {
        let List {
            start, len, class, ..
        } = self.heads[i];
        let block = &self.places[start as usize..][..room(class)];
        let key = end_key(x);
        let mut count = 0;
        // Groups that end before it are passed over, half of what is left at a time.
        let mut groups = len as usize / GROUP;
        while groups > 1 {
            let half = groups / 2;
            let last = count + half * GROUP - 1;
            count += usize::from(block[last].end < key) * half * GROUP;
            groups -= half;
        }
        // Of the others all are compared, so that no branch depends on where it is.
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

    /// All windows that are stored, by slot.
    #[inline]
    pub(crate) fn windows(&self) -> &[Window] {
        &self.windows
    }

    /// Which way the window crosses its edge.
    #[inline]
    pub(crate) fn direction(&self, slot: Slot) -> Direction {
        if self.states[slot as usize].has(State::REVERSED) {
            Direction::Reverse
        } else {
            Direction::Forward
        }
    }

    /// Whether the window waits in the queue.
    #[inline]
    pub(crate) fn waits(&self, slot: Slot) -> bool {
        self.states[slot as usize].has(State::WAITS)
    }

    /// The entry of a window of list `i` has come out of the queue. The window stays stored, and
    /// does not wait any more, unless it must wait for longer.
    #[inline(always)] // The window is not to pass through memory on its way to its crossing.
    #[allow(clippy::inline_always)] // Called for every window, and small.
    pub(crate) fn take(&mut self, i: usize, slot: Slot) -> Turn<()> {
        let state = &mut self.states[slot as usize];
        if state.has(State::GONE) {
            self.free.push(slot);
            return Turn::Void;
        }
        let window = self.windows[slot as usize];
        if state.has(State::OUTDATED) {
            state.0 &= !State::OUTDATED;
            return Turn::Later(window.min_distance());
        }
        state.0 &= !State::WAITS;
        self.heads[i].waiting -= 1;
        self.waiting -= 1;
        Turn::Now(window, ())
    }

    /// Stores a window in a slot, which is still to be put into list `i`; it `waits` or does not.
    #[inline]
    pub(crate) fn store(
        &mut self,
        i: usize,
        window: Window,
        direction: Direction,
        waits: bool,
    ) -> Slot {
        let mut state = State::default();
        if direction == Direction::Reverse {
            state.0 |= State::REVERSED;
        }
        if waits {
            state.0 |= State::WAITS;
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
            (self.windows.len() - 1) as Slot
        }
    }

    /// Cuts window `k` of list `i` down to `b0..b1`. Returns whether its least distance has grown
    /// while it waits.
    #[inline]
    pub(crate) fn cut(&mut self, i: usize, k: usize, b0: f64, b1: f64) -> bool {
        let place = &mut self.places[self.heads[i].start as usize + k];
        place.end = end_key(b1);
        let slot = place.slot;
        let window = &mut self.windows[slot as usize];
        let nearest = window.nearest_abscissa();
        (window.b0, window.b1) = (b0, b1);
        let state = &mut self.states[slot as usize];
        let grows = window.nearest_abscissa() != nearest && state.has(State::WAITS);
        if grows {
            state.0 |= State::OUTDATED;
        }
        grows
    }

    /// Gives up a window of list `i`, whose slot must leave the list.
    #[inline]
    pub(crate) fn remove(&mut self, i: usize, slot: Slot) {
        self.stored -= 1;
        let state = &mut self.states[slot as usize];
        if state.has(State::WAITS) {
            state.0 = State::GONE;
            self.heads[i].waiting -= 1;
            self.waiting -= 1;
        } else {
            self.free.push(slot);
        }
    }

    /// Puts `new` in the place of the slots `first..first + old` of list `i`.
    #[inline]
    pub(crate) fn replace(&mut self, i: usize, first: usize, old: usize, new: &[Slot]) {
        if old != new.len() {
            self.resize(i, first, old, new.len());
        }
        let start = self.heads[i].start as usize + first;
        for (to, &slot) in self.places[start..start + new.len()].iter_mut().zip(new) {
            let end = end_key(self.windows[slot as usize].b1);
            *to = Place { slot, end };
        }
    }

    /// Makes room for `new` slots in the place of `old` ones.
    #[inline]
    fn resize(&mut self, i: usize, first: usize, old: usize, new: usize) {
        let List {
            start, len, class, ..
        } = self.heads[i];
        let (start, len) = (start as usize, len as usize);
        let longer = len - old + new;
        let behind = start + first + old..start + len;
        if longer > room(class) {
            let to = self.relocate(i, longer);
            // Often there was nothing, and then there is nothing to call for.
            if first > 0 {
                self.places.copy_within(start..start + first, to);
            }
            if !behind.is_empty() {
                self.places.copy_within(behind, to + first + new);
            }
        } else {
            let to = start + first + new;
            if new == old + 1 && behind.len() < SHORT {
                // The most frequent case, and too little for a call.
                let places = &mut self.places[behind.start..=behind.end];
                for k in (1..places.len()).rev() {
                    places[k] = places[k - 1];
                }
            } else {
                self.places.copy_within(behind, to);
                if longer < len {
                    self.places[start + longer..start + len].fill(Place::NONE);
                }
            }
        }
        self.heads[i].len = longer as u32;
    }

    /// Gives list `i` a block for `len` slots and returns where it starts. The old one goes to
    /// whoever wants it: it is not written to before the next call.
    #[inline(never)]
    fn relocate(&mut self, i: usize, len: usize) -> usize {
        let List { start, class, .. } = self.heads[i];
        let larger = roomier(class, len);
        let to = self.free_blocks.take(larger).unwrap_or_else(|| {
            let to = self.places.len();
            self.places.resize(to + room(larger), Place::NONE);
            to as u32
        });
        self.places[to as usize + len..][..room(larger) - len].fill(Place::NONE);
        self.free_blocks.give(class, start);
        let list = &mut self.heads[i];
        (list.start, list.class) = (to, larger);
        to as usize
    }

    /// Asks for what [`take`](Self::take) looks at.
    #[inline]
    pub(crate) fn announce(&self, i: usize, slot: Slot) {
        prefetch(&self.windows, slot as usize);
        prefetch(&self.states, slot as usize);
        prefetch(&self.heads, i);
    }
}

impl Past for Lists {
    #[inline]
    fn is_waited_for(&self, i: usize) -> bool {
        self.heads[i].waiting > 0
    }

    #[inline]
    fn is_closed(&self, i: usize) -> bool {
        self.heads[i].closed
    }

    fn forget(&mut self, i: usize) {
        let List {
            start, len, class, ..
        } = self.heads[i];
        let places = &self.places[start as usize..][..len as usize];
        self.stored -= places.len();
        self.free.extend(places.iter().map(|place| place.slot));
        self.free_blocks.give(class, start);
        self.heads[i] = List {
            closed: true,
            ..List::default()
        };
    }

    fn reopen(&mut self, i: usize) {
        self.heads[i].closed = false;
    }
}

#[cfg(test)]
#[path = "lists_tests.rs"]
mod tests;
