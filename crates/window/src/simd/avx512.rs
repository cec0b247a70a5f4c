//! Eight lanes: AVX-512 F, DQ and VL.

// Intrinsics are unsafe outside functions that enable their features.
#![allow(unsafe_code)]

use std::arch::x86_64::{
    __m512d, _CMP_LE_OQ, _CMP_LT_OQ, _mm512_abs_pd, _mm512_add_pd, _mm512_castpd_si512,
    _mm512_castsi512_pd, _mm512_cmp_pd_mask, _mm512_div_pd, _mm512_loadu_pd, _mm512_mask_blend_pd,
    _mm512_mask_storeu_pd, _mm512_maskz_compress_pd, _mm512_max_pd, _mm512_min_pd, _mm512_mul_pd,
    _mm512_or_si512, _mm512_reduce_min_pd, _mm512_set_pd, _mm512_set1_pd, _mm512_sqrt_pd,
    _mm512_storeu_pd, _mm512_sub_pd,
};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Not, Sub};

use super::dispatch::{SimdProgram, run_avx512_apart};
use super::instructions::Instructions;
use super::lanes::{LaneMask, Lanes};

/// The proof that the processor has AVX-512 F, DQ and VL.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Avx512Token(());

impl Avx512Token {
    /// The token, if the processor has the instructions.
    pub(super) fn detect() -> Option<Self> {
        Instructions::Avx512.is_available().then_some(Self(()))
    }
}

/// Calls an intrinsic where a token or a vector exists.
macro_rules! intrinsics {
    ($($body:tt)*) => {{
        // SAFETY: tokens come from detection and vectors from tokens, so the processor has AVX-512.
        #[allow(unused_unsafe)]
        unsafe { $($body)* }
    }};
}

/// Eight numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Avx512(__m512d);

/// Eight truth values.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mask8(u8);

macro_rules! operator {
    ($($trait:ident $method:ident $intrinsic:ident)+) => {
        $(impl $trait for Avx512 {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(intrinsics!($intrinsic(self.0, other.0)))
            }
        })+
    };
}

operator! { Add add _mm512_add_pd Sub sub _mm512_sub_pd Mul mul _mm512_mul_pd Div div _mm512_div_pd }

impl Lanes for Avx512 {
    const COUNT: usize = 8;

    const STORES_SOME_SLOWLY: bool = false;

    type Token = Avx512Token;

    type Mask = Mask8;

    #[inline(always)]
    fn splat(_: Avx512Token, x: f64) -> Self {
        Self(intrinsics!(_mm512_set1_pd(x)))
    }

    #[inline(always)]
    fn places(_: Avx512Token) -> Self {
        let places = intrinsics!(_mm512_set_pd(7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0, 0.0));
        Self(places)
    }

    #[inline(always)]
    fn mask(_: Avx512Token, bits: u8) -> Mask8 {
        Mask8(bits)
    }

    #[inline(always)]
    unsafe fn load(_: Avx512Token, from: *const f64) -> Self {
        // SAFETY: the token proves AVX-512; the caller guarantees the range.
        Self(unsafe { _mm512_loadu_pd(from) })
    }

    #[inline(always)]
    unsafe fn store(self, to: *mut f64) {
        // SAFETY: a vector exists, which proves AVX-512; the caller guarantees the range.
        unsafe { _mm512_storeu_pd(to, self.0) }
    }

    /// Compresses in a register: compressing straight to memory is microcode on some processors.
    #[inline(always)]
    unsafe fn store_chosen(self, mask: Mask8, to: *mut f64) {
        let first = ((1_u32 << mask.0.count_ones()) - 1) as u8;
        // SAFETY: a vector exists, which proves AVX-512; only the lanes that the caller guarantees
        // are written.
        unsafe { _mm512_mask_storeu_pd(to, first, _mm512_maskz_compress_pd(mask.0, self.0)) }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(intrinsics!(_mm512_sqrt_pd(self.0)))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(intrinsics!(_mm512_abs_pd(self.0)))
    }

    #[inline(always)]
    fn minus_abs(self) -> Self {
        Self(intrinsics! {
            let sign = _mm512_castpd_si512(_mm512_set1_pd(-0.0));
            _mm512_castsi512_pd(_mm512_or_si512(sign, _mm512_castpd_si512(self.0)))
        })
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(intrinsics!(_mm512_min_pd(self.0, other.0)))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(intrinsics!(_mm512_max_pd(self.0, other.0)))
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Mask8 {
        Mask8(intrinsics!(_mm512_cmp_pd_mask::<_CMP_LT_OQ>(
            self.0, other.0
        )))
    }

    #[inline(always)]
    fn le(self, other: Self) -> Mask8 {
        Mask8(intrinsics!(_mm512_cmp_pd_mask::<_CMP_LE_OQ>(
            self.0, other.0
        )))
    }

    #[inline(always)]
    fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        Self(intrinsics!(_mm512_mask_blend_pd(mask.0, no.0, yes.0)))
    }

    #[inline(always)]
    fn least(self) -> f64 {
        intrinsics!(_mm512_reduce_min_pd(self.0))
    }

    #[inline(always)]
    fn run_apart<T: SimdProgram>(simd: Avx512Token, program: T) -> T::Output {
        run_avx512_apart(program, simd)
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
    fn bits(self) -> u8 {
        self.0
    }
}
