//! Windows stored on edges with their sources. Those of both directions are trimmed together.

use std::ops::Range;

use geobench_mesh::HalfEdgeId;
use geobench_window::Window;
use geobench_window::blocks::BlockLists;
use geobench_window::trimming::{TrimmedList, Trimmer, is_near, pieces};

use crate::field::NO_SOURCE;

/// A window of a list, in the frame of the edge's first half-edge, whichever way it crosses.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Stored {
    pub(crate) window: Window,
    /// The number of its source, with the flags [`WAITS`] and [`REVERSED`] in the highest bits.
    marks: u32,
    /// The number by which a queue finds it in its list.
    pub(crate) serial: u32,
}

/// The window waits to cross the face ahead of it.
const WAITS: u32 = 1 << 31;
/// The window crosses from above the edge to below it.
const REVERSED: u32 = 1 << 30;

impl Stored {
    /// A window of `source` that waits; it is in the frame of the edge.
    #[inline]
    pub(crate) fn waiting(window: Window, is_reversed: bool, source: u32) -> Self {
        Self {
            window,
            marks: source | WAITS | if is_reversed { REVERSED } else { 0 },
            serial: 0,
        }
    }

    /// Its part between `b0` and `b1`.
    #[inline]
    pub(crate) fn cut(&self, b0: f64, b1: f64) -> Self {
        let window = self.window.cut(b0, b1);
        Self { window, ..*self }
    }

    /// Number of the source from which the window comes.
    #[inline]
    pub(crate) fn source(&self) -> u32 {
        self.marks & !(WAITS | REVERSED)
    }

    /// Whether the window waits to cross.
    #[inline]
    pub(crate) fn waits(&self) -> bool {
        self.marks & WAITS != 0
    }

    /// Whether the window crosses by the second half-edge of the edge.
    #[inline]
    pub(crate) fn is_reversed(&self) -> bool {
        self.marks & REVERSED != 0
    }
}

/// The source of all windows that a list has held, [`SEVERAL`], or [`NO_SOURCE`].
#[derive(Clone, Copy, Debug)]
struct ListSource(u32);

impl Default for ListSource {
    fn default() -> Self {
        Self(NO_SOURCE)
    }
}

/// Greatest number of windows of a list that are prefetched.
const MOST_PREFETCHED: usize = 16;

/// The source of a list whose windows have come from several.
const SEVERAL: u32 = u32::MAX - 1;

/// A part of a window that has to be queued.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Waiting {
    /// Its least distance.
    pub(crate) label: f64,
    pub(crate) serial: u32,
    pub(crate) is_reversed: bool,
}

/// The effects of an insertion.
#[derive(Clone, Debug)]
pub(crate) struct Changes {
    /// Windows to queue one by one: the stored parts of the new window, and additional parts of
    /// stored windows that wait. Empty after a [merge](EdgeWindows::merge), whose windows are
    /// queued together.
    pub(crate) waiting: Vec<Waiting>,
    /// Number of stored parts of new windows.
    pub(crate) new_parts: usize,
    /// Their least distance; infinite if there are none.
    pub(crate) least: f64,
    /// Number of new windows, or of their [pieces], of which nothing is stored.
    pub(crate) dropped: usize,
    /// Number of additional parts of stored windows that wait.
    pub(crate) split: usize,
    /// Number of stored windows that lost a part.
    pub(crate) trimmed: usize,
    /// Number of stored windows that lost everything.
    pub(crate) removed: usize,
}

impl Default for Changes {
    fn default() -> Self {
        Self {
            waiting: Vec::new(),
            new_parts: 0,
            least: f64::INFINITY,
            dropped: 0,
            split: 0,
            trimmed: 0,
            removed: 0,
        }
    }
}

impl Changes {
    fn clear(&mut self) {
        let mut waiting = std::mem::take(&mut self.waiting);
        waiting.clear();
        *self = Self {
            waiting,
            ..Self::default()
        };
    }
}

/// The windows of all edges. The windows of one edge have disjoint intervals in ascending order;
/// gaps are normal. An edge has the number of the lesser one of its two half-edges, and its windows
/// are in the frame of that half-edge.
#[derive(Clone, Debug)]
pub(crate) struct EdgeWindows {
    lists: BlockLists<Stored, ListSource>,
    waiting: usize,
    counts_waiting: bool,
    next_serial: u32,
    trimmer: Trimmer<Stored>,
    pub(crate) changes: Changes,
}

