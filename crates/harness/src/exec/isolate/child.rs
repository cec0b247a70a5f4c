//! The side of the parent: starts a child process, sends requests and enforces limits.

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
use crate::exec::limits::{Limits, MemoryLimit, Timeout};
use crate::exec::protocol::{Reply, ReplyError};
use crate::exec::{Failure, affinity, interrupt};
use crate::schema::Status;
use crate::usage::quoted;

/// Interval of memory checks. The data limit bounds what a child can allocate in between.
const LOOK: Duration = Duration::from_millis(10);

/// Interval at which the parent looks whether a child has ended. A descendant may keep the standard
/// output of the child open.
const ALIVE: Duration = Duration::from_secs(1);

/// Time that a child has to exit after closing standard output.
const GRACE: Duration = Duration::from_secs(10);

/// A process that answers requests. It leads a process group, which is killed on drop.
#[derive(Debug)]
pub(super) struct ChildProcess {
    process: process::Child,
    descendants: Descendants,
    limits: Limits,
    /// Its standard input, until that is closed.
    requests: Option<ChildStdin>,
    replies: ChildStdout,
    errors: Option<ChildStderr>,
    /// The part of the next reply received so far.
    received: Vec<u8>,
    stderr_tail: Tail,
    /// Exit status, if the process has been waited for.
    status: Option<ExitStatus>,
    /// Whether the memory peak is sampled while the process works. Needed if the process exits with
    /// its answer.
    watched: bool,
    /// Whether the first signal of the user is ignored.
    outlasts_interrupts: bool,
    /// The largest memory peak seen so far, in bytes.
    peak: Option<u64>,
}

impl ChildProcess {
    /// Starts `command` with these limits, pinned to these processors; not pinned if there are
    /// none.
    pub(super) fn start(
        mut command: Command,
        limits: Limits,
        cpus: &[usize],
    ) -> Result<Self, ChildError> {
        command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .process_group(0);
        let started = affinity::inherited(cpus, || Descendants::of(&mut command));
        let child =
            started.and_then(|(process, descendants)| Self::new(process, descendants, limits));
        child.map_err(|error| ChildError::Start(command.get_program().display().to_string(), error))
    }

    fn new(
        mut process: process::Child,
        descendants: Descendants,
        limits: Limits,
    ) -> io::Result<Self> {
        let pipes = (
            process.stdin.take(),
            process.stdout.take(),
            process.stderr.take(),
        );
        let (Some(requests), Some(replies), Some(errors)) = pipes else {
            return Err(io::ErrorKind::BrokenPipe.into());
        };
        let child = Self {
            process,
            descendants,
            limits,
            requests: Some(requests),
            replies,
            errors: Some(errors),
            received: Vec::new(),
            stderr_tail: Tail::default(),
            status: None,
            watched: false,
            outlasts_interrupts: false,
            peak: None,
        };
        rustix::io::ioctl_fionbio(&child.replies, true)?;
        if let Some(errors) = &child.errors {
            rustix::io::ioctl_fionbio(errors, true)?;
        }
        Ok(child)
    }

    /// Resident bytes of the process and its descendants.
    pub(super) fn resident(&self) -> Option<u64> {
        self.descendants.resident()
    }

    /// Samples the memory peak from now on.
    pub(super) const fn watch(&mut self) {
        self.watched = true;
    }

    /// Resets the memory peak.
    pub(super) fn reset_peak(&mut self) {
        self.peak = None;
        self.descendants.reset_peak();
    }

    /// Peak resident bytes of the process and its descendants.
    pub(super) fn peak(&mut self) -> Option<u64> {
        self.peak = self.peak.max(self.descendants.peak_resident());
        self.peak
    }

    /// Lets the process end although the user has asked to stop: the first signal is ignored.
    pub(super) const fn outlast_interrupts(&mut self) {
        self.outlasts_interrupts = true;
    }

    /// Waits for the exit of a process that does not reply. Its standard output is discarded, and
    /// its standard input is empty.
    pub(super) fn finish(&mut self) -> Result<(), ChildError> {
        let _at_work = self.descendants.at_work();
        let kills = system::kernel_out_of_memory_kills();
        let deadline = self.deadline();
        self.requests = None;
        let error = loop {
            if let Err(error) = self.wait(deadline) {
                break error;
            }
            match self.receive() {
                Ok(true) => self.received.clear(),
                // Standard output is closed. The process has exited or continues.
                Ok(false) if self.has_ended() => match self.why_closed(kills) {
                    ChildError::Ended(report) if report.status.success() => return Ok(()),
                    error => break error,
                },
                Ok(false) => std::thread::sleep(Duration::from_millis(1)),
                Err(error) => break error.into(),
            }
        };
        self.kill();
        Err(error)
    }

