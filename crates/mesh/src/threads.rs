//! Parallel loops in a pool of `rayon`.

use std::ops::Range;

use rayon::iter::{IntoParallelIterator, ParallelIterator};

/// The number of threads that share work: those of the `rayon` pool of the caller, or one outside
/// of any pool.
pub fn count() -> usize {
    rayon::current_thread_index().map_or(1, |_| rayon::current_num_threads())
}

/// Applies `work` to each of `parts`, in any order. The results are in the order of the parts.
pub fn each<T: Send, R: Send>(parts: Vec<T>, work: impl Fn(T) -> R + Sync + Send) -> Vec<R> {
    if count() == 1 {
        parts.into_iter().map(work).collect()
    } else {
        parts.into_par_iter().map(work).collect()
    }
}

/// Divides `0..n` into ranges of nearly equal size: `pieces` for each thread, or one range for a
/// single thread or a small `n`.
pub fn ranges(n: usize, pieces: usize) -> Vec<Range<usize>> {
    const LITTLE: usize = 20_000;
    let threads = if n < LITTLE { 1 } else { count() };
    let parts = if threads == 1 { 1 } else { pieces * threads };
    (0..parts)
        .map(|part| n * part / parts..n * (part + 1) / parts)
        .collect()
}

/// Cuts `items` into consecutive slices of these lengths.
///
/// # Panics
///
/// If there are fewer items.
pub fn cut<T>(mut items: &mut [T], lengths: impl Iterator<Item = usize>) -> Vec<&mut [T]> {
    lengths
        .map(|length| {
            let (part, rest) = std::mem::take(&mut items).split_at_mut(length);
            items = rest;
            part
        })
        .collect()
}
