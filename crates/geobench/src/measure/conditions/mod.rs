//! What the machine did besides measuring: other programs, frequency, swapping, throttling.
//!
//! The system is asked before the first run and after the last one, never while something is timed. What it
//! does not tell (it tells most on Linux, and less in a virtual machine) is absent. Times that such a
//! disturbance may have spoilt stay in the file; the file says so, and so does the end of the run.

mod snapshot;
#[cfg(test)]
mod tests;

use crate::schema::Conditions;

pub use snapshot::Snapshot;

/// From how many processors kept busy by other programs, on average, a run counts as disturbed.
const OTHER_LOAD_LIMIT: f64 = 0.1;

/// From which share of its time that a virtual machine did not get a run counts as disturbed.
const STOLEN_LIMIT: f64 = 0.01;

/// The frequency at the end, as a share of that at the start, below which something slowed the processor down.
const FREQUENCY_LIMIT: f64 = 0.9;

/// The governor that keeps the frequency where it is.
const FIXED: &str = "performance";

/// What happened between two looks at the system.
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
    conditions
}

/// The conditions of several runs together: the worst of each.
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

/// What makes times doubtful.
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
    let happened = |count: Option<u64>| count.filter(|count| *count > 0);
    if let Some(pages) = happened(conditions.swapped_pages) {
        doubts.push(format!("the system swapped {pages} pages"));
    }
    if let Some(times) = happened(conditions.thermal_throttles) {
        doubts.push(format!(
            "processors were too hot and slowed down {times} times"
        ));
    }
    if let Some(times) = happened(conditions.cgroup_throttles) {
        doubts.push(format!(
            "the control group ran out of its share of the processors {times} times"
        ));
    }
    doubts
}
