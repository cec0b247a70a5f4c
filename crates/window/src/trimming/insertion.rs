//! Inserts windows into lists: sorted, disjoint, trimmed at tie points.

// Inlining keeps windows in registers while they are compared.
#![allow(clippy::inline_always)]

use std::ops::Range;

use super::compare::{is_sliver, matters};
use super::overlap::{Overlap, Owner, Segment};
use super::overlap_range::{OverlapRange, loses_everywhere};
use crate::window::Window;

/// A list of windows, and new ones that arrive at it; told what trimming does to either.
///
/// An entry is a window with what its owner notes about it, or refers to one that is stored
/// elsewhere. A method that changes a window returns its new entry.
pub trait TrimmedList {
    /// What the list holds for a window.
    type Entry: Copy;

    /// Whether the [origins](Trimmer::origins) of pieces are recorded.
    const RECORDS_ORIGINS: bool = false;

    /// Whether a pass goes on with a window that overlaps the one before, as that was trimmed. Else
    /// windows are compared as they arrive, and such a window starts another pass.
    const CORRECTS_LAST: bool = false;

    /// The entries of the windows, which are ascending and disjoint.
    fn entries(&self) -> &[Self::Entry];

    /// The entries, to be changed in place.
    fn entries_mut(&mut self) -> &mut [Self::Entry];

    /// The window of an entry.
    fn window<'a>(&'a self, entry: &'a Self::Entry) -> &'a Window;

    /// New window number `k`, if there are so many. They may be in any order, but are mostly in
    /// ascending order. The window of a source that [is near](super::is_near) the edge arrives in
    /// [pieces](super::pieces). Not called for a window that is inserted
    /// [alone](Trimmer::insert_one).
    fn arriving(&self, _: usize) -> Option<Window> {
        None
    }

    /// Whether the general [`Overlap`] divides all windows that a new one meets, unless the new one
    /// is nowhere shorter. Else it does so only where several parts may be shorter.
    ///
    /// The overlap places ties by another rule. LCT11 would take a seventh fewer instructions
    /// without it, for the same distances, but one or two windows in a thousand would be trimmed
    /// elsewhere.
    fn divides_all(&self) -> bool {
        false
    }

    /// Makes an entry for `part`, a part of new window number `k`.
    fn keep(&mut self, k: usize, part: Window) -> Self::Entry;

    /// New window number `k` is nowhere shorter: nothing of it is stored.
    fn drop_new(&mut self, k: usize);

    /// A window keeps its part between `b0` and `b1`, and one of its ends is new.
    fn cut(&mut self, old: &Self::Entry, b0: f64, b1: f64) -> Self::Entry;

    /// A window keeps its part between `b0` and `b1` beside one that it keeps further left.
    fn split(&mut self, old: &Self::Entry, b0: f64, b1: f64) -> Self::Entry;

    /// A window keeps nothing.
    fn remove(&mut self, old: &Self::Entry);
}

/// The window of which a piece is a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PieceOrigin {
    /// New window with this number.
    New(usize),
    /// Entry with this index.
    Old(usize),
}

/// Inserts windows into lists; owns the buffers.
///
/// Each stored window that a new one overlaps is split at the tie points in the common range, of
/// which there may be two. Each part goes to the window that is shorter there, to the stored one
/// where they are equal. Ranges without a stored window go to the new one.
///
/// ```
/// use geobench_window::Window;
/// use geobench_window::trimming::{TrimmedList, Trimmer};
///
/// struct List(Vec<Window>);
///
/// impl TrimmedList for List {
///     type Entry = Window;
///     fn entries(&self) -> &[Window] {
///         &self.0
///     }
///     fn entries_mut(&mut self) -> &mut [Window] {
///         &mut self.0
///     }
///     fn window<'a>(&'a self, entry: &'a Window) -> &'a Window {
///         entry
///     }
///     fn keep(&mut self, _: usize, part: Window) -> Window {
///         part
///     }
///     fn drop_new(&mut self, _: usize) {}
///     fn cut(&mut self, old: &Window, b0: f64, b1: f64) -> Window {
///         old.cut(b0, b1)
///     }
///     fn split(&mut self, old: &Window, b0: f64, b1: f64) -> Window {
///         old.cut(b0, b1)
///     }
///     fn remove(&mut self, _: &Window) {}
/// }
///
/// // The sources lie below both ends of an edge of length 1.
/// let old = Window { b0: 0.0, b1: 1.0, px: 0.0, py: -1.0, sigma: 0.0 };
/// let new = Window { px: 1.0, ..old };
/// let mut list = List(vec![old]);
/// let mut trimmer = Trimmer::default();
/// let replaced = trimmer.insert_one(&mut list, 0, &new, 1.0);
/// list.0.splice(replaced, trimmer.pieces().iter().copied());
/// let middle = list.0[0].b1;
/// assert!((middle - 0.5).abs() < 1e-15 && list.0[1].b0 == middle);
/// ```
#[derive(Clone, Debug)]
pub struct Trimmer<E> {
    pieces: Replacement<E>,
    overlap: Overlap,
    met: Vec<Window>,
}

