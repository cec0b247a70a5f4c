//! The time that a thread has worked.

/// A reading of a clock: the processor's own counter, at 12 ns, where the system's takes 70.
/// Threads read it after each turn, which takes some microseconds on models of some thousand faces.
#[cfg(target_arch = "x86_64")]
type Reading = u64;
#[cfg(not(target_arch = "x86_64"))]
type Reading = std::time::Instant;

/// The time that a thread has worked in a run.
///
/// It decides only how much work a thread hands to another, so differences between the counters of
/// processors do no harm.
#[derive(Debug)]
pub(super) struct Clock {
    started: Reading,
    waited: u64,
}

impl Clock {
    /// The thread begins.
    pub(super) fn start() -> Self {
        Self {
            started: now(),
            waited: 0,
        }
    }

    /// The time less the waits, in a unit that is the same for all threads.
    #[inline(always)]
    pub(super) fn busy(&self) -> u64 {
        since(self.started).saturating_sub(self.waited)
    }

    /// Does `wait`, during which the thread does not work.
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
