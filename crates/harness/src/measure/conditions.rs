//! Disturbances during a benchmark: other processes, frequency changes, swapping, throttling.
//!
//! Values come from `/proc` and `/sys`, read before the first run and after the last one, never
//! during a timed run. Values that the system does not report are absent. Linux reports most,
//! virtual machines fewer. Disturbed times stay in the result file. A warning is recorded there and
//! printed at the end of the run.

use std::fs;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::{Instant, SystemTime};

use crate::measure::host::{kibibytes, load, text};
use crate::measure::number::counted;
use crate::schema::Conditions;

/// A run counts as disturbed if other processes keep more processors busy than this, on average.
const OTHER_LOAD_LIMIT: f64 = 0.1;

/// A run counts as disturbed if more than this share of time was stolen from a virtual machine.
const STOLEN_LIMIT: f64 = 0.01;

/// A run counts as disturbed if the frequency at the end is below this fraction of that at the
/// start.
const FREQUENCY_LIMIT: f64 = 0.9;

/// The frequency governor that keeps the frequency fixed.
const FIXED: &str = "performance";

/// The conditions between two snapshots, with warnings about disturbances.
pub fn between(start: &Snapshot, end: &Snapshot) -> Conditions {
    let times = end.times_since(start);
    let grown = |of: fn(&Snapshot) -> Option<u64>| Some(of(end)?.saturating_sub(of(start)?));
    let mut conditions = Conditions {
        governors: end.governors.clone(),
        frequency_start: start.frequency,
        frequency_end: end.frequency,
        frequency_max: end.frequency_max,
        load_end: end.load,
        other_load: times.map(|times| times.other),
        stolen: times.map(|times| times.stolen),
        swap_used_bytes: end.swap_used_bytes,
        swapped_pages: grown(|s| s.swapped_pages),
        thermal_throttles: grown(|s| s.thermal_throttles),
        cgroup_throttles: grown(|s| s.cgroup_throttles),
        cgroup_throttled_seconds: end
            .cgroup_throttled_seconds
            .zip(start.cgroup_throttled_seconds)
            .map(|(end, start)| (end - start).max(0.0)),
        warnings: Vec::new(),
    };
    conditions.warnings = doubts(&conditions);
    conditions.warnings.extend(clock_jump(start, end));
    conditions
}

/// Smallest difference in seconds between the clock of the system and a steady one that counts as a
/// jump. Synchronised clocks are slewed by less during a run of hours.
const JUMP: f64 = 1.0;

/// A warning if the clock of the system was set between two snapshots. Times do not depend on it,
/// but the dates of the result file do.
fn clock_jump(start: &Snapshot, end: &Snapshot) -> Option<String> {
    let ((wall_before, before), (wall_after, after)) = (start.clocks?, end.clocks?);
    let passed = after.duration_since(before).as_secs_f64();
    let shown = match wall_after.duration_since(wall_before) {
        Ok(passed) => passed.as_secs_f64(),
        Err(back) => -back.duration().as_secs_f64(),
    };
    let jump = shown - passed;
    (jump.abs() > JUMP + 1e-4 * passed).then(|| {
        let direction = if jump > 0.0 { "forward" } else { "back" };
        format!(
            "the clock was set {direction} by {:.0} s, so the dates of the result are off",
            jump.abs()
        )
    })
}