impl EdgeWindows {
    /// Bytes of one stored window.
    pub(crate) const WINDOW_BYTES: usize = size_of::<Stored>();

    /// Empty lists for the edges of a mesh with this number of half-edges.
    pub(crate) fn new(half_edges: usize) -> Self {
        Self {
            lists: BlockLists::new(half_edges, 0),
            waiting: 0,
            counts_waiting: false,
            next_serial: 0,
            trimmer: Trimmer::default(),
            changes: Changes::default(),
        }
    }

    /// Changes the number of half-edges of the mesh. [`clear`](Self::clear) has to follow.
    pub(crate) fn set_edges(&mut self, half_edges: usize) {
        self.lists.set_count(half_edges, 0);
    }

    /// Empties all lists and opens them. If `counts_waiting`, windows that wait are counted from
    /// now on.
    pub(crate) fn clear(&mut self, counts_waiting: bool) {
        self.counts_waiting = counts_waiting;
        self.lists.clear();
        (self.waiting, self.next_serial) = (0, 0);
    }

    /// Number of windows that are stored.
    pub(crate) fn stored(&self) -> usize {
        self.lists.stored()
    }

    /// Number of windows that wait; 0 if they are not [counted](Self::clear).
    pub(crate) fn waiting(&self) -> usize {
        self.waiting
    }

    /// The windows of edge `e`.
    #[inline]
    pub(crate) fn list(&self, e: usize) -> &[Stored] {
        self.lists.entries(e)
    }

    /// Whether all windows of edge `e` come from `source`.
    #[inline]
    pub(crate) fn has_one_source(&self, e: usize, source: u32) -> bool {
        match self.lists.note(e).0 {
            _ if self.lists.is_empty(e) => true,
            SEVERAL => self.list(e).iter().all(|s| s.source() == source),
            first => first == source,
        }
    }

    /// Prefetches the head of the list of edge `e`.
    #[inline]
    pub(crate) fn prefetch_list(&self, e: usize) {
        self.lists.prefetch_head(e);
    }

    /// Prefetches the windows of edge `e`, whose list was [prefetched](Self::prefetch_list) before.
    #[inline]
    pub(crate) fn prefetch_windows(&self, e: usize) {
        // Four windows fill three cache lines; the prefetch of every second one requests all three.
        let chosen = |len: usize| (0..len.min(MOST_PREFETCHED)).step_by(2);
        self.lists.prefetch_entries(e, chosen);
    }

    /// All windows that are stored.
    pub(crate) fn all(&self) -> impl Iterator<Item = &Stored> {
        (0..self.lists.count()).flat_map(|e| self.list(e))
    }

    /// Whether edge `e` is closed: it stores no more windows.
    #[inline]
    pub(crate) fn is_closed(&self, e: usize) -> bool {
        self.lists.is_closed(e)
    }

    /// Removes the windows of edge `e`, and closes it if `and_close`. Returns the number of windows
    /// removed.
    pub(crate) fn give_up(&mut self, e: usize, and_close: bool) -> usize {
        let count = self.lists.len(e);
        self.count_waiting(e, 0..count, 0);
        self.lists.remove_all(e, and_close);
        count
    }

    /// The windows that wait on edge `e` and cross in this direction.
    pub(crate) fn waiting_on(&self, e: usize, is_reversed: bool) -> impl Iterator<Item = &Stored> {
        let list = self.list(e).iter();
        list.filter(move |s| s.waits() && s.is_reversed() == is_reversed)
    }

    /// Appends to `batch` the windows that wait on edge `e` of length `l` and cross in this
    /// direction. In `batch` they are in the frame of the half-edge by which they cross, in
    /// ascending order there. They stay stored and no longer wait.
    #[inline]
    pub(crate) fn take_all(
        &mut self,
        e: usize,
        is_reversed: bool,
        l: f64,
        batch: &mut Vec<Stored>,
    ) {
        let before = batch.len();
        let mut take = |stored: &mut Stored, window: fn(&Window, f64) -> Window| {
            if stored.waits() && stored.is_reversed() == is_reversed {
                stored.marks &= !WAITS;
                batch.push(Stored {
                    window: window(&stored.window, l),
                    ..*stored
                });
            }
        };
        let list = self.lists.entries_mut(e).0.iter_mut();
        if is_reversed {
            list.rev().for_each(|s| take(s, Window::reversed));
        } else {
            list.for_each(|s| take(s, |w, _| *w));
        }
        if self.counts_waiting {
            self.waiting -= batch.len() - before;
        }
    }

