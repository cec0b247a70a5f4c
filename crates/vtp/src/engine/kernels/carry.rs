//! The last pass over a list: propagates its windows across the face, through the exits that a rule
//! allows.

use geobench_window::simd::{LaneMask, Lanes};

use super::columns::Windows;
use super::exits::{EnteringRays, Rule, Sides};
use crate::engine::store::{Block, Columns};

/// Bounds within which the product of two divisors can be inverted without loss of precision.
const INVERTIBLE: [f64; 2] = [1e-280, 1e280];

/// The triangle that the windows cross, in the frame of the entered half-edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    /// Length of the half-edge AB.
    pub(crate) l: f64,
    /// Lengths of AC and CB.
    pub(crate) exits: [f64; 2],
    /// Position of the apex C.
    pub(crate) apex: [f64; 2],
    /// Unit vectors from A to C and from C to B.
    pub(crate) directions: [[f64; 2]; 2],
}

impl Triangle {
    /// The source image of a window in the frame of its children behind AC (0) or CB (1). The
    /// arithmetic, and so every bit, is that of [`carry`].
    #[inline]
    pub(crate) fn source_beyond(&self, side: usize, [px, py]: [f64; 2]) -> [f64; 2] {
        let [ux, uy] = self.directions[side];
        let [x, y] = match side {
            0 => [px, py],
            _ => [px - self.apex[0], py - self.apex[1]],
        };
        [ux * x + uy * y, -(ux * y - uy * x).abs()]
    }
}

/// The list behind an exit.
#[derive(Debug)]
pub(crate) struct Target<'a> {
    /// Its block, with room for all windows that may arrive.
    pub(crate) block: Block<'a>,
    /// Number of windows in the list, updated by [`carry`].
    pub(crate) len: usize,
    /// Whether there is a face behind the exit.
    pub(crate) open: bool,
}

/// Counts of [`carry`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Carried {
    /// Children tried, including empty ones.
    pub(crate) tried: usize,
    /// Children narrower than the threshold, which were dropped.
    pub(crate) tiny: usize,
}

