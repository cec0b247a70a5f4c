//! Blocks of memory for lists of windows that grow and shrink: size classes and free blocks.
//!
//! A store keeps all its lists in one array. A list is a block of places of that array; if it
//! outgrows the block, it moves to one of the next size class that is large enough.
//!
//! ```
//! use geobench_window::blocks::{FreeBlocks, larger_class, room};
//!
//! let (mut places, mut free) = (Vec::new(), FreeBlocks::default());
//! let class = larger_class(0, 5);
//! let start = free.take(class, &mut places, 0.0);
//! assert_eq!((start, places.len(), room(class)), (0, 8, 8));
//! free.give(class, start);
//! assert_eq!(free.take(class, &mut places, 0.0), start);
//! ```

/// The capacity of every block is a multiple of this number of places, which a search can compare
/// at once.
pub const GROUP: usize = 4;

/// Number of places in a block of each class: 4, and then two sizes for each power of two. A table,
/// because a branch on the class is mispredicted every other time. The table has more classes than a
/// list can need.
const ROOMS: [usize; 64] = {
    let mut rooms = [0; 64];
    rooms[1] = GROUP;
    let mut class = 2;
    while class < 58 {
        rooms[class] = (2 + (class & 1)) << (class / 2 + 1);
        class += 1;
    }
    rooms
};

/// Number of places in a block of this class: 0, 4, 8, 12, 16, 24, 32, 48, ...
#[inline]
pub fn room(class: u8) -> usize {
    ROOMS[usize::from(class) % ROOMS.len()]
}

/// The least class above `class` that has room for `len` places.
pub fn larger_class(class: u8, len: usize) -> u8 {
    let mut larger = class + 1;
    while room(larger) < len {
        larger += 1;
    }
    larger
}

/// Converts the index of a stored window, or of its place in a list, to 32 bits.
///
/// # Panics
///
/// If the index has more.
#[inline]
pub fn number(index: usize) -> u32 {
    u32::try_from(index).expect("more than 2^32 windows cannot be stored at once")
}

/// The free blocks of an array of places: for each class, where they start.
#[derive(Clone, Debug, Default)]
pub struct FreeBlocks {
    of_class: Vec<Vec<u32>>,
}

impl FreeBlocks {
    /// Drops all free blocks.
    pub fn clear(&mut self) {
        self.of_class.clear();
    }

    /// Takes a block of this class and returns its start: a free block, whose places keep what they
    /// held, or a new one at the end of `places`, filled with `filler`.
    ///
    /// # Panics
    ///
    /// If the array would have 2^32 places or more.
    pub fn take<T: Copy>(&mut self, class: u8, places: &mut Vec<T>, filler: T) -> u32 {
        let of_class = self.of_class.get_mut(usize::from(class));
        if let Some(start) = of_class.and_then(Vec::pop) {
            return start;
        }
        let start = places.len();
        let end = number(start + room(class));
        places.resize(end as usize, filler);
        start as u32
    }

    /// Frees a block of this class; class 0 has none.
    pub fn give(&mut self, class: u8, start: u32) {
        let class = usize::from(class);
        if class == 0 {
            return;
        }
        if self.of_class.len() <= class {
            self.of_class.resize(class + 1, Vec::new());
        }
        self.of_class[class].push(start);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_that_is_given_back_is_taken_by_one_of_its_class() {
        let (mut free, mut places) = (FreeBlocks::default(), Vec::new());
        let mut take = |free: &mut FreeBlocks, class| free.take(class, &mut places, 0);
        assert_eq!([take(&mut free, 3), take(&mut free, 2)], [0, 12]);
        free.give(0, 7);
        free.give(3, 0);
        assert_eq!([take(&mut free, 2), take(&mut free, 3)], [20, 0]);
        assert_eq!(take(&mut free, 3), 28);
        assert_eq!(places.len(), 40);
    }

    #[test]
    fn every_class_has_room_for_whole_groups_and_more_than_the_last_one() {
        let rooms: Vec<usize> = (0..58).map(room).collect();
        assert_eq!(rooms[..8], [0, 4, 8, 12, 16, 24, 32, 48]);
        for pair in rooms.windows(2) {
            assert!(pair[0] < pair[1] && pair[1] % GROUP == 0, "{pair:?}");
        }
        assert_eq!(
            [(0, 1), (1, 5), (1, 13)].map(|(class, len)| larger_class(class, len)),
            [1, 2, 4]
        );
    }
}
