//! Values with a cache line of their own, against false sharing.

/// A value in cache lines of its own; two, since processors fetch lines in pairs.
#[derive(Debug, Default)]
#[repr(align(128))]
pub(super) struct Padded<T>(pub(super) T);
