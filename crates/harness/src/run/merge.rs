//! Merges the result files of the shards of one benchmark. Shards may run on different machines, or
//! one after the other. Messages call a shard a *part*.
//!
//! Cells are merged in the order of an unsplit run: by group, model, source and algorithm. The file
//! of a shard has the whole plan, which determines the cells of the shard. Missing and interrupted
//! shards are therefore detected and named.

use anyhow::{anyhow, bail};
use serde_json::json;

use crate::exec::source::SourceSpec;
use crate::measure::conditions;
use crate::schema::difference::first_difference;
use crate::schema::{
    Cell, GroupRecord, ModelRecord, PlanRecord, PlannedGroup, ResultFile, Shard, SourceLabel,
    changed_program,
};

/// Maximum number of missing parts that a message names.
const MOST_NAMED: usize = 20;

/// The file of one shard.
struct ShardFile {
    name: String,
    /// The file, without its plan and cells.
    file: ResultFile,
    plan: PlanRecord,
    shard: Shard,
    /// The cells that are not merged yet, in reverse order.
    cells: Vec<Cell>,
}

impl ShardFile {
    /// The error that this part belongs to another benchmark than `first`.
    fn differs_from(&self, first: &Self, difference: &str) -> anyhow::Error {
        anyhow!(
            "{}: not a part of the same benchmark as {}: {difference}",
            self.name,
            first.name
        )
    }
}

