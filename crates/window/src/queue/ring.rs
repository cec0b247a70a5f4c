//! A ring of numbered buckets whose range of numbers moves upwards.

use super::arena::Chain;

/// Slots of the smallest ring: one word of the bit set.
const SMALLEST: usize = 64;

/// The buckets from `first` on, one for each slot. Bucket b lies in slot b modulo the number of
/// slots. That is a power of two, and grows when a higher bucket is needed.
#[derive(Clone, Debug)]
pub(crate) struct Ring {
    slots: Vec<Chain>,
    occupied: BitSet,
    first: u64,
}

impl Ring {
    pub(crate) fn new() -> Self {
        Self {
            slots: vec![Chain::EMPTY; SMALLEST],
            occupied: BitSet::new(SMALLEST),
            first: 0,
        }
    }

    /// The lowest bucket.
    pub(crate) fn first(&self) -> u64 {
        self.first
    }

    /// Sets the lowest bucket to `first`. The buckets below must be empty.
    pub(crate) fn advance(&mut self, first: u64) {
        self.first = first;
    }

    /// Marks `bucket` as occupied, after growing the ring if needed. `bucket` must not be below
    /// `first`.
    #[inline]
    pub(crate) fn occupy(&mut self, bucket: u64) -> &mut Chain {
        if bucket - self.first >= self.slots.len() as u64 {
            self.grow(bucket);
        }
        let i = self.index(bucket);
        self.occupied.insert(i);
        &mut self.slots[i]
    }

    /// The events of `bucket`, which must have a slot.
    #[inline]
    pub(crate) fn chain(&self, bucket: u64) -> Chain {
        self.slots[self.index(bucket)]
    }

    /// Marks `bucket` as empty. It must have a slot, and the caller must remove its events.
    #[inline]
    pub(crate) fn vacate(&mut self, bucket: u64) -> &mut Chain {
        let i = self.index(bucket);
        self.occupied.remove(i);
        &mut self.slots[i]
    }

    /// The lowest occupied bucket that is not below `from`.
    #[inline]
    pub(crate) fn next_occupied(&self, from: u64) -> Option<u64> {
        let start = self.index(from);
        let found = self
            .occupied
            .next(start)
            .or_else(|| self.occupied.next(0))?;
        let bucket = from + (found.wrapping_sub(start) & self.mask()) as u64;
        (bucket - self.first < self.slots.len() as u64).then_some(bucket)
    }

    /// Empties all buckets and makes number 0 the first.
    pub(crate) fn clear(&mut self) {
        self.slots.fill(Chain::EMPTY);
        self.occupied.clear();
        self.first = 0;
    }

    fn mask(&self) -> usize {
        self.slots.len() - 1
    }

    #[inline]
    fn index(&self, bucket: u64) -> usize {
        bucket as usize & self.mask()
    }

    #[cold]
    fn grow(&mut self, bucket: u64) {
        let needed = (bucket - self.first + 1).next_power_of_two() as usize;
        let mut larger = Self {
            slots: vec![Chain::EMPTY; needed],
            occupied: BitSet::new(needed),
            first: self.first,
        };
        let mut next = self.next_occupied(self.first);
        while let Some(bucket) = next {
            *larger.occupy(bucket) = self.slots[self.index(bucket)];
            next = self.next_occupied(bucket + 1);
        }
        *self = larger;
    }
}

/// A set of numbers below a multiple of 64. Two levels of words make the search for the next member
/// short.
#[derive(Clone, Debug)]
struct BitSet {
    words: Vec<u64>,
    /// Bit i tells whether word i is not 0.
    summary: Vec<u64>,
}

impl BitSet {
    fn new(size: usize) -> Self {
        let words = size.div_ceil(64);
        Self {
            words: vec![0; words],
            summary: vec![0; words.div_ceil(64)],
        }
    }

    #[inline]
    fn insert(&mut self, i: usize) {
        let word = &mut self.words[i / 64];
        if *word == 0 {
            self.summary[i / 4096] |= 1 << (i / 64 % 64);
        }
        *word |= 1 << (i % 64);
    }

    #[inline]
    fn remove(&mut self, i: usize) {
        let word = &mut self.words[i / 64];
        *word &= !(1 << (i % 64));
        if *word == 0 {
            self.summary[i / 4096] &= !(1 << (i / 64 % 64));
        }
    }

    /// The least member that is not below `from`.
    #[inline]
    fn next(&self, from: usize) -> Option<usize> {
        next_bit(&self.words[..(from / 64 + 1).min(self.words.len())], from).or_else(|| {
            let word = next_bit(&self.summary, from / 64 + 1)?;
            Some(64 * word + self.words[word].trailing_zeros() as usize)
        })
    }

    fn clear(&mut self) {
        self.words.fill(0);
        self.summary.fill(0);
    }
}

/// The position of the first set bit of `words` that is not before `from`.
#[inline]
fn next_bit(words: &[u64], from: usize) -> Option<usize> {
    let start = from / 64;
    let first = words.get(start)? & (u64::MAX << (from % 64));
    if first != 0 {
        return Some(64 * start + first.trailing_zeros() as usize);
    }
    let further = words[start + 1..].iter().position(|&word| word != 0)?;
    let word = start + 1 + further;
    Some(64 * word + words[word].trailing_zeros() as usize)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use geobench_mesh::VertexId;
    use proptest::prelude::*;

    use super::*;
    use crate::queue::{Arena, Event};

    proptest! {
        #[test]
        fn a_bit_set_is_a_set(
            steps in prop::collection::vec((any::<bool>(), 0..10_000usize), 0..100), from in 0..10_000usize,
        ) {
            let (mut bits, mut set) = (BitSet::new(10_048), BTreeSet::new());
            for (insert, i) in steps {
                if insert {
                    bits.insert(i);
                    set.insert(i);
                } else {
                    bits.remove(i);
                    set.remove(&i);
                }
            }
            prop_assert_eq!(bits.next(from), set.range(from..).next().copied());
        }

        #[test]
        fn a_ring_is_an_array_that_moves(
            steps in prop::collection::vec((0..3u8, 0..2_000u64), 0..200), from in 0..2_000u64,
        ) {
            let event = Event::vertex(VertexId::new(0));
            let (mut arena, mut ring, mut set) = (Arena::default(), Ring::new(), BTreeSet::new());
            for (step, by) in steps {
                match step {
                    0 => {
                        let bucket = ring.first() + by;
                        arena.append(ring.occupy(bucket), bucket as f64, event);
                        set.insert(bucket);
                    }
                    1 => {
                        if let Some(&bucket) = set.iter().next() {
                            ring.advance(bucket);
                        }
                    }
                    _ => {
                        if let Some(bucket) = set.pop_first() {
                            let mut drained = Vec::new();
                            arena.drain(ring.vacate(bucket), &mut drained);
                            prop_assert!(!drained.is_empty());
                            prop_assert!(drained.iter().all(|&(label, _)| label == bucket as f64));
                        }
                    }
                }
                let from = ring.first() + from;
                prop_assert_eq!(ring.next_occupied(from), set.range(from..).next().copied());
            }
        }
    }

    #[test]
    fn a_cleared_ring_starts_at_0() {
        let mut ring = Ring::new();
        ring.advance(100);
        ring.occupy(1_000);
        ring.clear();
        assert_eq!((ring.first(), ring.next_occupied(0)), (0, None));
    }
}
