//! Lists cross faces.

use geobench_window::simd::{Lanes, Program, Scalar};
use geobench_window::{Counter, Phase, Probe};

use super::{Improvement, SurfaceState, Wavefront};
use crate::engine::coalesce::FEW;
use crate::engine::kernels::{self, BestPath, Gate, Measured, Target, Triangle};
use crate::engine::sent::Sent;
use crate::engine::store::NO_LIST;
use crate::engine::surface::{NOBODY, next, parts, prev};
use crate::precision::extent;

impl Wavefront {
    /// Lists cross until none is ready; windows are coalesced if `COALESCE`, of which nothing is left
    /// otherwise in the code that runs.
    #[inline(always)]
    pub(crate) fn cross_all<L: Lanes, F: SurfaceState, P: Probe, const COALESCE: bool>(
        &mut self,
        simd: L::Token,
        state: &mut F,
        probe: &mut P,
    ) {
        let mut place = 0;
        loop {
            if place == self.ready.len() || self.must_settle() {
                self.settle(state, probe);
            }
            let Some(&h) = self.ready.get(place) else {
                break;
            };
            self.prefetch_face(state, place + 6);
            self.prefetch_beyond(state, place + 3);
            place += 1;
            if !COALESCE || L::COUNT == 1 {
                self.cross::<L, F, P, COALESCE>(simd, state, h, probe);
            } else if self.waiting_at(state, h) <= FEW {
                self.cross::<Scalar, F, P, COALESCE>((), state, h, probe);
            } else {
                let list = List::<F, P, COALESCE> {
                    wavefront: self,
                    state,
                    h,
                    probe,
                };
                L::run_apart(simd, list);
            }
        }
        self.ready.clear();
    }

    /// How many windows wait on `h`.
    #[inline(always)]
    fn waiting_at(&self, state: &impl SurfaceState, h: u32) -> usize {
        let (f, corner) = parts(h);
        self.store.len(state.list(f, corner))
    }

    /// Takes the list on `h` across its face.
    #[inline(always)]
    fn cross<L: Lanes, F: SurfaceState, P: Probe, const COALESCE: bool>(
        &mut self,
        simd: L::Token,
        state: &mut F,
        h: u32,
        probe: &mut P,
    ) {
        let (f, corner) = parts(h);
        let (after, before) = (next(corner), prev(corner));
        let list = state.take_list(f, corner);
        let face = &state.surface().faces[f];
        let [tail, head, apex] = [corner, after, before].map(|k| face.vertex[k]);
        let exits = [face.twin[before], face.twin[after]];
        let triangle = face.triangle(corner);
        let arrived = self.store.len(list);
        let mut len = arrived;
        probe.enter(Phase::Pruning);
        if self.compared.takes(h, len) {
            let block = self.store.padded_block(list);
            let extent = extent(triangle.l, state.surface().behind(h));
            len = kernels::compare::<L>(simd, block, len, extent, &mut self.cuts);
        }
        let gate = Gate {
            l: triangle.l,
            apex: triangle.apex,
            ends: [tail, head].map(|v| state.distance(v)),
        };
        let waiting = self.store.first(list, len);
        let found = kernels::measure::<L, true>(simd, waiting, 0, &gate, &mut self.keep);
        probe.enter(Phase::Propagation);
        probe.add(Counter::Filtered, (arrived - found.kept) as u64);
        probe.add(Counter::Parents, found.kept as u64);
        if probe.wants_sample(found.kept as u64) {
            probe.sample(self.store.windows().map(|w| w.min_distance()));
        }
        if found.kept > 0 {
            let size = gate.l + found.distance;
            let waiting = self.store.first(list, len);
            let best = BestPath::of(waiting, found.best, gate.apex, size);
            // The consequences wait: whether a path is the shortest is hard to predict.
            let news = state.offer(apex, found.distance);
            let path = Improvement {
                vertex: apex,
                h,
                entry: best.entry,
                distance: found.distance,
            };
            self.note(path, news);
            self.send::<L, F, P, COALESCE>(
                simd, state, list, h, exits, &triangle, &found, &best, probe,
            );
        }
        probe.enter(Phase::Management);
        self.store.set_len(list, 0);
        if P::COUNTS && F::COUNTS_LEVELS {
            self.levels.forget(h);
        }
        probe.raise(Counter::PeakWindows, self.store.waiting() as u64);
    }

