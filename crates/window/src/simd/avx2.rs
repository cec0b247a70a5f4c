//! Four lanes: AVX2.

// Intrinsics are unsafe outside functions that enable their features.
#![allow(unsafe_code)]

use std::arch::x86_64::{
    __m256d, __m256i, _CMP_LE_OQ, _CMP_LT_OQ, _mm_cvtsd_f64, _mm_min_pd, _mm_min_sd,
    _mm_unpackhi_pd, _mm256_add_pd, _mm256_and_pd, _mm256_andnot_pd, _mm256_blendv_pd,
    _mm256_castpd_ps, _mm256_castpd256_pd128, _mm256_castps_pd, _mm256_castsi256_pd, _mm256_cmp_pd,
    _mm256_div_pd, _mm256_extractf128_pd, _mm256_load_si256, _mm256_loadu_pd, _mm256_maskstore_pd,
    _mm256_max_pd, _mm256_min_pd, _mm256_movemask_pd, _mm256_mul_pd, _mm256_or_pd,
    _mm256_permutevar8x32_ps, _mm256_set_pd, _mm256_set1_epi64x, _mm256_set1_pd, _mm256_sqrt_pd,
    _mm256_storeu_pd, _mm256_sub_pd, _mm256_xor_pd,
};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Not, Sub};

use super::instructions::Instructions;
use super::lanes::{LaneMask, Lanes};

/// The proof that the processor has AVX2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Avx2Token(());

impl Avx2Token {
    /// The token, if the processor has the instructions.
    pub(super) fn detect() -> Option<Self> {
        Instructions::Avx2.is_available().then_some(Self(()))
    }
}

/// Calls an intrinsic where a token or a vector exists.
macro_rules! intrinsics {
    ($($body:tt)*) => {{
        // SAFETY: tokens come from detection and vectors from tokens, so the processor has AVX2.
        #[allow(unused_unsafe)]
        unsafe { $($body)* }
    }};
}

/// Four numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Avx2(__m256d);

/// Four truth values: a lane has all bits set, or none.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mask4(__m256d);

/// A table of registers, one for each of the 16 masks.
#[repr(align(32))]
struct RegisterTable([[u32; 8]; 16]);

/// For each mask, the permutation of 32-bit halves that moves the chosen lanes to the front.
static CHOSEN: RegisterTable = RegisterTable(chosen());

/// For each mask, the lanes with all bits set or none.
static LANES: RegisterTable = RegisterTable(lanes());

const fn chosen() -> [[u32; 8]; 16] {
    let mut table = [[0; 8]; 16];
    let mut bits = 0;
    while bits < 16 {
        let (mut lane, mut place) = (0, 0);
        while lane < 4 {
            if bits >> lane & 1 != 0 {
                table[bits][2 * place] = 2 * lane;
                table[bits][2 * place + 1] = 2 * lane + 1;
                place += 1;
            }
            lane += 1;
        }
        bits += 1;
    }
    table
}

const fn lanes() -> [[u32; 8]; 16] {
    let mut table = [[0; 8]; 16];
    let mut bits = 0;
    while bits < 16 {
        let mut half = 0;
        while half < 8 {
            if bits >> (half / 2) & 1 != 0 {
                table[bits][half] = u32::MAX;
            }
            half += 1;
        }
        bits += 1;
    }
    table
}

/// The entry of `table` for a mask.
#[inline(always)]
fn entry(_: Avx2Token, table: &RegisterTable, bits: u8) -> __m256i {
    let row: *const [u32; 8] = &raw const table.0[usize::from(bits & 15)];
    // SAFETY: the token proves AVX2; the row has 32 bytes, and the table is aligned to that.
    unsafe { _mm256_load_si256(row.cast()) }
}

macro_rules! operator {
    ($($trait:ident $method:ident $intrinsic:ident)+) => {
        $(impl $trait for Avx2 {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(intrinsics!($intrinsic(self.0, other.0)))
            }
        })+
    };
}

operator! { Add add _mm256_add_pd Sub sub _mm256_sub_pd Mul mul _mm256_mul_pd Div div _mm256_div_pd }

