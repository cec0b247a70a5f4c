//! [`VtpFast`]: one wavefront on one thread; see
//! [`wavefront`](crate::wavefront).

// The kernels must be inlined into the functions that have the features of the processor.
#![allow(clippy::inline_always)]

mod options;
mod serial_state;
mod solver;

pub use options::Options;
pub use solver::VtpFast;
