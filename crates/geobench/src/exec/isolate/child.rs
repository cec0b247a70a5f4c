//! The parent's end of a child process.

use std::collections::VecDeque;
use std::fmt;
use std::io::{self, Read, Write};
use std::os::fd::AsFd;
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::process::{self, ChildStderr, ChildStdin, ChildStdout, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::process::{Pid, Signal, WaitId, WaitIdOptions, kill_process_group, waitid};
use signal_hook::consts::{SIGABRT, SIGKILL};
use signal_hook::low_level::signal_name;

use super::system;
use super::system::Descendants;
use crate::exec::limits::Limits;
use crate::exec::protocol::{Reply, Request};
use crate::exec::{Failure, interrupt};
use crate::schema::Status;

/// Interval of memory checks. `system::limit_data` bounds what a child can allocate between two.
const LOOK: Duration = Duration::from_millis(10);

/// Time to end after closing standard output.
const GRACE: Duration = Duration::from_secs(1);

/// A process that answers requests. It leads a process group, which is killed on drop.
#[derive(Debug)]
pub(crate) struct ChildProcess {
    process: process::Child,
    descendants: Descendants,
    requests: ChildStdin,
    replies: ChildStdout,
    errors: Option<ChildStderr>,
    /// Received part of the next reply.
    received: Vec<u8>,
    stderr_tail: Tail,
    /// Exit status, once known.
    status: Option<ExitStatus>,
}

impl ChildProcess {
    /// Starts `command`.
    pub(crate) fn start(mut command: Command) -> io::Result<Self> {
        command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .process_group(0);
        let (mut process, descendants) = Descendants::of(&mut command)?;
        let (requests, replies, errors) = (
            process.stdin.take(),
            process.stdout.take(),
            process.stderr.take(),
        );
        let (Some(requests), Some(replies), Some(errors)) = (requests, replies, errors) else {
            return Err(io::ErrorKind::BrokenPipe.into());
        };
        let child = Self {
            process,
            descendants,
            requests,
            replies,
            errors: Some(errors),
            received: Vec::new(),
            stderr_tail: Tail::default(),
            status: None,
        };
        rustix::io::ioctl_fionbio(&child.replies, true)?;
        if let Some(errors) = &child.errors {
            rustix::io::ioctl_fionbio(errors, true)?;
        }
        Ok(child)
    }

    /// Resident bytes of the process and its descendants.
    pub(crate) fn resident(&self) -> Option<u64> {
        let own = system::resident(self.process.id())?;
        Some(own + self.descendants.resident_orphans())
    }

    /// Process id.
    pub(crate) fn id(&self) -> u32 {
        self.process.id()
    }

    /// Sends a request and waits for a reply of at most `longest` bytes. The parent sleeps
    /// meanwhile, except for memory checks.
    pub(super) fn ask(
        &mut self,
        request: &Request,
        limits: &Limits,
        longest: usize,
    ) -> Result<Reply, ChildError> {
        let mut line =
            serde_json::to_vec(request).map_err(|error| ChildError::Pipe(error.into()))?;
        line.push(b'\n');
        let answer = self.ask_line(&line, limits, longest)?;
        serde_json::from_slice(&answer).map_err(|_| {
            self.kill();
            ChildError::garbage(&answer)
        })
    }

    /// Sends `request`, unless it is empty, and waits for a line of at most `longest` bytes.
    pub(crate) fn ask_line(
        &mut self,
        request: &[u8],
        limits: &Limits,
        longest: usize,
    ) -> Result<Vec<u8>, ChildError> {
        let kills = system::kernel_out_of_memory_kills();
        let answer = self.converse(request, limits, longest);
        match answer {
            Ok(Some(line)) => Ok(line),
            // End of the pipe.
            Ok(None) => {
                let Some(status) = self.wait_for_end() else {
                    self.kill();
                    return Err(ChildError::Closed);
                };
                if !self.received.is_empty() {
                    return Err(ChildError::garbage(&self.received));
                }
                Err(ChildError::Ended(ExitReport {
                    status,
                    stderr_tail: self.stderr_tail.to_string(),
                    kernel_out_of_memory: kills < system::kernel_out_of_memory_kills(),
                }))
            }
            Err(error) => {
                self.kill();
                Err(error)
            }
        }
    }

    /// The line that answers a request, or `None` if the pipe ends first.
    fn converse(
        &mut self,
        request: &[u8],
        limits: &Limits,
        longest: usize,
    ) -> Result<Option<Vec<u8>>, ChildError> {
        let start = Instant::now();
        let deadline = limits.timeout.0.and_then(|time| start.checked_add(time));
        match self.requests.write_all(request) {
            // The process has ended; the reason is found below.
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => {}
            done => done.map_err(ChildError::Pipe)?,
        }
        let mut searched = 0;
        loop {
            if let Some(end) = self.received[searched..].iter().position(|b| *b == b'\n') {
                let rest = self.received.split_off(searched + end + 1);
                return Ok(Some(std::mem::replace(&mut self.received, rest)));
            }
            searched = self.received.len();
            if searched > longest {
                return Err(ChildError::garbage(&self.received));
            }
            if interrupt::requested() {
                return Err(ChildError::Interrupted);
            }
            let left = deadline.map(|deadline| deadline.saturating_duration_since(Instant::now()));
            if left.is_some_and(|left| left.is_zero()) {
                return Err(ChildError::Timeout);
            }
            if let Some(most) = limits.memory.0
                && let Some(bytes) = self.resident().filter(|bytes| *bytes > most)
            {
                return Err(ChildError::Memory(bytes));
            }
            let look = limits.memory.0.map(|_| LOOK);
            self.sleep([left, look].into_iter().flatten().min())
                .map_err(ChildError::Pipe)?;
            self.listen_to_errors();
            if !self.receive().map_err(ChildError::Pipe)? {
                return Ok(None);
            }
        }
    }

    /// Sleeps until output of the child, a signal or the end of `time`.
    fn sleep(&self, time: Option<Duration>) -> io::Result<()> {
        let time = time.and_then(|time| Timespec::try_from(time).ok());
        let wake = interrupt::wake();
        let errors = self.errors.as_ref().map(AsFd::as_fd);
        let mut events: Vec<PollFd<'_>> = [Some(self.replies.as_fd()), errors, wake]
            .into_iter()
            .flatten()
            .map(|fd| PollFd::from_borrowed_fd(fd, PollFlags::IN))
            .collect();
        match poll(&mut events, time.as_ref()) {
            Ok(_) | Err(rustix::io::Errno::INTR) => Ok(()),
            Err(error) => Err(error.into()),
        }
    }

    /// Reads available output; false at the end of the pipe.
    fn receive(&mut self) -> io::Result<bool> {
        let mut block = [0; 1 << 14];
        match self.replies.read(&mut block) {
            Ok(0) => Ok(false),
            Ok(count) => {
                self.received.extend_from_slice(&block[..count]);
                Ok(true)
            }
            Err(error) if is_temporary(&error) => Ok(true),
            Err(error) => Err(error),
        }
    }

    /// Reads available standard error.
    fn listen_to_errors(&mut self) {
        let mut block = [0; 1 << 12];
        while let Some(errors) = &mut self.errors {
            match errors.read(&mut block) {
                Ok(count @ 1..) => self.stderr_tail.push(&block[..count]),
                Err(error) if is_temporary(&error) => return,
                Ok(0) | Err(_) => self.errors = None,
            }
        }
    }

    /// Waits for the process to end and reads the rest of its standard error; `None` if it does not
    /// end.
    fn wait_for_end(&mut self) -> Option<ExitStatus> {
        let deadline = Instant::now() + GRACE;
        while !self.has_ended() {
            if Instant::now() >= deadline {
                return None;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        self.listen_to_errors();
        self.kill()
    }

    /// Whether the process has ended. Its id stays reserved until [`kill`](Self::kill).
    fn has_ended(&self) -> bool {
        let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
        self.group()
            .is_some_and(|pid| matches!(waitid(WaitId::Pid(pid), options), Ok(Some(_))))
    }

    /// Kills the process and its descendants.
    fn kill(&mut self) -> Option<ExitStatus> {
        if self.status.is_none() {
            let present = self.descendants.present();
            // The id cannot be reused before the leader is waited for.
            if let Some(group) = self.group() {
                let _ = kill_process_group(group, Signal::KILL);
            }
            self.status = self.process.wait().ok();
            self.descendants.end(present);
        }
        self.status
    }

    fn group(&self) -> Option<Pid> {
        i32::try_from(self.process.id())
            .ok()
            .and_then(Pid::from_raw)
    }
}

impl Drop for ChildProcess {
    fn drop(&mut self) {
        self.kill();
    }
}

fn is_temporary(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted
    )
}

/// Bytes kept.
const BYTES: usize = 2000;

/// Lines shown.
const LINES: usize = 3;

/// Characters shown.
const CHARACTERS: usize = 400;

/// The end of a byte stream; displays its last lines as one.
#[derive(Debug, Default)]
pub(super) struct Tail(VecDeque<u8>);

impl Tail {
    pub(super) fn push(&mut self, bytes: &[u8]) {
        self.0.extend(bytes);
        let surplus = self.0.len().saturating_sub(BYTES);
        self.0.drain(..surplus);
    }
}

impl fmt::Display for Tail {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bytes: Vec<u8> = self.0.iter().copied().collect();
        let text = String::from_utf8_lossy(&bytes);
        let lines: Vec<&str> = text
            .lines()
            .map(str::trim)
            .filter(|line| !line.is_empty())
            .collect();
        let last = lines[lines.len().saturating_sub(LINES)..].join(" / ");
        let surplus = last.chars().count().saturating_sub(CHARACTERS);
        let shown: String = last.chars().skip(surplus).collect();
        f.write_str(&shown)
    }
}

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

    #[test]
    fn the_last_lines_are_shown_as_one() {
        let mut tail = Tail::default();
        assert_eq!(tail.to_string(), "");
        tail.push(b"one\ntwo\n\nthr");
        tail.push(b"ee\n  four\n");
        assert_eq!(tail.to_string(), "two / three / four");
    }

    #[test]
    fn endless_text_takes_no_memory() {
        let mut tail = Tail::default();
        for _ in 0..1000 {
            tail.push("é".repeat(100).as_bytes());
        }
        tail.push(b"end");
        assert_eq!(tail.0.len(), BYTES);
        let shown = tail.to_string();
        assert_eq!(shown.chars().count(), CHARACTERS);
        assert!(shown.ends_with("éend"), "{shown}");
    }

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
