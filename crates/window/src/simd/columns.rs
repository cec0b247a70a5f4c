//! Bounds-checked views of structures of arrays: blocks of columns, each a whole number of cache
//! lines.

// Registers are loaded and stored through pointers, within bounds that the views check.
#![allow(unsafe_code)]
// An iterator over registers might not be inlined into code that is compiled for vectors.
#![allow(clippy::needless_range_loop)]

use std::marker::PhantomData;

use super::lanes::{LaneMask, Lanes};

/// A cache line of a column.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(64))]
pub struct CacheLine(pub [f64; CacheLine::LANES]);

impl CacheLine {
    /// Numbers in a line; the length of a register divides it.
    pub const LANES: usize = 8;
}

/// Number of registers that hold the first `len` numbers of a column.
#[inline(always)]
fn registers<L: Lanes>(len: usize) -> usize {
    const { assert!(CacheLine::LANES.is_multiple_of(L::COUNT)) };
    len.div_ceil(L::COUNT)
}

/// The stride between `N` columns of `column` lines each, in numbers. Panics if the columns and
/// `more` lines behind them do not fit into `lines` lines.
#[inline(always)]
fn stride_of<const N: usize>(lines: usize, column: u32, more: u64) -> usize {
    // Computed in 64 bits, which cannot overflow here.
    let needed = N as u64 * u64::from(column) + more;
    assert!(needed <= lines as u64, "the columns do not fit");
    column as usize * CacheLine::LANES
}

/// Loads one register from each of `N` columns that are `stride` numbers apart. The first one is at
/// `from`.
///
/// # Safety
///
/// `L::COUNT` numbers must be readable at each of these places.
#[inline(always)]
unsafe fn load<L: Lanes, const N: usize>(
    simd: L::Token,
    from: *const f64,
    stride: usize,
) -> [L; N] {
    let mut loaded = [L::splat(simd, 0.0); N];
    for column in 0..N {
        // SAFETY: the caller guarantees the ranges.
        loaded[column] = unsafe { L::load(simd, from.add(column * stride)) };
    }
    loaded
}

/// Writes the lanes that `mask` chooses to `N` columns that are `stride` numbers apart. The first
/// one is at `to`.
///
/// # Safety
///
/// `mask.count()` numbers must be writable at each of these places.
#[inline(always)]
unsafe fn store<L: Lanes, const N: usize>(
    to: *mut f64,
    stride: usize,
    mask: L::Mask,
    rows: [L; N],
) {
    let all = L::STORES_SOME_SLOWLY && mask.count() == L::COUNT;
    for column in 0..N {
        // SAFETY: the caller guarantees the ranges; all lanes are chosen if `all`.
        unsafe {
            let to = to.add(column * stride);
            if all {
                rows[column].store(to);
            } else {
                rows[column].store_chosen(mask, to);
            }
        }
    }
}

/// The first `len` rows of a block of `N` columns, for reading.
#[derive(Clone, Copy, Debug)]
pub struct Columns<'a, const N: usize> {
    start: *const f64,
    /// Numbers from one column to the next. `len` of them are rows. There are `N` columns.
    stride: usize,
    len: usize,
    lines: PhantomData<&'a [CacheLine]>,
}

impl<'a, const N: usize> Columns<'a, N> {
    /// The first `len` rows of `N` columns of `column` lines each, at the start of `lines`.
    ///
    /// # Panics
    ///
    /// If there are fewer lines, or columns are shorter than `len`.
    #[inline(always)]
    pub fn new(lines: &'a [CacheLine], column: u32, len: usize) -> Self {
        let stride = stride_of::<N>(lines.len(), column, 0);
        assert!(len <= stride, "columns are shorter than the list");
        Self {
            start: lines.as_ptr().cast(),
            stride,
            len,
            lines: PhantomData,
        }
    }

    /// Number of rows.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are no rows.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Number of registers that hold the rows of a column.
    #[inline(always)]
    pub fn registers<L: Lanes>(&self) -> usize {
        registers::<L>(self.len)
    }

    /// The lanes of a register that hold rows.
    #[inline(always)]
    pub fn listed<L: Lanes>(&self, simd: L::Token, register: usize) -> L::Mask {
        L::within(simd, register * L::COUNT, self.len)
    }

    /// Loads one register of each column. Lanes behind the last row hold any number.
    ///
    /// # Panics
    ///
    /// If `register` is not less than [`registers`](Self::registers).
    #[inline(always)]
    pub fn load<L: Lanes>(&self, simd: L::Token, register: usize) -> [L; N] {
        assert!(register < self.registers::<L>());
        // SAFETY: columns are whole cache lines, so a register with a row lies within its column.
        unsafe { load(simd, self.start.add(register * L::COUNT), self.stride) }
    }

