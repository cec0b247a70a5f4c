//! The threads of a command.

use rayon::{ThreadPool, ThreadPoolBuilder};

/// The threads that share the work of a command. A single one is that of the caller.
pub(super) struct Threads(Option<ThreadPool>);

impl Threads {
    pub(super) fn start(count: u32) -> anyhow::Result<Self> {
        let pool = || ThreadPoolBuilder::new().num_threads(count as usize).build();
        Ok(Self((count > 1).then(pool).transpose()?))
    }

    /// Runs `work`. Its parallel loops use the threads.
    pub(super) fn run<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match &self.0 {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }
}
