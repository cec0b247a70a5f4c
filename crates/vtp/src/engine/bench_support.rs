//! The kernels on synthetic lists, for the benches of this crate. Not part of the public interface.

use geobench_window::simd::{Instructions, Lanes, Simd, SimdProgram};

use super::kernels::{self, BestPath, Cuts, Gate, Measured, Target, Triangle};
use super::store::{COLUMNS, NO_LIST, WindowStore};
use crate::precision::blur;

/// A list in front of an equilateral triangle, with room for the children.
#[derive(Debug)]
pub struct KernelBench {
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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kernel {
    /// Rules 2 and 3 on a copy of the list.
    Compare,
    /// The vertex filter and the shortest path to the apex.
    Measure,
    /// The crossing, with rule 1.
    Carry,
}

impl KernelBench {
    /// A list of `len` windows. Uses `instructions`, or narrower ones if the processor lacks them.
    pub fn new(len: usize, instructions: Instructions) -> Self {
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
        let mut bench = Self {
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
        bench.run(Kernel::Measure);
        bench
    }

    /// Runs `kernel` once; returns the number of resulting windows.
    pub fn run(&mut self, kernel: Kernel) -> usize {
        self.simd.run(RunKernel {
            bench: self,
            kernel,
        })
    }
}

struct RunKernel<'a> {
    bench: &'a mut KernelBench,
    kernel: Kernel,
}

impl SimdProgram for RunKernel<'_> {
    type Output = usize;

    #[inline(always)]
    fn run<L: Lanes>(self, simd: L::Token) -> usize {
        let bench = self.bench;
        let len = bench.windows.len();
        let [list, copy, left, right] = bench.lists;
        match self.kernel {
            Kernel::Compare => {
                for (i, &window) in bench.windows.iter().enumerate() {
                    bench.store.put(copy, i, window);
                }
                let block = bench.store.padded_block(copy);
                kernels::compare::<L>(simd, block, len, blur(bench.gate.l), &mut bench.cuts)
            }
            Kernel::Measure => {
                let list = bench.store.first(list, len);
                let found =
                    kernels::measure::<L, true>(simd, list, 0, &bench.gate, &mut bench.keep);
                bench.found = Some(found);
                found.kept
            }
            Kernel::Carry => {
                let Some(found) = bench.found else {
                    return 0;
                };
                let [block, left, right] = bench.store.blocks([list, left, right]);
                let list = block.columns(len);
                let best = BestPath::of(list, found.best, &bench.gate, found.distance);
                let [mut left, mut right] = [left, right].map(|block| Target {
                    block,
                    len: 0,
                    open: true,
                });
                kernels::carry::<L, BestPath>(
                    simd,
                    list,
                    &bench.keep,
                    &bench.triangle,
                    &best,
                    0.0,
                    [&mut left, &mut right],
                );
                left.len + right.len
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_instructions_bring_the_same_windows_through_every_kernel() {
        for len in [1, 7, 8, 9, 100] {
            let results = Instructions::ALL.map(|instructions| {
                let mut bench = KernelBench::new(len, instructions);
                let counts =
                    [Kernel::Compare, Kernel::Measure, Kernel::Carry].map(|k| bench.run(k));
                assert_eq!(counts[1], len);
                assert!(counts[2] >= len, "{counts:?}");
                // The windows that the comparison has kept are the first of its list.
                let copy = bench.lists[1];
                bench.store.set_len(copy, counts[0]);
                (counts, bench.store.windows().collect::<Vec<_>>())
            });
            assert!(results.iter().all(|r| *r == results[0]), "{len}");
        }
    }
}
