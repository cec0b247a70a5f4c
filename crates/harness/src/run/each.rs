//! Work on several items, one after the other or at the same time.

use rayon::iter::{ParallelBridge, ParallelIterator};

/// Calls `work` for all items, sequentially or concurrently on the threads of the current pool.
/// Items are started in order, and none is started after an error.
pub(super) fn each<T: Send>(
    mut items: impl Iterator<Item = T> + Send,
    is_parallel: bool,
    work: impl Fn(T) -> anyhow::Result<()> + Send + Sync,
) -> anyhow::Result<()> {
    if is_parallel {
        items.par_bridge().try_for_each(work)
    } else {
        items.try_for_each(work)
    }
}
