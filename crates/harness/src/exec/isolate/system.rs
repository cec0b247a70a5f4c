//! System calls. Those of Linux do nothing elsewhere, or return `None`.

use std::path::Path;
use std::process::{self, Command};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use std::{fs, io, thread};

use rustix::process::{
    Pid, Resource, Rlimit, Signal, WaitId, WaitIdOptions, getppid, kill_process, setrlimit, waitid,
};

use crate::children::{KnownChild, spawn, started};
use crate::measure::host::kibibytes;

/// A command that starts this program, even if its executable has been replaced.
pub(super) fn this_program() -> Command {
    if cfg!(target_os = "linux") {
        Command::new("/proc/self/exe")
    } else {
        Command::new(std::env::current_exe().unwrap_or_else(|_| "geobench".into()))
    }
}

/// Turns this process into a child of `parent`: it exits with the parent, has its own name, and
/// writes no core dumps, which take long. Allocations fail beyond `data_limit` bytes of private
/// data, touched or not. Returns false if the parent has exited.
pub(super) fn become_child(parent: u32, data_limit: Option<u64>) -> bool {
    #[cfg(target_os = "linux")]
    {
        let _ = rustix::process::set_parent_process_death_signal(Some(Signal::KILL));
        // Shown by `ps` and `top`.
        let _ = rustix::thread::set_name(c"geobench-cell");
    }
    for (resource, bytes) in [(Resource::Core, Some(0)), (Resource::Data, data_limit)] {
        if bytes.is_some() {
            let limit = Rlimit {
                current: bytes,
                maximum: bytes,
            };
            let _ = setrlimit(resource, limit);
        }
    }
    getppid().is_some_and(|pid| u32::try_from(pid.as_raw_pid()) == Ok(parent))
}

/// Sets the priority of this process for out-of-memory kills. The kernel should kill a working
/// child rather than a waiting one or the parent, which holds all results.
pub(super) fn raise_oom_score(at_work: bool) {
    let _ = fs::write(
        "/proc/self/oom_score_adj",
        if at_work { "1000" } else { "500" },
    );
}

/// Bytes that this process and its children may use: what the machine has available, or the limit
/// of its control group, such as that of a container or of a job of Slurm, if that is less.
pub(super) fn available_memory() -> Option<u64> {
    let machine = kibibytes("/proc/meminfo", "MemAvailable");
    machine.into_iter().chain(group_limit()).min()
}

/// The memory limit of the control group of this process and of the groups around it.
fn group_limit() -> Option<u64> {
    let groups = fs::read_to_string("/proc/self/cgroup").ok()?;
    // A line is `number:controllers:path`, without controllers in version 2.
    let groups = groups.lines().filter_map(|line| {
        let (controllers, path) = line.split_once(':')?.1.split_once(':')?;
        let (root, file) = match controllers {
            "" => ("/sys/fs/cgroup", "memory.max"),
            "memory" => ("/sys/fs/cgroup/memory", "memory.limit_in_bytes"),
            _ => return None,
        };
        Some((root, path.trim_start_matches('/'), file))
    });
    let limits = groups.flat_map(|(root, path, file)| {
        let places = Path::new(path).ancestors();
        places.filter_map(move |place| {
            let text = fs::read_to_string(Path::new(root).join(place).join(file)).ok()?;
            text.trim().parse::<u64>().ok()
        })
    });
    limits.min()
}

/// Resident bytes of a process and its descendants.
fn resident(pid: u32) -> Option<u64> {
    let pages = fs::read_to_string(format!("/proc/{pid}/statm")).ok()?;
    let pages: u64 = pages.split(' ').nth(1)?.parse().ok()?;
    let own = pages * rustix::param::page_size() as u64;
    let others: u64 = children(pid).into_iter().filter_map(resident).sum();
    Some(own + others)
}

/// Resets the memory peak of a process and its descendants.
fn reset_peak(pid: u32) {
    // Without permission, the peak stays that since the start.
    let _ = fs::write(format!("/proc/{pid}/clear_refs"), "5");
    children(pid).into_iter().for_each(reset_peak);
}

