//! Windows that start from a vertex.

use geobench_window::{Counter, Probe};

use super::propagation::VtpFast;
use crate::engine::shadow::{Origin, Shadow};
use crate::engine::store::NO_LIST;
use crate::engine::surface::{NOBODY, half_edge, next, parts, prev};

impl VtpFast<'_> {
    /// Sends windows from `v` if it is a pseudo-source that has come nearer since it last did.
    pub(super) fn spawn_if_nearer<P: Probe>(&mut self, v: u32, probe: &mut P) {
        let (i, vertex) = (v as usize, self.surface.vertices[v as usize]);
        if vertex.pseudo_source && self.distances[i] < self.spawned[i] {
            self.spawned[i] = self.distances[i];
            self.spawn(v, vertex.all_around || !self.options.shadow, probe);
        }
    }

    /// Sends paths along edges of `v` and windows across its faces, in all directions or into the
    /// shadow of the path that reached it.
    pub(super) fn spawn<P: Probe>(&mut self, v: u32, all_around: bool, probe: &mut P) {
        probe.add(Counter::PseudoSources, 1);
        let ring = self.surface.ring_places(v);
        let shadow = if all_around {
            Shadow::all(ring.len())
        } else {
            Shadow::of(&self.surface, v, self.origins[v as usize])
        };
        let mut place = ring.start + shadow.first;
        for i in 0..shadow.count {
            let h = self.surface.rings[place];
            place = if place + 1 == ring.end {
                ring.start
            } else {
                place + 1
            };
            // The last edge belongs to the next face, if there is one.
            let last = !all_around && i + 1 == shadow.count;
            self.spawn_across(v, h, last, probe);
        }
        probe.raise(Counter::PeakWindows, self.store.waiting() as u64);
    }

    /// Sends a path along `h`, which starts at `v`, and a window across its face; along the other edge too
    /// if that is the last one.
    #[inline]
    fn spawn_across<P: Probe>(&mut self, v: u32, h: u32, last: bool, probe: &mut P) {
        let (f, corner) = parts(h);
        let (after, before) = (next(corner), prev(corner));
        let face = &self.surface.faces[f];
        let d = self.distances[v as usize];
        let [a, b] = [face.vertex[after], face.vertex[before]];
        let [to_a, to_b] = [d + face.length[corner], d + face.length[before]];
        let l = face.length[after];
        let twin = face.twin[after];
        let [x, y] = face.apex(after);
        let along_b = half_edge(f as u32, before);
        let length_b = face.length[before];
        // Seen from the opposite vertices the paths come along the far ends of their half-edges.
        self.offer(
            a,
            to_a,
            Origin {
                h: along_b,
                entry: length_b,
            },
            probe,
        );
        if last || self.surface.vertices[v as usize].boundary {
            self.offer(b, to_b, Origin { h, entry: 0.0 }, probe);
        }
        let [at_a, at_b] = [a, b].map(|v| self.distances[v as usize]);
        if twin == NOBODY {
            return;
        }
        probe.add(Counter::Spawned, 1);
        // The vertex filter: each end's own path along the edge beats the farthest ray.
        let margin = crate::engine::kernels::MARGIN;
        if (at_b + l) * margin < to_a || (at_a + l) * margin < to_b {
            probe.add(Counter::Filtered, 1);
            return;
        }
        let (target, k) = parts(twin);
        let list = self.store.reserve(self.surface.faces[target].list[k], 1);
        let len = self.store.len(list);
        debug_assert!(list != NO_LIST);
        self.store.put(list, len, [0.0, l, l - x, -y, d]);
        if P::COUNTS {
            self.levels.start(twin, [l - x, -y], d);
        }
        self.surface.faces[target].list[k] = self.store.set_len(list, len + 1);
        self.make_ready(target, k);
    }

    /// A path of length `d` reaches `v` along an edge.
    #[inline]
    fn offer<P: Probe>(&mut self, v: u32, d: f64, origin: Origin, probe: &mut P) {
        let i = v as usize;
        if d < self.distances[i] {
            self.distances[i] = d;
            self.origins[i] = origin;
            let news = self.buckets.push(v, d);
            probe.add(Counter::QueuePushes, u64::from(news));
        }
    }
}