    /// Window number `serial` of edge `e`, if it still waits.
    pub(crate) fn find(&self, e: usize, serial: u32) -> Option<&Stored> {
        let mut list = self.list(e).iter();
        list.find(|s| s.serial == serial && s.waits())
    }

    /// Marks window number `serial` of edge `e` as no longer waiting. It stays stored.
    pub(crate) fn take(&mut self, e: usize, serial: u32) {
        let mut list = self.lists.entries_mut(e).0.iter_mut();
        if let Some(stored) = list.find(|s| s.serial == serial && s.waits()) {
            stored.marks &= !WAITS;
            self.waiting -= usize::from(self.counts_waiting);
        }
    }

    /// Inserts a window of `source`, in the frame of the edge, on edge `e` of length `l`. Its
    /// stored parts wait. The effects are recorded in [`changes`](Self::changes).
    ///
    /// Ranges that it shares with stored windows are divided at tie points, regardless of the
    /// directions: a window that is longer at a point of the edge is on no shortest path beyond
    /// that point.
    pub(crate) fn insert(
        &mut self,
        e: usize,
        new: &Window,
        is_reversed: bool,
        source: u32,
        l: f64,
    ) {
        let new = Stored::waiting(*new, is_reversed, source);
        if !is_near(&new.window, l) {
            return self.insert_all(e, &[new], l, true);
        }
        let stored = self.list(e).iter().map(|s| &s.window);
        let pieces = pieces(&new.window, l, stored).map(|window| Stored { window, ..new });
        self.insert_all(e, &pieces.collect::<Vec<_>>(), l, true);
    }

    /// Inserts windows as they are to be stored, which then wait, on edge
    /// `e` of length `l`. They are in the frame of the edge, mostly in ascending order. The effects
    /// are recorded in [`changes`](Self::changes).
    pub(crate) fn merge(&mut self, e: usize, batch: &[Stored], l: f64) {
        self.insert_all(e, batch, l, false);
    }

    /// [`merge`](Self::merge), and lists the windows to queue if `one_by_one`.
    #[inline]
    fn insert_all(&mut self, e: usize, batch: &[Stored], l: f64, one_by_one: bool) {
        self.changes.clear();
        let mut k = 0;
        while let Some(new) = batch.get(k) {
            let first = self.lists.leading(e, |s| s.window.b1 <= new.window.b0);
            let mut arrivals = EdgeArrivals {
                list: self.lists.entries_mut(e).0,
                batch,
                one_by_one,
                next_serial: &mut self.next_serial,
                changes: &mut self.changes,
            };
            let (old, next) = self.trimmer.insert(&mut arrivals, first, k, l);
            let pieces = self.trimmer.pieces();
            if !pieces.is_empty() {
                self.replace(e, old);
            }
            k = next;
        }
    }

    /// Replaces the windows `old` of edge `e` by the pieces of the trimmer, and updates the counts
    /// and the source of the list.
    #[inline]
    fn replace(&mut self, e: usize, old: Range<usize>) {
        if self.counts_waiting {
            let waiting = self.trimmer.pieces().iter().filter(|s| s.waits()).count();
            self.count_waiting(e, old.clone(), waiting);
        }
        let new = self.trimmer.pieces();
        let ListSource(source) = self.lists.note_mut(e);
        for stored in new {
            if *source != stored.source() {
                *source = if *source == NO_SOURCE {
                    stored.source()
                } else {
                    SEVERAL
                };
            }
        }
        self.lists.replace(e, old, new);
    }

    /// Updates the number of windows that wait, for a replacement of the windows `old` of edge `e`
    /// by others of which `waiting` wait.
    fn count_waiting(&mut self, e: usize, old: Range<usize>, waiting: usize) {
        if self.counts_waiting {
            let replaced = self.list(e)[old].iter().filter(|s| s.waits()).count();
            self.waiting = self.waiting + waiting - replaced;
        }
    }
}

/// The arrival of windows at an edge.
struct EdgeArrivals<'a> {
    list: &'a mut [Stored],
    batch: &'a [Stored],
    /// Whether the windows were not announced together: those to queue are listed.
    one_by_one: bool,
    next_serial: &'a mut u32,
    changes: &'a mut Changes,
}

