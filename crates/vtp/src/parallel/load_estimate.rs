//! How much threads have before them, and who gives how much to whom.

use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering::Relaxed;

use super::padded::Padded;

/// What a list that waits costs besides its windows, in windows.
pub(super) const LIST: usize = 16;

/// How much more than the mean a thread must have before it gives, relatively. With 0.05 it is the
/// same, with 0.2 two threads take up to 2 % longer, with 0.35 4 %.
const TOO_MUCH: f64 = 0.1;

/// How much of what turns have taken so far counts against what the last one took.
const KEPT: f64 = 0.9;

/// What a thread's part of the wavefront weighs, and how long turns of so much take it.
#[derive(Debug, Default)]
pub(super) struct LoadEstimate {
    /// Lists and windows that waited when the thread told last.
    weight: f64,
    /// How long it had worked then.
    worked: u64,
    /// Sums over the turns so far, of which older ones count less and less.
    times: f64,
    weights: f64,
}

impl LoadEstimate {
    /// A thread that has [worked](super::clock::Clock) for so long has so many windows and lists
    /// that wait. Returns how long their turns are likely to take, in no unit but the same for all
    /// threads.
    ///
    /// It does so after each turn and once more when it has waited. So a thread that waits seems
    /// faster than it is, is given more and waits less.
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

    /// Time for each unit of weight; before anything is measured little, so that whoever has just
    /// woken up is given more.
    fn time_for_each(&self) -> f64 {
        if self.weights > 0.0 && self.times > 0.0 {
            1000.0 * self.times / self.weights
        } else {
            1000.0
        }
    }

    /// Lists and windows that wait.
    pub(super) fn weight(&self) -> f64 {
        self.weight
    }

    /// So much of it has been given away; returns which part that was.
    pub(super) fn lose(&mut self, weight: usize) -> f64 {
        let part = (weight as f64 / self.weight.max(1.0)).min(1.0);
        self.weight *= 1.0 - part;
        part
    }
}

/// Stands for what a thread expects that has not woken up.
const ABSENT: u64 = u64::MAX;

/// What all threads expect.
#[derive(Debug)]
pub(super) struct LoadEstimates(Vec<Padded<AtomicU64>>);

impl LoadEstimates {
    pub(super) fn new(threads: usize) -> Self {
        let absent = |_| Padded(AtomicU64::new(ABSENT));
        Self((0..threads).map(absent).collect())
    }

    /// No thread has woken up.
    pub(super) fn reset(&mut self) {
        self.0.fill_with(|| Padded(AtomicU64::new(ABSENT)));
    }

    /// What a thread expects now.
    pub(super) fn publish(&self, thread: usize, expected: u64) {
        self.0[thread].0.store(expected, Relaxed);
    }

    /// To whom a thread is to give, and how much of what it has: so much that both have the same,
    /// if it has too much.
    pub(super) fn advice(&self, thread: usize) -> Option<(usize, f64)> {
        let loads = self.0.iter().map(|load| load.0.load(Relaxed)).enumerate();
        let awake = loads.filter(|&(_, load)| load != ABSENT);
        let (mut total, mut count, mut poorest) = (0.0, 0.0, None);
        for (other, load) in awake {
            total += load as f64;
            count += 1.0;
            if poorest.is_none_or(|(_, least)| load < least) {
                poorest = Some((other, load));
            }
        }
        let (to, least) = poorest?;
        let own = self.0[thread].0.load(Relaxed) as f64;
        let share = (own - least as f64) / (2.0 * own);
        (own > (1.0 + TOO_MUCH) * total / count).then_some((to, share))
    }

    /// `from` has given `to` so much of what it expected.
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
    fn whoever_has_too_much_shares_with_whoever_has_least() {
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
