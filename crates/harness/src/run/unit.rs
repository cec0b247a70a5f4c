//! The cells of one model and one source.
//!
//! `plan` is what they share. `runs` executes their runs in order, after `reference` has found the
//! reference answer. `outcome` judges each answer: where it differs from the reference, `dispute`
//! finds who is right; `label_check` checks labels.

mod dispute;
mod label_check;
mod outcome;
mod plan;
mod reference;
mod runs;

use geobench_registry::Selection;

use crate::exec::model::ModelRef;
use crate::exec::source::SourceSpec;
use crate::exec::{Backend, Pass, Session};
use crate::lock::lock;
use crate::plan::Plan;
use crate::run::agreement;
use crate::run::cell_runs::CellRuns;
use crate::run::context::{RunContext, stopped_or};
use crate::run::earlier::{self, Earlier};
use crate::run::journal::{Journal, RunId};
use crate::run::log::RunLog;
use crate::run::order::RunOrder;
use crate::run::proof::Decision;
use crate::run::unit::plan::UnitPlan;
use crate::run::unit::reference::prepare;
use crate::run::unit::runs::{make_runs, make_runs_of_cells};
use crate::schema::{Cell, ModelRecord};

/// The cells of one model and source. Unless several cells run concurrently, their runs are
/// interleaved, so that a drift of clock frequency or temperature affects all algorithms alike.
pub(crate) struct Unit<'p> {
    plan: UnitPlan<'p>,
    /// One for each algorithm that runs on the model, in the order of the plan.
    cells: Vec<CellRuns<'p>>,
    /// What a proof has decided about disagreeing answers.
    decision: Option<Decision>,
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
            let done = prepare(&self.plan, &mut self.cells, &mut context)
                .and_then(|warmed| make_runs(&self.plan, &mut self.cells, warmed, &mut context));
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
            let done = make_runs_of_cells(
                &self.plan,
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
