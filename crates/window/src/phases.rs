//! The shares of phases in the time of a run, by sampling.
//!
//! Reading a clock at every change of phase would cost more than a short phase takes, and would
//! make short phases look several times as long as they are. Instead the solver stores its phase in
//! one byte, and another thread reads that byte some ten thousand times a second.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU64, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use crate::probe::{Phase, Probe};

/// Least time between two samples. The system's wake-up adds some 50 µs.
const INTERVAL: Duration = Duration::from_micros(50);

/// Time that a run spends in each phase: its duration, divided in proportion to the samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Phases {
    /// Time in [`Phase::Propagation`].
    pub propagation: Duration,
    /// Time in [`Phase::Pruning`].
    pub pruning: Duration,
    /// Time in [`Phase::Management`].
    pub management: Duration,
    /// Number of samples. The standard error of a share p is √(p(1-p) / samples).
    pub samples: u64,
}

/// A thread that samples the phase of the runs passed to [`watch`](PhaseSampler::watch).
///
/// ```
/// use geobench_window::{Phase, PhaseSampler, Probe};
///
/// let mut sampler = PhaseSampler::start()?;
/// while sampler.samples() < 10 {
///     sampler.watch(|probe| probe.enter(Phase::Propagation));
/// }
/// assert!(sampler.phases().samples >= 10);
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug)]
pub struct PhaseSampler {
    shared: Arc<SharedState>,
    thread: Option<JoinHandle<()>>,
    runs: u32,
    elapsed: Duration,
}

/// The state that both threads share.
#[derive(Debug)]
struct SharedState {
    /// The [`Phase`] of the run as a number, or [`IDLE`].
    phase: AtomicU8,
    /// Samples of each phase.
    samples: [AtomicU64; 3],
    /// Whether the thread has made its allocations.
    started: AtomicBool,
    ended: AtomicBool,
}

/// The value of `phase` between runs.
const IDLE: u8 = 3;

/// The probe of a watched run.
#[derive(Clone, Copy, Debug)]
pub struct PhaseProbe<'a>(&'a AtomicU8);

impl Probe for PhaseProbe<'_> {
    #[inline]
    fn enter(&mut self, phase: Phase) {
        self.0.store(phase as u8, Ordering::Relaxed);
    }
}

impl PhaseSampler {
    /// Starts the thread. Dropping the sampler ends it.
    ///
    /// # Errors
    ///
    /// When the system does not start a thread.
    pub fn start() -> io::Result<Self> {
        let shared = Arc::new(SharedState::new());
        let thread = thread::Builder::new().name("phases".to_owned()).spawn({
            let shared = Arc::clone(&shared);
            move || shared.sample()
        })?;
        // Waits until the thread has allocated, so that its memory does not count for a run.
        while !shared.started.load(Ordering::Acquire) {
            thread::yield_now();
        }
        Ok(Self {
            shared,
            thread: Some(thread),
            runs: 0,
            elapsed: Duration::ZERO,
        })
    }

    /// Samples the phases of `run`, which begins in [`Phase::Management`].
    pub fn watch<T>(&mut self, run: impl FnOnce(&mut PhaseProbe<'_>) -> T) -> T {
        let mut probe = PhaseProbe(&self.shared.phase);
        let start = Instant::now();
        probe.enter(Phase::Management);
        let result = run(&mut probe);
        self.shared.phase.store(IDLE, Ordering::Relaxed);
        self.elapsed += start.elapsed();
        self.runs += 1;
        result
    }

    /// Number of samples taken during runs.
    pub fn samples(&self) -> u64 {
        let count = |samples: &AtomicU64| samples.load(Ordering::Relaxed);
        self.shared.samples.iter().map(count).sum()
    }

    /// Whether runs were watched and no sample fell into one. On a busy machine the thread may have
    /// had no turn yet.
    pub fn has_missed_all(&self) -> bool {
        self.runs > 0 && self.samples() == 0
    }

    /// The phases of a run, on average over all runs watched; zero if no sample fell into a run.
    pub fn phases(&self) -> Phases {
        let counts = [0, 1, 2].map(|i: usize| self.shared.samples[i].load(Ordering::Relaxed));
        let samples: u64 = counts.iter().sum();
        let time = |count: u64| {
            let share = count as f64 / samples.max(1) as f64;
            self.elapsed.mul_f64(share) / self.runs.max(1)
        };
        Phases {
            propagation: time(counts[Phase::Propagation as usize]),
            pruning: time(counts[Phase::Pruning as usize]),
            management: time(counts[Phase::Management as usize]),
            samples,
        }
    }
}

impl Drop for PhaseSampler {
    fn drop(&mut self) {
        self.shared.ended.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // The thread only sleeps and counts, so it cannot panic.
            thread.join().ok();
        }
    }
}

impl SharedState {
    fn new() -> Self {
        Self {
            phase: AtomicU8::new(IDLE),
            samples: Default::default(),
            started: AtomicBool::new(false),
            ended: AtomicBool::new(false),
        }
    }

    /// The loop of the thread.
    fn sample(&self) {
        self.started.store(true, Ordering::Release);
        while !self.ended.load(Ordering::Relaxed) {
            self.look();
            thread::sleep(INTERVAL);
        }
    }

    /// Takes a sample, unless no run is watched.
    fn look(&self) {
        let phase = usize::from(self.phase.load(Ordering::Relaxed));
        if let Some(samples) = self.samples.get(phase) {
            samples.fetch_add(1, Ordering::Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The test takes the samples, so that they do not depend on the turns of a thread.
    #[test]
    fn time_is_divided_in_proportion_to_the_samples() {
        let shared = Arc::new(SharedState::new());
        let mut sampler = PhaseSampler {
            shared: Arc::clone(&shared),
            thread: None,
            runs: 0,
            elapsed: Duration::ZERO,
        };
        sampler.watch(|_| ());
        assert!(sampler.has_missed_all());
        sampler.watch(|probe| {
            thread::sleep(Duration::from_millis(1));
            shared.look();
            probe.enter(Phase::Pruning);
            (0..3).for_each(|_| shared.look());
        });
        shared.look();
        assert!(!sampler.has_missed_all());
        let phases = sampler.phases();
        assert_eq!(phases.samples, 4);
        let [pruning, management] = [phases.pruning, phases.management].map(|t| t.as_secs_f64());
        assert!(management > 0.0 && (pruning / management - 3.0).abs() < 1e-3);
        assert_eq!(phases.propagation, Duration::ZERO);
    }

    #[test]
    fn nothing_is_sampled_outside_of_runs() {
        let sampler = PhaseSampler::start().unwrap();
        thread::sleep(Duration::from_millis(2));
        assert_eq!(sampler.phases(), Phases::default());
    }
}
