//! The cells of one model and one source.

use std::path::Path;
use std::slice;
use std::sync::{Mutex, MutexGuard};

use geobench_registry::{self as registry, Selection};
use geobench_window::precision;

use crate::exec::model::ModelRef;
use crate::exec::source::SourceSpec;
use crate::exec::{Backend, Failure, Observation, Pass, Refusal, Session, Step};
use crate::lock::lock;
use crate::measure::number::{grouped, scientific};
use crate::plan::{MOST_FACES_UNASKED, Plan, Reference};
use crate::run::agreement;
use crate::run::answer_layout::AnswerLayout;
use crate::run::cell_runs::{CellRuns, summary};
use crate::run::each::each;
use crate::run::earlier::{self, Earlier};
use crate::run::journal::{Journal, JournalLine, RunId, RunOutcome, UnitId};
use crate::run::labels::NearestSources;
use crate::run::log::RunLog;
use crate::run::order::RunOrder;
use crate::run::proof::{self, Decision};
use crate::run::reference_check::{Answer, ReferenceCheck};
use crate::schema::{Cell, ModelRecord, Status};

/// The cells of one model and source. Unless several cells run concurrently, their runs are
/// interleaved, so that a drift of clock frequency or temperature affects all algorithms alike.
pub(crate) struct Unit<'p> {
    plan: UnitPlan<'p>,
    /// One for each algorithm that runs on the model, in the order of the plan.
    cells: Vec<CellRuns<'p>>,
    /// What a proof has decided about disagreeing answers.
    decision: Option<Decision>,
}

/// The data shared by the cells of a unit.
struct UnitPlan<'p> {
    plan: &'p Plan,
    model: &'p ModelRecord,
    /// The source, or several sources together.
    source: SourceSpec,
    /// The reference for this model.
    reference: Reference,
    order: RunOrder,
    is_interleaved: bool,
}

/// Where runs of earlier processes are recorded.
#[derive(Clone, Copy, Default)]
pub(crate) struct RecordedRuns<'p> {
    pub(crate) journal: Option<&'p Journal>,
    pub(crate) earlier: Option<&'p Earlier>,
}

impl<'p> RecordedRuns<'p> {
    /// The record of a model, and its SHA-256 if the record is from the earlier file.
    pub(crate) fn model(self, name: &str) -> Option<(&'p ModelRecord, Option<String>)> {
        if let Some(model) = self.journal.and_then(|journal| journal.model(name)) {
            return Some((model, None));
        }
        let model = self.earlier?.model(name)?;
        Some((model, model.sha256.clone()))
    }
}

impl<'p> Unit<'p> {
    /// The cells of `plan` for `model` and `source`, with the outcomes in `recorded`. The journal
    /// takes precedence over the earlier file.
    pub(crate) fn new(
        plan: &'p Plan,
        model: &'p ModelRecord,
        source: SourceSpec,
        recorded: RecordedRuns<'_>,
        is_interleaved: bool,
    ) -> Self {
        let algorithms: Vec<&Selection> = plan.algorithms_on(model).collect();
        let cells = algorithms.iter().copied().enumerate();
        let mut unit = Self {
            plan: UnitPlan {
                plan,
                model,
                order: RunOrder::new(plan.seed, &model.name, &source.label(), algorithms.len()),
                source,
                reference: plan.reference_on(model),
                is_interleaved,
            },
            cells: cells
                .map(|(index, algorithm)| CellRuns::new(index, algorithm, plan))
                .collect(),
            decision: None,
        };
        if let Some(journal) = recorded.journal {
            unit.decision = journal.decision(&unit.plan.unit_id()).cloned();
        }
        // The reference has one warm-up even if the plan has none.
        let warmups = (0..plan.warmup.max(1)).map(|round| (Pass::Warmup, round));
        let times = (0..plan.sampling.most()).map(|round| (Pass::Time, round));
        let last = [(Pass::Profile, 0), (Pass::Count, 0)];
        for (pass, round) in warmups.chain(times).chain(last) {
            for (index, &algorithm) in algorithms.iter().enumerate() {
                let run = unit.plan.run_id(algorithm, pass, round);
                let cell = &mut unit.cells[index];
                if pass == Pass::Warmup && round == 0 {
                    let earlier = recorded.earlier;
                    cell.earlier = earlier.and_then(|e| e.cell(&run, algorithm.threads()).cloned());
                }
                let journal = recorded.journal.and_then(|journal| journal.outcome(&run));
                let earlier = || earlier::outcome(cell.earlier.as_ref()?, pass, round);
                if let Some(outcome) = journal.cloned().or_else(earlier) {
                    cell.add(pass, round, outcome);
                }
            }
        }
        for cell in &mut unit.cells {
            cell.count_samples();
        }
        unit.revise();
        unit
    }

