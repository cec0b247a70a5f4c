//! Measurements of runs: memory, the machine and its state, statistics of times.

pub mod conditions;
pub mod host;
pub mod mann_whitney;
pub mod memory;
pub mod number;
pub mod statistics;
