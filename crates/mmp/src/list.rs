//! The windows of one half-edge or edge: sorted, disjoint, trimmed at tie points.

use std::cmp::Ordering;
use std::ops::Range;

use geobench_window::{Window, prefetch, tie_points};

/// How much shorter a new window must be, relatively, to take ground from a stored one. The old
/// one wins ties, so that a window that comes twice is not stored twice.
const MARGIN: f64 = 1.0 - 1e-12;

/// Width below which what trimming leaves of a window is dropped, as a fraction of the edge or of
/// the distance of the source, whichever is less.
///
/// Windows that meet along a ray overlap by rounding, and trimming then leaves slivers of 1e-17 to
/// 1e-11 of an edge, a third of all windows on scans, while true windows are wider than 1e-9. The
/// bent paths along the neighbours of a sliver are as short as its own to far below rounding.
/// Only where a source stands on the edge, behind a face of no area, do rays of all directions pass
/// through as little as that; hence the distance of the source.
const SLIVER: f64 = 1e-10;

/// Set in a tag while the window waits in the queue.
const QUEUED: u32 = 1 << 31;

/// Set in the id of a window that travels against the half-edge whose frame its list uses.
const REVERSED: u32 = 1 << 30;

/// Which way a window crosses the edge of its list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    /// From below the edge to above it, as in the frame of a window of its own half-edge.
    Forward,
    /// The other way, from a source above the edge.
    Reverse,
}

impl Direction {
    /// The direction of the window with this id.
    pub(crate) fn of(id: u32) -> Self {
        if id & REVERSED == 0 {
            Self::Forward
        } else {
            Self::Reverse
        }
    }
}

/// A window in its list.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stored {
    window: Window,
    /// The id by which the queue knows the window, unique in its list, and [`QUEUED`].
    tag: u32,
}

/// The windows of one half-edge, or of both half-edges of an edge in the frame of one of them, in
/// ascending order, with disjoint intervals. Gaps are normal.
#[derive(Clone, Debug, Default)]
pub(crate) struct WindowList {
    windows: Vec<Stored>,
}

impl WindowList {
    /// Bytes of one stored window.
    pub(crate) const WINDOW_BYTES: usize = size_of::<Stored>();

    /// Asks for what [`take`](Self::take) looks at first.
    #[inline]
    pub(crate) fn announce(&self) {
        prefetch(&self.windows, 0);
    }

    pub(crate) fn len(&self) -> usize {
        self.windows.len()
    }

    pub(crate) fn clear(&mut self) {
        self.windows.clear();
    }

    /// Puts `pieces` in the place of the windows `range`.
    ///
    /// Most lists stay short and all are kept to the end, so room grows by an eighth and not
    /// to the double.
    fn replace(&mut self, range: Range<usize>, pieces: &[Stored]) {
        if let [piece] = pieces
            && range.len() == 1
        {
            self.windows[range.start] = *piece;
            return;
        }
        let more = pieces.len().saturating_sub(range.len());
        if self.windows.len() + more > self.windows.capacity() {
            self.windows.reserve_exact(more.max(self.windows.len() / 8));
        }
        self.windows.splice(range, pieces.iter().copied());
    }

    /// The ids of the windows that wait in the queue.
    pub(crate) fn waiting(&self) -> impl Iterator<Item = u32> {
        let queued = self.windows.iter().filter(|s| s.tag & QUEUED != 0);
        queued.map(|s| s.tag & !QUEUED)
    }

    /// Takes the window with this id out of the queue; it stays stored. `None` if it has been
    /// removed or replaced.
    pub(crate) fn take(&mut self, id: u32) -> Option<Window> {
        let stored = self.windows.iter_mut().find(|s| s.tag == id | QUEUED)?;
        stored.tag = id;
        Some(stored.window)
    }
}

/// Who is shorter on a range.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Owner {
    New,
    /// The stored window at this place of the list.
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
    pub(crate) id: u32,
    /// The stored window that it is a part of; `None` if of the new one.
    pub(crate) part_of: Option<u32>,
}

/// Inserts windows into lists: the buffers this needs, and what the last insertion did.
#[derive(Clone, Debug, Default)]
pub(crate) struct Inserter {
    next_id: u32,
    segments: Vec<Segment>,
    pieces: Vec<Stored>,
    /// The windows to queue: what is left of the new one, and stored ones whose least distance grew
    /// before their turn came.
    pub(crate) to_queue: Vec<Entry>,
    /// How many of these are pieces of the new window.
    pub(crate) new_pieces: usize,
    /// Stored windows that lost a part.
    pub(crate) trimmed: usize,
    /// Stored windows that lost everything.
    pub(crate) removed: usize,
}

