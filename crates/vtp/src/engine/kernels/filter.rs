//! The vertex filter, applied while lists are gathered.

use geobench_window::simd::{LaneMask, Lanes};

use super::columns::Windows;
use crate::engine::store::{Block, Columns};
use crate::precision::{MARGIN, blur};

/// The factor of a path through a vertex before the comparison with a window.
pub(crate) const LOSES: f64 = 1.0 + MARGIN;

/// The half-edge of a list, with the values that the passes over the list need.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gate {
    /// Length of the half-edge.
    pub(crate) l: f64,
    /// Position of the apex.
    pub(crate) apex: [f64; 2],
    /// Known distances of the tail and the head.
    pub(crate) ends: [f64; 2],
    /// The longest edge of the mesh, to which rounding may be relative.
    pub(crate) longest: f64,
}

/// The vertex filter on one half-edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Filter<L> {
    tail: L,
    head: L,
}

impl<L: Lanes> Filter<L> {
    #[inline(always)]
    pub(super) fn new(simd: L::Token, gate: &Gate) -> Self {
        let [tail, head] = gate.ends.map(|d| d * LOSES + blur(gate.longest));
        Self {
            tail: L::splat(simd, tail),
            head: L::splat(simd, head + gate.l),
        }
    }

    /// The windows that no path along the edge from one of its ends beats at their far end. A
    /// window beaten there is beaten everywhere (Xin and Wang 2009, theorem 3.2). `squares` are the
    /// squared distances from the sources to both ends of the windows.
    #[inline(always)]
    pub(super) fn passes(&self, w: &Windows<L>, squares: [L; 2], zero: L) -> L::Mask {
        let (from_tail, from_head) = (self.tail - w.sigma + w.b1, self.head - w.sigma - w.b0);
        zero.le(from_tail.min(from_head))
            & squares[1].le(from_tail * from_tail)
            & squares[0].le(from_head * from_head)
    }
}

/// The squared distances from the sources to both ends of the windows.
#[inline(always)]
pub(super) fn squares<L: Lanes>(w: &Windows<L>) -> [L; 2] {
    let py2 = w.py * w.py;
    let (x0, x1) = (w.b0 - w.px, w.b1 - w.px);
    [x0 * x0 + py2, x1 * x1 + py2]
}

/// Writes the windows of `lists` that pass the filter into `hand`, one list after the other.
/// Returns their number.
#[inline(always)]
pub(crate) fn gather<L: Lanes>(
    simd: L::Token,
    lists: [Columns<'_>; 2],
    gate: &Gate,
    active: &mut Block<'_>,
) -> usize {
    let mut rest = active.append(0);
    let zero = L::splat(simd, 0.0);
    let filter = Filter::<L>::new(simd, gate);
    for list in lists {
        for register in 0..list.registers::<L>() {
            let w = Windows::new(list.load::<L>(simd, register));
            let listed = list.listed::<L>(simd, register);
            let passed = filter.passes(&w, squares(&w), zero) & listed;
            if passed.any() {
                rest.add(passed, w.rows());
            }
        }
    }
    rest.len()
}
