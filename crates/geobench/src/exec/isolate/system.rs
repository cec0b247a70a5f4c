//! Calls to the operating system. Functions without a counterpart outside Linux do nothing there,
//! or return `None`.

use std::fs;
use std::process::Command;

use rustix::process::{Resource, Rlimit, getppid, setrlimit};

/// A command that starts this program, even if its file has been replaced.
pub(super) fn this_program() -> Command {
    if cfg!(target_os = "linux") {
        Command::new("/proc/self/exe")
    } else {
        Command::new(std::env::current_exe().unwrap_or_else(|_| "geobench".into()))
    }
}

/// Kills this process when its parent ends.
pub(super) fn die_with_parent() {
    #[cfg(target_os = "linux")]
    let _ = rustix::process::set_parent_process_death_signal(Some(rustix::process::Signal::KILL));
}

/// Whether process `parent` is still the parent of this one.
pub(super) fn is_parent(parent: u32) -> bool {
    getppid().is_some_and(|pid| u32::try_from(pid.as_raw_pid()) == Ok(parent))
}

/// Sets the name that `ps` and `top` show.
pub(super) fn name_this_process() {
    #[cfg(target_os = "linux")]
    let _ = rustix::thread::set_name(c"geobench-cell");
}

/// Disables core dumps, which take long to write.
pub(super) fn disable_core_dumps() {
    let none = Rlimit {
        current: Some(0),
        maximum: Some(0),
    };
    let _ = setrlimit(Resource::Core, none);
}

/// Makes allocations fail beyond `bytes` of private data, touched or not.
pub(super) fn limit_data(bytes: u64) {
    let bound = Rlimit {
        current: Some(bytes),
        maximum: Some(bytes),
    };
    let _ = setrlimit(Resource::Data, bound);
}

/// Sets which process the kernel kills first when out of memory: one at work, rather than a waiting
/// one or the parent, which has all results.
pub(super) fn raise_oom_score(at_work: bool) {
    let _ = fs::write(
        "/proc/self/oom_score_adj",
        if at_work { "1000" } else { "500" },
    );
}

/// Resident bytes of a process and its descendants.
pub(super) fn resident(pid: u32) -> Option<u64> {
    let pages = fs::read_to_string(format!("/proc/{pid}/statm")).ok()?;
    let pages: u64 = pages.split(' ').nth(1)?.parse().ok()?;
    let own = pages * rustix::param::page_size() as u64;
    let others: u64 = children(pid).into_iter().filter_map(resident).sum();
    Some(own + others)
}

/// Processes whose parent is process `pid`.
pub(super) fn children(pid: u32) -> Vec<u32> {
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

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn linux_tells_what_is_asked() {
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
        let both = resident(shell.id()).unwrap();
        assert!(both > resident(started[0]).unwrap());
        let sleep = rustix::process::Pid::from_raw(started[0].cast_signed()).unwrap();
        rustix::process::kill_process(sleep, rustix::process::Signal::KILL).unwrap();
        shell.wait().unwrap();
    }
}
