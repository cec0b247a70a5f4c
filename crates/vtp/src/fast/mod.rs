//! VTP for speed; see [`vtp_fast`](crate::algorithms::vtp_fast) for what it does, and
//! [`propagation`] for how.

// The kernels must be inlined into the functions that have the features of the processor.
#![allow(clippy::inline_always)]

#[doc(hidden)]
pub mod bench_support;
mod buckets;
mod dispatch;
mod kernels;
mod lanes;
mod numbering;
mod options;
mod prefetch;
mod propagation;
mod spawn;
mod store;
mod surface;

pub use options::{Instructions, Options};
pub use propagation::VtpFast;
