//! What an outside program says on its standard output: one JSON object in each line.

use geobench_window::Counters;
use serde::Deserialize;

use crate::exec::Observation;
use crate::exec::wire;
use crate::measure::memory::Peaks;

/// A line of an outside program. Every field may be missing or null; one that is misspelt is not
/// understood, so that nobody waits for figures that never come.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Line {
    /// The model is loaded.
    pub(super) ready: bool,
    /// Seconds that the solve took.
    pub(super) seconds: Option<f64>,
    /// Seconds of what came before it and depends on the mesh alone, if that was part of this run.
    pub(super) setup_seconds: Option<f64>,
    /// What it counted, by the names of result files.
    #[serde(with = "wire::counters")]
    pub(super) counters: Option<Counters>,
    /// Most memory that the process occupied during the solve.
    pub(super) rss_peak_bytes: Option<u64>,
    /// Most bytes on its heap during the solve, without the mesh.
    pub(super) heap_peak_bytes: Option<u64>,
    /// The model or the source is none that it can work on, and why.
    pub(super) refused: Option<String>,
}

impl Line {
    /// The line, if it is one.
    pub(super) fn parse(line: &[u8]) -> Option<Self> {
        let line: Self = serde_json::from_slice(line).ok()?;
        let sound = |seconds: Option<f64>| seconds.is_none_or(|s| s.is_finite() && s >= 0.0);
        (sound(line.seconds) && sound(line.setup_seconds)).then_some(line)
    }

    /// What the run delivered, with the distances that it wrote.
    pub(super) fn observation(self, distances: Vec<f64>) -> Observation {
        Observation {
            distances,
            seconds: self.seconds,
            setup_seconds: self.setup_seconds,
            counters: self.counters,
            wavefront: Vec::new(),
            peaks: Peaks {
                heap: self.heap_peak_bytes,
                rss: self.rss_peak_bytes,
            },
            phases: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use geobench_window::Counter;

    use super::*;

    #[test]
    fn a_line_is_understood_whole_or_not_at_all() {
        let line = Line::parse(br#"{"seconds": 0.5, "counters": {"propagated": 7}}"#).unwrap();
        assert_eq!(line.seconds, Some(0.5));
        let counters = line.counters.unwrap();
        assert_eq!(counters.get(Counter::Propagated), Some(7));
        assert_eq!(counters.get(Counter::Kept), None);
        assert!(Line::parse(br#"{"ready": true}"#).unwrap().ready);
        for garbage in [
            "mesh has 4 vertices",
            r#"{"second": 0.5}"#,
            r#"{"seconds": -1}"#,
            r#"{"seconds": "fast"}"#,
            "{",
        ] {
            assert_eq!(Line::parse(garbage.as_bytes()), None, "{garbage}");
        }
    }
}
