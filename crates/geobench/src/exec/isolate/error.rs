//! Failures of child processes, and the messages for their rows.

use std::io;
use std::os::unix::process::ExitStatusExt;
use std::process::ExitStatus;

use signal_hook::consts::{SIGABRT, SIGKILL};
use signal_hook::low_level::signal_name;

use crate::exec::Failure;
use crate::exec::limits::Limits;
use crate::schema::Status;

/// Why there is no reply. The child is gone in every case.
#[derive(Debug)]
pub(crate) enum ChildError {
    /// Interrupted by a signal.
    Interrupted,
    /// Over the time limit.
    Timeout,
    /// Over the memory limit, with this many bytes.
    Memory(u64),
    /// Output that is not a reply.
    Garbage(String),
    /// Standard output closed, process still running.
    Closed,
    /// The process ended.
    Ended(ExitReport),
    /// The process cannot be started.
    Start(io::Error),
    /// The pipe failed.
    Pipe(io::Error),
}

/// How a process ended.
#[derive(Debug)]
pub(crate) struct ExitReport {
    /// Exit status.
    pub(crate) status: ExitStatus,
    /// End of its standard error.
    pub(crate) stderr_tail: String,
    /// Whether the kernel killed a process for lack of memory meanwhile.
    pub(crate) kernel_out_of_memory: bool,
}

impl ChildError {
    /// A line that is not a reply.
    pub(crate) fn garbage(line: &[u8]) -> Self {
        const MOST: usize = 60;
        let text = String::from_utf8_lossy(&line[..line.len().min(4 * MOST)]);
        let text = text.trim();
        Self::Garbage(match text.char_indices().nth(MOST) {
            Some((end, _)) => format!("{}...", &text[..end]),
            None => text.to_owned(),
        })
    }

    /// Status and message of the row, for a failure while the child was `doing` something.
    pub(crate) fn failure(&self, limits: &Limits, doing: &str) -> Failure {
        let (status, message) = match self {
            Self::Interrupted => (Status::Crashed, "interrupted".to_owned()),
            Self::Timeout => (
                Status::Timeout,
                format!("took longer than the {} allowed", limits.timeout),
            ),
            Self::Memory(bytes) => (
                Status::OutOfMemory,
                format!(
                    "occupied {}, more than the {} allowed",
                    crate::exec::limits::MemoryLimit(Some(*bytes)),
                    limits.memory
                ),
            ),
            Self::Garbage(text) => (
                Status::Crashed,
                format!("printed what is no answer: {text:?}"),
            ),
            Self::Closed => (
                Status::Crashed,
                "closed its standard output without an answer".to_owned(),
            ),
            Self::Ended(report) => report.meaning(),
            Self::Start(error) => (
                Status::Crashed,
                format!("its process cannot be started: {error}"),
            ),
            Self::Pipe(error) => (
                Status::Crashed,
                format!("cannot communicate with the child process: {error}"),
            ),
        };
        Failure {
            status,
            message: format!("{message} ({doing})"),
        }
    }
}

impl ExitReport {
    fn meaning(&self) -> (Status, String) {
        let signal = self.status.signal();
        if signal == Some(SIGABRT)
            && let Some(words) = self.failed_allocation()
        {
            return (Status::OutOfMemory, words.to_owned());
        }
        if signal == Some(SIGKILL) && self.kernel_out_of_memory {
            let message = "was killed by the system, which had no memory left";
            return (Status::OutOfMemory, message.to_owned());
        }
        let how = match (signal, self.status.code()) {
            (Some(signal), _) => match signal_name(signal) {
                Some(name) => format!("was killed by signal {signal} ({name})"),
                None => format!("was killed by signal {signal}"),
            },
            (None, Some(code)) => format!("ended with exit status {code} without an answer"),
            (None, None) => format!("ended without an answer: {}", self.status),
        };
        let message = if self.stderr_tail.is_empty() {
            how
        } else {
            format!("{how}, stderr: {}", self.stderr_tail)
        };
        (Status::Crashed, message)
    }

    /// The message of the runtime about a failed allocation.
    fn failed_allocation(&self) -> Option<&str> {
        let start = self.stderr_tail.rfind("memory allocation of ")?;
        let (words, _) = self.stderr_tail[start..].split_once(" failed")?;
        let bytes = words.strip_prefix("memory allocation of ")?;
        let number = bytes.strip_suffix(" bytes")?;
        number.parse::<u128>().ok()?;
        Some(&self.stderr_tail[start..start + words.len() + " failed".len()])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ended(wait_status: i32, stderr_tail: &str, kernel_out_of_memory: bool) -> (Status, String) {
        ExitReport {
            status: ExitStatus::from_raw(wait_status),
            stderr_tail: stderr_tail.to_owned(),
            kernel_out_of_memory,
        }
        .meaning()
    }

    #[test]
    fn an_end_says_how_and_why() {
        for (wait_status, words, kernel, status, message) in [
            (
                3 << 8,
                "",
                false,
                Status::Crashed,
                "ended with exit status 3 without an answer",
            ),
            (
                0,
                "",
                true,
                Status::Crashed,
                "ended with exit status 0 without an answer",
            ),
            (
                11,
                "what a pity",
                false,
                Status::Crashed,
                "was killed by signal 11 (SIGSEGV), stderr: what a pity",
            ),
            (
                6,
                "x / memory allocation of 16 bytes failed / y",
                false,
                Status::OutOfMemory,
                "memory allocation of 16 bytes failed",
            ),
            (
                6,
                "memory allocation of errors failed",
                false,
                Status::Crashed,
                "was killed by signal 6 (SIGABRT), stderr: memory allocation of errors failed",
            ),
            (
                9,
                "",
                false,
                Status::Crashed,
                "was killed by signal 9 (SIGKILL)",
            ),
            (
                9,
                "",
                true,
                Status::OutOfMemory,
                "was killed by the system, which had no memory left",
            ),
        ] {
            assert_eq!(ended(wait_status, words, kernel), (status, message.into()));
        }
    }
}
