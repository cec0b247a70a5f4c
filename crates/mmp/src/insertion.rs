//! Inserting a window into a list: sorted, disjoint, trimmed at tie points.

use std::ops::Range;

use geobench_window::{Window, tie_points};

use crate::duel::{Duel, duel, is_new_shorter, is_sliver, matters};
use crate::lists::{self, Direction, Lists, Slot};

/// Who is shorter on a range.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Owner {
    New,
    /// The stored window at this place among those that the new one meets.
    Old(usize),
}

/// A range of the half-edge and its owner.
#[derive(Clone, Copy, Debug)]
struct Segment {
    start: f64,
    end: f64,
    owner: Owner,
}

/// A window to be queued.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    /// Its least distance.
    pub(crate) label: f64,
    pub(crate) slot: Slot,
    /// The stored window that it is a part of; `None` if of the new one.
    pub(crate) part_of: Option<Slot>,
}

/// A new window that takes one range, and what this leaves of the windows that it meets.
#[derive(Clone, Copy, Debug)]
struct Wedge {
    start: f64,
    end: f64,
    /// The windows that lose something, counted from the first one that the new window may meet.
    first: usize,
    behind: usize,
    /// Whether the first of them keeps its part before `start`, and the last one its part behind `end`.
    keeps_left: bool,
    keeps_right: bool,
}

/// What becomes of a new window, as far as it is simple.
#[derive(Clone, Copy, Debug)]
enum Place {
    /// It is nowhere shorter.
    Nowhere,
    /// In one piece.
    Here(Wedge),
    /// Perhaps in several.
    Open,
}

