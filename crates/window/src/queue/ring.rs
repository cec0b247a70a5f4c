//! Numbered buckets, of which a range that moves upwards is there at any time.

use super::arena::Chain;

/// Slots of the smallest ring: one word of the bit set.
const SMALLEST: usize = 64;

/// The events of one bucket.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slot {
    pub(crate) chain: Chain,
    pub(crate) len: u32,
}

impl Slot {
    const EMPTY: Self = Self {
        chain: Chain::EMPTY,
        len: 0,
    };
}

/// The buckets from `first` on, as many as there are slots; bucket b lies in slot b modulo their
/// number, which is a power of two and grows when a bucket further up is needed.
#[derive(Clone, Debug)]
pub(crate) struct Ring {
    slots: Vec<Slot>,
    occupied: BitSet,
    first: u64,
}

impl Ring {
    pub(crate) fn new() -> Self {
        Self {
            slots: vec![Slot::EMPTY; SMALLEST],
            occupied: BitSet::new(SMALLEST),
            first: 0,
        }
    }

    /// The lowest bucket that it can hold.
    pub(crate) fn first(&self) -> u64 {
        self.first
    }

    /// Gives up the buckets below `first`, which must be empty.
    pub(crate) fn advance(&mut self, first: u64) {
        self.first = first;
    }

    /// The slot of a bucket that has one: not below `first`, and reserved if it is empty.
    #[inline]
    pub(crate) fn slot(&mut self, bucket: u64) -> &mut Slot {
        let i = self.index(bucket);
        &mut self.slots[i]
    }

    /// Makes room for `bucket` and marks it as occupied.
    #[inline]
    pub(crate) fn occupy(&mut self, bucket: u64) -> &mut Slot {
        if bucket - self.first >= self.slots.len() as u64 {
            self.grow(bucket);
        }
        let i = self.index(bucket);
        let slot = &mut self.slots[i];
        if slot.len == 0 {
            self.occupied.insert(i);
        }
        slot
    }

    /// Marks `bucket` as empty.
    #[inline]
    pub(crate) fn vacate(&mut self, bucket: u64) {
        let i = self.index(bucket);
        self.occupied.remove(i);
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

    /// Makes all buckets empty, and the first one number 0.
    pub(crate) fn clear(&mut self) {
        self.slots.fill(Slot::EMPTY);
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
            slots: vec![Slot::EMPTY; needed],
            occupied: BitSet::new(needed),
            first: self.first,
        };
        let mut next = self.next_occupied(self.first);
        while let Some(bucket) = next {
            *larger.occupy(bucket) = *self.slot(bucket);
            next = self.next_occupied(bucket + 1);
        }
        *self = larger;
    }
}

/// A set of numbers below a multiple of 64, in which the next member is found with few looks.
#[derive(Clone, Debug)]
struct BitSet {
    words: Vec<u64>,
    /// Which of the words are not 0.
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
        self.words[i / 64] |= 1 << (i % 64);
        self.summary[i / 4096] |= 1 << (i / 64 % 64);
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

/// The number of the first bit that is set in `words`, from number `from` on.
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

    use proptest::prelude::*;

    use super::*;

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
            let (mut ring, mut set) = (Ring::new(), BTreeSet::new());
            for (step, by) in steps {
                match step {
                    0 => {
                        let bucket = ring.first() + by;
                        ring.occupy(bucket).len = bucket as u32;
                        set.insert(bucket);
                    }
                    1 => {
                        if let Some(&bucket) = set.iter().next() {
                            ring.advance(bucket);
                        }
                    }
                    _ => {
                        if let Some(bucket) = set.pop_first() {
                            prop_assert_eq!(ring.slot(bucket).len, bucket as u32);
                            *ring.slot(bucket) = Slot::EMPTY;
                            ring.vacate(bucket);
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
        ring.occupy(1_000).len = 1;
        ring.clear();
        assert_eq!((ring.first(), ring.next_occupied(0)), (0, None));
    }
}
