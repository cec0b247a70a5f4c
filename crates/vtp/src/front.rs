//! The traversed area and the lists of windows on its border.

use geobench_window::Window;
use geobench_window::queue::MinHeap;
use geobench_window::trimming::KeptWindows;

use crate::engine::layout::{half_edge, parts};
use crate::engine::store::{COLUMNS, Columns, NO_LIST, WindowStore};

/// The side on which a window left the face below its half-edge.
///
/// A half-edge is the left exit of one half-edge and the right exit of another. Windows that arrive
/// as left children lie before those that arrive as right children. So two lists, read one after
/// the other, keep the windows in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ChildSide {
    /// Through the left exit of a face.
    AsLeftChild = 0,
    /// Through the right exit of a face, or from the vertex opposite the half-edge.
    AsRightChild = 1,
}

/// The lists and the state of a face, in half a cache line.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(32))]
struct FaceLists {
    /// The two lists that wait on each half-edge.
    lists: [[u32; 2]; 3],
    /// The step in which the face joined the area. A number of an earlier run if it has not joined.
    joined: u32,
    /// Whether the lists on each half-edge are queued to cross.
    queued: [bool; 3],
}

/// The traversed area, and the windows that wait. A list crosses the face in front of it as soon as
/// that face belongs to the area. Until then it waits on the wavefront, the border of the area.
#[derive(Clone, Debug)]
pub(crate) struct Front {
    places: Vec<FaceLists>,
    /// The windows of all lists.
    pub(crate) store: WindowStore,
    /// The number of this step; `before` is that of the last step of the previous run.
    step: u32,
    before: u32,
    /// Half-edges whose lists are queued to cross a face of the area. The first `crossed` of them
    /// have crossed.
    ready: Vec<u32>,
    crossed: usize,
    /// Whether the face on either side is thin, by half-edge; empty if no face is thin.
    thin: Vec<bool>,
    /// Half-edges beside thin faces of the area with waiting lists, by the least distance of their
    /// windows. In first-in, first-out order, these windows would wind around a needle before the
    /// windows that beat them have arrived.
    nearest: MinHeap<u32>,
}

impl Front {
    /// An empty area on a mesh with this number of faces. `thin` marks the half-edges beside thin
    /// faces and is empty without any.
    pub(crate) fn new(faces: usize, thin: Vec<bool>) -> Self {
        Self {
            thin,
            nearest: MinHeap::default(),
            places: vec![FaceLists::default(); faces],
            store: WindowStore::new(),
            step: 0,
            before: 0,
            ready: Vec::new(),
            crossed: 0,
        }
    }

    /// Changes the number of faces, and the half-edges beside thin ones; see [`new`](Self::new).
    pub(crate) fn splice(&mut self, faces: usize, thin: Vec<bool>) {
        self.reset();
        self.places.resize(faces, FaceLists::default());
        self.thin = thin;
    }

    /// Clears the state of the last run. No list may be queued. O(faces) after a run that ended
    /// while windows waited.
    pub(crate) fn reset(&mut self) {
        if self.waiting() > 0 {
            for face in 0..self.places.len() as u32 {
                (0..3).for_each(|corner| self.clear(half_edge(face, corner)));
            }
        }
        self.nearest.clear();
        self.before = self.step;
        // A run has fewer steps than this.
        if self.step > u32::MAX / 2 {
            (self.step, self.before) = (0, 0);
            for place in &mut self.places {
                place.joined = 0;
            }
        }
    }

    /// Begins the next step.
    pub(crate) fn advance(&mut self) {
        self.step += 1;
    }

    /// Whether `face` belongs to the area.
    #[inline]
    pub(crate) fn contains(&self, face: usize) -> bool {
        self.places[face].joined > self.before
    }

    /// Whether `face` joined in this step.
    #[inline]
    pub(crate) fn is_new(&self, face: usize) -> bool {
        self.places[face].joined == self.step
    }

    /// Makes `face` join in this step, if it has not joined, and queues the lists that wait for it.
    #[inline]
    pub(crate) fn join(&mut self, face: usize) {
        if !self.contains(face) {
            self.places[face].joined = self.step;
            for corner in 0..3 {
                if self.places[face].lists[corner] != [NO_LIST; 2] {
                    self.make_ready(half_edge(face as u32, corner));
                }
            }
        }
    }

    /// Queues the non-empty lists on `h`, if its face has joined.
    #[inline]
    pub(crate) fn make_ready(&mut self, h: u32) {
        let (face, corner) = parts(h);
        let place = &mut self.places[face];
        if place.joined > self.before && !place.queued[corner] {
            if !self.thin.is_empty() && self.thin[h as usize] {
                self.wait_by_distance(h);
                return;
            }
            place.queued[corner] = true;
            self.ready.push(h);
        }
    }

