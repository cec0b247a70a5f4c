//! Joining the parts of one benchmark that ran on different machines, or one after the other.
//!
//! The cells of the whole come in the order of the run that was not split: by group, model, source
//! and algorithm. Which part has which of them follows from the plan (`shard`), which every part
//! holds whole; so a part that is missing, or that was interrupted, is found and named.

use serde_json::json;

use crate::measure::conditions;
use crate::plan::source::SourceSpec;
use crate::schema::Shard;
use crate::schema::plan_record::{PlanRecord, PlannedGroup, first_difference};
use crate::schema::{Cell, ModelRecord, ResultFile};

/// Why parts cannot be joined.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MergeError {
    /// There is none.
    #[error("there are no parts to join")]
    Nothing,
    /// It was not made with `--shard`.
    #[error("{part}: not a part of a benchmark: it was made without --shard")]
    NotAPart {
        /// The file.
        part: String,
    },
    /// It is not of the benchmark that the first is of.
    #[error("{part}: not a part of the same benchmark as {first}: {difference}")]
    Differs {
        /// The first part.
        first: String,
        /// The one that differs from it.
        part: String,
        /// In what.
        difference: String,
    },
    /// Two files hold the same part.
    #[error("{part}: holds part {shard}, as does {first}; give each part once")]
    Twice {
        /// The first file.
        first: String,
        /// The second one.
        part: String,
        /// The part.
        shard: Shard,
    },
    /// Parts are missing.
    #[error("of {count} parts, {missing} missing; give the files of all parts")]
    Missing {
        /// How many there should be.
        count: u32,
        /// Which are not there, and the verb.
        missing: String,
    },
    /// A part does not have a cell that it should have.
    #[error("{part}: has no cells of {unit}; it was interrupted, so run it again to its end")]
    Incomplete {
        /// The file.
        part: String,
        /// The model and the source.
        unit: String,
    },
    /// A part has cells that are not its own.
    #[error("{part}: has cells that its part of the plan does not have, such as {cell}")]
    Surplus {
        /// The file.
        part: String,
        /// One of them.
        cell: String,
    },
}

/// Most missing parts that are named.
const MOST_NAMED: usize = 20;

/// A part on its way into the whole.
struct Part {
    name: String,
    file: ResultFile,
    shard: Shard,
    /// Its cells, the next one last.
    cells: Vec<Cell>,
}

/// Joins `parts`, each with the name of its file, in any order.
///
/// # Errors
///
/// When they are not all parts of one benchmark, each once and whole.
pub fn merge(parts: Vec<(String, ResultFile)>) -> Result<ResultFile, MergeError> {
    let mut parts = parts
        .into_iter()
        .map(|(name, file)| part(name, file))
        .collect::<Result<Vec<_>, _>>()?;
    parts.sort_by_key(|part| part.shard.index);
    check_together(&parts)?;
    let Some(first) = parts.first() else {
        return Err(MergeError::Nothing);
    };
    let mut whole = first.file.clone();
    let Some(mut plan) = whole.plan.take() else {
        return Err(MergeError::NotAPart {
            part: first.name.clone(),
        });
    };
    plan.shard = None;
    whole.cells = cells(&plan, &mut parts)?;
    for part in &parts {
        if let Some(cell) = part.cells.last() {
            return Err(MergeError::Surplus {
                part: part.name.clone(),
                cell: format!("{} of {}", cell.algorithm, cell.model),
            });
        }
    }
    whole.models = models(&plan, &parts)?;
    whole.started = extreme(&parts, |file| &file.started, Ord::min);
    whole.finished = extreme(&parts, |file| &file.finished, Ord::max);
    whole.conditions = conditions::worst(parts.iter().filter_map(|p| p.file.conditions.clone()));
    whole.sessions = parts.iter().flat_map(|p| p.file.sessions.clone()).collect();
    whole.plan = Some(plan);
    Ok(whole)
}

/// Whether all sessions of `file` ran on one machine, as far as can be told.
pub fn is_of_one_machine(file: &ResultFile) -> bool {
    let mut pairs = file.sessions.windows(2);
    pairs.all(|pair| pair[0].host.is_same_machine(&pair[1].host))
}

fn part(name: String, mut file: ResultFile) -> Result<Part, MergeError> {
    let shard = file.plan.as_ref().and_then(|plan| plan.shard);
    let Some(shard) = shard.filter(|shard| (1..=shard.count).contains(&shard.index)) else {
        return Err(MergeError::NotAPart { part: name });
    };
    let mut cells = std::mem::take(&mut file.cells);
    cells.reverse();
    Ok(Part {
        name,
        file,
        shard,
        cells,
    })
}