impl<E> Default for Trimmer<E> {
    fn default() -> Self {
        let (entries, origins) = (Vec::new(), Vec::new());
        Self {
            pieces: Replacement { entries, origins },
            overlap: Overlap::default(),
            met: Vec::new(),
        }
    }
}

/// The entries that replace those of a range.
#[derive(Clone, Debug)]
struct Replacement<E> {
    entries: Vec<E>,
    origins: Vec<PieceOrigin>,
}

impl<E: Copy> Trimmer<E> {
    /// Inserts `new` into a list on an edge of length `l`. Returns the range of entries that the
    /// [pieces](Self::pieces) are to replace.
    ///
    /// `first` entries or more end where `new` begins, or before.
    #[inline]
    pub fn insert_one<L: TrimmedList<Entry = E>>(
        &mut self,
        list: &mut L,
        first: usize,
        new: &Window,
        l: f64,
    ) -> Range<usize> {
        let mut pass = ListPass::start(list, &mut self.pieces, first, l);
        if pass.insert::<true>(0, new) {
            pass.end()
        } else {
            self.divide(list, first, 0, new, l)
        }
    }

    /// Inserts the new windows from number `k` on, as far as they can be inserted in one pass.
    /// Returns the range of entries that the [pieces](Self::pieces) are to replace, and the number
    /// of the first window that is left.
    ///
    /// The result is that of inserting the windows [one](Self::insert_one) after the other. Windows
    /// in ascending order share a pass; one out of order starts another, and one of which several
    /// parts may be shortest takes one of its own.
    #[inline]
    pub fn insert<L: TrimmedList<Entry = E>>(
        &mut self,
        list: &mut L,
        first: usize,
        k: usize,
        l: f64,
    ) -> (Range<usize>, usize) {
        let Some(new) = list.arriving(k) else {
            return (0..0, k);
        };
        let mut pass = ListPass::start(list, &mut self.pieces, first, l);
        if !pass.insert::<true>(k, &new) {
            return (self.divide(list, first, k, &new, l), k + 1);
        }
        let next = pass.insert_following(k, &new);
        (pass.end(), next)
    }

    /// The entries that are to replace the range that the last insertion returned.
    #[inline]
    pub fn pieces(&self) -> &[E] {
        &self.pieces.entries
    }

    /// The origins of the [pieces](Self::pieces), if the list
    /// [records](TrimmedList::RECORDS_ORIGINS) them.
    pub fn origins(&self) -> &[PieceOrigin] {
        &self.pieces.origins
    }

    /// Inserts `new` by dividing the whole overlap; several of its intervals may survive.
    #[cold]
    fn divide<L: TrimmedList<Entry = E>>(
        &mut self,
        list: &mut L,
        first: usize,
        k: usize,
        new: &Window,
        l: f64,
    ) -> Range<usize> {
        let pieces = &mut self.pieces;
        pieces.entries.clear();
        let behind = list.entries()[first..].iter().map(|e| list.window(e));
        let first = first + behind.take_while(|w| w.b1 <= new.b0).count();
        let behind = list.entries()[first..].iter().map(|e| list.window(e));
        self.met.clear();
        self.met.extend(behind.take_while(|w| w.b0 < new.b1));
        self.overlap.share_out(&self.met, new, l);
        let segments = self.overlap.segments();
        if !segments.iter().any(|s| s.owner == Owner::New) {
            list.drop_new(k);
            return 0..0;
        }
        let remove_all = |list: &mut L, old: Range<usize>| {
            for i in old {
                let entry = list.entries()[first + i];
                list.remove(&entry);
            }
        };
        // The stored windows before this one are done.
        let mut done = 0;
        for &Segment { start, end, owner } in segments {
            match owner {
                Owner::New => {
                    let entry = list.keep(k, new.cut(start, end));
                    pieces.push::<L>(entry, PieceOrigin::New(k));
                }
                Owner::Old(i) => {
                    let old = list.entries()[first + i];
                    let entry = if i < done {
                        list.split(&old, start, end)
                    } else {
                        remove_all(list, done..i);
                        done = i + 1;
                        if (start, end) == (self.met[i].b0, self.met[i].b1) {
                            old
                        } else {
                            list.cut(&old, start, end)
                        }
                    };
                    pieces.push::<L>(entry, PieceOrigin::Old(first + i));
                }
            }
        }
        remove_all(list, done..self.met.len());
        first..first + self.met.len()
    }
}

