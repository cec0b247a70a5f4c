//! The first half of a step: lists cross faces, and windows start from vertices. Distances do not change.

use std::sync::atomic::Ordering::Relaxed;

use geobench_window::{Phase, Probe};

use super::field::Field;
use super::mail::{Offer, Spawn};
use super::split::LIST;
use super::worker::{Task, Worker};
use crate::engine::kernels::{self, BestPath, Gate, MARGIN, Measured, Target};
use crate::engine::lanes::Lanes;
use crate::engine::prefetch::{line, prefetch};
use crate::engine::store::NO_LIST;
use crate::engine::surface::{Face, NOBODY, half_edge, next, parts, prev};

impl Worker {
    /// All lists that are ready cross their faces, then windows start.
    ///
    /// # Safety
    ///
    /// The processor must know the instructions of `L`.
    #[allow(unsafe_code)] // For a processor with the instructions of `L`, which only the caller knows.
    #[inline(always)]
    pub(super) unsafe fn cross<L: Lanes, P: Probe>(&mut self, field: &Field, probe: &mut P) {
        (self.load, self.again, self.sent) = (0, 0, 0);
        self.tasks.clear();
        for &face in &self.ready {
            let lists = field.faces[face as usize].take();
            self.tasks.push(Task { face, lists });
        }
        self.ready.clear();
        for i in 0..self.tasks.len() {
            self.prefetch_face(field, i + 6);
            self.prefetch_beyond(field, i + 3);
            let Task { face, lists } = self.tasks[i];
            for (corner, list) in lists.into_iter().enumerate() {
                if list != NO_LIST {
                    // SAFETY: promised by the caller.
                    unsafe { self.cross_list::<L, P>(field, face, corner, list, probe) };
                }
            }
        }
        for i in 0..self.spawns.len() {
            self.spawn_across(field, self.spawns[i]);
        }
        self.spawns.clear();
        let status = &field.statuses[self.thread].0;
        status.load.store(self.load, Relaxed);
        status.again.store(self.again, Relaxed);
        let waiting = self.store.waiting() as u64 + self.sent;
        status.waiting.store(waiting, Relaxed);
    }

    /// Takes a list across its face.
    ///
    /// # Safety
    ///
    /// The processor must know the instructions of `L`.
    #[allow(unsafe_code)] // For a processor with the instructions of `L`, which only the caller knows.
    #[inline(always)]
    unsafe fn cross_list<L: Lanes, P: Probe>(
        &mut self,
        field: &Field,
        f: u32,
        corner: usize,
        list: u32,
        probe: &mut P,
    ) {
        let face = &field.surface.faces[f as usize];
        let h = half_edge(f, corner);
        let arrived = self.store.len(list);
        let mut len = arrived;
        self.load += arrived as u64 + LIST;
        probe.enter(Phase::Pruning);
        if field.compared.takes(h, len) {
            let block = self.store.block_and_line_behind(list);
            // SAFETY: promised by the caller.
            len = unsafe { kernels::compare::<L>(block, len, &mut self.cuts) };
        }
        let [tail, head, apex] = [corner, next(corner), prev(corner)].map(|k| face.vertex[k]);
        let gate = Gate {
            l: face.length[corner],
            apex: face.apex(corner),
            ends: [field.distance(tail), field.distance(head)],
        };
        let block = self.store.block(list);
        // SAFETY: promised by the caller.
        let found = unsafe { kernels::measure::<L, true>(block, 0, len, &gate, &mut self.keep) };
        probe.enter(Phase::Propagation);
        self.tally.filtered += (arrived - found.kept) as u64;
        self.tally.parents += found.kept as u64;
        if found.kept > 0 {
            let best = BestPath::of(self.store.block(list), found.best, gate.apex, gate.l);
            if found.distance < field.distance(apex) {
                self.offer(
                    field,
                    Offer {
                        vertex: apex,
                        h,
                        entry: best.entry,
                        distance: found.distance,
                    },
                );
            }
            // SAFETY: promised by the caller.
            unsafe { self.carry::<L, P>(field, list, corner, face, &found, &best, probe) };
        }
        probe.enter(Phase::Management);
        self.store.set_len(list, 0);
    }