    /// Whether all runs are done.
    pub(crate) fn is_complete(&self) -> bool {
        self.cells.iter().all(CellRuns::is_complete)
    }

    /// Judges answers anew that were compared with a reference before a proof refuted it.
    fn revise(&mut self) {
        if let Some(Decision::Replaced { groups, .. }) = &self.decision {
            for cell in &mut self.cells {
                cell.revise(groups);
            }
        }
    }

    /// Executes the missing runs of all cells, interleaved.
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
            let checks = self.plan.checks(self.decision.take());
            let mut context = RunContext {
                session,
                log,
                checks: &checks,
            };
            let done = self
                .plan
                .prepare(&mut self.cells, &mut context)
                .and_then(|warmed| self.plan.make_runs(&mut self.cells, warmed, &mut context));
            self.decision = context.check().decision.take();
            stopped_or(done)?;
        }
        self.end(log);
        Ok(())
    }

    /// Executes the missing runs: first that of the reference, then those of the cells, which run
    /// concurrently on the threads of the current pool, each in its own session. `first` is an
    /// unused session of the model, if there is one. It serves the reference and then one cell.
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
            let checks = self.plan.checks(self.decision.take());
            let done = self.plan.make_runs_of_cells(
                &mut self.cells,
                first,
                &|| backend.open_further(model, self.plan.model),
                log,
                &checks,
            );
            self.decision = lock(&checks.reference).decision.take();
            stopped_or(done)?;
        }
        self.end(log);
        Ok(())
    }

    /// Reports the known runs to the listener.
    fn begin(&self, log: &RunLog<'_>) {
        for cell in &self.cells {
            for (pass, outcome) in cell.summaries() {
                let step = self.plan.as_step(cell.algorithm, pass, 1);
                log.listener().ran(&step, outcome);
            }
        }
    }

    /// Reports to the listener how many planned runs were not executed.
    fn end(&self, log: &RunLog<'_>) {
        let plan = self.plan.plan;
        let planned = plan.runs_per_cell();
        let skipped = self.cells.iter().map(|e| planned.saturating_sub(e.made));
        let left_out = plan.algorithms.len() - self.cells.len();
        log.listener()
            .skipped(skipped.sum::<usize>() + left_out * planned);
    }

    /// The records of the finished cells.
    pub(crate) fn cells(mut self) -> Vec<Cell> {
        self.revise();
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
                    // Journals of older versions do not store the position. In their runs every
                    // round has all algorithms, so it follows from the order.
                    let in_round = || self.plan.position(round, cell.index);
                    outcome.place.or_else(in_round)
                });
                let places = placed.collect();
                let mut cell = cell.finish(id, places, self.plan.plan.group.wavefront);
                cell.goal = self.plan.plan.goal.label();
                cell
            })
            .collect();
        let unchanged: Vec<(usize, Cell)> = cells
            .iter()
            .enumerate()
            .filter(|(_, cell)| earlier.contains(cell))
            .map(|(index, cell)| (index, cell.clone()))
            .collect();
        if let Some(decision) = &self.decision {
            for cell in &mut cells {
                decision.describe(&mut cell.check);
            }
        }
        agreement::explain(&mut cells);
        // Cells from the earlier file have these remarks already.
        for (index, cell) in unchanged {
            cells[index] = cell;
        }
        cells
    }
}