    /// The numbers of row `i`.
    ///
    /// # Panics
    ///
    /// If `i` is not less than `len`.
    #[inline(always)]
    pub fn row(&self, i: usize) -> [f64; N] {
        assert!(i < self.len);
        // SAFETY: `len` is at most `stride`.
        std::array::from_fn(|column| unsafe { *self.start.add(column * self.stride + i) })
    }
}

/// A block of `N` columns, for writing. `MORE` lines follow behind the last column.
#[derive(Debug)]
pub struct Block<'a, const N: usize, const MORE: u64 = 0> {
    start: *mut f64,
    /// As in [`Columns`].
    stride: usize,
    lines: PhantomData<&'a mut [CacheLine]>,
}

/// A block with one more line behind it, so that loads may start one row later.
pub type PaddedBlock<'a, const N: usize> = Block<'a, N, 1>;

impl<'a, const N: usize, const MORE: u64> Block<'a, N, MORE> {
    /// `N` columns of `column` lines each and the lines behind them, at the start of `lines`.
    ///
    /// # Panics
    ///
    /// If there are fewer lines.
    #[inline(always)]
    pub fn new(lines: &'a mut [CacheLine], column: u32) -> Self {
        Self {
            stride: stride_of::<N>(lines.len(), column, MORE),
            start: lines.as_mut_ptr().cast(),
            lines: PhantomData,
        }
    }

    /// Appends rows behind the first `len`.
    ///
    /// # Panics
    ///
    /// If columns are shorter than `len`.
    #[inline(always)]
    pub fn append(&mut self, len: usize) -> Sink<'_, N> {
        assert!(len <= self.stride, "columns are shorter than the list");
        Sink {
            start: self.start,
            stride: self.stride,
            len,
            block: PhantomData,
        }
    }

    /// The first `len` rows, for reading.
    ///
    /// # Panics
    ///
    /// If columns are shorter than `len`.
    #[inline(always)]
    pub fn columns(&self, len: usize) -> Columns<'_, N> {
        assert!(len <= self.stride, "columns are shorter than the list");
        Columns {
            start: self.start,
            stride: self.stride,
            len,
            lines: PhantomData,
        }
    }
}

impl<const N: usize> PaddedBlock<'_, N> {
    /// The first `len` rows, to be filtered in place.
    ///
    /// # Panics
    ///
    /// If columns are shorter than `len`.
    #[inline(always)]
    pub fn in_place(&mut self, len: usize) -> InPlace<'_, N> {
        assert!(len <= self.stride, "columns are shorter than the list");
        InPlace {
            start: self.start,
            stride: self.stride,
            len,
            kept: 0,
            block: PhantomData,
        }
    }
}

/// Appends rows to a [`Block`].
#[derive(Debug)]
pub struct Sink<'a, const N: usize> {
    start: *mut f64,
    /// As in [`Columns`].
    stride: usize,
    len: usize,
    block: PhantomData<&'a mut [CacheLine]>,
}

impl<const N: usize> Sink<'_, N> {
    /// Number of rows.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are no rows.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Appends the rows that `mask` chooses.
    ///
    /// # Panics
    ///
    /// If there is no room for them.
    #[inline(always)]
    pub fn add<L: Lanes>(&mut self, mask: L::Mask, rows: [L; N]) {
        let len = self.len + mask.count();
        assert!(len <= self.stride, "no room in a list");
        // SAFETY: each column has room for the chosen rows.
        unsafe { store(self.start.add(self.len), self.stride, mask, rows) };
        self.len = len;
    }
}

/// Filters the rows of a [`PaddedBlock`] in place: rows are loaded, and those that are kept are
/// written from the start on.
#[derive(Debug)]
pub struct InPlace<'a, const N: usize> {
    start: *mut f64,
    /// As in [`Columns`]; a line follows behind the last column.
    stride: usize,
    len: usize,
    kept: usize,
    block: PhantomData<&'a mut [CacheLine]>,
}