impl<E: Copy> Replacement<E> {
    #[inline(always)]
    fn push<L: TrimmedList>(&mut self, entry: E, origin: PieceOrigin) {
        self.entries.push(entry);
        if L::RECORDS_ORIGINS {
            self.origins.push(origin);
        }
    }
}

/// One pass over a list in ascending order.
///
/// Replaced ranges are collected as pieces. A stored window that loses its left part is cut in
/// place.
struct ListPass<'a, L: TrimmedList> {
    list: &'a mut L,
    /// Length of the edge.
    l: f64,
    pieces: &'a mut Replacement<L::Entry>,
    /// The first entry that the pieces replace.
    base: usize,
    /// The first entry that has not been passed. The pieces replace those from `base` up to it.
    next: usize,
}

impl<'a, L: TrimmedList> ListPass<'a, L> {
    /// Starts behind the first `next` entries.
    #[inline(always)]
    fn start(list: &'a mut L, pieces: &'a mut Replacement<L::Entry>, next: usize, l: f64) -> Self {
        pieces.entries.clear();
        if L::RECORDS_ORIGINS {
            pieces.origins.clear();
        }
        Self {
            list,
            l,
            pieces,
            base: next,
            next,
        }
    }

    /// The range that the pieces replace; empty if there are none.
    #[inline(always)]
    fn end(self) -> Range<usize> {
        if self.pieces.entries.is_empty() {
            0..0
        } else {
            self.base..self.next
        }
    }

    /// Stored window number `i`.
    #[inline(always)]
    fn old(&self, i: usize) -> Option<&Window> {
        let entry = self.list.entries().get(i)?;
        Some(self.list.window(entry))
    }

    /// Inserts the new windows behind number `k`, which is `new`, as long as they are in ascending
    /// order. Returns the number of the first one that is left.
    #[inline(always)]
    fn insert_following(&mut self, k: usize, new: &Window) -> usize {
        // The window before. All windows that end where it begins, or before, have been passed.
        let (mut previous, mut b0, mut b1) = (k, new.b0, new.b1);
        let mut k = k + 1;
        while let Some(new) = self.list.arriving(k) {
            if new.b0 < b0 {
                break;
            }
            if L::CORRECTS_LAST {
                let last = self.pieces.entries.last();
                b1 = last.map_or(new.b0, |e| self.list.window(e).b1);
            }
            let mut rest = new;
            if new.b0 < b1 {
                let last = if L::CORRECTS_LAST {
                    let last = self.pieces.entries.last();
                    last.map(|e| *self.list.window(e))
                } else {
                    self.list.arriving(previous)
                };
                let last = last.unwrap_or(new);
                if matters(&last, &new, new.b0, b1.min(new.b1), self.l) {
                    if !L::CORRECTS_LAST || new.b0 < last.b0 || !self.insert_over_last(k, &new) {
                        break;
                    }
                    (b0, k) = (new.b0, k + 1);
                    continue;
                }
                if new.b1 <= b1 {
                    self.list.drop_new(k);
                    k += 1;
                    continue;
                }
                // They only touch: the overlap is due to rounding.
                rest.b0 = b1;
            }
            self.pass(rest.b0);
            if !self.insert::<false>(k, &rest) {
                break;
            }
            (previous, b0, b1) = (k, new.b0, new.b1);
            k += 1;
        }
        k
    }

    /// Passes the windows that end at or before `x`.
    #[inline(always)]
    fn pass(&mut self, x: f64) {
        while let Some(entry) = self.list.entries().get(self.next)
            && self.list.window(entry).b1 <= x
        {
            if !self.pieces.entries.is_empty() {
                (self.pieces).push::<L>(*entry, PieceOrigin::Old(self.next));
            }
            self.next += 1;
        }
    }

