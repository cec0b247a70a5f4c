//! One look at the system, through the files of Linux.

use std::fs;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Ticks of the processors that make a second; Linux shows them so whatever its own clock.
const TICKS_PER_SECOND: u64 = 100;

/// What the system says at one moment. What it does not say is absent.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    ticks: Option<Ticks>,
    /// Ticks of this process, and of its children that have ended.
    own: Option<u64>,
    pub(super) governors: Option<Vec<String>>,
    pub(super) frequency: Option<u64>,
    pub(super) frequency_max: Option<u64>,
    pub(super) load: Option<f64>,
    pub(super) swap_used_bytes: Option<u64>,
    pub(super) swapped_pages: Option<u64>,
    pub(super) thermal_throttles: Option<u64>,
    pub(super) cgroup_throttles: Option<u64>,
    pub(super) cgroup_throttled_seconds: Option<f64>,
}

/// Ticks of all processors since the system started.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Ticks {
    all: u64,
    idle: u64,
    stolen: u64,
    processors: u64,
}

/// Who had the processors between two moments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Times {
    /// Processors that others kept busy.
    pub(super) other: f64,
    /// Share that nobody here had.
    pub(super) stolen: f64,
}

impl Snapshot {
    /// Looks at the system below `root`, which is `/` except in tests.
    pub fn take(root: &Path) -> Self {
        let processors = processors(root);
        let of_each = |file: &str| -> Vec<PathBuf> {
            processors.iter().map(|path| path.join(file)).collect()
        };
        let (cgroup_throttles, cgroup_throttled_seconds) = cgroup(root);
        Self {
            ticks: ticks(root),
            own: own_ticks(root),
            governors: governors(&of_each("cpufreq/scaling_governor")),
            frequency: most_kilohertz(&of_each("cpufreq/scaling_cur_freq")),
            frequency_max: most_kilohertz(&of_each("cpufreq/cpuinfo_max_freq")),
            load: text(&root.join("proc/loadavg")).and_then(|t| number(t.split(' ').next()?)),
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

    /// Who had the processors since `start`; none if that is less than a second of one of them.
    pub(super) fn times_since(&self, start: &Self) -> Option<Times> {
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

fn text(path: &Path) -> Option<String> {
    Some(fs::read_to_string(path).ok()?.trim().to_owned())
}

fn number<T: FromStr>(text: &str) -> Option<T> {
    text.trim().parse().ok()
}

/// The value in the line of `text` that starts with the word `key`.
fn value<T: FromStr>(text: &str, key: &str) -> Option<T> {
    text.lines().find_map(|line| {
        let mut words = line.split_whitespace();
        (words.next()? == key)
            .then(|| number(words.next()?))
            .flatten()
    })
}

/// The directories of all processors, in their order by name.
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
    let mut names: Vec<String> = files.iter().filter_map(|path| text(path)).collect();
    names.sort_unstable();
    names.dedup();
    (!names.is_empty()).then_some(names)
}

/// The largest of what the files hold in kilohertz, in hertz.
fn most_kilohertz(files: &[PathBuf]) -> Option<u64> {
    let all = files.iter().filter_map(|path| number::<u64>(&text(path)?));
    all.max()?.checked_mul(1000)
}

/// The first line of `/proc/stat`: user, nice, system, idle, iowait, irq, softirq, steal; what follows is
/// counted in user and nice already.
fn ticks(root: &Path) -> Option<Ticks> {
    let text = text(&root.join("proc/stat"))?;
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

/// The fields utime, stime, cutime and cstime of `/proc/self/stat`. The name of the program, which may
/// hold anything, ends at the last parenthesis.
fn own_ticks(root: &Path) -> Option<u64> {
    let text = text(&root.join("proc/self/stat"))?;
    let (_, fields) = text.rsplit_once(')')?;
    let fields: Vec<&str> = fields.split_whitespace().collect();
    fields
        .get(11..15)?
        .iter()
        .map(|field| number::<u64>(field))
        .sum()
}

fn swap_used(root: &Path) -> Option<u64> {
    let text = text(&root.join("proc/meminfo"))?;
    let total: u64 = value(&text, "SwapTotal:")?;
    total
        .checked_sub(value(&text, "SwapFree:")?)?
        .checked_mul(1024)
}

fn swapped(root: &Path) -> Option<u64> {
    let text = text(&root.join("proc/vmstat"))?;
    Some(value::<u64>(&text, "pswpin")? + value::<u64>(&text, "pswpout")?)
}

/// How many times the control group of this process was throttled, and for how many seconds. In a container the
/// path in `/proc/self/cgroup` may be that of the host; the group is then the root of what is seen.
fn cgroup(root: &Path) -> (Option<u64>, Option<f64>) {
    let mounted = root.join("sys/fs/cgroup");
    let mut places = Vec::new();
    for line in text(&root.join("proc/self/cgroup"))
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
        let text = text(&place.join("cpu.stat"))?;
        let times: u64 = value(&text, "nr_throttled")?;
        let seconds = value(&text, "throttled_usec")
            .map(|micro: f64| micro / 1e6)
            .or_else(|| value(&text, "throttled_time").map(|nano: f64| nano / 1e9));
        Some((times, seconds))
    });
    found.map_or((None, None), |(times, seconds)| (Some(times), seconds))
}
