//! The cells of one model and one source.

use std::collections::BTreeMap;
use std::path::Path;
use std::slice;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use geobench_mesh::SplitMix64;
use geobench_window::{Counter, precision};

use crate::exec::model::ModelRef;
use crate::exec::source::SourceSpec;
use crate::exec::{Backend, Failure, Observation, Pass, Refusal, Session, Step};
use crate::measure::memory::Peaks;
use crate::plan::sampling::Sampling;
use crate::plan::{Plan, Reference};
use crate::registry::{ProcessLifetime, Program, Selection};
use crate::run::agreement;
use crate::run::each;
use crate::run::earlier::{self, Earlier, NOT_CHECKED};
use crate::run::journal::{Journal, JournalLine, RunId, RunOutcome};
use crate::run::labels::NearestSources;
use crate::run::log::RunLog;
use crate::run::reference_check::{Answer, ReferenceCheck};
use crate::schema::{Cell, Check, Memory, ModelRecord, SourceLabel, Status, Time};

/// The cells of one model and source. Unless several run at the same time, their runs are
/// interleaved, so that drift of the machine affects all algorithms alike.
pub(crate) struct Unit<'p> {
    plan: UnitPlan<'p>,
    /// One for each algorithm.
    cells: Vec<CellRuns<'p>>,
}

/// What the cells of a unit have in common.
struct UnitPlan<'p> {
    plan: &'p Plan,
    model: &'p ModelRecord,
    /// The source, or several together.
    source: SourceSpec,
    order: RunOrder,
    is_interleaved: bool,
}

/// The runs that are done.
#[derive(Clone, Copy, Default)]
pub(crate) struct Past<'p> {
    pub(crate) journal: Option<&'p Journal>,
    pub(crate) earlier: Option<&'p Earlier>,
}

impl<'p> Past<'p> {
    /// The record of a model, and its hash if it is of an earlier file.
    pub(crate) fn model(self, name: &str) -> Option<(&'p ModelRecord, Option<String>)> {
        if let Some(model) = self.journal.and_then(|journal| journal.model(name)) {
            return Some((model, None));
        }
        let model = self.earlier?.model(name)?;
        Some((model, model.sha256.clone()))
    }
}

impl<'p> Unit<'p> {
    /// The cells of `plan` in `model` from `source`, with the runs in `past`.
    pub(crate) fn new(
        plan: &'p Plan,
        model: &'p ModelRecord,
        source: SourceSpec,
        past: Past<'_>,
        is_interleaved: bool,
    ) -> Self {
        let algorithms = &plan.algorithms;
        let cells = algorithms.iter().enumerate();
        let mut unit = Self {
            plan: UnitPlan {
                plan,
                model,
                order: RunOrder::new(plan.seed, &model.name, &source.label(), algorithms.len()),
                source,
                is_interleaved,
            },
            cells: cells
                .map(|(place, algorithm)| CellRuns::new(place, algorithm, plan.sampling))
                .collect(),
        };
        // The reference has one warm-up even if the plan has none.
        let warmups = (0..plan.warmup.max(1)).map(|round| (Pass::Warmup, round));
        let times = (0..plan.sampling.most()).map(|round| (Pass::Time, round));
        let last = [(Pass::Profile, 0), (Pass::Count, 0)];
        for (pass, round) in warmups.chain(times).chain(last) {
            for (place, algorithm) in algorithms.iter().enumerate() {
                let run = unit.plan.run_id(algorithm, pass, round);
                let cell = &mut unit.cells[place];
                if pass == Pass::Warmup && round == 0 {
                    let earlier = past.earlier;
                    cell.earlier = earlier.and_then(|e| e.cell(&run, algorithm.threads()).cloned());
                }
                let journal = past.journal.and_then(|journal| journal.outcome(&run));
                let earlier = || earlier::outcome(cell.earlier.as_ref()?, pass, round);
                if let Some(outcome) = journal.cloned().or_else(earlier) {
                    cell.add(pass, round, outcome);
                }
            }
        }
        for cell in &mut unit.cells {
            cell.count_samples();
        }
        unit
    }

    /// Whether all runs are done.
    pub(crate) fn is_complete(&self) -> bool {
        self.cells.iter().all(CellRuns::is_complete)
    }