    /// Sends what `found` counted in the `list` on `h` across its face, which is `triangle`, into
    /// the lists behind its two exits.
    #[allow(clippy::too_many_arguments)] // All of what the caller has found out.
    #[inline(always)]
    fn send<L: Lanes, F: SurfaceState, P: Probe, const COALESCE: bool>(
        &mut self,
        simd: L::Token,
        state: &mut F,
        list: u32,
        h: u32,
        exits: [u32; 2],
        triangle: &Triangle,
        found: &Measured,
        best: &BestPath,
        probe: &mut P,
    ) {
        let mut lists = [NO_LIST; 2];
        for side in 0..2 {
            if exits[side] != NOBODY && found.bound[side] > 0 {
                let (f, k) = parts(exits[side]);
                lists[side] = self.store.reserve(state.list(f, k), found.bound[side]);
            }
        }
        let before = lists.map(|list| self.store.len(list));
        let [block, left, right] = self.store.blocks([list, lists[0], lists[1]]);
        let mut left = Target {
            block: left,
            len: before[0],
            open: lists[0] != NO_LIST,
        };
        let mut right = Target {
            block: right,
            len: before[1],
            open: lists[1] != NO_LIST,
        };
        let carried = kernels::carry::<L, BestPath>(
            simd,
            block.columns(found.len),
            &self.keep,
            triangle,
            best,
            0.0,
            [&mut left, &mut right],
        );
        let mut sent = Sent {
            exits,
            lists,
            before,
            after: [left.len, right.len],
        };
        let children = sent.children();
        probe.enter(Phase::Management);
        if P::COUNTS && F::COUNTS_LEVELS {
            let deepest = sent.record_levels(&mut self.levels, &self.store, h, triangle);
            probe.raise(Counter::Levels, u64::from(deepest));
        }
        if COALESCE {
            let (f, corner) = parts(h);
            let face = &state.surface().faces[f];
            sent.after = (self.store).coalesce_behind(face, corner, lists, before, sent.after);
        }
        sent.admit(&mut self.kept, &mut self.store);
        for side in sent.sides() {
            let (f, k) = parts(exits[side]);
            let list = self.store.set_len(lists[side], sent.after[side]);
            state.set_list(f, k, list);
            if list != NO_LIST {
                self.make_ready(state, f, k);
            }
        }
        probe.add(Counter::Propagated, carried.tried as u64);
        probe.add(Counter::Children, children as u64);
    }

    /// Asks for the face that the list at `place` of the queue will cross.
    #[inline(always)]
    fn prefetch_face(&self, state: &impl SurfaceState, place: usize) {
        if let Some(&h) = self.ready.get(place) {
            state.prefetch_face(parts(h).0);
        }
    }

    /// Asks for what the list at `place` of the queue touches beyond its face.
    #[inline(always)]
    fn prefetch_beyond(&self, state: &impl SurfaceState, place: usize) {
        if let Some(&h) = self.ready.get(place) {
            for exit in state.surface().exits(h) {
                state.prefetch_lists(parts(exit).0);
            }
            let (f, corner) = parts(h);
            state.prefetch_distance(state.surface().faces[f].vertex[prev(corner)]);
        }
    }
}

/// A list about to cross.
struct List<'a, F, P, const COALESCE: bool> {
    wavefront: &'a mut Wavefront,
    state: &'a mut F,
    h: u32,
    probe: &'a mut P,
}

impl<F: SurfaceState, P: Probe, const COALESCE: bool> Program for List<'_, F, P, COALESCE> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, simd: L::Token) {
        self.wavefront
            .cross::<L, F, P, COALESCE>(simd, self.state, self.h, self.probe);
    }
}
