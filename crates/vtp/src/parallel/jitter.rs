//! Delays at random, in unit tests alone.
//!
//! What goes wrong only when two threads do something in the same moment, or one of them stops
//! between two steps, happens once in many thousand runs. With delays where others might come
//! between, it happens in a few.

/// Might take a while.
#[cfg(not(test))]
#[inline(always)]
pub(super) fn jitter() {}

/// Might take a while: nothing mostly, up to some microseconds or as long as others want now and
/// then, and a quarter of a millisecond at most once in two thousand times.
#[cfg(test)]
pub(super) fn jitter() {
    use std::cell::Cell;
    use std::hint::spin_loop;
    use std::sync::atomic::AtomicU64;
    use std::sync::atomic::Ordering::Relaxed;
    use std::thread;
    use std::time::Duration;

    static SEEDS: AtomicU64 = AtomicU64::new(1);
    thread_local! {
        static STATE: Cell<u64> = Cell::new(SEEDS.fetch_add(0x9E37_79B9_7F4A_7C16, Relaxed));
    }
    // The generator xorshift64 of Marsaglia.
    let mut x = STATE.get();
    x ^= x << 13;
    x ^= x >> 7;
    x ^= x << 17;
    STATE.set(x);
    let (choice, length) = (x >> 52, x >> 20 & 0xFF);
    match choice {
        0..2 => thread::sleep(Duration::from_micros(length)),
        2..32 => thread::yield_now(),
        32..512 => (0..length).for_each(|_| spin_loop()),
        _ => {}
    }
}
