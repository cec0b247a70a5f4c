//! One lane: any processor.

// Loads and stores take pointers.
#![allow(unsafe_code)]

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Not, Sub};

use super::lanes::{LaneMask, Lanes};

/// One number.
#[derive(Clone, Copy, Debug)]
pub struct Scalar(f64);

/// One truth value.
#[derive(Clone, Copy, Debug)]
pub struct ScalarMask(bool);

macro_rules! operator {
    ($($trait:ident $method:ident $symbol:tt)+) => {
        $(impl $trait for Scalar {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0 $symbol other.0)
            }
        })+
    };
}

operator! { Add add + Sub sub - Mul mul * Div div / }

impl Lanes for Scalar {
    const COUNT: usize = 1;

    const STORES_SOME_SLOWLY: bool = false;

    type Token = ();

    type Mask = ScalarMask;

    #[inline(always)]
    fn splat((): (), x: f64) -> Self {
        Self(x)
    }

    #[inline(always)]
    fn places((): ()) -> Self {
        Self(0.0)
    }

    #[inline(always)]
    fn mask((): (), bits: u8) -> ScalarMask {
        ScalarMask(bits & 1 != 0)
    }

    #[inline(always)]
    unsafe fn load((): (), from: *const f64) -> Self {
        // SAFETY: the caller guarantees the range.
        Self(unsafe { from.read() })
    }

    #[inline(always)]
    unsafe fn store(self, to: *mut f64) {
        // SAFETY: the caller guarantees the range.
        unsafe { to.write(self.0) }
    }

    #[inline(always)]
    unsafe fn store_chosen(self, mask: ScalarMask, to: *mut f64) {
        if mask.0 {
            // SAFETY: the mask is set, so the caller guarantees the range.
            unsafe { to.write(self.0) }
        }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs())
    }

    #[inline(always)]
    fn minus_abs(self) -> Self {
        Self(-self.0.abs())
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(if self.0 < other.0 { self.0 } else { other.0 })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(if self.0 > other.0 { self.0 } else { other.0 })
    }

    #[inline(always)]
    fn lt(self, other: Self) -> ScalarMask {
        ScalarMask(self.0 < other.0)
    }

    #[inline(always)]
    fn le(self, other: Self) -> ScalarMask {
        ScalarMask(self.0 <= other.0)
    }

    #[inline(always)]
    fn select(mask: ScalarMask, yes: Self, no: Self) -> Self {
        if mask.0 { yes } else { no }
    }

    #[inline(always)]
    fn least(self) -> f64 {
        self.0
    }
}

impl BitAnd for ScalarMask {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl BitOr for ScalarMask {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl Not for ScalarMask {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl LaneMask for ScalarMask {
    #[inline(always)]
    fn bits(self) -> u8 {
        u8::from(self.0)
    }
}
