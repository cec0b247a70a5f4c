//! The runs of one cell, and its record.

use std::collections::BTreeMap;
use std::sync::Arc;

use geobench_registry::{Program, Protocol, Selection};
use geobench_window::Counter;

use crate::exec::{Failure, Pass};
use crate::measure::memory::Peaks;
use crate::measure::statistics::{self, time_of_program};
use crate::plan::Plan;
use crate::plan::sampling::Sampling;
use crate::run::agreement;
use crate::run::earlier::NOT_CHECKED;
use crate::run::journal::{RunId, RunOutcome};
use crate::run::proof::{RevisedGroup, is_proof};
use crate::schema::{Cell, Check, Memory, Status, Time};

/// The outcomes of the runs of a cell.
#[derive(Debug)]
pub(super) struct CellRuns<'p> {
    /// Index of its algorithm in the plan.
    pub(super) index: usize,
    pub(super) algorithm: &'p Selection,
    outcomes: BTreeMap<(Pass, usize), RunOutcome>,
    /// First failure of a run, which fails the cell. No further runs are executed.
    failure: Option<Failure>,
    /// Number of runs executed by this process.
    pub(super) made: usize,
    sampling: Sampling,
    /// Whether it has a profiled and a counted run.
    counts: bool,
    /// Whether there are enough timed runs.
    has_time: bool,
    /// The same cell of the earlier file, if that has it.
    pub(super) earlier: Option<Cell>,
}

impl<'p> CellRuns<'p> {
    pub(super) const fn new(index: usize, algorithm: &'p Selection, plan: &Plan) -> Self {
        Self {
            index,
            algorithm,
            outcomes: BTreeMap::new(),
            failure: None,
            made: 0,
            sampling: plan.sampling,
            counts: plan.counts,
            has_time: false,
            earlier: None,
        }
    }

    const fn has_failed(&self) -> bool {
        self.failure.is_some()
    }

    /// Whether a run is missing. Every warm-up counts as missing while timed runs are missing,
    /// because each process repeats it.
    pub(super) fn lacks(&self, pass: Pass, round: usize) -> bool {
        let is_wanted = match pass {
            Pass::Warmup => return self.wants_time(),
            Pass::Time => self.wants_time(),
            Pass::Count | Pass::Profile => self.counts && !self.has_failed(),
        };
        is_wanted && !self.outcomes.contains_key(&(pass, round))
    }

    /// Whether timed runs are missing.
    pub(super) const fn wants_time(&self) -> bool {
        !self.has_failed() && !self.has_time
    }

    /// Whether all runs are done.
    pub(super) fn is_complete(&self) -> bool {
        !self.wants_time() && !self.lacks(Pass::Count, 0) && !self.lacks(Pass::Profile, 0)
    }

    /// The outcomes of the timed runs, in their order.
    pub(super) fn timed(&self) -> impl Iterator<Item = &RunOutcome> {
        let runs = self
            .outcomes
            .range((Pass::Time, 0)..=(Pass::Time, usize::MAX));
        runs.map(|(_, outcome)| outcome)
    }

    /// Decides whether the timed runs so far are enough.
    pub(super) fn count_samples(&mut self) {
        let observations = || self.timed().map(|found| &found.observation);
        let spent = observations().filter_map(|one| {
            let solves = one.solves.unwrap_or(1) as f64;
            one.outside_seconds.or(Some(one.seconds? * solves))
        });
        let spent = spent.sum();
        let seconds = observations().filter_map(|one| one.seconds).collect();
        let samples = if self.algorithm.program().is_some() {
            let outside = observations().filter_map(|one| one.outside_seconds);
            let ping = observations().filter_map(|one| one.ping_seconds);
            time_of_program(seconds, outside.collect(), ping.collect(), None).samples
        } else {
            seconds
        };
        self.has_time = self.sampling.is_enough(&samples, spent);
    }

    /// Number of solves of a timed run, from the time of the first run. External programs solve
    /// once.
    pub(super) fn solves(&self) -> usize {
        if self.algorithm.program().is_some() {
            return 1;
        }
        let mut known = self.outcomes.values();
        let first = known.find_map(|outcome| outcome.observation.seconds);
        self.sampling.solves(first)
    }

