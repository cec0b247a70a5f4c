//! Made-up systems.

use std::fs;

use tempfile::TempDir;

use super::*;

/// A directory with these files in it.
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

/// The ticks of this process: utime and stime, and those of its children.
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
        // 2,000 ticks, of which this process had 900 and others 40.
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
        // The first version of control groups, in a container: the path is not there.
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
fn a_system_that_tells_nothing_is_not_accused_of_anything() {
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
fn too_short_a_run_says_nothing_of_others() {
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
fn this_system_tells_who_had_the_processors() {
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
