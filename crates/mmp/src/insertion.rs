//! Inserting a window into a list: sorted, disjoint, trimmed at tie points.

use std::ops::Range;

use geobench_window::Window;

use crate::lists::{Direction, Lists, Place, Slot};
use crate::wedge::Fate;
use geobench_window::trimming::{Division, Owner, Segment, foot, is_sliver, pieces};

/// A window to be queued.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    /// Its least distance.
    pub(crate) label: f64,
    pub(crate) slot: Slot,
    /// The stored window that it is a part of; `None` if of the new one.
    pub(crate) part_of: Option<Slot>,
}

/// Inserts windows into lists: the buffers this needs, and what the last insertion did.
#[derive(Clone, Debug, Default)]
pub(crate) struct Inserter {
    division: Division,
    met: Vec<Window>,
    slots: Vec<Slot>,
    /// The windows to queue: what is left of the new one, and pieces of stored ones that have to
    /// wait on their own.
    pub(crate) to_queue: Vec<Entry>,
    /// How many of these are pieces of the new window.
    pub(crate) new_pieces: usize,
    /// Stored windows whose least distance grew before their turn came, and pieces of them.
    pub(crate) outdated: usize,
    /// Stored windows that lost a part.
    pub(crate) trimmed: usize,
    /// Stored windows that lost everything.
    pub(crate) removed: usize,
}

impl Inserter {
    /// Inserts `new`, which crosses in `direction`, into list `i`, whose edge has length `l`.
    ///
    /// Each stored window that `new` meets is split at the tie points inside the common range, of
    /// which there may be two, and each part goes to the window that is shorter there.
    /// Ranges without a window go to `new`. Takes O(log k + m) for m windows met among k, and the
    /// moving of the windows behind them.
    #[inline]
    pub(crate) fn insert(
        &mut self,
        lists: &mut Lists,
        i: usize,
        new: &Window,
        direction: Direction,
        l: f64,
    ) {
        self.to_queue.clear();
        (self.new_pieces, self.outdated) = (0, 0);
        (self.trimmed, self.removed) = (0, 0);
        if foot(new, l).is_some() {
            self.insert_pieces(lists, i, new, direction, l);
        } else {
            self.insert_piece(lists, i, new, direction, l);
        }
    }

    /// The same for a window with a [foot].
    #[cold]
    #[inline(never)]
    fn insert_pieces(
        &mut self,
        lists: &mut Lists,
        i: usize,
        new: &Window,
        direction: Direction,
        l: f64,
    ) {
        for piece in pieces(new, l) {
            self.insert_piece(lists, i, &piece, direction, l);
        }
    }

    /// The same for a window without a [foot], or for one of the pieces of one with it.
    #[inline]
    fn insert_piece(
        &mut self,
        lists: &mut Lists,
        i: usize,
        new: &Window,
        direction: Direction,
        l: f64,
    ) {
        let first = lists.ending_before(i, new.b0);
        let places = lists.places(i)[first..].iter();
        let behind = places.map(|place| &lists.windows()[place.slot as usize]);
        match Fate::of(behind, new, l) {
            Fate::Nowhere => {}
            Fate::Here(start, end) => {
                self.drive_in(lists, i, first, (start, end), new, direction, l);
            }
            Fate::Open => self.divide(lists, i, first, new, direction, l),
        }
    }

    /// Puts `new` where `wedge` says.
    #[inline]
    #[allow(clippy::too_many_arguments)] // Private, and one step of `insert`.
    fn drive_in(
        &mut self,
        lists: &mut Lists,
        i: usize,
        offset: usize,
        (start, end): (f64, f64),
        new: &Window,
        direction: Direction,
        l: f64,
    ) {
        let places = lists.places(i);
        let old = |k: usize| {
            places
                .get(k)
                .map(|place| &lists.windows()[place.slot as usize])
        };
        let mut from = offset;
        while old(from).is_some_and(|w| w.b1 <= start) {
            from += 1;
        }
        let keeps_left = old(from).is_some_and(|w| w.b0 < start);
        let mut to = from;
        while old(to).is_some_and(|w| w.b1 <= end) {
            to += 1;
        }
        let keeps_right = old(to).is_some_and(|w| w.b0 < end);
        to += usize::from(keeps_right);
        let taken = Window {
            b0: start,
            b1: end,
            ..*new
        };
        self.new_pieces += 1;
        let mut slots = [self.queue_piece(lists, i, taken, direction, None), 0];
        let mut pieces = 1;
        let mut left = None;
        if keeps_left {
            let slot = lists.places(i)[from].slot;
            let old = lists.windows()[slot as usize];
            if !is_sliver(&old, old.b0, start, l) {
                left = Some(old);
                self.keep(lists, i, from, old.b0, start);
                from += 1;
            }
        }
        if keeps_right {
            let slot = lists.places(i)[to - 1].slot;
            if let Some(old) = left
                && from == to
            {
                if !is_sliver(&old, end, old.b1, l) {
                    slots[1] = self.split_off(lists, i, slot, Window { b0: end, ..old });
                    pieces = 2;
                }
            } else {
                let old = lists.windows()[slot as usize];
                if !is_sliver(&old, end, old.b1, l) {
                    self.keep(lists, i, to - 1, end, old.b1);
                    to -= 1;
                }
            }
        }
        for k in from..to {
            let slot = lists.places(i)[k].slot;
            lists.remove(i, slot);
        }
        self.removed += to - from;
        lists.replace(i, from, to - from, &slots[..pieces]);
    }

