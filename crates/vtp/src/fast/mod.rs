//! VTP for speed; see [`vtp_fast`](crate::algorithms::vtp_fast) for what it does, and
//! [`wavefront`](crate::wavefront) for how.

// The kernels must be inlined into the functions that have the features of the processor.
#![allow(clippy::inline_always)]

mod options;
mod serial_state;
mod solver;

pub use options::Options;
pub use solver::VtpFast;
