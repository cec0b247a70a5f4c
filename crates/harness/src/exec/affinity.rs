//! Pinning to processors.

use std::io;
use std::str::FromStr;

use geobench_registry::UsageError;

use crate::measure::number::ranges;

/// Processor numbers: at least one, sorted, without duplicates.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CpuList(Vec<usize>);

impl CpuList {
    /// The processor numbers.
    pub fn numbers(&self) -> &[usize] {
        &self.0
    }
}

impl FromStr for CpuList {
    type Err = UsageError;

    fn from_str(text: &str) -> Result<Self, UsageError> {
        let syntax = || {
            UsageError(format!(
                "`{text}` is not a list of processors; give numbers and ranges such as 2 or 0,4-7"
            ))
        };
        // The capacity of the processor sets of the system.
        let number = |text: &str| {
            let number: usize = text.trim().parse().map_err(|_| syntax())?;
            (number < 1024).then_some(number).ok_or_else(syntax)
        };
        let mut list = Vec::new();
        for item in text.split(',') {
            match item.split_once('-') {
                Some((first, last)) => {
                    let (first, last) = (number(first)?, number(last)?);
                    if first > last {
                        return Err(syntax());
                    }
                    list.extend(first..=last);
                }
                None => list.push(number(item)?),
            }
        }
        list.sort_unstable();
        list.dedup();
        Ok(Self(list))
    }
}

/// Checks that this process may run on all of `cpus`.
///
/// # Errors
///
/// Names the first processor that it may not use, or the error of the system.
pub fn check(cpus: &CpuList) -> Result<(), UsageError> {
    let allowed = system::allowed()
        .map_err(|error| UsageError(format!("this system does not pin processes: {error}")))?;
    match cpus.0.iter().find(|cpu| !allowed.contains(cpu)) {
        None => Ok(()),
        Some(cpu) => Err(UsageError(format!(
            "processor {cpu} is not one of those that this process may use: {}",
            ranges(&allowed)
        ))),
    }
}

/// Restricts the calling thread, and the threads and processes that it starts later, to `cpus`.
///
/// # Errors
///
/// If the system refuses.
pub fn pin(cpus: &[usize]) -> io::Result<()> {
    system::pin(cpus)
}

/// Calls `start`. Processes that it starts are restricted to `cpus`, unless the list is empty.
///
/// # Errors
///
/// If the system refuses, and the error of `start`.
pub(crate) fn inherited<T>(cpus: &[usize], start: impl FnOnce() -> io::Result<T>) -> io::Result<T> {
    if cpus.is_empty() {
        return start();
    }
    let own = system::allowed()?;
    system::pin(cpus)?;
    let started = start();
    system::pin(&own)?;
    started
}

#[cfg(target_os = "linux")]
mod system {
    use std::io;

    use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};

    pub(super) fn allowed() -> io::Result<Vec<usize>> {
        let set = sched_getaffinity(None)?;
        Ok((0..CpuSet::MAX_CPU)
            .filter(|&cpu| set.is_set(cpu))
            .collect())
    }

    pub(super) fn pin(cpus: &[usize]) -> io::Result<()> {
        let mut set = CpuSet::new();
        for &cpu in cpus {
            set.set(cpu);
        }
        Ok(sched_setaffinity(None, &set)?)
    }
}

#[cfg(not(target_os = "linux"))]
mod system {
    use std::io;

    pub(super) fn allowed() -> io::Result<Vec<usize>> {
        Err(io::ErrorKind::Unsupported.into())
    }

    pub(super) fn pin(_: &[usize]) -> io::Result<()> {
        Err(io::ErrorKind::Unsupported.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_read_and_shown() {
        for (text, shown) in [("2", "2"), ("7, 0,4-6,5", "0,4-7"), ("0-0", "0")] {
            assert_eq!(ranges(text.parse::<CpuList>().unwrap().numbers()), shown);
        }
        for text in [
            "",
            "x",
            "1,,2",
            "-1",
            "3-1",
            "0,3-1",
            "0-",
            "1024",
            "0-99999999999",
        ] {
            assert!(text.parse::<CpuList>().is_err(), "{text}");
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_thread_is_pinned_to_a_processor_that_it_may_use() {
        let allowed = system::allowed().unwrap();
        let last = allowed[allowed.len() - 1];
        std::thread::spawn(move || {
            pin(&[last]).unwrap();
            assert_eq!(system::allowed().unwrap(), [last]);
            check(&last.to_string().parse().unwrap()).unwrap();
        })
        .join()
        .unwrap();
        let error = check(&"1023".parse().unwrap()).unwrap_err();
        assert!(
            error
                .to_string()
                .starts_with("processor 1023 is not one of those")
        );
    }
}
