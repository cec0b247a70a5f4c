//! The order of the runs of a unit.

use std::slice;
use std::sync::Mutex;

use crate::exec::{Failure, Pass, Refusal, Session};
use crate::lock::lock;
use crate::run::cell_runs::CellRuns;
use crate::run::context::{Checks, Interrupted, RunContext};
use crate::run::each::each;
use crate::run::journal::RunOutcome;
use crate::run::log::RunLog;
use crate::run::unit::outcome::{check_and_keep, keep};
use crate::run::unit::plan::UnitPlan;
use crate::run::unit::reference::prepare;

/// Executes the missing runs of these cells, interleaved. The cell with index `warmed` has had its
/// first warm-up.
pub(super) fn make_runs(
    unit: &UnitPlan<'_>,
    cells: &mut [CellRuns<'_>],
    warmed: Option<usize>,
    context: &mut RunContext<'_, '_>,
) -> anyhow::Result<()> {
    for round in 0..unit.plan.warmup {
        for cell in &mut *cells {
            if round > 0 || warmed != Some(cell.index) {
                step(unit, cell, Pass::Warmup, round, context)?;
            }
        }
    }
    for round in 0..unit.plan.sampling.most() {
        if !cells.iter().any(CellRuns::wants_time) {
            break;
        }
        for index in unit.order.round(round) {
            if let Some(cell) = cells.iter_mut().find(|cell| cell.index == index) {
                step(unit, cell, Pass::Time, round, context)?;
            }
        }
    }
    // Profile precedes Count: the storage of the counters fragments the heap, and the peak memory
    // of a later run could not be measured.
    for pass in [Pass::Profile, Pass::Count] {
        for cell in &mut *cells {
            step(unit, cell, pass, 0, context)?;
        }
    }
    Ok(())
}

/// Executes a run, unless it is done, its cell has enough timed runs, or its cell has failed.
fn step(
    unit: &UnitPlan<'_>,
    cell: &mut CellRuns<'_>,
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
    if !unit.is_planned(pass, round) {
        context.log.listener().more(1);
    }
    let done = context.execute(&unit.as_step(cell.algorithm, pass, solves))?;
    check_and_keep(unit, cell, pass, round, done, context)
}

/// Executes the missing runs of concurrent cells. `open` opens a session of the model.
pub(super) fn make_runs_of_cells<'s>(
    unit: &UnitPlan<'_>,
    cells: &mut [CellRuns<'_>],
    first: Option<Box<dyn Session + 's>>,
    open: &(dyn Fn() -> Result<Box<dyn Session + 's>, Refusal> + Sync),
    log: &RunLog<'_>,
    checks: &Checks,
) -> anyhow::Result<()> {
    let mut session = match first.map_or_else(open, Ok) {
        Ok(session) => session,
        Err(refusal) => return refuse(unit, cells, &refusal, log),
    };
    let mut context = RunContext {
        session: &mut *session,
        log,
        checks,
    };
    let warmed = prepare(unit, cells, &mut context)?;
    // The session of the reference run continues with the cell that it warmed up, or else with the
    // first cell.
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
                make_runs(unit, cell, warmed, &mut context)
            }
            Err(refusal) => refuse(unit, cell, &refusal, log),
        }
    })
}

/// Marks incomplete cells as refused, after a session of their model could not be opened.
fn refuse(
    unit: &UnitPlan<'_>,
    cells: &mut [CellRuns<'_>],
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
        keep(unit, cell, Pass::Warmup, 0, outcome, log)?;
    }
    Ok(())
}
