//! The passes over a list, compiled for every set of instructions.

// They call kernels, for whose instructions `dispatch` vouches.
#![allow(unsafe_code)]
// The kernels must be inlined into the functions that have the features of the processor.
#![allow(clippy::inline_always)]

use std::marker::PhantomData;

use crate::engine::dispatch::Program;
use crate::engine::hand::Hand;
use crate::engine::kernels::exits::Rule;
use crate::engine::kernels::{Carried, Gate, Measured, Target, Triangle, carry, measure};
use crate::engine::lanes::Lanes;
use crate::engine::store::Line;
use crate::engine::surface::Surface;
use crate::pruning::Pairs;

/// Takes the lists of a half-edge in hand, as far as filter and comparisons leave them, and
/// measures them.
pub(crate) struct Inspect<'a, P> {
    lists: [(&'a [Line], usize); 2],
    hand: &'a mut Hand,
    surface: &'a Surface,
    h: u32,
    gate: &'a Gate,
    pairs: PhantomData<P>,
}

impl<'a, P> Inspect<'a, P> {
    /// For the lists on `h`.
    #[inline]
    pub(crate) fn new(
        lists: [(&'a [Line], usize); 2],
        hand: &'a mut Hand,
        surface: &'a Surface,
        h: u32,
        gate: &'a Gate,
    ) -> Self {
        Self {
            lists,
            hand,
            surface,
            h,
            gate,
            pairs: PhantomData,
        }
    }
}

impl<P: Pairs> Program for Inspect<'_, P> {
    type Output = Measured;

    #[inline(always)]
    unsafe fn run<L: Lanes>(self) -> Measured {
        let Self { hand, gate, .. } = self;
        // SAFETY: promised by the caller.
        unsafe {
            hand.take::<L>(self.lists, gate);
            P::prune::<L>(hand, self.surface, self.h);
            hand.measure::<L>(gate)
        }
    }
}

/// Takes the list in hand across its face.
pub(crate) struct Carry<'a, 'b, R> {
    hand: &'a Hand,
    triangle: &'a Triangle,
    rule: &'a R,
    threshold: f64,
    targets: &'a mut [Target<'b>; 2],
}

impl<'a, 'b, R> Carry<'a, 'b, R> {
    /// For the list in `hand`, which has been measured; the targets must have room for what was
    /// counted then.
    #[inline]
    pub(crate) fn new(
        hand: &'a Hand,
        triangle: &'a Triangle,
        rule: &'a R,
        threshold: f64,
        targets: &'a mut [Target<'b>; 2],
    ) -> Self {
        Self {
            hand,
            triangle,
            rule,
            threshold,
            targets,
        }
    }
}

impl<R: Rule> Program for Carry<'_, '_, R> {
    type Output = Carried;

    #[inline(always)]
    unsafe fn run<L: Lanes>(self) -> Carried {
        let Self { hand, .. } = self;
        let [left, right] = self.targets;
        // SAFETY: promised by the caller, and by the maker of this.
        unsafe {
            carry::<L, R>(
                hand.block(),
                hand.len,
                &hand.keep,
                self.triangle,
                self.rule,
                self.threshold,
                [left, right],
            )
        }
    }
}

/// The length of the shortest path to the apex of the windows of a block from `start` to `len`.
pub(crate) struct Least<'a> {
    /// With a line behind it if `start` is not 0.
    pub(crate) block: &'a [Line],
    pub(crate) start: usize,
    pub(crate) len: usize,
    pub(crate) gate: &'a Gate,
    pub(crate) keep: &'a mut Vec<u8>,
}

impl Program for Least<'_> {
    type Output = f64;

    #[inline(always)]
    unsafe fn run<L: Lanes>(self) -> f64 {
        // SAFETY: promised by the caller, and by the maker of this.
        unsafe {
            measure::<L, false>(self.block, self.start, self.len, self.gate, self.keep).distance
        }
    }
}
