//! Values in separate cache lines, to avoid false sharing.

/// A value in cache lines of its own. It takes two, because processors fetch lines in pairs.
#[derive(Debug, Default)]
#[repr(align(128))]
pub(super) struct Padded<T>(pub(super) T);
