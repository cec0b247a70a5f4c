//! Windows of a list in registers.

/// One window in each lane of the registers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Windows<L> {
    pub(super) b0: L,
    pub(super) b1: L,
    pub(super) px: L,
    pub(super) py: L,
    pub(super) sigma: L,
}

impl<L> Windows<L> {
    /// From one register of each column of a list.
    #[inline(always)]
    pub(super) fn new([b0, b1, px, py, sigma]: [L; 5]) -> Self {
        Self {
            b0,
            b1,
            px,
            py,
            sigma,
        }
    }

    /// One register of each column of a list.
    #[inline(always)]
    pub(super) fn rows(self) -> [L; 5] {
        [self.b0, self.b1, self.px, self.py, self.sigma]
    }
}
