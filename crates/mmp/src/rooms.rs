//! Sizes of the blocks in which lists lie.

/// As many places are compared at once.
pub(crate) const GROUP: usize = 4;

/// Number of places in a block of each class: 4, and then two sizes for each power of two. It is read from a table, since a branch on
/// the class is foreseen wrongly every other time. There are more than a list can ever need.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_class_has_room_for_whole_groups_and_more_than_the_last_one() {
        let rooms: Vec<usize> = (0..58).map(room).collect();
        assert_eq!(rooms[..8], [0, 4, 8, 12, 16, 24, 32, 48]);
        for pair in rooms.windows(2) {
            assert!(pair[0] < pair[1] && pair[1] % GROUP == 0, "{pair:?}");
        }
    }
}