    /// Queues the lists on `h`, beside a thin face, by the least distance of their windows.
    #[cold]
    fn wait_by_distance(&mut self, h: u32) {
        let distance = self.least_distance(h);
        self.nearest.push(distance, h);
    }

    /// The least distance of the windows on `h`.
    #[cold]
    pub(crate) fn least_distance(&self, h: u32) -> f64 {
        let (face, corner) = parts(h);
        let windows = (self.places[face].lists[corner].into_iter())
            .flat_map(|list| self.store.windows_at(list, 0..self.store.len(list)));
        windows.fold(f64::INFINITY, |d, w| d.min(w.min_distance()))
    }

    /// Takes the half-edge beside a thin face whose nearest window has the least distance, if that
    /// is less than `d`. Its lists may have crossed already.
    #[inline]
    pub(crate) fn next_thin(&mut self, d: f64) -> Option<u32> {
        self.nearest.peek().filter(|&(nearest, _)| nearest < d)?;
        self.nearest.pop().map(|(_, h)| h)
    }

    /// Takes the half-edge that has been queued longest.
    #[inline]
    pub(crate) fn next_ready(&mut self) -> Option<u32> {
        let Some(&h) = self.ready.get(self.crossed) else {
            self.ready.clear();
            self.crossed = 0;
            return None;
        };
        self.crossed += 1;
        let (face, corner) = parts(h);
        self.places[face].queued[corner] = false;
        Some(h)
    }

    /// The half-edge that is taken after `after` others.
    #[inline]
    pub(crate) fn upcoming(&self, after: usize) -> Option<u32> {
        self.ready.get(self.crossed + after).copied()
    }

    /// Number of windows that wait.
    pub(crate) fn waiting(&self) -> usize {
        self.store.waiting()
    }

    /// All windows that wait.
    pub(crate) fn windows(&self) -> impl Iterator<Item = Window> {
        self.store.windows()
    }

    /// The windows that wait on `h`.
    pub(crate) fn windows_on(&self, h: u32) -> impl Iterator<Item = Window> {
        let (face, corner) = parts(h);
        let lists = self.places[face].lists[corner].into_iter();
        lists.flat_map(|list| self.store.windows_at(list, 0..self.store.len(list)))
    }

    /// The windows of both lists on `h`, in order.
    #[inline]
    pub(crate) fn lists(&self, h: u32) -> [Columns<'_>; 2] {
        let (face, corner) = parts(h);
        let lists = self.places[face].lists[corner];
        lists.map(|list| self.store.columns(list))
    }

    /// The first list on `h`: that of left children, or of all windows once they have been ordered.
    pub(crate) fn first(&self, h: u32) -> u32 {
        let (face, corner) = parts(h);
        self.places[face].lists[corner][0]
    }

    /// Removes the windows from the lists on `h` that `kept` has replaced since they arrived.
    #[cold]
    pub(crate) fn drop_replaced(&mut self, h: u32, kept: &KeptWindows) {
        let (face, corner) = parts(h);
        for list in &mut self.places[face].lists[corner] {
            if *list != NO_LIST {
                let left = self.store.drop_replaced(kept, h, *list);
                *list = self.store.set_len(*list, left);
            }
        }
    }

    /// Removes the lists from `h`.
    #[inline]
    pub(crate) fn clear(&mut self, h: u32) {
        let (face, corner) = parts(h);
        for list in std::mem::take(&mut self.places[face].lists[corner]) {
            if list != NO_LIST {
                self.store.set_len(list, 0);
            }
        }
    }

    /// A list with room for `more` windows that arrive at `h`: the list of the same side, or a
    /// separate one if `alone`. A separate list must be [inserted](Self::insert).
    #[inline]
    pub(crate) fn reserve(&mut self, h: u32, arrival: ChildSide, more: usize, alone: bool) -> u32 {
        let (face, corner) = parts(h);
        let list = self.places[face].lists[corner][arrival as usize];
        self.store.reserve(if alone { NO_LIST } else { list }, more)
    }

    /// Makes `list`, from [`reserve`](Self::reserve), wait on `h` with the first `len` windows of
    /// its block.
    #[inline]
    pub(crate) fn arrive(&mut self, h: u32, arrival: ChildSide, list: u32, len: usize) {
        let (face, corner) = parts(h);
        self.places[face].lists[corner][arrival as usize] = self.store.set_len(list, len);
    }

