//! The order of the runs of a unit, and how their answers are checked.

use std::path::Path;
use std::slice;
use std::sync::Mutex;

use geobench_registry::{self as registry, Selection};
use geobench_window::precision;

use crate::exec::expected::Expected;
use crate::exec::source::SourceSpec;
use crate::exec::{Failure, Observation, Pass, Refusal, Session, Step};
use crate::lock::lock;
use crate::measure::number::{grouped, scientific};
use crate::plan::{MOST_FACES_UNASKED, Plan, Reference};
use crate::run::answer_layout::AnswerLayout;
use crate::run::cell_runs::{CellRuns, summary};
use crate::run::context::{Checks, Interrupted, Nearest, RunContext};
use crate::run::each::each;
use crate::run::journal::{Journal, JournalLine, RunId, RunOutcome, UnitId};
use crate::run::labels::NearestSources;
use crate::run::log::RunLog;
use crate::run::order::RunOrder;
use crate::run::proof::{self, Decision};
use crate::run::reference_check::{Answer, ReferenceCheck};
use crate::schema::{ModelRecord, Status};

/// Maximum number of sources whose labels are checked. Each costs one run.
const MOST_SOURCES: usize = 100;

/// The data shared by the cells of a unit.
pub(super) struct UnitPlan<'p> {
    pub(super) plan: &'p Plan,
    pub(super) model: &'p ModelRecord,
    /// The source, or several sources together.
    pub(super) source: SourceSpec,
    /// The reference for this model.
    pub(super) reference: Reference,
    pub(super) order: RunOrder,
    pub(super) is_interleaved: bool,
}

impl<'p> UnitPlan<'p> {
    /// Executes the missing runs of concurrent cells.
    pub(super) fn make_runs_of_cells<'s>(
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
    pub(super) fn checks(&self, decision: Option<Decision>) -> Checks {
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
    pub(super) fn prepare(
        &self,
        cells: &mut [CellRuns<'p>],
        context: &mut RunContext<'_, '_>,
    ) -> anyhow::Result<Option<usize>> {
        self.restore_clusters(cells, context)?;
        self.find_reference(cells, context)
    }

    /// Executes the missing runs of these cells, interleaved. The cell with index `warmed` has had
    /// its first warm-up.
    pub(super) fn make_runs(
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
    pub(super) fn position(&self, round: usize, index: usize) -> Option<usize> {
        let position = self.order.position(round, index);
        position.filter(|_| self.is_interleaved)
    }

    /// Determines the reference answer, by a proof, from a file or by a run. Returns the index of
    /// the cell whose first warm-up the run was.
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
        match &self.reference {
            Reference::None => {}
            Reference::Files(files) => self.read_reference(files, context),
            Reference::Unasked(_) if self.model.faces > Some(MOST_FACES_UNASKED) => {
                context.check().unchecked = Some(format!(
                    "the model has more than {} faces; --check mmp-fast compares its distances",
                    grouped(MOST_FACES_UNASKED)
                ));
            }
            Reference::Algorithm(reference) | Reference::Unasked(reference) => {
                return self.run_reference(reference, cells, context);
            }
        }
        Ok(None)
    }

    /// Runs the reference, unless the journal has its failure. If it is an algorithm of the plan,
    /// the run counts as its first warm-up, and the index of its cell is returned.
    fn run_reference(
        &self,
        reference: &Selection,
        cells: &mut [CellRuns<'p>],
        context: &mut RunContext<'_, '_>,
    ) -> anyhow::Result<Option<usize>> {
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

    /// Reads the reference answer from a file.
    fn read_reference(&self, files: &Expected, context: &RunContext<'_, '_>) {
        let vertices = self.model.vertex_count();
        let ModelRecord { path, weld, .. } = self.model;
        let found = files.find(Path::new(path), *weld, &self.source.label(), vertices);
        let mut check = context.check();
        match found {
            Ok(field) => {
                let name = field.path.display().to_string();
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
            Err(error) => check.unchecked = Some(error.to_string()),
        }
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

    pub(super) fn as_step<'s>(
        &'s self,
        algorithm: &'s Selection,
        pass: Pass,
        solves: usize,
    ) -> Step<'s> {
        Step {
            model: &self.model.name,
            algorithm,
            source: &self.source,
            goal: &self.plan.goal,
            pass,
            solves,
        }
    }

    pub(super) fn unit_id(&self) -> UnitId {
        UnitId {
            group: self.plan.group.name.clone(),
            model: self.model.name.clone(),
            source: self.source.label(),
        }
    }

    pub(super) fn run_id(&self, algorithm: &Selection, pass: Pass, round: usize) -> RunId {
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
