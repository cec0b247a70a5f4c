//! What is measured beside the answer: memory, instructions, the machine and its condition, and the
//! statistics of repeated times.

pub mod conditions;
pub mod host;
pub mod instructions;
pub mod memory;
pub(crate) mod number;
pub(crate) mod rng;
pub mod statistics;
