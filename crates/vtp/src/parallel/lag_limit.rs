//! How far threads have come, how they wait for each other, and when all is done.

use std::hint::spin_loop;
use std::sync::atomic::Ordering::{Acquire, Relaxed, Release};
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicUsize};
use std::thread;
use std::time::Duration;

use super::padded::Padded;

/// The place of a thread that has no vertex to wait for.
const NOWHERE: u32 = u32::MAX;

/// How many buckets one of two threads may be ahead of the other. With none they would wait for
/// each other in each bucket, with 2 they take 2 to 3 % longer on models of some thousand faces;
/// with more, windows that come late cross what others have made of earlier ones once more.
const LEAD_OF_TWO: u32 = 4;

/// The same among more threads, where that weighs more: with 4, 16 threads took up to 37 % more
/// windows than one, with 2 less than 30 % (on two processors, before handoffs went by place).
const LEAD_OF_MORE: u32 = 2;

/// Turns of a loop of some 40 ns each in which a thread looks again before it lets others run.
const SPINS: u32 = 2000;

/// Times that it lets others run before it sleeps, and for how long it does.
const YIELDS: u32 = 64;
const NAP: Duration = Duration::from_micros(50);

/// Where the threads of a run are.
#[derive(Debug)]
pub(super) struct LagLimit {
    /// The bucket whose turn each thread takes or wants to take.
    places: Vec<Padded<AtomicU32>>,
    /// Threads at work and handoffs on their way: when there are none, nothing will ever happen.
    pending: Padded<AtomicUsize>,
    /// Threads that have come to the end of the run, and how many are to come.
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

    /// The first thread is at work, at the first bucket, in a run in which so many threads take
    /// part.
    pub(super) fn reset(&mut self, threads: usize) {
        self.arrived = Padded::default();
        self.expected = threads;
        self.places.fill_with(|| Padded(AtomicU32::new(NOWHERE)));
        self.come_to(0, Some(0));
        self.pending = Padded(AtomicUsize::new(1));
        self.broken = AtomicBool::new(false);
    }

    /// A thread has come to a bucket, or has no vertex that waits.
    pub(super) fn come_to(&self, thread: usize, bucket: Option<u32>) {
        self.places[thread]
            .0
            .store(bucket.unwrap_or(NOWHERE), Relaxed);
    }

    /// A thread gets something from one that is at `bucket`, and falls back until it has taken it
    /// in: it may be far ahead or have nothing to do.
    pub(super) fn call_back(&self, to: usize, bucket: u32) {
        self.places[to].0.fetch_min(bucket, Relaxed);
    }

    /// The last bucket whose turn may be taken.
    pub(super) fn limit(&self) -> u32 {
        let last = self.places.iter().map(|place| place.0.load(Relaxed)).min();
        last.unwrap_or(NOWHERE).saturating_add(self.lead)
    }

    /// A thread goes to work again, or a handoff is sent; by a thread that is at work, or that has a
    /// handoff.
    pub(super) fn begin(&self) {
        self.pending.0.fetch_add(1, Relaxed);
    }

    /// A thread has nothing left to do, or has taken in all of a handoff; what that leads to is
    /// counted by the thread, which is at work.
    pub(super) fn end(&self) {
        self.pending.0.fetch_sub(1, Release);
    }

    /// Whether no thread has anything left to do. What all have done is seen then.
    pub(super) fn is_over(&self) -> bool {
        self.pending.0.load(Acquire) == 0
    }

    /// Waits until all threads have come here. What they have done before is seen then. Returns
    /// whether no thread has panicked.
    pub(super) fn meet(&self) -> bool {
        let arrived = &self.arrived.0;
        arrived.fetch_add(1, Release);
        let mut backoff = self.backoff();
        while arrived.load(Acquire) < self.expected && !self.is_broken() {
            backoff.wait();
        }
        !self.is_broken()
    }

    /// A thread has panicked; no other may wait for it.
    pub(super) fn break_up(&self) {
        self.broken.store(true, Relaxed);
    }

    pub(super) fn is_broken(&self) -> bool {
        self.broken.load(Relaxed)
    }

    /// For a thread that is to wait.
    pub(super) fn backoff(&self) -> Backoff {
        Backoff {
            spins: self.spins,
            yields: YIELDS,
        }
    }
}

/// Waits a little longer each time: threads wait for microseconds mostly, and waking one that
/// sleeps takes tens. Where there are more threads than processors, it lets others run.
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

/// Lets the others go if the thread that holds this panics.
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
    fn threads_that_meet_see_what_all_have_done() {
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
        // The first sends the other a handoff and rests; the other takes it.
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
