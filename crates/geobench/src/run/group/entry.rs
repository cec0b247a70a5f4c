//! One cell on its way.

use std::collections::BTreeMap;

use geobench_window::Counter;

use crate::exec::{Failure, Purpose};
use crate::measure::memory::Peaks;
use crate::plan::Plan;
use crate::registry::Selection;
use crate::run::agreement;
use crate::run::ledger::{Finding, RunId};
use crate::schema::{Cell, Check, Memory, Status, Time};

/// What is known of a cell: what came of each of its runs.
#[derive(Debug)]
pub(super) struct Entry<'p> {
    pub(super) algorithm: &'p Selection,
    findings: BTreeMap<(Purpose, usize), Finding>,
    /// Why it fails, if it does; no run is made any more then.
    failure: Option<Failure>,
    /// Runs that were made now, and not before the benchmark was interrupted.
    pub(super) made: usize,
}

impl<'p> Entry<'p> {
    pub(super) const fn new(algorithm: &'p Selection) -> Self {
        Self {
            algorithm,
            findings: BTreeMap::new(),
            failure: None,
            made: 0,
        }
    }

    pub(super) const fn has_failed(&self) -> bool {
        self.failure.is_some()
    }

    /// Whether a run is still to be made. Warm-ups are made again where there is something left to
    /// be timed.
    pub(super) fn lacks(&self, plan: &Plan, purpose: Purpose, round: usize) -> bool {
        !self.has_failed()
            && match purpose {
                Purpose::WarmUp => (0..plan.repeat).any(|r| self.lacks(plan, Purpose::Time, r)),
                _ => !self.findings.contains_key(&(purpose, round)),
            }
    }

    /// Whether there is nothing left to be done.
    pub(super) fn is_complete(&self, plan: &Plan) -> bool {
        self.has_failed()
            || (0..plan.repeat).all(|round| !self.lacks(plan, Purpose::Time, round))
                && !self.lacks(plan, Purpose::Count, 0)
                && !self.lacks(plan, Purpose::Clock, 0)
    }

    /// The cluster of an answer that differed from the reference, if one did.
    pub(super) fn odd_cluster(&self) -> Option<u32> {
        let clusters = self
            .findings
            .values()
            .filter_map(|found| found.check.cluster);
        clusters
            .max()
            .filter(|&cluster| cluster != agreement::REFERENCE)
    }

    /// What came of the runs that are known, in short.
    pub(super) fn outcomes(&self) -> impl Iterator<Item = (Purpose, Result<Option<f64>, Status>)> {
        let findings = self.findings.iter();
        findings.map(|(&(purpose, _), finding)| (purpose, outcome(finding)))
    }

    /// Takes in what came of a run.
    pub(super) fn add(&mut self, purpose: Purpose, round: usize, finding: Finding) {
        self.failure = self.failure.take().or_else(|| finding.failure.clone());
        // The first of several warm-ups of one number is the one that set the algorithm up.
        self.findings.entry((purpose, round)).or_insert(finding);
    }

    /// The cell, in which the runs had these places in their rounds; with the wavefronts of its run only
    /// if so wanted.
    pub(super) fn finish(self, run: RunId, places: Vec<usize>, with_wavefront: bool) -> Cell {
        let mut cell = Cell {
            group: run.group,
            source: Some(run.source),
            check: self.check(),
            threads: self.algorithm.threads(),
            ..Cell::new(&run.model, &run.algorithm)
        };
        if let Some(failure) = self.failure {
            cell.status = failure.status;
            cell.message = Some(failure.message);
            return cell;
        }
        if self.algorithm.is_approximate() {
            cell.message = Some("approximate: compared, but not held to the tolerance".to_owned());
        }
        let (mut samples, mut setup) = (Vec::new(), None);
        for ((purpose, _), finding) in self.findings {
            let observation = finding.observation;
            if let Some(why) = finding.unchecked {
                cell.message = Some(format!("not checked: {why}"));
            }
            // The set-up of the counted run is apart from those of the timed ones.
            setup = setup.or(observation.setup_seconds);
            match purpose {
                Purpose::WarmUp => {}
                Purpose::Time => samples.extend(observation.seconds),
                Purpose::Count => {
                    cell.counters = observation.counters.unwrap_or_default();
                    if with_wavefront {
                        cell.wavefront = observation.wavefront;
                    }
                }
                Purpose::Clock => cell.phases = observation.phases.unwrap_or_default(),
            }
            if matches!(purpose, Purpose::Clock | Purpose::Count) {
                // Ours are measured in the clocked run; those of outside programs come with what they count.
                let Peaks { heap, rss } = observation.peaks;
                cell.memory.heap_peak_bytes = cell.memory.heap_peak_bytes.or(heap);
                cell.memory.rss_peak_bytes = cell.memory.rss_peak_bytes.or(rss);
            }
        }
        cell.time = Time {
            places,
            ..crate::measure::statistics::time(samples, setup)
        };
        let count = |counter| cell.counters.get(counter);
        cell.memory = Memory {
            papers_bytes: count(self.algorithm.algorithm().memory_counter)
                .map(|windows| windows * PAPERS_WINDOW_BYTES),
            windows_peak_bytes: count(Counter::PeakWindows)
                .zip(count(Counter::WindowBytes))
                .map(|(windows, bytes)| windows * bytes),
            ..cell.memory
        };
        cell
    }

    /// The comparison that came out worst. A cell is checked if all its runs were.
    fn check(&self) -> Check {
        let findings = || self.findings.values();
        let badness = |check: &Check| match check.reference {
            Some(_) => check.max_rel.unwrap_or(f64::INFINITY),
            None => -1.0,
        };
        let worst = findings()
            .map(|finding| &finding.check)
            .max_by(|a, b| badness(a).total_cmp(&badness(b)));
        let unreachable = findings()
            .rev()
            .find_map(|finding| finding.check.unreachable);
        if findings().any(|finding| finding.unchecked.is_some()) {
            return Check {
                unreachable,
                cluster: worst.and_then(|check| check.cluster),
                ..Check::default()
            };
        }
        Check {
            unreachable,
            ..worst.cloned().unwrap_or_default()
        }
    }
}

/// What came of a run, in short: how it failed, or the seconds that it took if it was timed.
pub(super) fn outcome(finding: &Finding) -> Result<Option<f64>, Status> {
    match &finding.failure {
        Some(failure) => Err(failure.status),
        None => Ok(finding.observation.seconds),
    }
}

/// Bytes that the papers charge for each window.
const PAPERS_WINDOW_BYTES: u64 = 80;
