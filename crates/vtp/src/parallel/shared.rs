//! What all threads see of a run.

use std::ops::Range;
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering::Relaxed;

use super::gift::Gifts;
use super::load::Loads;
use super::pace::Pace;
use crate::engine::surface::Surface;
use crate::fast::Options;

/// The state of a run that threads share.
///
/// Distances are atomic, but in no order of their own: what one thread must know of another comes with a gift. A distance that
/// a thread sees may be old. An old distance is a longer one, and prunes less.
#[derive(Debug)]
pub(super) struct Shared {
    pub(super) surface: Surface,
    /// Whether windows parted by flat vertices become one again.
    pub(super) reunites: bool,
    pub(super) threads: usize,
    pub(super) distances: Vec<Distance>,
    pub(super) loads: Loads,
    pub(super) gifts: Gifts,
    pub(super) pace: Pace,
}

impl Shared {
    pub(super) fn new(surface: Surface, options: &Options, threads: usize) -> Self {
        let vertices = surface.vertices.len();
        Self {
            reunites: options.reunite && surface.has_many_flat_vertices(),
            threads,
            distances: (0..vertices).map(|_| Distance::unknown()).collect(),
            loads: Loads::new(threads),
            gifts: Gifts::new(threads),
            pace: Pace::new(threads),
            surface,
        }
    }

    /// Forgets what a run has left behind that was broken off.
    pub(super) fn recover(&mut self) {
        self.gifts = Gifts::new(self.threads);
        self.distances.fill_with(Distance::unknown);
    }

    /// Starts another run. Nothing may be on its way and no distance known, as after a run or when it has [recovered](Self::recover).
    pub(super) fn start(&mut self) {
        self.loads.reset();
        self.pace.reset();
    }

    /// The share of `thread` in `count` things.
    pub(super) fn share(&self, thread: usize, count: usize) -> Range<usize> {
        let size = count.div_ceil(self.threads);
        let start = (thread * size).min(count);
        start..(start + size).min(count)
    }

    /// What is known of the distance of `v` at the end of a run, forgotten for the next one.
    pub(super) fn take_distance(&self, v: u32) -> f64 {
        let distance = &self.distances[v as usize];
        let known = distance.get();
        distance.set(f64::INFINITY);
        known
    }
}

/// A distance that threads can see, not negative.
#[derive(Debug)]
pub(super) struct Distance(AtomicU64);

impl Distance {
    fn unknown() -> Self {
        Self(AtomicU64::new(f64::INFINITY.to_bits()))
    }

    #[inline(always)]
    pub(super) fn get(&self) -> f64 {
        f64::from_bits(self.0.load(Relaxed))
    }

    #[inline(always)]
    pub(super) fn set(&self, value: f64) {
        self.0.store(value.to_bits(), Relaxed);
    }

    /// Takes a lesser value, whatever other threads do; returns whether it was less.
    #[inline]
    pub(super) fn lower(&self, value: f64) -> bool {
        // The bits of such numbers are in the same order.
        let bits = value.to_bits();
        self.0.fetch_min(bits, Relaxed) > bits
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::thread;

    #[test]
    fn of_threads_that_find_the_same_at_once_one_has_found_it() {
        let distance = Distance::unknown();
        let find = || {
            let all = (0..100_000_u32).rev();
            let least = all.filter(|&d| distance.lower(f64::from(d)));
            least.collect::<Vec<_>>()
        };
        let found = thread::scope(|scope| {
            let threads = [scope.spawn(find), scope.spawn(find)];
            threads.map(|thread| thread.join().unwrap()).concat()
        });
        let mut once = found.clone();
        once.sort_unstable();
        once.dedup();
        assert_eq!((found.len(), once[0]), (once.len(), 0));
    }
}
