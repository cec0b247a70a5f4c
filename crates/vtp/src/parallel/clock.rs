//! The working time of a thread.

use std::time::{Duration, Instant};

/// The working time of a thread in a run.
///
/// It only decides how much work a thread hands off.
#[derive(Debug)]
pub(super) struct Clock {
    started: Instant,
    waited: Duration,
}

impl Clock {
    /// Starts the clock of a thread.
    pub(super) fn start() -> Self {
        Self {
            started: Instant::now(),
            waited: Duration::ZERO,
        }
    }

    /// The time since the start without the waits, in nanoseconds.
    pub(super) fn busy(&self) -> u64 {
        let busy = self.started.elapsed().saturating_sub(self.waited);
        u64::try_from(busy.as_nanos()).unwrap_or(u64::MAX)
    }

    /// Runs `wait`, whose duration does not count as work.
    pub(super) fn pause<T>(&mut self, wait: impl FnOnce() -> T) -> T {
        let before = Instant::now();
        let result = wait();
        self.waited += before.elapsed();
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::thread;

    #[test]
    fn waiting_is_not_work() {
        let mut clock = Clock::start();
        let slept = clock.pause(|| {
            let inside = Clock::start();
            thread::sleep(Duration::from_millis(1));
            inside.busy()
        });
        let waited = clock.waited;
        assert!(slept > 0 && waited >= Duration::from_nanos(slept));
        let (worked, all) = (clock.busy(), clock.started.elapsed());
        assert!(worked > 0 && waited + Duration::from_nanos(worked) <= all);
    }
}
