//! What one thread does in a run.

use std::mem;
use std::ops::Range;
use std::time::{Duration, Instant};

use geobench_window::{Counter, Probe};

use super::field::Field;
use super::jitter::jitter;
use super::mail::{Mail, Offer};
use crate::engine::buckets::Buckets;
use crate::engine::kernels::Cuts;
use crate::engine::lanes::Lanes;
use crate::engine::store::WindowStore;
use crate::engine::surface::Surface;

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
    pub(super) turns: u64,
    pub(super) peak_windows: u64,
    pub(super) peak_queue: u64,
    /// Blocks given to other threads; for tests.
    pub(super) given: u64,
}

impl Tally {
    /// Tells `probe`. Of peaks, which threads reach at different times, it gets the sum of what they are.
    pub(super) fn report(&self, probe: &mut impl Probe) {
        for (counter, n) in [
            (Counter::Propagated, self.propagated),
            (Counter::Parents, self.parents),
            (Counter::Children, self.children),
            (Counter::Spawned, self.spawned),
            (Counter::Filtered, self.filtered),
            (Counter::QueuePushes, self.pushes),
            (Counter::PseudoSources, self.pseudo_sources),
            (Counter::Iterations, self.turns),
            (Counter::PeakWindows, self.peak_windows),
            (Counter::QueuePeak, self.peak_queue),
        ] {
            probe.add(counter, n);
        }
    }
}

/// How long a thread has worked.
#[derive(Debug)]
struct Clock {
    started: Instant,
    waited: Duration,
}

impl Clock {
    fn start() -> Self {
        Self {
            started: Instant::now(),
            waited: Duration::ZERO,
        }
    }

    /// In nanoseconds, without what it has waited.
    fn busy(&self) -> u64 {
        let busy = self.started.elapsed().saturating_sub(self.waited);
        u64::try_from(busy.as_nanos()).unwrap_or(u64::MAX)
    }
}

/// A thread's own things, kept from run to run; in cache lines of their own.
#[derive(Debug)]
#[repr(align(128))]
pub(super) struct Worker {
    pub(super) thread: usize,
    pub(super) store: WindowStore,
    /// Half-edges whose lists are about to cross.
    pub(super) ready: Vec<u32>,
    /// Paths to vertices of this thread that were the shortest when they were found, whose consequences wait.
    pub(super) offers: Vec<Offer>,
    /// Vertices whose turn it is.
    pub(super) turn: Vec<u32>,
    pub(super) buckets: Buckets,
    /// What is to go to each other thread.
    pub(super) out: Vec<Mail>,
    pub(super) letter: Mail,
    /// The division of the surface that it knows.
    division: u32,
    pub(super) keep: Vec<u8>,
    pub(super) cuts: Cuts,
    clock: Clock,
    pub(super) tally: Tally,
}

impl Worker {
    pub(super) fn new(thread: usize, threads: usize, surface: &Surface, bucket: f64) -> Self {
        Self {
            thread,
            store: WindowStore::new(),
            ready: Vec::new(),
            offers: Vec::new(),
            turn: Vec::new(),
            buckets: Buckets::new(surface.vertices.len(), bucket),
            out: vec![Mail::default(); threads],
            letter: Mail::default(),
            division: 0,
            keep: Vec::new(),
            cuts: Cuts::default(),
            clock: Clock::start(),
            tally: Tally::default(),
        }
    }

    /// This thread's share of `count` things.
    pub(super) fn share(&self, field: &Field, count: usize) -> Range<usize> {
        let size = count.div_ceil(field.threads);
        let start = (self.thread * size).min(count);
        start..(start + size).min(count)
    }

    /// All that is this thread's in a run from `sources`; windows that flat vertices have parted become one again if `REUNITE`.
    ///
    /// # Safety
    ///
    /// The processor must know the instructions of `L`.
    #[allow(unsafe_code)] // For a processor with the instructions of `L`, which only the caller knows.
    #[inline(always)]
    pub(super) unsafe fn run<L: Lanes, P: Probe, const REUNITE: bool>(
        &mut self,
        field: &Field,
        sources: &[u32],
        probe: &mut P,
    ) {
        self.tally = Tally::default();
        self.buckets.reset();
        field.reset_vertices(self.share(field, field.vertices.len()));
        field.pace.start();
        self.clock = Clock::start();
        if self.thread == 0 {
            self.start_from(field, sources);
        }
        loop {
            // SAFETY: promised by the caller.
            unsafe { self.cross_all::<L, P, REUNITE>(field, probe) };
            self.send(field);
            jitter();
            if self.has_mail(field) {
                // Until it is read, others must see this thread where its letter has called it back to.
                self.receive(field);
                continue;
            }
            jitter();
            let nearest = self.buckets.nearest();
            field.pace.come_to(self.thread, nearest);
            match nearest {
                _ if field.pace.is_broken() => break,
                Some(bucket) if field.pace.allows(bucket) => self.take_turn(field, bucket),
                _ => {
                    if !self.wait(field, nearest) {
                        break;
                    }
                }
            }
        }
    }

    /// The turn of a bucket.
    fn take_turn(&mut self, field: &Field, bucket: u32) {
        if field.threads > 1 {
            let busy = self.clock.busy();
            field
                .split
                .come_to(self.thread, bucket, busy, &field.surface);
            let division = field.split.divisions();
            if mem::replace(&mut self.division, division) != division {
                self.hand_over(field, bucket);
            }
        }
        self.tally.turns += 1;
        self.buckets.take(bucket, &mut self.turn);
        self.pass(field);
    }

    /// Waits for a letter, which it takes in, or until `nearest`, the nearest bucket that has a vertex, may have its turn; returns
    /// whether there is anything left to do, and nobody has panicked.
    fn wait(&mut self, field: &Field, nearest: Option<u32>) -> bool {
        let since = Instant::now();
        let mut patience = field.pace.patience();
        if nearest.is_none() {
            field.pace.end();
        }
        let goes_on = loop {
            jitter();
            if self.has_mail(field) {
                if nearest.is_none() {
                    field.pace.begin();
                }
                break true;
            }
            if nearest.is_some_and(|bucket| field.pace.allows(bucket)) {
                break true;
            }
            if nearest.is_none() && field.pace.is_over() || field.pace.is_broken() {
                break false;
            }
            patience.wait();
        };
        self.clock.waited += since.elapsed();
        self.receive(field);
        goes_on
    }
}
