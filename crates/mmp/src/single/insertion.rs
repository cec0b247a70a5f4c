//! Inserts a window into a list: sorted, disjoint, trimmed at tie points.

use std::ops::Range;

use geobench_window::Window;

use super::lists::{Direction, ListEntry, Lists, Slot};
use geobench_window::trimming::{Overlap, OverlapRange, Owner, Segment, foot, is_sliver, pieces};

/// A window to be queued.
#[derive(Clone, Copy, Debug)]
pub(crate) struct QueueEntry {
    /// Its least distance.
    pub(crate) label: f64,
    pub(crate) slot: Slot,
    /// The stored window of which it is a part; `None` for a part of the new one.
    pub(crate) part_of: Option<Slot>,
}

/// Inserts windows into lists; owns the buffers and the counts of the last insertion.
#[derive(Clone, Debug, Default)]
pub(crate) struct Inserter {
    overlap: Overlap,
    met: Vec<Window>,
    slots: Vec<Slot>,
    /// The windows to queue: the surviving pieces of the new one, and split-off pieces of stored
    /// ones that wait.
    pub(crate) to_queue: Vec<QueueEntry>,
    /// How many of these are pieces of the new window.
    pub(crate) new_pieces: usize,
    /// Waiting windows whose least distance grew, and their split-off pieces.
    pub(crate) outdated: usize,
    /// Number of stored windows that lost a part.
    pub(crate) trimmed: usize,
    /// Number of stored windows that were removed.
    pub(crate) removed: usize,
}

impl Inserter {
    /// Inserts `new`, which crosses in `direction`, into list `i`, whose edge has length `l`.
    ///
    /// Each stored window that `new` overlaps is split at the tie points in the common range, of
    /// which there may be two. Each part goes to the window that is shorter there. Ranges without a
    /// stored window go to `new`. Takes O(log k + m) for m windows met among k, and moves the slots
    /// behind them.
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

    /// [`insert`](Self::insert) for a window with a [foot], which is split at it.
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

    /// [`insert`](Self::insert) for a window without a [foot] or split at it.
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
        match OverlapRange::of(behind, new, l) {
            OverlapRange::Empty => {}
            OverlapRange::Single(start, end) => {
                self.insert_range(lists, i, first, (start, end), new, direction, l);
            }
            OverlapRange::Undecided => self.divide(lists, i, first, new, direction, l),
        }
    }

    /// Inserts the part `start..end` of `new`, the only one that survives.
    #[inline]
    #[allow(clippy::too_many_arguments)] // Private, and one step of `insert`.
    fn insert_range(
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
                self.shrink(lists, i, from, old.b0, start);
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
                    self.shrink(lists, i, to - 1, end, old.b1);
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

    /// Inserts `new` by dividing the whole overlap; several of its intervals may survive.
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
        let stored = |place: &ListEntry| lists.windows()[place.slot as usize];
        let behind = lists.places(i)[first..].iter().map(stored);
        let first = first + behind.take_while(|w| w.b1 <= new.b0).count();
        let behind = lists.places(i)[first..].iter().map(stored);
        met.extend(behind.take_while(|w| w.b0 < new.b1));
        self.overlap.share_out(&met, new, l);
        if self
            .overlap
            .segments()
            .iter()
            .any(|s| s.owner == Owner::New)
        {
            self.apply(lists, i, first, &met, new, direction);
        }
        self.met = met;
    }

    /// Replaces the windows `met` by the segments of the overlap.
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
        let overlap = std::mem::take(&mut self.overlap);
        // The stored windows before this one are done.
        let mut next_old = 0;
        for &Segment { start, end, owner } in overlap.segments() {
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
                        self.remove_all(lists, i, first + next_old..first + k);
                        next_old = k + 1;
                        if start != met[k].b0 || end != met[k].b1 {
                            self.shrink(lists, i, first + k, start, end);
                        }
                        slots.push(slot);
                    }
                }
            }
        }
        self.remove_all(lists, i, first + next_old..first + met.len());
        lists.replace(i, first, met.len(), &slots);
        (self.overlap, self.slots) = (overlap, slots);
    }

    /// Removes these windows of list `i`; the caller takes their slots out of the list.
    fn remove_all(&mut self, lists: &mut Lists, i: usize, range: Range<usize>) {
        self.removed += range.len();
        for k in range {
            let slot = lists.places(i)[k].slot;
            lists.remove(i, slot);
        }
    }

    /// Stores a window that waits to be propagated.
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
        self.to_queue.push(QueueEntry {
            label: window.min_distance(),
            slot,
            part_of,
        });
        slot
    }

    /// Cuts a stored window down to `start..end`.
    ///
    /// A propagated window is only cut: its children will be trimmed by those of the winner. A
    /// waiting window is queued later if its least distance grew.
    #[inline]
    fn shrink(&mut self, lists: &mut Lists, i: usize, k: usize, start: f64, end: f64) {
        self.trimmed += 1;
        self.outdated += usize::from(lists.cut(i, k, start, end));
    }

    /// Stores a second piece of the window in `slot`; it waits if that window does.
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
mod tests;
