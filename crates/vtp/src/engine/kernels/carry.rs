//! Last pass over a list: its windows cross the face, each through the exits that rule 1 leaves it.

use super::columns::{Columns, Sink, Windows};
use crate::engine::lanes::{LaneMask, Lanes};
use crate::engine::store::Line;

/// By how far, as a fraction of the half-edge, rays must lie beyond the best path before rule 1 cuts
/// them: rounding must not, and any such value is safe.
const SLACK: f64 = 1e-12;

/// Fraction of the coordinates' size by which a point must lie off a ray to count as beside it.
pub(super) const CLEARANCE: f64 = 1e-12;

/// Products of two divisors within these bounds can be inverted without loss.
const INVERTIBLE: [f64; 2] = [1e-280, 1e280];

/// The triangle that the windows cross, seen from the half-edge through which they enter.
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

/// The shortest path of a list to the apex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BestPath {
    /// Where it crosses the half-edge.
    pub(crate) entry: f64,
    /// Where it comes from.
    pub(crate) source: [f64; 2],
}

impl BestPath {
    /// The path of window `i` of `block` to `apex`.
    #[inline(always)]
    pub(crate) fn of(block: &[Line], i: usize, apex: [f64; 2]) -> Self {
        let column = block.len() / crate::engine::store::COLUMNS;
        let at = |c: usize| block[c * column + i / Line::LANES].0[i % Line::LANES];
        let [b0, b1, px, py] = [at(0), at(1), at(2), at(3)];
        let sp = (apex[1] * px - apex[0] * py) / (apex[1] - py);
        Self {
            entry: if sp < b0 {
                b0
            } else if sp > b1 {
                b1
            } else {
                sp
            },
            source: [px, py],
        }
    }
}

/// A list behind an exit.
#[derive(Debug)]
pub(crate) struct Target<'a> {
    /// Its block, with room for all the windows that may come.
    pub(crate) block: &'a mut [Line],
    /// Windows that it has; afterwards those that it has then.
    pub(crate) len: usize,
    /// Whether there is anything behind the exit.
    pub(crate) open: bool,
}

