//! Processes started by a child that outlive it.
//!
//! A process that calls `setsid` leaves the process group of its child, and one whose parent has
//! ended is no longer a descendant of the child. The `geobench` command is therefore a child
//! subreaper ([`adopt`]): Linux makes it the parent of such orphans. An orphan is killed with the
//! child it belongs to, which is told by
//!
//! 1. the mark of the child in the environment, which descendants inherit, or
//! 2. its place among the descendants of the child or of its orphans, recorded before these were
//!    killed.
//!
//! An orphan without either ends when no child is left. Other children of this process are in its
//! own process group and are left alone. Outside Linux, and in programs that use this library,
//! nothing is adopted.

use std::fs;
use std::io;
use std::process::{self, Command};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, WaitId, WaitIdOptions, getpgrp, kill_process, waitid};

use super::system;

/// The environment variable that holds the mark.
const MARK: &str = "GEOBENCH_CHILD";

/// Time that the orphans of a child have to end after they were killed.
const GRACE: Duration = Duration::from_secs(1);

/// Whether orphans become children of this process.
static ADOPTS: AtomicBool = AtomicBool::new(false);

/// The children that have been started and have not ended.
static STARTED: Mutex<Vec<u32>> = Mutex::new(Vec::new());

/// Makes this process the parent of orphaned descendants from now on.
pub(crate) fn adopt() {
    #[cfg(target_os = "linux")]
    if rustix::process::set_child_subreaper(Some(rustix::process::getpid())).is_ok() {
        ADOPTS.store(true, Ordering::Relaxed);
    }
}

/// Identifies the descendants of a child.
#[derive(Debug)]
pub(super) struct Descendants {
    child: u32,
    /// The entry of the environment.
    mark: String,
}

/// A process, identified by id and start time because ids are reused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Process {
    number: u32,
    /// When it was started, in ticks of the system.
    start: u64,
}

impl Descendants {
    /// Starts a child with a mark of its own.
    pub(super) fn of(command: &mut Command) -> io::Result<(process::Child, Self)> {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let mark = format!("{}.{count}", process::id());
        command.env(MARK, &mark);
        // Holds the lock so that the child is not taken for an orphan before its id is recorded.
        let mut started = started();
        let child = command.spawn()?;
        started.push(child.id());
        let descendants = Self {
            child: child.id(),
            mark: format!("{MARK}={mark}"),
        };
        Ok((child, descendants))
    }

    /// The descendants that currently exist below the child.
    pub(super) fn present(&self) -> Present {
        let mut present = Present(Vec::new());
        if ADOPTS.load(Ordering::Relaxed) {
            present.add_below(self.child);
        }
        present
    }

    /// Resident bytes of the orphans with the mark and their descendants.
    pub(super) fn resident_orphans(&self) -> u64 {
        if !ADOPTS.load(Ordering::Relaxed) {
            return 0;
        }
        let orphans = orphans(&started());
        let marked = orphans.into_iter().filter(|orphan| self.marks(*orphan));
        marked
            .filter_map(|orphan| system::resident(orphan.number))
            .sum()
    }

    /// Kills all orphans of the child, which has ended and been waited for; `present` are the
    /// descendants recorded before.
    pub(super) fn end(&self, mut present: Present) {
        let mut started = started();
        started.retain(|child| *child != self.child);
        if !ADOPTS.load(Ordering::Relaxed) {
            return;
        }
        let deadline = Instant::now() + GRACE;
        loop {
            let mut left = false;
            for orphan in orphans(&started) {
                let belongs =
                    present.0.contains(&orphan) || started.is_empty() || self.marks(orphan);
                if belongs {
                    left = true;
                    present.add_below(orphan.number);
                    // A child not waited for keeps its id.
                    if let Some(pid) = pid(orphan.number) {
                        let _ = kill_process(pid, Signal::KILL);
                    }
                }
                forget_if_ended(orphan.number);
            }
            if !left || Instant::now() >= deadline {
                return;
            }
            thread::sleep(Duration::from_millis(1));
        }
    }

    fn marks(&self, orphan: Process) -> bool {
        let environment = fs::read(format!("/proc/{}/environ", orphan.number)).unwrap_or_default();
        let mut entries = environment.split(|byte| *byte == 0);
        entries.any(|entry| entry == self.mark.as_bytes())
    }
}

/// Processes that belong to a child.
pub(super) struct Present(Vec<Process>);

impl Present {
    /// Adds all descendants of a process.
    fn add_below(&mut self, number: u32) {
        for child in system::children(number) {
            if let Some((process, _)) = look(child)
                && !self.0.contains(&process)
            {
                self.0.push(process);
                self.add_below(child);
            }
        }
    }
}

fn started() -> MutexGuard<'static, Vec<u32>> {
    STARTED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The children of this process that others have started.
fn orphans(started: &[u32]) -> Vec<Process> {
    let own_group = getpgrp().as_raw_pid();
    let children = system::children(process::id());
    let strangers = children.into_iter().filter(|c| !started.contains(c));
    strangers
        .filter_map(look)
        .filter(|(_, group)| *group != own_group)
        .map(|(process, _)| process)
        .collect()
}

/// A process and the number of its process group.
fn look(number: u32) -> Option<(Process, i32)> {
    let text = fs::read(format!("/proc/{number}/stat")).ok()?;
    let text = String::from_utf8_lossy(&text);
    // The name of the program stands in parentheses and may hold anything.
    let (_, facts) = text.rsplit_once(") ")?;
    let mut facts = facts.split(' ');
    let group = facts.nth(2)?.parse().ok()?;
    let start = facts.nth(16)?.parse().ok()?;
    Some((Process { number, start }, group))
}

/// Waits for a child if it has ended.
fn forget_if_ended(number: u32) {
    if let Some(pid) = pid(number) {
        let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG;
        let _ = waitid(WaitId::Pid(pid), options);
    }
}

fn pid(number: u32) -> Option<Pid> {
    i32::try_from(number).ok().and_then(Pid::from_raw)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn a_process_is_known_by_its_number_and_start() {
        let (own, group) = look(process::id()).unwrap();
        assert_eq!(group, getpgrp().as_raw_pid());
        assert!(own.start > 0);
        assert_eq!(look(process::id()).unwrap().0, own);
        assert_eq!(look(u32::MAX), None);
    }

    #[test]
    fn a_library_leaves_children_alone() {
        let mut command = Command::new("sh");
        command.args(["-c", "exec sleep 60"]);
        let (mut child, descendants) = Descendants::of(&mut command).unwrap();
        descendants.end(descendants.present());
        assert_eq!(child.try_wait().unwrap(), None);
        child.kill().unwrap();
        child.wait().unwrap();
    }
}
