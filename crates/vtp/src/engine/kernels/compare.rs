//! Rules 2 and 3 on a whole list at once.

use geobench_window::simd::{CacheLine, LaneMask, Lanes, Scratch};

use super::columns::Windows;
use crate::engine::store::PaddedBlock;
use crate::precision::{CLEARANCE, WINS};

/// Scratch for the comparison of neighbours, reused from list to list: the ends of the intervals
/// that each comparison leaves.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cuts {
    /// After the comparison with the right neighbour.
    by_right: Vec<CacheLine>,
    /// After the comparison with the left neighbour.
    by_left: Vec<CacheLine>,
}

impl Cuts {
    /// The scratch for a list of `len` windows.
    #[inline(always)]
    pub(super) fn of(&mut self, len: usize) -> ListCuts<'_> {
        let lines = 2 * (len / CacheLine::LANES + 2);
        if self.by_left.len() < lines {
            self.by_right.resize(2 * lines, CacheLine::default());
            self.by_left.resize(2 * lines, CacheLine::default());
        }
        ListCuts {
            by_right: Scratch::new(&mut self.by_right, len),
            by_left: Scratch::new(&mut self.by_left, len),
        }
    }
}

/// The scratch for one list.
pub(super) struct ListCuts<'a> {
    by_right: Scratch<'a, 2>,
    by_left: Scratch<'a, 2>,
}

impl ListCuts<'_> {
    /// Stores what the comparison with right neighbours leaves of the windows of a register, and of
    /// these neighbours.
    #[inline(always)]
    pub(super) fn note<L: Lanes>(&mut self, register: usize, [of_a, of_b]: [[L; 2]; 2]) {
        self.by_right.store(register, of_a);
        self.by_left.store_next(register, of_b);
    }

    /// Sets the entry of the first window, which has no left neighbour.
    #[inline(always)]
    pub(super) fn open(&mut self) {
        self.by_left.set_row(0, [f64::NEG_INFINITY, f64::INFINITY]);
    }

    /// What both comparisons leave of the windows of a register.
    #[inline(always)]
    pub(super) fn left<L: Lanes>(&self, simd: L::Token, register: usize) -> [L; 2] {
        let by_right = self.by_right.load::<L>(simd, register);
        let by_left = self.by_left.load::<L>(simd, register);
        [by_right[0].max(by_left[0]), by_right[1].min(by_left[1])]
    }
}

/// Compares neighbours among the first `len` windows of `block`, whose sources err by this
/// [`blur`](crate::precision::blur). Cuts each by its losses, drops windows that have lost
/// everything, and returns the number of windows left.
///
/// As [`check_pair`](crate::pairs::check_pair) for windows that overlap, but all comparisons use
/// the windows as they were before any cut. A ray is cut because it crosses a shorter real path.
/// That stays true if the winner is cut elsewhere. So comparisons need no order, and whole
/// registers of neighbours are compared at once. Disjoint windows are not compared (cases 3 and 6),
/// which would save next to nothing.
#[inline(always)]
pub(crate) fn compare<L: Lanes>(
    simd: L::Token,
    mut block: PaddedBlock<'_>,
    len: usize,
    blur: f64,
    cuts: &mut Cuts,
) -> usize {
    let mut list = block.in_place(len);
    let mut cuts = cuts.of(len);
    let registers = list.registers::<L>();
    for register in 0..registers {
        let a = Windows::new(list.load::<L>(simd, register));
        let b = Windows::new(list.load_next::<L>(simd, register));
        let pairs = list.with_next::<L>(simd, register);
        let (left, _) = losses::<L>(simd, &a, &b, pairs, blur);
        cuts.note::<L>(register, left);
    }
    cuts.open();
    for register in 0..registers {
        // Loaded before anything is stored: fewer windows have been kept than loaded.
        let w = Windows::new(list.load::<L>(simd, register));
        let [b0, b1] = cuts.left::<L>(simd, register);
        let alive = b0.lt(b1) & list.listed::<L>(simd, register);
        list.keep(alive, Windows { b0, b1, ..w }.rows());
    }
    list.kept()
}

/// What the comparison of each of `pairs` leaves of the intervals of `a` and `b`, and which pairs
/// are disjoint.
#[inline(always)]
pub(super) fn losses<L: Lanes>(
    simd: L::Token,
    a: &Windows<L>,
    b: &Windows<L>,
    pairs: L::Mask,
    blur: f64,
) -> ([[L; 2]; 2], L::Mask) {
    let (zero, wins) = (L::splat(simd, 0.0), L::splat(simd, WINS));
    let (clearance, blur) = (L::splat(simd, CLEARANCE), L::splat(simd, blur));
    let (mut of_a, mut of_b) = ([a.b0, a.b1], [b.b0, b.b1]);
    let (lo, hi) = (a.b0.max(b.b0), a.b1.min(b.b1));
    let overlap = pairs & lo.le(hi);
    let apart = pairs & !overlap;
    if !overlap.any() {
        return ([of_a, of_b], apart);
    }
    let (dx, dy) = (b.px - a.px, b.py - a.py);
    let size = clearance * (a.px.abs() + a.py.abs() + b.px.abs() + b.py.abs()) + blur;
    let (back_x, back_y) = (zero - dx, zero - dy);
    let b_left_of_a = side(a, a.b0, [dx, dy], size, zero)[0];
    let b_right_of_a = side(a, a.b1, [dx, dy], size, zero)[1];
    let a_left_of_b = side(b, b.b0, [back_x, back_y], size, zero)[0];
    let a_right_of_b = side(b, b.b1, [back_x, back_y], size, zero)[1];
    for x in [lo, hi] {
        let [left, right] = side(a, x, [dx, dy], size, zero);
        let cut_a = [left & b_left_of_a, right & b_right_of_a];
        let [left, right] = side(b, x, [back_x, back_y], size, zero);
        let cut_b = [left & a_left_of_b, right & a_right_of_b];
        if !(overlap & (cut_a[0] | cut_a[1] | cut_b[0] | cut_b[1])).any() {
            continue;
        }
        let (to_a, to_b) = (length(a, x), length(b, x));
        let a_wins = overlap & to_a.lt(to_b * wins - blur);
        let b_wins = overlap & to_b.lt(to_a * wins - blur);
        of_a[0] = L::select(b_wins & cut_a[0], of_a[0].max(x), of_a[0]);
        of_a[1] = L::select(b_wins & cut_a[1], of_a[1].min(x), of_a[1]);
        of_b[0] = L::select(a_wins & cut_b[0], of_b[0].max(x), of_b[0]);
        of_b[1] = L::select(a_wins & cut_b[1], of_b[1].min(x), of_b[1]);
    }
    ([of_a, of_b], apart)
}

/// The lanes in which the source at `offset` from that of `w` is clearly left, and clearly right,
/// of the ray of `w` through abscissa `x`. `size` is the size of the coordinates times the
/// clearance.
#[inline(always)]
pub(super) fn side<L: Lanes>(
    w: &Windows<L>,
    x: L,
    offset: [L; 2],
    size: L,
    zero: L,
) -> [L::Mask; 2] {
    let along = x - w.px;
    let area = along * offset[1] + w.py * offset[0];
    let doubt = size * (along.abs() + w.py.abs());
    [doubt.lt(area), area.lt(zero - doubt)]
}

/// The lengths of the paths of `w` to abscissa `x`.
#[inline(always)]
pub(super) fn length<L: Lanes>(w: &Windows<L>, x: L) -> L {
    let along = x - w.px;
    w.sigma + (along * along + w.py * w.py).sqrt()
}
