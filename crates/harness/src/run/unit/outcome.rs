//! Judges the answers of runs and keeps their outcomes.

use geobench_registry::Selection;
use geobench_window::precision;

use crate::exec::{Failure, Observation, Pass};
use crate::measure::number::scientific;
use crate::run::cell_runs::{CellRuns, summary};
use crate::run::context::RunContext;
use crate::run::journal::{JournalLine, RunOutcome};
use crate::run::log::RunLog;
use crate::run::reference_check::ReferenceCheck;
use crate::run::unit::dispute::settle;
use crate::run::unit::label_check::judge_labels;
use crate::run::unit::plan::UnitPlan;

/// Checks the answer of a run, writes the outcome to the journal and adds it to its cell.
pub(super) fn check_and_keep(
    unit: &UnitPlan<'_>,
    cell: &mut CellRuns<'_>,
    pass: Pass,
    round: usize,
    done: Result<Observation, Failure>,
    context: &mut RunContext<'_, '_>,
) -> anyhow::Result<()> {
    let mut done = done;
    let labels = done.as_mut().ok().and_then(|done| done.labels.take());
    if let Ok(found) = &done {
        settle(unit, cell.algorithm, &found.distances, context)?;
    }
    let mut outcome = judge(unit, cell.algorithm, done, &mut context.check());
    if let Some(labels) = labels.filter(|_| outcome.failure.is_none()) {
        judge_labels(unit, &labels, &mut outcome, context)?;
    }
    if pass == Pass::Time {
        outcome.place = unit.position(round, cell.index);
    }
    keep(unit, cell, pass, round, outcome, context.log)
}

/// The outcome of a run: its answer compared with the reference, or its failure.
pub(super) fn judge(
    unit: &UnitPlan<'_>,
    algorithm: &Selection,
    done: Result<Observation, Failure>,
    reference_check: &mut ReferenceCheck,
) -> RunOutcome {
    match done {
        Ok(mut observation) => {
            let distances = std::mem::take(&mut observation.distances);
            let (mut check, failure) =
                reference_check.judge(&distances, algorithm, unit.plan.tolerance);
            check.doubt = (unit.model.longest_edge)
                .and_then(|longest| precision::doubtful_by(longest, &distances));
            // An answer without a proven bound may differ by any finite amount.
            let failure = failure.filter(|_| !algorithm.may_differ() || check.max_rel.is_none());
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

/// Writes the outcome of a run to the journal and adds it to its cell.
pub(super) fn keep(
    unit: &UnitPlan<'_>,
    cell: &mut CellRuns<'_>,
    pass: Pass,
    round: usize,
    outcome: RunOutcome,
    log: &RunLog<'_>,
) -> anyhow::Result<()> {
    log.keep(JournalLine::Run {
        id: unit.run_id(cell.algorithm, pass, round),
        found: outcome.clone(),
    })?;
    let step = unit.as_step(cell.algorithm, pass, 1);
    log.listener().ran(&step, summary(&outcome));
    cell.made += usize::from(unit.is_planned(pass, round));
    cell.add(pass, round, outcome);
    if pass == Pass::Time {
        cell.count_samples();
    }
    Ok(())
}
