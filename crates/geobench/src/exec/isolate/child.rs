//! The parent's end of a child process.

use std::collections::VecDeque;
use std::fmt;
use std::io::{self, Read, Write};
use std::os::fd::AsFd;
use std::os::unix::process::CommandExt;
use std::process::{self, ChildStderr, ChildStdin, ChildStdout, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::process::{Pid, Signal, WaitId, WaitIdOptions, kill_process_group, waitid};

use super::error::{ChildError, ExitReport};
use super::orphans::Descendants;
use super::system;
use crate::exec::interrupt;
use crate::exec::limits::Limits;
use crate::exec::protocol::{Reply, Request};

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
}
