//! VTP for speed; see [`vtp_fast`](crate::algorithms::vtp_fast) for what it does, and
//! [`propagation`] for how.

// The kernels must be inlined into the functions that have the features of the processor.
#![allow(clippy::inline_always)]

mod options;
mod propagation;
mod spawn;

pub use options::{Instructions, Options};
pub use propagation::VtpFast;
