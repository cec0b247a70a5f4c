//! One program for each set of instructions.

#![allow(unsafe_code)]

use geobench_window::Probe;

use super::lanes::Scalar;
#[cfg(target_arch = "x86_64")]
use super::lanes::{Avx2, Avx512};
use super::options::Instructions;
use super::propagation::VtpFast;

/// Runs `solver`, whose sources have had their turns, to the end, with `instructions`, which the processor has.
pub(super) fn run<P: Probe>(solver: &mut VtpFast<'_>, instructions: Instructions, probe: &mut P) {
    match instructions {
        // SAFETY: every processor can count to one.
        Instructions::Scalar => unsafe { solver.run::<Scalar, P>(probe) },
        // SAFETY: options hold only instructions that the processor has.
        #[cfg(target_arch = "x86_64")]
        Instructions::Avx2 => unsafe { run_avx2(solver, probe) },
        // SAFETY: likewise.
        #[cfg(target_arch = "x86_64")]
        Instructions::Avx512 => unsafe { run_avx512(solver, probe) },
        #[cfg(not(target_arch = "x86_64"))]
        Instructions::Avx2 | Instructions::Avx512 => unreachable!("not on this processor"),
    }
}

/// # Safety
///
/// The processor must have these features.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2,popcnt,lzcnt")]
unsafe fn run_avx2<P: Probe>(solver: &mut VtpFast<'_>, probe: &mut P) {
    // SAFETY: promised by the caller.
    unsafe { solver.run::<Avx2, P>(probe) }
}

/// # Safety
///
/// The processor must have these features.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,bmi1,bmi2,popcnt,lzcnt")]
unsafe fn run_avx512<P: Probe>(solver: &mut VtpFast<'_>, probe: &mut P) {
    // SAFETY: promised by the caller.
    unsafe { solver.run::<Avx512, P>(probe) }
}
