//! Parts of the wavefront change hands.

use std::mem;

use super::field::Field;
use super::jitter::jitter;
use super::worker::Worker;
use crate::engine::store::NO_LIST;
use crate::engine::surface::{half_edge, parts};

/// Buckets whose vertices are looked at. Blocks of which all vertices are farther from their turns wait for the next time.
const REACH: u32 = 8;

/// Vertices between one that changes hands and the next cut, at least: what is nearer might come back the next time.
const MARGIN: u32 = 32;

impl Worker {
    /// Gives away what lies in the range of another thread since the surface was divided anew: the blocks of the vertices that are to have
    /// their turns next, and of the faces around them, with the windows that wait there.
    ///
    /// Nothing may be ready to cross, and no path may wait for its consequences. The bucket is that of the next turn.
    pub(super) fn hand_over(&mut self, field: &Field, bucket: u32) {
        debug_assert!(self.ready.is_empty() && self.offers.is_empty());
        let mut front = mem::take(&mut self.turn);
        front.clear();
        for bucket in bucket..bucket.saturating_add(REACH) {
            front.extend(self.buckets.waiting_in(bucket));
        }
        for &v in &front {
            jitter();
            let [to, other] = [v.saturating_sub(MARGIN), v.saturating_add(MARGIN)]
                .map(|near| field.split.owner_of_vertex(near));
            if to == self.thread || to != other {
                continue;
            }
            if field.owner_of_vertex(v) == self.thread {
                self.give_vertices(field, v, to);
            }
            for &h in field.surface.ring(v) {
                let (f, _) = parts(h);
                let to = field.split.owner_of_face(f);
                if to != self.thread && field.owner_of_face(f) == self.thread {
                    self.give_faces(field, f, to);
                }
            }
        }
        self.turn = front;
        self.send(field);
    }

    /// Gives the block of vertex `v` to the thread `to`.
    fn give_vertices(&mut self, field: &Field, v: u32, to: usize) {
        for v in field.vertex_owners.block(v as usize) {
            if self.buckets.remove(v as u32) {
                self.out[to].turns.push(v as u32);
            }
        }
        jitter();
        field.vertex_owners.give(v as usize, to);
        self.tally.given += 1;
    }