impl<'p> UnitPlan<'p> {
    /// Executes the missing runs of concurrent cells.
    fn make_runs_of_cells<'s>(
        &self,
        cells: &mut [CellRuns<'p>],
        first: Option<Box<dyn Session + 's>>,
        open: &(dyn Fn() -> Result<Box<dyn Session + 's>, Refusal> + Sync),
        log: &RunLog<'_>,
        checks: &Checks,
    ) -> anyhow::Result<()> {
        let mut session = match first.map_or_else(open, Ok) {
            Ok(session) => session,
            Err(refusal) => return self.refuse(cells, &refusal, log),
        };
        let mut context = RunContext {
            session: &mut *session,
            log,
            checks,
        };
        let warmed = self.prepare(cells, &mut context)?;
        // The session of the reference run continues with the cell that it warmed up, or else with
        // the first cell.
        let continuing = warmed.unwrap_or_default();
        let session = Mutex::new(Some(session));
        each(cells.iter_mut(), true, |cell| {
            if cell.is_complete() {
                return Ok(());
            }
            let own = if cell.index == continuing {
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
                        checks,
                    };
                    self.make_runs(cell, warmed, &mut context)
                }
                Err(refusal) => self.refuse(cell, &refusal, log),
            }
        })
    }

    /// Marks incomplete cells as refused, after a session of their model could not be opened.
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
            let outcome = RunOutcome {
                failure: Some(Failure::new(refusal.status, &refusal.message)),
                ..RunOutcome::default()
            };
            self.keep(cell, Pass::Warmup, 0, outcome, log)?;
        }
        Ok(())
    }

    /// The state of the checks before the first run.
    fn checks(&self, decision: Option<Decision>) -> Checks {
        let vertices = self.model.vertex_count();
        Checks {
            reference: Mutex::new(ReferenceCheck {
                layout: AnswerLayout::new(&self.plan.goal, vertices),
                decision,
                ..ReferenceCheck::default()
            }),
            nearest: Mutex::default(),
        }
    }

    /// Executes the runs that the checks need before those of the cells. Returns the index of the
    /// cell whose first warm-up was one of them.
    fn prepare(
        &self,
        cells: &mut [CellRuns<'p>],
        context: &mut RunContext<'_, '_>,
    ) -> anyhow::Result<Option<usize>> {
        self.restore_clusters(cells, context)?;
        self.find_reference(cells, context)
    }

    /// Executes the missing runs of these cells, interleaved. The cell with index `warmed` has had
    /// its first warm-up.
    fn make_runs(
        &self,
        cells: &mut [CellRuns<'p>],
        warmed: Option<usize>,
        context: &mut RunContext<'_, '_>,
    ) -> anyhow::Result<()> {
        for round in 0..self.plan.warmup {
            for cell in &mut *cells {
                if round > 0 || warmed != Some(cell.index) {
                    self.step(cell, Pass::Warmup, round, context)?;
                }
            }
        }
        for round in 0..self.plan.sampling.most() {
            if !cells.iter().any(CellRuns::wants_time) {
                break;
            }
            for index in self.order.round(round) {
                if let Some(cell) = cells.iter_mut().find(|cell| cell.index == index) {
                    self.step(cell, Pass::Time, round, context)?;
                }
            }
        }
        // Profile precedes Count: the storage of the counters fragments the heap, and the peak
        // memory of a later run could not be measured.
        for pass in [Pass::Profile, Pass::Count] {
            for cell in &mut *cells {
                self.step(cell, pass, 0, context)?;
            }
        }
        Ok(())
    }

    /// Position of the cell with index `index` in a round of timed runs. `None` for concurrent
    /// cells, which have no common rounds.
    fn position(&self, round: usize, index: usize) -> Option<usize> {
        let position = self.order.position(round, index);
        position.filter(|_| self.is_interleaved)
    }

    /// Determines the reference answer, from a file or by a run. If the reference is an algorithm
    /// of the plan, the run counts as its first warm-up, and the index of its cell is returned.
    fn find_reference(
        &self,
        cells: &mut [CellRuns<'p>],
        context: &mut RunContext<'_, '_>,
    ) -> anyhow::Result<Option<usize>> {
        let decision = context.check().decision.clone();
        match decision {
            Some(Decision::Replaced { .. }) => {
                let proven = self.prove(context)?;
                let mut check = context.check();
                match proven {
                    Ok(proven) => check.answer = Some(proven),
                    Err(why) => check.unchecked = Some(why),
                }
                return Ok(None);
            }
            Some(Decision::Unrefuted(_)) => {
                let bounds = self.prove(context)?.ok();
                context.check().bounds = bounds;
            }
            _ => {}
        }
        let reference = match &self.reference {
            Reference::None => return Ok(None),
            Reference::Files(files) => {
                let vertices = self.model.vertex_count();
                let ModelRecord { path, weld, .. } = self.model;
                match files.find(Path::new(path), *weld, &self.source.label(), vertices) {
                    Ok(field) => {
                        let name = field.path.display().to_string();
                        let mut check = context.check();
                        let distances = check.layout.of_stored(&field.distances);
                        if distances.is_empty() {
                            check.unchecked = Some(format!("{name} has no distance of a target"));
                        } else {
                            let vertices = check.layout.count(vertices);
                            check.answer = Some(Answer {
                                name,
                                distances,
                                vertices,
                                stored: Some(field.distances),
                                bounds: None,
                            });
                        }
                    }
                    Err(error) => context.check().unchecked = Some(error.to_string()),
                }
                return Ok(None);
            }
            Reference::Unasked(_) if self.model.faces > Some(MOST_FACES_UNASKED) => {
                context.check().unchecked = Some(format!(
                    "the model has more than {} faces; --check mmp-fast compares its distances",
                    grouped(MOST_FACES_UNASKED)
                ));
                return Ok(None);
            }
            Reference::Algorithm(reference) | Reference::Unasked(reference) => reference,
        };
        let run = self.run_id(reference, Pass::Warmup, 0);
        let failed = |failure: &Failure| {
            let label = reference.label();
            Some(format!("the reference {label} failed: {}", failure.message))
        };
        let failure = |journal: &Journal| journal.outcome(&run)?.failure.clone();
        let known = context.log.journal().as_deref().and_then(failure);
        if let Some(failure) = known {
            // The journal has a failure of the reference. The run is not repeated.
            context.check().unchecked = failed(&failure);
            return Ok(None);
        }
        let cell = cells
            .iter_mut()
            .find(|cell| cell.algorithm.label() == reference.label());
        let lacks = |cell: &&mut CellRuns<'p>| cell.lacks(Pass::Warmup, 0);
        if !self.is_planned(Pass::Warmup, 0) || !cell.as_ref().is_some_and(lacks) {
            context.log.listener().more(1);
        }
        let done = context.execute(&self.as_step(reference, Pass::Warmup, 1))?;
        match &done {
            Ok(observation) => {
                context.check().answer =
                    Some(Answer::of(reference.label(), &observation.distances));
            }
            Err(failure) => context.check().unchecked = failed(failure),
        }
        let Some(cell) = cell else {
            // The reference is not an algorithm of the plan. Its outcome goes to the journal, so
            // that a failure is not repeated.
            let found = self.judge(reference, done, &mut context.check());
            context.log.keep(JournalLine::Run { id: run, found })?;
            return Ok(None);
        };
        // Otherwise the cell has all timed runs or has failed. The answer serves only the checks.
        if cell.lacks(Pass::Warmup, 0) {
            self.check_and_keep(cell, Pass::Warmup, 0, done, context)?;
        }
        Ok(Some(cell.index))
    }

    /// Repeats one run of each cluster that differed from the reference before an interruption. The
    /// journal does not store answers, and later answers are compared with them.
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
                let done =
                    context.execute_unplanned(&self.as_step(cell.algorithm, Pass::Warmup, 1))?;
                let answer = done.ok().map(|observation| observation.distances);
                context.check().clusters.restore(cluster, answer);
            }
        }
        Ok(())
    }

    /// Whether [`Plan::runs_per_cell`] counts a run: not a timed run beyond the minimum, nor the
    /// warm-up of a reference without warm-ups.
    fn is_planned(&self, pass: Pass, round: usize) -> bool {
        match pass {
            Pass::Warmup => round < self.plan.warmup,
            Pass::Time => round < self.plan.sampling.fewest(),
            Pass::Profile | Pass::Count => true,
        }
    }

    /// Executes a run, unless it is done, its cell has enough timed runs, or its cell has failed.
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
        }
        if !self.is_planned(pass, round) {
            context.log.listener().more(1);
        }
        let done = context.execute(&self.as_step(cell.algorithm, pass, solves))?;
        self.check_and_keep(cell, pass, round, done, context)
    }

    /// Checks the answer of a run, writes the outcome to the journal and adds it to its cell.
    fn check_and_keep(
        &self,
        cell: &mut CellRuns<'p>,
        pass: Pass,
        round: usize,
        done: Result<Observation, Failure>,
        context: &mut RunContext<'_, '_>,
    ) -> anyhow::Result<()> {
        let mut done = done;
        let labels = done.as_mut().ok().and_then(|done| done.labels.take());
        if let Ok(found) = &done {
            self.settle(cell.algorithm, &found.distances, context)?;
        }
        let mut outcome = self.judge(cell.algorithm, done, &mut context.check());
        if let Some(labels) = labels.filter(|_| outcome.failure.is_none()) {
            self.judge_labels(&labels, &mut outcome, context)?;
        }
        if pass == Pass::Time {
            outcome.place = self.position(round, cell.index);
        }
        self.keep(cell, pass, round, outcome, context.log)
    }

    /// Finds what the judgement of an answer needs: the scale of the reference where they differ,
    /// and a proof where they still do.
    fn settle(
        &self,
        algorithm: &Selection,
        distances: &[f64],
        context: &mut RunContext<'_, '_>,
    ) -> anyhow::Result<()> {
        // Other cells wait, since they may need the same.
        let mut check = context.check();
        let tolerance = algorithm.tolerance(self.plan.tolerance);
        if algorithm.may_differ() || !check.is_disputed(distances, algorithm, tolerance) {
            return Ok(());
        }
        self.find_scale(&mut check, distances, tolerance, context)?;
        if check.decision.is_none() && check.is_disputed(distances, algorithm, tolerance) {
            let decision = self.decide(&mut check, context)?;
            context.log.keep(JournalLine::Decision {
                id: self.unit_id(),
                found: decision.clone(),
            })?;
            check.decision = Some(decision);
        }
        Ok(())
    }

    /// Finds the scale of the reference, if the comparison with `distances` depends on it.
    fn find_scale(
        &self,
        check: &mut ReferenceCheck,
        distances: &[f64],
        tolerance: f64,
        context: &mut RunContext<'_, '_>,
    ) -> Result<(), Interrupted> {
        let is_named = |name: &str| check.answer.as_ref().is_some_and(|a| a.name == name);
        let certificate = registry::certificate(self.plan.tolerance);
        let [_, greatest] = registry::proven_bounds();
        let algorithm = match self.reference.algorithm() {
            Some(reference) if is_named(reference.label()) => reference,
            _ if is_named(proof::BOUNDS) => &greatest,
            // It takes the place of a refuted reference. A file is not run.
            _ => &certificate,
        };
        let step = self.as_step(algorithm, Pass::Warmup, 1);
        check.find_scale(distances, tolerance, context.session, &step);
        if context.log.interrupted() {
            return Err(Interrupted);
        }
        Ok(())
    }

    /// Proven distances or bounds, or why there are none.
    fn prove(
        &self,
        context: &mut RunContext<'_, '_>,
    ) -> Result<Result<Answer, String>, Interrupted> {
        Answer::proven(self.plan.tolerance, |algorithm| {
            context.execute_unplanned(&self.as_step(algorithm, Pass::Warmup, 1))
        })
    }

    /// Decides by a proof whether the reference is right. If it is not, the proven distances or
    /// bounds take its place.
    fn decide(
        &self,
        check: &mut ReferenceCheck,
        context: &mut RunContext<'_, '_>,
    ) -> Result<Decision, Interrupted> {
        let reference = check.answer.as_ref().map(|answer| answer.name.clone());
        if let Some(proven) = reference
            .as_ref()
            .filter(|name| proof::is_certificate(name))
        {
            return Ok(Decision::Confirmed(proven.clone()));
        }
        if let Some(why) = proof::too_large(self.model.faces) {
            return Ok(Decision::Undecided(why));
        }
        let proven = match self.prove(context)? {
            Ok(proven) => proven,
            Err(why) => return Ok(Decision::Undecided(why)),
        };
        let found = check
            .answer
            .as_ref()
            .map(|answer| answer.completed_by(&proven));
        let why = proven.bounds.as_ref().map(|bounds| bounds.why.clone());
        let before = (
            check.answer.replace(proven),
            std::mem::take(&mut check.scale),
        );
        let tolerance = self.plan.tolerance;
        if let (Some(found), Some(reference)) = (&found, &reference) {
            self.find_scale(check, found, tolerance, context)?;
            if !check.differs(found, tolerance) {
                check.scale = before.1;
                let proven = std::mem::replace(&mut check.answer, before.0);
                check.bounds = proven.filter(|_| why.is_some());
                let confirmed = || Decision::Confirmed(reference.clone());
                return Ok(why.map_or_else(confirmed, Decision::Unrefuted));
            }
        }
        check.unchecked = None;
        Ok(Decision::Replaced {
            reference,
            groups: check.revise(found, tolerance),
            why,
        })
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
        cell.made += usize::from(self.is_planned(pass, round));
        cell.add(pass, round, outcome);
        if pass == Pass::Time {
            cell.count_samples();
        }
        Ok(())
    }

    /// Checks that each label names a nearest source of its vertex. The nearest sources come from
    /// one run of the reference per source, executed when the first labels arrive.
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
                let message = format!(
                    "vertex {first} has label {}, which is not that of a nearest source; {} of {} labels are wrong",
                    labels[*first],
                    wrong.len(),
                    labels.len()
                );
                outcome.failure = Some(Failure::new(Status::Wrong, message));
            }
        }
        Ok(())
    }

    /// The nearest sources of every vertex. `None` if the reference is not an algorithm, if a run
    /// fails, for a single source, and for more than [`MOST_SOURCES`].
    fn find_nearest(
        &self,
        context: &mut RunContext<'_, '_>,
    ) -> Result<Option<NearestSources>, Interrupted> {
        let Some(reference) = self.reference.algorithm() else {
            return Ok(None);
        };
        let vertices = self.model.vertex_count();
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
            let done = context.execute_unplanned(&step)?;
            let check = context.check();
            let (Ok(done), Some(answer)) = (done, &check.answer) else {
                return Ok(None);
            };
            let rule = check.scale.rule(self.plan.tolerance);
            nearest.add(i, &done.distances, &answer.distances, &rule);
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
                let (mut check, failure) =
                    reference_check.judge(&distances, algorithm, self.plan.tolerance);
                check.doubt = (self.model.longest_edge)
                    .and_then(|longest| precision::doubtful_by(longest, &distances));
                // An answer without a proven bound may differ by any finite amount.
                let failure =
                    failure.filter(|_| !algorithm.may_differ() || check.max_rel.is_none());
                let failure = failure.map(|failure| match check.doubt.map(scientific) {
                    Some(doubt) => Failure {
                        message: format!(
                            "{}; in doubt, each distance may be off by up to {doubt}",
                            failure.message
                        ),
                        ..failure
                    },
                    None => failure,
                });
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
            goal: &self.plan.goal,
            pass,
            solves,
        }
    }

    fn unit_id(&self) -> UnitId {
        UnitId {
            group: self.plan.group.name.clone(),
            model: self.model.name.clone(),
            source: self.source.label(),
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

/// Maximum number of sources whose labels are checked. Each costs one run.
const MOST_SOURCES: usize = 100;

/// The environment of the runs.
struct RunContext<'s, 'l> {
    session: &'s mut dyn Session,
    log: &'s RunLog<'l>,
    checks: &'s Checks,
}

/// The state of the checks, shared by concurrent cells.
struct Checks {
    /// The reference, and the answers that differ from it.
    reference: Mutex<ReferenceCheck>,
    nearest: Mutex<Nearest>,
}

/// The nearest sources of every vertex.
#[derive(Default)]
enum Nearest {
    /// No run has returned labels yet.
    #[default]
    NotSought,
    /// Labels are not checked.
    Unknown,
    Known(NearestSources),
}

/// A signal stopped the runs.
#[derive(Debug, thiserror::Error)]
#[error("interrupted")]
struct Interrupted;

/// Turns [`Interrupted`] into success, because an interruption is not an error.
fn stopped_or(done: anyhow::Result<()>) -> anyhow::Result<()> {
    match done {
        Err(error) if error.is::<Interrupted>() => Ok(()),
        done => done,
    }
}

impl<'s> RunContext<'s, '_> {
    fn check(&self) -> MutexGuard<'s, ReferenceCheck> {
        lock(&self.checks.reference)
    }

    /// Executes a run.
    ///
    /// # Errors
    ///
    /// The outer error: a signal arrived before the run, or a signal arrived and the run failed.
    /// The inner result is that of the run.
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

    /// Executes a run that no cell counts.
    ///
    /// # Errors
    ///
    /// As [`execute`](Self::execute).
    fn execute_unplanned(
        &mut self,
        step: &Step<'_>,
    ) -> Result<Result<Observation, Failure>, Interrupted> {
        self.log.listener().more(1);
        self.execute(step)
    }
}
