//! Rules 2 and 3 as in the paper: neighbours are compared until no window is deleted.

use geobench_window::simd::{LaneMask, Lanes};

use super::columns::Windows;
use super::compare::{Cuts, losses, side};
use super::trim::trim;
use crate::engine::store::PaddedBlock;
use crate::pairs::{BLURRED, INSIDE, SharedEdge};
use crate::precision::{CLEARANCE, WINS};
use crate::tally::PruningTally;

/// Compares neighbours among the first `len` windows of `block`, cuts each by its losses, drops
/// windows that have lost everything, compares new neighbours, and so on. Returns the number of
/// windows left, and whether the list has settled.
///
/// With `TRIM`, neighbours also give up the ranges of their overlap on which the other is shorter.
/// If that would leave one of them in several pieces, or the list out of order, the list has not
/// settled and must be processed window by window.
///
/// `edge` returns the edge and the triangle below it. `again` is scratch.
///
/// The paper traverses the list from one end, and a window meets its second neighbour after the
/// first one has cut it. Here all pairs of a round are compared as they were before the round,
/// whole registers at a time. A ray is cut because it crosses a shorter real path, which stays true
/// if the winner is cut elsewhere. The pairs of windows that are compared are the same.
#[inline(always)]
#[allow(clippy::needless_range_loop)] // As in `geobench_window::simd`, without iterators.
#[allow(clippy::too_many_arguments)] // The parts of one list, which its caller holds apart.
pub(crate) fn settle<L: Lanes, T: PruningTally, const TRIM: bool>(
    simd: L::Token,
    mut block: PaddedBlock<'_>,
    mut len: usize,
    edge: impl Fn() -> SharedEdge,
    cuts: &mut Cuts,
    again: &mut Vec<u8>,
    tally: &mut T,
) -> (usize, bool) {
    if len < 2 {
        return (len, true);
    }
    let edge = edge();
    // A bit for each window that must be compared with the next one, in one byte for each register.
    again.clear();
    again.resize(len.div_ceil(L::COUNT), u8::MAX);
    loop {
        let mut list = block.in_place(len);
        let mut cuts = cuts.of(len);
        let registers = list.registers::<L>();
        let mut died = false;
        for register in 0..registers {
            let a = Windows::new(list.load::<L>(simd, register));
            let b = Windows::new(list.load_next::<L>(simd, register));
            let pairs = list.with_next::<L>(simd, register);
            let pairs = pairs & L::mask(simd, again[register]);
            let left = if pairs.any() {
                let (left, apart) = losses::<L>(simd, &a, &b, pairs, edge.blur);
                let left = crossings::<L>(simd, &a, &b, apart, &edge, left);
                if T::COUNTS {
                    report::<L>(&a, &b, [pairs, apart], &left, register * L::COUNT, tally);
                }
                if TRIM {
                    let (left, anew) = trim::<L>(simd, &a, &b, pairs, edge.l, left);
                    if anew.any() {
                        return (len, false);
                    }
                    left
                } else {
                    left
                }
            } else {
                [[a.b0, a.b1], [b.b0, b.b1]]
            };
            cuts.note(register, left);
        }
        cuts.open();
        again.fill(0);
        for register in 0..registers {
            // Loaded before anything is stored: fewer windows have been kept than loaded.
            let w = Windows::new(list.load::<L>(simd, register));
            let [b0, b1] = cuts.left::<L>(simd, register);
            let listed = list.listed::<L>(simd, register);
            let alive = b0.lt(b1) & listed;
            if T::COUNTS {
                tally.keep(register * L::COUNT, alive.bits());
            }
            if alive.count() < listed.count() {
                died = true;
                bring_together::<L>(alive, listed.count(), list.kept(), again);
            }
            list.keep(alive, Windows { b0, b1, ..w }.rows());
        }
        len = list.kept();
        if T::COUNTS {
            tally.turn();
        }
        if !died || len < 2 {
            return (len, true);
        }
    }
}

/// Tells what was compared from window `first` on: the `pairs`, those of them that are `apart`, and
/// what was `left`.
#[inline(always)]
fn report<L: Lanes>(
    a: &Windows<L>,
    b: &Windows<L>,
    [pairs, apart]: [L::Mask; 2],
    left: &[[L; 2]; 2],
    first: usize,
    tally: &mut impl PruningTally,
) {
    let overlap = pairs & !apart;
    let swapped = b.b0.lt(a.b0);
    let cases = [overlap & !swapped, overlap & swapped, apart];
    let loses = |w: &Windows<L>, [b0, b1]: [L; 2]| (w.b0.lt(b0) | b1.lt(w.b1)).bits();
    let losers = [loses(a, left[0]), loses(b, left[1])];
    tally.compare(first, pairs.bits(), cases.map(LaneMask::bits), losers);
}

/// Sets the bits of windows whose right neighbours were deleted. Of the `listed` windows of a
/// register, those in `alive` are kept, behind `before` others.
#[inline(always)]
fn bring_together<L: Lanes>(alive: L::Mask, listed: usize, before: usize, again: &mut [u8]) {
    let mut place = before;
    for lane in 0..listed {
        if alive.bits() >> lane & 1 != 0 {
            place += 1;
        } else if place > 0 {
            let left = place - 1;
            again[left / L::COUNT] |= 1 << (left % L::COUNT);
        }
    }
}

