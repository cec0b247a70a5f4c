//! Several numbers in one register: what the kernels are written in.
//!
//! A kernel is one generic function over [`Lanes`]; the three implementations make a scalar, an
//! AVX2 and an AVX-512 program of it. All operations round as IEEE 754 says and none is fused, so
//! that the three programs give the same bits. The type of a lane stands for the proof that the
//! processor knows its instructions: values come only out of the unsafe functions here.

// Vector instructions run only on processors that have them.
#![allow(unsafe_code)]

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod scalar;

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Not, Sub};

#[cfg(target_arch = "x86_64")]
pub(crate) use avx2::Avx2;
#[cfg(target_arch = "x86_64")]
pub(crate) use avx512::Avx512;
pub(crate) use scalar::Scalar;

/// `COUNT` numbers on which every operation works at once.
pub(crate) trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// How many.
    const COUNT: usize;

    /// Whether storing some lanes takes so much longer than storing all that a branch on it pays,
    /// though it is foreseen badly.
    const STORES_SOME_SLOWLY: bool;

    /// One answer for each lane.
    type Mask: LaneMask;

    /// `x` in every lane.
    ///
    /// # Safety
    ///
    /// The processor must have the instructions of the type. The same holds for the other unsafe
    /// functions.
    unsafe fn splat(x: f64) -> Self;

    /// The number of each lane, from 0.
    ///
    /// # Safety
    ///
    /// As for [`splat`](Self::splat).
    unsafe fn places() -> Self;

    /// The `COUNT` numbers from `from` on.
    ///
    /// # Safety
    ///
    /// They must be readable.
    unsafe fn load(from: *const f64) -> Self;

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
}

/// One answer for each lane.
pub(crate) trait LaneMask:
    Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self>
{
    /// The lanes whose bits are set; the first lane is the lowest bit.
    ///
    /// # Safety
    ///
    /// As for [`Lanes::splat`].
    unsafe fn from_bits(bits: u8) -> Self;

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