    /// Sends `request` as a line, unless it is empty, and waits for a reply of at most `longest`
    /// bytes. Returns it with the time from the request to the reply. The parent sleeps meanwhile,
    /// except for memory checks.
    pub(super) fn ask(
        &mut self,
        request: &str,
        longest: usize,
    ) -> Result<(Reply, Duration), ChildError> {
        let _at_work = self.descendants.at_work();
        let kills = system::kernel_out_of_memory_kills();
        let error = match self.converse(request, longest) {
            Ok((line, time)) => match Reply::parse(&line) {
                Ok(Reply {
                    refused: Some(why), ..
                }) => ChildError::Refused(why),
                Ok(Reply {
                    crashed: Some(how), ..
                }) => ChildError::Crashed(how),
                Ok(reply) => return Ok((reply, time)),
                Err(ReplyError::NoObject) => ChildError::garbage(&line),
                Err(ReplyError::Key(problem)) => ChildError::Protocol(problem),
            },
            Err(ChildError::Closed) => self.why_closed(kills),
            Err(error) => error,
        };
        self.kill();
        Err(error)
    }

    /// Sends a request and returns the line of the reply, with the time that it took.
    fn converse(
        &mut self,
        request: &str,
        longest: usize,
    ) -> Result<(Vec<u8>, Duration), ChildError> {
        let deadline = self.deadline();
        if !request.is_empty() {
            // A line from before the request would be taken for the answer, at once.
            self.receive()?;
            if !self.received.is_empty() {
                return Err(ChildError::Unasked(shortened(&self.received)));
            }
        }
        let start = Instant::now();
        if let Some(requests) = self.requests.as_mut().filter(|_| !request.is_empty()) {
            match requests.write_all(format!("{request}\n").as_bytes()) {
                // The process has exited. The reason is determined below.
                Err(error) if error.kind() == io::ErrorKind::BrokenPipe => {}
                done => done?,
            }
        }
        let mut searched = 0;
        loop {
            if let Some(end) = self.received[searched..].iter().position(|b| *b == b'\n') {
                let time = start.elapsed();
                let rest = self.received.split_off(searched + end + 1);
                return Ok((std::mem::replace(&mut self.received, rest), time));
            }
            searched = self.received.len();
            if searched > longest {
                return Err(ChildError::garbage(&self.received));
            }
            self.wait(deadline)?;
            // What it wrote before its end can be read after it.
            let has_ended = self.has_ended();
            let is_open = self.receive()?;
            if !is_open || has_ended && self.received.len() == searched {
                return Err(ChildError::Closed);
            }
        }
    }

    /// The deadline of a request that starts now; `None` without a time limit.
    fn deadline(&self) -> Option<Instant> {
        let timeout = self.limits.timeout.0;
        timeout.and_then(|time| Instant::now().checked_add(time))
    }

    /// Sleeps until an event, and checks the limits.
    fn wait(&mut self, deadline: Option<Instant>) -> Result<(), ChildError> {
        let Limits {
            timeout, memory, ..
        } = self.limits;
        if interrupt::requested() && !self.outlasts_interrupts {
            return Err(ChildError::Interrupted);
        }
        let left = deadline.map(|deadline| deadline.saturating_duration_since(Instant::now()));
        if left.is_some_and(|left| left.is_zero()) {
            return Err(ChildError::Timeout(timeout));
        }
        if let Some(most) = memory.0
            && let Some(bytes) = self.resident().filter(|bytes| *bytes > most)
        {
            return Err(ChildError::Memory(MemoryLimit(Some(bytes)), memory));
        }
        if self.watched {
            self.peak();
        }
        let look = (memory.0.is_some() || self.watched).then_some(LOOK);
        self.sleep([left, look, Some(ALIVE)].into_iter().flatten().min())?;
        self.listen_to_errors();
        Ok(())
    }

