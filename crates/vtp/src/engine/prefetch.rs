//! Requests for cache lines before they are needed.

use geobench_window::prefetch_line;

/// Prefetches the cache line in which `values[i]` starts, if there is such a value.
#[inline(always)]
pub(crate) fn prefetch<T>(values: &[T], i: usize) {
    if let Some(value) = values.get(i) {
        prefetch_line(value);
    }
}
