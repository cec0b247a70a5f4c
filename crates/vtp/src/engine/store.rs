//! Lists of waiting windows: structures of arrays in one arena.
//!
//! A list is a *block* of five columns, b0, b1, px, py and σ, each a whole number of cache lines;
//! 40 bytes a window. Blocks have size classes and are reused, last freed first. The few thousand
//! windows of a wavefront thus stay in the same cache lines during a run.

use std::ops::Range;
use std::slice;

use geobench_window::Window;
use geobench_window::blocks::number;
use geobench_window::simd::{self, CacheLine};
use geobench_window::trimming::KeptWindows;

/// Columns of a block.
pub(crate) const COLUMNS: usize = 5;

/// The windows of a list, for reading.
pub(crate) type Columns<'a> = simd::Columns<'a, COLUMNS>;

/// The block of a list, for writing.
pub(crate) type Block<'a> = simd::Block<'a, COLUMNS>;

/// The block of a list and the line behind it.
pub(crate) type PaddedBlock<'a> = simd::PaddedBlock<'a, COLUMNS>;

/// The handle that stands for no list.
pub(crate) const NO_LIST: u32 = 0;

/// Lines of a column in the classes of small blocks. Each further class doubles the last.
const SMALL: [u32; 13] = [1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 24, 32, 48];

/// The class for each small number of lines.
const CLASS_OF: [u8; 49] = classes();

/// Number of classes, enough for every length of 32 bits.
const CLASSES: usize = SMALL.len() + 27;

const fn classes() -> [u8; 49] {
    let mut table = [0; 49];
    let (mut lines, mut class) = (0, 0);
    while lines < table.len() {
        if lines as u32 > SMALL[class] {
            class += 1;
        }
        table[lines] = class as u8;
        lines += 1;
    }
    table
}

/// Lines of a column of a block of `class`.
#[inline]
const fn lines_of(class: u8) -> u32 {
    let class = class as usize;
    if class < SMALL.len() {
        SMALL[class]
    } else {
        64 << (class - SMALL.len())
    }
}

/// The least class with room for `windows`.
#[inline]
fn class_for(windows: usize) -> u8 {
    let lines = windows.div_ceil(CacheLine::LANES);
    match CLASS_OF.get(lines) {
        Some(&class) => class,
        None => SMALL.len() as u8 + (lines.div_ceil(64).next_power_of_two().trailing_zeros()) as u8,
    }
}

/// The header of a list.
#[derive(Clone, Copy, Debug, Default)]
struct ListHeader {
    /// First line of its block.
    start: u32,
    len: u32,
    /// Lines of a column of its block; 0 for [`NO_LIST`].
    column: u32,
    class: u8,
}

impl ListHeader {
    /// Number of windows that fit into the block.
    #[inline]
    fn room(self) -> usize {
        self.column as usize * CacheLine::LANES
    }
}

/// The lists of waiting windows, addressed by handles.
#[derive(Clone, Debug)]
pub(crate) struct WindowStore {
    lines: Vec<CacheLine>,
    /// Number of lines that belong to blocks.
    used: usize,
    lists: Vec<ListHeader>,
    /// For each class, the lists whose blocks are free.
    free: Vec<Vec<u32>>,
    waiting: usize,
}

/// The window of a row.
pub(crate) fn as_window([b0, b1, px, py, sigma]: [f64; COLUMNS]) -> Window {
    Window {
        b0,
        b1,
        px,
        py,
        sigma,
    }
}

/// The part of a window arriving at half-edge `h` that `kept` admits.
#[cold]
pub(crate) fn admit(
    kept: &mut KeptWindows,
    h: u32,
    window: [f64; COLUMNS],
) -> Option<[f64; COLUMNS]> {
    let Window {
        b0,
        b1,
        px,
        py,
        sigma,
    } = kept.admit(h as usize, &as_window(window))?;
    Some([b0, b1, px, py, sigma])
}

impl WindowStore {
    pub(crate) fn new() -> Self {
        Self {
            // Kernels may load one number behind a block, without using it.
            lines: vec![CacheLine::default(); 1],
            used: 0,
            // The header of `NO_LIST`.
            lists: vec![ListHeader::default()],
            free: vec![Vec::new(); CLASSES],
            waiting: 0,
        }
    }