/// Sum of the peak resident bytes of a process and its current descendants.
fn peak_resident(pid: u32) -> Option<u64> {
    let own = kibibytes(format!("/proc/{pid}/status"), "VmHWM")?;
    let others: u64 = children(pid).into_iter().filter_map(peak_resident).sum();
    Some(own + others)
}

/// The child processes of process `pid`.
fn children(pid: u32) -> Vec<u32> {
    let Ok(threads) = fs::read_dir(format!("/proc/{pid}/task")) else {
        return Vec::new();
    };
    let lists = threads
        .flatten()
        .filter_map(|thread| fs::read_to_string(thread.path().join("children")).ok());
    lists
        .flat_map(|list| {
            let numbers = list.split_whitespace().map(str::parse);
            numbers.collect::<Vec<_>>()
        })
        .flatten()
        .collect()
}

/// Number of processes that the kernel has killed for lack of memory.
pub(super) fn kernel_out_of_memory_kills() -> Option<u64> {
    let text = fs::read_to_string("/proc/vmstat").ok()?;
    text.lines()
        .find_map(|line| line.strip_prefix("oom_kill "))
        .and_then(|count| count.trim().parse().ok())
}

/// Name of the environment variable that marks a child and its descendants.
const MARK: &str = "GEOBENCH_CHILD";

/// Time that the orphans of a child have to exit after being killed.
const GRACE: Duration = Duration::from_secs(10);

/// Whether this process adopts orphans.
static ADOPTS: AtomicBool = AtomicBool::new(false);

/// Makes this process the parent of orphaned descendants from now on.
pub fn adopt_orphans() {
    #[cfg(target_os = "linux")]
    if rustix::process::set_child_subreaper(Some(rustix::process::getpid())).is_ok() {
        ADOPTS.store(true, Ordering::Relaxed);
    }
}

/// Identifies the descendants of a child, including those that outlive it.
///
/// A process that calls `setsid` leaves the process group of the child. A process whose parent has
/// exited is no longer a descendant of the child. The `geobench` command is therefore a child
/// subreaper ([`adopt_orphans`]): Linux makes it the parent of such orphans. An orphan is killed
/// with the child to which it belongs. That child is identified by one of:
///
/// 1. the mark in the environment, which descendants inherit unless they replace it;
/// 2. the descendants of the child and of its orphans, recorded before these were killed;
/// 3. having been the only child at work, which is so without `--jobs`, when an orphan without a
///    mark was first seen ([`OrphanOwners`]).
///
/// An orphan that belongs to no child is killed when no child is left. Children that this process
/// has started itself are no orphans. Outside Linux, and in programs that use this library, nothing
/// is adopted.
#[derive(Debug)]
pub(super) struct Descendants {
    child: KnownChild,
    mark: String,
}

/// A process. Ids are reused, so the start time is part of its identity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Process {
    number: u32,
    /// Start time in clock ticks since boot.
    start: u64,
}

impl Descendants {
    /// Starts a child with a unique mark.
    pub(super) fn of(command: &mut Command) -> io::Result<(process::Child, Self)> {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let mark = format!("{}.{count}", process::id());
        command.env(MARK, &mark);
        if ADOPTS.load(Ordering::Relaxed) {
            OrphanOwners::see(&orphans(&started())).start(&mark);
        }
        let (child, known) = spawn(command)?;
        let descendants = Self { child: known, mark };
        Ok((child, descendants))
    }

    /// The current descendants of the child.
    pub(super) fn present(&self) -> DescendantList {
        let mut present = DescendantList(Vec::new());
        if ADOPTS.load(Ordering::Relaxed) {
            present.add_below(self.child.id());
        }
        present
    }

    /// Resident bytes of the child and its descendants. `None` if the child has ended.
    pub(super) fn resident(&self) -> Option<u64> {
        let orphans = self.orphans().into_iter().filter_map(resident);
        Some(resident(self.child.id())? + orphans.sum::<u64>())
    }

    /// Sum of the peak resident bytes of the child and its current descendants. `None` if the child
    /// has ended.
    pub(super) fn peak_resident(&self) -> Option<u64> {
        let orphans = self.orphans().into_iter().filter_map(peak_resident);
        Some(peak_resident(self.child.id())? + orphans.sum::<u64>())
    }

