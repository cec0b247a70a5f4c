//! The limit of the lag between threads, their waiting, and the detection of the end of a run.

use std::hint::spin_loop;
use std::sync::atomic::Ordering::{Acquire, Relaxed, Release};
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicUsize};
use std::thread;
use std::time::Duration;

use super::padded::Padded;

/// The bucket of a thread without waiting vertices.
const NOWHERE: u32 = u32::MAX;

/// How many buckets one of two threads may be ahead of the other. With 0 they would wait for each
/// other in each bucket. With 2 they take 2 to 3 % longer on models of some thousand faces. With
/// more than 4, late windows repeat crossings that earlier ones have made.
const LEAD_OF_TWO: u32 = 4;

/// The same limit for more than two threads, where late windows cost more. With 4, 16 threads took
/// up to 37 % more windows than one; with 2, less than 30 % (on two processors, before handoffs
/// considered positions).
const LEAD_OF_MORE: u32 = 2;

/// Checks of some 40 ns each before a waiting thread yields.
const SPINS: u32 = 2000;

/// Yields before a waiting thread sleeps, and the length of a sleep.
const YIELDS: u32 = 64;
const NAP: Duration = Duration::from_micros(50);

/// The buckets that the threads of a run have reached, and the work that is left.
#[derive(Debug)]
pub(super) struct LagLimit {
    /// The bucket that each thread processes or wants to process.
    places: Vec<Padded<AtomicU32>>,
    /// Threads at work plus handoffs in transit. The run is over when it reaches 0.
    pending: Padded<AtomicUsize>,
    /// Threads that have reached the end of the run; `expected` is the number of threads of
    /// the run.
    arrived: Padded<AtomicUsize>,
    expected: usize,
    broken: AtomicBool,
    lead: u32,
    spins: u32,
}

impl LagLimit {
    pub(super) fn new(threads: usize) -> Self {
        let processors = thread::available_parallelism().map_or(1, usize::from);
        Self {
            places: (0..threads).map(|_| Padded::default()).collect(),
            pending: Padded::default(),
            arrived: Padded::default(),
            expected: threads,
            broken: AtomicBool::new(false),
            lead: if threads > 2 {
                LEAD_OF_MORE
            } else {
                LEAD_OF_TWO
            },
            spins: if threads > processors { 0 } else { SPINS },
        }
    }

    /// Prepares a run with this number of threads. The first thread is at work, at the first
    /// bucket.
    pub(super) fn reset(&mut self, threads: usize) {
        self.arrived = Padded::default();
        self.expected = threads;
        self.places.fill_with(|| Padded(AtomicU32::new(NOWHERE)));
        self.come_to(0, Some(0));
        self.pending = Padded(AtomicUsize::new(1));
        self.broken = AtomicBool::new(false);
    }

    /// Publishes the bucket that a thread has reached; `None` if it has no waiting vertices.
    pub(super) fn come_to(&self, thread: usize, bucket: Option<u32>) {
        self.places[thread]
            .0
            .store(bucket.unwrap_or(NOWHERE), Relaxed);
    }

    /// Receiving a handoff moves a thread back to the sender's bucket, until it is unpacked.
    pub(super) fn call_back(&self, to: usize, bucket: u32) {
        self.places[to].0.fetch_min(bucket, Relaxed);
    }

    /// The last bucket that may be processed.
    pub(super) fn limit(&self) -> u32 {
        let last = self.places.iter().map(|place| place.0.load(Relaxed)).min();
        last.unwrap_or(NOWHERE).saturating_add(self.lead)
    }

    /// Counts a thread that resumes work, or a handoff that is sent. The caller must be at work or
    /// have received a handoff.
    pub(super) fn begin(&self) {
        self.pending.0.fetch_add(1, Relaxed);
    }

    /// Counts off a thread that runs out of work, or a handoff that has been unpacked. Its effects
    /// belong to the receiver's work.
    pub(super) fn end(&self) {
        self.pending.0.fetch_sub(1, Release);
    }

    /// Whether no work is left. If so, all writes of the threads are visible.
    pub(super) fn is_over(&self) -> bool {
        self.pending.0.load(Acquire) == 0
    }

