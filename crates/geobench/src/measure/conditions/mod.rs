//! What the machine did besides measuring: other programs, frequency, swapping, throttling.
//!
//! The system is asked before the first run and after the last one, never while something is timed. What it
//! does not tell (it tells most on Linux, and less in a virtual machine) is absent. Times that such a
//! disturbance may have spoilt stay in the file; the file says so, and so does the end of the run.

mod snapshot;
#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

pub use snapshot::Snapshot;

/// From how many processors kept busy by other programs, on average, a run counts as disturbed.
const OTHER_LOAD_LIMIT: f64 = 0.1;

/// From which share of its time that a virtual machine did not get a run counts as disturbed.
const STOLEN_LIMIT: f64 = 0.01;

/// The frequency at the end, as a share of that at the start, below which something slowed the processor down.
const FREQUENCY_LIMIT: f64 = 0.9;

/// The governor that keeps the frequency where it is.
const FIXED: &str = "performance";

/// What happened on the machine between the start and the end of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Conditions {
    /// The governors of the processors' frequencies at the end, each once.
    pub governors: Option<Vec<String>>,
    /// Frequency of the fastest processor at the start, in hertz.
    pub frequency_start: Option<u64>,
    /// The same at the end.
    pub frequency_end: Option<u64>,
    /// The highest frequency that a processor has, in hertz.
    pub frequency_max: Option<u64>,
    /// Load average over one minute at the end; that of the start is in `host`.
    pub load_end: Option<f64>,
    /// Processors that other processes kept busy, on average; null for runs of less than a second.
    pub other_load: Option<f64>,
    /// Share of the time of all processors that the host of a virtual machine gave to others; null
    /// for runs of less than a second.
    pub stolen: Option<f64>,
    /// Swap space in use at the end, in bytes.
    pub swap_used_bytes: Option<u64>,
    /// Pages that the whole system moved to and from swap space meanwhile.
    pub swapped_pages: Option<u64>,
    /// How many times a processor slowed itself down because it was too hot.
    pub thermal_throttles: Option<u64>,
    /// How many times the control group had used up its share of the processors.
    pub cgroup_throttles: Option<u64>,
    /// Seconds that its tasks waited for that reason.
    pub cgroup_throttled_seconds: Option<f64>,
    /// What of this makes the times doubtful, in words.
    pub warnings: Vec<String>,
}

impl Conditions {
    /// What happened between two looks at the system.
    pub fn between(start: &Snapshot, end: &Snapshot) -> Self {
        let times = end.times_since(start);
        let grown = |of: fn(&Snapshot) -> Option<u64>| Some(of(end)?.saturating_sub(of(start)?));
        let mut conditions = Self {
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
        conditions.warnings = conditions.doubts();
        conditions
    }

    /// The conditions of several runs together: the worst of each.
    pub fn worst(runs: impl IntoIterator<Item = Self>) -> Option<Self> {
        runs.into_iter().reduce(|a, b| {
            let mut warnings = a.warnings;
            for warning in b.warnings {
                if !warnings.contains(&warning) {
                    warnings.push(warning);
                }
            }
            let more = |a: Option<f64>, b: Option<f64>| a.into_iter().chain(b).reduce(f64::max);
            Self {
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
                cgroup_throttled_seconds: more(
                    a.cgroup_throttled_seconds,
                    b.cgroup_throttled_seconds,
                ),
                warnings,
            }
        })
    }

    /// What makes times doubtful.
    fn doubts(&self) -> Vec<String> {
        let mut doubts = Vec::new();
        if let Some(busy) = self.other_load.filter(|busy| *busy > OTHER_LOAD_LIMIT) {
            doubts.push(format!("other programs kept {busy:.1} processors busy"));
        }
        if let Some(stolen) = self.stolen.filter(|stolen| *stolen > STOLEN_LIMIT) {
            doubts.push(format!(
                "the host of this virtual machine took {:.0} % of its time away",
                100.0 * stolen
            ));
        }
        let governors = self.governors.iter().flatten();
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
        if let (Some(start), Some(end)) = (self.frequency_start, self.frequency_end)
            && (end as f64) < FREQUENCY_LIMIT * start as f64
        {
            doubts.push(format!(
                "the processors slowed down from {:.2} to {:.2} GHz",
                start as f64 / 1e9,
                end as f64 / 1e9
            ));
        }
        let happened = |count: Option<u64>| count.filter(|count| *count > 0);
        if let Some(pages) = happened(self.swapped_pages) {
            doubts.push(format!("the system swapped {pages} pages"));
        }
        if let Some(times) = happened(self.thermal_throttles) {
            doubts.push(format!(
                "processors were too hot and slowed down {times} times"
            ));
        }
        if let Some(times) = happened(self.cgroup_throttles) {
            doubts.push(format!(
                "the control group ran out of its share of the processors {times} times"
            ));
        }
        doubts
    }
}
