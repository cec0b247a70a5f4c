//! Passes over a list, compiled for every instruction set.

// Kernels must be inlined into the functions that enable the instructions.
#![allow(clippy::inline_always)]

use std::marker::PhantomData;

use crate::engine::active_list::ActiveList;
use crate::engine::kernels::exits::Rule;
use crate::engine::kernels::{Carried, Gate, Measured, Target, Triangle, carry, measure};
use crate::engine::layout::MeshLayout;
use crate::engine::store::Columns;
use crate::pruning::Pairs;
use crate::tally::PruningTally;
use geobench_window::simd::Lanes;
use geobench_window::simd::SimdProgram;

/// Applies the vertex filter and pairwise comparisons to the windows of a half-edge, makes the
/// result the active list, and measures it.
pub(crate) struct Inspect<'a, P, T> {
    lists: [Columns<'a>; 2],
    active: &'a mut ActiveList,
    layout: &'a MeshLayout,
    h: u32,
    gate: &'a Gate,
    tally: &'a mut T,
    pairs: PhantomData<P>,
}

impl<'a, P, T> Inspect<'a, P, T> {
    /// For the lists on half-edge `h`.
    #[inline]
    pub(crate) fn new(
        lists: [Columns<'a>; 2],
        active: &'a mut ActiveList,
        layout: &'a MeshLayout,
        h: u32,
        gate: &'a Gate,
        tally: &'a mut T,
    ) -> Self {
        Self {
            lists,
            active,
            layout,
            h,
            gate,
            tally,
            pairs: PhantomData,
        }
    }
}

impl<P: Pairs, T: PruningTally> SimdProgram for Inspect<'_, P, T> {
    type Output = Measured;

    #[inline(always)]
    fn run<L: Lanes>(self, simd: L::Token) -> Measured {
        let Self {
            active,
            gate,
            tally,
            ..
        } = self;
        let mut seam = 0;
        if T::COUNTS {
            active.take::<L>(simd, [self.lists[0], Columns::new(&[], 0, 0)], gate);
            seam = active.len;
        }
        active.take::<L>(simd, self.lists, gate);
        if T::COUNTS {
            tally.start(seam, active.len);
        }
        P::prune::<L, T>(simd, active, self.layout, self.h, tally);
        let measured = active.measure::<L>(simd, gate);
        if T::COUNTS {
            let kept = active.keep[..active.len.div_ceil(L::COUNT)].iter();
            tally.cross(kept.map(|bits| bits.count_ones() as usize).sum());
        }
        measured
    }
}

/// Propagates the active list across its face. It has been measured, and the targets have room for
/// the windows that the measurement counted.
pub(crate) struct Carry<'a, 'b, R> {
    pub(crate) active: &'a ActiveList,
    pub(crate) triangle: &'a Triangle,
    pub(crate) rule: &'a R,
    pub(crate) threshold: f64,
    pub(crate) targets: &'a mut [Target<'b>; 2],
}

impl<R: Rule> SimdProgram for Carry<'_, '_, R> {
    type Output = Carried;

    #[inline(always)]
    fn run<L: Lanes>(self, simd: L::Token) -> Carried {
        let Self { active, .. } = self;
        let [left, right] = self.targets;
        carry::<L, R>(
            simd,
            active.columns(),
            &active.keep,
            self.triangle,
            self.rule,
            self.threshold,
            [left, right],
        )
    }
}

/// The length of the shortest path to the apex, over the windows of a list from `start` on.
pub(crate) struct Least<'a> {
    pub(crate) list: Columns<'a>,
    pub(crate) start: usize,
    pub(crate) gate: &'a Gate,
    pub(crate) keep: &'a mut Vec<u8>,
}

impl SimdProgram for Least<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<L: Lanes>(self, simd: L::Token) -> f64 {
        measure::<L, false>(simd, self.list, self.start, self.gate, self.keep).distance
    }
}