    /// Waits until all threads have arrived. Their earlier writes are then visible. Returns whether
    /// no thread has panicked.
    pub(super) fn meet(&self) -> bool {
        let arrived = &self.arrived.0;
        arrived.fetch_add(1, Release);
        let mut backoff = self.backoff();
        while arrived.load(Acquire) < self.expected && !self.is_broken() {
            backoff.wait();
        }
        !self.is_broken()
    }

    /// Ends the waits of all threads after a panic.
    pub(super) fn break_up(&self) {
        self.broken.store(true, Relaxed);
    }

    pub(super) fn is_broken(&self) -> bool {
        self.broken.load(Relaxed)
    }

    /// A new backoff for a waiting thread.
    pub(super) fn backoff(&self) -> Backoff {
        Backoff {
            spins: self.spins,
            yields: YIELDS,
        }
    }
}

/// Spins, then yields, then sleeps. Most waits take microseconds, and waking a sleeping thread
/// takes tens of microseconds. With more threads than processors it yields at once.
#[derive(Debug)]
pub(super) struct Backoff {
    spins: u32,
    yields: u32,
}

impl Backoff {
    pub(super) fn wait(&mut self) {
        if self.spins > 0 {
            self.spins -= 1;
            spin_loop();
        } else if self.yields > 0 {
            self.yields -= 1;
            thread::yield_now();
        } else {
            thread::sleep(NAP);
        }
    }
}

/// Releases the other threads if the thread that holds this panics.
#[derive(Debug)]
pub(super) struct BreakOnPanic<'a>(pub(super) &'a LagLimit);

impl Drop for BreakOnPanic<'_> {
    fn drop(&mut self) {
        if thread::panicking() {
            self.0.break_up();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thread_may_be_a_little_ahead_of_the_last_one_that_has_work() {
        let mut lag = LagLimit::new(3);
        lag.reset(3);
        for (thread, bucket) in [(0, Some(7)), (1, None), (2, Some(5))] {
            lag.come_to(thread, bucket);
        }
        assert_eq!(lag.limit(), 5 + LEAD_OF_MORE);
        lag.come_to(2, None);
        assert_eq!(lag.limit(), 7 + LEAD_OF_MORE);
        lag.call_back(2, 7);
        lag.come_to(0, Some(9));
        assert_eq!(lag.limit(), 7 + LEAD_OF_MORE);
        lag.come_to(2, None);
        lag.come_to(0, None);
        assert_eq!(lag.limit(), u32::MAX);
    }

    #[test]
    fn threads_that_meet_see_the_work_of_all() {
        let mut lag = LagLimit::new(3);
        lag.reset(3);
        let done = [0, 1, 2].map(|_| AtomicU32::new(0));
        let run = |thread: usize| {
            done[thread].store(7, Relaxed);
            assert!(lag.meet());
            done.iter().map(|d| d.load(Relaxed)).sum::<u32>()
        };
        let sums = thread::scope(|scope| {
            let threads = [0, 1, 2].map(|thread| scope.spawn(move || run(thread)));
            threads.map(|thread| thread.join().unwrap())
        });
        assert_eq!(sums, [21; 3]);
    }

    #[test]
    fn a_run_is_over_when_no_thread_works_and_no_handoff_is_on_its_way() {
        let mut lag = LagLimit::new(2);
        lag.reset(2);
        // The first thread sends the other a handoff and runs out of work. The other thread
        // receives it.
        lag.begin();
        lag.end();
        assert!(!lag.is_over());
        lag.begin();
        lag.end();
        assert!(!lag.is_over());
        lag.end();
        assert!(lag.is_over());
    }

    #[test]
    fn a_panic_lets_the_others_go() {
        let mut lag = LagLimit::new(3);
        lag.reset(3);
        thread::scope(|scope| {
            let panics = scope.spawn(|| {
                let _guard = BreakOnPanic(&lag);
                assert_eq!(lag.places.len(), 0, "on purpose");
            });
            assert!(panics.join().is_err());
        });
        assert!(lag.is_broken() && !lag.meet());
    }
}
