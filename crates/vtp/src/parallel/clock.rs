//! The working time of a thread.

/// A clock reading. The processor's time-stamp counter takes 12 ns, the system's clock 70 ns.
/// Threads read it after each turn, which takes some microseconds on models of some thousand faces.
#[cfg(target_arch = "x86_64")]
type Reading = u64;
#[cfg(not(target_arch = "x86_64"))]
type Reading = std::time::Instant;

/// The working time of a thread in a run.
///
/// It only decides how much work a thread hands off. Differences between the counters of processors
/// are harmless.
#[derive(Debug)]
pub(super) struct Clock {
    started: Reading,
    waited: u64,
}

impl Clock {
    /// Starts the clock of a thread.
    pub(super) fn start() -> Self {
        Self {
            started: now(),
            waited: 0,
        }
    }

    /// The time since the start without the waits, in a unit that all threads share.
    #[inline(always)]
    pub(super) fn busy(&self) -> u64 {
        since(self.started).saturating_sub(self.waited)
    }

    /// Runs `wait`, whose duration does not count as work.
    pub(super) fn pause<T>(&mut self, wait: impl FnOnce() -> T) -> T {
        let before = now();
        let result = wait();
        self.waited += since(before);
        result
    }
}

#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code)] // A system may forbid it (Linux: `PR_SET_TSC`), and ends the program then.
#[inline(always)]
fn now() -> Reading {
    unsafe { std::arch::x86_64::_rdtsc() }
}

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn since(before: Reading) -> u64 {
    now().saturating_sub(before)
}

#[cfg(not(target_arch = "x86_64"))]
fn now() -> Reading {
    Reading::now()
}

#[cfg(not(target_arch = "x86_64"))]
fn since(before: Reading) -> u64 {
    u64::try_from(before.elapsed().as_nanos()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::thread;
    use std::time::Duration;

    #[test]
    fn what_a_thread_waits_is_not_work() {
        let mut clock = Clock::start();
        let slept = clock.pause(|| {
            let inside = Clock::start();
            thread::sleep(Duration::from_millis(1));
            inside.busy()
        });
        assert!(slept > 0 && clock.waited >= slept);
        let (worked, all) = (clock.busy(), since(clock.started));
        assert!(worked > 0 && worked + clock.waited <= all);
    }
}
