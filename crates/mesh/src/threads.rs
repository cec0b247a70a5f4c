//! Parallel loops in a pool of `rayon`.

use std::ops::Range;

use rayon::iter::{IntoParallelIterator, ParallelIterator};
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

/// Threads that share work. A single one is that of the caller.
///
/// ```
/// use geobench_mesh::Mesh;
/// use geobench_mesh::threads::Threads;
///
/// let threads = Threads::start(2)?;
/// let mesh = threads.run(|| Mesh::generate("torus,faces=30000"))?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Threads(Option<ThreadPool>);

impl Threads {
    /// Starts `count` threads.
    ///
    /// # Errors
    ///
    /// If the system cannot start them.
    pub fn start(count: usize) -> Result<Self, ThreadPoolBuildError> {
        let pool = || ThreadPoolBuilder::new().num_threads(count).build();
        Ok(Self((count > 1).then(pool).transpose()?))
    }

    /// Runs `work`. Its parallel loops use the threads.
    pub fn run<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match &self.0 {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }
}

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

/// Appends `part` to `all`. The first part is not copied.
pub fn append<T>(all: &mut Vec<T>, mut part: Vec<T>) {
    if all.is_empty() {
        *all = part;
    } else {
        all.append(&mut part);
    }
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