/// Takes those of the first `len` windows of `block` for which `keep` has bits across `triangle`, and adds what arrives to
/// the targets behind AC and CB. Returns how many children were tried.
///
/// With e, D and m(s) as in [`measure`](super::measure()) and w(s) = D - cy·s, the ray through abscissa s
/// meets AC at -la·py·s / w(s) from A, and CB at lb·m(s) / (-l·py - w(s)) from C. Each end of a window
/// leaves through one exit, so both ends take two divisions, which are made as one: 1/(w₀w₁).
///
/// Rule 1: let S be where the best path enters and p₀ its source. Rays left of S only go left, those
/// right of S only right; and of a window that splits beyond S the rest goes as well if the best path
/// has crossed it before S (see `sides.rs` for the plain form, with the proof).
///
/// # Safety
///
/// The processor must know the instructions of `L`; `keep` must come from
/// [`measure`](super::measure()) for the same block, and the targets have room for its bounds.
#[inline(always)]
#[allow(clippy::too_many_lines)] // One straight line of arithmetic, which parts would not make clearer.
pub(crate) unsafe fn carry<L: Lanes>(
    block: &[Line],
    len: usize,
    keep: &[u8],
    triangle: &Triangle,
    best: &BestPath,
    [left, right]: [&mut Target<'_>; 2],
) -> usize {
    let columns = Columns::new(block);
    let mut to_left = Sink::new(left.block, left.len);
    let mut to_right = Sink::new(right.block, right.len);
    let mut tried = 0;
    // SAFETY: the caller vouches for the processor, for `block` and for room in the targets.
    unsafe {
        let zero = L::splat(0.0);
        let open_left = L::Mask::from_bits(if left.open { u8::MAX } else { 0 });
        let open_right = L::Mask::from_bits(if right.open { u8::MAX } else { 0 });
        let (cx, cy) = (L::splat(triangle.apex[0]), L::splat(triangle.apex[1]));
        let (la, lb) = (L::splat(triangle.exits[0]), L::splat(triangle.exits[1]));
        let (minus_l, minus_la) = (L::splat(-triangle.l), L::splat(-triangle.exits[0]));
        let entry = L::splat(best.entry);
        let slack = SLACK * triangle.l;
        let before = L::splat(best.entry - slack);
        let behind = L::splat(best.entry + slack);
        for (register, &kept) in keep[..len.div_ceil(L::COUNT)].iter().enumerate() {
            let Windows {
                b0,
                b1,
                px,
                py,
                sigma,
            } = columns.load::<L>(register * L::COUNT);
            let kept = L::Mask::from_bits(kept);
            let e = cy - py;
            let d = cy * px - cx * py;
            let (m0, m1) = (b0 * e - d, b1 * e - d);
            let starts_left = m0.lt(zero);
            let ends_left = m1.lt(zero);
            let mut go_left = kept & starts_left & open_left;
            let mut go_right = kept & zero.lt(m1) & open_right;
            // Rule 1.
            let mut cut_right = go_right & b0.lt(before) & d.lt(before * e);
            let mut cut_left = go_left & behind.lt(b1) & (behind * e).lt(d);
            // Most of these lie wholly on the other side.
            go_right = go_right & !(cut_right & b1.le(before));
            go_left = go_left & !(cut_left & behind.le(b0));
            cut_right = cut_right & go_right;
            cut_left = cut_left & go_left;
            if (cut_left | cut_right).any() {
                let [crossed_left, crossed_right] = crossed::<L>(b0, b1, px, py, best);
                go_right = go_right & !(cut_right & crossed_right);
                go_left = go_left & !(cut_left & crossed_left);
                cut_right = cut_right & go_right;
                cut_left = cut_left & go_left;
            }
            tried += go_left.count() + go_right.count();
            // Where both ends arrive, each at its own exit.
            let scale = minus_la * py;
            let base = minus_l * py;
            let (w0, w1) = (d - cy * b0, d - cy * b1);
            let n0 = L::select(starts_left, scale * b0, lb * m0);
            let d0 = L::select(starts_left, w0, base - w0);
            let n1 = L::select(ends_left, scale * b1, lb * m1);
            let d1 = L::select(ends_left, w1, base - w1);
            let [q0, q1] = quotients::<L>([n0, n1], [d0, d1], go_left | go_right);
            let left_start = q0.max(zero);
            let mut left_end = L::select(ends_left, q1.min(la), la);
            let mut right_start = L::select(starts_left, zero, q0.max(zero));
            let right_end = q1.min(lb);
            if (cut_left | cut_right).any() {
                let (ms, ws) = (entry * e - d, d - cy * entry);
                let cut = (scale * entry / ws).min(la);
                left_end = L::select(cut_left, cut, left_end);
                let cut = (lb * ms / (base - ws)).max(zero);
                right_start = L::select(cut_right, cut, right_start);
            }
            if go_left.any() {
                let (ux, uy) = (
                    L::splat(triangle.directions[0][0]),
                    L::splat(triangle.directions[0][1]),
                );
                let children = Windows {
                    b0: left_start,
                    b1: left_end,
                    px: ux * px + uy * py,
                    py: (ux * py - uy * px).min(zero),
                    sigma,
                };
                to_left.add(go_left & left_start.lt(left_end), &children);
            }
            if go_right.any() {
                let (vx, vy) = (
                    L::splat(triangle.directions[1][0]),
                    L::splat(triangle.directions[1][1]),
                );
                let (x, y) = (px - cx, py - cy);
                let children = Windows {
                    b0: right_start,
                    b1: right_end,
                    px: vx * x + vy * y,
                    py: (vx * y - vy * x).min(zero),
                    sigma,
                };
                to_right.add(go_right & right_start.lt(right_end), &children);
            }
        }
    }
    left.len = to_left.len();
    right.len = to_right.len();
    tried
}

/// Both quotients, by one division where the product of the divisors allows it.
///
/// The product of two quotients' divisors leaves the range of f64 only in faces without area; there
/// each gets a division of its own. `wanted` are the lanes that matter.
///
/// # Safety
///
/// The processor must know the instructions of `L`.
#[inline(always)]
unsafe fn quotients<L: Lanes>(n: [L; 2], d: [L; 2], wanted: L::Mask) -> [L; 2] {
    let product = d[0] * d[1];
    // SAFETY: promised by the caller.
    let (one, least, most) = unsafe {
        let [least, most] = INVERTIBLE;
        (L::splat(1.0), L::splat(least), L::splat(most))
    };
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

/// Where the best path has, beyond doubt, crossed all rays of a window left of its entry, and all
/// right of it: its source lies beyond the outer ray, and the window's source on the other side of it.
///
/// # Safety
///
/// The processor must know the instructions of `L`.
#[inline(always)]
unsafe fn crossed<L: Lanes>(b0: L, b1: L, px: L, py: L, best: &BestPath) -> [L::Mask; 2] {
    // SAFETY: promised by the caller.
    let (qx, qy, s, clearance, zero) = unsafe {
        (
            L::splat(best.source[0]),
            L::splat(best.source[1]),
            L::splat(best.entry),
            L::splat(CLEARANCE),
            L::splat(0.0),
        )
    };
    let (dx, dy) = (qx - px, qy - py);
    let size = clearance * (px.abs() + py.abs() + qx.abs() + qy.abs());
    // Twice the area of the window's source, its end x on the edge, and the best source; the sign is that of
    // the side on which the latter lies.
    let left = (b0 - px) * dy + py * dx;
    let left_doubt = size * ((b0 - px).abs() + py.abs());
    let right = (b1 - px) * dy + py * dx;
    let right_doubt = size * ((b1 - px).abs() + py.abs());
    // The same of the best path and the window's source.
    let own = zero - ((s - qx) * dy + qy * dx);
    let own_doubt = size * ((s - qx).abs() + qy.abs());
    [
        left_doubt.lt(left) & own.lt(zero - own_doubt),
        right.lt(zero - right_doubt) & own_doubt.lt(own),
    ]
}
