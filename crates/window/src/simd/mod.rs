//! Vector instructions: detection at run time, and generic code over several numbers at once.
//!
//! A [`SimdProgram`] is written once, generic over [`Lanes`], and compiled for every instruction
//! set. [`Simd`] is the proof that the processor has a set. Detection makes it. Its
//! [`run`](Simd::run) passes the program a zero-sized *token* ([`Lanes::Token`]). Vectors can be
//! made only with a token. [`Columns`], [`Block`], [`InPlace`] and [`Scratch`] are bounds-checked
//! views of structures of arrays. Programs therefore need no unsafe code.
//!
//! All operations round as IEEE 754 prescribes, and none is fused. Every set gives the same bits.
//!
//! ```
//! use geobench_window::simd::{Columns, Instructions, Lanes, CacheLine, Simd, SimdProgram};
//!
//! /// The least of x + y.
//! struct LeastSum<'a>(Columns<'a, 2>);
//!
//! impl SimdProgram for LeastSum<'_> {
//!     type Output = f64;
//!
//!     #[inline(always)]
//!     fn run<L: Lanes>(self, simd: L::Token) -> f64 {
//!         let infinite = L::splat(simd, f64::INFINITY);
//!         let mut least = infinite;
//!         for register in 0..self.0.registers::<L>() {
//!             let [x, y] = self.0.load::<L>(simd, register);
//!             let listed = self.0.listed::<L>(simd, register);
//!             least = least.min(L::select(listed, x + y, infinite));
//!         }
//!         least.least()
//!     }
//! }
//!
//! let (x, y) = (CacheLine([5.0, 3.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0]), CacheLine([0.5; 8]));
//! for instructions in Instructions::ALL {
//!     let lines = [x, y];
//!     let least = LeastSum(Columns::new(&lines, 1, 3));
//!     assert_eq!(Simd::new(instructions).run(least), 3.5);
//! }
//! ```

// Generic code must be inlined into the functions that are compiled for an instruction set.
#![allow(clippy::inline_always)]

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod columns;
mod dispatch;
mod instructions;
mod lanes;
mod scalar;

pub use columns::{Block, CacheLine, Columns, InPlace, PaddedBlock, Scratch, Sink};
pub use dispatch::{Simd, SimdProgram};
pub use instructions::{Instructions, UnknownInstructions};
pub use lanes::{LaneMask, Lanes};
pub use scalar::Scalar;