    /// Moves the first `len` windows of `list`, a separate list, into the lists on `h`, in
    /// ascending order of their left ends. The lists keep this order until they are taken.
    pub(crate) fn insert(&mut self, h: u32, list: u32, len: usize) {
        if len == 0 {
            self.store.set_len(list, 0);
            return;
        }
        let (face, corner) = parts(h);
        let [mut all, second] = std::mem::take(&mut self.places[face].lists[corner]);
        for (from, count) in [(second, self.store.len(second)), (list, len)] {
            let sorted = from == list;
            for i in 0..count {
                let window = self.store.get(from, i);
                all = self.store.reserve(all, 1);
                let mut place = self.store.len(all);
                self.store.set_len(all, place + 1);
                // The second list lies behind the first one.
                while sorted && place > 0 && self.store.get(all, place - 1)[0] > window[0] {
                    let moved = self.store.get(all, place - 1);
                    self.store.put(all, place, moved);
                    place -= 1;
                }
                self.store.put(all, place, window);
            }
            if from != NO_LIST {
                self.store.set_len(from, 0);
            }
        }
        self.places[face].lists[corner][0] = all;
    }

    /// Appends a window to the list of its side on `h`; returns the list and the index of the
    /// window.
    pub(crate) fn push(
        &mut self,
        h: u32,
        arrival: ChildSide,
        window: [f64; COLUMNS],
    ) -> (u32, usize) {
        let list = self.reserve(h, arrival, 1, false);
        let len = self.store.len(list);
        self.store.put(list, len, window);
        self.arrive(h, arrival, list, len + 1);
        (list, len)
    }

    /// Prefetches the state of `face`.
    #[inline]
    pub(crate) fn prefetch(&self, face: usize) {
        crate::engine::prefetch::prefetch(&self.places, face);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn window(b0: f64) -> [f64; COLUMNS] {
        [b0, b0 + 1.0, 0.0, -1.0, 0.0]
    }

    fn starts(front: &Front, h: u32) -> Vec<f64> {
        let lists = front.lists(h);
        let starts = lists.map(|list| (0..list.len()).map(move |i| list.row(i)[0]));
        starts.into_iter().flatten().collect()
    }

    #[test]
    fn left_children_come_first_and_lists_are_used_again() {
        let mut front = Front::new(2, Vec::new());
        let h = half_edge(1, 2);
        for round in 0..3 {
            front.push(h, ChildSide::AsRightChild, window(3.0));
            front.push(h, ChildSide::AsLeftChild, window(1.0));
            front.push(h, ChildSide::AsLeftChild, window(2.0));
            assert_eq!(front.waiting(), 3, "round {round}");
            assert_eq!(starts(&front, h), [1.0, 2.0, 3.0]);
            front.clear(h);
            assert!(starts(&front, h).is_empty());
            assert_eq!(front.waiting(), 0);
        }
    }

    #[test]
    fn late_windows_are_put_in_their_places() {
        let mut front = Front::new(1, Vec::new());
        for (arrival, b0) in [
            (ChildSide::AsRightChild, 4.0),
            (ChildSide::AsLeftChild, 2.0),
            (ChildSide::AsLeftChild, 3.0),
        ] {
            front.push(0, arrival, window(b0));
        }
        for late in [[2.5, 9.0], [0.0, 3.0]] {
            let list = front.reserve(0, ChildSide::AsLeftChild, 2, true);
            for (i, b0) in late.into_iter().enumerate() {
                front.store.put(list, i, window(b0));
            }
            front.insert(0, list, 2);
        }
        assert_eq!(starts(&front, 0), [0.0, 2.0, 2.5, 3.0, 3.0, 4.0, 9.0]);
        assert_eq!(front.waiting(), 7);
        // If no expected window arrived, the waiting windows once lost their list.
        let list = front.reserve(0, ChildSide::AsLeftChild, 2, true);
        front.insert(0, list, 0);
        assert_eq!(starts(&front, 0).len(), 7);
        front.clear(0);
        assert_eq!(front.waiting(), 0);
    }

    #[test]
    fn a_face_joins_once_a_run_and_its_lists_are_ready_then() {
        let mut front = Front::new(2, Vec::new());
        for _ in 0..2 {
            front.reset();
            front.advance();
            front.push(half_edge(1, 0), ChildSide::AsLeftChild, window(1.0));
            front.make_ready(half_edge(1, 0));
            assert!(!front.contains(1) && front.next_ready().is_none());
            front.join(1);
            front.join(1);
            assert!(front.contains(1) && front.is_new(1));
            assert_eq!(front.next_ready(), Some(half_edge(1, 0)));
            assert_eq!(front.next_ready(), None);
            front.clear(half_edge(1, 0));
            front.advance();
            assert!(front.contains(1) && !front.is_new(1));
        }
    }
}