    /// Number of windows in all lists.
    pub(crate) fn waiting(&self) -> usize {
        self.waiting
    }

    /// Number of non-empty lists.
    pub(crate) fn lists(&self) -> usize {
        let free: usize = self.free.iter().map(Vec::len).sum();
        self.lists.len() - 1 - free
    }

    /// Number of windows in `list`; 0 for [`NO_LIST`].
    #[inline]
    pub(crate) fn len(&self, list: u32) -> usize {
        self.lists[list as usize].len as usize
    }

    /// Makes room for `more` windows in `list`, which may be [`NO_LIST`]. Returns the list, which
    /// may have moved to another block and have another handle.
    #[inline(always)]
    pub(crate) fn reserve(&mut self, list: u32, more: usize) -> u32 {
        let entry = self.lists[list as usize];
        if entry.len as usize + more <= entry.room() {
            return list;
        }
        self.move_to_larger(list, entry, more)
    }

    /// Moves `list`, whose header is `old`, to a block with room for `more` windows.
    fn move_to_larger(&mut self, list: u32, old: ListHeader, more: usize) -> u32 {
        if list == NO_LIST {
            // As many windows are likely to arrive from the other side of the face below.
            return self.allocate(class_for(2 * more));
        }
        let new = self.allocate(class_for(old.len as usize + more));
        let (from, to) = (old.start as usize, self.lists[new as usize]);
        let filled = (old.len as usize).div_ceil(CacheLine::LANES);
        for column in 0..COLUMNS {
            let source = from + column * old.column as usize;
            let target = to.start as usize + column * to.column as usize;
            self.lines.copy_within(source..source + filled, target);
        }
        self.lists[new as usize].len = old.len;
        self.lists[list as usize].len = 0;
        self.free[usize::from(old.class)].push(list);
        new
    }

    #[inline]
    fn allocate(&mut self, class: u8) -> u32 {
        match self.free[usize::from(class)].pop() {
            Some(list) => list,
            None => self.grow(class),
        }
    }

    #[cold]
    fn grow(&mut self, class: u8) -> u32 {
        let start = self.used as u32;
        let column = lines_of(class);
        self.used = number(self.used + COLUMNS * column as usize) as usize;
        self.lines.resize(self.used + 1, CacheLine::default());
        self.lists.push(ListHeader {
            start,
            len: 0,
            column,
            class,
        });
        (self.lists.len() - 1) as u32
    }

    /// Sets the length of `list`. An empty list is freed, and [`NO_LIST`] is returned for it.
    #[inline]
    pub(crate) fn set_len(&mut self, list: u32, len: usize) -> u32 {
        let entry = &mut self.lists[list as usize];
        self.waiting = self.waiting + len - entry.len as usize;
        entry.len = len as u32;
        if len > 0 {
            return list;
        }
        self.free[usize::from(entry.class)].push(list);
        NO_LIST
    }

    /// Writes a window at index `i` of `list`, which must have room there.
    #[inline]
    pub(crate) fn put(&mut self, list: u32, i: usize, window: [f64; COLUMNS]) {
        let ListHeader { start, column, .. } = self.lists[list as usize];
        let mut line = start as usize + i / CacheLine::LANES;
        for value in window {
            self.lines[line].0[i % CacheLine::LANES] = value;
            line += column as usize;
        }
    }

    /// Appends the windows of `list` to `columns`, column by column.
    pub(crate) fn copy_out(&self, list: u32, columns: &mut Vec<f64>) {
        let ListHeader {
            start, len, column, ..
        } = self.lists[list as usize];
        let mut line = start as usize;
        for _ in 0..COLUMNS {
            let numbers = self.lines[line..].iter().flat_map(|line| line.0);
            columns.extend(numbers.take(len as usize));
            line += column as usize;
        }
    }

    /// Appends windows from [`copy_out`](Self::copy_out) to `list`, which may be [`NO_LIST`].
    /// Returns the list, as [`reserve`](Self::reserve) does.
    pub(crate) fn append(&mut self, list: u32, columns: &[f64]) -> u32 {
        let more = columns.len() / COLUMNS;
        if more == 0 {
            return list;
        }
        let list = self.reserve(list, more);
        let len = self.len(list);
        let ListHeader { start, column, .. } = self.lists[list as usize];
        let mut first = start as usize;
        for numbers in columns.chunks_exact(more) {
            for (i, &number) in (len..).zip(numbers) {
                self.lines[first + i / CacheLine::LANES].0[i % CacheLine::LANES] = number;
            }
            first += column as usize;
        }
        self.set_len(list, len + more)
    }

