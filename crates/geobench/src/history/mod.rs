//! What is done with several result files: two are compared, the rounds of one are pooled, the
//! parts of a sharded run are merged.

pub mod compare;
pub mod merge;
pub mod pool;
