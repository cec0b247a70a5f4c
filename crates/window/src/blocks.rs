//! Lists that grow and shrink in one array.
//!
//! A list is a block of places of the array. If it outgrows the block, it moves to one of the next
//! size class that is large enough. Freed blocks are used again first.

use std::ops::Range;

use crate::prefetch::prefetch;

/// The capacity of every block is a multiple of this number of places, which a search can compare
/// at once.
const GROUP: usize = 4;

/// Number of places in a block of each class: 4, and then two sizes for each power of two. A table,
/// because a branch on the class is mispredicted every other time. The table has more classes than
/// a list can need.
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

/// No more bytes than this are moved without a call.
const SHORT: usize = 64;

/// Number of places in a block of this class: 0, 4, 8, 12, 16, 24, 32, 48, ...
#[inline]
fn room(class: u8) -> usize {
    ROOMS[usize::from(class) % ROOMS.len()]
}

/// The least class above `class` that has room for `len` places.
fn larger_class(class: u8, len: usize) -> u8 {
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

/// A list: its block, and what its owner notes about it.
#[derive(Clone, Copy, Debug, Default)]
struct ListHead<H> {
    start: u32,
    len: u32,
    /// Size class of the block; 0 without any.
    class: u8,
    closed: bool,
    note: H,
}

/// Lists of entries, each with a note of type `H`, which a new or emptied list has by default.
///
/// A list can be closed. What that means is up to the owner. Those behind the first ones, the
/// *gates*, are closed at all times.
///
/// ```
/// use geobench_window::blocks::BlockLists;
///
/// let mut lists: BlockLists<char, u32> = BlockLists::new(2, 0);
/// lists.replace(0, 0..0, &['a', 'd']);
/// lists.replace(1, 0..0, &['z']);
/// lists.replace(0, 1..1, &['b', 'c']);
/// assert_eq!((lists.entries(0), lists.stored()), (&['a', 'b', 'c', 'd'][..], 5));
/// assert_eq!(lists.leading(0, |&c| c < 'c'), 2);
/// ```
#[derive(Clone, Debug)]
pub struct BlockLists<E, H = ()> {
    heads: Vec<ListHead<H>>,
    first_gate: usize,
    entries: Vec<E>,
    /// Where the free blocks of each class start.
    free: Vec<Vec<u32>>,
    stored: usize,
}

impl<E: Copy + Default, H: Copy + Default> Default for BlockLists<E, H> {
    /// No lists.
    fn default() -> Self {
        Self::new(0, 0)
    }
}

impl<E: Copy + Default, H: Copy + Default> BlockLists<E, H> {
    /// `count` empty lists, followed by `gates`.
    pub fn new(count: usize, gates: usize) -> Self {
        let mut lists = Self {
            heads: vec![ListHead::default(); count + gates],
            first_gate: count,
            entries: Vec::new(),
            free: vec![Vec::new(); ROOMS.len()],
            stored: 0,
        };
        lists.clear();
        lists
    }

    /// Changes the numbers of lists and gates. The next [`clear`](Self::clear) makes all lists
    /// empty.
    pub fn set_count(&mut self, count: usize, gates: usize) {
        self.heads.resize(count + gates, ListHead::default());
        self.first_gate = count;
    }

    /// Number of lists, gates included.
    pub fn count(&self) -> usize {
        self.heads.len()
    }

    /// Empties and opens all lists but the gates.
    pub fn clear(&mut self) {
        self.heads.fill(ListHead::default());
        for gate in &mut self.heads[self.first_gate..] {
            gate.closed = true;
        }
        self.clear_blocks();
    }

    /// As [`clear`](Self::clear), if no others than `lists` have changed since. None may be a gate.
    pub fn clear_at(&mut self, lists: impl Iterator<Item = usize>) {
        for i in lists {
            self.heads[i] = ListHead::default();
        }
        self.clear_blocks();
    }

    fn clear_blocks(&mut self) {
        self.entries.clear();
        self.free.iter_mut().for_each(Vec::clear);
        self.stored = 0;
    }

    /// Number of entries in all lists.
    #[inline]
    pub fn stored(&self) -> usize {
        self.stored
    }

    /// Number of entries of list `i`.
    #[inline]
    pub fn len(&self, i: usize) -> usize {
        self.heads[i].len as usize
    }

    /// Whether list `i` is empty.
    #[inline]
    pub fn is_empty(&self, i: usize) -> bool {
        self.heads[i].len == 0
    }

    /// The entries of list `i`.
    #[inline]
    pub fn entries(&self, i: usize) -> &[E] {
        let ListHead { start, len, .. } = self.heads[i];
        &self.entries[start as usize..][..len as usize]
    }

    /// The entries of list `i`, and its note.
    #[inline]
    pub fn entries_mut(&mut self, i: usize) -> (&mut [E], &mut H) {
        let ListHead {
            start, len, note, ..
        } = &mut self.heads[i];
        (&mut self.entries[*start as usize..][..*len as usize], note)
    }

    /// The note of list `i`.
    #[inline]
    pub fn note(&self, i: usize) -> &H {
        &self.heads[i].note
    }

    /// The note of list `i`, to be changed.
    #[inline]
    pub fn note_mut(&mut self, i: usize) -> &mut H {
        &mut self.heads[i].note
    }

    /// Whether list `i` is closed.
    #[inline]
    pub fn is_closed(&self, i: usize) -> bool {
        self.heads[i].closed
    }

    /// Opens list `i`.
    pub fn open(&mut self, i: usize) {
        self.heads[i].closed = false;
    }

    /// Removes the entries and the note of list `i`, and closes it if `and_close`.
    pub fn remove_all(&mut self, i: usize, and_close: bool) {
        let ListHead {
            start, len, class, ..
        } = self.heads[i];
        self.stored -= len as usize;
        self.free_block(class, start);
        self.heads[i] = ListHead {
            closed: and_close,
            ..ListHead::default()
        };
    }

    /// How many entries at the beginning of list `i` satisfy `holds`, which none does behind one
    /// that does not. O(log n).
    #[inline(always)]
    #[allow(clippy::inline_always)] // Once for each list that windows arrive at.
    pub fn leading(&self, i: usize, holds: impl Fn(&E) -> bool) -> usize {
        let ListHead {
            start, len, class, ..
        } = self.heads[i];
        let len = len as usize;
        if len == 0 {
            return 0;
        }
        let block = &self.entries[start as usize..][..room(class)];
        let mut count = 0;
        // Binary search over groups.
        let mut groups = len.div_ceil(GROUP);
        while groups > 1 {
            let half = groups / 2;
            let last = count + half * GROUP - 1;
            count += usize::from(holds(&block[last])) * half * GROUP;
            groups -= half;
        }
        // Branch-free count within the group, whose last places may be unused.
        #[allow(clippy::cast_possible_wrap)] // SSE2 compares no unsigned integers.
        let used = (len - count).min(GROUP) as i32;
        let group = block[count..count + GROUP].iter().zip(0i32..);
        let in_group = group.map(|(e, k)| u32::from(holds(e)) & u32::from(k < used));
        count + in_group.sum::<u32>() as usize
    }

    /// Replaces the entries `old` of list `i` by `new`.
    #[inline(always)]
    #[allow(clippy::inline_always)] // As `leading`.
    pub fn replace(&mut self, i: usize, old: Range<usize>, new: &[E]) {
        let first = old.start;
        if old.len() != new.len() {
            self.resize(i, old, new.len());
        }
        let at = self.heads[i].start as usize + first;
        match (&mut self.entries[at..at + new.len()], new) {
            // The most frequent cases, too short for a call.
            (_, []) => {}
            ([place], [entry]) => *place = *entry,
            ([place, next], [entry, other]) => (*place, *next) = (*entry, *other),
            (places, new) => places.copy_from_slice(new),
        }
    }

    /// Makes room for `new` entries of list `i` in the place of `old`.
    #[inline]
    fn resize(&mut self, i: usize, old: Range<usize>, new: usize) {
        let ListHead {
            start, len, class, ..
        } = self.heads[i];
        let (start, len) = (start as usize, len as usize);
        let longer = len - old.len() + new;
        let behind = start + old.end..start + len;
        if longer > room(class) {
            let to = self.relocate(i, longer);
            // Often empty; then no call is needed.
            if old.start > 0 {
                self.entries.copy_within(start..start + old.start, to);
            }
            if !behind.is_empty() {
                self.entries.copy_within(behind, to + old.start + new);
            }
        } else if new == old.len() + 1 && behind.len() * size_of::<E>() < SHORT {
            // The most frequent case, too short for a call.
            let places = &mut self.entries[behind.start..=behind.end];
            for k in (1..places.len()).rev() {
                places[k] = places[k - 1];
            }
        } else if !behind.is_empty() {
            self.entries.copy_within(behind, start + old.start + new);
        }
        self.stored = self.stored + new - old.len();
        self.heads[i].len = longer as u32;
    }

    /// Moves list `i` to a block for `len` entries, without them, and returns where it starts. The
    /// old block is freed, but not written to before the next call.
    ///
    /// # Panics
    ///
    /// If the array would have 2^32 places or more.
    #[inline(never)]
    fn relocate(&mut self, i: usize, len: usize) -> usize {
        let ListHead { start, class, .. } = self.heads[i];
        let larger = larger_class(class, len);
        let to = self.free[usize::from(larger)].pop().unwrap_or_else(|| {
            let end = number(self.entries.len() + room(larger));
            let start = self.entries.len() as u32;
            self.entries.resize(end as usize, E::default());
            start
        });
        self.free_block(class, start);
        let head = &mut self.heads[i];
        (head.start, head.class) = (to, larger);
        to as usize
    }

    fn free_block(&mut self, class: u8, start: u32) {
        if class > 0 {
            self.free[usize::from(class)].push(start);
        }
    }

    /// Prefetches the head of list `i`.
    #[inline]
    pub fn prefetch_head(&self, i: usize) {
        prefetch(&self.heads, i);
    }

    /// Prefetches the entries of list `i` that `chosen` names for its length. The head was
    /// [prefetched](Self::prefetch_head) before.
    #[inline]
    pub fn prefetch_entries<I: Iterator<Item = usize>>(
        &self,
        i: usize,
        chosen: impl Fn(usize) -> I,
    ) {
        let ListHead { start, len, .. } = self.heads[i];
        for k in chosen(len as usize) {
            prefetch(&self.entries, start as usize + k);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use proptest::sample::Index;

    use super::*;

    #[derive(Clone, Debug)]
    enum Step {
        /// In this list, from this position on, replaces a fraction of the entries by so many.
        Replace(usize, Index, Index, usize),
        RemoveAll(usize, bool),
        Open(usize),
    }

    fn steps() -> impl Strategy<Value = Vec<Step>> {
        let step = prop_oneof![
            8 => (0..4usize, any::<Index>(), any::<Index>(), 0..5usize)
                .prop_map(|(i, from, part, new)| Step::Replace(i, from, part, new)),
            1 => (0..4usize, any::<bool>()).prop_map(|(i, close)| Step::RemoveAll(i, close)),
            1 => (0..4usize).prop_map(Step::Open),
        ];
        prop::collection::vec(step, 0..200)
    }

    proptest! {
        /// Compares with a vector for each list.
        #[test]
        fn lists_in_one_array_do_not_disturb_each_other(steps in steps()) {
            let mut lists = BlockLists::<u32, bool>::new(4, 1);
            let (mut model, mut closed) = (vec![Vec::new(); 5], [false, false, false, false, true]);
            let mut serial = 0;
            for step in steps {
                match step {
                    Step::Replace(i, from, part, new) => {
                        let first = from.index(model[i].len() + 1);
                        let old = first..first + part.index(model[i].len() - first + 1);
                        let new: Vec<u32> = (serial..).take(new).collect();
                        serial += new.len() as u32;
                        lists.replace(i, old.clone(), &new);
                        *lists.note_mut(i) = true;
                        model[i].splice(old, new);
                    }
                    Step::RemoveAll(i, and_close) => {
                        lists.remove_all(i, and_close);
                        prop_assert!(!lists.note(i));
                        model[i].clear();
                        closed[i] = and_close;
                    }
                    Step::Open(i) => {
                        lists.open(i);
                        closed[i] = false;
                    }
                }
                for (i, expected) in model.iter().enumerate() {
                    prop_assert_eq!(lists.entries(i), &expected[..]);
                    prop_assert_eq!(lists.is_closed(i), closed[i]);
                }
                prop_assert_eq!(lists.stored(), model.iter().map(Vec::len).sum::<usize>());
            }
            lists.clear();
            prop_assert!((0..4).all(|i| lists.is_empty(i) && !lists.is_closed(i)) && lists.is_closed(4));
        }

        #[test]
        fn leading_entries_are_counted_exactly(
            entries in prop::collection::vec(1..40u32, 0..60), at in 0..41u32,
        ) {
            let mut entries = entries;
            entries.sort_unstable();
            let mut lists = BlockLists::<u32>::new(1, 0);
            // Freed blocks contain old entries, which must not count.
            lists.replace(0, 0..0, &[0; 70]);
            lists.remove_all(0, false);
            lists.replace(0, 0..0, &entries);
            let expected = entries.iter().filter(|&&e| e <= at).count();
            prop_assert_eq!(lists.leading(0, |&e| e <= at), expected);
        }
    }

    #[test]
    fn a_block_that_is_freed_is_used_again() {
        let mut lists = BlockLists::<u32>::new(2, 0);
        lists.replace(0, 0..0, &[7; 20]);
        let room = lists.entries.len();
        lists.remove_all(0, true);
        lists.replace(1, 0..0, &[8; 20]);
        assert_eq!(
            (lists.entries(1), lists.entries.len()),
            (&[8; 20][..], room)
        );
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