    /// Appends windows to `list`. Returns the list, as [`reserve`](Self::reserve) does.
    pub(crate) fn append_rows(&mut self, list: u32, rows: &[[f64; COLUMNS]]) -> u32 {
        let list = self.reserve(list, rows.len());
        let len = self.len(list);
        for (i, &row) in rows.iter().enumerate() {
            self.put(list, len + i, row);
        }
        self.lists[list as usize].len += rows.len() as u32;
        self.waiting += rows.len();
        list
    }

    /// The block of `list` and the line behind it, which is free or belongs to another block.
    #[inline]
    pub(crate) fn padded_block(&mut self, list: u32) -> PaddedBlock<'_> {
        let ListHeader { start, column, .. } = self.lists[list as usize];
        PaddedBlock::new(&mut self.lines[start as usize..], column)
    }

    /// The windows of `list`.
    #[inline]
    pub(crate) fn columns(&self, list: u32) -> Columns<'_> {
        self.first(list, self.len(list))
    }

    /// The first `len` windows of the block of `list`.
    #[inline(always)]
    pub(crate) fn first(&self, list: u32, len: usize) -> Columns<'_> {
        let ListHeader { start, column, .. } = self.lists[list as usize];
        Columns::new(&self.lines[start as usize..], column, len)
    }

    /// The window at index `i` of `list`.
    #[inline]
    pub(crate) fn get(&self, list: u32, i: usize) -> [f64; COLUMNS] {
        self.first(list, i + 1).row(i)
    }

    /// The blocks of different lists; empty for [`NO_LIST`].
    ///
    /// # Panics
    ///
    /// If a list occurs twice.
    #[allow(unsafe_code)] // To compare the ranges of blocks takes a twentieth of a solve.
    #[inline(always)]
    pub(crate) fn blocks<const N: usize>(&mut self, lists: [u32; N]) -> [Block<'_>; N] {
        // Whether there is a list is hard to predict, so there is no branch on it.
        let mut twice = false;
        for (i, &list) in lists.iter().enumerate() {
            for &other in &lists[..i] {
                twice |= list == other && list != NO_LIST;
            }
        }
        assert!(!twice, "a list is there twice");
        let lists = lists.map(|list| self.lists[list as usize]);
        let lines = self.lines.as_mut_ptr();
        lists.map(|ListHeader { start, column, .. }| {
            let (start, len) = (start as usize, COLUMNS * column as usize);
            // SAFETY: every block lies within `lines`, and `grow` gives each block lines of its
            // own. The block of `NO_LIST` is empty.
            let lines = unsafe { slice::from_raw_parts_mut(lines.add(start), len) };
            Block::new(lines, column)
        })
    }

    /// Reduces the windows of `list` at `places`, on half-edge `h` of a thin face, to the parts
    /// that `kept` admits. Returns the number of windows left.
    #[cold]
    pub(crate) fn admit(
        &mut self,
        kept: &mut KeptWindows,
        h: u32,
        list: u32,
        places: Range<usize>,
    ) -> usize {
        let mut left = places.start;
        for i in places {
            let window = self.get(list, i);
            if let Some(part) = admit(kept, h, window) {
                // Most stay as they are, where they are.
                if left != i || part != window {
                    self.put(list, left, part);
                }
                left += 1;
            }
        }
        left
    }

    /// Removes the windows from `list`, on half-edge `h`, that `kept` has replaced since they
    /// arrived. Returns the number of windows left.
    #[cold]
    pub(crate) fn drop_replaced(&mut self, kept: &KeptWindows, h: u32, list: u32) -> usize {
        let mut left = 0;
        for i in 0..self.len(list) {
            let window = self.get(list, i);
            if !kept.has_replaced(h as usize, &as_window(window)) {
                if left != i {
                    self.put(list, left, window);
                }
                left += 1;
            }
        }
        left
    }

    /// The windows of `list` with indices in `places`.
    pub(crate) fn windows_at(
        &self,
        list: u32,
        places: Range<usize>,
    ) -> impl Iterator<Item = Window> {
        let columns = self.first(list, places.end);
        places.map(move |i| as_window(columns.row(i)))
    }

    /// All waiting windows.
    pub(crate) fn windows(&self) -> impl Iterator<Item = Window> {
        (0..self.lists.len() as u32).flat_map(move |list| self.windows_at(list, 0..self.len(list)))
    }
}