    /// Gives the block of face `f` to the thread `to`.
    fn give_faces(&mut self, field: &Field, f: usize, to: usize) {
        for f in field.face_owners.block(f) {
            for corner in 0..3 {
                // No half-edge is queued, since nothing is ready to cross.
                let list = field.faces[f].take(corner);
                if list != NO_LIST {
                    self.send_windows(list, half_edge(f as u32, corner), to);
                }
            }
        }
        jitter();
        // From now on the new owner may put lists there.
        field.face_owners.give(f, to);
        self.tally.given += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::store::COLUMNS;
    use crate::parallel::test_run::{path, two_threads};

    /// A vertex, and a face around it, of the first thread.
    fn of_the_first_thread(field: &Field) -> (u32, usize) {
        let v = 150;
        let faces = field.surface.ring(v).iter().map(|&h| parts(h).0);
        let f = faces.max().unwrap();
        assert_eq!((field.owner_of_vertex(v), field.owner_of_face(f)), (0, 0));
        (v, f)
    }

    /// Divides anew: the second thread gets what comes after vertex `cut` or so.
    fn divide(field: &Field, cut: u32) {
        let mut faces = field.surface.faces.iter();
        let first = faces.position(|face| face.vertex.iter().all(|&v| v >= cut));
        field.split.note(0, first.unwrap(), 1000);
        field.split.come_to(0, 100, 0, &field.surface);
        assert_eq!(field.split.divisions(), 1);
    }

    /// The windows on half-edge `h`.
    fn windows(worker: &Worker, field: &Field, h: u32) -> Vec<[f64; COLUMNS]> {
        let (f, corner) = parts(h);
        let list = field.faces[f].list(corner);
        let places = 0..worker.store.len(list);
        places.map(|i| worker.store.get(list, i)).collect()
    }

    /// A list of `windows`, on no half-edge yet.
    fn list_of(worker: &mut Worker, windows: &[[f64; COLUMNS]]) -> u32 {
        let list = worker.store.reserve(NO_LIST, windows.len());
        for (i, &window) in windows.iter().enumerate() {
            worker.store.put(list, i, window);
        }
        worker.store.set_len(list, windows.len())
    }

    /// A run whose first thread has given a vertex with a turn in bucket 2 to the second one, which has not read the letter.
    fn after_a_gift() -> (Field, [Worker; 2], u32) {
        let (field, mut workers) = two_threads();
        let (v, _) = of_the_first_thread(&field);
        field.distances[v as usize].set(2.5);
        workers[0].buckets.push(v, 2.5);
        divide(&field, 100);
        workers[0].hand_over(&field, 2);
        (field, workers, v)
    }

    #[test]
    fn what_changes_hands_arrives_whole() {
        let (field, [mut first, mut second]) = two_threads();
        let (v, f) = of_the_first_thread(&field);
        let far = field.vertex_owners.block(v as usize).start as u32;
        for (vertex, distance) in [(v, 2.5), (far, 5000.5)] {
            field.distances[vertex as usize].set(distance);
            first.buckets.push(vertex, distance);
        }
        let lists = [0, 2].map(|corner| {
            let windows: Vec<_> = (0..9 + corner).map(|i| [i as f64; COLUMNS]).collect();
            let h = half_edge(f as u32, corner);
            let list = list_of(&mut first, &windows);
            first.put_list(&field, h, list);
            (h, windows)
        });

        first.hand_over(&field, 2);
        assert!(!second.has_mail(&field), "given away without need");
        divide(&field, 100);
        first.hand_over(&field, 2);
        assert_eq!((field.owner_of_vertex(v), field.owner_of_face(f)), (1, 1));
        assert_eq!((first.buckets.nearest(), first.store.waiting()), (None, 0));

        second.receive(&field);
        for (h, sent) in lists {
            assert_eq!(windows(&second, &field, h), sent);
        }
        let mut turn = Vec::new();
        for (vertex, bucket) in [(v, 2), (far, 5000)] {
            assert_eq!(second.buckets.nearest(), Some(bucket));
            second.buckets.take(bucket, &mut turn);
            assert_eq!(turn, [vertex]);
        }
        assert!(!first.has_mail(&field));
    }

    #[test]
    fn what_lies_next_to_a_cut_stays() {
        for (thread, cut, gone, stays) in [(0, 100, 200, 110), (1, 350, 300, 340)] {
            let (field, mut workers) = two_threads();
            for v in [gone, stays] {
                assert_eq!(field.owner_of_vertex(v), thread);
                workers[thread].buckets.push(v, 2.5);
            }
            divide(&field, cut);
            workers[thread].hand_over(&field, 2);
            let owners =
                [gone, stays].map(|v| (field.split.owner_of_vertex(v), field.owner_of_vertex(v)));
            assert_eq!(owners, [(1 - thread, 1 - thread), (1 - thread, thread)]);
        }
    }

    #[test]
    fn a_letter_about_what_has_been_given_away_goes_on_to_the_new_owner() {
        let (field, [mut first, mut second]) = two_threads();
        let (v, f) = of_the_first_thread(&field);
        first.buckets.push(v, 2.5);
        let h = half_edge(f as u32, 1);
        let offer = path(&field, v, 0, 2.25);
        let window = [7.0; COLUMNS];
        let list = list_of(&mut second, &[window]);
        second.deliver(&field, h, list, 0);
        second.offer(&field, offer);
        second.send(&field);

        divide(&field, 100);
        first.hand_over(&field, 2);
        first.receive(&field);
        assert_eq!((first.store.waiting(), first.offers.len()), (0, 0));
        first.send(&field);
        second.receive(&field);
        assert_eq!(windows(&second, &field, h), [window]);
        assert_eq!(second.offers, [offer]);

        // The face joined when it still was the first thread's.
        assert_eq!(second.ready, []);
        second.out[0].joined.push(f as u32);
        second.send(&field);
        first.receive(&field);
        first.send(&field);
        second.receive(&field);
        assert_eq!(second.ready, [h]);
    }

    #[test]
    fn a_vertex_that_is_given_back_before_the_letter_is_read_has_its_turn() {
        let (field, [mut first, mut second], v) = after_a_gift();
        field.vertex_owners.give(v as usize, 0);
        second.receive(&field);
        assert_eq!(second.buckets.nearest(), None);
        second.send(&field);
        first.receive(&field);
        assert_eq!(first.buckets.nearest(), Some(2));
    }

    #[test]
    fn a_vertex_that_has_had_its_turn_gets_no_other_one_from_a_letter() {
        let (field, [_, mut second], v) = after_a_gift();
        // The new owner knows that it is, and a path reaches the vertex, before the letter is read.
        second.buckets.push(v, 2.5);
        let mut turn = Vec::new();
        second.buckets.take(2, &mut turn);
        field.vertices[v as usize].pass();
        second.receive(&field);
        assert_eq!(
            (turn.as_slice(), second.buckets.nearest()),
            ([v].as_slice(), None)
        );
    }
}