    /// Takes what `found` counted in `list` across `face`, into the lists behind its two exits.
    ///
    /// # Safety
    ///
    /// The processor must know the instructions of `L`.
    #[allow(unsafe_code)] // For a processor with the instructions of `L`, which only the caller knows.
    #[allow(clippy::too_many_arguments)] // All of what the caller has found out.
    #[inline(always)]
    unsafe fn carry<L: Lanes, P: Probe>(
        &mut self,
        field: &Field,
        list: u32,
        corner: usize,
        face: &Face,
        found: &Measured,
        best: &BestPath,
        probe: &mut P,
    ) {
        let exits = [face.twin[prev(corner)], face.twin[next(corner)]];
        let mut lists = [NO_LIST; 2];
        let mut owners = [self.thread; 2];
        for side in 0..2 {
            if exits[side] != NOBODY && found.bound[side] > 0 {
                let (f, k) = parts(exits[side]);
                owners[side] = self.owner_of_face(field, f);
                let known = if owners[side] == self.thread {
                    field.faces[f].list(k)
                } else {
                    NO_LIST
                };
                lists[side] = self.store.reserve(known, found.bound[side]);
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
        let triangle = face.triangle(corner);
        // SAFETY: promised by the caller; `keep` and the bounds are of this list.
        let carried = unsafe {
            kernels::carry::<L, BestPath>(
                block,
                found.len,
                &self.keep,
                &triangle,
                best,
                0.0,
                [&mut left, &mut right],
            )
        };
        let after = [left.len, right.len];
        probe.enter(Phase::Management);
        for side in 0..2 {
            if lists[side] != NO_LIST {
                let list = self.store.set_len(lists[side], after[side]);
                let more = after[side] - before[side];
                self.deliver(field, exits[side], list, more, owners[side]);
            }
        }
        let children = after[0] + after[1] - before[0] - before[1];
        self.tally.propagated += carried.tried as u64;
        self.tally.children += children as u64;
    }

    /// Puts `list`, which has grown by `more` windows, on the half-edge `h` of a face of `owner`.
    #[inline(always)]
    fn deliver(&mut self, field: &Field, h: u32, list: u32, more: usize, owner: usize) {
        let (f, k) = parts(h);
        let state = &field.faces[f];
        let has_joined = state.has_joined(field.run);
        self.split.note(f, more);
        self.again += if has_joined { more as u64 } else { 0 };
        if owner == self.thread {
            state.set_list(k, list);
            if list != NO_LIST && has_joined && state.enqueue() {
                self.ready.push(f as u32);
            }
        } else if list != NO_LIST {
            self.sent += more as u64;
            self.send_windows(list, h, owner);
        }
    }

    /// Tells the owner of a vertex about a path to it.
    #[inline]
    fn offer(&mut self, field: &Field, offer: Offer) {
        let owner = self.owner_of_vertex(field, offer.vertex);
        if owner == self.thread {
            self.offers.push(offer);
        } else {
            self.desk.out[owner].offers.push(offer);
        }
    }

    /// Sends a path along the half-edge of `spawn`, and a window across its face; along the other edge too if
    /// that is the last one.
    #[inline]
    fn spawn_across(&mut self, field: &Field, spawn: Spawn) {
        let Spawn {
            h,
            last,
            distance: d,
        } = spawn;
        let (f, corner) = parts(h);
        let (after, before) = (next(corner), prev(corner));
        let face = &field.surface.faces[f];
        let [v, a, b] = [corner, after, before].map(|k| face.vertex[k]);
        let [to_a, to_b] = [d + face.length[corner], d + face.length[before]];
        let [at_a, at_b] = [a, b].map(|v| field.distance(v));
        let l = face.length[after];
        // Seen from the opposite vertices the paths come along the far ends of their half-edges.
        if to_a < at_a {
            self.offer(
                field,
                Offer {
                    vertex: a,
                    h: half_edge(f as u32, before),
                    entry: face.length[before],
                    distance: to_a,
                },
            );
        }
        if (last || field.surface.vertices[v as usize].boundary) && to_b < at_b {
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
        // The vertex filter: each end's own path along the edge beats the farthest ray.
        if at_b * MARGIN + l < to_a || at_a * MARGIN + l < to_b {
            self.tally.filtered += 1;
            return;
        }
        let [x, y] = face.apex(after);
        let (target, k) = parts(twin);
        let owner = self.owner_of_face(field, target);
        let known = if owner == self.thread {
            field.faces[target].list(k)
        } else {
            NO_LIST
        };
        let list = self.store.reserve(known, 1);
        let len = self.store.len(list);
        self.store.put(list, len, [0.0, l, l - x, -y, d]);
        let list = self.store.set_len(list, len + 1);
        self.deliver(field, twin, list, 1, owner);
    }

    /// Asks for the face of a task.
    #[inline(always)]
    fn prefetch_face(&self, field: &Field, task: usize) {
        if let Some(task) = self.tasks.get(task) {
            let face = &field.surface.faces[task.face as usize];
            line(face);
            line(&face.apex_x);
        }
    }

    /// Asks for what a task touches beyond its face.
    #[inline(always)]
    fn prefetch_beyond(&self, field: &Field, task: usize) {
        if let Some(task) = self.tasks.get(task) {
            let face = &field.surface.faces[task.face as usize];
            for corner in 0..3 {
                prefetch(&field.faces, parts(face.twin[corner]).0);
                prefetch(&field.distances, face.vertex[corner] as usize);
            }
        }
    }
}
