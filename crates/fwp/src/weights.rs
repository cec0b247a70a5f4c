//! Counts of the windows that wait in each bucket.

/// The most buckets that are counted. Windows further up are not counted until the first bucket
/// comes near them.
const MOST: u64 = 1 << 18;

/// Numbers of windows by the bucket of their label. The first bucket only moves upwards.
///
/// A queue of lists does not see single windows, but K of Xu et al. (2015) is a number of windows.
/// As there, a trimmed window also counts under its old label until the round of that label.
#[derive(Clone, Debug, Default)]
pub(crate) struct Weights {
    /// The count of bucket b is at index b modulo the length, which is 0 or a power of two.
    counts: Vec<u32>,
    first: u64,
    total: u64,
}

impl Weights {
    /// Number of windows in all buckets.
    pub(crate) fn total(&self) -> u64 {
        self.total
    }

    /// Counts one more window in `bucket`, which must not be below the first.
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

    /// Makes `first` the first bucket. Those below must be empty.
    pub(crate) fn advance(&mut self, first: u64) {
        let passed = (first - self.first).min(self.counts.len() as u64);
        for bucket in self.first..self.first + passed {
            self.take(bucket);
        }
        self.first = first;
    }

    /// Empties `bucket`; returns the number of windows in it.
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

    /// Empties all buckets and makes number 0 the first.
    pub(crate) fn clear(&mut self) {
        self.counts.fill(0);
        (self.first, self.total) = (0, 0);
    }

    #[inline]
    fn index(&self, bucket: u64) -> usize {
        // The length is a power of two.
        bucket as usize & (self.counts.len() - 1)
    }

    /// Makes room for bucket number `place`, counted from the first.
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
        /// Compares with a map; some buckets are beyond those that are counted.
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
