//! Random delays in unit tests, which vary the schedule of threads.
//!
//! Delays between the steps at which other threads may interfere make races frequent: one that
//! occurs in some thousands of runs then occurs in a few.

/// Does nothing outside unit tests.
#[cfg(not(test))]
#[inline(always)]
pub(super) fn schedule_fuzz() {}

/// Usually returns at once. Sometimes it spins for some microseconds or yields, and once in two
/// thousand times it sleeps for at most a quarter of a millisecond.
#[cfg(test)]
pub(super) fn schedule_fuzz() {
    use std::cell::RefCell;
    use std::hint::spin_loop;
    use std::sync::atomic::AtomicU64;
    use std::sync::atomic::Ordering::Relaxed;
    use std::thread;
    use std::time::Duration;

    use geobench_mesh::SplitMix64;

    static SEEDS: AtomicU64 = AtomicU64::new(1);
    thread_local! {
        static RANDOM: RefCell<SplitMix64> =
            RefCell::new(SplitMix64::new(SEEDS.fetch_add(1, Relaxed)));
    }
    let x = RANDOM.with_borrow_mut(SplitMix64::next);
    let (choice, length) = (x >> 52, x >> 20 & 0xFF);
    match choice {
        0..2 => thread::sleep(Duration::from_micros(length)),
        2..32 => thread::yield_now(),
        32..512 => (0..length).for_each(|_| spin_loop()),
        _ => {}
    }
}