impl<const N: usize> InPlace<'_, N> {
    /// Number of registers that hold the rows of a column.
    #[inline(always)]
    pub fn registers<L: Lanes>(&self) -> usize {
        registers::<L>(self.len)
    }

    /// The lanes of a register that hold rows.
    #[inline(always)]
    pub fn listed<L: Lanes>(&self, simd: L::Token, register: usize) -> L::Mask {
        L::within(simd, register * L::COUNT, self.len)
    }

    /// The lanes of a register that hold rows with a successor.
    #[inline(always)]
    pub fn with_next<L: Lanes>(&self, simd: L::Token, register: usize) -> L::Mask {
        L::within(simd, register * L::COUNT, self.len - 1)
    }

    /// Loads one register of each column. Lanes behind the last row hold any number.
    ///
    /// # Panics
    ///
    /// If `register` is not less than [`registers`](Self::registers).
    #[inline(always)]
    pub fn load<L: Lanes>(&self, simd: L::Token, register: usize) -> [L; N] {
        assert!(register < self.registers::<L>());
        // SAFETY: as in `Columns::load`.
        unsafe { load(simd, self.start.add(register * L::COUNT), self.stride) }
    }

    /// As [`load`](Self::load), one row further on.
    ///
    /// # Panics
    ///
    /// As [`load`](Self::load).
    #[inline(always)]
    pub fn load_next<L: Lanes>(&self, simd: L::Token, register: usize) -> [L; N] {
        assert!(register < self.registers::<L>());
        // SAFETY: as in `Columns::load`, and there is a line behind the last column.
        unsafe { load(simd, self.start.add(register * L::COUNT + 1), self.stride) }
    }

    /// Writes the rows that `mask` chooses behind those that have been kept. Load rows before
    /// keeping more rows than have been loaded: rows that have not been loaded are overwritten.
    ///
    /// # Panics
    ///
    /// If there is no room for them.
    #[inline(always)]
    pub fn keep<L: Lanes>(&mut self, mask: L::Mask, rows: [L; N]) {
        let kept = self.kept + mask.count();
        assert!(kept <= self.stride, "no room in a list");
        // SAFETY: each column has room for the chosen rows.
        unsafe { store(self.start.add(self.kept), self.stride, mask, rows) };
        self.kept = kept;
    }

    /// As [`keep`](Self::keep), for rows of a register as they were loaded. Writes nothing if they
    /// stay where they are.
    #[inline(always)]
    pub fn keep_unchanged<L: Lanes>(&mut self, register: usize, mask: L::Mask, rows: [L; N]) {
        let bits = mask.bits();
        let are_first = bits & bits.wrapping_add(1) == 0;
        if are_first && self.kept == register * L::COUNT {
            self.kept += mask.count();
        } else {
            self.keep::<L>(mask, rows);
        }
    }

    /// Number of rows kept.
    #[inline(always)]
    pub fn kept(&self) -> usize {
        self.kept
    }
}

/// A block of `N` columns that are stored and loaded as whole registers.
#[derive(Debug)]
pub struct Scratch<'a, const N: usize> {
    start: *mut f64,
    /// As in [`Columns`]; columns have at least one line more than `len` rows take.
    stride: usize,
    len: usize,
    lines: PhantomData<&'a mut [CacheLine]>,
}

impl<'a, const N: usize> Scratch<'a, N> {
    /// Columns for `len` rows: `lines` divided into `N` equal columns.
    ///
    /// # Panics
    ///
    /// If columns do not have one line more than `len` rows take.
    #[inline(always)]
    pub fn new(lines: &'a mut [CacheLine], len: usize) -> Self {
        let stride = lines.len() / N * CacheLine::LANES;
        assert!(
            len < stride && stride - len >= CacheLine::LANES,
            "columns are shorter than the list and a line"
        );
        Self {
            start: lines.as_mut_ptr().cast(),
            stride,
            len,
            lines: PhantomData,
        }
    }

    /// Stores one register of each column.
    ///
    /// # Panics
    ///
    /// If the register does not hold any of the rows.
    #[inline(always)]
    pub fn store<L: Lanes>(&mut self, register: usize, rows: [L; N]) {
        self.store_at(register, 0, rows);
    }

    /// As [`store`](Self::store), one row further on.
    ///
    /// # Panics
    ///
    /// As [`store`](Self::store).
    #[inline(always)]
    pub fn store_next<L: Lanes>(&mut self, register: usize, rows: [L; N]) {
        self.store_at(register, 1, rows);
    }

    #[inline(always)]
    fn store_at<L: Lanes>(&mut self, register: usize, further: usize, rows: [L; N]) {
        assert!(register < registers::<L>(self.len) && further <= 1);
        for column in 0..N {
            let place = column * self.stride + register * L::COUNT + further;
            // SAFETY: the register starts before row `len`, and columns go on for a line behind it.
            unsafe { rows[column].store(self.start.add(place)) };
        }
    }