    /// The cluster of a run whose answer differed from the reference, if one did.
    pub(super) fn odd_cluster(&self) -> Option<u32> {
        let clusters = self
            .outcomes
            .values()
            .filter_map(|found| found.check.cluster);
        clusters
            .max()
            .filter(|&cluster| cluster != agreement::REFERENCE)
    }

    /// Passes and short outcomes of the known runs.
    pub(super) fn summaries(&self) -> impl Iterator<Item = (Pass, Result<Option<f64>, Status>)> {
        let outcomes = self.outcomes.iter();
        outcomes.map(|(&(pass, _), outcome)| (pass, summary(outcome)))
    }

    /// Puts comparisons with proven distances in the place of those with a reference that a proof
    /// has refuted.
    pub(super) fn revise(&mut self, groups: &[RevisedGroup]) {
        for outcome in self.outcomes.values_mut() {
            let known = &outcome.check;
            let is_new = known.reference.as_deref().is_some_and(is_proof);
            let group = groups
                .iter()
                .find(|group| known.cluster == Some(group.before));
            let Some(group) = group.filter(|_| !is_new) else {
                continue;
            };
            outcome.check = Check {
                unreachable: known.unreachable,
                doubt: known.doubt,
                wrong_labels: known.wrong_labels,
                ..group.check.clone()
            };
            outcome.unchecked = None;
            let failure = outcome.failure.take();
            outcome.failure = failure.or_else(|| group.failure.clone());
            self.failure = self.failure.take().or_else(|| outcome.failure.clone());
        }
    }

    /// Adds the outcome of a run.
    pub(super) fn add(&mut self, pass: Pass, round: usize, outcome: RunOutcome) {
        self.failure = self.failure.take().or_else(|| outcome.failure.clone());
        // Of repeated warm-ups the first counts, because it included the set-up.
        self.outcomes.entry((pass, round)).or_insert(outcome);
    }

    /// The record of the cell. `places` are the positions of its timed runs in their rounds. If the
    /// earlier file has the cell with all these samples, returns that one unchanged.
    pub(super) fn finish(self, run: RunId, places: Vec<usize>, with_wavefront: bool) -> Cell {
        let all = self.timed().count();
        // A failure counts, also if the earlier runs ended well.
        let is_same = |earlier: &&Cell| {
            let fails_anew = self.failure.is_some() && earlier.status == Status::Ok;
            earlier.time.samples.len() >= all && !fails_anew
        };
        if let Some(same) = self.earlier.as_ref().filter(is_same) {
            return same.clone();
        }
        let mut cell = Cell {
            group: run.group,
            source: Some(run.source),
            check: self.check(),
            threads: self.algorithm.threads(),
            approximate: self.algorithm.is_approximate(),
            simd: self.algorithm.simd(),
            ..Cell::new(&run.model, &run.algorithm)
        };
        if let Some(earlier) = &self.earlier {
            cell.instructions = earlier.instructions;
            cell.instructions_simd
                .clone_from(&earlier.instructions_simd);
        }
        if let Some(failure) = self.failure {
            cell.status = failure.status;
            cell.message = Some(failure.message);
            return cell;
        }
        if self.algorithm.is_approximate() {
            cell.message = Some(match self.algorithm.error_bound() {
                Some(bound) => {
                    format!("approximate: held to its proven relative error of at most {bound}")
                }
                None => "approximate: compared, but not held to the tolerance".to_owned(),
            });
        }
        let (mut samples, mut solves, mut setup) = (Vec::new(), Vec::new(), None);
        let mut extraction = None;
        let (mut outside, mut ping) = (Vec::new(), Vec::new());
        for ((pass, _), outcome) in self.outcomes {
            let observation = outcome.observation;
            cell.message = cell.message.or(observation.note);
            if let Some(why) = outcome.unchecked {
                cell.message = Some(format!("{NOT_CHECKED}{why}"));
            }
            // Only the first set-up counts: it is that of the timed solver.
            setup = setup.or(observation.setup_seconds);
            extraction = extraction.or(observation.extraction_seconds);
            match pass {
                Pass::Warmup => {}
                Pass::Time => {
                    samples.extend(observation.seconds);
                    solves.push(observation.solves.unwrap_or(1));
                    outside.extend(observation.outside_seconds);
                    ping.extend(observation.ping_seconds);
                }
                Pass::Count => {
                    cell.check.edge_excess = observation.edge_excess;
                    cell.counters = observation.counters.unwrap_or_default();
                    if with_wavefront {
                        cell.wavefront = observation.wavefront;
                    }
                }
                Pass::Profile => cell.phases = observation.phases.unwrap_or_default(),
            }
            if matches!(pass, Pass::Profile | Pass::Count) {
                // Peaks of our algorithms are measured in the profiled run. External programs
                // report them with the counts.
                let Peaks { heap, rss } = observation.peaks;
                cell.memory.heap_peak_bytes = cell.memory.heap_peak_bytes.or(heap);
                cell.memory.rss_peak_bytes = cell.memory.rss_peak_bytes.or(rss);
            }
        }
        if solves.iter().all(|&solves| solves == 1) {
            solves.clear();
        }
        // Only a program with a protocol reports its own times; a command does not.
        let speaks = |program: &Arc<Program>| program.protocol != Protocol::Command;
        let time = if self.algorithm.program().is_some_and(speaks) {
            time_of_program(samples, outside, ping, setup)
        } else {
            Time {
                outside,
                ..statistics::time(samples, setup)
            }
        };
        cell.time = Time {
            extraction,
            places,
            solves,
            precision: self.sampling.precision().map(|wanted| wanted.relative),
            ..time
        };
        cell.phases = cell.phases.of_time(cell.time.median);
        let count = |counter| cell.counters.get(counter);
        cell.memory = Memory {
            papers_bytes: count(self.algorithm.algorithm().memory_counter)
                .and_then(|windows| windows.checked_mul(PAPERS_WINDOW_BYTES)),
            windows_peak_bytes: count(Counter::PeakWindows)
                .zip(count(Counter::WindowBytes))
                .and_then(|(windows, bytes)| windows.checked_mul(bytes)),
            ..cell.memory
        };
        cell
    }

