//! What threads tell each other.

use std::mem;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use super::jitter::jitter;
use super::pace::Pace;
use super::padded::Padded;

/// A path to a vertex that was the shortest when it was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Offer {
    pub(super) vertex: u32,
    /// The half-edge that it crossed last.
    pub(super) h: u32,
    /// Where.
    pub(super) entry: f64,
    /// Its length.
    pub(super) distance: f64,
}

/// A letter from one thread to another.
#[derive(Clone, Debug, Default)]
pub(super) struct Mail {
    /// Paths to vertices of the other.
    pub(super) offers: Vec<Offer>,
    /// Half-edges of faces of the other for which there are windows, and how many.
    pub(super) arrivals: Vec<(u32, u32)>,
    /// These windows, list by list, in columns.
    pub(super) windows: Vec<f64>,
    /// Faces of the other that have joined the traversed area.
    pub(super) joined: Vec<u32>,
    /// Vertices that wait for their turns, and are the other's from now on.
    pub(super) turns: Vec<u32>,
}

impl Mail {
    pub(super) fn is_empty(&self) -> bool {
        self.offers.is_empty()
            && self.arrivals.is_empty()
            && self.joined.is_empty()
            && self.turns.is_empty()
    }

    fn clear(&mut self) {
        self.offers.clear();
        self.arrivals.clear();
        self.windows.clear();
        self.joined.clear();
        self.turns.clear();
    }

    /// Adds what another letter says, which is empty afterwards.
    fn append(&mut self, other: &mut Self) {
        self.offers.append(&mut other.offers);
        self.arrivals.append(&mut other.arrivals);
        self.windows.append(&mut other.windows);
        self.joined.append(&mut other.joined);
        self.turns.append(&mut other.turns);
    }
}

/// Where a letter from one thread to another lies.
#[derive(Debug, Default)]
struct Slot {
    full: AtomicBool,
    mail: Mutex<Mail>,
}

/// The mailboxes of all threads: one for each two.
#[derive(Debug)]
pub(super) struct Post {
    threads: usize,
    slots: Vec<Padded<Slot>>,
}

impl Post {
    pub(super) fn new(threads: usize) -> Self {
        Self {
            threads,
            slots: (0..threads * threads).map(|_| Padded::default()).collect(),
        }
    }

    fn slot(&self, from: usize, to: usize) -> &Slot {
        &self.slots[from * self.threads + to].0
    }

    /// Sends a letter, which is empty afterwards; together with the last one if that has not been taken.
    pub(super) fn send(&self, from: usize, to: usize, mail: &mut Mail, pace: &Pace) {
        let slot = self.slot(from, to);
        let mut there = slot.mail.lock().unwrap_or_else(PoisonError::into_inner);
        jitter();
        if slot.full.load(Ordering::Relaxed) {
            there.append(mail);
        } else {
            pace.begin();
            jitter();
            pace.call_back(from, to);
            mem::swap(&mut *there, mail);
            slot.full.store(true, Ordering::Relaxed);
        }
    }

    /// Whether there is a letter.
    #[inline(always)]
    pub(super) fn is_full(&self, from: usize, to: usize) -> bool {
        self.slot(from, to).full.load(Ordering::Relaxed)
    }

    /// Takes the letter, if there is one, into `mail`, whose contents are lost; returns whether there was one. When all has been
    /// done that it asks for, it is to [end](Pace::end).
    pub(super) fn receive(&self, from: usize, to: usize, mail: &mut Mail) -> bool {
        if !self.is_full(from, to) {
            return false;
        }
        mail.clear();
        let slot = self.slot(from, to);
        let mut there = slot.mail.lock().unwrap_or_else(PoisonError::into_inner);
        mem::swap(&mut *there, mail);
        slot.full.store(false, Ordering::Relaxed);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_that_wait_become_one_and_count_once() {
        let (post, mut pace) = (Post::new(2), Pace::new(2));
        pace.reset();
        let offer = |vertex| Offer {
            vertex,
            h: 7,
            entry: 0.5,
            distance: 1.5,
        };
        let mut received = Mail::default();
        for _ in 0..2 {
            assert!(!post.is_full(1, 0) && !post.receive(1, 0, &mut received));
            for vertex in [3, 4] {
                let mut mail = Mail {
                    offers: vec![offer(vertex)],
                    arrivals: vec![(vertex, 1)],
                    windows: vec![f64::from(vertex); 5],
                    joined: vec![vertex],
                    turns: vec![vertex + 10],
                };
                post.send(1, 0, &mut mail, &pace);
                assert!(mail.is_empty());
            }
            assert!(post.is_full(1, 0) && !post.is_full(0, 1));
            assert!(post.receive(1, 0, &mut received));
            assert_eq!(received.offers, [3, 4].map(offer));
            assert_eq!(received.arrivals, [(3, 1), (4, 1)]);
            assert_eq!(received.windows, [[3.0; 5], [4.0; 5]].concat());
            assert_eq!(received.joined, [3, 4]);
            assert_eq!(received.turns, [13, 14]);
            pace.end();
        }
        pace.end();
        assert!(!pace.is_over());
        pace.end();
        assert!(pace.is_over());
    }
}
