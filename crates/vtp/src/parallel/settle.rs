//! The second half of a step: distances improve, with their consequences. No window moves.

use super::field::Field;
use super::mail::{Offer, Spawn};
use super::worker::Worker;
use crate::engine::shadow::{Origin, Shadow};
use crate::engine::surface::parts;

impl Worker {
    /// Takes the shortest of the paths that were found to each vertex of this thread.
    ///
    /// Every one was shorter than the distance before this step. Which of several comes first must not
    /// matter, so of equally short ones the one with the least half-edge and entry is taken.
    pub(super) fn settle(&mut self, field: &Field) {
        let offers = std::mem::take(&mut self.offers);
        for offer in &offers {
            let (distance, vertex) = (
                &field.distances[offer.vertex as usize],
                &field.vertices[offer.vertex as usize],
            );
            let known = distance.get();
            if offer.distance < known
                || offer.distance == known && comes_before(offer, vertex.origin())
            {
                distance.set(offer.distance);
                vertex.set_origin(Origin {
                    h: offer.h,
                    entry: offer.entry,
                });
            }
        }
        for &Offer {
            vertex,
            h,
            entry,
            distance,
        } in &offers
        {
            let state = &field.vertices[vertex as usize];
            let origin = state.origin();
            if distance > field.distance(vertex) || (origin.h, origin.entry) != (h, entry) {
                continue;
            }
            if state.has_passed() {
                self.spawn_if_nearer(field, vertex);
            } else {
                self.tally.pushes += u64::from(self.buckets.push(vertex, distance));
            }
        }
        self.offers = offers;
        self.offers.clear();
    }

    /// Has windows start from `v` if it is a pseudo-source that has come nearer since it last did.
    pub(super) fn spawn_if_nearer(&mut self, field: &Field, v: u32) {
        let (vertex, state) = (
            field.surface.vertices[v as usize],
            &field.vertices[v as usize],
        );
        let distance = field.distance(v);
        if vertex.pseudo_source && distance < state.spawned.get() {
            state.spawned.set(distance);
            self.spawn(field, v, vertex.all_around || !field.shadow);
        }
    }

    /// Has windows start from `v` in the next step, in all directions or into the shadow of the path that
    /// reached it. All faces around it have joined.
    pub(super) fn spawn(&mut self, field: &Field, v: u32, all_around: bool) {
        self.tally.pseudo_sources += 1;
        let ring = field.surface.ring(v);
        let shadow = if all_around {
            Shadow::all(ring.len())
        } else {
            Shadow::of(&field.surface, v, field.vertices[v as usize].origin())
        };
        let distance = field.distance(v);
        let mut place = shadow.first;
        for i in 0..shadow.count {
            let h = ring[place];
            place = if place + 1 == ring.len() {
                0
            } else {
                place + 1
            };
            let spawn = Spawn {
                h,
                // The last edge belongs to the next face, if there is one.
                last: !all_around && i + 1 == shadow.count,
                distance,
            };
            let owner = self.owner_of_face(field, parts(h).0);
            if owner == self.thread {
                self.spawns.push(spawn);
            } else {
                self.desk.out[owner].spawns.push(spawn);
            }
        }
    }
}

/// Whether an offer goes before another one of the same length.
fn comes_before(offer: &Offer, other: Origin) -> bool {
    offer.h < other.h || offer.h == other.h && offer.entry < other.entry
}
