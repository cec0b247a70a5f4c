//! Delays at random, in unit tests alone.
//!
//! What goes wrong only when two threads do something in the same moment, or one of them stops
//! between two steps, happens once in many thousand runs. With delays where others might come
//! between, it happens in a few.

/// Might take a while.
#[cfg(not(test))]
#[inline(always)]
pub(super) fn schedule_fuzz() {}

/// Might take a while: nothing mostly, up to some microseconds or as long as others want now and
/// then, and a quarter of a millisecond at most once in two thousand times.
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