    /// Sleeps until the child writes output, a signal arrives, or `time` has passed.
    fn sleep(&self, time: Option<Duration>) -> io::Result<()> {
        let time = time.and_then(|time| Timespec::try_from(time).ok());
        let wake = interrupt::wake().filter(|_| !self.outlasts_interrupts);
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

    /// Why standard output was closed: the process has exited, or still runs after [`GRACE`].
    /// `kills` is the kernel's count of out-of-memory kills before the request.
    fn why_closed(&mut self, kills: Option<u64>) -> ChildError {
        let deadline = Instant::now() + GRACE;
        while !self.has_ended() {
            if Instant::now() >= deadline {
                return ChildError::Closed;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        self.listen_to_errors();
        match self.kill() {
            Some(_) if !self.received.is_empty() => ChildError::garbage(&self.received),
            Some(status) => ChildError::Ended(ExitReport {
                status,
                stderr_tail: self.stderr_tail.to_string(),
                kernel_out_of_memory: kills < system::kernel_out_of_memory_kills(),
            }),
            None => ChildError::Closed,
        }
    }

    /// Whether the process has exited. Its id stays reserved until [`kill`](Self::kill).
    fn has_ended(&self) -> bool {
        let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
        self.group()
            .is_some_and(|pid| matches!(waitid(WaitId::Pid(pid), options), Ok(Some(_))))
    }

    /// Kills the process and its descendants.
    fn kill(&mut self) -> Option<ExitStatus> {
        if self.status.is_none() {
            let present = self.descendants.present();
            // The id cannot be reused before the group leader is waited for.
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

/// Maximum number of bytes kept.
const BYTES: usize = 2000;

/// Maximum number of lines shown.
const LINES: usize = 3;

/// Maximum number of characters shown.
pub(super) const CHARACTERS: usize = 400;

/// The end of a byte stream. Displays its last lines joined into one.
#[derive(Debug, Default)]
struct Tail(Vec<u8>);

impl Tail {
    fn push(&mut self, bytes: &[u8]) {
        self.0.extend(bytes);
        let surplus = self.0.len().saturating_sub(BYTES);
        self.0.drain(..surplus);
    }
}

impl fmt::Display for Tail {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = String::from_utf8_lossy(&self.0);
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

/// Why there is no reply. The child has exited or been killed in every case.
#[derive(Debug, thiserror::Error)]
pub(super) enum ChildError {
    /// Interrupted by a signal.
    #[error("interrupted")]
    Interrupted,
    /// Over the time limit.
    #[error("took longer than the {0} allowed")]
    Timeout(Timeout),
    /// Occupied memory exceeds the limit: the amount and the limit.
    #[error("occupied {0}, more than the {1} allowed")]
    Memory(MemoryLimit, MemoryLimit),
    /// Output that is not a reply.
    #[error("printed what is no answer: {0:?}")]
    Garbage(String),
    /// Output between an answer and the next request.
    #[error("printed without a request: {0:?}; write one line for each request")]
    Unasked(String),
    /// A reply that the protocol does not allow.
    #[error("broke the protocol: {0}")]
    Protocol(String),
    /// Standard output is closed, but the process still runs.
    #[error("closed its standard output without an answer")]
    Closed,
    /// The process exited.
    #[error("{}", .0.meaning().1)]
    Ended(ExitReport),
    /// A program cannot be started.
    #[error("{0} cannot be started: {1}")]
    Start(String, io::Error),
    /// The pipe failed.
    #[error("cannot communicate with the child process: {0}")]
    Pipe(#[from] io::Error),
    /// The child refused the model or the source.
    #[error("{0}")]
    Refused(String),
    /// The algorithm failed, according to the child.
    #[error("{0}")]
    Crashed(String),
}

/// How a process ended.
#[derive(Debug)]
pub(super) struct ExitReport {
    /// Exit status.
    pub(super) status: ExitStatus,
    /// End of its standard error.
    pub(super) stderr_tail: String,
    /// Whether the kernel killed a process for lack of memory during the request.
    pub(super) kernel_out_of_memory: bool,
}

impl ChildError {
    /// A line that is not a reply.
    pub(super) fn garbage(line: &[u8]) -> Self {
        Self::Garbage(shortened(line))
    }

    /// Status and message of the row. `doing` says in what phase the child failed.
    pub(super) fn failure(&self, doing: &str) -> Failure {
        let status = match self {
            Self::Timeout(_) => Status::Timeout,
            Self::Memory(..) => Status::OutOfMemory,
            Self::Ended(report) => report.meaning().0,
            Self::Refused(why) => return Failure::new(Status::Refused, why),
            Self::Crashed(how) => return Failure::new(Status::Crashed, how),
            _ => Status::Crashed,
        };
        Failure::new(status, format!("{self} ({doing})"))
    }
}

/// The beginning of a line, for messages.
fn shortened(line: &[u8]) -> String {
    let text = String::from_utf8_lossy(&line[..line.len().min(CHARACTERS)]);
    quoted(text.trim()).into_owned()
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

    /// The message of the Rust runtime about a failed allocation.
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
    fn the_wait_status_and_stderr_give_status_and_message() {
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
