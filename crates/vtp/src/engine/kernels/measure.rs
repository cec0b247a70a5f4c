//! Pass over a list that is about to cross its face: the vertex filter, if that has not been applied
//! yet, and the shortest path to the apex.

use super::columns::{Columns, Windows, within};
use super::filter::{Filter, Gate, squares};
use crate::engine::lanes::{LaneMask, Lanes};
use crate::engine::store::Line;

/// By how much, relative to the shortest path so far, a window may seem too long and still have its
/// path measured: far more than rounding can make of it.
const LENIENCY: f64 = 1.0 + 1e-13;

/// What the pass found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Measured {
    /// Number of windows measured.
    pub(crate) len: usize,
    /// The length of the shortest path to the apex; infinite if no window is left.
    pub(crate) distance: f64,
    /// Number of the window that it belongs to, the first of equal ones.
    pub(crate) best: usize,
    /// Windows that are left.
    pub(crate) kept: usize,
    /// Windows with rays for the left and for the right exit, at most.
    pub(crate) bound: [usize; 2],
}

/// Measures the windows of `block` from `start` to `len`, those that pass the vertex filter if `FILTER` says so;
/// leaves in `keep` a bit for each window, a byte for each register, whether it is left.
///
/// With e = cy - py and D = cy·px - cx·py, a ray through abscissa s leaves to the left if
/// m(s) = s·e - D < 0: the sides of both ends of a window take no division. It offers the apex C
/// σ + |pC| if it sees it, else σ + |p s| + |s C| with s its end nearest to the ray to C. With
/// r = |p s|² (or |pC|²), w = |s C|² (or 0) and t the length to beat less σ, that is shorter if
/// u = t² - r - w > 0 and 4rw < u²; so the square roots are taken only where the shortest path
/// becomes shorter, a few times a list.
///
/// # Safety
///
/// The processor must know the instructions of `L`; if `start` is not 0 a line behind the block must be readable and
/// belong to it.
#[inline(always)]
pub(crate) unsafe fn measure<L: Lanes, const FILTER: bool>(
    block: &[Line],
    start: usize,
    len: usize,
    gate: &Gate,
    keep: &mut Vec<u8>,
) -> Measured {
    // A byte for each register, whatever its size.
    if keep.len() < len {
        keep.resize(len.next_power_of_two(), 0);
    }
    let columns = Columns::new(block);
    let mut found = Measured {
        len,
        distance: f64::INFINITY,
        best: 0,
        kept: 0,
        bound: [0; 2],
    };
    // SAFETY: the caller vouches for the processor; windows are read up to the end of the line in which the
    // last one lies, and there are no more registers than windows.
    unsafe {
        let zero = L::splat(0.0);
        let filter = Filter::<L>::new(gate);
        let (cx, cy) = (L::splat(gate.apex[0]), L::splat(gate.apex[1]));
        let cy2 = cy * cy;
        let mut limit = L::splat(f64::INFINITY);
        let mut i = start;
        while i < len {
            let windows = columns.load::<L>(i);
            let [r0, r1] = squares(&windows);
            let mut kept = within::<L>(i, len);
            if FILTER {
                kept = filter.passes(&windows, [r0, r1], zero) & kept;
            }
            *keep.get_unchecked_mut((i - start) / L::COUNT) = kept.bits();
            let Windows {
                b0,
                b1,
                px,
                py,
                sigma,
            } = windows;
            // On which side of the apex its ends pass.
            let e = cy - py;
            let d = cy * px - cx * py;
            let only_right = zero.lt(b0 * e - d);
            let only_left = (b1 * e - d).lt(zero);
            found.kept += kept.count();
            found.bound[0] += (kept & !only_right).count();
            found.bound[1] += (kept & !only_left).count();
            // Whether its path to the apex is shorter than the others'.
            let to_apex = cx - px;
            let seen = to_apex * to_apex + e * e;
            let r = L::select(only_right, r0, L::select(only_left, r1, seen));
            let bend = L::select(only_right, b0, b1);
            let beside = cx - bend;
            let w = L::select(only_right | only_left, beside * beside + cy2, zero);
            let t = limit - sigma;
            let u = t * t - r - w;
            let four = L::splat(4.0);
            let shorter = kept & zero.lt(t) & zero.lt(u) & (four * (r * w)).lt(u * u);
            if shorter.any() {
                let path = sigma + r.sqrt() + w.sqrt();
                let path = L::select(shorter, path, L::splat(f64::INFINITY));
                let least = path.least();
                if least < found.distance {
                    let first = path.le(L::splat(least)).bits().trailing_zeros();
                    found.distance = least;
                    found.best = i + first as usize;
                    limit = L::splat(least * LENIENCY);
                }
            }
            i += L::COUNT;
        }
    }
    found
}
