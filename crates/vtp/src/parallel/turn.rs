//! Between steps, when no list is ready: the vertices of the nearest bucket have their turns.

use std::sync::atomic::Ordering::Relaxed;

use super::barrier::Broken;
use super::field::Field;
use super::worker::Worker;
use crate::engine::prefetch::prefetch;
use crate::engine::store::NO_LIST;
use crate::engine::surface::{NOBODY, half_edge, parts};

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

    /// Divides the vertices whose turn it is among the threads.
    pub(super) fn divide(&mut self, field: &Field) -> Result<(), Broken> {
        let loads = field.statuses.iter().map(|s| s.0.load.load(Relaxed));
        self.split.learn(loads);
        self.load = 0;
        if field.threads == 1 {
            return Ok(());
        }
        for (to, mail) in self.desk.out.iter_mut().enumerate() {
            if to != self.thread {
                mail.turn.extend_from_slice(&self.turn);
            }
        }
        self.front.clear();
        self.front.extend_from_slice(&self.turn);
        self.exchange(field)?;
        if self.split.cut(&mut self.front) {
            let range = self.split.range(self.thread);
            self.turn.clear();
            let own = self.front.iter().filter(|v| range.contains(v));
            self.turn.extend(own);
        }
        Ok(())
    }

    /// The turns of this thread's vertices.
    pub(super) fn pass_turn(&mut self, field: &Field) {
        for i in 0..self.turn.len() {
            if let Some(&v) = self.turn.get(i + 6) {
                for &h in field.surface.ring(v) {
                    prefetch(&field.faces, parts(h).0);
                    prefetch(&field.surface.faces, parts(h).0);
                }
            }
            let v = self.turn[i];
            self.join_ring(field, v);
            self.spawn_if_nearer(field, v);
        }
    }

    /// The faces around `v` join the traversed area, as faces of this thread if another one is not faster.
    fn join_ring(&mut self, field: &Field, v: u32) {
        field.vertices[v as usize].pass(self.thread);
        for &h in field.surface.ring(v) {
            let (f, _) = parts(h);
            let state = &field.faces[f];
            if !state.join(field.run, self.thread) {
                continue;
            }
            let mut is_ready = false;
            for corner in 0..3 {
                if state.list(corner) == NO_LIST {
                    continue;
                }
                // The windows lie with the thread of the face that they come from.
                let twin = field.surface.faces[f].twin[corner];
                debug_assert!(twin != NOBODY);
                match field.owner(parts(twin).0) {
                    Some(holder) if holder != self.thread => {
                        let h = half_edge(f as u32, corner);
                        self.desk.out[holder].requests.push(h);
                    }
                    _ => is_ready = true,
                }
            }
            if is_ready && state.enqueue() {
                self.ready.push(f as u32);
            }
        }
    }

    /// Gives other threads the windows that wait for their faces.
    pub(super) fn hand_over(&mut self, field: &Field) -> Result<(), Broken> {
        if field.threads == 1 {
            return Ok(());
        }
        let asked: usize = self.desk.out.iter().map(|mail| mail.requests.len()).sum();
        let status = &field.statuses[self.thread].0;
        status.work.store(asked as u32, Relaxed);
        self.exchange(field)?;
        if field.sum(|s| s.work.load(Relaxed).into()) == 0 {
            return Ok(());
        }
        for i in 0..self.requests.len() {
            let h = self.requests[i];
            let (f, corner) = parts(h);
            let (state, owner) = (&field.faces[f], field.owner(f));
            if let Some(owner) = owner {
                self.send_windows(state.list(corner), h, owner);
                state.set_list(corner, NO_LIST);
            }
        }
        self.requests.clear();
        self.exchange(field)
    }
}
