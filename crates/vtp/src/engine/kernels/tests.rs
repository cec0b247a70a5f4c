//! The kernels on synthetic lists.

use geobench_window::simd::{Instructions, Lanes, Simd, SimdProgram};

use super::{BestPath, Cuts, Gate, Measured, Target, Triangle, carry, compare, measure};
use crate::engine::store::{COLUMNS, NO_LIST, WindowStore};
use crate::precision::blur;

/// A list in front of an equilateral triangle, with room for the children.
struct SyntheticList {
    simd: Simd,
    store: WindowStore,
    lists: [u32; 4],
    windows: Vec<[f64; COLUMNS]>,
    gate: Gate,
    triangle: Triangle,
    keep: Vec<u8>,
    cuts: Cuts,
    found: Option<Measured>,
}

/// A kernel.
#[derive(Clone, Copy)]
enum Kernel {
    /// Rules 2 and 3 on a copy of the list.
    Compare,
    /// The vertex filter and the shortest path to the apex.
    Measure,
    /// The crossing, with rule 1.
    Carry,
}

impl SyntheticList {
    /// A list of `len` windows. Uses `instructions`, or narrower ones if the processor lacks them.
    fn new(len: usize, instructions: Instructions) -> Self {
        let mut store = WindowStore::new();
        let lists = [len, len, len, len].map(|n| store.reserve(NO_LIST, n));
        // Neighbours overlap by half of their width; their sources lie side by side.
        let width = 1.0 / (len + 1) as f64;
        let window = |i: usize| {
            let b0 = i as f64 * width;
            let away = (i * 7 % 5) as f64;
            [
                b0,
                b0 + 2.0 * width,
                0.5 + 0.1 * away,
                -9.0 - 0.1 * away,
                0.5 * away,
            ]
        };
        let windows: Vec<_> = (0..len).map(window).collect();
        for (i, &window) in windows.iter().enumerate() {
            store.put(lists[0], i, window);
        }
        let height = 0.75_f64.sqrt();
        let mut case = Self {
            simd: Simd::new(instructions),
            store,
            lists,
            windows,
            gate: Gate {
                l: 1.0,
                apex: [0.5, height],
                ends: [30.0, 30.0],
                longest: 1.0,
            },
            triangle: Triangle {
                l: 1.0,
                exits: [1.0, 1.0],
                apex: [0.5, height],
                directions: [[0.5, height], [0.5, -height]],
            },
            keep: Vec::new(),
            cuts: Cuts::default(),
            found: None,
        };
        case.run(Kernel::Measure);
        case
    }

    /// Runs `kernel` once; returns the number of resulting windows.
    fn run(&mut self, kernel: Kernel) -> usize {
        self.simd.run(RunKernel { case: self, kernel })
    }
}

struct RunKernel<'a> {
    case: &'a mut SyntheticList,
    kernel: Kernel,
}

impl SimdProgram for RunKernel<'_> {
    type Output = usize;

    #[inline(always)]
    fn run<L: Lanes>(self, simd: L::Token) -> usize {
        let case = self.case;
        let len = case.windows.len();
        let [list, copy, left, right] = case.lists;
        match self.kernel {
            Kernel::Compare => {
                for (i, &window) in case.windows.iter().enumerate() {
                    case.store.put(copy, i, window);
                }
                let block = case.store.padded_block(copy);
                compare::<L>(simd, block, len, blur(case.gate.l), &mut case.cuts)
            }
            Kernel::Measure => {
                let list = case.store.first(list, len);
                let found = measure::<L, true>(simd, list, 0, &case.gate, &mut case.keep);
                case.found = Some(found);
                found.kept
            }
            Kernel::Carry => {
                let Some(found) = case.found else {
                    return 0;
                };
                let [block, left, right] = case.store.blocks([list, left, right]);
                let list = block.columns(len);
                let best = BestPath::of(list, found.best, &case.gate, found.distance);
                let [mut left, mut right] = [left, right].map(|block| Target {
                    block,
                    len: 0,
                    open: true,
                });
                carry::<L, BestPath>(
                    simd,
                    list,
                    &case.keep,
                    &case.triangle,
                    &best,
                    0.0,
                    [&mut left, &mut right],
                );
                left.len + right.len
            }
        }
    }
}

#[test]
fn all_instructions_bring_the_same_windows_through_every_kernel() {
    for len in [1, 7, 8, 9, 100] {
        let results = Instructions::ALL.map(|instructions| {
            let mut case = SyntheticList::new(len, instructions);
            let counts = [Kernel::Compare, Kernel::Measure, Kernel::Carry].map(|k| case.run(k));
            assert_eq!(counts[1], len);
            assert!(counts[2] >= len, "{counts:?}");
            // The windows that the comparison has kept are the first of its list.
            let copy = case.lists[1];
            case.store.set_len(copy, counts[0]);
            (counts, case.store.windows().collect::<Vec<_>>())
        });
        assert!(results.iter().all(|r| *r == results[0]), "{len}");
    }
}