    /// Loads one register of each column.
    ///
    /// # Panics
    ///
    /// As [`store`](Self::store).
    #[inline(always)]
    pub fn load<L: Lanes>(&self, simd: L::Token, register: usize) -> [L; N] {
        assert!(register < registers::<L>(self.len));
        // SAFETY: as in `store_at`.
        unsafe { load(simd, self.start.add(register * L::COUNT), self.stride) }
    }

    /// Sets row `i`.
    ///
    /// # Panics
    ///
    /// If `i` is not less than the number of rows.
    #[inline(always)]
    pub fn set_row(&mut self, i: usize, row: [f64; N]) {
        assert!(i < self.len);
        for column in 0..N {
            // SAFETY: `len` is less than `stride`.
            unsafe { *self.start.add(column * self.stride + i) = row[column] };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{Instructions, Scalar, Simd, SimdProgram};

    /// Keeps the rows whose first number is less than that of their successor, in place, and
    /// appends them to a sink, which they fill.
    struct KeepRising<'a>(&'a mut [CacheLine], usize, &'a mut [CacheLine]);

    impl SimdProgram for KeepRising<'_> {
        type Output = [usize; 2];

        #[inline(always)]
        fn run<L: Lanes>(self, simd: L::Token) -> [usize; 2] {
            let Self(lines, len, out) = self;
            let column = (lines.len() / 2) as u32;
            let mut block = PaddedBlock::<2>::new(lines, column);
            let mut list = block.in_place(len);
            let mut cuts = vec![CacheLine::default(); 2 * (len / CacheLine::LANES + 2)];
            let mut cuts = Scratch::<2>::new(&mut cuts, len);
            let mut out = Block::<2>::new(out, column);
            let mut sink = out.append(0);
            for register in 0..list.registers::<L>() {
                cuts.store(register, list.load_next::<L>(simd, register));
            }
            for register in 0..list.registers::<L>() {
                let row = list.load::<L>(simd, register);
                let next = cuts.load::<L>(simd, register);
                let rises = row[0].lt(next[0]) & list.with_next::<L>(simd, register);
                sink.add(rises, row);
                list.keep(rises, row);
            }
            [list.kept(), sink.len()]
        }
    }

    #[test]
    fn all_instructions_keep_the_same_rows() {
        for len in [1, 2, 7, 8, 9, 15, 16, 29, 32] {
            let column = 4;
            let first = |i: usize| (i * 7 % 5) as f64;
            let mut lines = vec![CacheLine([f64::INFINITY; 8]); 2 * column + 1];
            for i in 0..len {
                lines[i / 8].0[i % 8] = first(i);
                lines[column + i / 8].0[i % 8] = i as f64;
            }
            let expected: Vec<_> = (0..len - 1)
                .filter(|&i| first(i) < first(i + 1))
                .map(|i| [first(i), i as f64])
                .collect();
            for instructions in Instructions::ALL {
                let (mut list, mut out) = (lines.clone(), vec![CacheLine::default(); 2 * column]);
                let kept = Simd::new(instructions).run(KeepRising(&mut list, len, &mut out));
                assert_eq!(kept, [expected.len(); 2], "{instructions}, {len}");
                for lines in [&list, &out] {
                    let columns = Columns::<2>::new(lines, column as u32, expected.len());
                    let rows: Vec<_> = (0..columns.len()).map(|i| columns.row(i)).collect();
                    assert_eq!(rows, expected, "{instructions}, {len}");
                }
            }
        }
    }

    #[test]
    #[should_panic(expected = "no room")]
    fn a_full_block_takes_no_row() {
        let mut lines = [CacheLine::default(); 2];
        let mut block = Block::<2>::new(&mut lines, 1);
        block
            .append(8)
            .add(Scalar::mask((), 1), [Scalar::splat((), 1.0); 2]);
    }

    #[test]
    #[should_panic(expected = "shorter than the list")]
    fn no_rows_are_read_behind_a_column() {
        Columns::<2>::new(&[CacheLine::default(); 2], 1, 9);
    }

    #[test]
    #[should_panic(expected = "do not fit")]
    fn a_block_has_all_its_lines() {
        PaddedBlock::<2>::new(&mut [CacheLine::default(); 2], 1);
    }

    #[test]
    #[should_panic(expected = "register < ")]
    fn no_register_is_read_behind_the_last_row() {
        Columns::<2>::new(&[CacheLine::default(); 2], 1, 4).load::<Scalar>((), 4);
    }
}
