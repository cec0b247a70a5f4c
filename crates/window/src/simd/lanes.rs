//! Lanes: several numbers in one register.

// Loads and stores take pointers. Only `columns` calls them.
#![allow(unsafe_code)]

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Not, Sub};

use super::dispatch::SimdProgram;

/// `COUNT` numbers in one register, on which every operation works at once: 1, 4 or 8.
#[allow(clippy::return_self_not_must_use)] // They are values like numbers.
pub trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// The number of lanes; a divisor of 8.
    const COUNT: usize;

    /// Whether storing some lanes is so much slower than storing all that a branch on it pays, even
    /// if it is hard to predict.
    const STORES_SOME_SLOWLY: bool;

    /// The zero-sized proof that the processor has the instructions of this type. Detection in
    /// [`Simd`](super::Simd) makes it.
    type Token: Copy;

    /// A truth value for each lane.
    type Mask: LaneMask;

    /// `x` in every lane.
    fn splat(simd: Self::Token, x: f64) -> Self;

    /// The number of each lane, from 0.
    fn places(simd: Self::Token) -> Self;

    /// The lanes whose bits are set. The lowest bit is the first lane.
    fn mask(simd: Self::Token, bits: u8) -> Self::Mask;

    /// The lanes of a register that hold items, where the register starts at item `i` of a list of
    /// `len`.
    #[inline(always)]
    fn within(simd: Self::Token, i: usize, len: usize) -> Self::Mask {
        let left = len - i;
        Self::mask(simd, if left >= 8 { u8::MAX } else { (1 << left) - 1 })
    }

    /// Loads `COUNT` numbers from `from` on.
    ///
    /// # Safety
    ///
    /// They must be readable.
    unsafe fn load(simd: Self::Token, from: *const f64) -> Self;

    /// Stores all lanes from `to` on.
    ///
    /// # Safety
    ///
    /// `COUNT` numbers must be writable from `to` on.
    unsafe fn store(self, to: *mut f64);

    /// Stores the lanes that `mask` chooses contiguously from `to` on, and nothing else.
    ///
    /// # Safety
    ///
    /// `mask.count()` numbers must be writable from `to` on.
    unsafe fn store_chosen(self, mask: Self::Mask, to: *mut f64);

    /// The square root.
    fn sqrt(self) -> Self;

    /// The absolute value.
    fn abs(self) -> Self;

    /// -|x|, in one operation.
    fn minus_abs(self) -> Self;

    /// `self` where it is less than `other`, else `other`. So `other` where either is NaN.
    fn min(self, other: Self) -> Self;

    /// `self` where it is greater than `other`, else `other`. So `other` where either is NaN.
    fn max(self, other: Self) -> Self;

    /// The lanes in which `self` is less than `other`, neither being NaN.
    fn lt(self, other: Self) -> Self::Mask;

    /// The lanes in which `self` is at most `other`, neither being NaN.
    fn le(self, other: Self) -> Self::Mask;

    /// `yes` where `mask` is set, `no` elsewhere.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// The least of the lanes. None may be NaN.
    fn least(self) -> f64;

    /// Runs `program` from within a program that is compiled for `Self` as well. On AVX-512 it runs
    /// in a function of its own.
    ///
    /// Inlined there, the program's 512-bit constants would be reloaded again and again by the
    /// surrounding code. One such instruction slows down all others for a while.
    #[inline(always)]
    fn run_apart<T: SimdProgram>(simd: Self::Token, program: T) -> T::Output {
        program.run::<Self>(simd)
    }
}

/// A truth value for each lane.
pub trait LaneMask:
    Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self>
{
    /// The truth values as bits. The lowest bit is the first lane.
    fn bits(self) -> u8;

    /// Whether any lane is set.
    #[inline(always)]
    fn any(self) -> bool {
        self.bits() != 0
    }

    /// Number of lanes that are set.
    #[inline(always)]
    fn count(self) -> usize {
        self.bits().count_ones() as usize
    }
}
