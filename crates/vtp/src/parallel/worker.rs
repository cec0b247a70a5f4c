//! What one thread does in a run.

use std::ops::Range;
use std::sync::atomic::Ordering::Relaxed;
use std::time::Instant;

use geobench_window::{Counter, Probe};

use super::barrier::Broken;
use super::field::Field;
use super::mail::{Desk, Offer, Spawn};
use super::split::Split;
use crate::engine::buckets::Buckets;
use crate::engine::kernels::Cuts;
use crate::engine::lanes::Lanes;
use crate::engine::store::{COLUMNS, NO_LIST, WindowStore};
use crate::engine::surface::parts;

/// Stands for no bucket.
const NO_BUCKET: u32 = u32::MAX;

/// A face whose lists are about to cross.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task {
    pub(super) face: u32,
    pub(super) lists: [u32; 3],
}

/// What has been counted.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tally {
    pub(super) propagated: u64,
    pub(super) parents: u64,
    pub(super) children: u64,
    pub(super) spawned: u64,
    pub(super) filtered: u64,
    pub(super) pushes: u64,
    pub(super) pseudo_sources: u64,
}

impl Tally {
    /// Tells `probe`.
    pub(super) fn report(&self, probe: &mut impl Probe) {
        for (counter, n) in [
            (Counter::Propagated, self.propagated),
            (Counter::Parents, self.parents),
            (Counter::Children, self.children),
            (Counter::Spawned, self.spawned),
            (Counter::Filtered, self.filtered),
            (Counter::QueuePushes, self.pushes),
            (Counter::PseudoSources, self.pseudo_sources),
        ] {
            probe.add(counter, n);
        }
    }
}

/// A thread's own things, kept from run to run.
#[derive(Debug)]
pub(super) struct Worker {
    pub(super) thread: usize,
    pub(super) store: WindowStore,
    /// Faces of this thread with lists that are to cross in the next phase.
    pub(super) ready: Vec<u32>,
    pub(super) tasks: Vec<Task>,
    /// Windows that are to start in the next phase across faces of this thread.
    pub(super) spawns: Vec<Spawn>,
    /// Paths to vertices of this thread that were found in the last phase.
    pub(super) offers: Vec<Offer>,
    /// Half-edges whose windows other threads ask for.
    pub(super) requests: Vec<u32>,
    /// Vertices whose turn it is, first those that were this thread's, then those that shall be.
    pub(super) turn: Vec<u32>,
    /// Vertices whose turn it is with any thread.
    pub(super) front: Vec<u32>,
    pub(super) split: Split,
    pub(super) buckets: Buckets,
    pub(super) desk: Desk,
    pub(super) keep: Vec<u8>,
    pub(super) cuts: Cuts,
    /// How long this thread has been at work in this round, in nanoseconds.
    pub(super) load: u64,
    pub(super) tally: Tally,
}

impl Worker {
    pub(super) fn new(thread: usize, threads: usize, vertices: usize, bucket: f64) -> Self {
        Self {
            thread,
            store: WindowStore::new(),
            ready: Vec::new(),
            tasks: Vec::new(),
            spawns: Vec::new(),
            offers: Vec::new(),
            requests: Vec::new(),
            turn: Vec::new(),
            front: Vec::new(),
            split: Split::new(vertices, threads),
            buckets: Buckets::new(vertices, bucket),
            desk: Desk::new(thread, threads),
            keep: Vec::new(),
            cuts: Cuts::default(),
            load: 0,
            tally: Tally::default(),
        }
    }

    /// This thread's share of `count` things.
    pub(super) fn share(&self, field: &Field, count: usize) -> Range<usize> {
        let size = count.div_ceil(field.threads);
        let start = (self.thread * size).min(count);
        start..(start + size).min(count)
    }

