//! How much memory a run takes at its peak.
//!
//! Two figures: bytes that the program holds on the heap, counted by the allocator that the binary
//! installs, and memory that the whole process occupies, as Linux accounts for it. The second includes the mesh and the code
//! that the run needs; a cell gives back the code that ran before, to read the model or for an earlier run.
//!
//! The allocator counts in timed runs too, since a program has but one. What that costs was measured
//! with Valgrind, as instructions of a solve of `gen:torus,faces=5000,bump=0.1,seed=7` in two builds
//! that differ in nothing else: mmp{turn=window} 0.29 %, fwp-mmp{turn=window} 0.26 %, vtp 0.04 %, ich and fwp-ch 0.001 %
//! more than without it. The least of 360 times of each, of alternating calls of both builds with
//! 2,000 faces, is between 2.7 % less and 2.0 % more with it, less for four of the five: noise.
//! The solvers allocate seldom, because their buffers live on from run to run.

mod clean_pages;

use peakmem_alloc::{INSTRUMENTED_SYSTEM, PeakMemAllocTrait};
use serde::{Deserialize, Serialize};

pub(crate) use self::clean_pages::give_back as give_back_clean_pages;
use crate::measure::host::kibibytes;

/// Measures from [`start`](PeakMemory::start) to [`stop`](PeakMemory::stop). Only one may be
/// under way at a time: the counters behind it are the process's.
#[derive(Debug)]
pub struct PeakMemory {
    rss_was_reset: bool,
}

/// What a measurement found; a figure that this system or build does not have is absent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Peaks {
    /// Most bytes on the heap beyond those at the start.
    pub heap: Option<u64>,
    /// Most memory that the process occupied, everything included.
    pub rss: Option<u64>,
}

impl PeakMemory {
    /// Starts measuring.
    pub fn start() -> Self {
        // 5 resets the peak that `VmHWM` shows. The figure the parent process gets for its child
        // cannot be used: it includes what was inherited before exec.
        let rss_was_reset = std::fs::write("/proc/self/clear_refs", "5").is_ok();
        INSTRUMENTED_SYSTEM.reset_peak_memory();
        Self { rss_was_reset }
    }

    /// The peaks since the start.
    pub fn stop(self) -> Peaks {
        let heap = INSTRUMENTED_SYSTEM.get_peak_memory() as u64;
        Peaks {
            // Nothing allocated at all means that the allocator is not installed.
            heap: (heap > 0).then_some(heap),
            rss: self
                .rss_was_reset
                .then(|| kibibytes("/proc/self/status", "VmHWM"))
                .flatten(),
        }
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn the_peak_of_the_process_follows_an_allocation() {
        let measure = PeakMemory::start();
        let block = std::hint::black_box(vec![1_u8; 64 << 20]);
        let peak = measure.stop().rss.unwrap();
        drop(block);
        assert!(peak >= 64 << 20, "{peak}");
    }
}
