//! Crossings compiled for the instructions of the processor.

// A function with processor features is only called after the check that they are there.
#![allow(unsafe_code)]

use super::Crossings;
use crate::frame::Faces;
use crate::simd::Instructions;

/// The instructions for which the crossings are compiled. Results are the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Program {
    /// Those that every processor of this kind has.
    Portable,
    /// Four numbers at a time.
    #[cfg(target_arch = "x86_64")]
    Avx2(Avx2),
}

/// A processor that has AVX2.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Avx2(());

impl Program {
    /// For `instructions`, or narrower ones if the processor lacks them. AVX-512 is of no use here.
    pub(super) fn new(instructions: Instructions) -> Self {
        match instructions.min(Instructions::Avx2).or_narrower() {
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx2 => Self::Avx2(Avx2(())),
            _ => Self::Portable,
        }
    }

    #[inline]
    pub(super) fn run(self, crossings: &mut Crossings, faces: &Faces) {
        match self {
            Self::Portable => run_portable(crossings, faces),
            // SAFETY: `new` makes such a program on a processor that has AVX2 only.
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(_) => unsafe { run_avx2(crossings, faces) },
        }
    }
}

#[inline(never)]
fn run_portable(crossings: &mut Crossings, faces: &Faces) {
    crossings.run(faces);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn run_avx2(crossings: &mut Crossings, faces: &Faces) {
    crossings.run(faces);
}
