//! Estimates of the remaining time of each thread, which handoffs balance.

use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering::Relaxed;

use super::padded::Padded;

/// The cost of a waiting list in addition to its windows, in units of a window.
pub(super) const LIST: usize = 16;

/// A thread hands off work if its estimate exceeds the mean by this fraction. 0.05 makes no
/// difference. With 0.2 two threads take up to 2 % longer, with 0.35 4 %.
const TOO_MUCH: f64 = 0.1;

/// The weight of earlier turns relative to the last one.
const KEPT: f64 = 0.9;

/// The waiting work of a thread, and its time for a unit of work.
#[derive(Debug, Default)]
pub(super) struct LoadEstimate {
    /// The weight of waiting lists and windows at the last estimate.
    weight: f64,
    /// The working time of the thread at the last estimate.
    worked: u64,
    /// Sums over the turns so far, with less weight for older ones.
    times: f64,
    weights: f64,
}

impl LoadEstimate {
    /// Estimates how long a thread with `windows` in `lists` will take. `worked` is its [working
    /// time](super::clock::Clock). The unit is the same for all threads.
    ///
    /// Called after each turn and after each wait. A waiting thread therefore seems faster than it
    /// is, receives more work and waits less.
    pub(super) fn note(&mut self, windows: usize, lists: usize, worked: u64) -> u64 {
        let took = worked.saturating_sub(self.worked);
        self.times = KEPT * self.times + took as f64;
        self.weights = KEPT * self.weights + self.weight;
        self.weight = (windows + LIST * lists) as f64;
        self.worked = worked;
        #[allow(clippy::cast_sign_loss)] // Neither is negative.
        let expected = (self.weight * self.time_for_each()) as u64;
        expected
    }

    /// Time for a unit of weight. Before the first measurement it is low, so that a thread that has
    /// just started receives work.
    fn time_for_each(&self) -> f64 {
        if self.weights > 0.0 && self.times > 0.0 {
            1000.0 * self.times / self.weights
        } else {
            1000.0
        }
    }

    /// The weight of waiting lists and windows.
    pub(super) fn weight(&self) -> f64 {
        self.weight
    }

    /// Subtracts the weight of a handoff; returns its fraction of the whole.
    pub(super) fn lose(&mut self, weight: usize) -> f64 {
        let part = (weight as f64 / self.weight.max(1.0)).min(1.0);
        self.weight *= 1.0 - part;
        part
    }
}

/// The estimate of a thread that has not started.
const ABSENT: u64 = u64::MAX;

/// The estimates of all threads.
#[derive(Debug)]
pub(super) struct LoadEstimates(Vec<Padded<AtomicU64>>);

impl LoadEstimates {
    pub(super) fn new(threads: usize) -> Self {
        let absent = |_| Padded(AtomicU64::new(ABSENT));
        Self((0..threads).map(absent).collect())
    }

    /// Resets the estimates to those of threads that have not started.
    pub(super) fn reset(&mut self) {
        self.0.fill_with(|| Padded(AtomicU64::new(ABSENT)));
    }

    /// Publishes the estimate of a thread.
    pub(super) fn publish(&self, thread: usize, expected: u64) {
        self.0[thread].0.store(expected, Relaxed);
    }

    /// The thread to which `thread` should hand off work, and the fraction that makes both equal;
    /// `None` if `thread` does not have too much.
    pub(super) fn advice(&self, thread: usize) -> Option<(usize, f64)> {
        let loads = self.0.iter().map(|load| load.0.load(Relaxed)).enumerate();
        let awake = loads.filter(|&(_, load)| load != ABSENT);
        let (mut total, mut count, mut least_loaded) = (0.0, 0.0, None);
        for (other, load) in awake {
            total += load as f64;
            count += 1.0;
            if least_loaded.is_none_or(|(_, least)| load < least) {
                least_loaded = Some((other, load));
            }
        }
        let (to, least) = least_loaded?;
        let own = self.0[thread].0.load(Relaxed) as f64;
        let share = (own - least as f64) / (2.0 * own);
        (own > (1.0 + TOO_MUCH) * total / count).then_some((to, share))
    }

    /// Records that `from` has handed off this fraction of its work to `to`.
    pub(super) fn moved(&self, from: usize, to: usize, share: f64) {
        #[allow(clippy::cast_sign_loss)] // No share is negative.
        let moved = (self.0[from].0.load(Relaxed) as f64 * share) as u64;
        self.0[from].0.fetch_sub(moved, Relaxed);
        self.0[to].0.fetch_add(moved, Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thread_with_too_much_hands_off_to_the_one_with_least() {
        let loads = LoadEstimates::new(4);
        for (thread, load) in [(0, 900), (1, 100), (2, 200)] {
            loads.publish(thread, load);
        }
        assert_eq!(loads.advice(0), Some((1, 400.0 / 900.0)));
        assert_eq!((loads.advice(1), loads.advice(2)), (None, None));
        loads.moved(0, 1, 400.0 / 900.0);
        for from in [0, 1] {
            assert_eq!(loads.advice(from), Some((2, 150.0 / 500.0)));
        }
        loads.moved(0, 2, 150.0 / 500.0);
        loads.publish(1, 400);
        assert_eq!([0, 1, 2].map(|thread| loads.advice(thread)), [None; 3]);
        let loads = LoadEstimates::new(1);
        for load in [9, 0] {
            loads.publish(0, load);
            assert_eq!(loads.advice(0), None);
        }
    }

    #[test]
    fn a_slow_thread_expects_to_take_longer_and_one_that_waits_less_long() {
        let [mut fast, mut slow, mut waits] = [0, 1, 2].map(|_| LoadEstimate::default());
        let [mut a, mut b, mut c] = [0; 3];
        for turn in 0..9 {
            a = fast.note(1000, 20, 1000 * turn);
            b = slow.note(1000, 20, 3000 * turn);
            waits.note(1000, 20, 1000 * turn);
            c = waits.note(1000, 20, 1000 * turn);
        }
        assert!(b.abs_diff(3 * a) < 5 && c < a, "{a}, {b}, {c}");
        assert_eq!((fast.lose(330), fast.weight), (0.25, 990.0));
        assert_eq!((fast.lose(9999), fast.weight), (1.0, 0.0));
    }
}
