//! Measurements beside the answer: memory, instructions, the machine and its conditions, statistics
//! of times.

pub mod conditions;
pub mod host;
pub mod instructions;
pub mod memory;
pub(crate) mod number;
pub mod statistics;