    /// Resets the memory peak of the child and its descendants.
    pub(super) fn reset_peak(&self) {
        reset_peak(self.child.id());
        self.orphans().into_iter().for_each(reset_peak);
    }

    /// The orphans that are known to be descendants of the child.
    fn orphans(&self) -> Vec<u32> {
        if !ADOPTS.load(Ordering::Relaxed) {
            return Vec::new();
        }
        let orphans = orphans(&started());
        let owners = OrphanOwners::see(&orphans);
        let owned = orphans
            .into_iter()
            .filter(|one| owners.has(*one, &self.mark));
        owned.map(|orphan| orphan.number).collect()
    }

    /// Tells that the answer of the child is awaited, until the result is dropped.
    pub(super) fn at_work(&self) -> AtWork {
        AtWork::begin(&self.mark)
    }

    /// Kills all orphans of the child, which has been waited for. `present` lists the descendants
    /// recorded before that.
    pub(super) fn end(&self, mut present: DescendantList) {
        let mut started = started();
        started.retain(|child| *child != self.child.id());
        if !ADOPTS.load(Ordering::Relaxed) {
            return;
        }
        let deadline = Instant::now() + GRACE;
        loop {
            let mut left = false;
            let orphans = orphans(&started);
            let owners = OrphanOwners::see(&orphans);
            for orphan in orphans {
                let belongs = present.0.contains(&orphan)
                    || started.is_empty()
                    || owners.has(orphan, &self.mark);
                if belongs {
                    left = true;
                    present.add_below(orphan.number);
                    // The id of a child stays reserved until the child is waited for.
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
}

/// The mark in the environment of a process.
fn mark(process: Process) -> Option<String> {
    let environment = fs::read(format!("/proc/{}/environ", process.number)).ok()?;
    let mut entries = environment.split(|byte| *byte == 0);
    let value = |entry: &[u8]| {
        let value = entry.strip_prefix(MARK.as_bytes())?.strip_prefix(b"=")?;
        Some(String::from_utf8_lossy(value).into_owned())
    };
    entries.find_map(value)
}

/// To which children the orphans without a mark belong: each to the child that was at work when it
/// was first seen. It cannot have been started by another, which waits for a request.
///
/// A child is at work from its start on: an outside program may have orphans before this process
/// awaits its answer. Orphans are looked for before a child starts and when it begins to work,
/// while its memory is watched, and when it ends. So one that appears after the answer of a child
/// still belongs to that child.
#[derive(Debug)]
pub(super) struct OrphanOwners {
    /// The orphans that were seen, each with the mark of its child. It has none if several children
    /// were at work, or the last one.
    seen: Vec<(Process, Option<String>)>,
    /// The marks of the children whose answers this process awaits.
    at_work: Vec<String>,
    /// The only child that was at work last, or has been started since.
    last: Option<String>,
}

static OWNERS: Mutex<OrphanOwners> = Mutex::new(OrphanOwners {
    seen: Vec::new(),
    at_work: Vec::new(),
    last: None,
});

impl OrphanOwners {
    fn get() -> MutexGuard<'static, Self> {
        OWNERS.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Assigns those of all current `orphans` that are new, and forgets those that are no more.
    fn see(orphans: &[Process]) -> MutexGuard<'static, Self> {
        let mut owners = Self::get();
        owners.seen.retain(|(orphan, _)| orphans.contains(orphan));
        for &orphan in orphans {
            if owners.seen.iter().all(|(seen, _)| *seen != orphan) {
                let owner = mark(orphan).or_else(|| owners.last.clone());
                owners.seen.push((orphan, owner));
            }
        }
        owners
    }

    /// Records that the child with this mark starts.
    fn start(&mut self, mark: &str) {
        self.last = self.at_work.is_empty().then(|| mark.to_owned());
    }

    /// Records that the answer of the child with this mark is awaited.
    fn begin(&mut self, mark: &str) {
        self.at_work.push(mark.to_owned());
        self.last = (self.at_work.len() == 1).then(|| mark.to_owned());
    }

    /// Whether an orphan that was seen belongs to the child with this mark.
    fn has(&self, orphan: Process, mark: &str) -> bool {
        let found = self.seen.iter().find(|(seen, _)| *seen == orphan);
        found.is_some_and(|(_, owner)| owner.as_deref() == Some(mark))
    }
}

/// A child whose answer this process awaits.
pub(super) struct AtWork {
    mark: String,
}

impl AtWork {
    fn begin(mark: &str) -> Self {
        if ADOPTS.load(Ordering::Relaxed) {
            // Those that have appeared since the last child worked or started are of that child.
            OrphanOwners::see(&orphans(&started())).begin(mark);
        }
        Self {
            mark: mark.to_owned(),
        }
    }
}

impl Drop for AtWork {
    fn drop(&mut self) {
        let mut owners = OrphanOwners::get();
        if let Some(place) = owners.at_work.iter().position(|mark| *mark == self.mark) {
            owners.at_work.swap_remove(place);
        }
    }
}

/// The processes that belong to a child.
pub(super) struct DescendantList(Vec<Process>);

impl DescendantList {
    /// Adds all descendants of a process.
    fn add_below(&mut self, number: u32) {
        for child in children(number) {
            if let Some(process) = look(child)
                && !self.0.contains(&process)
            {
                self.0.push(process);
                self.add_below(child);
            }
        }
    }
}

/// The orphans that this process has adopted: its children that it has not started.
fn orphans(started: &[u32]) -> Vec<Process> {
    let children = children(process::id()).into_iter();
    let strangers = children.filter(|child| !started.contains(child));
    strangers.filter_map(look).collect()
}

/// The process with this id.
fn look(number: u32) -> Option<Process> {
    let text = fs::read(format!("/proc/{number}/stat")).ok()?;
    let text = String::from_utf8_lossy(&text);
    // The name of the program, in parentheses, may contain any character.
    let (_, facts) = text.rsplit_once(") ")?;
    let start = facts.split(' ').nth(19)?.parse().ok()?;
    Some(Process { number, start })
}

/// Reaps a child if it has exited.
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
    fn linux_gives_memory_and_kills() {
        assert!(kernel_out_of_memory_kills().is_some());
        let own = resident(std::process::id()).unwrap();
        assert!(own > 1 << 20, "{own}");
        assert_eq!(resident(u32::MAX), None);
    }

    #[test]
    fn processes_that_a_process_started_count_with_it() {
        let mut shell = Command::new("sh")
            .args(["-c", "sleep 60 & echo; wait"])
            .stdout(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        let mut line = [0];
        std::io::Read::read_exact(shell.stdout.as_mut().unwrap(), &mut line).unwrap();
        let started = children(shell.id());
        assert_eq!(started.len(), 1);
        // Until it sleeps, its memory changes.
        let stat = format!("/proc/{}/stat", started[0]);
        while !fs::read_to_string(&stat).unwrap().contains("(sleep) S") {
            thread::sleep(Duration::from_millis(1));
        }
        let both = resident(shell.id()).unwrap();
        assert!(both > resident(started[0]).unwrap());
        let sleep = rustix::process::Pid::from_raw(started[0].cast_signed()).unwrap();
        rustix::process::kill_process(sleep, rustix::process::Signal::KILL).unwrap();
        shell.wait().unwrap();
    }

    #[test]
    fn a_process_is_known_by_its_number_and_start() {
        let own = look(process::id()).unwrap();
        assert!(own.start > 0);
        assert_eq!(look(process::id()).unwrap(), own);
        assert_eq!(look(u32::MAX), None);
    }

    #[test]
    fn early_orphans_belong_to_the_child_that_starts() {
        let mut owners = OrphanOwners {
            seen: Vec::new(),
            at_work: Vec::new(),
            last: None,
        };
        owners.begin("a");
        assert_eq!(owners.last.as_deref(), Some("a"));
        owners.at_work.clear();
        owners.start("b");
        assert_eq!(owners.last.as_deref(), Some("b"));
        // Two at work: whose they are is unknown.
        owners.begin("b");
        owners.start("c");
        assert_eq!(owners.last, None);
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
