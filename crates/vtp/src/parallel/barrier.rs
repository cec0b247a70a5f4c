//! Where the threads of a run wait for each other, some thousand times in each.

use std::hint::spin_loop;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Condvar, Mutex, PoisonError};
use std::thread;

use super::padded::Padded;

/// Turns of a loop of some 40 ns each in which a thread asks again before it lets others run: far longer than a
/// phase takes where every thread has a processor.
const SPINS: u32 = 2000;

/// Times that it lets others run before it sleeps.
const YIELDS: u32 = 64;

/// A barrier at which threads spin, since they wait for microseconds: 0.2 µs for two threads, where waking one
/// that sleeps takes tens. Whoever waits for long, since there are more threads than processors, lets others run and
/// then sleeps.
#[derive(Debug)]
pub(super) struct Barrier {
    parties: u32,
    spins: u32,
    arrived: Padded<AtomicU32>,
    /// Counts the times that all have met.
    generation: Padded<AtomicU32>,
    sleepers: AtomicU32,
    broken: AtomicBool,
    lock: Mutex<()>,
    woken: Condvar,
}

/// A thread has panicked and will not arrive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Broken;

impl Barrier {
    /// For so many threads, at least one.
    pub(super) fn new(parties: u32) -> Self {
        let processors = thread::available_parallelism().map_or(1, usize::from);
        Self {
            parties,
            spins: if parties as usize > processors {
                0
            } else {
                SPINS
            },
            arrived: Padded(AtomicU32::new(0)),
            generation: Padded(AtomicU32::new(0)),
            sleepers: AtomicU32::new(0),
            broken: AtomicBool::new(false),
            lock: Mutex::new(()),
            woken: Condvar::new(),
        }
    }

    /// Waits until all threads have arrived. What they wrote before is seen by all afterwards.
    pub(super) fn wait(&self) -> Result<(), Broken> {
        if self.parties == 1 {
            return Ok(());
        }
        let generation = self.generation.0.load(Ordering::Relaxed);
        if self.arrived.0.fetch_add(1, Ordering::AcqRel) + 1 == self.parties {
            self.arrived.0.store(0, Ordering::Relaxed);
            // In one order with the counting of sleepers: one of the two sees the other.
            self.generation
                .0
                .store(generation.wrapping_add(1), Ordering::SeqCst);
            if self.sleepers.load(Ordering::SeqCst) > 0 {
                self.wake();
            }
        } else {
            self.wait_for_others(generation);
        }
        if self.broken.load(Ordering::Relaxed) {
            return Err(Broken);
        }
        Ok(())
    }

    fn is_over(&self, generation: u32) -> bool {
        self.generation.0.load(Ordering::SeqCst) != generation || self.broken.load(Ordering::SeqCst)
    }

    #[inline]
    fn wait_for_others(&self, generation: u32) {
        for _ in 0..self.spins {
            if self.generation.0.load(Ordering::Acquire) != generation {
                return;
            }
            spin_loop();
        }
        for _ in 0..YIELDS {
            if self.is_over(generation) {
                return;
            }
            thread::yield_now();
        }
        self.sleep(generation);
    }

    #[cold]
    fn sleep(&self, generation: u32) {
        let mut guard = self.lock.lock().unwrap_or_else(PoisonError::into_inner);
        self.sleepers.fetch_add(1, Ordering::SeqCst);
        while !self.is_over(generation) {
            guard = self
                .woken
                .wait(guard)
                .unwrap_or_else(PoisonError::into_inner);
        }
        self.sleepers.fetch_sub(1, Ordering::SeqCst);
    }

    #[cold]
    fn wake(&self) {
        // Whoever counts as a sleeper and holds the lock is about to look once more.
        drop(self.lock.lock());
        self.woken.notify_all();
    }

    /// Lets all threads go, with an error, now and whenever they come.
    pub(super) fn break_up(&self) {
        self.broken.store(true, Ordering::SeqCst);
        self.wake();
    }
}

/// Breaks up a barrier if the thread that holds this panics.
#[derive(Debug)]
pub(super) struct BreakOnPanic<'a>(pub(super) &'a Barrier);

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
    fn nobody_passes_before_all_have_come_however_many_there_are() {
        for parties in [1, 2, 3, 8] {
            let barrier = Barrier::new(parties);
            let arrivals = AtomicU32::new(0);
            thread::scope(|scope| {
                for _ in 0..parties {
                    scope.spawn(|| {
                        for round in 1..=200 {
                            arrivals.fetch_add(1, Ordering::Relaxed);
                            barrier.wait().unwrap();
                            let seen = arrivals.load(Ordering::Relaxed);
                            assert!(seen >= round * parties, "{seen} in round {round}");
                            barrier.wait().unwrap();
                        }
                    });
                }
            });
            assert_eq!(arrivals.into_inner(), 200 * parties);
        }
    }

    #[test]
    fn those_who_sleep_are_woken() {
        let barrier = Barrier::new(2);
        thread::scope(|scope| {
            scope.spawn(|| barrier.wait().unwrap());
            while barrier.sleepers.load(Ordering::SeqCst) == 0 {
                thread::yield_now();
            }
            barrier.wait().unwrap();
        });
    }

    #[test]
    fn a_panic_lets_the_others_go() {
        let barrier = Barrier::new(3);
        let results: Vec<_> = thread::scope(|scope| {
            let panics = scope.spawn(|| {
                let _guard = BreakOnPanic(&barrier);
                assert_eq!(barrier.parties, 0, "on purpose");
            });
            let waits = [(); 2].map(|()| scope.spawn(|| barrier.wait()));
            assert!(panics.join().is_err());
            waits.into_iter().map(|w| w.join().unwrap()).collect()
        });
        assert_eq!(results, [Err(Broken); 2]);
        assert_eq!(barrier.wait(), Err(Broken));
    }
}
