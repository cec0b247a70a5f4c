//! The pass over a list before it crosses its face: finds the shortest path to the apex, and
//! applies the vertex filter if that has not been done.

use geobench_window::simd::{LaneMask, Lanes};

use super::columns::Windows;
use super::filter::{Filter, Gate, squares};
use crate::engine::store::Columns;

/// The result of the pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Measured {
    /// Number of windows measured.
    pub(crate) len: usize,
    /// The length of the shortest path to the apex; infinite if no window is left.
    pub(crate) distance: f64,
    /// The number of the window with this path, the first of equal ones.
    pub(crate) best: usize,
    /// Number of windows left.
    pub(crate) kept: usize,
    /// Upper bounds of the numbers of windows with rays for the left and for the right exit.
    pub(crate) bound: [usize; 2],
}

/// Measures the windows of `list` from `start` on; with `FILTER` only those that pass the vertex
/// filter. Sets in `keep` a bit for each window that is left, in one byte for each register.
///
/// With e = cy - py and D = cy·px - cx·py, a ray through abscissa s leaves to the left if m(s) =
/// s·e - D < 0. So the sides of both ends of a window take no division. A window that sees the apex
/// C offers it σ + |pC|. Any other window offers σ + |p s| + |s C|, where s is its end nearest to
/// the ray to C.
///
/// All paths are measured, and each lane keeps its shortest one. Two square roots take less time
/// than a branch on whether a path is the shortest so far, which is hard to predict. The branch
/// would cost 8 % of a solve with one window at a time, 4 % with four, and nothing with eight.
#[inline(always)]
#[allow(clippy::needless_range_loop)] // As in `geobench_window::simd`, without iterators.
pub(crate) fn measure<L: Lanes, const FILTER: bool>(
    simd: L::Token,
    list: Columns<'_>,
    start: usize,
    gate: &Gate,
    keep: &mut Vec<u8>,
) -> Measured {
    let len = list.len();
    // One byte for each register, whatever its size.
    if keep.len() < len {
        keep.resize(len.next_power_of_two(), 0);
    }
    let mut found = Measured {
        len,
        distance: f64::INFINITY,
        best: 0,
        kept: 0,
        bound: [0; 2],
    };
    let first = start / L::COUNT;
    let registers = list.registers::<L>();
    let keep = &mut keep[..registers];
    let zero = L::splat(simd, 0.0);
    let filter = Filter::<L>::new(simd, gate);
    let (cx, cy) = (L::splat(simd, gate.apex[0]), L::splat(simd, gate.apex[1]));
    let cy2 = cy * cy;
    let nothing = L::splat(simd, f64::INFINITY);
    // The shortest path in each lane, and the number of the first window of its register.
    let (mut shortest, mut place) = (nothing, zero);
    for register in first..registers {
        let windows = Windows::new(list.load::<L>(simd, register));
        let [r0, r1] = squares(&windows);
        let mut kept = list.listed::<L>(simd, register);
        if register * L::COUNT < start {
            kept = kept & !L::within(simd, register * L::COUNT, start);
        }
        if FILTER {
            kept = filter.passes(&windows, [r0, r1], zero) & kept;
        }
        keep[register] = kept.bits();
        let Windows {
            b0,
            b1,
            px,
            py,
            sigma,
        } = windows;
        // The side of the apex on which both ends pass.
        let e = cy - py;
        let d = cy * px - cx * py;
        let only_right = zero.lt(b0 * e - d);
        let only_left = (b1 * e - d).lt(zero);
        found.kept += kept.count();
        found.bound[0] += (kept & !only_right).count();
        found.bound[1] += (kept & !only_left).count();
        if kept.any() {
            let to_apex = cx - px;
            let seen = to_apex * to_apex + e * e;
            let r = L::select(only_right, r0, L::select(only_left, r1, seen));
            let bend = L::select(only_right, b0, b1);
            let beside = cx - bend;
            let w = L::select(only_right | only_left, beside * beside + cy2, zero);
            let path = L::select(kept, sigma + r.sqrt() + w.sqrt(), nothing);
            let shorter = path.lt(shortest);
            shortest = L::select(shorter, path, shortest);
            let here = L::splat(simd, (register * L::COUNT) as f64);
            place = L::select(shorter, here, place);
        }
    }
    found.distance = shortest.least();
    let least = shortest.le(L::splat(simd, found.distance));
    found.best = if registers <= first + 1 {
        first * L::COUNT + least.bits().trailing_zeros() as usize
    } else {
        let numbers = L::select(least, place + L::places(simd), nothing);
        #[allow(clippy::cast_sign_loss)] // Numbers of windows.
        let best = numbers.least() as u32;
        best as usize
    };
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::store::{NO_LIST, WindowStore};
    use geobench_window::simd::{Instructions, Simd, SimdProgram};

    /// Measures a whole list.
    struct Whole<'a>(Columns<'a>, &'a Gate);

    impl SimdProgram for Whole<'_> {
        type Output = Measured;

        #[inline(always)]
        fn run<L: Lanes>(self, simd: L::Token) -> Measured {
            measure::<L, true>(simd, self.0, 0, self.1, &mut Vec::new())
        }
    }

    /// Straight paths to the apex of a flat triangle, of these lengths.
    fn measured(lengths: &[f64], instructions: Instructions) -> Measured {
        let gate = Gate {
            l: 1.0,
            apex: [0.5, 0.5],
            ends: [2.5; 2],
            longest: 1.0,
        };
        let mut store = WindowStore::new();
        let list = store.reserve(NO_LIST, lengths.len());
        for (i, length) in lengths.iter().enumerate() {
            store.put(list, i, [0.4, 0.6, 0.5, -0.5, length - 1.0]);
        }
        store.set_len(list, lengths.len());
        Simd::new(instructions).run(Whole(store.columns(list), &gate))
    }

    #[test]
    fn the_first_of_the_shortest_paths_is_found_in_whatever_register_it_lies() {
        let all = Instructions::ALL;
        for instructions in all.into_iter().filter(|i| i.is_available()) {
            for (count, shortest) in [
                (1, &[0][..]),
                (5, &[4]),
                (8, &[3, 2]),
                (30, &[29]),
                (30, &[9, 17, 24]),
                (30, &[12, 11, 19]),
            ] {
                let mut lengths = vec![1.5; count];
                for &i in shortest {
                    lengths[i] = 1.25;
                }
                let found = measured(&lengths, instructions);
                let first = *shortest.iter().min().unwrap();
                assert_eq!(
                    (found.best, found.distance),
                    (first, 1.25),
                    "{instructions}"
                );
                assert_eq!((found.kept, found.bound), (count, [count; 2]));
            }
            let none = measured(&[4.0, 5.0], instructions);
            assert_eq!((none.kept, none.distance), (0, f64::INFINITY));
        }
    }
}
