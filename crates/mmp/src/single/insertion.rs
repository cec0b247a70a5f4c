//! Inserts a window into a list: sorted, disjoint, trimmed at tie points.

use geobench_window::Window;
use geobench_window::trimming::{TrimmedList, Trimmer, is_near, pieces};

use super::lists::{Direction, ListEntry, Lists, Slot, Slots};

/// A window to be queued.
#[derive(Clone, Copy, Debug)]
pub(crate) struct QueueEntry {
    /// Its least distance.
    pub(crate) label: f64,
    pub(crate) slot: Slot,
    /// The stored window of which it is a part; `None` for a part of the new one.
    pub(crate) part_of: Option<Slot>,
}

/// What an insertion did.
#[derive(Clone, Debug, Default)]
pub(crate) struct Effects {
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

/// Inserts windows into lists; owns the buffers.
#[derive(Clone, Debug, Default)]
pub(crate) struct Inserter {
    trimmer: Trimmer<ListEntry>,
    /// The effects of the last insertion.
    pub(crate) effects: Effects,
}

impl Inserter {
    /// Inserts `new`, which crosses in `direction`, into list `i`, whose edge has length `l`. Takes
    /// O(log k + m) for m windows met among k, and moves the entries behind them.
    #[inline]
    pub(crate) fn insert(
        &mut self,
        lists: &mut Lists,
        i: usize,
        new: &Window,
        direction: Direction,
        l: f64,
    ) {
        let effects = &mut self.effects;
        effects.to_queue.clear();
        (effects.new_pieces, effects.outdated) = (0, 0);
        (effects.trimmed, effects.removed) = (0, 0);
        if is_near(new, l) {
            self.insert_pieces(lists, i, new, direction, l);
        } else {
            self.insert_piece(lists, i, new, direction, l);
        }
    }

    /// [`insert`](Self::insert) for a window whose source [`is_near`].
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
        let (places, _, slots) = lists.parts(i);
        let stored = places.iter().map(|place| slots.window(place.slot));
        let pieces: Vec<Window> = pieces(new, l, stored).collect();
        for piece in pieces {
            self.insert_piece(lists, i, &piece, direction, l);
        }
    }

    /// [`insert`](Self::insert) for a window as it is to be stored.
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
        let (places, waiting, slots) = lists.parts(i);
        let mut insertion = ListInsertion {
            places,
            waiting,
            slots,
            direction,
            effects: &mut self.effects,
        };
        let old = (self.trimmer).insert_one(&mut insertion, first, new, l);
        lists.replace(i, old, self.trimmer.pieces());
    }
}

/// The arrival of one window at a list.
struct ListInsertion<'a> {
    places: &'a mut [ListEntry],
    waiting: &'a mut u32,
    slots: &'a mut Slots,
    direction: Direction,
    effects: &'a mut Effects,
}

impl ListInsertion<'_> {
    /// Stores a window that waits to be propagated.
    #[inline]
    fn queue_piece(
        &mut self,
        window: Window,
        direction: Direction,
        part_of: Option<Slot>,
    ) -> ListEntry {
        let entry = (self.slots).store(window, direction, true, self.waiting);
        self.effects.to_queue.push(QueueEntry {
            label: window.min_distance(),
            slot: entry.slot,
            part_of,
        });
        entry
    }
}

impl TrimmedList for ListInsertion<'_> {
    type Entry = ListEntry;

    #[inline]
    fn entries(&self) -> &[ListEntry] {
        self.places
    }

    #[inline]
    fn entries_mut(&mut self) -> &mut [ListEntry] {
        self.places
    }

    #[inline]
    fn window<'a>(&'a self, entry: &'a ListEntry) -> &'a Window {
        self.slots.window(entry.slot)
    }

    #[inline]
    fn keep(&mut self, _: usize, part: Window) -> ListEntry {
        self.effects.new_pieces += 1;
        self.queue_piece(part, self.direction, None)
    }

    #[inline]
    fn drop_new(&mut self, _: usize) {}

    /// A propagated window is only cut: its children will be trimmed by those of the winner. A
    /// waiting window is queued later if its least distance grew.
    #[inline]
    fn cut(&mut self, old: &ListEntry, b0: f64, b1: f64) -> ListEntry {
        let (entry, grows) = self.slots.cut(old.slot, b0, b1);
        self.effects.trimmed += 1;
        self.effects.outdated += usize::from(grows);
        entry
    }

    /// The second piece waits if the window does.
    fn split(&mut self, old: &ListEntry, b0: f64, b1: f64) -> ListEntry {
        let piece = self.slots.window(old.slot).cut(b0, b1);
        let direction = self.slots.direction(old.slot);
        if self.slots.waits(old.slot) {
            self.effects.outdated += 1;
            self.queue_piece(piece, direction, Some(old.slot))
        } else {
            self.slots.store(piece, direction, false, self.waiting)
        }
    }

    #[inline]
    fn remove(&mut self, old: &ListEntry) {
        self.effects.removed += 1;
        self.slots.remove(old.slot, self.waiting);
    }
}

#[cfg(test)]
mod tests;