#[cfg(test)]
mod tests {
    use geobench_window::simd::{Lanes, Scalar};

    use super::*;

    #[test]
    fn every_length_has_the_least_class_that_holds_it() {
        for windows in (1..5000).chain([1 << 20, (1 << 20) + 1, u32::MAX as usize]) {
            let class = class_for(windows);
            let room = |class| lines_of(class) as usize * CacheLine::LANES;
            assert!(room(class) >= windows, "{windows}");
            assert!(class == 0 || room(class - 1) < windows, "{windows}");
            assert!(usize::from(class) < CLASSES);
        }
    }

    #[test]
    fn windows_move_with_a_list_that_grows_and_blocks_are_used_again() {
        let mut store = WindowStore::new();
        for round in 0..3 {
            let mut list = store.reserve(NO_LIST, 4);
            for i in 0..8 {
                store.put(list, i, [0.0, 1.0, 2.0, 3.0, 4.0]);
            }
            list = store.set_len(list, 8);
            list = store.reserve(list, 100);
            let waiting: Vec<_> = store.windows().collect();
            let window = Window {
                b0: 0.0,
                b1: 1.0,
                px: 2.0,
                py: 3.0,
                sigma: 4.0,
            };
            assert_eq!(waiting, [window; 8], "round {round}");
            assert_eq!((store.waiting(), store.len(list)), (8, 8));
            assert_eq!(store.set_len(list, 0), NO_LIST);
            assert_eq!(store.lists.len(), 3);
        }
        assert_eq!(store.waiting(), 0);
    }

    #[test]
    fn windows_that_are_copied_out_of_one_store_arrive_in_another() {
        let (mut from, mut to) = (WindowStore::new(), WindowStore::new());
        let window = |i: usize| std::array::from_fn(|c| (10 * i + c) as f64);
        let mut there = NO_LIST;
        let mut first = 0;
        for n in [1, 0, 7, 9, 40] {
            let list = from.reserve(NO_LIST, n.max(1));
            for i in 0..n {
                from.put(list, i, window(first + i));
            }
            from.set_len(list, n);
            let mut columns = Vec::new();
            from.copy_out(list, &mut columns);
            there = to.append(there, &columns);
            first += n;
        }
        let arrived: Vec<_> = to
            .windows()
            .map(|w| [w.b0, w.b1, w.px, w.py, w.sigma])
            .collect();
        assert_eq!(arrived, (0..57).map(window).collect::<Vec<_>>());
        assert_eq!((to.len(there), to.waiting()), (57, 57));
    }

    #[test]
    fn blocks_of_several_lists_do_not_overlap() {
        let mut store = WindowStore::new();
        let lists = [3, 30, 300].map(|n| store.reserve(NO_LIST, n));
        for (i, mut block) in store.blocks(lists).into_iter().enumerate() {
            let mut sink = block.append(0);
            for _ in 0..[3, 30, 300][i] {
                sink.add(Scalar::mask((), 1), [Scalar::splat((), i as f64); COLUMNS]);
            }
        }
        for (i, (block, len)) in store.blocks(lists).iter().zip([3, 30, 300]).enumerate() {
            let columns = block.columns(len);
            assert!((0..len).all(|row| columns.row(row) == [i as f64; COLUMNS]));
        }
        let [block, none, _] = store.blocks([lists[0], NO_LIST, NO_LIST]);
        assert_eq!((block.columns(3).len(), none.columns(0).len()), (3, 0));
    }

    #[test]
    #[should_panic(expected = "twice")]
    fn no_list_has_two_mutable_blocks() {
        let mut store = WindowStore::new();
        let list = store.reserve(NO_LIST, 1);
        store.blocks([list, NO_LIST, list]);
    }
}