impl EdgeArrivals<'_> {
    /// Numbers a part of a window, and lists it to be queued.
    #[inline]
    fn number(&mut self, part: &mut Stored, label: impl Fn(&Window) -> f64) {
        part.serial = *self.next_serial;
        *self.next_serial = self.next_serial.wrapping_add(1);
        if self.one_by_one && part.waits() {
            self.changes.waiting.push(Waiting {
                label: label(&part.window),
                serial: part.serial,
                is_reversed: part.is_reversed(),
            });
        }
    }
}

impl TrimmedList for EdgeArrivals<'_> {
    type Entry = Stored;

    const CORRECTS_LAST: bool = true;

    #[inline]
    fn entries(&self) -> &[Stored] {
        self.list
    }

    #[inline]
    fn entries_mut(&mut self) -> &mut [Stored] {
        self.list
    }

    #[inline]
    fn window<'a>(&'a self, entry: &'a Stored) -> &'a Window {
        &entry.window
    }

    #[inline]
    fn arriving(&self, k: usize) -> Option<Window> {
        self.batch.get(k).map(|new| new.window)
    }

    #[inline]
    fn divides_all(&self) -> bool {
        self.one_by_one
    }

    #[inline]
    fn keep(&mut self, k: usize, window: Window) -> Stored {
        self.changes.new_parts += 1;
        let label = window.min_distance();
        if label < self.changes.least {
            self.changes.least = label;
        }
        let mut part = Stored {
            window,
            ..self.batch[k]
        };
        self.number(&mut part, |_| label);
        part
    }

    #[inline]
    fn drop_new(&mut self, _: usize) {
        self.changes.dropped += 1;
    }

    #[inline]
    fn cut(&mut self, old: &Stored, b0: f64, b1: f64) -> Stored {
        self.changes.trimmed += 1;
        old.cut(b0, b1)
    }

    #[inline]
    fn split(&mut self, old: &Stored, b0: f64, b1: f64) -> Stored {
        self.changes.split += usize::from(old.waits());
        let mut part = old.cut(b0, b1);
        self.number(&mut part, Window::min_distance);
        part
    }

    #[inline]
    fn remove(&mut self, _: &Stored) {
        self.changes.removed += 1;
    }
}

/// The number of the edge of half-edge `h` with twin `twin`, and whether windows that cross by `h`
/// are reversed there.
#[inline]
pub(crate) fn edge_of(h: HalfEdgeId, twin: HalfEdgeId) -> (usize, bool) {
    (h.min(twin).index(), twin < h)
}

#[cfg(test)]
mod tests {
    use geobench_mesh::SplitMix64;

    use super::*;

    const WINDOW: Window = Window {
        b0: 0.0,
        b1: 1.0,
        px: 0.5,
        py: -1.0,
        sigma: 0.0,
    };

    fn ends(lists: &EdgeWindows) -> Vec<(f64, f64, u32)> {
        let list = lists.list(0).iter();
        list.map(|s| (s.window.b0, s.window.b1, s.source()))
            .collect()
    }

    #[test]
    fn windows_of_both_directions_share_an_edge() {
        let mut lists = EdgeWindows::new(1);
        lists.clear(true);
        lists.insert(0, &WINDOW, false, 0, 1.0);
        let from_above = Window {
            px: 1.5,
            py: 1.0,
            ..WINDOW
        };
        lists.insert(0, &from_above, true, 1, 1.0);
        // The bisector of (0.5, -1) and (1.5, 1) meets the edge at 1: the new window wins nothing.
        assert_eq!(ends(&lists), [(0.0, 1.0, 0)]);
        let nearer = Window {
            px: 1.0,
            ..from_above
        };
        lists.insert(0, &nearer, true, 1, 1.0);
        assert_eq!(ends(&lists), [(0.0, 0.75, 0), (0.75, 1.0, 1)]);
        assert_eq!((lists.stored(), lists.waiting()), (2, 2));
        assert_eq!((lists.changes.trimmed, lists.changes.new_parts), (1, 1));
        let mut batch = Vec::new();
        lists.take_all(0, true, 1.0, &mut batch);
        assert_eq!((batch.len(), lists.waiting()), (1, 1));
        assert_eq!(lists.waiting_on(0, false).count(), 1);
        assert_eq!(lists.waiting_on(0, true).count(), 0);
    }

    #[test]
    fn a_window_that_is_split_keeps_its_number_once() {
        let mut lists = EdgeWindows::new(1);
        lists.clear(true);
        let far = Window { py: -3.0, ..WINDOW };
        lists.insert(0, &far, false, 0, 1.0);
        let near = Window {
            py: -0.1,
            sigma: 2.7,
            ..WINDOW
        };
        lists.insert(0, &near, false, 1, 1.0);
        let list = lists.list(0);
        assert_eq!(list.len(), 3);
        assert!(list[0].serial != list[2].serial && list[0].source() == list[2].source());
        assert_eq!(lists.changes.waiting.len(), 2);
        assert_eq!(lists.changes.new_parts, 1);
    }