/// Inserts windows into lists: the buffers this needs, and what the last insertion did.
#[derive(Clone, Debug, Default)]
pub(crate) struct Inserter {
    segments: Vec<Segment>,
    met: Vec<Window>,
    slots: Vec<Slot>,
    /// The windows to queue: what is left of the new one, and pieces of stored ones that have to wait on their own.
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
    /// Ranges that nobody held go to `new`. Takes O(log k + m) for m windows met among k, and the
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
        let first = lists.ending_before(i, new.b0);
        match place(lists.windows(), &lists.places(i)[first..], new, l) {
            Place::Nowhere => {}
            Place::Here(wedge) => self.drive_in(lists, i, first, &wedge, new, direction, l),
            Place::Open => self.divide(lists, i, first, new, direction, l),
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
        wedge: &Wedge,
        new: &Window,
        direction: Direction,
        l: f64,
    ) {
        let &Wedge { start, end, .. } = wedge;
        let (mut from, mut to) = (offset + wedge.first, offset + wedge.behind);
        let taken = Window {
            b0: start,
            b1: end,
            ..*new
        };
        self.new_pieces = 1;
        let mut slots = [self.queue_piece(lists, i, taken, direction, None), 0];
        let mut pieces = 1;
        let mut left = None;
        if wedge.keeps_left {
            let slot = lists.places(i)[from].slot;
            let old = lists.windows()[slot as usize];
            if !is_sliver(&old, old.b0, start, l) {
                left = Some(old);
                self.keep(lists, i, from, old.b0, start);
                from += 1;
            }
        }
        if wedge.keeps_right {
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
        self.removed = to - from;
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
        let stored = |place: &lists::Place| lists.windows()[place.slot as usize];
        let behind = lists.places(i)[first..].iter().map(stored);
        let first = first + behind.take_while(|w| w.b1 <= new.b0).count();
        let behind = lists.places(i)[first..].iter().map(stored);
        met.extend(behind.take_while(|w| w.b0 < new.b1));
        self.share_out(&met, new, l);
        self.segments.retain(|s| {
            let owner = match s.owner {
                Owner::New => new,
                Owner::Old(k) => &met[k],
            };
            !is_sliver(owner, s.start, s.end, l)
        });
        if self.segments.iter().any(|s| s.owner == Owner::New) {
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
        let mut segments = std::mem::take(&mut self.segments);
        // The stored windows before this one have been dealt with.
        let mut next_old = 0;
        for &Segment { start, end, owner } in &segments {
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
        segments.clear();
        (self.segments, self.slots) = (segments, slots);
    }

    /// Removes these windows of list `i`, whose slots are still to be taken out.
    fn give_up(&mut self, lists: &mut Lists, i: usize, range: Range<usize>) {
        self.removed += range.len();
        for k in range {
            let slot = lists.places(i)[k].slot;
            lists.remove(i, slot);
        }
    }

    /// Divides the ranges of `met` and `new` between them.
    fn share_out(&mut self, met: &[Window], new: &Window, l: f64) {
        self.segments.clear();
        let mut covered = new.b0;
        for (i, w) in met.iter().enumerate() {
            let old = Owner::Old(i);
            let (lo, hi) = (w.b0.max(new.b0), w.b1.min(new.b1));
            self.grant(covered, w.b0, Owner::New);
            self.grant(w.b0, lo, old);
            // Ranges that matter to neither are not worth a trim.
            let matters = |start, end| matters(w, new, start, end, l);
            let winner = |start, end| {
                if is_new_shorter(w, new, start, end) {
                    Owner::New
                } else {
                    old
                }
            };
            let mut start = lo;
            if matters(lo, hi) {
                for &tie in tie_points(w, new).as_slice() {
                    if matters(start, tie) && matters(tie, hi) {
                        self.grant(start, tie, winner(start, tie));
                        start = tie;
                    }
                }
                self.grant(start, hi, winner(start, hi));
            } else {
                self.grant(start, hi, old);
            }
            self.grant(hi, w.b1, old);
            covered = hi;
        }
        self.grant(covered, new.b1, Owner::New);
    }

    /// Gives `start..end` to `owner`.
    fn grant(&mut self, start: f64, end: f64, owner: Owner) {
        if start < end {
            match self.segments.last_mut() {
                Some(last) if last.owner == owner => last.end = end,
                _ => self.segments.push(Segment { start, end, owner }),
            }
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

/// Where `new` is shorter than the windows at `places`, of which the first is the first that it may meet.
#[inline]
fn place(windows: &[Window], places: &[lists::Place], new: &Window, l: f64) -> Place {
    let mut wedge = Wedge {
        start: new.b0,
        end: new.b1,
        first: 0,
        behind: 0,
        keeps_left: false,
        keeps_right: false,
    };
    // Whether it has gained anything, and lost it again.
    let (mut gained, mut over) = (false, false);
    // Up to here everything has been decided.
    let mut decided = new.b0;
    for place in places {
        let w = &windows[place.slot as usize];
        if w.b0 >= new.b1 {
            break;
        }
        let (lo, hi) = (w.b0.max(new.b0), w.b1.min(new.b1));
        if decided < lo && !is_sliver(new, decided, lo, l) {
            if over {
                return Place::Open;
            }
            if !gained {
                (gained, wedge.start) = (true, decided);
            }
        }
        decided = decided.max(hi);
        let outcome = if matters(w, new, lo, hi, l) {
            duel(w, new, lo, hi, l)
        } else {
            Duel::Old
        };
        match outcome {
            Duel::Old if gained && !over => (over, wedge.end) = (true, lo),
            Duel::Old => {
                if !gained {
                    wedge.first += 1;
                    wedge.behind += 1;
                    wedge.start = decided;
                }
            }
            Duel::New | Duel::NewOld(_) if !over => {
                if !gained {
                    (gained, wedge.start, wedge.keeps_left) = (true, lo, w.b0 < lo);
                }
                wedge.behind += 1;
                wedge.keeps_right = hi < w.b1;
                if let Duel::NewOld(tie) = outcome {
                    (over, wedge.end, wedge.keeps_right) = (true, tie, true);
                }
            }
            Duel::OldNew(tie) if !gained => {
                (gained, wedge.start, wedge.keeps_left) = (true, tie, true);
                wedge.behind += 1;
                wedge.keeps_right = hi < w.b1;
            }
            _ => return Place::Open,
        }
        if w.b1 >= new.b1 {
            // The next one begins behind it, and need not be looked at.
            break;
        }
    }
    if decided < new.b1 && !over && !gained {
        (gained, wedge.start) = (true, decided);
    } else if decided < new.b1 && over && !is_sliver(new, decided, new.b1, l) {
        return Place::Open;
    }
    if gained && !is_sliver(new, wedge.start, wedge.end, l) {
        Place::Here(wedge)
    } else {
        Place::Nowhere
    }
}

#[cfg(test)]
mod tests {
    use geobench_window::continuous::Turn;

    use super::*;
    use proptest::prelude::*;

    fn window(b0: f64, b1: f64, px: f64, py: f64, sigma: f64) -> Window {
        Window {
            b0,
            b1,
            px,
            py,
            sigma,
        }
    }

    fn insert(inserter: &mut Inserter, lists: &mut Lists, new: &Window) {
        inserter.insert(lists, 0, new, Direction::Forward, 1.0);
    }

    fn insert_all(windows: &[Window]) -> Lists {
        let (mut list, mut inserter) = (Lists::new(1), Inserter::default());
        for w in windows {
            insert(&mut inserter, &mut list, w);
        }
        list
    }

    fn stored(list: &Lists) -> Vec<Window> {
        let windows = list.places(0).iter();
        windows
            .map(|place| list.windows()[place.slot as usize])
            .collect()
    }

    fn at(list: &Lists, x: f64) -> Option<f64> {
        let mut windows = stored(list).into_iter();
        let held = windows.find(|w| w.b0 <= x && x <= w.b1);
        held.map(|w| w.distance(x))
    }

    fn windows() -> impl Strategy<Value = Window> {
        (
            0.0..0.9f64,
            0.01..1.0f64,
            -2.0..3.0f64,
            -4.0..0.0f64,
            0.0..2.0f64,
        )
            .prop_map(|(b0, width, px, py, sigma)| window(b0, (b0 + width).min(1.0), px, py, sigma))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1000))]

        #[test]
        fn a_list_is_the_lower_envelope_of_all_that_came(
            windows in prop::collection::vec(windows(), 1..12), x in 0.0..1.0f64,
        ) {
            let list = insert_all(&windows);
            for pair in stored(&list).windows(2) {
                prop_assert!(pair[0].b1 <= pair[1].b0, "{pair:?} overlap");
            }
            let near_an_end = windows.iter().any(|w| (x - w.b0).abs() < 1e-8 || (x - w.b1).abs() < 1e-8);
            prop_assume!(!near_an_end);
            let covering = windows.iter().filter(|w| w.b0 <= x && x <= w.b1);
            let least = covering.map(|w| w.distance(x)).reduce(f64::min);
            match (at(&list, x), least) {
                (Some(held), Some(least)) => prop_assert!((held - least).abs() <= 1e-9 * least),
                (None, None) => {}
                (held, least) => prop_assert!(false, "{held:?} held, {least:?} offered"),
            }
        }

        #[test]
        fn every_window_left_is_in_the_queue_under_its_least_distance(
            windows in prop::collection::vec(windows(), 1..12),
        ) {
            let (mut list, mut inserter) = (Lists::new(1), Inserter::default());
            let mut queue = Vec::new();
            for w in &windows {
                insert(&mut inserter, &mut list, w);
                queue.extend_from_slice(&inserter.to_queue);
            }
            let mut found = 0;
            while let Some(Entry { label, slot, .. }) = queue.pop() {
                match list.take(0, slot) {
                    Turn::Now(w, ()) => {
                        prop_assert_eq!(label, w.min_distance());
                        found += 1;
                    }
                    Turn::Later(later) => {
                        prop_assert!(later >= label);
                        queue.push(Entry { label: later, slot, part_of: None });
                    }
                    Turn::Void => {}
                }
            }
            prop_assert_eq!(found, list.len(0));
        }
    }

    #[test]
    fn the_old_window_wins_a_tie() {
        let w = window(0.0, 1.0, 0.5, -1.0, 0.0);
        let list = insert_all(&[w, w]);
        assert_eq!(list.len(0), 1);
    }

    #[test]
    fn a_window_between_two_ties_splits_the_old_one() {
        let far = window(0.0, 1.0, 0.5, -2.0, 0.0);
        let near = window(0.0, 1.0, 0.5, -0.1, 1.85);
        let list = insert_all(&[far, near]);
        assert_eq!(list.len(0), 3);
        assert_eq!(at(&list, 0.5), Some(near.distance(0.5)));
        assert_eq!(at(&list, 0.0), Some(far.distance(0.0)));
        assert_eq!(at(&list, 1.0), Some(far.distance(1.0)));
    }

    #[test]
    fn a_propagated_window_is_cut_but_not_queued_again() {
        let (mut list, mut inserter) = (Lists::new(1), Inserter::default());
        insert(&mut inserter, &mut list, &window(0.0, 1.0, 0.2, -1.0, 0.0));
        let slot = inserter.to_queue[0].slot;
        assert!(matches!(list.take(0, slot), Turn::Now(..)));
        insert(&mut inserter, &mut list, &window(0.0, 0.5, 0.2, -0.5, 0.0));
        assert_eq!(
            (inserter.new_pieces, inserter.trimmed, inserter.removed),
            (1, 1, 0)
        );
        assert_eq!(inserter.to_queue.len(), 1);
    }

    #[test]
    fn a_waiting_window_whose_nearest_point_is_lost_waits_for_longer() {
        let (mut list, mut inserter) = (Lists::new(1), Inserter::default());
        insert(&mut inserter, &mut list, &window(0.0, 1.0, 0.2, -1.0, 0.0));
        let first = inserter.to_queue[0];
        insert(&mut inserter, &mut list, &window(0.0, 0.5, 0.2, -0.5, 0.0));
        assert_eq!((inserter.to_queue.len(), inserter.outdated), (1, 1));
        let rest = window(0.5, 1.0, 0.2, -1.0, 0.0);
        assert_eq!(list.take(0, first.slot), Turn::Later(rest.min_distance()));
        assert_eq!(list.take(0, first.slot), Turn::Now(rest, ()));
    }

    #[test]
    fn both_parts_of_a_waiting_window_wait() {
        let (mut list, mut inserter) = (Lists::new(1), Inserter::default());
        insert(&mut inserter, &mut list, &window(0.0, 1.0, 0.5, -2.0, 0.0));
        let whole = inserter.to_queue[0].slot;
        insert(&mut inserter, &mut list, &window(0.4, 0.6, 0.5, -1.0, 0.0));
        let parts: Vec<_> = inserter.to_queue.iter().map(|e| e.part_of).collect();
        assert_eq!(parts, [None, Some(whole)]);
        assert_eq!((list.len(0), list.waiting()), (3, 3));
        insert(&mut inserter, &mut list, &window(0.0, 1.0, 0.2, -0.1, 0.0));
        assert_eq!((list.len(0), list.waiting()), (1, 1));
    }

    /// The fan of a source that stands on the edge passes through no width at all; when such windows
    /// were dropped as slivers, vertices behind flat faces came out twice as far.
    #[test]
    fn a_window_of_a_source_on_the_edge_is_no_sliver_however_narrow() {
        let whole = window(0.0, 1.0, 0.5, -1.0, 1.0);
        let fan = window(0.0, 1e-14, 0.0, -1e-20, 0.0);
        assert_eq!(insert_all(&[whole, fan]).len(0), 2);
        assert_eq!(insert_all(&[fan]).len(0), 1);
    }

    /// Sources at 0.75 and, by way of it, at 0.5 are equal left of 0.5. The middle of the edge being
    /// there, the first to come kept all of it, and rays to the right were 5e-2 too long: on an
    /// edge with two vertices on it and faces without area between, in any order but nearest first.
    #[test]
    fn sources_on_the_edge_are_told_apart_where_they_differ() {
        let far = window(0.0, 1.0, 0.5, -4e-31, 0.25);
        let near = window(0.0, 1.0, 0.75, -4e-31, 0.0);
        for windows in [[far, near], [near, far]] {
            let list = insert_all(&windows);
            assert_eq!(at(&list, 1.0), Some(0.25));
            assert_eq!(at(&list, 0.0), Some(0.75));
        }
    }

    /// Windows that meet along a ray overlap by rounding. When the splinters of such overlaps were
    /// kept, the horse took twice its windows and each edge up to 7,000 of them.
    #[test]
    fn overlaps_by_rounding_leave_no_splinters() {
        let left = window(0.0, 0.5 + 1e-15, 0.5, -1.0, 0.0);
        let right = window(0.5, 1.0, 0.5, -1.0, 1e-9);
        let list = insert_all(&[right, left]);
        assert_eq!(list.len(0), 2);
        assert!(stored(&list).iter().all(|w| w.b1 - w.b0 > 0.4));
    }
}
