//! The surface as one thread sees it.

use std::hint::select_unpredictable;

use super::schedule_fuzz::schedule_fuzz;
use super::shared::{AtomicDistance, Shared};
use crate::engine::face_state::FaceState;
use crate::engine::layout::MeshLayout;
use crate::engine::prefetch::prefetch;
use crate::wavefront::SurfaceState;
use geobench_window::prefetch_line;

/// The state of faces and vertices that a thread does not share.
#[derive(Debug)]
pub(super) struct ThreadState {
    faces: Vec<FaceState>,
    /// For each vertex, the length of the last path that this thread has recorded; infinite if
    /// there is none, or once the vertex has been handed off. The first path that the thread finds
    /// or receives is recorded. A later path is recorded if it is shorter than that and than the
    /// distance that the thread saw. So the thread that wrote a distance, or received the vertex,
    /// has a path that is no longer. If the length is finite, the vertex has had its turn in this
    /// wavefront or waits for it.
    reached: Vec<f64>,
    /// The target of writes without effect, which avoid a branch.
    nowhere: AtomicDistance,
    /// The number of this run.
    run: u8,
}

impl ThreadState {
    pub(super) fn new(layout: &MeshLayout) -> Self {
        Self {
            faces: vec![FaceState::default(); layout.faces.len()],
            reached: vec![f64::INFINITY; layout.vertices.len()],
            nowhere: AtomicDistance::unknown(),
            run: 0,
        }
    }

    /// Follows a change of the layout.
    pub(super) fn splice(&mut self, layout: &MeshLayout) {
        self.faces.resize(layout.faces.len(), FaceState::default());
        self.reached.resize(layout.vertices.len(), f64::INFINITY);
    }

    /// Clears the state of the last run.
    pub(super) fn reset(&mut self) {
        if self.run == u8::MAX {
            self.run = 0;
            self.faces.fill(FaceState::default());
        }
        self.run += 1;
        self.reached.fill(f64::INFINITY);
    }

    /// Lowers the shared distances to those that this thread has found. Threads write without
    /// atomic minima, so a longer path may have overwritten a shorter one.
    pub(super) fn repair(&self, distances: &[AtomicDistance]) {
        for (distance, &reached) in distances.iter().zip(&self.reached) {
            if reached < f64::INFINITY && reached < distance.get() {
                distance.lower(reached);
            }
        }
    }
}

/// A thread's view of the surface: references to the shared state and to its own.
#[derive(Debug)]
pub(super) struct ThreadView<'a> {
    layout: &'a MeshLayout,
    distances: &'a [AtomicDistance],
    faces: &'a mut [FaceState],
    reached: &'a mut [f64],
    nowhere: &'a AtomicDistance,
    run: u8,
}

impl<'a> ThreadView<'a> {
    pub(super) fn new(shared: &'a Shared, state: &'a mut ThreadState) -> Self {
        Self {
            layout: &shared.layout,
            distances: &shared.distances,
            faces: &mut state.faces,
            reached: &mut state.reached,
            nowhere: &state.nowhere,
            run: state.run,
        }
    }
}

impl ThreadView<'_> {
    /// Hands off the turn of `v`; returns the length of this thread's path to it.
    pub(super) fn give_up(&mut self, v: u32) -> f64 {
        std::mem::replace(&mut self.reached[v as usize], f64::INFINITY)
    }

    /// Takes over the turn of `v`, to which another thread has found a path of length `d`.
    pub(super) fn take_over(&mut self, v: u32, d: f64) {
        let reached = &mut self.reached[v as usize];
        *reached = reached.min(d);
    }
}

