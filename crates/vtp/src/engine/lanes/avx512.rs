//! Eight lanes: AVX-512 F, DQ and VL.

use std::arch::x86_64::{
    __m512d, _CMP_LE_OQ, _CMP_LT_OQ, _mm512_abs_pd, _mm512_add_pd, _mm512_castpd_si512,
    _mm512_castsi512_pd, _mm512_cmp_pd_mask, _mm512_div_pd, _mm512_loadu_pd, _mm512_mask_blend_pd,
    _mm512_mask_storeu_pd, _mm512_maskz_compress_pd, _mm512_max_pd, _mm512_min_pd, _mm512_mul_pd,
    _mm512_or_si512, _mm512_reduce_min_pd, _mm512_set_pd, _mm512_set1_pd, _mm512_sqrt_pd,
    _mm512_storeu_pd, _mm512_sub_pd,
};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Not, Sub};

use super::{LaneMask, Lanes};

/// Eight numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx512(__m512d);

/// Eight answers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mask8(u8);

macro_rules! operator {
    ($($trait:ident $method:ident $intrinsic:ident)+) => {
        $(impl $trait for Avx512 {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: a value of this type exists, so the processor has AVX-512.
                Self(unsafe { $intrinsic(self.0, other.0) })
            }
        })+
    };
}

operator! { Add add _mm512_add_pd Sub sub _mm512_sub_pd Mul mul _mm512_mul_pd Div div _mm512_div_pd }

impl Lanes for Avx512 {
    const COUNT: usize = 8;

    const STORES_SOME_SLOWLY: bool = false;

    type Mask = Mask8;

    #[inline(always)]
    unsafe fn splat(x: f64) -> Self {
        // SAFETY: promised by the caller.
        Self(unsafe { _mm512_set1_pd(x) })
    }

    #[inline(always)]
    unsafe fn places() -> Self {
        // SAFETY: promised by the caller.
        Self(unsafe { _mm512_set_pd(7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0, 0.0) })
    }

    #[inline(always)]
    unsafe fn load(from: *const f64) -> Self {
        // SAFETY: promised by the caller.
        Self(unsafe { _mm512_loadu_pd(from) })
    }

    #[inline(always)]
    unsafe fn store(self, to: *mut f64) {
        // SAFETY: promised by the caller.
        unsafe { _mm512_storeu_pd(to, self.0) }
    }

    /// Compresses in a register: compressing straight to memory is microcode on some processors.
    #[inline(always)]
    unsafe fn store_chosen(self, mask: Mask8, to: *mut f64) {
        let first = ((1_u32 << mask.0.count_ones()) - 1) as u8;
        // SAFETY: promised by the caller; lanes that are not among the first are not written.
        unsafe { _mm512_mask_storeu_pd(to, first, _mm512_maskz_compress_pd(mask.0, self.0)) }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: a value of this type exists, so the processor has AVX-512; likewise below.
        Self(unsafe { _mm512_sqrt_pd(self.0) })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: as for `sqrt`.
        Self(unsafe { _mm512_abs_pd(self.0) })
    }

    #[inline(always)]
    fn minus_abs(self) -> Self {
        // SAFETY: as for `sqrt`.
        Self(unsafe {
            let sign = _mm512_castpd_si512(_mm512_set1_pd(-0.0));
            _mm512_castsi512_pd(_mm512_or_si512(sign, _mm512_castpd_si512(self.0)))
        })
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: as for `sqrt`.
        Self(unsafe { _mm512_min_pd(self.0, other.0) })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: as for `sqrt`.
        Self(unsafe { _mm512_max_pd(self.0, other.0) })
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Mask8 {
        // SAFETY: as for `sqrt`.
        Mask8(unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, other.0) })
    }

    #[inline(always)]
    fn le(self, other: Self) -> Mask8 {
        // SAFETY: as for `sqrt`.
        Mask8(unsafe { _mm512_cmp_pd_mask::<_CMP_LE_OQ>(self.0, other.0) })
    }

    #[inline(always)]
    fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        // SAFETY: as for `sqrt`.
        Self(unsafe { _mm512_mask_blend_pd(mask.0, no.0, yes.0) })
    }

    #[inline(always)]
    fn least(self) -> f64 {
        // SAFETY: as for `sqrt`.
        unsafe { _mm512_reduce_min_pd(self.0) }
    }
}

impl BitAnd for Mask8 {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl BitOr for Mask8 {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl Not for Mask8 {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl LaneMask for Mask8 {
    #[inline(always)]
    unsafe fn from_bits(bits: u8) -> Self {
        Self(bits)
    }

    #[inline(always)]
    fn bits(self) -> u8 {
        self.0
    }
}
