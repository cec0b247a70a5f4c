//! Windows that start from a vertex.

use std::f32::consts::PI;

use geobench_window::{Counter, Probe};

use super::propagation::VtpFast;
use crate::engine::store::NO_LIST;
use crate::engine::surface::{NOBODY, Surface, half_edge, next, parts, prev};

/// By how much, in radians, the shadow of a path is widened: far more than the angles err.
const PENUMBRA: f32 = 1e-3;

/// How a path reached the apex of a half-edge.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Origin {
    /// The half-edge that it crossed last.
    pub(super) h: u32,
    /// Where.
    pub(super) entry: f64,
}

/// The faces around a vertex into which a path that reaches it can go on.
#[derive(Clone, Copy, Debug)]
struct Shadow {
    /// First of them, and their number, in the ring of the vertex.
    first: usize,
    count: usize,
}

impl Shadow {
    /// All faces around a vertex.
    fn all(degree: usize) -> Self {
        Self {
            first: 0,
            count: degree,
        }
    }

    /// A shortest path bends at an interior vertex only if it leaves it at an angle of π or more on
    /// both sides, so only in a wedge as wide as the excess over 2π, opposite to where it came from.
    fn of(surface: &Surface, v: u32, origin: Origin) -> Self {
        let places = surface.ring_places(v);
        let (ring, angles) = (&surface.rings[places.clone()], &surface.angles[places]);
        let (f, corner) = parts(origin.h);
        let own = half_edge(f as u32, prev(corner));
        let Some(start) = ring.iter().position(|&h| h == own) else {
            return Self::all(ring.len());
        };
        // At the apex, counter-clockwise from the side that ends at the tail to the path.
        let [x, y] = surface.faces[f].apex(corner);
        let across = y * origin.entry;
        let along = y * y - x * (origin.entry - x);
        let size = across.abs() + along.abs();
        let turned = ((across / size) as f32).atan2((along / size) as f32);
        let (from, to) = (
            PI - PENUMBRA,
            surface.vertices[v as usize].total_angle - PI + PENUMBRA,
        );
        // The first corner that ends within, and the last that starts within.
        let mut shadow = Self { first: 0, count: 0 };
        let (mut place, mut before) = (start, -turned);
        for _ in 0..ring.len() {
            let after = before + angles[place];
            if after >= from && before <= to {
                if shadow.count == 0 {
                    shadow.first = place;
                }
                shadow.count += 1;
            }
            before = after;
            place = if place + 1 == ring.len() {
                0
            } else {
                place + 1
            };
        }
        shadow
    }
}

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
        if at_b * margin + l < to_a || at_a * margin + l < to_b {
            probe.add(Counter::Filtered, 1);
            return;
        }
        let (target, k) = parts(twin);
        let list = self.store.reserve(self.surface.faces[target].list[k], 1);
        let len = self.store.len(list);
        debug_assert!(list != NO_LIST);
        self.store.put(list, len, [0.0, l, l - x, -y, d]);
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
