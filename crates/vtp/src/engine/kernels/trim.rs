//! Overlapping neighbours cut at their tie points, as in MMP.

use super::columns::Windows;
use super::compare::length;
use crate::precision::WINS;
use crate::trim::ON_EDGE;
use geobench_window::simd::{LaneMask, Lanes};

/// What is `left` of the intervals of neighbours `a` and `b` after each of `pairs` gives up the
/// ranges of their overlap on which the other is shorter. Also returns the pairs for which the list
/// would have to be rebuilt: one window would be left in several pieces, or both in the wrong
/// order.
///
/// This is the vector form of [`trim_pair`](crate::trim::trim_pair), with the formulas of
/// [`geobench_window::tie_points`].
#[inline(always)]
pub(super) fn trim<L: Lanes>(
    simd: L::Token,
    a: &Windows<L>,
    b: &Windows<L>,
    pairs: L::Mask,
    l: f64,
    left: [[L; 2]; 2],
) -> ([[L; 2]; 2], L::Mask) {
    let [[a0, a1], [b0, b1]] = left;
    let (lo, hi) = (a0.max(b0), a1.min(b1));
    let (on_edge, margin, half) = (
        L::splat(simd, -ON_EDGE * l),
        L::splat(simd, WINS),
        L::splat(simd, 0.5),
    );
    let overlap = pairs & a0.lt(a1) & b0.lt(b1) & lo.lt(hi) & a.py.max(b.py).le(on_edge);
    if !overlap.any() {
        return (left, overlap);
    }
    let ties = ties(simd, a, b);
    // A tie outside the overlap gives an empty range at its start.
    let t = L::select(lo.lt(ties[0]) & ties[0].lt(hi), ties[0], lo);
    let u = L::select(lo.lt(ties[1]) & ties[1].lt(hi), ties[1], lo);
    let stretches = [[lo, t.min(u)], [t.min(u), t.max(u)], [t.max(u), hi]];
    let mut empty = [overlap; 3];
    let (mut lost_by_a, mut lost_by_b) = ([overlap; 3], [overlap; 3]);
    for (i, [from, to]) in stretches.into_iter().enumerate() {
        let middle = half * (from + to);
        let (to_a, to_b) = (length(a, middle), length(b, middle));
        let wide = overlap & from.lt(to);
        empty[i] = !wide;
        lost_by_a[i] = wide & to_b.lt(to_a * margin);
        lost_by_b[i] = wide & to_a.lt(to_b * margin);
    }
    let (of_a, a_parted) = rest::<L>([a0, a1], &stretches, empty, lost_by_a);
    let (of_b, b_parted) = rest::<L>([b0, b1], &stretches, empty, lost_by_b);
    let left = [
        [
            L::select(overlap, of_a[0], a0),
            L::select(overlap, of_a[1], a1),
        ],
        [
            L::select(overlap, of_b[0], b0),
            L::select(overlap, of_b[1], b1),
        ],
    ];
    let disordered = of_b[0].lt(of_a[0]) & of_a[0].lt(of_a[1]) & of_b[0].lt(of_b[1]);
    (left, overlap & (a_parted | b_parted | disordered))
}

/// The rest of an interval with three consecutive ranges in it, of which those in `lost` are lost
/// and some may be `empty`, and whether a lost range splits the interval.
#[inline(always)]
fn rest<L: Lanes>(
    [start, end]: [L; 2],
    stretches: &[[L; 2]; 3],
    empty: [L::Mask; 3],
    lost: [L::Mask; 3],
) -> ([L; 2], L::Mask) {
    let (lo, hi) = (stretches[0][0], stretches[2][1]);
    let (mut first, mut last) = (hi, lo);
    for i in [2, 1, 0] {
        first = L::select(empty[i] | lost[i], first, stretches[i][0]);
    }
    for i in [0, 1, 2] {
        last = L::select(empty[i] | lost[i], last, stretches[i][1]);
    }
    let first = L::select(start.lt(lo), start, first);
    let last = L::select(hi.lt(end), end, last);
    let mut parted = lost[0] & first.le(lo) & stretches[0][1].le(last);
    parted = parted | (lost[1] & first.le(stretches[1][0]) & stretches[1][1].le(last));
    parted = parted | (lost[2] & first.le(stretches[2][0]) & hi.le(last));
    ([first, last], parted)
}

/// The two abscissae at which windows tie; infinite or NaN where there are fewer.
#[inline(always)]
fn ties<L: Lanes>(simd: L::Token, w0: &Windows<L>, w1: &Windows<L>) -> [L; 2] {
    let (zero, half, none) = (
        L::splat(simd, 0.0),
        L::splat(simd, 0.5),
        L::splat(simd, f64::INFINITY),
    );
    let a = w1.px - w0.px;
    let delta = w1.sigma - w0.sigma;
    let y1 = w1.py;
    let leading = (a - delta) * (a + delta);
    let b = half * (leading + (w0.py - y1) * (w0.py + y1));
    // A negative radicand gives NaN, which counts as no tie.
    let root = delta * (b * b + leading * y1 * y1).sqrt();
    let middle = zero - a * b;
    let numerators = [middle + root, middle - root];
    let product = (b - delta * y1) * (b + delta * y1);
    let no_delta = delta.le(zero) & zero.le(delta);
    let mut ties = [none; 2];
    for s in 0..2 {
        let (own, other) = (numerators[s], numerators[1 - s]);
        let direct = other.abs().le(own.abs());
        let u = L::select(direct, own, product) / L::select(direct, leading, other);
        let scaled = a * u + b;
        let valid = zero.le(scaled * delta) & zero.le((delta * delta + scaled) * delta);
        ties[s] = L::select(valid, w1.px + u, none);
    }
    let bisector = w1.px - b / a;
    [
        L::select(no_delta, bisector, ties[0]),
        L::select(no_delta, none, ties[1]),
    ]
}
