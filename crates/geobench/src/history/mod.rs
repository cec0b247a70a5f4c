//! Several result files: compared, pooled, joined; and histories of many commits.

pub mod changes;
pub mod compare;
pub mod gate;
pub mod join;
pub mod pool;
pub mod records;
pub mod trend;