/// What is `left` of neighbours after the disjoint pairs, `apart`, have been compared (cases 3 and
/// 6). If their nearest rays have crossed inside the triangle behind the edge, the window whose
/// path to the crossing is longer is deleted.
///
/// [`check_pair`](crate::pairs::check_pair), the scalar form, proves that the whole window may be
/// deleted.
#[inline(always)]
fn crossings<L: Lanes>(
    simd: L::Token,
    a: &Windows<L>,
    b: &Windows<L>,
    apart: L::Mask,
    edge: &SharedEdge,
    mut left: [[L; 2]; 2],
) -> [[L; 2]; 2] {
    if !apart.any() {
        return left;
    }
    let (zero, clearance) = (L::splat(simd, 0.0), L::splat(simd, CLEARANCE));
    let blur = L::splat(simd, edge.blur);
    let in_order = a.b1.lt(b.b0);
    let (v, u) = (select(in_order, a, b), select(in_order, b, a));
    // The rays to the nearest ends cross below the edge if each source is beyond the ray of the
    // other.
    let (dx, dy) = (u.px - v.px, u.py - v.py);
    let size = clearance * (a.px.abs() + a.py.abs() + b.px.abs() + b.py.abs()) + blur;
    let beyond_left = side(&v, v.b1, [dx, dy], size, zero)[0];
    let beyond_right = side(&u, u.b0, [zero - dx, zero - dy], size, zero)[1];
    let crossing = apart & beyond_left & beyond_right;
    if crossing.any() {
        let dead = dearer::<L>(simd, &v, &u, crossing, edge);
        let none = L::splat(simd, f64::NEG_INFINITY);
        let a_dies = (in_order & dead[0]) | (!in_order & dead[1]);
        let b_dies = (in_order & dead[1]) | (!in_order & dead[0]);
        left[0][1] = L::select(a_dies, none, left[0][1]);
        left[1][1] = L::select(b_dies, none, left[1][1]);
    }
    left
}

/// Windows of `yes` where `mask` is set, of `no` elsewhere.
#[inline(always)]
fn select<L: Lanes>(mask: L::Mask, yes: &Windows<L>, no: &Windows<L>) -> Windows<L> {
    Windows {
        b0: L::select(mask, yes.b0, no.b0),
        b1: L::select(mask, yes.b1, no.b1),
        px: L::select(mask, yes.px, no.px),
        py: L::select(mask, yes.py, no.py),
        sigma: L::select(mask, yes.sigma, no.sigma),
    }
}

/// Which of the left windows `v` and of the right windows `u` are deleted, among `pairs`.
#[inline(always)]
fn dearer<L: Lanes>(
    simd: L::Token,
    v: &Windows<L>,
    u: &Windows<L>,
    pairs: L::Mask,
    edge: &SharedEdge,
) -> [L::Mask; 2] {
    let (zero, one) = (L::splat(simd, 0.0), L::splat(simd, 1.0));
    let rounding = L::splat(simd, edge.blur);
    let (l, wins) = (L::splat(simd, edge.l), L::splat(simd, WINS));
    let (tx, ty) = (
        L::splat(simd, edge.behind[0]),
        L::splat(simd, edge.behind[1]),
    );
    let (rx, ry) = (v.b1 - v.px, zero - v.py);
    let (qx, qy) = (u.b0 - u.px, zero - u.py);
    let (dx, dy) = (u.px - v.px, u.py - v.py);
    let denominator = rx * qy - ry * qx;
    let s = (dx * qy - dy * qx) / denominator;
    let t = (dx * ry - dy * rx) / denominator;
    let (r2, q2) = (rx * rx + ry * ry, qx * qx + qy * qy);
    let blur = L::splat(simd, INSIDE * edge.slenderness) * (r2 * q2).sqrt() / denominator.abs();
    // The crossing, and whether it is clearly inside the triangle.
    let (x, y) = (v.px + s * rx, v.py + s * ry);
    let depth = y / ty;
    let leftmost = depth * tx;
    let rightmost = l + depth * (tx - l);
    let slack = blur * l;
    let inside = zero.lt(s)
        & s.lt(one)
        & zero.lt(t)
        & t.lt(one)
        & blur.lt(L::splat(simd, BLURRED))
        & blur.lt(depth)
        & depth.lt(one - blur)
        & (leftmost + slack).lt(x)
        & x.lt(rightmost - slack);
    let (to_left, to_right) = (v.sigma + s * r2.sqrt(), u.sigma + t * q2.sqrt());
    [
        pairs & inside & to_right.lt(to_left * wins - rounding),
        pairs & inside & to_left.lt(to_right * wins - rounding),
    ]
}

#[cfg(test)]
mod tests {
    use geobench_window::Window;
    use geobench_window::simd::{CacheLine, Scalar};
    use proptest::prelude::*;

