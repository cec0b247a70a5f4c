//! Whose the faces and vertices are.

use std::ops::Range;
use std::sync::atomic::AtomicU16;
use std::sync::atomic::Ordering::{Acquire, Relaxed, Release};

/// Stands for no thread.
const NOBODY: u16 = u16::MAX;

/// The most threads of a run.
pub(super) const MOST_THREADS: usize = 1024;

const _: () = assert!(MOST_THREADS <= NOBODY as usize);

/// The owners of things with consecutive numbers, which belong to a thread by whole blocks: from the time in a run on when
/// somebody asks for the owner of one of them, until that owner gives the block away.
#[derive(Debug)]
pub(super) struct Owners {
    /// Things of a block, as a power of 2.
    shift: u32,
    blocks: Vec<AtomicU16>,
    count: usize,
}

impl Owners {
    pub(super) fn new(count: usize, shift: u32) -> Self {
        let blocks = (count >> shift) + 1;
        Self {
            shift,
            blocks: (0..blocks).map(|_| AtomicU16::new(NOBODY)).collect(),
            count,
        }
    }

    /// All become nobody's.
    pub(super) fn reset(&mut self) {
        self.blocks.fill_with(|| AtomicU16::new(NOBODY));
    }

    /// The owner of thing `i`: `thread` if it had none.
    #[inline(always)]
    pub(super) fn of(&self, i: usize, thread: impl FnOnce() -> usize) -> usize {
        let block = &self.blocks[i >> self.shift];
        match block.load(Acquire) {
            NOBODY => Self::choose(block, thread()),
            owner => usize::from(owner),
        }
    }

    /// The things of the block of thing `i`.
    pub(super) fn block(&self, i: usize) -> Range<usize> {
        let first = i >> self.shift << self.shift;
        first..(first + (1 << self.shift)).min(self.count)
    }

    /// Its owner gives the block of thing `i` to another thread, which sees all that the owner did with it before.
    pub(super) fn give(&self, i: usize, to: usize) {
        self.blocks[i >> self.shift].store(to as u16, Release);
    }

    #[cold]
    fn choose(block: &AtomicU16, thread: usize) -> usize {
        match block.compare_exchange(NOBODY, thread as u16, Relaxed, Acquire) {
            Ok(_) => thread,
            // Another thread was faster, and may have chosen differently.
            Err(owner) => usize::from(owner),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_belongs_to_the_first_one_who_is_named() {
        let mut owners = Owners::new(70, 5);
        assert_eq!(owners.of(40, || 3), 3);
        assert_eq!([32, 63].map(|i| owners.of(i, || 1)), [3, 3]);
        assert_eq!([31, 64, 69].map(|i| owners.of(i, || 1)), [1, 1, 1]);
        assert_eq!(Owners::choose(&owners.blocks[1], 2), 3);
        owners.give(33, 5);
        assert_eq!([31, 40, 64].map(|i| owners.of(i, || 7)), [1, 5, 1]);
        assert_eq!([owners.block(40), owners.block(69)], [32..64, 64..70]);
        owners.reset();
        assert_eq!(owners.of(40, || MOST_THREADS - 1), MOST_THREADS - 1);
    }
}
