//! Peak memory of a run.
//!
//! There are two figures. Heap bytes are counted by the allocator that the binary installs. Peak
//! RSS of the process is read from Linux. It covers what the process holds: mesh, solver, code, and
//! what loading and earlier runs have left in the allocator.
//!
//! The allocator also counts during timed runs. It costs at most 0.3 % of the instructions of a
//! solve and no measurable time, since solvers keep their buffers between runs and allocate rarely.

use peakmem_alloc::{INSTRUMENTED_SYSTEM, PeakMemAllocTrait};
use serde::{Deserialize, Serialize};

use crate::measure::host::kibibytes;

/// Measures from [`start`](PeakMemory::start) to [`stop`](PeakMemory::stop). The counters are
/// global, so at most one measurement can be active.
#[derive(Debug)]
pub struct PeakMemory {
    rss_was_reset: bool,
}

/// The peaks in bytes. A figure that this system or build does not provide is absent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Peaks {
    /// Peak heap bytes in addition to those at the start.
    pub heap: Option<u64>,
    /// Peak RSS of the process.
    pub rss: Option<u64>,
}

impl PeakMemory {
    /// Starts measuring.
    pub fn start() -> Self {
        // 5 resets `VmHWM`. `ru_maxrss` of a child cannot be used: it includes memory of the parent
        // from before exec.
        let rss_was_reset = std::fs::write("/proc/self/clear_refs", "5").is_ok();
        INSTRUMENTED_SYSTEM.reset_peak_memory();
        Self { rss_was_reset }
    }

    /// The peaks since the start.
    pub fn stop(self) -> Peaks {
        let heap = INSTRUMENTED_SYSTEM.get_peak_memory() as u64;
        Peaks {
            // Zero means that the allocator is not installed.
            heap: (heap > 0).then_some(heap),
            rss: self
                .rss_was_reset
                .then(|| kibibytes("/proc/self/status", "VmHWM"))
                .flatten(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn the_peak_of_the_process_follows_an_allocation() {
        let measure = PeakMemory::start();
        let block = std::hint::black_box(vec![1_u8; 64 << 20]);
        let peak = measure.stop().rss.unwrap();
        drop(block);
        assert!(peak >= 64 << 20, "{peak}");
    }
}
