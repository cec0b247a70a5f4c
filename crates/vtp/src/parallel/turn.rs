//! The turns of vertices.

use super::field::Field;
use super::jitter::jitter;
use super::worker::Worker;
use crate::engine::prefetch::prefetch;
use crate::engine::store::NO_LIST;
use crate::engine::surface::{half_edge, parts};

impl Worker {
    /// The turns of the sources, which send windows all around.
    pub(super) fn start_from(&mut self, field: &Field, sources: &[u32]) {
        for &s in sources {
            field.distances[s as usize].set(0.0);
            field.vertices[s as usize].pass();
        }
        for &s in sources {
            let state = &field.vertices[s as usize];
            if state.spawned.get() > 0.0 {
                state.spawned.set(0.0);
                self.spawn(field, s, true);
                self.join_ring(field, s);
            }
        }
    }

    /// The turns of the vertices in `turn`.
    pub(super) fn pass(&mut self, field: &Field) {
        for i in 0..self.turn.len() {
            if let Some(&v) = self.turn.get(i + 6) {
                for &h in field.surface.ring(v) {
                    prefetch(&field.faces, parts(h).0);
                }
            }
            let v = self.turn[i];
            field.vertices[v as usize].pass();
            self.join_ring(field, v);
            self.spawn_if_nearer(field, v);
        }
    }

    /// The faces around `v` join the traversed area, with the windows that wait for it.
    fn join_ring(&mut self, field: &Field, v: u32) {
        for &h in field.surface.ring(v) {
            let (f, _) = parts(h);
            if field.faces[f].join(field.run) {
                jitter();
                let owner = field.owner_of_face(f);
                if owner == self.thread {
                    self.queue_face(field, f);
                } else {
                    self.out[owner].joined.push(f as u32);
                }
            }
        }
    }

    /// Queues the lists of a face of this thread that has joined.
    pub(super) fn queue_face(&mut self, field: &Field, f: usize) {
        let state = &field.faces[f];
        for corner in 0..3 {
            if state.list(corner) != NO_LIST && state.enqueue(corner) {
                self.ready.push(half_edge(f as u32, corner));
            }
        }
    }
}
