//! The check of labels, which name the nearest source of each vertex.

use crate::exec::source::SourceSpec;
use crate::exec::{Failure, Pass, Step};
use crate::lock::lock;
use crate::run::context::{Interrupted, Nearest, RunContext};
use crate::run::journal::RunOutcome;
use crate::run::labels::NearestSources;
use crate::run::unit::plan::UnitPlan;
use crate::schema::Status;

/// Maximum number of sources whose labels are checked. Each costs one run.
const MOST_SOURCES: usize = 100;

/// Checks that each label names a nearest source of its vertex. The nearest sources come from one
/// run of the reference per source, executed when the first labels arrive.
pub(super) fn judge_labels(
    unit: &UnitPlan<'_>,
    labels: &[u32],
    outcome: &mut RunOutcome,
    context: &mut RunContext<'_, '_>,
) -> Result<(), Interrupted> {
    let checks = context.checks;
    let mut nearest = lock(&checks.nearest);
    if matches!(*nearest, Nearest::NotSought) {
        let found = find_nearest(unit, context)?;
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
    unit: &UnitPlan<'_>,
    context: &mut RunContext<'_, '_>,
) -> Result<Option<NearestSources>, Interrupted> {
    let Some(reference) = unit.reference.algorithm() else {
        return Ok(None);
    };
    let vertices = unit.model.vertex_count();
    let Ok(points) = unit.source.points(vertices) else {
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
            ..unit.as_step(reference, Pass::Warmup, 1)
        };
        let done = context.execute_unplanned(&step)?;
        let check = context.check();
        let (Ok(done), Some(answer)) = (done, &check.answer) else {
            return Ok(None);
        };
        let rule = check.scale.rule(unit.plan.tolerance);
        nearest.add(i, &done.distances, &answer.distances, &rule);
    }
    Ok(Some(nearest))
}
