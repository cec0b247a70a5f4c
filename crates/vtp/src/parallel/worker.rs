//! What one thread does in a run.

use std::ops::Range;
use std::sync::atomic::Ordering::Relaxed;

use geobench_window::{Counter, Probe};

use super::barrier::Broken;
use super::field::Field;
use super::mail::{Desk, Mail, Offer, Spawn};
use super::split::Split;
use crate::engine::buckets::Buckets;
use crate::engine::kernels::Cuts;
use crate::engine::lanes::Lanes;
use crate::engine::store::{COLUMNS, NO_LIST, WindowStore};
use crate::engine::surface::{Surface, parts};

/// Stands for no bucket.
const NO_BUCKET: u32 = u32::MAX;

/// Steps after which the surface is divided anew.
const STEPS: u32 = 2;

/// The most of ten windows of the wavefront that may be about to cross again when a turn is taken. More would be
/// windows behind a front that outruns them where faces are far smaller than the mean: on a terrain four times as many
/// windows, on a stretched torus seven times. Of all that wait, since a step should be worth its barriers: with 1, twice as many
/// steps for 0.3 % fewer windows.
const MOST_AGAIN: u64 = 3;

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

/// A thread's own things, kept from run to run; in cache lines of their own.
#[derive(Debug)]
#[repr(align(128))]
pub(super) struct Worker {
    pub(super) thread: usize,
    pub(super) store: WindowStore,
    /// Faces of this thread with lists that are to cross in the next step.
    pub(super) ready: Vec<u32>,
    pub(super) tasks: Vec<Task>,
    /// Windows that are to start in the next step across faces of this thread.
    pub(super) spawns: Vec<Spawn>,
    /// Paths to vertices of this thread that were found in this step.
    pub(super) offers: Vec<Offer>,
    /// Vertices whose turn it is.
    pub(super) turn: Vec<u32>,
    pub(super) split: Split,
    pub(super) buckets: Buckets,
    pub(super) desk: Desk,
    pub(super) keep: Vec<u8>,
    pub(super) cuts: Cuts,
    /// Of the current step: what this thread had to cross; windows that are to cross again in the next one;
    /// windows that went to other threads.
    pub(super) load: u64,
    pub(super) again: u64,
    pub(super) sent: u64,
    pub(super) tally: Tally,
}

impl Worker {
    pub(super) fn new(thread: usize, threads: usize, surface: &Surface, bucket: f64) -> Self {
        Self {
            thread,
            store: WindowStore::new(),
            ready: Vec::new(),
            tasks: Vec::new(),
            spawns: Vec::new(),
            offers: Vec::new(),
            turn: Vec::new(),
            split: Split::new(surface, threads),
            buckets: Buckets::new(surface.vertices.len(), bucket),
            desk: Desk::new(thread, threads),
            keep: Vec::new(),
            cuts: Cuts::default(),
            load: 0,
            again: 0,
            sent: 0,
            tally: Tally::default(),
        }
    }

    /// This thread's share of `count` things.
    pub(super) fn share(&self, field: &Field, count: usize) -> Range<usize> {
        let size = count.div_ceil(field.threads);
        let start = (self.thread * size).min(count);
        start..(start + size).min(count)
    }

    /// Whose a face is.
    #[inline(always)]
    pub(super) fn owner_of_face(&self, field: &Field, f: usize) -> usize {
        if field.threads == 1 {
            return 0;
        }
        field.faces[f].owner_or(field.run, || self.split.owner_of_face(f))
    }

    /// Whose a vertex is.
    #[inline(always)]
    pub(super) fn owner_of_vertex(&self, field: &Field, v: u32) -> usize {
        if field.threads == 1 {
            return 0;
        }
        field.vertices[v as usize].owner_or(|| self.split.owner_of_vertex(v))
    }

