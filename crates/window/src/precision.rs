//! Placeholder.

pub use geobench_mesh::precision::{GRAIN, MARGIN};
