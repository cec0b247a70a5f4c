//! Rules 2 and 3 on a whole list at once.

use super::columns::{Sink, Windows, within};
use crate::engine::lanes::{LaneMask, Lanes};
use crate::engine::store::Line;
use crate::precision::{CLEARANCE, WINS};

/// What neighbours leave of the intervals, kept from run to run.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cuts {
    /// Left and right ends after the comparison with the right neighbour, then after that with the
    /// left one.
    ends: [Vec<f64>; 4],
}

impl Cuts {
    /// Room for a list of `len` and what whole registers overrun.
    #[inline(always)]
    pub(super) fn resize(&mut self, len: usize) {
        let len = len + 2 * Line::LANES;
        for ends in &mut self.ends {
            if ends.len() < len {
                ends.resize(len.next_power_of_two(), 0.0);
            }
        }
    }

    /// Notes what is left of the windows from number `i` on, compared with their right neighbours,
    /// and of these.
    ///
    /// # Safety
    ///
    /// The processor must know the instructions of `L`, and there must be room for a list that
    /// long.
    #[inline(always)]
    pub(super) unsafe fn note<L: Lanes>(&mut self, i: usize, [of_a, of_b]: [[L; 2]; 2]) {
        let [b0_first, b1_first, b0_second, b1_second] = &mut self.ends;
        // SAFETY: promised by the caller.
        unsafe {
            of_a[0].store(b0_first.as_mut_ptr().add(i));
            of_a[1].store(b1_first.as_mut_ptr().add(i));
            of_b[0].store(b0_second.as_mut_ptr().add(i + 1));
            of_b[1].store(b1_second.as_mut_ptr().add(i + 1));
        }
    }

    /// The first window has no left neighbour.
    #[inline(always)]
    pub(super) fn open(&mut self) {
        self.ends[2][0] = f64::NEG_INFINITY;
        self.ends[3][0] = f64::INFINITY;
    }

    /// What both neighbours have left of the windows from number `i` on.
    ///
    /// # Safety
    ///
    /// As for [`note`](Self::note).
    #[inline(always)]
    pub(super) unsafe fn left<L: Lanes>(&self, i: usize) -> [L; 2] {
        let [b0_first, b1_first, b0_second, b1_second] = &self.ends;
        // SAFETY: promised by the caller.
        unsafe {
            [
                L::load(b0_first.as_ptr().add(i)).max(L::load(b0_second.as_ptr().add(i))),
                L::load(b1_first.as_ptr().add(i)).min(L::load(b1_second.as_ptr().add(i))),
            ]
        }
    }
}

/// Compares neighbours among the first `len` windows of `block`, which is followed by a line that
/// may be read and whose edge has this [`extent`](crate::precision::extent); cuts what each loses,
/// drops who has lost all, and returns how many are left.
///
/// As [`check_pair`](crate::pairs::check_pair) for windows that overlap, but all comparisons are
/// made with the windows as they came: a ray that is cut crosses a real path that is shorter, and
/// that stays true when the winner is cut elsewhere. So the comparisons need no order, and whole
/// registers of neighbours are compared at once. Windows apart are not compared (cases 3 and 6),
/// which saves next to nothing.
///
/// # Safety
///
/// The processor must know the instructions of `L`.
#[inline(always)]
pub(crate) unsafe fn compare<L: Lanes>(
    block: &mut [Line],
    len: usize,
    extent: f64,
    cuts: &mut Cuts,
) -> usize {
    cuts.resize(len);
    // The last line is only for reading behind the block.
    let own = block.len() - 1;
    let mut rest = Sink::new(&mut block[..own], 0);
    let columns = rest.columns();
    // SAFETY: the caller vouches for the processor. Windows are read up to one behind the line in
    // which the last one lies, and the scratch is longer than that.
    unsafe {
        let mut i = 0;
        while i < len {
            let a = columns.load::<L>(i);
            let b = columns.load::<L>(i + 1);
            let pairs = within::<L>(i, len - 1);
            cuts.note(i, losses::<L>(&a, &b, pairs, extent).0);
            i += L::COUNT;
        }
        cuts.open();
        let mut i = 0;
        while i < len {
            // Read before anything is written: `rest` never overtakes.
            let w = columns.load::<L>(i);
            let [b0, b1] = cuts.left::<L>(i);
            let alive = b0.lt(b1) & within::<L>(i, len);
            rest.add(alive, &Windows { b0, b1, ..w });
            i += L::COUNT;
        }
        rest.len()
    }
}

/// What is left of the intervals of `a` and of `b` after each of `pairs` has been compared, and
/// which of these do not meet.
///
/// # Safety
///
/// The processor must know the instructions of `L`.
#[inline(always)]
pub(super) unsafe fn losses<L: Lanes>(
    a: &Windows<L>,
    b: &Windows<L>,
    pairs: L::Mask,
    extent: f64,
) -> ([[L; 2]; 2], L::Mask) {
    // SAFETY: promised by the caller.
    let (zero, wins, clearance, blur) = unsafe {
        let blur = L::splat(CLEARANCE * extent);
        (L::splat(0.0), L::splat(WINS), L::splat(CLEARANCE), blur)
    };
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

/// Whether the source at `offset` from that of `w` lies clearly left, and clearly right, of the ray
/// of `w` through abscissa `x`; `size` is the size of their coordinates times the clearance.
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
