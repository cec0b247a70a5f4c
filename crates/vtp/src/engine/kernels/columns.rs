//! Windows of a list as registers full of them.

use crate::engine::lanes::Lanes;
use crate::engine::store::{COLUMNS, Line};

/// As many windows as the registers have lanes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Windows<L> {
    pub(super) b0: L,
    pub(super) b1: L,
    pub(super) px: L,
    pub(super) py: L,
    pub(super) sigma: L,
}

/// The windows of a list.
#[derive(Clone, Copy, Debug)]
pub(super) struct Columns {
    start: *const f64,
    /// Numbers from one column to the next.
    stride: usize,
}

impl Columns {
    #[inline(always)]
    pub(super) fn new(block: &[Line]) -> Self {
        Self {
            start: block.as_ptr().cast(),
            stride: block.len() / COLUMNS * Line::LANES,
        }
    }

    /// The windows from number `i` on.
    ///
    /// # Safety
    ///
    /// The processor must know the instructions of `L`; the block must live, and `i` and the number
    /// of lanes lie within a column, all but the last of which may be overrun.
    #[inline(always)]
    pub(super) unsafe fn load<L: Lanes>(self, i: usize) -> Windows<L> {
        // SAFETY: promised by the caller.
        unsafe {
            let from = self.start.add(i);
            Windows {
                b0: L::load(from),
                b1: L::load(from.add(self.stride)),
                px: L::load(from.add(2 * self.stride)),
                py: L::load(from.add(3 * self.stride)),
                sigma: L::load(from.add(4 * self.stride)),
            }
        }
    }
}

/// A list to which windows are added.
#[derive(Debug)]
pub(super) struct Sink {
    start: *mut f64,
    stride: usize,
    len: usize,
}

impl Sink {
    /// For a list with `len` windows so far.
    #[inline(always)]
    pub(super) fn new(block: &mut [Line], len: usize) -> Self {
        Self {
            start: block.as_mut_ptr().cast(),
            stride: block.len() / COLUMNS * Line::LANES,
            len,
        }
    }

    /// The same windows for reading.
    #[inline(always)]
    pub(super) fn columns(&self) -> Columns {
        Columns {
            start: self.start.cast_const(),
            stride: self.stride,
        }
    }

    /// How many windows there are now.
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Adds those of `windows` that `mask` chooses.
    ///
    /// # Safety
    ///
    /// The processor must know the instructions of `L`; the block must live and have room for them.
    #[inline(always)]
    pub(super) unsafe fn add<L: Lanes>(&mut self, mask: L::Mask, windows: &Windows<L>) {
        use crate::engine::lanes::LaneMask;
        debug_assert!(self.len + mask.count() <= self.stride);
        // SAFETY: promised by the caller.
        unsafe {
            let to = self.start.add(self.len);
            if L::STORES_SOME_SLOWLY && mask.count() == L::COUNT {
                windows.b0.store(to);
                windows.b1.store(to.add(self.stride));
                windows.px.store(to.add(2 * self.stride));
                windows.py.store(to.add(3 * self.stride));
                windows.sigma.store(to.add(4 * self.stride));
                self.len += L::COUNT;
                return;
            }
            windows.b0.store_chosen(mask, to);
            windows.b1.store_chosen(mask, to.add(self.stride));
            windows.px.store_chosen(mask, to.add(2 * self.stride));
            windows.py.store_chosen(mask, to.add(3 * self.stride));
            windows.sigma.store_chosen(mask, to.add(4 * self.stride));
        }
        self.len += mask.count();
    }
}

/// The lanes of a register at window `i` that are among the first `len`.
///
/// # Safety
///
/// The processor must know the instructions of `L`.
#[inline(always)]
pub(super) unsafe fn within<L: Lanes>(i: usize, len: usize) -> L::Mask {
    use crate::engine::lanes::LaneMask;
    let left = len - i;
    let bits = if left >= 8 { u8::MAX } else { (1 << left) - 1 };
    // SAFETY: promised by the caller.
    unsafe { L::Mask::from_bits(bits) }
}
