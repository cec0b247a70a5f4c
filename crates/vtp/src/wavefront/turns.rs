//! The turns of vertices, and what follows from paths that reach them.

use geobench_window::{Counter, Probe};

use super::{Improvement, SurfaceState, Wavefront};
use crate::engine::spawn_wedge::Origin;
use crate::engine::store::NO_LIST;
use crate::engine::surface::{half_edge, parts};

impl Wavefront {
    /// The turns of the vertices of `bucket`, before which no other one may have any.
    pub(crate) fn take_turn<P: Probe>(
        &mut self,
        state: &mut impl SurfaceState,
        bucket: u32,
        probe: &mut P,
    ) {
        let mut turn = std::mem::take(&mut self.turn);
        self.buckets.take(bucket, &mut turn);
        probe.add(Counter::Iterations, 1);
        for (i, &v) in turn.iter().enumerate() {
            if let Some(&v) = turn.get(i + 6) {
                for &h in state.surface().ring(v) {
                    state.prefetch_lists(parts(h).0);
                }
            }
            self.pass(state, v, probe);
        }
        self.turn = turn;
    }

    /// The turn of vertex `v`: the faces around it join the traversed area.
    pub(crate) fn pass<P: Probe>(&mut self, state: &mut impl SurfaceState, v: u32, probe: &mut P) {
        self.passed[v as usize] = true;
        for place in state.surface().ring_places(v) {
            let (f, _) = parts(state.surface().rings[place]);
            if state.join(f) {
                for corner in 0..3 {
                    if state.list(f, corner) != NO_LIST {
                        self.make_ready(state, f, corner);
                    }
                }
            }
        }
        self.spawn_if_nearer(state, v, probe);
    }

    /// Queues the list on half-edge `corner` of face `f` if that has joined.
    #[inline(always)]
    pub(crate) fn make_ready(&mut self, state: &mut impl SurfaceState, f: usize, corner: usize) {
        if state.enqueue(f, corner) {
            self.ready.push(half_edge(f as u32, corner));
        }
    }

    /// Has an improvement wait for its consequences. There is room for one.
    #[inline(always)]
    pub(super) fn note(&mut self, improvement: Improvement, news: bool) {
        self.improvements[self.improved] = improvement;
        self.improved += usize::from(news);
    }

    /// A path that another wavefront had found, to a vertex whose turn is up to this one now.
    pub(crate) fn hear_of<P: Probe>(
        &mut self,
        state: &mut impl SurfaceState,
        improvement: Improvement,
        probe: &mut P,
    ) {
        self.note(improvement, true);
        if self.must_settle() {
            self.settle(state, probe);
        }
    }

    /// Whether there is no room for another improvement.
    #[inline(always)]
    pub(super) fn must_settle(&self) -> bool {
        self.improved == self.improvements.len()
    }

    /// The consequences of distances that have improved.
    pub(crate) fn settle<P: Probe>(&mut self, state: &mut impl SurfaceState, probe: &mut P) {
        for i in 0..std::mem::take(&mut self.improved) {
            let Improvement {
                vertex,
                h,
                entry,
                distance,
            } = self.improvements[i];
            let v = vertex as usize;
            // What came later has its own consequences.
            if distance <= state.reached(vertex) && state.surface().vertices[v].pseudo_source {
                self.origins[v] = Origin { h, entry };
                if self.passed[v] {
                    self.spawn_if_nearer(state, vertex, probe);
                }
            }
            if !self.passed[v] {
                // Others may have written a longer one since.
                let nearest = state.distance(vertex).min(state.reached(vertex));
                let news = self.buckets.push(vertex, nearest);
                probe.add(Counter::QueuePushes, u64::from(news));
            }
        }
        probe.raise(Counter::QueuePeak, self.buckets.len() as u64);
    }
}