    /// All steps from `sources`.
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
        self.buckets.reset();
        self.split.reset(&field.surface);
        field.reset_vertices(self.share(field, field.vertices.len()));
        self.exchange(field)?;
        if self.thread == 0 {
            self.start_from(field, sources);
        }
        self.say(field);
        self.exchange(field)?;
        for step in 1.. {
            let nearest = field.statuses.iter().map(|s| s.0.nearest.load(Relaxed));
            let nearest = nearest.min().unwrap_or(NO_BUCKET);
            if nearest == NO_BUCKET && field.sum(|s| s.work.load(Relaxed).into()) == 0 {
                break;
            }
            // SAFETY: promised by the caller.
            unsafe { self.cross::<L, P>(field, probe) };
            let divides = field.threads > 1 && step % STEPS == 0;
            if divides {
                self.send_loads();
            }
            self.exchange(field)?;
            if divides {
                let loads = field.statuses.iter().map(|s| s.0.load.load(Relaxed));
                self.split.compare(loads);
                self.split.cut(&field.surface);
            }
            self.settle(field);
            let [again, waiting] = [
                field.sum(|s| s.again.load(Relaxed)),
                field.sum(|s| s.waiting.load(Relaxed)),
            ];
            probe.raise(Counter::PeakWindows, waiting);
            if nearest != NO_BUCKET && 10 * again <= MOST_AGAIN * waiting {
                probe.add(Counter::Iterations, 1);
                self.pass_turn(field, nearest);
            }
            self.say(field);
            self.exchange(field)?;
            if P::COUNTS {
                let queued = field.sum(|s| s.queued.load(Relaxed));
                probe.raise(Counter::QueuePeak, queued);
            }
        }
        Ok(())
    }

    /// Says how things stand at the end of a step.
    fn say(&mut self, field: &Field) {
        let sent = |mail: &Mail| mail.spawns.len() + mail.joined.len();
        let sent: usize = self.desk.out.iter().map(sent).sum();
        let work = self.ready.len() + self.spawns.len() + sent;
        let status = &field.statuses[self.thread].0;
        status.work.store(work as u32, Relaxed);
        let nearest = self.buckets.nearest().unwrap_or(NO_BUCKET);
        status.nearest.store(nearest, Relaxed);
        status.queued.store(self.buckets.waiting() as u64, Relaxed);
    }

    /// Tells all threads, this one included, what came where in its part.
    fn send_loads(&mut self) {
        let mut own = std::mem::take(&mut self.desk.out[self.thread].loads);
        self.split.drain(&mut own);
        for mail in &mut self.desk.out {
            mail.loads.extend_from_slice(&own);
        }
        self.desk.out[self.thread].loads = own;
    }

    /// Ends half a step: waits for all threads, and takes in what they have sent.
    pub(super) fn exchange(&mut self, field: &Field) -> Result<(), Broken> {
        self.desk.send(&field.post)?;
        for from in 0..field.threads {
            let Some(mail) = self.desk.receive(&field.post, from) else {
                continue;
            };
            self.split.learn(&mail.loads);
            self.offers.extend_from_slice(&mail.offers);
            self.spawns.extend_from_slice(&mail.spawns);
            let mut windows = mail.windows.as_slice();
            for &(h, n) in &mail.arrivals {
                let (list, rest) = windows.split_at(n as usize * COLUMNS);
                windows = rest;
                let (f, corner) = parts(h);
                let state = &field.faces[f];
                let to = self.store.append(state.list(corner), list);
                state.set_list(corner, to);
                if state.has_joined(field.run) && state.enqueue() {
                    self.ready.push(f as u32);
                }
            }
            for &f in &mail.joined {
                queue_face(&mut self.ready, field, f as usize);
            }
        }
        Ok(())
    }

    /// Sends the windows of `list`, which are to wait on `h`, to the thread `to`, and gives the list back.
    pub(super) fn send_windows(&mut self, list: u32, h: u32, to: usize) {
        let mail = &mut self.desk.out[to];
        mail.arrivals.push((h, self.store.len(list) as u32));
        self.store.copy_out(list, &mut mail.windows);
        let none = self.store.set_len(list, 0);
        debug_assert!(none == NO_LIST);
    }
}

/// Puts a face that has joined into a thread's queue, if windows wait for it.
pub(super) fn queue_face(ready: &mut Vec<u32>, field: &Field, f: usize) {
    let state = &field.faces[f];
    if (0..3).any(|corner| state.list(corner) != NO_LIST) && state.enqueue() {
        ready.push(f as u32);
    }
}
