//! Answers that differ from the reference: the scale of the rule of right distances, and a proof
//! that decides which are right.

use geobench_registry::{self as registry, Selection};

use crate::exec::Pass;
use crate::run::context::{Interrupted, RunContext};
use crate::run::journal::JournalLine;
use crate::run::proof::{self, Decision};
use crate::run::reference_check::{Answer, ReferenceCheck};
use crate::run::unit::plan::UnitPlan;

/// Finds what the judgement of an answer needs: the scale of the reference where they differ, and a
/// proof where they still do.
pub(super) fn settle(
    unit: &UnitPlan<'_>,
    algorithm: &Selection,
    distances: &[f64],
    context: &mut RunContext<'_, '_>,
) -> anyhow::Result<()> {
    // Other cells wait, since they may need the same.
    let mut check = context.check();
    let tolerance = algorithm.tolerance(unit.plan.tolerance);
    if algorithm.may_differ() || !check.is_disputed(distances, algorithm, tolerance) {
        return Ok(());
    }
    find_scale(unit, &mut check, distances, tolerance, context)?;
    if check.decision.is_none() && check.is_disputed(distances, algorithm, tolerance) {
        let decision = decide(unit, &mut check, context)?;
        context.log.keep(JournalLine::Decision {
            id: unit.unit_id(),
            found: decision.clone(),
        })?;
        check.decision = Some(decision);
    }
    Ok(())
}

/// Finds the scale of the reference, if the comparison with `distances` depends on it.
fn find_scale(
    unit: &UnitPlan<'_>,
    check: &mut ReferenceCheck,
    distances: &[f64],
    tolerance: f64,
    context: &mut RunContext<'_, '_>,
) -> Result<(), Interrupted> {
    let is_named = |name: &str| check.answer.as_ref().is_some_and(|a| a.name == name);
    let certificate = registry::certificate(unit.plan.tolerance);
    let [_, greatest] = registry::proven_bounds();
    let algorithm = match unit.reference.algorithm() {
        Some(reference) if is_named(reference.label()) => reference,
        _ if is_named(proof::BOUNDS) => &greatest,
        // It takes the place of a refuted reference. A file is not run.
        _ => &certificate,
    };
    let step = unit.as_step(algorithm, Pass::Warmup, 1);
    check.find_scale(distances, tolerance, context.session, &step);
    if context.log.interrupted() {
        return Err(Interrupted);
    }
    Ok(())
}

/// Decides by a proof whether the reference is right. If it is not, the proven distances or bounds
/// take its place.
fn decide(
    unit: &UnitPlan<'_>,
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
    if let Some(why) = proof::too_large(unit.model.faces) {
        return Ok(Decision::Undecided(why));
    }
    let proven = match prove(unit, context)? {
        Ok(proven) => proven,
        Err(why) => return Ok(Decision::Undecided(why)),
    };
    let found = check
        .answer
        .as_ref()
        .map(|answer| answer.completed_by(&proven));
    let why = proven.bounds.as_ref().map(|bounds| bounds.why.clone());
    let answer = check.answer.replace(proven);
    let scale = std::mem::take(&mut check.scale);
    let tolerance = unit.plan.tolerance;
    if let (Some(found), Some(reference)) = (&found, &reference) {
        find_scale(unit, check, found, tolerance, context)?;
        if !check.differs(found, tolerance) {
            check.scale = scale;
            let proven = std::mem::replace(&mut check.answer, answer);
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

/// Proven distances or bounds, or why there are none.
pub(super) fn prove(
    unit: &UnitPlan<'_>,
    context: &mut RunContext<'_, '_>,
) -> Result<Result<Answer, String>, Interrupted> {
    Answer::proven(unit.plan.tolerance, |algorithm| {
        context.execute_unplanned(&unit.as_step(algorithm, Pass::Warmup, 1))
    })
}
