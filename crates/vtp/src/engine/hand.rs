//! The list that is about to cross its face.

use geobench_window::Window;

use super::kernels::{Cuts, Gate, Measured, gather, measure};
use super::lanes::Lanes;
use super::store::{COLUMNS, Line};

/// A list taken from the half-edge on which it waited, in a block of its own, with what the passes
/// over it need.
#[derive(Clone, Debug)]
pub(crate) struct Hand {
    lines: Vec<Line>,
    pub(crate) len: usize,
    /// Scratch of the comparison of neighbours.
    cuts: Cuts,
    again: Vec<u8>,
    /// Which windows are carried on.
    pub(crate) keep: Vec<u8>,
    /// Windows one by one, for comparisons that have no vector form.
    pub(crate) windows: Vec<Window>,
}

impl Hand {
    pub(crate) fn new() -> Self {
        Self {
            lines: vec![Line::default(); COLUMNS * 17 + 1],
            len: 0,
            cuts: Cuts::default(),
            again: Vec::new(),
            keep: Vec::new(),
            windows: Vec::new(),
        }
    }

    /// Takes the windows of `lists`, blocks with their lengths, that pass the vertex filter.
    ///
    /// # Safety
    ///
    /// The processor must know the instructions of `L`.
    #[allow(unsafe_code)] // For a processor with the instructions of `L`, which only the caller knows.
    #[inline(always)]
    pub(crate) unsafe fn take<L: Lanes>(&mut self, lists: [(&[Line], usize); 2], gate: &Gate) {
        self.make_room(lists[0].1 + lists[1].1);
        let own = self.lines.len() - 1;
        // SAFETY: the processor is the caller's business, and there is room.
        self.len = unsafe { gather::<L>(lists, gate, &mut self.lines[..own]) };
    }

    /// Measures all windows.
    ///
    /// # Safety
    ///
    /// The processor must know the instructions of `L`.
    #[allow(unsafe_code)] // For a processor with the instructions of `L`, which only the caller knows.
    #[inline(always)]
    pub(crate) unsafe fn measure<L: Lanes>(&mut self, gate: &Gate) -> Measured {
        let own = self.lines.len() - 1;
        // SAFETY: promised by the caller.
        unsafe { measure::<L, false>(&self.lines[..own], 0, self.len, gate, &mut self.keep) }
    }

    /// Room for `windows`, in columns of an odd number of lines: those of an even number would
    /// share cache lines.
    #[inline]
    fn make_room(&mut self, windows: usize) {
        let lines = windows.div_ceil(Line::LANES) + 1;
        if COLUMNS * lines >= self.lines.len() {
            self.lines
                .resize(COLUMNS * (2 * lines + 1) + 1, Line::default());
        }
    }

    /// The block with a line behind it, and scratch for the comparison of neighbours.
    #[inline]
    pub(crate) fn parts(&mut self) -> (&mut [Line], &mut Cuts, &mut Vec<u8>) {
        (&mut self.lines, &mut self.cuts, &mut self.again)
    }

    /// The block.
    #[inline]
    pub(crate) fn block(&self) -> &[Line] {
        &self.lines[..self.lines.len() - 1]
    }

    /// Window number `i`.
    #[inline]
    pub(crate) fn window(&self, i: usize) -> Window {
        let column = self.lines.len() / COLUMNS;
        let at = |c: usize| self.lines[c * column + i / Line::LANES].0[i % Line::LANES];
        Window {
            b0: at(0),
            b1: at(1),
            px: at(2),
            py: at(3),
            sigma: at(4),
        }
    }

    /// All windows.
    pub(crate) fn iter(&self) -> impl Iterator<Item = Window> {
        (0..self.len).map(|i| self.window(i))
    }

    /// Puts `windows` in the place of all.
    pub(crate) fn replace(&mut self, windows: &[Window]) {
        self.make_room(windows.len());
        self.len = windows.len();
        let column = self.lines.len() / COLUMNS;
        for (i, w) in windows.iter().enumerate() {
            for (c, x) in [w.b0, w.b1, w.px, w.py, w.sigma].into_iter().enumerate() {
                self.lines[c * column + i / Line::LANES].0[i % Line::LANES] = x;
            }
        }
    }
}
