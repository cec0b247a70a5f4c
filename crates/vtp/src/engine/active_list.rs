//! The list that crosses its face next.

use geobench_window::Window;
use geobench_window::simd::{CacheLine, Lanes};

use super::kernels::{Cuts, Gate, Measured, gather, measure};
use super::store::{Block, COLUMNS, Columns, PaddedBlock, as_window};

/// A list taken from its half-edge, in its own block, with the scratch memory of the passes over
/// it.
#[derive(Clone, Debug)]
pub(crate) struct ActiveList {
    /// A block and one more line behind it.
    lines: Vec<CacheLine>,
    /// Lines of each column.
    column: u32,
    pub(crate) len: usize,
    /// Scratch for the comparison of neighbours.
    cuts: Cuts,
    again: Vec<u8>,
    /// One bit for each window: whether it is propagated.
    pub(crate) keep: Vec<u8>,
    /// Scratch for comparisons that have no vector form.
    pub(crate) windows: Vec<Window>,
}

impl ActiveList {
    pub(crate) fn new() -> Self {
        Self {
            lines: vec![CacheLine::default(); COLUMNS * 17 + 1],
            column: 17,
            len: 0,
            cuts: Cuts::default(),
            again: Vec::new(),
            keep: Vec::new(),
            windows: Vec::new(),
        }
    }

    /// Replaces the content by the windows of `lists` that pass the vertex filter.
    #[inline(always)]
    pub(crate) fn take<L: Lanes>(&mut self, simd: L::Token, lists: [Columns<'_>; 2], gate: &Gate) {
        self.make_room(lists[0].len() + lists[1].len());
        let mut block = Block::new(&mut self.lines, self.column);
        self.len = gather::<L>(simd, lists, gate, &mut block);
    }

    /// Measures all windows.
    #[inline(always)]
    pub(crate) fn measure<L: Lanes>(&mut self, simd: L::Token, gate: &Gate) -> Measured {
        let list = Columns::new(&self.lines, self.column, self.len);
        measure::<L, false>(simd, list, 0, gate, &mut self.keep)
    }

    /// Makes room for `windows`. Columns have an odd number of lines; with an even number, columns
    /// would compete for the same cache sets.
    #[inline]
    fn make_room(&mut self, windows: usize) {
        let lines = windows.div_ceil(CacheLine::LANES) + 1;
        if lines > self.column as usize {
            self.column = 2 * lines as u32 + 1;
            let all = COLUMNS * self.column as usize + 1;
            self.lines.resize(all, CacheLine::default());
        }
    }

    /// The block with a line behind it, and the scratch for the comparison of neighbours.
    #[inline]
    pub(crate) fn parts(&mut self) -> (PaddedBlock<'_>, &mut Cuts, &mut Vec<u8>) {
        let block = PaddedBlock::new(&mut self.lines, self.column);
        (block, &mut self.cuts, &mut self.again)
    }

    /// The windows.
    #[inline]
    pub(crate) fn columns(&self) -> Columns<'_> {
        Columns::new(&self.lines, self.column, self.len)
    }

    /// Window number `i`.
    #[inline]
    pub(crate) fn window(&self, i: usize) -> Window {
        as_window(self.columns().row(i))
    }

    /// All windows.
    pub(crate) fn iter(&self) -> impl Iterator<Item = Window> {
        (0..self.len).map(|i| self.window(i))
    }

    /// Replaces all windows by `windows`.
    pub(crate) fn replace(&mut self, windows: &[Window]) {
        self.make_room(windows.len());
        self.len = windows.len();
        for (i, w) in windows.iter().enumerate() {
            for (c, x) in [w.b0, w.b1, w.px, w.py, w.sigma].into_iter().enumerate() {
                self.lines[c * self.column as usize + i / CacheLine::LANES].0
                    [i % CacheLine::LANES] = x;
            }
        }
    }
}
