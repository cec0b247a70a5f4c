//! Lanes: several numbers in one register.

// Loads and stores take addresses; `columns` alone calls them.
#![allow(unsafe_code)]

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Not, Sub};

use super::dispatch::SimdProgram;

/// `COUNT` numbers on which every operation works at once: 1, 4 or 8.
#[allow(clippy::return_self_not_must_use)] // They are values like numbers.
pub trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// The number of lanes, which divides 8.
    const COUNT: usize;

    /// Whether storing some lanes takes so much longer than storing all that a branch on it pays,
    /// though it is hard to predict.
    const STORES_SOME_SLOWLY: bool;

    /// The proof that the processor has the instructions of this type. Zero-sized; made by
    /// detection in [`Simd`](super::Simd).
    type Token: Copy;

    /// One answer per lane.
    type Mask: LaneMask;

    /// `x` in every lane.
    fn splat(simd: Self::Token, x: f64) -> Self;

    /// The number of each lane, from 0.
    fn places(simd: Self::Token) -> Self;

    /// The lanes whose bits are set; the first lane is the lowest bit.
    fn mask(simd: Self::Token, bits: u8) -> Self::Mask;

    /// The first lanes of a register at place `i` of a list of `len`, those with places below
    /// `len`.
    #[inline(always)]
    fn within(simd: Self::Token, i: usize, len: usize) -> Self::Mask {
        let left = len - i;
        Self::mask(simd, if left >= 8 { u8::MAX } else { (1 << left) - 1 })
    }

    /// The `COUNT` numbers from `from` on.
    ///
    /// # Safety
    ///
    /// They must be readable.
    unsafe fn load(simd: Self::Token, from: *const f64) -> Self;

    /// Writes all lanes from `to` on.
    ///
    /// # Safety
    ///
    /// They must be writable.
    unsafe fn store(self, to: *mut f64);

    /// Writes the lanes that `mask` chooses, one behind the other, from `to` on, and nothing else.
    ///
    /// # Safety
    ///
    /// As many numbers must be writable.
    unsafe fn store_chosen(self, mask: Self::Mask, to: *mut f64);

    /// The square root.
    fn sqrt(self) -> Self;

    /// The absolute value.
    fn abs(self) -> Self;

    /// -|x|, in one operation.
    fn minus_abs(self) -> Self;

    /// `self` where it is less than `other`, else `other`, also where one of them is NaN.
    fn min(self, other: Self) -> Self;

    /// `self` where it is greater than `other`, else `other`, also where one of them is NaN.
    fn max(self, other: Self) -> Self;

    /// Where `self` is less; not where one is NaN.
    fn lt(self, other: Self) -> Self::Mask;

    /// Where `self` is less or equal; not where one is NaN.
    fn le(self, other: Self) -> Self::Mask;

    /// `yes` where `mask` holds, `no` elsewhere.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// The least of the lanes, none of which is NaN.
    fn least(self) -> f64;

    /// Runs `program` from within one that was compiled for `Self` as well; in a function of its
    /// own where registers have 512 bits.
    ///
    /// The surrounding code would load constants that the program keeps in such registers again
    /// and again, and one such instruction slows down all others for a while.
    #[inline(always)]
    fn run_apart<T: SimdProgram>(simd: Self::Token, program: T) -> T::Output {
        program.run::<Self>(simd)
    }
}

/// One answer per lane.
pub trait LaneMask:
    Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self>
{
    /// A bit for each lane.
    fn bits(self) -> u8;

    /// Whether any lane holds.
    #[inline(always)]
    fn any(self) -> bool {
        self.bits() != 0
    }

    /// How many lanes hold.
    #[inline(always)]
    fn count(self) -> usize {
        self.bits().count_ones() as usize
    }
}