/// Combines the conditions of several runs, in order: the worst of each figure, and all warnings
/// without repetition. Frequency and load keep the first value of the start and the last of the
/// end. `None` without runs.
pub fn worst(runs: impl IntoIterator<Item = Conditions>) -> Option<Conditions> {
    runs.into_iter().reduce(|a, b| {
        let mut warnings = a.warnings;
        for warning in b.warnings {
            if !warnings.contains(&warning) {
                warnings.push(warning);
            }
        }
        let more = |a: Option<f64>, b: Option<f64>| a.into_iter().chain(b).reduce(f64::max);
        Conditions {
            governors: a.governors.or(b.governors),
            frequency_start: a.frequency_start.or(b.frequency_start),
            frequency_end: b.frequency_end,
            frequency_max: a.frequency_max.max(b.frequency_max),
            load_end: b.load_end,
            other_load: more(a.other_load, b.other_load),
            stolen: more(a.stolen, b.stolen),
            swap_used_bytes: a.swap_used_bytes.max(b.swap_used_bytes),
            swapped_pages: a.swapped_pages.max(b.swapped_pages),
            thermal_throttles: a.thermal_throttles.max(b.thermal_throttles),
            cgroup_throttles: a.cgroup_throttles.max(b.cgroup_throttles),
            cgroup_throttled_seconds: more(a.cgroup_throttled_seconds, b.cgroup_throttled_seconds),
            warnings,
        }
    })
}

/// The warnings about disturbances.
fn doubts(conditions: &Conditions) -> Vec<String> {
    let mut doubts = Vec::new();
    if let Some(busy) = conditions
        .other_load
        .filter(|busy| *busy > OTHER_LOAD_LIMIT)
    {
        doubts.push(format!("other programs kept {busy:.1} processors busy"));
    }
    if let Some(stolen) = conditions.stolen.filter(|stolen| *stolen > STOLEN_LIMIT) {
        doubts.push(format!(
            "the host of this virtual machine took {:.0} % of its time away",
            100.0 * stolen
        ));
    }
    let governors = conditions.governors.iter().flatten();
    let moving: Vec<&str> = governors
        .map(String::as_str)
        .filter(|g| *g != FIXED)
        .collect();
    if !moving.is_empty() {
        doubts.push(format!(
            "the frequency of the processors is not fixed: governor {}",
            moving.join(", ")
        ));
    }
    if let (Some(start), Some(end)) = (conditions.frequency_start, conditions.frequency_end)
        && (end as f64) < FREQUENCY_LIMIT * start as f64
    {
        doubts.push(format!(
            "the processors slowed down from {:.2} to {:.2} GHz",
            start as f64 / 1e9,
            end as f64 / 1e9
        ));
    }
    let happened = |count: Option<u64>| count.filter(|count| *count > 0).map(|n| n as usize);
    if let Some(pages) = happened(conditions.swapped_pages) {
        doubts.push(format!("the system swapped {}", counted(pages, "page")));
    }
    if let Some(times) = happened(conditions.thermal_throttles) {
        doubts.push(format!(
            "processors were too hot and slowed down {}",
            counted(times, "time")
        ));
    }
    if let Some(times) = happened(conditions.cgroup_throttles) {
        doubts.push(format!(
            "the control group ran out of its share of the processors {}",
            counted(times, "time")
        ));
    }
    doubts
}

/// Unit of times in `/proc` (`USER_HZ`), the same on every Linux.
const TICKS_PER_SECOND: u64 = 100;

/// The state of the system at one moment. Values that the system does not report are absent.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// The system clock, and one that is never set.
    clocks: Option<(SystemTime, Instant)>,
    ticks: Option<Ticks>,
    /// Ticks of this process and of its children that have been waited for.
    own: Option<u64>,
    governors: Option<Vec<String>>,
    frequency: Option<u64>,
    frequency_max: Option<u64>,
    load: Option<f64>,
    swap_used_bytes: Option<u64>,
    swapped_pages: Option<u64>,
    thermal_throttles: Option<u64>,
    cgroup_throttles: Option<u64>,
    cgroup_throttled_seconds: Option<f64>,
}

/// Ticks of all processors since boot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Ticks {
    all: u64,
    idle: u64,
    stolen: u64,
    processors: u64,
}

/// Processor use between two snapshots.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Times {
    /// Mean number of processors busy with other processes.
    other: f64,
    /// Share of steal time: the hypervisor gave it to other machines.
    stolen: f64,
}

