//! The end of a step: the vertices of the nearest bucket have their turns.

use super::field::Field;
use super::worker::{Worker, queue_face};
use crate::engine::prefetch::prefetch;
use crate::engine::surface::parts;

impl Worker {
    /// The turns of the sources, which send windows all around.
    pub(super) fn start_from(&mut self, field: &Field, sources: &[u32]) {
        for &s in sources {
            field.distances[s as usize].set(0.0);
        }
        for &s in sources {
            let state = &field.vertices[s as usize];
            if state.spawned.get() > 0.0 {
                state.spawned.set(0.0);
                self.join_ring(field, s);
                self.spawn(field, s, true);
            }
        }
    }

    /// The turns of this thread's vertices in the bucket `last` and in those before it, into which some may have come
    /// since that was the nearest one.
    pub(super) fn pass_turn(&mut self, field: &Field, last: u32) {
        while let Some(bucket) = self.buckets.nearest().filter(|&bucket| bucket < last) {
            self.buckets.take(bucket, &mut self.turn);
            self.pass(field);
        }
        self.buckets.take(last, &mut self.turn);
        self.pass(field);
    }

    /// The turns of the vertices in `turn`.
    fn pass(&mut self, field: &Field) {
        for i in 0..self.turn.len() {
            if let Some(&v) = self.turn.get(i + 6) {
                for &h in field.surface.ring(v) {
                    prefetch(&field.faces, parts(h).0);
                }
            }
            let v = self.turn[i];
            self.join_ring(field, v);
            self.spawn_if_nearer(field, v);
        }
    }

    /// The faces around `v` join the traversed area, with the windows that wait for it.
    fn join_ring(&mut self, field: &Field, v: u32) {
        field.vertices[v as usize].pass(self.thread);
        for &h in field.surface.ring(v) {
            let (f, _) = parts(h);
            let state = &field.faces[f];
            if !state.join(field.run) {
                continue;
            }
            // Nothing waits for a face that is nobody's.
            match state.owner(field.run) {
                Some(owner) if owner != self.thread => {
                    self.desk.out[owner].joined.push(f as u32);
                }
                _ => queue_face(&mut self.ready, field, f),
            }
        }
    }
}