impl Lanes for Avx2 {
    const COUNT: usize = 4;

    const STORES_SOME_SLOWLY: bool = true;

    type Token = Avx2Token;

    type Mask = Mask4;

    #[inline(always)]
    fn splat(_: Avx2Token, x: f64) -> Self {
        Self(intrinsics!(_mm256_set1_pd(x)))
    }

    #[inline(always)]
    fn places(_: Avx2Token) -> Self {
        Self(intrinsics!(_mm256_set_pd(3.0, 2.0, 1.0, 0.0)))
    }

    #[inline(always)]
    fn mask(simd: Avx2Token, bits: u8) -> Mask4 {
        Mask4(intrinsics!(_mm256_castsi256_pd(entry(simd, &LANES, bits))))
    }

    #[inline(always)]
    unsafe fn load(_: Avx2Token, from: *const f64) -> Self {
        // SAFETY: the token proves AVX2; the caller guarantees the range.
        Self(unsafe { _mm256_loadu_pd(from) })
    }

    #[inline(always)]
    unsafe fn store(self, to: *mut f64) {
        // SAFETY: a vector exists, which proves AVX2; the caller guarantees the range.
        unsafe { _mm256_storeu_pd(to, self.0) }
    }

    #[inline(always)]
    unsafe fn store_chosen(self, mask: Mask4, to: *mut f64) {
        let bits = mask.bits();
        let first = ((1_u32 << bits.count_ones()) - 1) as u8;
        let simd = Avx2Token(());
        // SAFETY: a vector exists, which proves AVX2; only the lanes that the caller guarantees are
        // written.
        unsafe {
            let chosen = entry(simd, &CHOSEN, bits);
            let front = _mm256_permutevar8x32_ps(_mm256_castpd_ps(self.0), chosen);
            _mm256_maskstore_pd(to, entry(simd, &LANES, first), _mm256_castps_pd(front));
        }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(intrinsics!(_mm256_sqrt_pd(self.0)))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(intrinsics!(_mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0)))
    }

    #[inline(always)]
    fn minus_abs(self) -> Self {
        Self(intrinsics!(_mm256_or_pd(_mm256_set1_pd(-0.0), self.0)))
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(intrinsics!(_mm256_min_pd(self.0, other.0)))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(intrinsics!(_mm256_max_pd(self.0, other.0)))
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Mask4 {
        Mask4(intrinsics!(_mm256_cmp_pd::<_CMP_LT_OQ>(self.0, other.0)))
    }

    #[inline(always)]
    fn le(self, other: Self) -> Mask4 {
        Mask4(intrinsics!(_mm256_cmp_pd::<_CMP_LE_OQ>(self.0, other.0)))
    }

    #[inline(always)]
    fn select(mask: Mask4, yes: Self, no: Self) -> Self {
        Self(intrinsics!(_mm256_blendv_pd(no.0, yes.0, mask.0)))
    }

    #[inline(always)]
    fn least(self) -> f64 {
        intrinsics! {
            let two = _mm_min_pd(
                _mm256_castpd256_pd128(self.0),
                _mm256_extractf128_pd::<1>(self.0),
            );
            _mm_cvtsd_f64(_mm_min_sd(two, _mm_unpackhi_pd(two, two)))
        }
    }
}

impl BitAnd for Mask4 {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(intrinsics!(_mm256_and_pd(self.0, other.0)))
    }
}

impl BitOr for Mask4 {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(intrinsics!(_mm256_or_pd(self.0, other.0)))
    }
}

impl Not for Mask4 {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self(intrinsics!(_mm256_xor_pd(
            self.0,
            _mm256_castsi256_pd(_mm256_set1_epi64x(-1))
        )))
    }
}

impl LaneMask for Mask4 {
    #[inline(always)]
    #[allow(clippy::cast_sign_loss)] // The sign is not among the four bits.
    fn bits(self) -> u8 {
        intrinsics!(_mm256_movemask_pd(self.0) as u8)
    }
}