impl SurfaceState for ThreadView<'_> {
    const IS_ALONE: bool = false;

    #[inline(always)]
    fn layout(&self) -> &MeshLayout {
        self.layout
    }

    #[inline(always)]
    fn list(&self, f: usize, corner: usize) -> u32 {
        self.faces[f].list(corner)
    }

    #[inline(always)]
    fn set_list(&mut self, f: usize, corner: usize, list: u32) {
        self.faces[f].set_list(corner, list);
    }

    #[inline(always)]
    fn take_list(&mut self, f: usize, corner: usize) -> u32 {
        self.faces[f].take_list(corner)
    }

    #[inline(always)]
    fn enqueue(&mut self, f: usize, corner: usize) -> bool {
        self.faces[f].enqueue(corner, self.run)
    }

    #[inline(always)]
    fn join(&mut self, f: usize) -> bool {
        self.faces[f].join(self.run)
    }

    #[inline(always)]
    fn distance(&self, v: u32) -> f64 {
        self.distances[v as usize].get()
    }

    /// Also accepts the first path of this wavefront to a vertex that another thread has reached by
    /// a shorter path. The vertex then has a turn in this wavefront as well, for the lists of this
    /// wavefront around it.
    ///
    /// Whether a path is the shortest is hard to predict, so there is no branch on it. There is no
    /// atomic minimum either. If another thread writes a longer path at the same time, threads may
    /// see that until [`ThreadState::repair`], and delete fewer windows.
    #[inline(always)]
    #[allow(clippy::needless_bitwise_bool)] // The lazy ones are branches.
    fn offer(&mut self, v: u32, d: f64) -> bool {
        schedule_fuzz();
        let distance = &self.distances[v as usize];
        let reached = &mut self.reached[v as usize];
        let nearer = (d < distance.get()) & (d < *reached);
        let news = nearer | (*reached == f64::INFINITY);
        schedule_fuzz();
        select_unpredictable(nearer, distance, self.nowhere).set(d);
        *reached = select_unpredictable(news, d, *reached);
        news
    }

    #[inline(always)]
    fn reached(&self, v: u32) -> f64 {
        self.reached[v as usize]
    }

    #[inline(always)]
    fn prefetch_face(&self, f: usize) {
        self.layout.prefetch(f);
        self.prefetch_lists(f);
    }

    #[inline(always)]
    fn prefetch_lists(&self, f: usize) {
        prefetch(self.faces, f);
    }

    #[inline(always)]
    fn prefetch_distance(&self, v: u32) {
        if let Some(distance) = self.distances.get(v as usize) {
            prefetch_line(distance);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::test_run::{path, saddle, two_threads};
    use geobench_window::{Count, Counter};

    #[test]
    fn an_offer_counts_if_it_is_shortest_or_the_first_of_its_thread() {
        let (shared, [mut a, mut b]) = two_threads();
        let (_, mut a) = a.view(&shared);
        let (_, mut b) = b.view(&shared);
        assert!(a.offer(7, 3.0) && !a.offer(7, 3.0) && !a.offer(7, 4.0));
        assert!(b.offer(7, 5.0) && !b.offer(7, 5.0) && b.offer(7, 2.0));
        assert!(a.offer(7, 1.0) && !b.offer(7, 2.0));
        assert_eq!([a.distance(7), b.distance(7)], [1.0; 2]);
    }

    /// A thread that has not seen the shorter path may write a longer one at the same time.
    #[test]
    fn a_path_that_another_thread_has_overwritten_is_not_lost() {
        let (shared, mut threads) = two_threads();
        let (_, mut view) = threads[0].view(&shared);
        assert!(view.offer(7, 3.0));
        shared.distances[7].set(4.0);
        assert!(!view.offer(7, 3.5) && view.reached(7) == 3.0);
        let given = view.give_up(7);
        let (_, mut view) = threads[1].view(&shared);
        view.take_over(7, given);
        for thread in threads {
            thread.state.repair(&shared.distances);
        }
        assert_eq!(shared.distances[7].get(), 3.0);
    }

    /// Another thread once lowered the distance of a vertex, and its turn came before its path was
    /// known. Windows started into the spawn wedge of the old path, and never into that of the new
    /// one.
    #[test]
    fn windows_do_not_start_into_the_shadow_of_a_path_that_is_no_longer_the_shortest() {
        let (shared, mut threads) = two_threads();
        let v = saddle(&shared.layout);
        let path = |place, distance| path(&shared.layout, v, place, distance);
        threads[0].find(&shared, path(0, 10.0));
        threads[1].find(&shared, path(2, 9.0));
        assert_eq!(shared.distances[v as usize].get(), 9.0);
        for (thread, bucket, started) in [(0, 10, 0), (1, 9, 1)] {
            let mut count = Count::default();
            let (wavefront, mut view) = threads[thread].view(&shared);
            wavefront.take_turn(&mut view, bucket, &mut count);
            let counted = count.counters(&[Counter::PseudoSources]);
            assert_eq!(counted.get(Counter::PseudoSources), Some(started));
        }
        assert_eq!(threads[1].wavefront.origins[v as usize].h, path(2, 0.0).h);
    }
}