/// Makes sure that the parts, which are sorted, are those of one benchmark, each once.
fn check_together(parts: &[Part]) -> Result<(), MergeError> {
    for pair in parts.windows(2) {
        let (first, part) = (&parts[0], &pair[1]);
        if let Some(difference) = differs(first, part) {
            return Err(MergeError::Differs {
                first: first.name.clone(),
                part: part.name.clone(),
                difference,
            });
        }
        if pair[0].shard == part.shard {
            return Err(MergeError::Twice {
                first: pair[0].name.clone(),
                part: part.name.clone(),
                shard: part.shard,
            });
        }
    }
    let count = parts.first().map_or(0, |part| part.shard.count);
    let missing: Vec<String> = (1..=count)
        .filter(|index| parts.iter().all(|part| part.shard.index != *index))
        .map(|index| index.to_string())
        .take(MOST_NAMED)
        .collect();
    if missing.is_empty() {
        return Ok(());
    }
    let verb = if missing.len() == 1 { "is" } else { "are" };
    Err(MergeError::Missing {
        count,
        missing: format!("{} {verb}", missing.join(", ")),
    })
}

/// In what `part` is not of the benchmark that `first` is of.
fn differs(first: &Part, part: &Part) -> Option<String> {
    if first.shard.count != part.shard.count {
        return Some(format!(
            "there are {} parts and not {}",
            part.shard.count, first.shard.count
        ));
    }
    let identity = |part: &Part| {
        let plan = part.file.plan.clone();
        let plan = plan.map(|plan| PlanRecord {
            shard: None,
            ..plan
        });
        json!({"tool": part.file.tool, "plan": plan})
    };
    let found = first_difference(&identity(first), &identity(part))?;
    Some(format!(
        "`{}` is {} and not {}",
        found.place, found.right, found.left
    ))
}

/// The cells of all parts in the order of the plan.
fn cells(plan: &PlanRecord, parts: &mut [Part]) -> Result<Vec<Cell>, MergeError> {
    let mut all = Vec::new();
    let mut first_unit = 0_u128;
    for group in &plan.groups {
        let sources = group
            .sources
            .parse()
            .map_or(1, |s: SourceSpec| s.count() as u128);
        for model in &group.models {
            for source in 0..sources {
                let unit = first_unit + source;
                let holder = parts.iter_mut().find(|part| part.shard.holds(unit));
                let Some(part) = holder else { continue };
                let taken = take_unit(group, &model.name, part, &mut all);
                // Random sources of a model that was refused have one cell together, the first.
                if taken == Some(Taken::AllSources) {
                    break;
                }
                if taken.is_none() {
                    return Err(MergeError::Incomplete {
                        part: part.name.clone(),
                        unit: format!("{}, source {} of {sources}", model.name, source + 1),
                    });
                }
            }
            first_unit += sources;
        }
    }
    Ok(all)
}

/// What the next cells of a part stand for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Taken {
    OneSource,
    AllSources,
}

/// Moves the cells of a model and one source, if they come next; there is one for each algorithm.
fn take_unit(
    group: &PlannedGroup,
    model: &str,
    part: &mut Part,
    all: &mut Vec<Cell>,
) -> Option<Taken> {
    let source = part.cells.last()?.source;
    let start = part.cells.len().checked_sub(group.algorithms.len())?;
    let next = part.cells[start..].iter().rev();
    let fits = next.zip(&group.algorithms).all(|(cell, algorithm)| {
        cell.group == group.name
            && cell.model == model
            && cell.source == source
            && cell.algorithm == algorithm.label
    });
    if !fits {
        return None;
    }
    all.extend(part.cells.drain(start..).rev());
    Some(match source {
        Some(_) => Taken::OneSource,
        None => Taken::AllSources,
    })
}

/// The models of all parts in the order of the plan, each once.
fn models(plan: &PlanRecord, parts: &[Part]) -> Result<Vec<ModelRecord>, MergeError> {
    let mut models: Vec<ModelRecord> = Vec::new();
    for name in plan
        .groups
        .iter()
        .flat_map(|group| &group.models)
        .map(|model| &model.name)
    {
        if models.iter().any(|model| model.name == *name) {
            continue;
        }
        let mut holders = parts.iter().filter_map(|part| {
            let found = part.file.models.iter().find(|model| model.name == *name);
            found.map(|model| (part, model))
        });
        let Some((first, model)) = holders.next() else {
            continue;
        };
        if let Some((part, other)) = holders.find(|(_, other)| other.sha256 != model.sha256) {
            let hash = |model: &ModelRecord| match &model.sha256 {
                Some(hash) => format!("`{hash}`"),
                None => "not known".to_owned(),
            };
            return Err(MergeError::Differs {
                first: first.name.clone(),
                part: part.name.clone(),
                difference: format!(
                    "the SHA-256 of {name} is {} and not {}",
                    hash(other),
                    hash(model)
                ),
            });
        }
        models.push(model.clone());
    }
    Ok(models)
}

/// The first or the last of the times of all parts, which sort as text.
fn extreme(
    parts: &[Part],
    of: fn(&ResultFile) -> &String,
    choose: fn(String, String) -> String,
) -> String {
    let times = parts.iter().map(|part| of(&part.file).clone());
    times.reduce(choose).unwrap_or_default()
}