    /// Carries out the runs that are missing, those of all cells interleaved.
    ///
    /// # Errors
    ///
    /// When the journal cannot be written.
    pub(crate) fn run(
        &mut self,
        session: &mut dyn Session,
        log: &RunLog<'_>,
    ) -> anyhow::Result<()> {
        self.begin(log);
        if !self.is_complete() {
            let checks = Checks::default();
            let mut context = RunContext {
                session,
                log,
                checks: &checks,
            };
            let done = self
                .plan
                .prepare(&mut self.cells, &mut context)
                .and_then(|warmed| self.plan.make_runs(&mut self.cells, warmed, &mut context));
            stopped_or(done)?;
        }
        self.end(log);
        Ok(())
    }

    /// Carries out the runs that are missing. As many cells run at the same time as this pool has
    /// threads, each in a session of its own; the reference comes before them. One cell has
    /// `first`, a session of the model that has made no run, if there is one.
    ///
    /// # Errors
    ///
    /// When the journal cannot be written.
    pub(crate) fn run_cells<'s>(
        &mut self,
        first: Option<Box<dyn Session + 's>>,
        backend: &'s dyn Backend,
        model: &'s ModelRef,
        log: &RunLog<'_>,
    ) -> anyhow::Result<()> {
        self.begin(log);
        if !self.is_complete() {
            stopped_or(self.plan.make_runs_of_cells(
                &mut self.cells,
                first,
                &|| backend.open_further(model, self.plan.model),
                log,
            ))?;
        }
        self.end(log);
        Ok(())
    }

    /// Tells the listener of the runs that are known.
    fn begin(&self, log: &RunLog<'_>) {
        for cell in &self.cells {
            for (pass, outcome) in cell.summaries() {
                let step = self.plan.as_step(cell.algorithm, pass, 1);
                log.listener().ran(&step, outcome);
            }
        }
    }

    /// Tells the listener of the planned runs that were not made.
    fn end(&self, log: &RunLog<'_>) {
        let planned = self.plan.plan.runs_per_cell();
        let skipped = self.cells.iter().map(|e| planned.saturating_sub(e.made));
        log.listener().skipped(skipped.sum());
    }

    /// The records of the finished cells.
    pub(crate) fn cells(self) -> Vec<Cell> {
        let ids: Vec<RunId> = self
            .cells
            .iter()
            .map(|cell| self.plan.run_id(cell.algorithm, Pass::Time, 0))
            .collect();
        let earlier = self.cells.iter().filter_map(|cell| cell.earlier.clone());
        let earlier: Vec<Cell> = earlier.collect();
        let cells = self.cells.into_iter().zip(ids);
        let mut cells: Vec<Cell> = cells
            .filter(|(cell, _)| cell.is_complete())
            .map(|(cell, id)| {
                let placed = cell.timed().enumerate().filter_map(|(round, outcome)| {
                    // In journals of older programs every round has all algorithms.
                    let in_round = || self.plan.place(round, cell.place);
                    outcome.place.or_else(in_round)
                });
                let places = placed.collect();
                cell.finish(id, places, self.plan.plan.group.wavefront)
            })
            .collect();
        let unchanged: Vec<(usize, Option<String>)> = cells
            .iter()
            .enumerate()
            .filter(|(_, cell)| earlier.contains(cell))
            .map(|(place, cell)| (place, cell.message.clone()))
            .collect();
        agreement::explain(&mut cells);
        // These were explained when they were made.
        for (place, message) in unchanged {
            cells[place].message = message;
        }
        cells
    }
}