    use super::*;
    use crate::pairs::{PairOutcome, check_pair};

    const EDGE: SharedEdge = SharedEdge::new(1.0, [0.4, -0.8], 2.0);

    prop_compose! {
        fn windows()(
            b0 in 0.0..0.9f64, width in 0.01..0.3f64,
            px in -1.0..2.0f64, py in -2.0..-0.9f64, sigma in 0.0..0.5f64,
        ) -> Window {
            Window { b0, b1: (b0 + width).min(1.0), px, py, sigma }
        }
    }

    fn settled<const TRIM: bool>(list: &[Window]) -> Vec<Window> {
        try_settled::<TRIM>(list).unwrap()
    }

    fn try_settled<const TRIM: bool>(list: &[Window]) -> Option<Vec<Window>> {
        let mut lines = vec![CacheLine::default(); 5 * list.len().div_ceil(CacheLine::LANES) + 1];
        let column = lines.len() / 5;
        for (i, w) in list.iter().enumerate() {
            for (c, x) in [w.b0, w.b1, w.px, w.py, w.sigma].into_iter().enumerate() {
                lines[c * column + i / CacheLine::LANES].0[i % CacheLine::LANES] = x;
            }
        }
        let (mut cuts, mut again) = (Cuts::default(), Vec::new());
        let (len, settled) = settle::<Scalar, (), TRIM>(
            (),
            PaddedBlock::new(&mut lines, column as u32),
            list.len(),
            || EDGE,
            &mut cuts,
            &mut again,
            &mut (),
        );
        let at =
            |c: usize, i: usize| lines[c * column + i / CacheLine::LANES].0[i % CacheLine::LANES];
        let window = |i| Window {
            b0: at(0, i),
            b1: at(1, i),
            px: at(2, i),
            py: at(3, i),
            sigma: at(4, i),
        };
        settled.then(|| (0..len).map(window).collect())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        /// A list of two windows keeps what the scalar form keeps, except that both cuts use the
        /// windows before any cut.
        #[test]
        fn two_windows_fare_as_in_the_plain_form(a in windows(), b in windows()) {
            let (mut first, mut second) = (a, b);
            let plain = match check_pair(&mut first, &mut second, &EDGE) {
                PairOutcome::BothStay => vec![first, second],
                PairOutcome::FirstDies => vec![b],
                PairOutcome::SecondDies => vec![a],
            };
            let found = settled::<false>(&[a, b]);
            if plain.len() == 1 {
                prop_assert_eq!(found.len(), 1);
                prop_assert_eq!(found[0].source(), plain[0].source());
            } else {
                prop_assert_eq!(found, plain);
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        /// At every point of the edge the shorter window is kept, and the remaining overlap is not
        /// worth a tie.
        #[test]
        fn trimmed_neighbours_lose_no_distance(
            a in windows(), b in windows(), x in 0.0..1.0f64,
        ) {
            let covers = |w: &Window| w.b0 <= x && x <= w.b1;
            let reached = |windows: &[Window]| {
                let reached = windows.iter().filter(|w| covers(w));
                reached.map(|w| w.distance(x)).fold(f64::INFINITY, f64::min)
            };
            let Some(found) = try_settled::<true>(&[a, b]) else {
                return Ok(());
            };
            prop_assert!(found.len() <= 2);
            if let [a, b] = found[..] {
                let overlap = a.b1.min(b.b1) - a.b0.max(b.b0);
                let x = 0.5 * (a.b1.min(b.b1) + a.b0.max(b.b0));
                let equal = (a.distance(x) - b.distance(x)).abs() <= 1e-11 * a.distance(x);
                prop_assert!(overlap <= 1e-9 || equal, "{found:?}");
            }
            // Cuts that follow from the ends of the overlap may extend beyond the overlap.
            let before = reached(&settled::<false>(&[a, b]));
            let after = reached(&found);
            prop_assert!(before == after || (after - before).abs() <= 1e-12 * before);
        }
    }

    #[test]
    fn a_list_that_would_fall_to_pieces_is_left_to_others() {
        let window = |b0: f64, b1: f64, py: f64, sigma: f64| Window {
            b0,
            b1,
            px: 0.5,
            py,
            sigma,
        };
        let list = [window(0.0, 1.0, -1.0, 5.0), window(0.4, 0.6, -0.5, 0.0)];
        assert_eq!(try_settled::<true>(&list), None);
    }

    #[test]
    fn windows_brought_together_by_a_death_are_compared() {
        let window = |b0: f64, b1: f64, px: f64, sigma: f64| Window {
            b0,
            b1,
            px,
            py: -1.0,
            sigma,
        };
        let better = window(0.0, 0.6, 0.1, 0.0);
        // The windows that are deleted first are not adjacent to the window that beats all of them.
        let dear = [0.1, 0.2, 0.3].map(|b0| window(b0, b0 + 0.1, 0.9, 3.0));
        let list = [&dear[..], &[better]].concat();
        assert_eq!(settled::<false>(&list), [better]);
        let list = [&[better], &dear[..]].concat();
        assert_eq!(settled::<false>(&list), [better]);
    }
}