impl Snapshot {
    /// Reads the files below `root`, which is `/` except in tests.
    pub fn take(root: &Path) -> Self {
        let processors = processors(root);
        let of_each = |file: &str| -> Vec<PathBuf> {
            processors.iter().map(|path| path.join(file)).collect()
        };
        let (cgroup_throttles, cgroup_throttled_seconds) = cgroup(root);
        Self {
            clocks: Some((SystemTime::now(), Instant::now())),
            ticks: ticks(root),
            own: own_ticks(root),
            governors: governors(&of_each("cpufreq/scaling_governor")),
            frequency: most_kilohertz(&of_each("cpufreq/scaling_cur_freq")),
            frequency_max: most_kilohertz(&of_each("cpufreq/cpuinfo_max_freq")),
            load: load(root),
            swap_used_bytes: swap_used(root),
            swapped_pages: swapped(root),
            thermal_throttles: of_each("thermal_throttle/core_throttle_count")
                .iter()
                .filter_map(|path| number::<u64>(&text(path)?))
                .reduce(|a, b| a + b),
            cgroup_throttles,
            cgroup_throttled_seconds,
        }
    }

    /// Processor use since `start`; `None` for less than a second of processor time.
    fn times_since(&self, start: &Self) -> Option<Times> {
        let (a, b) = (start.ticks?, self.ticks?);
        let all = b.all.checked_sub(a.all)?;
        if all < TICKS_PER_SECOND {
            return None;
        }
        let idle = b.idle.saturating_sub(a.idle);
        let stolen = b.stolen.saturating_sub(a.stolen);
        let own = self.own?.saturating_sub(start.own?);
        let others = all.saturating_sub(idle + stolen + own);
        Some(Times {
            other: others as f64 / all as f64 * b.processors as f64,
            stolen: stolen as f64 / all as f64,
        })
    }
}

fn number<T: FromStr>(text: &str) -> Option<T> {
    text.trim().parse().ok()
}

/// The second word of the first line of `text` whose first word is `key`.
fn value<T: FromStr>(text: &str, key: &str) -> Option<T> {
    text.lines().find_map(|line| {
        let mut words = line.split_whitespace();
        (words.next()? == key)
            .then(|| number(words.next()?))
            .flatten()
    })
}

/// The directories of all processors, sorted by name.
fn processors(root: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(root.join("sys/devices/system/cpu")) else {
        return Vec::new();
    };
    let is_processor = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.strip_prefix("cpu")
            .is_some_and(|n| number::<u32>(n).is_some())
    };
    let mut paths: Vec<PathBuf> = entries.filter_map(|e| Some(e.ok()?.path())).collect();
    paths.retain(is_processor);
    paths.sort_unstable();
    paths
}

fn governors(files: &[PathBuf]) -> Option<Vec<String>> {
    let mut names: Vec<String> = files.iter().filter_map(text).collect();
    names.sort_unstable();
    names.dedup();
    (!names.is_empty()).then_some(names)
}

/// The largest value in the files, converted from kHz to Hz.
fn most_kilohertz(files: &[PathBuf]) -> Option<u64> {
    let all = files.iter().filter_map(|path| number::<u64>(&text(path)?));
    all.max()?.checked_mul(1000)
}

/// Parses the first line of `/proc/stat`: user, nice, system, idle, iowait, irq, softirq, steal.
/// The fields after these are already included in user and nice.
fn ticks(root: &Path) -> Option<Ticks> {
    let text = text(root.join("proc/stat"))?;
    let mut lines = text.lines().filter(|line| line.starts_with("cpu"));
    let fields: Vec<u64> = lines
        .next()?
        .split_whitespace()
        .skip(1)
        .take(8)
        .map(|field| number(field).unwrap_or(0))
        .collect();
    Some(Ticks {
        all: fields.iter().sum(),
        idle: fields.get(3)? + fields.get(4)?,
        stolen: fields.get(7).copied().unwrap_or(0),
        processors: lines.count() as u64,
    })
}

