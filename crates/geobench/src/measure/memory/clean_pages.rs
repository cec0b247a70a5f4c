//! Pages of files that this process maps and has not changed: most of them code.
//!
//! A process that reads models, speaks JSON and knows every algorithm has run some megabytes of code by the time a run begins,
//! since Linux maps 64 KB around each page that is needed. On a model of 6,000 faces that is more than the model and the
//! algorithm take together. What the run needs of it comes back by itself and counts; the rest is no memory of the run.

// One call to the system, in `give_back`.
#![allow(unsafe_code)]

use std::ops::Range;

/// Gives the system back all unchanged pages of files that this process maps. It brings back each that is touched again, which takes
/// some microseconds the first time.
///
/// Only for a process in which nothing maps and unmaps files as it goes, as a cell. Does nothing where the system does not tell what is mapped.
#[cfg(target_os = "linux")]
pub(crate) fn give_back() {
    let Ok(smaps) = std::fs::read_to_string("/proc/self/smaps") else {
        return;
    };
    for Range { start, end } in unchanged(&smaps) {
        // SAFETY: the kernel has just said that the range is a private mapping of a file, not writable, of which no page is
        // this process's own. So every page in it is as in the file, and is read from there again if it is touched.
        // Only cells come here, in which nothing maps files as it goes, so that nothing else can have come to lie there since.
        let _ = unsafe {
            rustix::mm::madvise(
                std::ptr::without_provenance_mut(start),
                end - start,
                rustix::mm::Advice::LinuxDontNeed,
            )
        };
    }
}

/// Does nothing: nothing is known of what is mapped.
#[cfg(not(target_os = "linux"))]
pub(crate) fn give_back() {}

/// The ranges of addresses in a text like `/proc/self/smaps` that are private mappings of files, not writable, and without a page that the
/// process has made its own. What the dynamic linker changed before it took away the right to write has such pages.
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

/// The range of a mapping, and whether it is a private one of a file that nobody may write to; nothing if `line` is not the first of a mapping.
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
        assert_eq!(unchanged(""), []);
        assert_eq!(unchanged("Anonymous:             0 kB\n"), []);
        assert_eq!(unchanged("a-b\nx-y r--p\nAnonymous: 0 kB"), []);
        let cut_short = SMAPS.split_inclusive('\n').next().unwrap();
        assert_eq!(unchanged(cut_short), []);
    }

    /// Other tests of this process may run code at the same time that was not there: hence more than one trial.
    #[test]
    #[cfg(target_os = "linux")]
    fn code_is_given_back_and_comes_again() {
        let of_files = || crate::measure::host::kibibytes("/proc/self/status", "RssFile").unwrap();
        let gives_back = || {
            let before = of_files();
            give_back();
            of_files() < before
        };
        assert!((0..1000).any(|_| gives_back()));
        assert_eq!(format!("{:?}", [1.5, 2.0]), "[1.5, 2.0]");
    }
}