    /// Inserts `new`, number `k`, which begins at or after the end of the passed windows and of the
    /// pieces; there are none yet if it is the `FIRST` one. Returns false and changes nothing if
    /// several parts of `new` may be shortest.
    #[inline(always)]
    fn insert<const FIRST: bool>(&mut self, k: usize, new: &Window) -> bool {
        let list = &*self.list;
        let behind = list.entries()[self.next..].iter().map(|e| list.window(e));
        if list.divides_all() {
            let is_lost = loses_everywhere(behind, new, self.l);
            if is_lost {
                self.list.drop_new(k);
            }
            return is_lost;
        }
        match OverlapRange::of(behind, new, self.l) {
            OverlapRange::Empty => self.list.drop_new(k),
            OverlapRange::Single(start, end) => {
                if FIRST {
                    while self.old(self.next).is_some_and(|w| w.b1 <= start) {
                        self.next += 1;
                    }
                } else {
                    self.pass(start);
                }
                if FIRST || self.pieces.entries.is_empty() {
                    self.base = self.next;
                }
                self.put(k, new.cut(start, end));
            }
            OverlapRange::Undecided => return false,
        }
        true
    }

    /// [`insert`](Self::insert) for a window that begins within the last piece.
    #[inline(never)]
    fn insert_over_last(&mut self, k: usize, new: &Window) -> bool {
        let Some(&last) = self.pieces.entries.last() else {
            return false;
        };
        let list = &*self.list;
        let whole = *list.window(&last);
        let behind = list.entries()[self.next..].iter().map(|e| list.window(e));
        let (start, end) =
            match OverlapRange::of(std::iter::once(&whole).chain(behind), new, self.l) {
                OverlapRange::Empty => {
                    self.list.drop_new(k);
                    return true;
                }
                OverlapRange::Single(start, end) => (start, end),
                OverlapRange::Undecided => return false,
            };
        let (b0, b1) = (whole.b0, whole.b1);
        if b1 <= start {
            self.pass(start);
            return self.insert::<false>(k, &new.cut(start, end));
        }
        self.pieces.entries.pop();
        let origin = self.pieces.origins.pop().unwrap_or(PieceOrigin::New(k));
        let keeps_left = b0 < start && !is_sliver(&whole, b0, start, self.l);
        let keeps_right = end < b1 && !is_sliver(&whole, end, b1, self.l);
        if keeps_left {
            let left = self.list.cut(&last, b0, start);
            self.pieces.push::<L>(left, origin);
        }
        if keeps_right {
            let piece = self.list.keep(k, new.cut(start, end));
            self.pieces.push::<L>(piece, PieceOrigin::New(k));
            let right = if keeps_left {
                self.list.split(&last, end, b1)
            } else {
                self.list.cut(&last, end, b1)
            };
            self.pieces.push::<L>(right, origin);
        } else {
            self.put(k, new.cut(start, end));
        }
        if !(keeps_left || keeps_right) {
            self.list.remove(&last);
        }
        true
    }

    /// Appends `part` of new window number `k` to the pieces, and takes its range from the windows
    /// that have not been passed.
    #[inline(always)]
    fn put(&mut self, k: usize, part: Window) {
        let (first, start, end) = (self.next, part.b0, part.b1);
        let is_left = |w: &&Window| w.b0 < start && !is_sliver(w, w.b0, start, self.l);
        let left = self.old(first).filter(is_left).map(|w| w.b0);
        let mut to = first;
        while self.old(to).is_some_and(|w| w.b1 <= end) {
            to += 1;
        }
        let mut right = None;
        if let Some(w) = self.old(to)
            && w.b0 < end
        {
            if is_sliver(w, end, w.b1, self.l) {
                to += 1;
            } else {
                right = Some(w.b1);
            }
        }
        if let Some(b0) = left {
            let old = self.list.entries()[first];
            let left = self.list.cut(&old, b0, start);
            self.pieces.push::<L>(left, PieceOrigin::Old(first));
        }
        let piece = self.list.keep(k, part);
        self.pieces.push::<L>(piece, PieceOrigin::New(k));
        for i in first + usize::from(left.is_some())..to {
            if let Some(&old) = self.list.entries().get(i) {
                self.list.remove(&old);
            }
        }
        if let Some(b1) = right {
            let old = self.list.entries()[to];
            let rest = if left.is_some() && to == first {
                self.list.split(&old, end, b1)
            } else {
                self.list.cut(&old, end, b1)
            };
            self.list.entries_mut()[to] = rest;
        }
        self.next = to;
    }
}
