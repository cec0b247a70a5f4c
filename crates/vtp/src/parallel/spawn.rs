//! Windows that start from a vertex.

use super::field::Field;
use super::mail::Offer;
use super::worker::Worker;
use crate::engine::kernels::MARGIN;
use crate::engine::shadow::Shadow;
use crate::engine::store::NO_LIST;
use crate::engine::surface::{NOBODY, half_edge, next, parts, prev};

impl Worker {
    /// Sends paths along edges of `v` and windows across its faces, in all directions or into the shadow of the path that
    /// reached it.
    pub(super) fn spawn(&mut self, field: &Field, v: u32, all_around: bool) {
        self.tally.pseudo_sources += 1;
        let ring = field.surface.ring(v);
        let shadow = if all_around {
            Shadow::all(ring.len())
        } else {
            Shadow::of(&field.surface, v, field.vertices[v as usize].origin())
        };
        let mut place = shadow.first;
        for i in 0..shadow.count {
            // The last edge belongs to the next face, if there is one.
            let last = !all_around && i + 1 == shadow.count;
            self.spawn_across(field, ring[place], last);
            place = if place + 1 == ring.len() {
                0
            } else {
                place + 1
            };
        }
        let waiting = self.store.waiting() as u64;
        self.tally.peak_windows = self.tally.peak_windows.max(waiting);
    }

    /// Sends a path along `h`, and a window across its face; along the other edge too if that is the last one.
    #[inline]
    fn spawn_across(&mut self, field: &Field, h: u32, last: bool) {
        let (f, corner) = parts(h);
        let (after, before) = (next(corner), prev(corner));
        let face = &field.surface.faces[f];
        let [v, a, b] = [corner, after, before].map(|k| face.vertex[k]);
        let d = field.vertices[v as usize].spawned.get();
        let [to_a, to_b] = [d + face.length[corner], d + face.length[before]];
        let l = face.length[after];
        // Seen from the opposite vertices the paths come along the far ends of their half-edges.
        self.offer(
            field,
            Offer {
                vertex: a,
                h: half_edge(f as u32, before),
                entry: face.length[before],
                distance: to_a,
            },
        );
        if last || field.surface.vertices[v as usize].boundary {
            self.offer(
                field,
                Offer {
                    vertex: b,
                    h,
                    entry: 0.0,
                    distance: to_b,
                },
            );
        }
        let twin = face.twin[after];
        if twin == NOBODY {
            return;
        }
        self.tally.spawned += 1;
        let [at_a, at_b] = [a, b].map(|v| field.distance(v));
        // The vertex filter: each end's own path along the edge beats the farthest ray.
        if (at_b + l) * MARGIN < to_a || (at_a + l) * MARGIN < to_b {
            self.tally.filtered += 1;
            return;
        }
        let [x, y] = face.apex(after);
        let (target, k) = parts(twin);
        let owner = field.owner_of_face(target);
        let known = if owner == self.thread {
            field.faces[target].list(k)
        } else {
            NO_LIST
        };
        let list = self.store.reserve(known, 1);
        let len = self.store.len(list);
        self.store.put(list, len, [0.0, l, l - x, -y, d]);
        let list = self.store.set_len(list, len + 1);
        self.deliver(field, twin, list, owner);
    }
}
