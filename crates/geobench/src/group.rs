//! The cells of one model and one source.

use std::path::Path;

use geobench_mesh::VertexId;
use geobench_window::{Counter, Counters};

use crate::check::{self, Comparison};
use crate::memory::Peaks;
use crate::plan::{Plan, Reference};
use crate::record::{Cell, Memory, ModelRecord, Phases, Status, Time};
use crate::registry::Selection;
use crate::runner::{Executor, Failure, Listener, Observation, Purpose, Step};

/// The cells of one model and one source, whose runs are interleaved so that a drifting machine
/// hurts all algorithms alike.
pub(crate) struct Group<'p> {
    plan: &'p Plan,
    model: &'p ModelRecord,
    source: VertexId,
    /// One for each algorithm.
    entries: Vec<Entry<'p>>,
    expected: Option<Answer>,
    /// Why there is no expected answer although one is wanted.
    unchecked: Option<String>,
}

/// One cell on its way.
struct Entry<'p> {
    algorithm: &'p Selection,
    samples: Vec<f64>,
    setup: Option<f64>,
    counters: Option<Counters>,
    peaks: Peaks,
    phases: Phases,
    /// The comparison that came out worst.
    comparison: Option<Comparison>,
    unreachable: Option<usize>,
    failure: Option<Failure>,
    runs: usize,
}

/// What answers are compared with, and its name.
struct Answer {
    name: String,
    distances: Vec<(usize, f64)>,
    vertices: usize,
}

impl<'p> Group<'p> {
    /// The cells of `plan` in `model` from `source`.
    pub(crate) fn new(plan: &'p Plan, model: &'p ModelRecord, source: VertexId) -> Self {
        let entries = plan
            .algorithms
            .iter()
            .map(|algorithm| Entry {
                algorithm,
                samples: Vec::new(),
                setup: None,
                counters: None,
                peaks: Peaks::default(),
                phases: Phases::default(),
                comparison: None,
                unreachable: None,
                failure: None,
                runs: 0,
            })
            .collect();
        Self {
            plan,
            model,
            source,
            entries,
            expected: None,
            unchecked: None,
        }
    }

    /// Carries out every run of these cells.
    pub(crate) fn run(
        mut self,
        executor: &mut dyn Executor,
        listener: &mut dyn Listener,
    ) -> Vec<Cell> {
        let warmed = self.find_reference(executor, listener);
        for round in 0..self.plan.warmup {
            for entry in 0..self.entries.len() {
                // The reference has had its first warm-up.
                if round > 0 || warmed != Some(entry) {
                    self.step(entry, Purpose::WarmUp, executor, listener);
                }
            }
        }
        for _ in 0..self.plan.repeat {
            for entry in 0..self.entries.len() {
                self.step(entry, Purpose::Time, executor, listener);
            }
        }
        for purpose in [Purpose::Count, Purpose::Clock] {
            for entry in 0..self.entries.len() {
                self.step(entry, purpose, executor, listener);
            }
        }
        let skipped: usize = self
            .entries
            .iter()
            .map(|e| self.plan.runs_per_cell().saturating_sub(e.runs))
            .sum();
        listener.skipped(skipped);
        let Self {
            plan,
            model,
            source,
            entries,
            expected,
            unchecked,
        } = self;
        let reference = expected.map(|answer| answer.name);
        entries
            .into_iter()
            .map(|entry| {
                entry.finish(
                    plan,
                    model,
                    source,
                    reference.as_deref(),
                    unchecked.as_deref(),
                )
            })
            .collect()
    }

    /// Finds the answer that all others must agree with. If this takes a run of an algorithm that
    /// is measured too, the place of that one is returned: the run counts as its warm-up.
    fn find_reference(
        &mut self,
        executor: &mut dyn Executor,
        listener: &mut dyn Listener,
    ) -> Option<usize> {
        match &self.plan.reference {
            Reference::None => None,
            Reference::Files(files) => {
                let vertices = self.model.vertices.unwrap_or(0) as usize;
                match files.find(Path::new(&self.model.path), self.source.raw(), vertices) {
                    Ok(field) => {
                        self.expected = Some(Answer {
                            name: field.path.display().to_string(),
                            distances: field.distances,
                            vertices,
                        });
                    }
                    Err(error) => self.unchecked = Some(error.to_string()),
                }
                None
            }
            Reference::Algorithm(reference) => {
                let place = self
                    .entries
                    .iter()
                    .position(|e| e.algorithm.label() == reference.label());
                let step = Step {
                    model: &self.model.name,
                    algorithm: reference,
                    source: self.source,
                    purpose: Purpose::WarmUp,
                };
                listener.step(&step);
                match executor.execute(&step) {
                    Ok(observation) => {
                        self.expected = Some(Answer {
                            name: reference.label().to_owned(),
                            vertices: observation.distances.len(),
                            distances: observation.distances.iter().copied().enumerate().collect(),
                        });
                        if let Some(place) = place {
                            self.observe(place, Purpose::WarmUp, observation);
                        }
                    }
                    Err(failure) => {
                        self.unchecked = Some(format!(
                            "the reference {} failed: {}",
                            reference.label(),
                            failure.message
                        ));
                        if let Some(place) = place {
                            self.entries[place].failure = Some(failure);
                        }
                    }
                }
                place
            }
        }
    }

