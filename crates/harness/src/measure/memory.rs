//! Peak memory of a run.
//!
//! There are two figures. Heap bytes are counted by the allocator that the binary installs. Peak
//! RSS of the process is read from Linux. It covers the pages touched during the run: mesh, solver
//! and code. Code pages of loading and of earlier runs are released before the run.
//!
//! The allocator also counts during timed runs. It costs at most 0.3 % of the instructions of a
//! solve and no measurable time, since solvers keep their buffers between runs and allocate rarely.

#![allow(unsafe_code)]

use std::ops::Range;

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

/// Releases all unmodified pages of mapped files, most of them code.
///
/// Loading touches some megabytes of code (Linux maps 64 KB around each page), more than the memory
/// of a model of 6,000 faces and its solver. Pages that the run needs are mapped again on the next
/// access, within microseconds, and count towards its peak.
///
/// Only for a process in which no other thread maps or unmaps files, such as the process of a cell.
/// Does nothing if the system does not list mappings.
#[cfg(target_os = "linux")]
pub(crate) fn give_back_clean_pages() {
    let Ok(smaps) = std::fs::read_to_string("/proc/self/smaps") else {
        return;
    };
    for Range { start, end } in unchanged(&smaps) {
        // SAFETY: the kernel lists the range as a private, read-only mapping of a file without
        // modified pages, so its pages are read from the file again on access. Only processes of
        // cells call this. No other thread of them maps files, so the range is still that mapping.
        let _ = unsafe {
            rustix::mm::madvise(
                std::ptr::without_provenance_mut(start),
                end - start,
                rustix::mm::Advice::LinuxDontNeed,
            )
        };
    }
}

/// Does nothing: this system does not list the mappings.
#[cfg(not(target_os = "linux"))]
pub(crate) fn give_back_clean_pages() {}

/// The address ranges of private, read-only mappings of files without modified pages, from the text
/// of `/proc/self/smaps`. Relocated pages that the dynamic linker made read-only count as modified.
#[cfg_attr(not(target_os = "linux"), allow(dead_code))]
fn unchanged(smaps: &str) -> Vec<Range<usize>> {
    let mut ranges = Vec::new();
    let mut candidate = None;
    for line in smaps.lines() {
        if let Some((range, is_file)) = mapping(line) {
            candidate = is_file.then_some(range);
        } else if line
            .strip_prefix("Anonymous:")
            .is_some_and(|size| size.trim() == "0 kB")
        {
            ranges.extend(candidate.take());
        }
    }
    ranges
}

/// Parses the first line of a mapping: its range, and whether it is a private, read-only mapping of
/// a file. `None` for other lines.
fn mapping(line: &str) -> Option<(Range<usize>, bool)> {
    let mut fields = line.split_ascii_whitespace();
    let (start, end) = fields.next()?.split_once('-')?;
    let start = usize::from_str_radix(start, 16).ok()?;
    let end = usize::from_str_radix(end, 16).ok()?;
    let rights = fields.next()?.as_bytes();
    let inode = fields.nth(2)?;
    let is_file = rights.len() == 4 && rights[1] == b'-' && rights[3] == b'p' && inode != "0";
    Some((start..end, is_file))
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

    const SMAPS: &str = "\
00400000-00500000 r--p 00000000 08:01 77 /bin/program
Rss:                 520 kB
Anonymous:             0 kB
VmFlags: rd mr mw me
00500000-00900000 r-xp 00100000 08:01 77 /bin/program
Anonymous:             0 kB
00900000-00910000 r--p 00500000 08:01 77 /bin/program
Anonymous:            64 kB
00910000-00920000 rw-p 00510000 08:01 77 /bin/program
Anonymous:             0 kB
00920000-00930000 r--s 00000000 08:01 78 /shared memory
Anonymous:             0 kB
7f0000000000-7f0000010000 r--p 00000000 00:00 0
Anonymous:             0 kB
7ffd0000a000-7ffd0000c000 r-xp 00000000 00:00 0 [vdso]
Anonymous:             0 kB
";

    #[test]
    fn only_what_a_file_still_has_is_given_back() {
        assert_eq!(
            unchanged(SMAPS),
            [0x40_0000..0x50_0000, 0x50_0000..0x90_0000]
        );
    }

    #[test]
    fn a_text_of_another_form_gives_nothing() {
        let cut_short = SMAPS.split_inclusive('\n').next().unwrap();
        let short = "Anonymous:             0 kB\n";
        for text in ["", short, "a-b\nx-y r--p\nAnonymous: 0 kB", cut_short] {
            assert!(unchanged(text).is_empty(), "{text}");
        }
    }

    /// Other tests of this process may map code again meanwhile. Hence the test tries more than
    /// once.
    #[test]
    #[cfg(target_os = "linux")]
    fn code_is_given_back_and_comes_again() {
        let of_files = || crate::measure::host::kibibytes("/proc/self/status", "RssFile").unwrap();
        let gives_back = || {
            let before = of_files();
            give_back_clean_pages();
            of_files() < before
        };
        assert!((0..1000).any(|_| gives_back()));
        assert_eq!(format!("{:?}", [1.5, 2.0]), "[1.5, 2.0]");
    }
}