impl<'p> UnitPlan<'p> {
    /// Carries out the runs that are missing of cells at the same time.
    fn make_runs_of_cells<'s>(
        &self,
        cells: &mut [CellRuns<'p>],
        first: Option<Box<dyn Session + 's>>,
        open: &(dyn Fn() -> Result<Box<dyn Session + 's>, Refusal> + Sync),
        log: &RunLog<'_>,
    ) -> anyhow::Result<()> {
        let checks = Checks::default();
        let mut session = match first.map_or_else(open, Ok) {
            Ok(session) => session,
            Err(refusal) => return self.refuse(cells, &refusal, log),
        };
        let mut context = RunContext {
            session: &mut *session,
            log,
            checks: &checks,
        };
        let warmed = self.prepare(cells, &mut context)?;
        // Its session goes on with the cell that it has warmed up.
        let heir = warmed.unwrap_or_default();
        let session = Mutex::new(Some(session));
        each(cells.iter_mut(), true, |cell| {
            if cell.is_complete() {
                return Ok(());
            }
            let own = if cell.place == heir {
                lock(&session).take()
            } else {
                None
            };
            let cell = slice::from_mut(cell);
            match own.map_or_else(open, Ok) {
                Ok(mut session) => {
                    let mut context = RunContext {
                        session: &mut *session,
                        log,
                        checks: &checks,
                    };
                    self.make_runs(cell, warmed, &mut context)
                }
                Err(refusal) => self.refuse(cell, &refusal, log),
            }
        })
    }

    /// Ends cells whose model could not be opened again.
    fn refuse(
        &self,
        cells: &mut [CellRuns<'p>],
        refusal: &Refusal,
        log: &RunLog<'_>,
    ) -> anyhow::Result<()> {
        if log.interrupted() {
            return Err(Interrupted.into());
        }
        for cell in cells.iter_mut().filter(|cell| !cell.is_complete()) {
            let failure = Failure {
                status: Status::Refused,
                message: refusal.message.clone(),
            };
            let outcome = RunOutcome {
                failure: Some(failure),
                ..RunOutcome::default()
            };
            self.keep(cell, Pass::Warmup, 0, outcome, log)?;
        }
        Ok(())
    }

    /// Makes the runs that come before those of the cells. Returns the place of the cell whose
    /// first warm-up was one of them.
    fn prepare(
        &self,
        cells: &mut [CellRuns<'p>],
        context: &mut RunContext<'_, '_>,
    ) -> anyhow::Result<Option<usize>> {
        self.restore_clusters(cells, context)?;
        self.find_reference(cells, context)
    }

    /// Makes the runs of these cells, interleaved. The cell at place `warmed` has had its first
    /// warm-up.
    fn make_runs(
        &self,
        cells: &mut [CellRuns<'p>],
        warmed: Option<usize>,
        context: &mut RunContext<'_, '_>,
    ) -> anyhow::Result<()> {
        for round in 0..self.plan.warmup {
            for cell in &mut *cells {
                if round > 0 || warmed != Some(cell.place) {
                    self.step(cell, Pass::Warmup, round, context)?;
                }
            }
        }
        for round in 0..self.plan.sampling.most() {
            if !cells.iter().any(CellRuns::wants_time) {
                break;
            }
            for place in self.order.round(round) {
                if let Some(cell) = cells.iter_mut().find(|cell| cell.place == place) {
                    self.step(cell, Pass::Time, round, context)?;
                }
            }
        }
        // Profile before Count: the storage of the counters fragments the heap, and the memory of
        // later runs could not be measured.
        for pass in [Pass::Profile, Pass::Count] {
            for cell in &mut *cells {
                self.step(cell, pass, 0, context)?;
            }
        }
        Ok(())
    }

    /// The place of the cell at `place` in a round of timed runs, if there are rounds.
    fn place(&self, round: usize, place: usize) -> Option<usize> {
        let place = self.order.place(round, place);
        place.filter(|_| self.is_interleaved)
    }

    /// Determines the reference answer. If that takes a run of an algorithm of the plan, the run
    /// counts as its warm-up and the index of its cell is returned.
    fn find_reference(
        &self,
        cells: &mut [CellRuns<'p>],
        context: &mut RunContext<'_, '_>,
    ) -> anyhow::Result<Option<usize>> {
        let reference = match &self.plan.reference {
            Reference::None => return Ok(None),
            Reference::Files(files) => {
                let vertices = self.model.vertices.unwrap_or(0) as usize;
                match files.find(Path::new(&self.model.path), &self.source.label(), vertices) {
                    Ok(field) => {
                        context.check().answer = Some(Answer {
                            name: field.path.display().to_string(),
                            distances: field.distances,
                            vertices,
                        });
                    }
                    Err(error) => context.check().unchecked = Some(error.to_string()),
                }
                return Ok(None);
            }
            Reference::Algorithm(reference) => reference,
        };
        let run = self.run_id(reference, Pass::Warmup, 0);
        let failed = |failure: &Failure| {
            let label = reference.label();
            Some(format!("the reference {label} failed: {}", failure.message))
        };
        let failure = |journal: &Journal| journal.outcome(&run)?.failure.clone();
        let known = context.log.journal().as_deref().and_then(failure);
        if let Some(failure) = known {
            // Not tried again.
            context.check().unchecked = failed(&failure);
            return Ok(None);
        }
        let cell = cells
            .iter_mut()
            .find(|cell| cell.algorithm.label() == reference.label());
        let done = context.execute(&self.as_step(reference, Pass::Warmup, 1))?;
        match &done {
            Ok(observation) => {
                context.check().answer =
                    Some(Answer::of(reference.label(), &observation.distances));
            }
            Err(failure) => context.check().unchecked = failed(failure),
        }
        let Some(cell) = cell else {
            // Not a cell of the plan. The journal keeps a failure, so that it is not tried again.
            let found = self.judge(reference, done, &mut context.check());
            context.log.keep(JournalLine::Run { id: run, found })?;
            return Ok(None);
        };
        // Else its timed runs are done. The new answer serves checks only.
        if cell.lacks(Pass::Warmup, 0) {
            self.take_in(cell, Pass::Warmup, 0, done, context)?;
        }
        Ok(Some(cell.place))
    }

    /// Repeats runs whose answers differed from the reference before an interruption, so that later
    /// answers can be compared with them.
    fn restore_clusters(
        &self,
        cells: &[CellRuns<'p>],
        context: &mut RunContext<'_, '_>,
    ) -> anyhow::Result<()> {
        let mut restored = Vec::new();
        for cell in cells {
            let Some(cluster) = cell.odd_cluster() else {
                continue;
            };
            if !restored.contains(&cluster) {
                restored.push(cluster);
                let done = context.execute(&self.as_step(cell.algorithm, Pass::Warmup, 1))?;
                let answer = done.ok().map(|observation| observation.distances);
                context.check().clusters.restore(cluster, answer);
            }
        }
        Ok(())
    }

    /// Makes a run, unless it is done or its cell has failed.
    fn step(
        &self,
        cell: &mut CellRuns<'p>,
        pass: Pass,
        round: usize,
        context: &mut RunContext<'_, '_>,
    ) -> anyhow::Result<()> {
        if !cell.lacks(pass, round) {
            return Ok(());
        }
        let mut solves = 1;
        if pass == Pass::Time {
            solves = cell.solves();
            if round >= self.plan.sampling.fewest() {
                context.log.listener().extended();
            }
        }
        let done = context.execute(&self.as_step(cell.algorithm, pass, solves))?;
        self.take_in(cell, pass, round, done, context)
    }

    /// Checks the result of a run, writes it to the journal and adds it to its cell.
    fn take_in(
        &self,
        cell: &mut CellRuns<'p>,
        pass: Pass,
        round: usize,
        done: Result<Observation, Failure>,
        context: &mut RunContext<'_, '_>,
    ) -> anyhow::Result<()> {
        let mut done = done;
        let labels = done.as_mut().ok().and_then(|done| done.labels.take());
        let mut outcome = self.judge(cell.algorithm, done, &mut context.check());
        if let Some(labels) = labels.filter(|_| outcome.failure.is_none()) {
            self.judge_labels(&labels, &mut outcome, context)?;
        }
        if pass == Pass::Time {
            outcome.place = self.place(round, cell.place);
        }
        self.keep(cell, pass, round, outcome, context.log)
    }

    /// Writes the outcome of a run to the journal and adds it to its cell.
    fn keep(
        &self,
        cell: &mut CellRuns<'p>,
        pass: Pass,
        round: usize,
        outcome: RunOutcome,
        log: &RunLog<'_>,
    ) -> anyhow::Result<()> {
        log.keep(JournalLine::Run {
            id: self.run_id(cell.algorithm, pass, round),
            found: outcome.clone(),
        })?;
        let step = self.as_step(cell.algorithm, pass, 1);
        log.listener().ran(&step, summary(&outcome));
        cell.made += 1;
        cell.add(pass, round, outcome);
        if pass == Pass::Time {
            cell.count_samples();
        }
        Ok(())
    }

    /// Compares labels with one run of the reference from each source.
    fn judge_labels(
        &self,
        labels: &[u32],
        outcome: &mut RunOutcome,
        context: &mut RunContext<'_, '_>,
    ) -> Result<(), Interrupted> {
        let checks = context.checks;
        let mut nearest = lock(&checks.nearest);
        if matches!(*nearest, Nearest::NotSought) {
            let found = self.find_nearest(context)?;
            *nearest = found.map_or(Nearest::Unknown, Nearest::Known);
        }
        if let Nearest::Known(nearest) = &*nearest {
            let wrong: Vec<usize> = nearest.wrong(labels).collect();
            outcome.check.wrong_labels = Some(wrong.len() as u64);
            if let Some(first) = wrong.first() {
                outcome.failure = Some(Failure {
                    status: Status::Wrong,
                    message: format!(
                        "vertex {first} has label {}, which is not that of a nearest source; {} of {} labels are wrong",
                        labels[*first],
                        wrong.len(),
                        labels.len()
                    ),
                });
            }
        }
        Ok(())
    }

    /// The nearest sources of every vertex; `None` where nothing is checked, of a single source, and
    /// of more than [`MOST_SOURCES`].
    fn find_nearest(
        &self,
        context: &mut RunContext<'_, '_>,
    ) -> Result<Option<NearestSources>, Interrupted> {
        let Reference::Algorithm(reference) = &self.plan.reference else {
            return Ok(None);
        };
        let vertices = self.model.vertices.unwrap_or(0) as usize;
        let Ok(points) = self.source.points(vertices) else {
            return Ok(None);
        };
        if !(2..=MOST_SOURCES).contains(&points.len()) {
            return Ok(None);
        }
        let mut nearest = NearestSources::new(vertices, points.len());
        for (i, point) in points.into_iter().enumerate() {
            let source = SourceSpec::from(point);
            let step = Step {
                source: &source,
                ..self.as_step(reference, Pass::Warmup, 1)
            };
            let done = context.execute(&step)?;
            let check = context.check();
            let (Ok(done), Some(answer)) = (done, &check.answer) else {
                return Ok(None);
            };
            nearest.add(i, &done.distances, &answer.distances, self.plan.tolerance);
        }
        Ok(Some(nearest))
    }

    fn judge(
        &self,
        algorithm: &Selection,
        done: Result<Observation, Failure>,
        reference_check: &mut ReferenceCheck,
    ) -> RunOutcome {
        match done {
            Ok(mut observation) => {
                let distances = std::mem::take(&mut observation.distances);
                let bound = algorithm.error_bound();
                let is_approximate = algorithm.is_approximate();
                let tolerance = self.plan.tolerance.max(bound.unwrap_or(0.0));
                let (mut check, failure) =
                    reference_check.judge(&distances, tolerance, is_approximate);
                check.doubt = (self.model.longest_edge)
                    .and_then(|longest| precision::doubtful_by(longest, &distances));
                // An approximation may differ, but by a finite amount, or by its proven bound.
                let may_differ = is_approximate && bound.is_none();
                let failure = failure.filter(|_| !may_differ || check.max_rel.is_none());
                RunOutcome {
                    observation,
                    check,
                    unchecked: reference_check.unchecked.clone(),
                    failure,
                    place: None,
                }
            }
            Err(failure) => RunOutcome {
                failure: Some(failure),
                ..RunOutcome::default()
            },
        }
    }

    fn as_step<'s>(&'s self, algorithm: &'s Selection, pass: Pass, solves: usize) -> Step<'s> {
        Step {
            model: &self.model.name,
            algorithm,
            source: &self.source,
            pass,
            solves,
        }
    }

    fn run_id(&self, algorithm: &Selection, pass: Pass, round: usize) -> RunId {
        RunId {
            group: self.plan.group.name.clone(),
            model: self.model.name.clone(),
            source: self.source.label(),
            algorithm: algorithm.label().to_owned(),
            pass,
            round,
        }
    }
}

/// The most sources whose labels are checked, each by a run of its own.
const MOST_SOURCES: usize = 100;

/// The environment of the runs.
struct RunContext<'s, 'l> {
    session: &'s mut dyn Session,
    log: &'s RunLog<'l>,
    checks: &'s Checks,
}

/// What the answers of the cells are compared with; cells that run at the same time share it.
#[derive(Default)]
struct Checks {
    /// The reference, and the answers that differ from it.
    reference: Mutex<ReferenceCheck>,
    nearest: Mutex<Nearest>,
}

/// The nearest sources of every vertex.
#[derive(Default)]
enum Nearest {
    /// No labels have come yet.
    #[default]
    NotSought,
    /// Labels are not checked.
    Unknown,
    Known(NearestSources),
}

/// A signal arrived.
#[derive(Debug, thiserror::Error)]
#[error("interrupted")]
struct Interrupted;

/// A signal ends the runs without an error.
fn stopped_or(done: anyhow::Result<()>) -> anyhow::Result<()> {
    match done {
        Err(error) if error.is::<Interrupted>() => Ok(()),
        done => done,
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<'s> RunContext<'s, '_> {
    fn check(&self) -> MutexGuard<'s, ReferenceCheck> {
        lock(&self.checks.reference)
    }

    /// Makes a run, unless a signal arrives first.
    fn execute(&mut self, step: &Step<'_>) -> Result<Result<Observation, Failure>, Interrupted> {
        if self.log.interrupted() {
            return Err(Interrupted);
        }
        self.log.listener().step(step);
        let done = self.session.execute(step);
        if done.is_err() && self.log.interrupted() {
            return Err(Interrupted);
        }
        Ok(done)
    }
}

/// The outcomes of the runs of a cell.
#[derive(Debug)]
struct CellRuns<'p> {
    /// Its place in the plan.
    place: usize,
    algorithm: &'p Selection,
    outcomes: BTreeMap<(Pass, usize), RunOutcome>,
    /// Failure of the cell; no further runs are made.
    failure: Option<Failure>,
    /// Runs made by this process, without those from the journal.
    made: usize,
    sampling: Sampling,
    /// Whether there are enough timed runs.
    has_time: bool,
    /// The cell of an earlier file.
    earlier: Option<Cell>,
}

impl<'p> CellRuns<'p> {
    const fn new(place: usize, algorithm: &'p Selection, sampling: Sampling) -> Self {
        Self {
            place,
            algorithm,
            outcomes: BTreeMap::new(),
            failure: None,
            made: 0,
            sampling,
            has_time: false,
            earlier: None,
        }
    }

    const fn has_failed(&self) -> bool {
        self.failure.is_some()
    }

    /// Whether a run is missing. Warm-ups are repeated if timed runs are missing.
    fn lacks(&self, pass: Pass, round: usize) -> bool {
        let is_wanted = match pass {
            Pass::Warmup => return self.wants_time(),
            Pass::Time => self.wants_time(),
            Pass::Count | Pass::Profile => !self.has_failed(),
        };
        is_wanted && !self.outcomes.contains_key(&(pass, round))
    }

    /// Whether timed runs are missing.
    const fn wants_time(&self) -> bool {
        !self.has_failed() && !self.has_time
    }

    /// Whether all runs are done.
    fn is_complete(&self) -> bool {
        !self.wants_time() && !self.lacks(Pass::Count, 0) && !self.lacks(Pass::Profile, 0)
    }

    /// The outcomes of the timed runs, in their order.
    fn timed(&self) -> impl Iterator<Item = &RunOutcome> {
        let runs = self
            .outcomes
            .range((Pass::Time, 0)..=(Pass::Time, usize::MAX));
        runs.map(|(_, outcome)| outcome)
    }

    /// Decides whether the timed runs so far are enough.
    fn count_samples(&mut self) {
        let of = |found: &RunOutcome| {
            let seconds = found.observation.seconds?;
            let solves = found.observation.solves.unwrap_or(1) as f64;
            let outside = found.observation.outside_seconds;
            Some((seconds, outside.unwrap_or(seconds * solves)))
        };
        let (samples, spent): (Vec<f64>, Vec<f64>) = self.timed().filter_map(of).unzip();
        let is_outside = self.algorithm.program().is_some();
        let samples = if is_outside && is_doubtful(&samples, &spent) {
            &spent
        } else {
            &samples
        };
        self.has_time = self.sampling.is_enough(samples, spent.iter().sum());
    }

    /// Solves of a timed run, from the time of the first warm-up. Outside programs solve once.
    fn solves(&self) -> usize {
        if self.algorithm.program().is_some() {
            return 1;
        }
        let warm = self.outcomes.get(&(Pass::Warmup, 0));
        self.sampling
            .solves(warm.and_then(|outcome| outcome.observation.seconds))
    }

    /// The cluster of an answer that differed from the reference, if one did.
    fn odd_cluster(&self) -> Option<u32> {
        let clusters = self
            .outcomes
            .values()
            .filter_map(|found| found.check.cluster);
        clusters
            .max()
            .filter(|&cluster| cluster != agreement::REFERENCE)
    }

    /// Short outcomes of the known runs.
    fn summaries(&self) -> impl Iterator<Item = (Pass, Result<Option<f64>, Status>)> {
        let outcomes = self.outcomes.iter();
        outcomes.map(|(&(pass, _), outcome)| (pass, summary(outcome)))
    }

    /// Adds the outcome of a run.
    fn add(&mut self, pass: Pass, round: usize, outcome: RunOutcome) {
        self.failure = self.failure.take().or_else(|| outcome.failure.clone());
        // Of repeated warm-ups the first set the algorithm up.
        self.outcomes.entry((pass, round)).or_insert(outcome);
    }

    /// The record of the cell. `places` are the places of its timed runs in their rounds.
    fn finish(self, run: RunId, places: Vec<usize>, with_wavefront: bool) -> Cell {
        let all = self.timed().count();
        let samples = |cell: &Cell| cell.time.samples.len();
        if let Some(same) = self.earlier.as_ref().filter(|e| samples(e) >= all) {
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
        let (mut outside, mut claimed, mut doubted) = (Vec::new(), Vec::new(), false);
        for ((pass, _), outcome) in self.outcomes {
            let observation = outcome.observation;
            cell.message = cell.message.or(observation.note);
            if let Some(why) = outcome.unchecked {
                cell.message = Some(format!("{NOT_CHECKED}{why}"));
            }
            // The set-up of the counted run is not that of the timed runs.
            setup = setup.or(observation.setup_seconds);
            extraction = extraction.or(observation.extraction_seconds);
            match pass {
                Pass::Warmup => {}
                Pass::Time => {
                    samples.extend(observation.seconds);
                    solves.push(observation.solves.unwrap_or(1));
                    outside.extend(observation.outside_seconds);
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
                // Ours are measured in the profiled run; outside programs report them with the
                // counts.
                let Peaks { heap, rss } = observation.peaks;
                cell.memory.heap_peak_bytes = cell.memory.heap_peak_bytes.or(heap);
                cell.memory.rss_peak_bytes = cell.memory.rss_peak_bytes.or(rss);
            }
        }
        if solves.iter().all(|&solves| solves == 1) {
            solves.clear();
        }
        let speaks = |program: &Arc<Program>| program.lifetime != ProcessLifetime::Command;
        if !outside.is_empty() && self.algorithm.program().is_some_and(speaks) {
            claimed.clone_from(&samples);
            doubted = is_doubtful(&claimed, &outside);
            if doubted {
                samples.clone_from(&outside);
            }
        }
        cell.time = Time {
            extraction,
            places,
            solves,
            outside,
            claimed,
            doubted,
            precision: self.sampling.precision().map(|wanted| wanted.relative),
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

    /// The worst comparison. A cell is checked if all its runs were.
    fn check(&self) -> Check {
        let outcomes = || self.outcomes.values();
        let badness = |check: &Check| match check.reference {
            Some(_) => check.max_rel.unwrap_or(f64::INFINITY),
            None => -1.0,
        };
        let worst = outcomes()
            .map(|outcome| &outcome.check)
            .max_by(|a, b| badness(a).total_cmp(&badness(b)));
        let unreachable = outcomes()
            .rev()
            .find_map(|outcome| outcome.check.unreachable);
        let doubt = outcomes().find_map(|outcome| outcome.check.doubt);
        let wrong_labels = outcomes().find_map(|outcome| outcome.check.wrong_labels);
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

/// Least share of the time from outside that the own time of an outside program can be.
const LEAST_CLAIM: f64 = 0.1;

/// Share by which the clock of a program may run faster than ours.
const CLOCKS: f64 = 0.01;

/// Whether one of the times that an outside program claims is more than that from outside, or a
/// small part of it.
fn is_doubtful(claimed: &[f64], outside: &[f64]) -> bool {
    let mut pairs = claimed.iter().zip(outside);
    pairs.any(|(&claimed, &outside)| {
        claimed > outside * (1.0 + CLOCKS) || claimed < LEAST_CLAIM * outside
    })
}

/// A short outcome: the status of a failure, or the seconds of a timed run.
fn summary(outcome: &RunOutcome) -> Result<Option<f64>, Status> {
    match &outcome.failure {
        Some(failure) => Err(failure.status),
        None => Ok(outcome.observation.seconds),
    }
}

/// Bytes that the papers charge for each window.
const PAPERS_WINDOW_BYTES: u64 = 80;

/// The order of the algorithms in each round of timed runs.
///
/// A round has one run of every algorithm. The previous run matters through caches, memory and
/// clock frequency, so the order follows the rows of a balanced Latin square (E. J. Williams,
/// Experimental designs balanced for the estimation of residual effects of treatments, 1949): over
/// all rows every algorithm has every place equally often and follows every other equally often.
/// Seed, model and source determine the columns and the first row, so that a run can be repeated.
#[derive(Clone, Debug)]
pub(crate) struct RunOrder {
    /// The algorithm of each part of the square.
    parts: Vec<usize>,
    /// The rows of the square, in order of use.
    rows: Vec<usize>,
}

impl RunOrder {
    /// The order of `algorithms` algorithms in a model from a source.
    pub(crate) fn new(seed: u64, model: &str, source: &SourceLabel, algorithms: usize) -> Self {
        let source = match source {
            SourceLabel::Vertex(vertex) => vertex.to_le_bytes().to_vec(),
            SourceLabel::Other(text) => text.clone().into_bytes(),
        };
        let bytes = model.bytes().chain(source);
        let seed = bytes.fold(seed, |seed, byte| {
            SplitMix64::new(seed ^ u64::from(byte)).next()
        });
        let mut random = SplitMix64::new(seed);
        // An odd number of algorithms needs the square and its mirror image.
        let rows = algorithms * (1 + algorithms % 2);
        Self {
            parts: shuffled(algorithms, &mut random),
            rows: shuffled(rows, &mut random),
        }
    }

    /// The place of an algorithm in `round`.
    fn place(&self, round: usize, algorithm: usize) -> Option<usize> {
        let mut order = self.round(round).into_iter();
        order.position(|other| other == algorithm)
    }

    /// The algorithms in their order in `round`, counted from 0.
    pub(crate) fn round(&self, round: usize) -> Vec<usize> {
        let n = self.parts.len();
        if n == 0 {
            return Vec::new();
        }
        let row = self.rows[round % self.rows.len()];
        let mut order: Vec<usize> = (0..n)
            // The first row is 0, n - 1, 1, n - 2, ...: neighbours differ by every amount once.
            .map(|k| if k % 2 == 0 { k / 2 } else { n - k.div_ceil(2) })
            .map(|part| self.parts[(part + row) % n])
            .collect();
        if row >= n {
            order.reverse();
        }
        order
    }
}

/// The numbers below `n`, shuffled (Fisher and Yates).
fn shuffled(n: usize, random: &mut SplitMix64) -> Vec<usize> {
    let mut all: Vec<usize> = (0..n).collect();
    for i in 0..n {
        all.swap(i, i + random.below(n - i));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_and_every_neighbour_is_had_equally_often() {
        for n in 1..=9 {
            let order = RunOrder::new(7, "horse", &3.into(), n);
            let (rounds, each) = (n * (1 + n % 2), 1 + n % 2);
            let mut places = vec![vec![0; n]; n];
            let mut follows = vec![vec![0; n]; n];
            for round in 0..rounds {
                let order = order.round(round);
                for (place, &algorithm) in order.iter().enumerate() {
                    places[algorithm][place] += 1;
                }
                for pair in order.windows(2) {
                    follows[pair[0]][pair[1]] += 1;
                }
            }
            assert!(places.iter().flatten().all(|&count| count == each), "{n}");
            for (a, row) in follows.iter().enumerate() {
                for (b, &count) in row.iter().enumerate() {
                    assert_eq!(count, if a == b { 0 } else { each }, "{n}: {a} {b}");
                }
            }
        }
    }

    #[test]
    fn two_algorithms_alternate_in_going_first() {
        let order = RunOrder::new(1, "cow", &0.into(), 2);
        let first: Vec<usize> = (0..6).map(|round| order.round(round)[0]).collect();
        assert_ne!(first[0], first[1]);
        assert_eq!(first[..2], first[2..4]);
        assert_eq!(first[..2], first[4..]);
    }

    #[test]
    fn the_order_follows_from_seed_model_and_source_alone() {
        let all = |order: &RunOrder| (0..12).map(|r| order.round(r)).collect::<Vec<_>>();
        let order = all(&RunOrder::new(1, "cow", &0.into(), 5));
        assert_eq!(order, all(&RunOrder::new(1, "cow", &0.into(), 5)));
        assert_ne!(order, all(&RunOrder::new(2, "cow", &0.into(), 5)));
        assert_ne!(order, all(&RunOrder::new(1, "horse", &0.into(), 5)));
        assert_ne!(order, all(&RunOrder::new(1, "cow", &1.into(), 5)));
        assert!(RunOrder::new(1, "cow", &0.into(), 0).round(3).is_empty());
    }
}