impl Inserter {
    /// Inserts `new`, which crosses in `direction`, into `list`, whose edge has length `l`.
    ///
    /// Each stored window that `new` meets is split at the tie points inside the common range, of
    /// which there may be two, and each part goes to the window that is shorter at its middle.
    /// Ranges that nobody held go to `new`. Takes O(log k + m) for m windows met among k, and the
    /// moving of the windows behind them.
    pub(crate) fn insert(
        &mut self,
        list: &mut WindowList,
        new: &Window,
        direction: Direction,
        l: f64,
    ) {
        self.to_queue.clear();
        (self.new_pieces, self.trimmed, self.removed) = (0, 0, 0);
        let first = list.windows.partition_point(|s| s.window.b1 <= new.b0);
        let met = list.windows[first..]
            .iter()
            .take_while(|s| s.window.b0 < new.b1)
            .count();
        let met_windows = &list.windows[first..first + met];
        self.share_out(met_windows, new, l);
        self.segments.retain(|s| {
            let owner = match s.owner {
                Owner::New => new,
                Owner::Old(i) => &met_windows[i].window,
            };
            !is_sliver(owner, s.start, s.end, l)
        });
        if self.segments.iter().any(|s| s.owner == Owner::New) {
            self.replace(list, first..first + met, new, direction);
        }
    }