    /// The comparison with the largest relative difference. A cell counts as checked only if all
    /// its runs were checked.
    fn check(&self) -> Check {
        let outcomes = || self.outcomes.values();
        // A run without a comparison ranks below all others.
        let badness = |check: &Check| match check.reference {
            Some(_) => check.max_rel.unwrap_or(f64::INFINITY),
            None => -1.0,
        };
        // Proven distances take the place of a refuted reference.
        let is_proven = |check: &&Check| check.reference.as_deref().is_some_and(is_proof);
        let checks = || outcomes().map(|outcome| &outcome.check);
        let with_proof = checks().any(|check| is_proven(&check));
        let worst = checks()
            .filter(|check| !with_proof || is_proven(check))
            .max_by(|a, b| badness(a).total_cmp(&badness(b)));
        let unreachable = outcomes()
            .rev()
            .find_map(|outcome| outcome.check.unreachable);
        let doubts = outcomes().filter_map(|outcome| outcome.check.doubt);
        let doubt = doubts.reduce(f64::max);
        let wrong_labels = outcomes().filter_map(|outcome| outcome.check.wrong_labels);
        let wrong_labels = wrong_labels.max();
        if outcomes().any(|outcome| outcome.unchecked.is_some()) {
            return Check {
                unreachable,
                doubt,
                wrong_labels,
                cluster: worst.and_then(|check| check.cluster),
                ..Check::default()
            };
        }
        Check {
            unreachable,
            doubt,
            wrong_labels,
            ..worst.cloned().unwrap_or_default()
        }
    }
}

/// A short outcome: the status of a failure, or the seconds of the solve, if measured.
pub(super) fn summary(outcome: &RunOutcome) -> Result<Option<f64>, Status> {
    match &outcome.failure {
        Some(failure) => Err(failure.status),
        None => Ok(outcome.observation.seconds),
    }
}

/// Bytes per window that the papers assume in their memory figures.
const PAPERS_WINDOW_BYTES: u64 = 80;
