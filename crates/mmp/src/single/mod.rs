//! MMP with windows propagated one at a time, as in the papers.
//!
//! [`Trimming`] is the policy: a window is inserted into the sorted list of its half-edge or edge
//! and split at tie points with the windows that it overlaps. Any
//! [`Discipline`](geobench_window::queue::Discipline) orders the windows that wait.

pub(crate) mod insertion;
pub(crate) mod lists;
mod trimming;

pub use trimming::{Carrier, Trimming, windows_of};
