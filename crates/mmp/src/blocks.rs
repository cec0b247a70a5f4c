//! Blocks of memory for lists: size classes and free lists.

/// Number of places that a search compares at once.
pub(crate) const GROUP: usize = 4;

/// Number of places in a block of each class: 4, and then two sizes for each power of two. A table,
/// because a branch on the class is mispredicted every other time. It has more classes than a list
/// can need.
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

/// Number of places in a block of this class; class 0 has none.
#[inline]
pub(crate) fn room(class: u8) -> usize {
    ROOMS[usize::from(class) % ROOMS.len()]
}

/// The least class above `class` that has room for `len` places.
pub(crate) fn roomier(class: u8, len: usize) -> u8 {
    let mut larger = class + 1;
    while room(larger) < len {
        larger += 1;
    }
    larger
}

/// The free blocks of each class, by where they start.
#[derive(Clone, Debug, Default)]
pub(crate) struct FreeBlocks {
    of_class: Vec<Vec<u32>>,
}

impl FreeBlocks {
    /// Drops all free blocks.
    pub(crate) fn clear(&mut self) {
        self.of_class.clear();
    }

    /// Takes a block of this class, if there is one.
    pub(crate) fn take(&mut self, class: u8) -> Option<u32> {
        self.of_class.get_mut(usize::from(class))?.pop()
    }

    /// Frees a block of this class; class 0 has none.
    pub(crate) fn give(&mut self, class: u8, start: u32) {
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
        let mut free = FreeBlocks::default();
        free.give(0, 7);
        free.give(3, 40);
        assert_eq!(
            (free.take(0), free.take(2), free.take(4)),
            (None, None, None)
        );
        assert_eq!((free.take(3), free.take(3)), (Some(40), None));
        assert_eq!([roomier(0, 1), roomier(1, 5), roomier(1, 13)], [1, 2, 4]);
    }

    #[test]
    fn every_class_has_room_for_whole_groups_and_more_than_the_last_one() {
        let rooms: Vec<usize> = (0..58).map(room).collect();
        assert_eq!(rooms[..8], [0, 4, 8, 12, 16, 24, 32, 48]);
        for pair in rooms.windows(2) {
            assert!(pair[0] < pair[1] && pair[1] % GROUP == 0, "{pair:?}");
        }
    }
}