    /// All rounds from `sources`.
    ///
    /// # Safety
    ///
    /// The processor must know the instructions of `L`.
    #[allow(unsafe_code)] // For a processor with the instructions of `L`, which only the caller knows.
    #[inline(always)]
    pub(super) unsafe fn run<L: Lanes, P: Probe>(
        &mut self,
        field: &Field,
        sources: &[u32],
        probe: &mut P,
    ) -> Result<(), Broken> {
        self.tally = Tally::default();
        self.load = 0;
        self.buckets.reset();
        field.reset_vertices(self.share(field, field.vertices.len()));
        self.exchange(field)?;
        if self.thread == 0 {
            self.start_from(field, sources);
        }
        self.exchange(field)?;
        loop {
            loop {
                let began = Instant::now();
                // SAFETY: promised by the caller.
                unsafe { self.cross::<L, P>(field, probe) };
                self.work_since(began);
                self.exchange(field)?;
                self.settle(field);
                self.say(field);
                self.exchange(field)?;
                if P::COUNTS {
                    let of = |f: fn(&super::field::Status) -> u64| field.sum(f);
                    probe.raise(Counter::PeakWindows, of(|s| s.waiting.load(Relaxed)));
                    probe.raise(Counter::QueuePeak, of(|s| s.queued.load(Relaxed)));
                }
                if field.sum(|s| s.work.load(Relaxed).into()) == 0 {
                    break;
                }
            }
            let nearest = field.statuses.iter().map(|s| s.0.nearest.load(Relaxed));
            let nearest = nearest.min().unwrap_or(NO_BUCKET);
            if nearest == NO_BUCKET {
                return Ok(());
            }
            probe.add(Counter::Iterations, 1);
            self.buckets.take(nearest, &mut self.turn);
            self.divide(field)?;
            let began = Instant::now();
            self.pass_turn(field);
            self.work_since(began);
            self.hand_over(field)?;
        }
    }

    fn work_since(&mut self, began: Instant) {
        self.load += began.elapsed().as_nanos() as u64;
    }

    /// Says how things stand.
    fn say(&mut self, field: &Field) {
        let sent: usize = self.desk.out.iter().map(|mail| mail.spawns.len()).sum();
        let work = self.ready.len() + self.spawns.len() + sent;
        let status = &field.statuses[self.thread].0;
        status.work.store(work as u32, Relaxed);
        if work == 0 {
            let nearest = self.buckets.nearest().unwrap_or(NO_BUCKET);
            status.nearest.store(nearest, Relaxed);
        }
        status.load.store(self.load, Relaxed);
        let (waiting, queued) = (self.store.waiting() as u64, self.buckets.waiting() as u64);
        status.waiting.store(waiting, Relaxed);
        status.queued.store(queued, Relaxed);
    }

    /// Ends a phase: waits for all threads, and takes in what they have sent.
    pub(super) fn exchange(&mut self, field: &Field) -> Result<(), Broken> {
        self.desk.send(&field.post)?;
        for from in 0..field.threads {
            let Some(mail) = self.desk.receive(&field.post, from) else {
                continue;
            };
            self.offers.extend_from_slice(&mail.offers);
            self.spawns.extend_from_slice(&mail.spawns);
            self.requests.extend_from_slice(&mail.requests);
            self.front.extend_from_slice(&mail.turn);
            let mut windows = mail.windows.as_slice();
            for &(h, n) in &mail.arrivals {
                let (list, rest) = windows.split_at(n as usize * COLUMNS);
                windows = rest;
                let (f, corner) = parts(h);
                let state = &field.faces[f];
                let to = self.store.append(state.list(corner), list);
                state.set_list(corner, to);
                if state.enqueue() {
                    self.ready.push(f as u32);
                }
            }
        }
        Ok(())
    }

    /// Sends the windows of `list`, which wait on `h`, to the thread `to`, and gives the list back.
    pub(super) fn send_windows(&mut self, list: u32, h: u32, to: usize) {
        let mail = &mut self.desk.out[to];
        mail.arrivals.push((h, self.store.len(list) as u32));
        self.store.copy_out(list, &mut mail.windows);
        let none = self.store.set_len(list, 0);
        debug_assert!(none == NO_LIST);
    }
}
