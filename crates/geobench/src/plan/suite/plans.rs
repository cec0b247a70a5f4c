//! From settings to plans.

use std::collections::HashMap;

use super::document::SuiteError;
use super::{ALGORITHMS, DEFAULT_SEED, Library, MODELS, Settings, Suite, WantedModel};
use crate::exec::limits::{Limits, Timeout};
use crate::exec::model::{self, ModelError, ModelRef};
use crate::plan::source::SourceSpec;
use crate::plan::{OneFileForMore, Plan, Reference};
use crate::registry::{self, Selection};
use crate::schema::GroupRecord;

/// What is to be run.
#[derive(Clone, Debug)]
pub struct Plans {
    /// One for each group, in order. A model has the same name in all of them.
    pub plans: Vec<Plan>,
    /// What is left out, and why, each in one line.
    pub notes: Vec<String>,
}

/// Why there is no plan.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// A model of the command line.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The suite file.
    #[error(transparent)]
    Suite(#[from] SuiteError),
    /// The reference.
    #[error(transparent)]
    Reference(#[from] OneFileForMore),
}

/// Which models a suite is run on, of those that it has to offer.
#[derive(Clone, Debug, Default)]
pub struct Scale {
    /// Whether in the sizes of the paper, not in those for a small machine.
    pub full: bool,
    /// The models that take the place of those that stand for them.
    pub library: Option<Library>,
}

/// The plans of `suite` in this `scale`, or a single one without it. What `asked` says holds for all
/// groups, whatever the suite says.
///
/// # Errors
///
/// When a model does not exist that must, or a group has nothing to compare with.
pub fn plans(suite: Option<&Suite>, asked: &Settings, scale: &Scale) -> Result<Plans, PlanError> {
    let mut done = Plans {
        plans: Vec::new(),
        notes: Vec::new(),
    };
    let Some(suite) = suite else {
        let models = match &asked.models {
            Some(models) => {
                let arguments: Vec<&str> = models.iter().map(|m| m.argument.as_str()).collect();
                model::collect(&arguments)?
            }
            None => model::collect(MODELS)?,
        };
        done.plans
            .push(plan(asked, models, GroupRecord::unnamed())?);
        return Ok(done);
    };
    for group in &suite.groups {
        let settings = if scale.full {
            asked.or(&group.full).or(&group.settings)
        } else {
            asked.or(&group.settings)
        };
        let fail = |line, problem: String| SuiteError {
            path: suite.path.clone(),
            line,
            problem,
        };
        let Some(wanted) = &settings.models else {
            let problem = format!("group `{}` has no models", group.name);
            return Err(fail(None, problem).into());
        };
        let mut models = Vec::new();
        for wanted in wanted {
            if let Some(library) = scale.library.as_ref().filter(|_| !wanted.real.is_empty()) {
                if let Some(real) = library.find(&wanted.real) {
                    models.push(real.subdivided(wanted.subdivide)?);
                    continue;
                }
                done.notes.push(format!(
                    "group `{}`: no model called {} is in {}; {} stands for it",
                    group.name,
                    wanted.real.join(" or "),
                    library.directory().display(),
                    wanted.argument
                ));
            }
            match find(wanted) {
                Ok(found) => models.extend(found),
                Err(ModelError::Missing { path, problem }) if wanted.optional => {
                    done.notes.push(format!(
                        "group `{}`: the optional model {path} is left out: {problem}",
                        group.name
                    ));
                }
                Err(error) if wanted.line.is_some() => {
                    return Err(fail(wanted.line, format!("`models`: {error}")).into());
                }
                Err(error) => return Err(error.into()),
            }
        }
        if models.is_empty() {
            done.notes.push(format!(
                "group `{}` is left out: none of its models is there",
                group.name
            ));
            continue;
        }
        let record = GroupRecord {
            name: Some(group.name.clone()),
            shows: group.shows.clone(),
            ..GroupRecord::unnamed()
        };
        done.plans.push(plan(&settings, models, record)?);
    }
    name_alike(&mut done.plans);
    Ok(done)
}

fn find(wanted: &WantedModel) -> Result<Vec<ModelRef>, ModelError> {
    model::collect(&[&wanted.argument])
}

/// Gives a model the same name in all plans, and different models different ones.
fn name_alike(plans: &mut [Plan]) {
    let mut all: Vec<ModelRef> = Vec::new();
    for model in plans.iter().flat_map(|plan| &plan.models) {
        if all.iter().all(|other| other.path != model.path) {
            all.push(model.clone());
        }
    }
    model::make_names_unique(&mut all);
    let names: HashMap<&str, &str> = all
        .iter()
        .map(|model| (model.path.as_str(), model.name.as_str()))
        .collect();
    for plan in plans {
        for model in &mut plan.models {
            names[model.path.as_str()].clone_into(&mut model.name);
        }
        // The same model twice in one group would be two columns of one name.
        let mut seen: Vec<String> = Vec::new();
        plan.models.retain(|model| {
            let new = !seen.contains(&model.name);
            seen.push(model.name.clone());
            new
        });
    }
}

fn plan(
    settings: &Settings,
    models: Vec<ModelRef>,
    group: GroupRecord,
) -> Result<Plan, OneFileForMore> {
    let threads = settings.threads.unwrap_or(1) as usize;
    let algorithms = settings.algorithms.clone().unwrap_or_else(usual);
    let algorithms: Vec<Selection> = algorithms
        .into_iter()
        .map(|algorithm| algorithm.with_threads(threads))
        .collect();
    let reference = match settings.reference.clone() {
        Some(Reference::Algorithm(one)) => Some(Reference::Algorithm(one.with_threads(threads))),
        other => other,
    };
    let plan = Plan {
        group: GroupRecord {
            rows: settings.rows.clone().unwrap_or_default(),
            ratios_to: settings.ratios_to.clone(),
            wavefront: settings.wavefront.unwrap_or(false),
            ..group
        },
        models,
        sources: settings.sources.clone().unwrap_or(SourceSpec::First),
        repeat: settings.repeat.unwrap_or(5) as usize,
        warmup: settings.warmup.unwrap_or(1) as usize,
        reference: reference.unwrap_or_else(|| Reference::usual(&algorithms)),
        tolerance: settings.tolerance.unwrap_or(1e-9),
        seed: settings.seed.unwrap_or(DEFAULT_SEED),
        share: None,
        limits: Limits {
            timeout: settings.timeout.unwrap_or(Timeout::USUAL),
            memory: settings.memory_limit.unwrap_or_default(),
            decompressed: settings.max_decompressed.unwrap_or_default(),
        },
        algorithms,
    };
    plan.check_reference()?;
    Ok(plan)
}

/// The algorithms that run where none are named.
fn usual() -> Vec<Selection> {
    let known = |name: &&&str| registry::algorithms().iter().any(|a| a.name == **name);
    let names: Vec<&str> = ALGORITHMS.iter().filter(known).copied().collect();
    registry::select(&names.join(",")).unwrap_or_default()
}