/// Propagates the windows of `list` whose bits are set in `keep` across `triangle`, as far as
/// `rule` allows. Children of at least the width `threshold` are appended to the targets behind AC
/// and CB. `keep` comes from [`measure`](super::measure()), and the targets have room for its
/// bounds.
///
/// With e, D and m(s) as in [`measure`](super::measure()), the ray through abscissa s divides AC as
/// n : |m(s)| with n = -py·s, and BC as n : |m(s)| with n = -py·(l - s), from the ends that they
/// share with the half-edge. Neither part is negative, so their sum has no cancellation, however
/// close the source is to the half-edge. Each end of a window leaves through one exit. Both ends
/// take two divisions, which are computed as one: 1/(d₀d₁).
#[inline(always)]
#[allow(clippy::needless_range_loop)] // As in `geobench_window::simd`, without iterators.
#[allow(clippy::too_many_arguments)] // The parts of one crossing, which its callers hold apart.
#[allow(clippy::too_many_lines)] // One straight line of arithmetic, which parts would not make clearer.
pub(crate) fn carry<L: Lanes, R: Rule>(
    simd: L::Token,
    list: Columns<'_>,
    keep: &[u8],
    triangle: &Triangle,
    rule: &R,
    threshold: f64,
    [left, right]: [&mut Target<'_>; 2],
) -> Carried {
    let mut to_left = left.block.append(left.len);
    let mut to_right = right.block.append(right.len);
    let mut carried = Carried::default();
    let (zero, threshold) = (L::splat(simd, 0.0), L::splat(simd, threshold));
    let open_left = L::mask(simd, if left.open { u8::MAX } else { 0 });
    let open_right = L::mask(simd, if right.open { u8::MAX } else { 0 });
    let (cx, cy) = (
        L::splat(simd, triangle.apex[0]),
        L::splat(simd, triangle.apex[1]),
    );
    let (la, lb) = (
        L::splat(simd, triangle.exits[0]),
        L::splat(simd, triangle.exits[1]),
    );
    let l = L::splat(simd, triangle.l);
    let registers = list.registers::<L>();
    let keep = &keep[..registers];
    for register in 0..registers {
        let windows = Windows::new(list.load::<L>(simd, register));
        let Windows {
            b0,
            b1,
            px,
            py,
            sigma,
        } = windows;
        let kept = L::mask(simd, keep[register]);
        let e = cy - py;
        let d = cy * px - cx * py;
        let (m0, m1) = (b0 * e - d, b1 * e - d);
        let starts_left = m0.lt(zero);
        let ends_left = m1.lt(zero);
        let Sides { tried, cut, limits } = rule.sides(
            simd,
            &EnteringRays {
                windows,
                kept,
                e,
                d,
            },
        );
        let tried = [tried[0] & open_left, tried[1] & open_right];
        carried.tried += tried[0].count() + tried[1].count();
        let go_left = tried[0] & starts_left;
        let go_right = tried[1] & zero.lt(m1);
        let (cut_left, cut_right) = (go_left & cut[0], go_right & cut[1]);
        // The positions at which both ends arrive, each at its own exit.
        let depth = zero - py;
        let (from_corner0, from_corner1) = (
            depth * L::select(starts_left, b0, l - b0),
            depth * L::select(ends_left, b1, l - b1),
        );
        let (from_apex0, from_apex1) = (m0.abs(), m1.abs());
        let n0 = L::select(starts_left, la * from_corner0, lb * from_apex0);
        let d0 = from_corner0 + from_apex0;
        let n1 = L::select(ends_left, la * from_corner1, lb * from_apex1);
        let d1 = from_corner1 + from_apex1;
        let [q0, q1] = quotients::<L>(simd, [n0, n1], [d0, d1], go_left | go_right);
        let left_start = q0.max(zero);
        let mut left_end = L::select(ends_left, q1.min(la), la);
        let mut right_start = L::select(starts_left, zero, q0.max(zero));
        let right_end = q1.min(lb);
        if (cut_left | cut_right).any() {
            let [s, t] = limits;
            let (n, m) = (depth * s, (s * e - d).abs());
            let cut = (la * n / (n + m)).min(la);
            left_end = L::select(cut_left, cut, left_end);
            let (n, m) = (depth * (l - t), (t * e - d).abs());
            let cut = (lb * m / (n + m)).max(zero);
            right_start = L::select(cut_right, cut, right_start);
        }
        if go_left.any() {
            let (ux, uy) = (
                L::splat(simd, triangle.directions[0][0]),
                L::splat(simd, triangle.directions[0][1]),
            );
            let children = Windows {
                b0: left_start,
                b1: left_end,
                px: ux * px + uy * py,
                py: (ux * py - uy * px).minus_abs(),
                sigma,
            };
            let arrive = go_left & left_start.lt(left_end);
            let tiny = arrive & (left_end - left_start).lt(threshold);
            carried.tiny += tiny.count();
            to_left.add(arrive & !tiny, children.rows());
        }
        if go_right.any() {
            let (vx, vy) = (
                L::splat(simd, triangle.directions[1][0]),
                L::splat(simd, triangle.directions[1][1]),
            );
            let (x, y) = (px - cx, py - cy);
            let children = Windows {
                b0: right_start,
                b1: right_end,
                px: vx * x + vy * y,
                py: (vx * y - vy * x).minus_abs(),
                sigma,
            };
            let arrive = go_right & right_start.lt(right_end);
            let tiny = arrive & (right_end - right_start).lt(threshold);
            carried.tiny += tiny.count();
            to_right.add(arrive & !tiny, children.rows());
        }
    }
    let lens = [to_left.len(), to_right.len()];
    [left.len, right.len] = lens;
    carried
}

/// Both quotients, with one division if the product of the divisors allows it.
///
/// The product leaves the range of `f64` only in faces without area. There each quotient has its
/// own division. `wanted` are the lanes whose results are used.
#[inline(always)]
fn quotients<L: Lanes>(simd: L::Token, n: [L; 2], d: [L; 2], wanted: L::Mask) -> [L; 2] {
    let product = d[0] * d[1];
    let one = L::splat(simd, 1.0);
    let [least, most] = INVERTIBLE;
    let (least, most) = (L::splat(simd, least), L::splat(simd, most));
    let inverse = one / product;
    let quotients = [n[0] * d[1] * inverse, n[1] * d[0] * inverse];
    let invertible = least.lt(product) & product.lt(most);
    if !(wanted & !invertible).any() {
        return quotients;
    }
    [
        L::select(invertible, quotients[0], n[0] / d[0]),
        L::select(invertible, quotients[1], n[1] / d[1]),
    ]
}
