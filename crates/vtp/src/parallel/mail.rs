//! What threads tell each other, and when.

use std::mem;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use super::barrier::{Barrier, Broken};
use super::padded::Padded;

/// A path to a vertex that was the shortest before this phase.
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

/// A path and a window that are to start from the vertex at which a half-edge starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spawn {
    pub(super) h: u32,
    /// Whether a path is to be sent along the other edge of the face as well.
    pub(super) last: bool,
    /// The distance of the vertex.
    pub(super) distance: f64,
}

/// Letters from one thread to another.
#[derive(Clone, Debug, Default)]
pub(super) struct Mail {
    pub(super) offers: Vec<Offer>,
    pub(super) spawns: Vec<Spawn>,
    /// Half-edges for which there are windows, and how many.
    pub(super) arrivals: Vec<(u32, u32)>,
    /// These windows, list by list, in columns.
    pub(super) windows: Vec<f64>,
    /// Faces that have joined the traversed area.
    pub(super) joined: Vec<u32>,
    /// Loads of parts of the surface, see [`Split`](super::split::Split).
    pub(super) loads: Vec<(u32, u32)>,
}

impl Mail {
    fn is_empty(&self) -> bool {
        self.offers.is_empty()
            && self.spawns.is_empty()
            && self.arrivals.is_empty()
            && self.joined.is_empty()
            && self.loads.is_empty()
    }

    fn clear(&mut self) {
        self.offers.clear();
        self.spawns.clear();
        self.arrivals.clear();
        self.windows.clear();
        self.joined.clear();
        self.loads.clear();
    }
}

/// Where the letters from one thread to another lie.
#[derive(Debug, Default)]
struct Slot {
    full: AtomicBool,
    mail: Mutex<Mail>,
}

/// The mailboxes of all threads. There are two of each kind, used in turns, so that a phase can fill one
/// while a thread is still to empty the other.
#[derive(Debug)]
pub(super) struct Post {
    threads: usize,
    boxes: [Vec<Padded<Slot>>; 2],
    barrier: Barrier,
}

impl Post {
    pub(super) fn new(threads: usize) -> Self {
        let boxes = || {
            (0..threads * threads)
                .map(|_| Padded::default())
                .collect::<Vec<_>>()
        };
        Self {
            threads,
            boxes: [boxes(), boxes()],
            barrier: Barrier::new(threads as u32),
        }
    }

    pub(super) fn barrier(&self) -> &Barrier {
        &self.barrier
    }

    fn slot(&self, side: usize, from: usize, to: usize) -> &Slot {
        &self.boxes[side][from * self.threads + to].0
    }
}

/// A thread's own part of the post.
#[derive(Debug)]
pub(super) struct Desk {
    thread: usize,
    side: usize,
    /// What goes to each thread after this phase.
    pub(super) out: Vec<Mail>,
    read: Mail,
}

impl Desk {
    pub(super) fn new(thread: usize, threads: usize) -> Self {
        Self {
            thread,
            side: 0,
            out: vec![Mail::default(); threads],
            read: Mail::default(),
        }
    }

    /// Ends a phase: sends all letters and waits until all threads have done so.
    pub(super) fn send(&mut self, post: &Post) -> Result<(), Broken> {
        for (to, mail) in self.out.iter_mut().enumerate() {
            if !mail.is_empty() {
                let slot = post.slot(self.side, self.thread, to);
                let mut there = slot.mail.lock().unwrap_or_else(PoisonError::into_inner);
                mem::swap(&mut *there, mail);
                slot.full.store(true, Ordering::Relaxed);
            }
        }
        post.barrier.wait()?;
        self.side = 1 - self.side;
        Ok(())
    }

    /// The letters that another thread has sent at the end of the last phase, if there are any.
    pub(super) fn receive(&mut self, post: &Post, from: usize) -> Option<&Mail> {
        let slot = post.slot(1 - self.side, from, self.thread);
        if !slot.full.load(Ordering::Relaxed) {
            return None;
        }
        slot.full.store(false, Ordering::Relaxed);
        self.read.clear();
        let mut there = slot.mail.lock().unwrap_or_else(PoisonError::into_inner);
        mem::swap(&mut *there, &mut self.read);
        Some(&self.read)
    }
}
