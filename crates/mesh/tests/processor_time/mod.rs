//! The processor time of a thread: unlike the time that passes, it does not depend on what else the
//! machine does.

use std::time::Duration;

/// A moment of the processor time of this thread.
pub(crate) struct ProcessorTime(Duration);

impl ProcessorTime {
    /// The processor time so far; 0 where the system does not tell it.
    pub(crate) fn now() -> Self {
        let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
        let nanoseconds = text.split_whitespace().next();
        let nanoseconds = nanoseconds.and_then(|number| number.parse().ok());
        Self(Duration::from_nanos(nanoseconds.unwrap_or(0)))
    }

    /// The processor time since then.
    pub(crate) fn elapsed(&self) -> Duration {
        Self::now().0.saturating_sub(self.0)
    }
}
