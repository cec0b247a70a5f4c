//! One program for each set of instructions.

// Here the processor is asked what it has, and here alone the promise to all kernels is given.
#![allow(unsafe_code)]

#[cfg(target_arch = "x86_64")]
use super::lanes::{Avx2, Avx512};
use super::lanes::{Lanes, Scalar};
use geobench_window::simd::Instructions;

/// Something that is compiled for every set of instructions.
pub(crate) trait Program {
    /// What comes of it.
    type Output;

    /// Runs it. Must be inlined, so that it is compiled for the features of its caller.
    ///
    /// # Safety
    ///
    /// The processor must know the instructions of `L`.
    unsafe fn run<L: Lanes>(self) -> Self::Output;
}

/// Runs `program` with `instructions`, which the processor has.
#[inline]
pub(crate) fn run<T: Program>(program: T, instructions: Instructions) -> T::Output {
    debug_assert!(instructions.is_available());
    match instructions {
        // SAFETY: every processor can count to one.
        Instructions::Scalar => unsafe { program.run::<Scalar>() },
        // SAFETY: options hold only instructions that the processor has.
        #[cfg(target_arch = "x86_64")]
        Instructions::Avx2 => unsafe { run_avx2(program) },
        // SAFETY: likewise.
        #[cfg(target_arch = "x86_64")]
        Instructions::Avx512 => unsafe { run_avx512(program) },
        #[cfg(not(target_arch = "x86_64"))]
        Instructions::Avx2 | Instructions::Avx512 => unreachable!("not on this processor"),
    }
}

/// # Safety
///
/// The processor must have these features.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2,popcnt,lzcnt")]
unsafe fn run_avx2<T: Program>(program: T) -> T::Output {
    // SAFETY: promised by the caller.
    unsafe { program.run::<Avx2>() }
}

/// # Safety
///
/// The processor must have these features.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,bmi1,bmi2,popcnt,lzcnt")]
unsafe fn run_avx512<T: Program>(program: T) -> T::Output {
    // SAFETY: promised by the caller.
    unsafe { program.run::<Avx512>() }
}

/// Runs `program` with the instructions of `L`, from within one that was compiled for `L` as well,
/// in a function of its own where registers have 512 bits.
///
/// Constants that the program keeps in such registers would be loaded again and again by what runs
/// around it, and one such instruction slows down all others for a while.
///
/// # Safety
///
/// The processor must know the instructions of `L`.
#[inline(always)]
pub(crate) unsafe fn run_apart<L: Lanes, T: Program>(program: T) -> T::Output {
    #[cfg(target_arch = "x86_64")]
    if L::COUNT == Avx512::COUNT {
        // SAFETY: promised by the caller; nothing else has so many lanes.
        return unsafe { run_avx512_apart(program) };
    }
    // SAFETY: promised by the caller.
    unsafe { program.run::<L>() }
}

/// [`run_avx512`] is not inlined into a function without its features, and this one into none; on
/// one that has both attributes, the compiler forgets the one against inlining.
///
/// # Safety
///
/// The processor must have the features.
#[cfg(target_arch = "x86_64")]
#[inline(never)]
unsafe fn run_avx512_apart<T: Program>(program: T) -> T::Output {
    // SAFETY: promised by the caller.
    unsafe { run_avx512(program) }
}
