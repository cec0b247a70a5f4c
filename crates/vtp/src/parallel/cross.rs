//! Lists cross faces.

use geobench_window::{Phase, Probe};

use super::field::Field;
use super::jitter::jitter;
use super::mail::Offer;
use super::worker::Worker;
use crate::engine::kernels::{self, BestPath, Gate, Measured, Target};
use crate::engine::lanes::{Lanes, Scalar};
use crate::engine::prefetch::{line, prefetch};
use crate::engine::reunite::FEW;
use crate::engine::store::NO_LIST;
use crate::engine::surface::{Face, NOBODY, next, parts, prev};

/// Lists after which a thread looks for mail and sends its own. What comes late has others cross once more.
const LISTS: usize = 16;

/// Shorter paths wait for their consequences until so many have come together.
const OFFERS: usize = 4096;

impl Worker {
    /// Lists cross until none is ready.
    ///
    /// # Safety
    ///
    /// The processor must know the instructions of `L`.
    #[allow(unsafe_code)] // For a processor with the instructions of `L`, which only the caller knows.
    #[inline(always)]
    pub(super) unsafe fn cross_all<L: Lanes, P: Probe, const REUNITE: bool>(
        &mut self,
        field: &Field,
        probe: &mut P,
    ) {
        let (mut place, mut exchange) = (0, LISTS);
        loop {
            if place == self.ready.len() || self.offers.len() >= OFFERS {
                self.settle(field);
            }
            let Some(&h) = self.ready.get(place) else {
                break;
            };
            if place == exchange {
                exchange += LISTS;
                self.receive(field);
                self.send(field);
            }
            self.prefetch_face(field, place + 6);
            self.prefetch_beyond(field, place + 3);
            place += 1;
            jitter();
            if REUNITE && L::COUNT > 1 && self.waiting_at(field, h) <= FEW {
                // SAFETY: every processor can count to one.
                unsafe { self.cross::<Scalar, P, REUNITE>(field, h, probe) };
            } else {
                // SAFETY: promised by the caller.
                unsafe { self.cross::<L, P, REUNITE>(field, h, probe) };
            }
        }
        self.ready.clear();
    }

    /// How many windows wait on `h`.
    #[inline(always)]
    fn waiting_at(&self, field: &Field, h: u32) -> usize {
        let (f, corner) = parts(h);
        self.store.len(field.faces[f].list(corner))
    }

    /// Takes the list on `h` across its face.
    ///
    /// # Safety
    ///
    /// The processor must know the instructions of `L`.
    #[allow(unsafe_code)] // For a processor with the instructions of `L`, which only the caller knows.
    #[inline(always)]
    unsafe fn cross<L: Lanes, P: Probe, const REUNITE: bool>(
        &mut self,
        field: &Field,
        h: u32,
        probe: &mut P,
    ) {
        let (f, corner) = parts(h);
        let face = &field.surface.faces[f];
        let list = field.faces[f].take(corner);
        let arrived = self.store.len(list);
        let mut len = arrived;
        field.split.note(self.thread, f, arrived);
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
            self.offer(
                field,
                Offer {
                    vertex: apex,
                    h,
                    entry: best.entry,
                    distance: found.distance,
                },
            );
            // SAFETY: promised by the caller.
            unsafe {
                self.carry::<L, P, REUNITE>(field, list, corner, face, &found, &best, probe);
            };
        }
        probe.enter(Phase::Management);
        self.store.set_len(list, 0);
        let waiting = self.store.waiting() as u64;
        self.tally.peak_windows = self.tally.peak_windows.max(waiting);
    }

    /// Takes what `found` counted in `list` across `face`, into the lists behind its two exits.
    ///
    /// # Safety
    ///
    /// The processor must know the instructions of `L`.
    #[allow(unsafe_code)] // For a processor with the instructions of `L`, which only the caller knows.
    #[allow(clippy::too_many_arguments)] // All of what the caller has found out.
    #[inline(always)]
    unsafe fn carry<L: Lanes, P: Probe, const REUNITE: bool>(
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
                owners[side] = field.owner_of_face(f);
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
        let mut after = [left.len, right.len];
        let children = after[0] + after[1] - before[0] - before[1];
        probe.enter(Phase::Management);
        if REUNITE {
            after = self
                .store
                .reunite_behind(face, corner, lists, before, after);
        }
        for side in 0..2 {
            if lists[side] != NO_LIST {
                let list = self.store.set_len(lists[side], after[side]);
                self.deliver(field, exits[side], list, owners[side]);
            }
        }
        self.tally.propagated += carried.tried as u64;
        self.tally.children += children as u64;
    }

    /// Has `list` wait on the half-edge `h` of a face of `owner`.
    #[inline(always)]
    pub(super) fn deliver(&mut self, field: &Field, h: u32, list: u32, owner: usize) {
        if owner == self.thread {
            self.put_list(field, h, list);
        } else if list != NO_LIST {
            self.send_windows(list, h, owner);
        }
    }

    /// Asks for the face that the list at `place` of the queue will cross.
    #[inline(always)]
    fn prefetch_face(&self, field: &Field, place: usize) {
        if let Some(&h) = self.ready.get(place) {
            let (f, _) = parts(h);
            let face = &field.surface.faces[f];
            line(face);
            line(&face.apex_x);
            prefetch(&field.faces, f);
        }
    }

    /// Asks for what the list at `place` of the queue touches beyond its face.
    #[inline(always)]
    fn prefetch_beyond(&self, field: &Field, place: usize) {
        if let Some(&h) = self.ready.get(place) {
            let face = &field.surface.faces[parts(h).0];
            for corner in 0..3 {
                prefetch(&field.faces, parts(face.twin[corner]).0);
                prefetch(&field.distances, face.vertex[corner] as usize);
            }
        }
    }
}