/// Merges `parts`, the files of all shards of a benchmark, each with its name. Their order is
/// irrelevant.
///
/// # Errors
///
/// If a file is not of a shard, if a shard is missing, incomplete or given twice, or if the shards
/// differ in program, plan or models.
pub fn merge(parts: Vec<(String, ResultFile)>) -> anyhow::Result<ResultFile> {
    let mut parts = parts
        .into_iter()
        .map(|(name, file)| part(name, file))
        .collect::<Result<Vec<_>, _>>()?;
    parts.sort_by_key(|part| part.shard.index);
    check_together(&parts)?;
    let Some(first) = parts.first() else {
        bail!("there are no parts to join");
    };
    let mut whole = first.file.clone();
    let mut plan = first.plan.clone();
    plan.shard = None;
    whole.cells = cells(&plan, &mut parts)?;
    for ShardFile { name, cells, .. } in &parts {
        if let Some(Cell {
            algorithm, model, ..
        }) = cells.last()
        {
            bail!(
                "{name}: has cells that its part of the plan does not have, such as {algorithm} of {model}"
            );
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

/// Whether all sessions of `file` ran on one machine, as far as the records tell.
pub fn is_of_one_machine(file: &ResultFile) -> bool {
    let mut pairs = file.sessions.windows(2);
    pairs.all(|pair| pair[0].host.is_same_machine(&pair[1].host))
}

/// Takes the plan and the cells out of the file of a shard.
///
/// # Errors
///
/// If the file is not of a shard.
fn part(name: String, mut file: ResultFile) -> anyhow::Result<ShardFile> {
    let plan = file.plan.take();
    let whole = |shard: &Shard| (1..=shard.count).contains(&shard.index);
    let (Some(plan), Some(shard)) = (plan.clone(), plan.and_then(|p| p.shard).filter(whole)) else {
        bail!("{name}: not a part of a benchmark: it was made without --shard");
    };
    let mut cells = std::mem::take(&mut file.cells);
    cells.reverse();
    Ok(ShardFile {
        name,
        file,
        plan,
        shard,
        cells,
    })
}

/// Checks that `parts`, sorted by index, are the shards of one benchmark, each exactly once.
fn check_together(parts: &[ShardFile]) -> anyhow::Result<()> {
    for pair in parts.windows(2) {
        let (first, part) = (&parts[0], &pair[1]);
        if let Some(difference) = differs(first, part) {
            return Err(part.differs_from(first, &difference));
        }
        if pair[0].shard == part.shard {
            bail!(
                "{}: holds part {}, as does {}; give each part once",
                part.name,
                part.shard,
                pair[0].name
            );
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
    bail!(
        "of {count} parts, {} {verb} missing; give the files of all parts",
        missing.join(", ")
    );
}

/// The first difference between the benchmarks of `first` and `part`.
fn differs(first: &ShardFile, part: &ShardFile) -> Option<String> {
    if first.shard.count != part.shard.count {
        return Some(format!(
            "there are {} parts and not {}",
            part.shard.count, first.shard.count
        ));
    }
    let identity = |part: &ShardFile| {
        let plan = PlanRecord {
            shard: None,
            ..part.plan.clone()
        };
        json!({"tool": part.file.tool, "plan": plan})
    };
    if let Some(found) = first_difference(&identity(first), &identity(part)) {
        return Some(format!(
            "`{}` is {} and not {}",
            found.place, found.right, found.left
        ));
    }
    changed_program(first.file.programs(), part.file.programs())
}

/// Moves the cells out of all parts, in the order of the plan.
fn cells(plan: &PlanRecord, parts: &mut [ShardFile]) -> anyhow::Result<Vec<Cell>> {
    let mut all = Vec::new();
    let mut first_unit = 0_u128;
    let records = parts.first().map(|part| part.file.groups.clone());
    for group in &plan.groups {
        let record = records
            .iter()
            .flatten()
            .find(|record| record.name == group.name);
        let record = record.cloned().unwrap_or_default();
        let spec = group.sources.parse::<SourceSpec>().ok();
        let spec = spec.filter(|_| !group.sources_together);
        let planned = spec.as_ref().map_or(1, |spec| spec.count() as u128);
        for model in &group.models {
            let sources = match &spec {
                Some(spec) => units_of_model(spec, &model.name, parts),
                None => planned,
            };
            // A part that refused the model and does not know its sources has one cell for each
            // algorithm. Of several such parts the first counts.
            let mut refusing = Vec::new();
            for part in &mut *parts {
                if let Some(cells) = next_unit(group, &record, &model.name, part, Option::is_none) {
                    if refusing.is_empty() {
                        all.extend(cells);
                    }
                    refusing.push(part.shard.index);
                }
            }
            for source in 0..sources {
                let unit = first_unit + source;
                let holder = parts.iter_mut().find(|part| part.shard.holds(unit));
                let Some(part) = holder else { continue };
                if refusing.contains(&part.shard.index) {
                    continue;
                }
                if let Some(cells) = next_unit(group, &record, &model.name, part, Option::is_some) {
                    all.extend(cells);
                } else {
                    bail!(
                        "{}: has no cells of {}, source {} of {sources}; it was interrupted, so run it again to its end",
                        part.name,
                        model.name,
                        source + 1
                    );
                }
            }
            first_unit += planned;
        }
    }
    Ok(all)
}

/// Number of sources in a model. Each counts once, also if several forms name it, and `all` stands
/// for all vertices, so the number depends on the vertices in the record of the model. A model that
/// was refused has no such number; if the sources include `all`, it has one unit.
fn units_of_model(spec: &SourceSpec, model: &str, parts: &[ShardFile]) -> u128 {
    let models = parts.iter().flat_map(|part| &part.file.models);
    let mut known = models.filter(|record| record.name == model && record.vertices.is_some());
    let of_model = |record: &ModelRecord| {
        let spec = spec.with_largest(|| record.first_of_largest());
        spec.points(record.vertex_count()).ok()
    };
    let points = known.next().and_then(of_model);
    let unknown = if spec.has_all() { 1 } else { spec.count() };
    points.map_or(unknown, |points| points.len()) as u128
}

/// Takes the next cells of `part`, one for each algorithm that runs on the model. `None` if they
/// are not cells of this group and model with one source that `is_wanted`, in the order of the
/// plan; then nothing is taken.
fn next_unit(
    group: &PlannedGroup,
    record: &GroupRecord,
    model: &str,
    part: &mut ShardFile,
    is_wanted: fn(&Option<SourceLabel>) -> bool,
) -> Option<Vec<Cell>> {
    let source = part.cells.last()?.source.clone();
    let known = part.file.models.iter().find(|known| known.name == model);
    let left_out = known.map_or(&[][..], |known| record.left_out_of(known));
    let algorithms = group.algorithms.iter();
    let algorithms = algorithms.filter(|algorithm| !left_out.contains(&algorithm.label));
    let start = part.cells.len().checked_sub(algorithms.clone().count())?;
    let next = part.cells[start..].iter().rev();
    let mut pairs = next.zip(algorithms);
    let fits = is_wanted(&source)
        && pairs.all(|(cell, algorithm)| {
            cell.group == group.name
                && cell.model == model
                && cell.source == source
                && cell.algorithm == algorithm.label
        });
    fits.then(|| part.cells.drain(start..).rev().collect())
}

/// The records of the models of all parts, in the order of the plan, each once.
fn models(plan: &PlanRecord, parts: &[ShardFile]) -> anyhow::Result<Vec<ModelRecord>> {
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
        // A part that refused the model does not know its hash.
        let mut loaded = holders
            .clone()
            .filter_map(|(part, model)| Some((part, model, model.sha256.as_ref()?)));
        let Some((first, model, here)) = loaded.next() else {
            models.extend(holders.next().map(|(_, model)| model.clone()));
            continue;
        };
        if let Some((part, _, there)) = loaded.find(|(.., there)| *there != here) {
            let difference = format!("the SHA-256 of {name} is `{there}` and not `{here}`");
            return Err(part.differs_from(first, &difference));
        }
        let mut model = model.clone();
        // A part without cells of a group has no note on algorithms that the group left out.
        model.add_notes(holders.flat_map(|(_, model)| model.notes.clone()));
        models.push(model);
    }
    Ok(models)
}

/// The earliest or latest time of all parts. RFC 3339 times in UTC sort as text.
fn extreme(
    parts: &[ShardFile],
    of: fn(&ResultFile) -> &String,
    choose: fn(String, String) -> String,
) -> String {
    let times = parts.iter().map(|part| of(&part.file).clone());
    times.reduce(choose).unwrap_or_default()
}