    /// Inserts `new` whatever the windows from `first` on may leave of it.
    #[cold]
    fn divide(
        &mut self,
        lists: &mut Lists,
        i: usize,
        first: usize,
        new: &Window,
        direction: Direction,
        l: f64,
    ) {
        let mut met = std::mem::take(&mut self.met);
        met.clear();
        let stored = |place: &Place| lists.windows()[place.slot as usize];
        let behind = lists.places(i)[first..].iter().map(stored);
        let first = first + behind.take_while(|w| w.b1 <= new.b0).count();
        let behind = lists.places(i)[first..].iter().map(stored);
        met.extend(behind.take_while(|w| w.b0 < new.b1));
        self.division.share_out(&met, new, l);
        if self
            .division
            .segments()
            .iter()
            .any(|s| s.owner == Owner::New)
        {
            self.apply(lists, i, first, &met, new, direction);
        }
        self.met = met;
    }

    /// Puts the segments in the place of the windows `met`.
    fn apply(
        &mut self,
        lists: &mut Lists,
        i: usize,
        first: usize,
        met: &[Window],
        new: &Window,
        direction: Direction,
    ) {
        let mut slots = std::mem::take(&mut self.slots);
        slots.clear();
        let division = std::mem::take(&mut self.division);
        // The stored windows before this one have been dealt with.
        let mut next_old = 0;
        for &Segment { start, end, owner } in division.segments() {
            match owner {
                Owner::New => {
                    let window = Window {
                        b0: start,
                        b1: end,
                        ..*new
                    };
                    self.new_pieces += 1;
                    slots.push(self.queue_piece(lists, i, window, direction, None));
                }
                Owner::Old(k) => {
                    let slot = lists.places(i)[first + k].slot;
                    let window = Window {
                        b0: start,
                        b1: end,
                        ..met[k]
                    };
                    if k < next_old {
                        slots.push(self.split_off(lists, i, slot, window));
                    } else {
                        self.give_up(lists, i, first + next_old..first + k);
                        next_old = k + 1;
                        if start != met[k].b0 || end != met[k].b1 {
                            self.keep(lists, i, first + k, start, end);
                        }
                        slots.push(slot);
                    }
                }
            }
        }
        self.give_up(lists, i, first + next_old..first + met.len());
        lists.replace(i, first, met.len(), &slots);
        (self.division, self.slots) = (division, slots);
    }

    /// Removes these windows of list `i`, whose slots are still to be taken out.
    fn give_up(&mut self, lists: &mut Lists, i: usize, range: Range<usize>) {
        self.removed += range.len();
        for k in range {
            let slot = lists.places(i)[k].slot;
            lists.remove(i, slot);
        }
    }

    /// Stores a window that has to be propagated.
    #[inline]
    fn queue_piece(
        &mut self,
        lists: &mut Lists,
        i: usize,
        window: Window,
        direction: Direction,
        part_of: Option<Slot>,
    ) -> Slot {
        let slot = lists.store(i, window, direction, true);
        self.to_queue.push(Entry {
            label: window.min_distance(),
            slot,
            part_of,
        });
        slot
    }

    /// Leaves `start..end` of a stored window to it.
    ///
    /// A window that was propagated already is only cut, since its children will be trimmed by
    /// those of the winner; one that still waits has to wait for longer if its least distance grew.
    #[inline]
    fn keep(&mut self, lists: &mut Lists, i: usize, k: usize, start: f64, end: f64) {
        self.trimmed += 1;
        self.outdated += usize::from(lists.cut(i, k, start, end));
    }

    /// Stores a further piece of the window in `slot`, which waits if that does.
    fn split_off(&mut self, lists: &mut Lists, i: usize, slot: Slot, piece: Window) -> Slot {
        let direction = lists.direction(slot);
        if lists.waits(slot) {
            self.outdated += 1;
            self.queue_piece(lists, i, piece, direction, Some(slot))
        } else {
            lists.store(i, piece, direction, false)
        }
    }
}

#[cfg(test)]
#[path = "insertion_tests.rs"]
mod tests;