/// Sum of the fields utime, stime, cutime and cstime of `/proc/self/stat`. The name of the program
/// may contain any character, so the fields start after the last parenthesis.
fn own_ticks(root: &Path) -> Option<u64> {
    let text = text(root.join("proc/self/stat"))?;
    let (_, fields) = text.rsplit_once(')')?;
    let fields: Vec<&str> = fields.split_whitespace().collect();
    fields
        .get(11..15)?
        .iter()
        .map(|field| number::<u64>(field))
        .sum()
}

fn swap_used(root: &Path) -> Option<u64> {
    let size = |key| kibibytes(root.join("proc/meminfo"), key);
    size("SwapTotal")?.checked_sub(size("SwapFree")?)
}

fn swapped(root: &Path) -> Option<u64> {
    let text = text(root.join("proc/vmstat"))?;
    Some(value::<u64>(&text, "pswpin")? + value::<u64>(&text, "pswpout")?)
}

/// Number and total seconds of throttling of the cgroup of this process, from `cpu.stat` of cgroup
/// v2 or v1. In a container the path in `/proc/self/cgroup` may be that of the host. The cgroup is
/// then at the root of the mount.
fn cgroup(root: &Path) -> (Option<u64>, Option<f64>) {
    let mounted = root.join("sys/fs/cgroup");
    let mut places = Vec::new();
    for line in text(root.join("proc/self/cgroup"))
        .unwrap_or_default()
        .lines()
    {
        let mut fields = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(path)) = (fields.next(), fields.next()) else {
            continue;
        };
        let base = if controllers.is_empty() {
            mounted.clone()
        } else if controllers.split(',').any(|c| c == "cpu") {
            mounted.join(controllers)
        } else {
            continue;
        };
        places.push(base.join(path.trim_start_matches('/')));
        places.push(base);
    }
    let found = places.iter().find_map(|place| {
        let text = text(place.join("cpu.stat"))?;
        let times: u64 = value(&text, "nr_throttled")?;
        let seconds = value(&text, "throttled_usec")
            .map(|micro: f64| micro / 1e6)
            .or_else(|| value(&text, "throttled_time").map(|nano: f64| nano / 1e9));
        Some((times, seconds))
    });
    found.map_or((None, None), |(times, seconds)| (Some(times), seconds))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use tempfile::TempDir;

    use super::*;

    /// Creates a directory with these files.
    fn system(files: &[(&str, &str)]) -> TempDir {
        let root = tempfile::tempdir().unwrap();
        for (path, contents) in files {
            let path = root.path().join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, contents).unwrap();
        }
        root
    }

    fn between(start: &[(&str, &str)], end: &[(&str, &str)]) -> Conditions {
        let [start, end] = [start, end].map(|files| Snapshot::take(system(files).path()));
        super::between(&start, &end)
    }

    /// utime, stime, cutime and cstime of this process.
    fn own(ticks: [u64; 4]) -> String {
        let [u, s, cu, cs] = ticks;
        format!("77 (a ) (b) R 1 1 1 0 -1 4194304 95 0 0 0 {u} {s} {cu} {cs} 20 0 1 0 71833")
    }

    #[test]
    fn a_quiet_system_gives_no_warning() {
        let (before, after) = (own([10, 5, 0, 0]), own([210, 25, 600, 80]));
        let frequencies = [
            (
                "sys/devices/system/cpu/cpu0/cpufreq/scaling_governor",
                "performance\n",
            ),
            (
                "sys/devices/system/cpu/cpu0/cpufreq/scaling_cur_freq",
                "3000000\n",
            ),
            (
                "sys/devices/system/cpu/cpu0/cpufreq/cpuinfo_max_freq",
                "3600000\n",
            ),
            (
                "sys/devices/system/cpu/cpu1/cpufreq/scaling_governor",
                "performance\n",
            ),
            (
                "sys/devices/system/cpu/cpu1/cpufreq/scaling_cur_freq",
                "2900000\n",
            ),
            ("sys/devices/system/cpu/cpufreq/boost", "1\n"),
            (
                "sys/devices/system/cpu/cpu0/thermal_throttle/core_throttle_count",
                "4\n",
            ),
            (
                "sys/devices/system/cpu/cpu1/thermal_throttle/core_throttle_count",
                "1\n",
            ),
            (
                "proc/meminfo",
                "MemTotal: 8 kB\nSwapTotal: 1000 kB\nSwapFree: 900 kB\n",
            ),
            ("proc/vmstat", "pswpin 5\npswpout 6\n"),
            ("proc/self/cgroup", "0::/user.slice/x\n"),
            (
                "sys/fs/cgroup/user.slice/x/cpu.stat",
                "usage_usec 9\nnr_periods 9\nnr_throttled 3\nthrottled_usec 1500000\n",
            ),
        ];
        let mut start = frequencies.to_vec();
        start.extend([
            (
                "proc/stat",
                "cpu  100 0 50 1000 10 0 0 0 0 0\ncpu0 1\ncpu1 1\nintr 7\n",
            ),
            ("proc/self/stat", before.as_str()),
            ("proc/loadavg", "0.10 0.20 0.30 1/99 7\n"),
        ]);
        let mut end = frequencies.to_vec();
        end.extend([
            // 2,000 ticks, 900 of this process and 40 of others.
            (
                "proc/stat",
                "cpu  940 0 150 2040 30 0 0 0 0 0\ncpu0 1\ncpu1 1\nintr 7\n",
            ),
            ("proc/self/stat", after.as_str()),
            ("proc/loadavg", "1.10 0.20 0.30 1/99 7\n"),
        ]);
        let found = between(&start, &end);
        assert_eq!(
            found,
            Conditions {
                governors: Some(vec!["performance".into()]),
                frequency_start: Some(3_000_000_000),
                frequency_end: Some(3_000_000_000),
                frequency_max: Some(3_600_000_000),
                load_end: Some(1.1),
                other_load: Some(0.04),
                stolen: Some(0.0),
                swap_used_bytes: Some(102_400),
                swapped_pages: Some(0),
                thermal_throttles: Some(0),
                cgroup_throttles: Some(0),
                cgroup_throttled_seconds: Some(0.0),
                warnings: Vec::new(),
            }
        );
    }

    #[test]
    fn every_disturbance_is_warned_of() {
        let (before, after) = (own([0; 4]), own([500, 0, 0, 0]));
        let start = [
            ("proc/stat", "cpu  0 0 0 0 0 0 0 0 0 0\ncpu0 1\ncpu1 1\n"),
            ("proc/self/stat", before.as_str()),
            (
                "sys/devices/system/cpu/cpu0/cpufreq/scaling_cur_freq",
                "3000000",
            ),
            (
                "sys/devices/system/cpu/cpu0/thermal_throttle/core_throttle_count",
                "4",
            ),
            ("proc/vmstat", "pswpin 5\npswpout 6\n"),
            // cgroup v1 in a container: the path does not exist there.
            (
                "proc/self/cgroup",
                "3:cpuset:/\n2:cpu,cpuacct:/elsewhere\n1:name=systemd:/\n",
            ),
            (
                "sys/fs/cgroup/cpu,cpuacct/cpu.stat",
                "nr_periods 9\nnr_throttled 3\nthrottled_time 500000000\n",
            ),
        ];
        let end = [
            (
                "proc/stat",
                "cpu  900 0 0 1000 0 0 0 100 0 0\ncpu0 1\ncpu1 1\n",
            ),
            ("proc/self/stat", after.as_str()),
            (
                "sys/devices/system/cpu/cpu0/cpufreq/scaling_governor",
                "powersave",
            ),
            (
                "sys/devices/system/cpu/cpu0/cpufreq/scaling_cur_freq",
                "2000000",
            ),
            (
                "sys/devices/system/cpu/cpu0/thermal_throttle/core_throttle_count",
                "6",
            ),
            ("proc/vmstat", "pswpin 50\npswpout 7\n"),
            (
                "proc/self/cgroup",
                "3:cpuset:/\n2:cpu,cpuacct:/elsewhere\n1:name=systemd:/\n",
            ),
            (
                "sys/fs/cgroup/cpu,cpuacct/cpu.stat",
                "nr_periods 9\nnr_throttled 8\nthrottled_time 750000000\n",
            ),
        ];
        let found = between(&start, &end);
        assert_eq!(found.cgroup_throttled_seconds, Some(0.25));
        assert_eq!(
            found.warnings,
            [
                "other programs kept 0.4 processors busy",
                "the host of this virtual machine took 5 % of its time away",
                "the frequency of the processors is not fixed: governor powersave",
                "the processors slowed down from 3.00 to 2.00 GHz",
                "the system swapped 46 pages",
                "processors were too hot and slowed down 2 times",
                "the control group ran out of its share of the processors 5 times",
            ]
        );
    }

    #[test]
    fn missing_or_malformed_system_files_give_no_conditions() {
        assert_eq!(between(&[], &[]), Conditions::default());
        let nonsense = [
            ("proc/stat", "cpu x\n"),
            ("proc/self/stat", "no parenthesis"),
            ("proc/loadavg", "?"),
            ("proc/meminfo", "SwapTotal: 3 kB\nSwapFree: 5 kB\n"),
            ("proc/self/cgroup", "0\n0::/\n"),
            ("sys/fs/cgroup/cpu.stat", "usage_usec 7\n"),
            (
                "sys/devices/system/cpu/cpu0/cpufreq/scaling_cur_freq",
                "fast",
            ),
        ];
        assert_eq!(between(&nonsense, &nonsense), Conditions::default());
    }

    #[test]
    fn a_run_that_is_too_short_has_no_other_load() {
        let idle = own([0; 4]);
        let after = |ticks: &str| {
            let start = [
                ("proc/stat", "cpu 0 0 0 0 0 0 0 0\ncpu0\n"),
                ("proc/self/stat", &idle),
            ];
            let end = [("proc/stat", ticks), ("proc/self/stat", &idle)];
            between(&start, &end).other_load
        };
        assert_eq!(after("cpu 99 0 0 0 0 0 0 0\ncpu0\n"), None);
        assert_eq!(after("cpu 100 0 0 0 0 0 0 0\ncpu0\n"), Some(1.0));
    }

    #[test]
    fn of_several_runs_the_worst_counts() {
        let run = |other_load, warning: &str| Conditions {
            other_load: Some(other_load),
            warnings: vec!["the system swapped 1 pages".into(), warning.into()],
            ..Conditions::default()
        };
        let worst = super::worst([run(0.5, "a"), run(0.25, "b")]).unwrap();
        assert_eq!(worst.other_load, Some(0.5));
        assert_eq!(worst.warnings, ["the system swapped 1 pages", "a", "b"]);
        assert_eq!(super::worst([]), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn this_system_gives_the_times_of_processors() {
        let snapshot = Snapshot::take(std::path::Path::new("/"));
        assert!(snapshot.load.is_some());
        let idle = own([0; 4]);
        let nothing = [
            ("proc/stat", "cpu 0 0 0 0 0 0 0 0\n"),
            ("proc/self/stat", idle.as_str()),
        ];
        let start = Snapshot::take(system(&nothing).path());
        let times = snapshot.times_since(&start).unwrap();
        assert!(times.other > 0.0 && times.stolen >= 0.0);
    }
}
