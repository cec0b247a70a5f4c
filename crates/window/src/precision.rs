//! Placeholder.

pub use geobench_mesh::precision::MARGIN;
