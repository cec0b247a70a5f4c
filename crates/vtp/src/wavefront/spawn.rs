//! Windows that start from a vertex.

use geobench_window::{Counter, Probe};

use super::{SurfaceState, Wavefront};
use crate::engine::kernels::LOSES;
use crate::engine::spawn_wedge::{Origin, SpawnWedge};
use crate::engine::store::{NO_LIST, admit};
use crate::engine::surface::{NOBODY, half_edge, parts, prev};

impl Wavefront {
    /// The turn of a source, which sends windows all around.
    pub(crate) fn start_from<P: Probe>(
        &mut self,
        state: &mut impl SurfaceState,
        source: u32,
        probe: &mut P,
    ) {
        if self.spawned[source as usize] > 0.0 {
            self.spawned[source as usize] = 0.0;
            self.spawn(state, source, true, probe);
            self.pass(state, source, probe);
        }
    }

    /// Sends windows from `v` if it is a pseudo-source that has come nearer since it last did.
    pub(super) fn spawn_if_nearer<P: Probe>(
        &mut self,
        state: &mut impl SurfaceState,
        v: u32,
        probe: &mut P,
    ) {
        let (vertex, distance) = (state.surface().vertices[v as usize], state.reached(v));
        if vertex.pseudo_source
            && distance < self.spawned[v as usize]
            // The thread that has found a shorter path sends windows from it.
            && distance <= state.distance(v)
        {
            self.spawned[v as usize] = distance;
            self.spawn(state, v, vertex.all_around || !self.spawn_wedge, probe);
        }
    }

    /// Sends paths along edges of `v` and windows across its faces, in all directions or into the
    /// shadow of the path that reached it.
    fn spawn<P: Probe>(
        &mut self,
        state: &mut impl SurfaceState,
        v: u32,
        all_around: bool,
        probe: &mut P,
    ) {
        probe.add(Counter::PseudoSources, 1);
        let ring = state.surface().ring_places(v);
        let wedge = if all_around {
            SpawnWedge::all(ring.len())
        } else {
            SpawnWedge::of(state.surface(), v, self.origins[v as usize])
        };
        let mut place = ring.start + wedge.first;
        for i in 0..wedge.count {
            let h = state.surface().rings[place];
            place = if place + 1 == ring.end {
                ring.start
            } else {
                place + 1
            };
            // The last edge belongs to the next face, if there is one.
            let last = !all_around && i + 1 == wedge.count;
            self.spawn_across(state, v, h, last, probe);
        }
        probe.raise(Counter::PeakWindows, self.store.waiting() as u64);
    }

    /// Sends a path along `h`, which starts at `v`, and a window across its face; along the other
    /// edge too if that is the last one.
    #[inline]
    fn spawn_across<F: SurfaceState, P: Probe>(
        &mut self,
        state: &mut F,
        v: u32,
        h: u32,
        last: bool,
        probe: &mut P,
    ) {
        let d = self.spawned[v as usize];
        let spawn = state.surface().spawn(h, d);
        let ([a, b], [to_a, to_b]) = (spawn.ends, spawn.paths);
        let [_, l, px, py, _] = spawn.window;
        // Seen from the opposite vertices the paths come along the far ends of their half-edges.
        let (f, corner) = parts(h);
        let along_b = Origin {
            h: half_edge(f as u32, prev(corner)),
            entry: state.surface().faces[f].length[prev(corner)],
        };
        self.offer_along(state, a, to_a, along_b, probe);
        if last || state.surface().vertices[v as usize].boundary {
            self.offer_along(state, b, to_b, Origin { h, entry: 0.0 }, probe);
        }
        if spawn.exit == NOBODY {
            return;
        }
        let [at_a, at_b] = [a, b].map(|v| state.distance(v));
        probe.add(Counter::Spawned, 1);
        // The vertex filter: each end's own path along the edge beats the farthest ray.
        if (at_b + l) * LOSES < to_a || (at_a + l) * LOSES < to_b {
            probe.add(Counter::Filtered, 1);
            return;
        }
        let (target, k) = parts(spawn.exit);
        let mut window = spawn.window;
        if self.kept.holds(spawn.exit as usize) {
            let Some(part) = admit(&mut self.kept, spawn.exit, window) else {
                probe.add(Counter::Filtered, 1);
                return;
            };
            window = part;
        }
        let list = self.store.reserve(state.list(target, k), 1);
        let len = self.store.len(list);
        debug_assert!(list != NO_LIST);
        self.store.put(list, len, window);
        if P::COUNTS && F::COUNTS_LEVELS {
            self.levels.start(spawn.exit, [px, py], d);
        }
        state.set_list(target, k, self.store.set_len(list, len + 1));
        self.make_ready(state, target, k);
    }

    /// A path of length `d` reaches `v` along an edge.
    #[inline]
    fn offer_along<P: Probe>(
        &mut self,
        state: &mut impl SurfaceState,
        v: u32,
        d: f64,
        origin: Origin,
        probe: &mut P,
    ) {
        if state.offer(v, d) {
            self.origins[v as usize] = origin;
            let news = self.buckets.push(v, state.distance(v).min(d));
            probe.add(Counter::QueuePushes, u64::from(news));
        }
    }
}
