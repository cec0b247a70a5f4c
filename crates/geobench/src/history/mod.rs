//! Several result files: compared, pooled, joined.

pub mod compare;
pub mod join;
pub mod pool;
