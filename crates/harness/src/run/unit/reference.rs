//! The reference answer of a unit: by a proof, from a file or by a run.

use std::path::Path;

use geobench_registry::Selection;

use crate::exec::expected::Expected;
use crate::exec::{Failure, Pass};
use crate::measure::number::grouped;
use crate::plan::{MOST_FACES_UNASKED, Reference};
use crate::run::cell_runs::CellRuns;
use crate::run::context::RunContext;
use crate::run::journal::{Journal, JournalLine};
use crate::run::proof::Decision;
use crate::run::reference_check::Answer;
use crate::run::unit::dispute::prove;
use crate::run::unit::outcome::{check_and_keep, judge};
use crate::run::unit::plan::UnitPlan;
use crate::schema::ModelRecord;

/// Executes the runs that the checks need before those of the cells. Returns the index of the cell
/// whose first warm-up was one of them.
pub(super) fn prepare(
    unit: &UnitPlan<'_>,
    cells: &mut [CellRuns<'_>],
    context: &mut RunContext<'_, '_>,
) -> anyhow::Result<Option<usize>> {
    restore_clusters(unit, cells, context)?;
    find_reference(unit, cells, context)
}

/// Repeats one run of each cluster that differed from the reference before an interruption. The
/// journal does not store answers, and later answers are compared with them.
fn restore_clusters(
    unit: &UnitPlan<'_>,
    cells: &[CellRuns<'_>],
    context: &mut RunContext<'_, '_>,
) -> anyhow::Result<()> {
    let mut restored = Vec::new();
    for cell in cells {
        let Some(cluster) = cell.odd_cluster() else {
            continue;
        };
        if !restored.contains(&cluster) {
            restored.push(cluster);
            let done = context.execute_unplanned(&unit.as_step(cell.algorithm, Pass::Warmup, 1))?;
            let answer = done.ok().map(|observation| observation.distances);
            context.check().clusters.restore(cluster, answer);
        }
    }
    Ok(())
}

/// Determines the reference answer, by a proof, from a file or by a run. Returns the index of the
/// cell whose first warm-up the run was.
fn find_reference(
    unit: &UnitPlan<'_>,
    cells: &mut [CellRuns<'_>],
    context: &mut RunContext<'_, '_>,
) -> anyhow::Result<Option<usize>> {
    let decision = context.check().decision.clone();
    match decision {
        Some(Decision::Replaced { .. }) => {
            let proven = prove(unit, context)?;
            let mut check = context.check();
            match proven {
                Ok(proven) => check.answer = Some(proven),
                Err(why) => check.unchecked = Some(why),
            }
            return Ok(None);
        }
        Some(Decision::Unrefuted(_)) => {
            let bounds = prove(unit, context)?.ok();
            context.check().bounds = bounds;
        }
        _ => {}
    }
    match &unit.reference {
        Reference::None => {}
        Reference::Files(files) => read_reference(unit, files, context),
        Reference::Unasked(_) if unit.model.faces > Some(MOST_FACES_UNASKED) => {
            context.check().unchecked = Some(format!(
                "the model has more than {} faces; --check mmp-fast compares its distances",
                grouped(MOST_FACES_UNASKED)
            ));
        }
        Reference::Algorithm(reference) | Reference::Unasked(reference) => {
            return run_reference(unit, reference, cells, context);
        }
    }
    Ok(None)
}

/// Runs the reference, unless the journal has its failure. If it is an algorithm of the plan, the
/// run counts as its first warm-up, and the index of its cell is returned.
fn run_reference(
    unit: &UnitPlan<'_>,
    reference: &Selection,
    cells: &mut [CellRuns<'_>],
    context: &mut RunContext<'_, '_>,
) -> anyhow::Result<Option<usize>> {
    let run = unit.run_id(reference, Pass::Warmup, 0);
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
    let lacks = |cell: &&mut CellRuns<'_>| cell.lacks(Pass::Warmup, 0);
    if !unit.is_planned(Pass::Warmup, 0) || !cell.as_ref().is_some_and(lacks) {
        context.log.listener().more(1);
    }
    let done = context.execute(&unit.as_step(reference, Pass::Warmup, 1))?;
    match &done {
        Ok(observation) => {
            context.check().answer = Some(Answer::of(reference.label(), &observation.distances));
        }
        Err(failure) => context.check().unchecked = failed(failure),
    }
    let Some(cell) = cell else {
        // The reference is not an algorithm of the plan. Its outcome goes to the journal, so that a
        // failure is not repeated.
        let found = judge(unit, reference, done, &mut context.check());
        context.log.keep(JournalLine::Run { id: run, found })?;
        return Ok(None);
    };
    // Otherwise the cell has all timed runs or has failed. The answer serves only the checks.
    if cell.lacks(Pass::Warmup, 0) {
        check_and_keep(unit, cell, Pass::Warmup, 0, done, context)?;
    }
    Ok(Some(cell.index))
}

/// Reads the reference answer from a file.
fn read_reference(unit: &UnitPlan<'_>, files: &Expected, context: &RunContext<'_, '_>) {
    let vertices = unit.model.vertex_count();
    let ModelRecord { path, weld, .. } = unit.model;
    let found = files.find(Path::new(path), *weld, &unit.source.label(), vertices);
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