    /// Divides the ranges of `met` and `new` between them.
    fn share_out(&mut self, met: &[Stored], new: &Window, l: f64) {
        self.segments.clear();
        let mut covered = new.b0;
        for (i, stored) in met.iter().enumerate() {
            let w = &stored.window;
            let old = Owner::Old(i);
            let (lo, hi) = (w.b0.max(new.b0), w.b1.min(new.b1));
            self.grant(covered, w.b0, Owner::New);
            self.grant(w.b0, lo, old);
            // Ranges that matter to neither are not worth a trim.
            let matters = |start, end| {
                start < end && !(is_sliver(w, start, end, l) && is_sliver(new, start, end, l))
            };
            let mut start = lo;
            if matters(lo, hi) {
                for &tie in tie_points(w, new).as_slice() {
                    if matters(start, tie) && matters(tie, hi) {
                        self.grant(start, tie, shorter(w, new, start, tie, old));
                        start = tie;
                    }
                }
                self.grant(start, hi, shorter(w, new, start, hi, old));
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

    /// Puts the segments in the place of the windows `range` of `list`.
    fn replace(
        &mut self,
        list: &mut WindowList,
        range: Range<usize>,
        new: &Window,
        direction: Direction,
    ) {
        self.pieces.clear();
        let met = &list.windows[range.clone()];
        let mut segments = std::mem::take(&mut self.segments);
        let mut survivors = 0;
        let mut last_old = None;
        for segment in segments.drain(..) {
            match segment.owner {
                Owner::New => {
                    let window = Window {
                        b0: segment.start,
                        b1: segment.end,
                        ..*new
                    };
                    self.new_pieces += 1;
                    self.queue_piece(window, direction, None);
                }
                Owner::Old(i) => {
                    let first_piece = last_old != Some(i);
                    survivors += usize::from(first_piece);
                    last_old = Some(i);
                    self.keep_piece(&met[i], segment.start, segment.end, first_piece);
                }
            }
        }
        self.segments = segments;
        self.removed = met.len() - survivors;
        list.replace(range, &self.pieces);
    }

    /// Stores a window that has to be propagated.
    fn queue_piece(&mut self, window: Window, direction: Direction, part_of: Option<u32>) {
        self.next_id = (self.next_id + 1) & !(QUEUED | REVERSED);
        let id = match direction {
            Direction::Forward => self.next_id,
            Direction::Reverse => self.next_id | REVERSED,
        };
        self.to_queue.push(Entry {
            label: window.min_distance(),
            id,
            part_of,
        });
        self.pieces.push(Stored {
            window,
            tag: id | QUEUED,
        });
    }

    /// Stores what is left of `old` on `start..end`.
    ///
    /// A window that was propagated already is only cut, since its children will be trimmed by
    /// those of the winner; one that still waits is queued again if its least distance grew.
    fn keep_piece(&mut self, old: &Stored, start: f64, end: f64, first_piece: bool) {
        let window = Window {
            b0: start,
            b1: end,
            ..old.window
        };
        let whole = start == old.window.b0 && end == old.window.b1;
        self.trimmed += usize::from(first_piece && !whole);
        let in_queue_as_is =
            first_piece && (whole || window.min_distance() <= old.window.min_distance());
        if old.tag & QUEUED == 0 || in_queue_as_is {
            self.pieces.push(Stored {
                window,
                tag: old.tag,
            });
        } else {
            let id = old.tag & !QUEUED;
            self.queue_piece(window, Direction::of(id), Some(id));
        }
    }
}

/// Whether hardly any ray of `w` passes between `start` and `end`; see [`SLIVER`].
#[inline]
fn is_sliver(w: &Window, start: f64, end: f64, l: f64) -> bool {
    let width = end - start;
    let beside = (start - w.px).max(w.px - end).max(0.0);
    width <= SLIVER * l && width <= SLIVER * (beside + w.py.abs())
}

/// Which of a stored and a new window is shorter on a range without a tie.
///
/// The middle tells, unless they are equal there. Two sources on the line of the edge are equal all
/// along the side on which one stands behind the other, and part where the nearer one stands: the
/// ends tell then.
fn shorter(stored: &Window, new: &Window, start: f64, end: f64, old: Owner) -> Owner {
    let compare = |x: f64| {
        let (held, offered) = (stored.distance(x), new.distance(x));
        if offered < held * MARGIN {
            Ordering::Less
        } else if held < offered * MARGIN {
            Ordering::Greater
        } else {
            Ordering::Equal
        }
    };
    let middle = compare(0.5 * (start + end));
    let wins = match middle {
        Ordering::Equal => {
            let ends = [compare(start), compare(end)];
            ends.contains(&Ordering::Less) && !ends.contains(&Ordering::Greater)
        }
        _ => middle == Ordering::Less,
    };
    if wins { Owner::New } else { old }
}

#[cfg(test)]
mod tests {
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

    fn insert(inserter: &mut Inserter, list: &mut WindowList, new: &Window) {
        inserter.insert(list, new, Direction::Forward, 1.0);
    }

    fn insert_all(windows: &[Window]) -> WindowList {
        let (mut list, mut inserter) = (WindowList::default(), Inserter::default());
        for w in windows {
            insert(&mut inserter, &mut list, w);
        }
        list
    }

    fn at(list: &WindowList, x: f64) -> Option<f64> {
        let held = list
            .windows
            .iter()
            .find(|s| s.window.b0 <= x && x <= s.window.b1);
        held.map(|s| s.window.distance(x))
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
            for pair in list.windows.windows(2) {
                prop_assert!(pair[0].window.b1 <= pair[1].window.b0, "{pair:?} overlap");
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
            let (mut list, mut inserter) = (WindowList::default(), Inserter::default());
            let mut queue = Vec::new();
            for w in &windows {
                insert(&mut inserter, &mut list, w);
                queue.extend_from_slice(&inserter.to_queue);
            }
            // The last entry of an id is the one that counts; older ids are gone from the list.
            let mut found = 0;
            for entry in queue {
                if let Some(w) = list.take(entry.id) {
                    prop_assert!(entry.label <= w.min_distance());
                    found += 1;
                }
            }
            prop_assert_eq!(found, list.len());
        }
    }

    #[test]
    fn the_old_window_wins_a_tie() {
        let w = window(0.0, 1.0, 0.5, -1.0, 0.0);
        let list = insert_all(&[w, w]);
        assert_eq!(list.len(), 1);
    }

    #[test]
    fn a_window_between_two_ties_splits_the_old_one() {
        let far = window(0.0, 1.0, 0.5, -2.0, 0.0);
        let near = window(0.0, 1.0, 0.5, -0.1, 1.85);
        let list = insert_all(&[far, near]);
        assert_eq!(list.len(), 3);
        assert_eq!(at(&list, 0.5), Some(near.distance(0.5)));
        assert_eq!(at(&list, 0.0), Some(far.distance(0.0)));
        assert_eq!(at(&list, 1.0), Some(far.distance(1.0)));
    }

    #[test]
    fn a_propagated_window_is_cut_but_not_queued_again() {
        let (mut list, mut inserter) = (WindowList::default(), Inserter::default());
        insert(&mut inserter, &mut list, &window(0.0, 1.0, 0.2, -1.0, 0.0));
        let id = inserter.to_queue[0].id;
        assert!(list.take(id).is_some());
        assert!(list.take(id).is_none());
        insert(&mut inserter, &mut list, &window(0.0, 0.5, 0.2, -0.5, 0.0));
        assert_eq!(
            (inserter.new_pieces, inserter.trimmed, inserter.removed),
            (1, 1, 0)
        );
        assert_eq!(inserter.to_queue.len(), 1);
    }

    #[test]
    fn a_waiting_window_whose_nearest_point_is_lost_is_queued_again() {
        let (mut list, mut inserter) = (WindowList::default(), Inserter::default());
        insert(&mut inserter, &mut list, &window(0.0, 1.0, 0.2, -1.0, 0.0));
        let first = inserter.to_queue[0];
        insert(&mut inserter, &mut list, &window(0.0, 0.5, 0.2, -0.5, 0.0));
        assert!(
            list.take(first.id).is_none(),
            "the old entry of the queue is void"
        );
        let entries = inserter.to_queue.iter();
        let again: Vec<_> = entries.filter(|e| e.part_of == Some(first.id)).collect();
        assert_eq!(again.len(), 1);
        assert_eq!(
            again[0].label,
            window(0.5, 1.0, 0.2, -1.0, 0.0).min_distance()
        );
    }

    /// The fan of a source that stands on the edge passes through no width at all; when such windows
    /// were dropped as slivers, vertices behind flat faces came out twice as far.
    #[test]
    fn a_window_of_a_source_on_the_edge_is_no_sliver_however_narrow() {
        let whole = window(0.0, 1.0, 0.5, -1.0, 1.0);
        let fan = window(0.0, 1e-14, 0.0, -1e-20, 0.0);
        assert_eq!(insert_all(&[whole, fan]).len(), 2);
        assert_eq!(insert_all(&[fan]).len(), 1);
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
        assert_eq!(list.len(), 2);
        assert!(list.windows.iter().all(|s| s.window.b1 - s.window.b0 > 0.4));
    }
}