    #[test]
    fn closed_lists_stay_empty() {
        let mut lists = EdgeWindows::new(2);
        lists.clear(true);
        lists.insert(0, &WINDOW, false, 0, 1.0);
        assert_eq!(lists.give_up(0, true), 1);
        assert!(lists.is_closed(0) && !lists.is_closed(1));
        assert_eq!((lists.stored(), lists.waiting()), (0, 0));
    }

    /// A batch of windows in ascending order, from sources below the edge, or above it if
    /// `is_reversed`.
    fn random_batch(random: &mut SplitMix64, is_reversed: bool) -> Vec<Stored> {
        let mut number = |low: f64, high: f64| {
            low + (high - low) * (random.next() >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut batch: Vec<Stored> = (0..5)
            .map(|source| {
                let (a, b) = (number(0.0, 1.0), number(0.0, 1.0));
                let y = number(0.1, 2.0);
                let window = Window {
                    b0: a.min(b),
                    b1: a.max(b),
                    px: number(-1.0, 2.0),
                    py: if is_reversed { y } else { -y },
                    sigma: number(0.0, 1.0),
                };
                Stored::waiting(window, is_reversed, source)
            })
            .collect();
        batch.sort_by(|a, b| a.window.b0.total_cmp(&b.window.b0));
        batch
    }

    #[test]
    fn merging_a_batch_is_inserting_its_windows_one_after_the_other() {
        let mut random = SplitMix64::new(5);
        let (mut kept, mut lost) = (0, 0);
        for _ in 0..2000 {
            let (mut merged, mut inserted) = (EdgeWindows::new(1), EdgeWindows::new(1));
            for lists in [&mut merged, &mut inserted] {
                lists.clear(true);
            }
            for is_reversed in [false, true, false] {
                let batch = random_batch(&mut random, is_reversed);
                merged.merge(0, &batch, 1.0);
                let mut single = Changes::default();
                for new in &batch {
                    inserted.insert(0, &new.window, is_reversed, new.source(), 1.0);
                    let changes = &inserted.changes;
                    single.new_parts += changes.new_parts;
                    single.dropped += changes.dropped;
                    single.least = single.least.min(changes.least);
                    single.split += changes.split;
                    single.trimmed += changes.trimmed;
                    single.removed += changes.removed;
                }
                let counts = |c: &Changes| [c.new_parts, c.dropped, c.split, c.trimmed, c.removed];
                assert_eq!(counts(&merged.changes), counts(&single));
                assert!(
                    (merged.changes.least - single.least).abs() <= 1e-12 || single.new_parts == 0
                );
                kept += single.new_parts;
                lost += single.dropped;
                let (a, b) = (ends(&merged), ends(&inserted));
                assert_eq!(a.len(), b.len(), "{a:?} {b:?}");
                for (a, b) in a.iter().zip(&b) {
                    let moved = (a.0 - b.0).abs().max((a.1 - b.1).abs());
                    assert!(a.2 == b.2 && moved <= 1e-9, "{a:?} {b:?}");
                }
                assert_eq!(
                    (merged.stored(), merged.waiting()),
                    (inserted.stored(), inserted.waiting())
                );
            }
        }
        assert!(kept > 5_000 && lost > 5_000, "{kept} {lost}");
    }

    #[test]
    fn one_source_of_a_list_is_told_apart_from_several() {
        let mut lists = EdgeWindows::new(1);
        lists.clear(false);
        assert!(lists.has_one_source(0, 3));
        let far = Window {
            b1: 0.5,
            py: -3.0,
            ..WINDOW
        };
        lists.insert(0, &far, false, 3, 1.0);
        assert!(lists.has_one_source(0, 3) && !lists.has_one_source(0, 4));
        lists.insert(0, &Window { b0: 0.5, ..WINDOW }, false, 4, 1.0);
        assert!(!lists.has_one_source(0, 3) && !lists.has_one_source(0, 4));
        // The window of source 3 is trimmed away: what the list holds counts, not what it has held.
        lists.insert(0, &WINDOW, false, 4, 1.0);
        assert!(lists.has_one_source(0, 4) && !lists.has_one_source(0, 3));
    }
}