    fn step(
        &mut self,
        place: usize,
        purpose: Purpose,
        executor: &mut dyn Executor,
        listener: &mut dyn Listener,
    ) {
        let entry = &self.entries[place];
        if entry.failure.is_some() {
            return;
        }
        let step = Step {
            model: &self.model.name,
            algorithm: entry.algorithm,
            source: self.source,
            purpose,
        };
        listener.step(&step);
        match executor.execute(&step) {
            Ok(observation) => self.observe(place, purpose, observation),
            Err(failure) => self.entries[place].failure = Some(failure),
        }
    }

    /// Checks what a run delivered and adds it to its cell.
    fn observe(&mut self, place: usize, purpose: Purpose, observation: Observation) {
        let entry = &mut self.entries[place];
        entry.runs += 1;
        if let Some(failure) = entry.check(
            &observation.distances,
            self.expected.as_ref(),
            self.plan.tolerance,
        ) {
            entry.failure = Some(failure);
            return;
        }
        // The set-up of the counted run is apart from those of the timed ones.
        entry.setup = entry.setup.or(observation.setup_seconds);
        match purpose {
            Purpose::WarmUp => {}
            Purpose::Time => entry.samples.extend(observation.seconds),
            Purpose::Count => {
                entry.counters = observation.counters;
                entry.peaks = observation.peaks;
            }
            Purpose::Clock => entry.phases = observation.phases.unwrap_or_default(),
        }
    }
}

impl Entry<'_> {
    /// Compares an answer with the expected one and keeps the worst comparison; returns why the
    /// cell fails, if it does.
    fn check(
        &mut self,
        distances: &[f64],
        expected: Option<&Answer>,
        tolerance: f64,
    ) -> Option<Failure> {
        let wrong = |message: String| {
            Some(Failure {
                status: Status::Wrong,
                message,
            })
        };
        let comparison = match expected {
            Some(answer) if answer.vertices != distances.len() => {
                return wrong(
                    check::LengthMismatch {
                        found: distances.len(),
                        expected: answer.vertices,
                    }
                    .to_string(),
                );
            }
            Some(answer) => {
                check::compare_some(distances, answer.distances.iter().copied(), tolerance)
            }
            // Nothing to compare with; a distance that is not a number is wrong all the same.
            None => check::compare_some(
                distances,
                distances
                    .iter()
                    .copied()
                    .enumerate()
                    .filter(|(_, d)| d.is_nan()),
                tolerance,
            ),
        };
        self.unreachable = Some(comparison.unreachable);
        let failure = comparison.worst.filter(|_| !comparison.agrees()).map(|worst| {
            let name = expected.map_or("no reference", |answer| answer.name.as_str());
            format!(
                "differs from {name}: {worst}; {} of {} vertices differ by more than {tolerance:e} relative",
                comparison.disagreeing, comparison.compared
            )
        });
        if self
            .comparison
            .as_ref()
            .is_none_or(|c| comparison.max_rel >= c.max_rel)
        {
            self.comparison = Some(comparison);
        }
        failure.and_then(wrong)
    }

    fn finish(
        self,
        plan: &Plan,
        model: &ModelRecord,
        source: VertexId,
        reference: Option<&str>,
        unchecked: Option<&str>,
    ) -> Cell {
        let mut cell = Cell {
            group: plan.group.name.clone(),
            source: Some(source.raw()),
            ..Cell::new(&model.name, self.algorithm.label())
        };
        if let (Some(reference), Some(comparison)) = (reference, &self.comparison) {
            let finite = |x: f64| x.is_finite().then_some(x);
            cell.check.reference = Some(reference.to_owned());
            cell.check.max_abs = finite(comparison.max_abs);
            cell.check.max_rel = finite(comparison.max_rel);
        }
        cell.check.unreachable = self.unreachable.map(|n| n as u64);
        if let Some(failure) = self.failure {
            cell.status = failure.status;
            cell.message = Some(failure.message);
            return cell;
        }
        cell.message = unchecked.map(|why| format!("not checked: {why}"));
        cell.time = Time::of(self.samples, self.setup);
        cell.phases = self.phases;
        let counters = self.counters.unwrap_or_default();
        let count = |counter| counters.get(counter);
        cell.memory = Memory {
            papers_bytes: count(self.algorithm.algorithm().memory_counter)
                .map(|windows| windows * PAPERS_WINDOW_BYTES),
            windows_peak_bytes: count(Counter::PeakWindows)
                .zip(count(Counter::WindowBytes))
                .map(|(windows, bytes)| windows * bytes),
            heap_peak_bytes: self.peaks.heap,
            rss_peak_bytes: self.peaks.rss,
        };
        cell.counters = counters;
        cell
    }
}

/// Bytes that the papers charge for each window.
const PAPERS_WINDOW_BYTES: u64 = 80;
