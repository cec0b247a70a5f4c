//! Paths to vertices, and what follows when they are the shortest.

use super::field::Field;
use super::jitter::jitter;
use super::mail::Offer;
use super::worker::Worker;
use crate::engine::shadow::Origin;

impl Worker {
    /// A path has been found to a vertex, which may be another thread's.
    #[inline(always)]
    pub(super) fn offer(&mut self, field: &Field, offer: Offer) {
        if offer.distance < field.distance(offer.vertex) {
            jitter();
            self.accept(field, offer);
        }
    }

    /// A path has been found that was shorter than the one known a moment ago.
    ///
    /// The owner may overwrite what another thread has found in the same moment; it gets to know it by mail.
    #[inline(always)]
    fn accept(&mut self, field: &Field, offer: Offer) {
        let known = &field.distances[offer.vertex as usize];
        let owner = field.owner_of_vertex(offer.vertex);
        if owner == self.thread {
            // Whoever had the vertex until now may have found a shorter one, and tells nobody.
            if offer.distance < known.get() {
                jitter();
                known.set(offer.distance);
                self.offers.push(offer);
            }
        } else if known.lower(offer.distance) {
            jitter();
            self.out[owner].offers.push(offer);
        }
    }

    /// Another thread has found a path to a vertex of this thread.
    pub(super) fn hear_of(&mut self, field: &Field, offer: Offer) {
        let known = &field.distances[offer.vertex as usize];
        if offer.distance <= known.get() {
            jitter();
            known.set(offer.distance);
            self.offers.push(offer);
        }
    }

    /// The consequences of distances that have improved.
    pub(super) fn settle(&mut self, field: &Field) {
        let mut next = 0;
        // Windows that start find more.
        while let Some(&offer) = self.offers.get(next) {
            next += 1;
            let (vertex, distance) = (offer.vertex, offer.distance);
            if distance > field.distance(vertex) {
                // What came later has its own consequences.
                continue;
            }
            let state = &field.vertices[vertex as usize];
            if field.surface.vertices[vertex as usize].pseudo_source {
                let Offer { h, entry, .. } = offer;
                state.reach(distance, Origin { h, entry });
                if state.has_passed() {
                    self.spawn_if_nearer(field, vertex);
                }
            }
            if !state.has_passed() {
                self.tally.pushes += u64::from(self.buckets.push(vertex, distance));
            }
        }
        self.offers.clear();
        self.tally.peak_queue = self.tally.peak_queue.max(self.buckets.len() as u64);
    }

    /// Has windows start from `v` if it is a pseudo-source that has come nearer since it last did.
    pub(super) fn spawn_if_nearer(&mut self, field: &Field, v: u32) {
        let (vertex, state) = (
            field.surface.vertices[v as usize],
            &field.vertices[v as usize],
        );
        let distance = state.reached.get();
        jitter();
        // If another thread has found a shorter path, of which it is not known yet where it comes from, windows start when it is.
        if vertex.pseudo_source && distance < state.spawned.get() && distance <= field.distance(v) {
            state.spawned.set(distance);
            self.spawn(field, v, vertex.all_around || !field.shadow);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::parallel::test_run::{path, two_threads};

    /// The distance of a vertex once was lowered by another thread, and its turn came before the letter that said by
    /// which path: windows started into the shadow of the old path, and never into that of the new one.
    #[test]
    fn windows_do_not_start_into_the_shadow_of_a_path_that_is_no_longer_the_shortest() {
        let (field, mut workers) = two_threads();
        let mut vertices = (0..).zip(&field.surface.vertices);
        let inside = vertices.find(|(_, v)| v.pseudo_source && !v.all_around);
        let (vertex, _) = inside.unwrap();
        let owner = field.owner_of_vertex(vertex);
        let other = 1 - owner;
        let offer = |place, distance| path(&field, vertex, place, distance);
        let state = &field.vertices[vertex as usize];
        workers[owner].offer(&field, offer(0, 10.0));
        workers[owner].settle(&field);
        assert_eq!(
            (state.reached.get(), state.origin().h),
            (10.0, offer(0, 0.0).h)
        );

        workers[other].offer(&field, offer(2, 9.0));
        assert_eq!(field.distance(vertex), 9.0);
        workers[owner].turn.push(vertex);
        workers[owner].pass(&field);
        assert_eq!(state.spawned.get(), f64::INFINITY);

        workers[other].send(&field);
        assert!(workers[owner].has_mail(&field));
        workers[owner].receive(&field);
        workers[owner].settle(&field);
        assert_eq!(
            (state.spawned.get(), state.origin().h),
            (9.0, offer(2, 0.0).h)
        );
    }

    #[test]
    fn of_two_paths_found_at_the_same_time_the_shorter_one_stays() {
        let (field, mut workers) = two_threads();
        let vertex = 7;
        let owner = field.owner_of_vertex(vertex);
        let offer = |distance| path(&field, vertex, 0, distance);
        workers[1 - owner].offer(&field, offer(9.0));
        // As if the owner had looked before that.
        field.distances[vertex as usize].set(10.0);
        workers[1 - owner].send(&field);
        workers[owner].receive(&field);
        assert_eq!(field.distance(vertex), 9.0);
        workers[owner].offer(&field, offer(9.5));
        assert_eq!(workers[owner].offers, [offer(9.0)]);
    }

    /// Whoever had just been given a vertex once overwrote the shorter distance that its last owner had found meanwhile.
    #[test]
    fn a_vertex_that_has_just_changed_hands_keeps_the_path_of_its_last_owner() {
        let (field, mut workers) = two_threads();
        let vertex = 7;
        let owner = field.owner_of_vertex(vertex);
        let offer = |distance| path(&field, vertex, 0, distance);
        workers[owner].offer(&field, offer(4.0));
        workers[owner].settle(&field);
        field.vertex_owners.give(vertex as usize, 1 - owner);
        // As if the new owner had looked before all that.
        workers[1 - owner].accept(&field, offer(9.5));
        assert_eq!(field.distance(vertex), 4.0);
        assert_eq!(workers[1 - owner].offers, []);
    }
}
