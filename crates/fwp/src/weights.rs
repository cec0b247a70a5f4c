//! Counts of the windows that wait in each bucket.

/// The most buckets that are counted apart; windows further up are not counted until they are near.
const MOST: u64 = 1 << 18;

/// Numbers of windows, by the bucket of their label, from a first bucket on that only moves
/// upwards.
///
/// A queue whose events are whole lists does not see its windows, but the rounds of Xu et al. 2015
/// are so many windows long. Counted as there, a window that has been trimmed counts under its old
/// label as well until the round of that comes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Weights {
    /// That of bucket b stands at b modulo their number, which is 0 or a power of two.
    counts: Vec<u32>,
    first: u64,
    total: u64,
}

impl Weights {
    /// Windows in all buckets.
    pub(crate) fn total(&self) -> u64 {
        self.total
    }

    /// One more window in `bucket`, which is not below the first one.
    #[inline]
    pub(crate) fn add(&mut self, bucket: u64) {
        let place = bucket - self.first;
        if place >= self.counts.len() as u64 {
            if place >= MOST {
                return;
            }
            self.grow(place);
        }
        let i = self.index(bucket);
        self.counts[i] += 1;
        self.total += 1;
    }

    /// Makes this the first bucket: those below are empty.
    pub(crate) fn advance(&mut self, first: u64) {
        let passed = (first - self.first).min(self.counts.len() as u64);
        for bucket in self.first..self.first + passed {
            self.take(bucket);
        }
        self.first = first;
    }

    /// Empties a bucket; returns how many windows it held.
    #[inline]
    pub(crate) fn take(&mut self, bucket: u64) -> u64 {
        if bucket - self.first >= self.counts.len() as u64 {
            return 0;
        }
        let i = self.index(bucket);
        let count = u64::from(std::mem::take(&mut self.counts[i]));
        self.total -= count;
        count
    }

    /// Makes all buckets empty, and the first one number 0.
    pub(crate) fn clear(&mut self) {
        self.counts.fill(0);
        (self.first, self.total) = (0, 0);
    }

    #[inline]
    fn index(&self, bucket: u64) -> usize {
        // Their number is a power of two.
        bucket as usize & (self.counts.len() - 1)
    }

    /// Makes room for the bucket that lies so far behind the first one.
    #[cold]
    fn grow(&mut self, place: u64) {
        let room = (place + 1).next_power_of_two().max(64) as usize;
        let mut counts = vec![0; room];
        for bucket in self.first..self.first + self.counts.len() as u64 {
            counts[bucket as usize & (room - 1)] = self.counts[self.index(bucket)];
        }
        self.counts = counts;
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Against a map, with buckets further up than are counted.
        #[test]
        fn every_window_counts_until_its_bucket_is_taken_or_passed(
            steps in prop::collection::vec((prop_oneof![0..9u64, 0..900u64, Just(1 << 40)], 0..4u8), 0..300),
        ) {
            let mut weights = Weights::default();
            let (mut counts, mut first) = (BTreeMap::<u64, u64>::new(), 0);
            for (distance, step) in steps {
                let bucket = first + distance;
                match step {
                    0 => {
                        prop_assert_eq!(weights.take(bucket), counts.remove(&bucket).unwrap_or(0));
                    }
                    1 if distance < MOST => {
                        first = bucket;
                        weights.advance(first);
                        counts = counts.split_off(&first);
                    }
                    _ => {
                        weights.add(bucket);
                        if distance < MOST {
                            *counts.entry(bucket).or_default() += 1;
                        }
                    }
                }
                prop_assert_eq!(weights.total(), counts.values().sum::<u64>());
            }
            weights.clear();
            prop_assert_eq!((weights.total(), weights.take(0)), (0, 0));
        }
    }
}
