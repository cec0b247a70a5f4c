//! Work shared by the threads of a pool.

use std::ops::Range;

use rayon::iter::{IntoParallelIterator, ParallelIterator};

/// How many threads there are to share work: those of the pool of `rayon` in which the caller runs,
/// outside of any pool one.
pub fn count() -> usize {
    rayon::current_thread_index().map_or(1, |_| rayon::current_num_threads())
}

/// Does `work` for each of `parts`, in any order; the results are in theirs.
pub fn each<T: Send, R: Send>(parts: Vec<T>, work: impl Fn(T) -> R + Sync + Send) -> Vec<R> {
    if count() == 1 {
        parts.into_iter().map(work).collect()
    } else {
        parts.into_par_iter().map(work).collect()
    }
}

/// `0..n` in parts of equal size, to one: `pieces` for each thread; one for a single thread, or where
/// there is little to do.
pub fn ranges(n: usize, pieces: usize) -> Vec<Range<usize>> {
    const LITTLE: usize = 20_000;
    let threads = if n < LITTLE { 1 } else { count() };
    let parts = if threads == 1 { 1 } else { pieces * threads };
    (0..parts)
        .map(|part| n * part / parts..n * (part + 1) / parts)
        .collect()
}

/// Cuts `items` into parts of these lengths.
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
