//! Programs compiled for every instruction set.

// The functions for an instruction set are called here alone, with the token of the set.
#![allow(unsafe_code)]

use super::instructions::Instructions;
use super::lanes::Lanes;
use super::scalar::Scalar;
#[cfg(target_arch = "x86_64")]
use super::{
    avx2::{Avx2, Avx2Token},
    avx512::{Avx512, Avx512Token},
};

/// A program that is compiled for every instruction set.
pub trait SimdProgram {
    /// The result.
    type Output;

    /// Runs the program with the instructions of `L`. This function, and every function that it
    /// passes vectors to, must be `#[inline(always)]`, so that it is compiled with the features of
    /// its caller.
    fn run<L: Lanes>(self, simd: L::Token) -> Self::Output;
}

/// The proof that this processor has an instruction set. Made by detection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Simd(DispatchKind);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum DispatchKind {
    Scalar,
    #[cfg(target_arch = "x86_64")]
    Avx2(Avx2Token),
    #[cfg(target_arch = "x86_64")]
    Avx512(Avx512Token),
}

impl Simd {
    /// The proof for `instructions`, or for narrower ones if the processor lacks them.
    pub fn new(instructions: Instructions) -> Self {
        #[cfg(target_arch = "x86_64")]
        if instructions >= Instructions::Avx512
            && let Some(token) = Avx512Token::detect()
        {
            return Self(DispatchKind::Avx512(token));
        }
        #[cfg(target_arch = "x86_64")]
        if instructions >= Instructions::Avx2
            && let Some(token) = Avx2Token::detect()
        {
            return Self(DispatchKind::Avx2(token));
        }
        let _ = instructions;
        Self(DispatchKind::Scalar)
    }

    /// The instructions in use.
    pub fn instructions(self) -> Instructions {
        match self.0 {
            DispatchKind::Scalar => Instructions::Scalar,
            #[cfg(target_arch = "x86_64")]
            DispatchKind::Avx2(_) => Instructions::Avx2,
            #[cfg(target_arch = "x86_64")]
            DispatchKind::Avx512(_) => Instructions::Avx512,
        }
    }

    /// Runs `program` with these instructions.
    #[inline]
    pub fn run<T: SimdProgram>(self, program: T) -> T::Output {
        match self.0 {
            DispatchKind::Scalar => program.run::<Scalar>(()),
            // SAFETY: the token proves that the processor has the features.
            #[cfg(target_arch = "x86_64")]
            DispatchKind::Avx2(token) => unsafe { run_avx2(program, token) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            DispatchKind::Avx512(token) => unsafe { run_avx512(program, token) },
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2,popcnt,lzcnt")]
fn run_avx2<T: SimdProgram>(program: T, token: Avx2Token) -> T::Output {
    program.run::<Avx2>(token)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,bmi1,bmi2,popcnt,lzcnt")]
fn run_avx512<T: SimdProgram>(program: T, token: Avx512Token) -> T::Output {
    program.run::<Avx512>(token)
}

/// Keeps [`run_avx512`] out of its caller. `run_avx512` cannot be inlined into this function, which
/// lacks its features, and this function is never inlined. With both attributes on one function the
/// compiler would drop `inline(never)`.
#[cfg(target_arch = "x86_64")]
#[inline(never)]
pub(super) fn run_avx512_apart<T: SimdProgram>(program: T, token: Avx512Token) -> T::Output {
    // SAFETY: the token proves that the processor has the features.
    unsafe { run_avx512(program, token) }
}
