//! Letters that a thread sends and gets.

use std::mem;

use super::field::Field;
use super::jitter::jitter;
use super::mail::Mail;
use super::worker::Worker;
use crate::engine::store::{COLUMNS, NO_LIST};
use crate::engine::surface::parts;

impl Worker {
    /// Whether there is a letter for this thread.
    #[inline(always)]
    pub(super) fn has_mail(&self, field: &Field) -> bool {
        (0..field.threads).any(|from| field.post.is_full(from, self.thread))
    }

    /// Sends what there is for others.
    pub(super) fn send(&mut self, field: &Field) {
        for (to, mail) in self.out.iter_mut().enumerate() {
            if !mail.is_empty() {
                jitter();
                field.post.send(self.thread, to, mail, &field.pace);
            }
        }
    }

    /// Takes in what others have sent.
    pub(super) fn receive(&mut self, field: &Field) {
        let mut letter = mem::take(&mut self.letter);
        for from in 0..field.threads {
            if field.post.receive(from, self.thread, &mut letter) {
                jitter();
                self.read(field, &letter);
                jitter();
                field.pace.end();
            }
        }
        self.letter = letter;
    }

    /// Takes in what `letter` says. Some of it may be about what this thread has given away since it was written; that goes on
    /// to whoever has it now.
    fn read(&mut self, field: &Field, letter: &Mail) {
        for &offer in &letter.offers {
            let owner = field.owner_of_vertex(offer.vertex);
            if owner == self.thread {
                self.hear_of(field, offer);
            } else {
                self.out[owner].offers.push(offer);
            }
        }
        let mut windows = letter.windows.as_slice();
        for &(h, n) in &letter.arrivals {
            let (list, rest) = windows.split_at(n as usize * COLUMNS);
            windows = rest;
            let (f, corner) = parts(h);
            let owner = field.owner_of_face(f);
            if owner == self.thread {
                let to = self.store.append(field.faces[f].list(corner), list);
                self.put_list(field, h, to);
            } else {
                self.out[owner].arrivals.push((h, n));
                self.out[owner].windows.extend_from_slice(list);
            }
        }
        for &f in &letter.joined {
            let owner = field.owner_of_face(f as usize);
            if owner == self.thread {
                self.queue_face(field, f as usize);
            } else {
                self.out[owner].joined.push(f);
            }
        }
        for &v in &letter.turns {
            let owner = field.owner_of_vertex(v);
            if owner != self.thread {
                self.out[owner].turns.push(v);
            } else if !field.vertices[v as usize].has_passed() {
                // Whoever gave it away has counted it.
                self.buckets.push(v, field.distance(v));
            }
        }
    }

    /// Sends the windows of `list`, which are to wait on `h`, to the thread `to`, and gives the list back.
    pub(super) fn send_windows(&mut self, list: u32, h: u32, to: usize) {
        let mail = &mut self.out[to];
        mail.arrivals.push((h, self.store.len(list) as u32));
        self.store.copy_out(list, &mut mail.windows);
        let none = self.store.set_len(list, 0);
        debug_assert!(none == NO_LIST);
    }

    /// Puts `list` on the half-edge `h` of a face of this thread, which is queued if the face has joined.
    #[inline(always)]
    pub(super) fn put_list(&mut self, field: &Field, h: u32, list: u32) {
        let (f, corner) = parts(h);
        let state = &field.faces[f];
        state.set_list(corner, list);
        if list != NO_LIST && state.has_joined(field.run) && state.enqueue(corner) {
            self.ready.push(h);
        }
    }
}
