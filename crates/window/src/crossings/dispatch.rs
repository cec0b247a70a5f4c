//! The program for the processor that is there.

// A function with features of the processor can only be called so; each call follows the check that
// they are there.
#![allow(unsafe_code)]

use super::Crossings;
use crate::frame::Faces;

/// For which instructions the crossings are compiled. Results are the same.
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
    /// The fastest one that this processor can run.
    pub(super) fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") {
            return Self::Avx2(Avx2(()));
        }
        Self::Portable
    }

    #[inline]
    pub(super) fn run(self, crossings: &mut Crossings, faces: &Faces) {
        match self {
            Self::Portable => run_portable(crossings, faces),
            // SAFETY: `best` makes such a program on a processor that has AVX2 only.
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
