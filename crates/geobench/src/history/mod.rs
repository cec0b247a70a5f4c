//! Several result files together: two are compared, and rounds that took turns are pooled.

pub mod compare;
pub mod pool;
