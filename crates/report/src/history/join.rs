//! Joins result files of different runs on one machine.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use anyhow::{Context, bail};
use geobench_harness::measure::conditions;
use geobench_harness::schema::difference::first_difference;
use geobench_harness::schema::{
    Cell, CellId, GroupRecord, ModelRecord, ResultFile, SourceLabel, changed_program,
};
use serde_json::Value;

use crate::table::group::by_key;

/// A joined file.
#[derive(Clone, Debug)]
pub struct Joined {
    /// The file.
    pub file: ResultFile,
    /// What differs between the runs, one line each.
    pub notes: Vec<String>,
}

/// Joins `files`, each given with its name. If several files have a cell, the cell of the first is
/// kept.
///
/// # Errors
///
/// When `files` is empty, when the machines differ, when models of one name differ, or when the
/// goals of the runs of one group differ.
pub fn join(files: Vec<(String, ResultFile)>) -> anyhow::Result<Joined> {
    let mut rest = files.into_iter();
    let (first, file) = rest.next().context("there are no files to join")?;
    let mut joined = Joined {
        file,
        notes: Vec::new(),
    };
    for (name, file) in rest {
        check_machine(&joined.file, &first, &name, &file)?;
        let kept = add(&mut joined, &first, &name, file, Preferred::Joined)?;
        if kept > 0 {
            joined.notes.push(format!(
                "{name}: {kept} of its cells are also in earlier files, whose times are kept"
            ));
        }
    }
    Ok(joined)
}

/// Adds the cells of `new` to `earlier`, each given with the name of its file. If both files have a
/// cell, the new one is kept. `new` may come from another machine if all its times are already in
/// `earlier`.
///
/// # Errors
///
/// As [`join`].
pub fn extend(
    (earlier_name, earlier): (&str, ResultFile),
    (new_name, new): (&str, ResultFile),
) -> anyhow::Result<Joined> {
    let mut joined = Joined {
        file: earlier,
        notes: Vec::new(),
    };
    let mut known: HashMap<CellId, Vec<&Cell>> = HashMap::new();
    for cell in &joined.file.cells {
        known.entry(cell.id()).or_default().push(cell);
    }
    let is_timed_before = |cell: &Cell| {
        let known = known.get(&cell.id());
        known.is_some_and(|known| known.iter().any(|known| known.time == cell.time))
    };
    if !new.cells.iter().all(is_timed_before) {
        check_machine(&joined.file, earlier_name, new_name, &new)?;
    }
    add(&mut joined, earlier_name, new_name, new, Preferred::Added)?;
    Ok(joined)
}

/// All cells of `files`, each given with its name, for one table. If several files have a cell, the
/// name of the file is appended to its algorithm. Different machines cause a note.
///
/// # Errors
///
/// When `files` is empty, when models of one name differ, or when the goals of the runs of one
/// group differ.
pub fn beside(mut files: Vec<(String, ResultFile)>) -> anyhow::Result<Joined> {
    let mut names = Vec::new();
    for index in 1..files.len() {
        let (before, rest) = files.split_at_mut(index);
        let (name, file) = &mut rest[0];
        for (first, known) in before {
            rename_models(known, first, name, file)?;
        }
    }
    let mut holders: HashMap<CellId, usize> = HashMap::new();
    for (name, file) in &files {
        names.push(name.clone());
        for cell in &file.cells {
            *holders.entry(cell.id()).or_default() += 1;
        }
    }
    let stem = |name: &str| {
        let stem = Path::new(name).file_stem();
        stem.map_or_else(|| name.to_owned(), |s| s.to_string_lossy().into_owned())
    };
    let stems: Vec<String> = names.iter().map(|name| stem(name)).collect();
    for (index, (name, file)) in files.iter_mut().enumerate() {
        let is_unique = stems.iter().filter(|stem| **stem == stems[index]).count() == 1;
        let shown = if is_unique { &stems[index] } else { &*name };
        for cell in &mut file.cells {
            if holders[&cell.id()] > 1 {
                cell.algorithm = format!("{} ({shown})", cell.algorithm);
            }
        }
    }
    let mut rest = files.into_iter();
    let (first, file) = rest.next().context("there are no files to join")?;
    let mut joined = Joined {
        file,
        notes: Vec::new(),
    };
    for (name, file) in rest {
        if !joined.file.host.is_same_machine(&file.host) {
            joined.notes.push(format!(
                "{name}: from another machine than {first}, so that their times do not compare: {}",
                file.host.in_words()
            ));
        }
        add(&mut joined, &first, &name, file, Preferred::Joined)?;
    }
    Ok(joined)
}

/// Refuses files from different machines.
fn check_machine(
    whole: &ResultFile,
    first: &str,
    name: &str,
    file: &ResultFile,
) -> anyhow::Result<()> {
    if !whole.host.is_same_machine(&file.host) {
        bail!(
            "{name}: from another machine than {first}, so that their times do not compare: {} and \
             not {}",
            file.host.in_words(),
            whole.host.in_words()
        );
    }
    Ok(())
}

/// Refuses files whose runs of one group have different goals: their times do not compare.
fn check_goals(
    whole: &ResultFile,
    first: &str,
    name: &str,
    file: &ResultFile,
) -> anyhow::Result<()> {
    // One cell of each goal of a group.
    let goals = by_key(&whole.cells, |cell| (&cell.group, &cell.goal));
    let mut known: HashMap<_, Vec<&Cell>> = HashMap::new();
    for ((group, _), cells) in goals {
        known.entry(group).or_default().push(cells[0]);
    }
    for cell in &file.cells {
        let mut known = known.get(&cell.group).into_iter().flatten();
        if let Some(other) = known.find(|known| known.goal != cell.goal) {
            let goal = |cell: &Cell| {
                let all = || "to all vertices".to_owned();
                cell.goal.clone().unwrap_or_else(all)
            };
            bail!(
                "{name}: its runs are {}, and those of {first} {}, so that their times do not \
                 compare; give the same --target and --radius, or keep the files apart",
                goal(cell),
                goal(other)
            );
        }
    }
    Ok(())
}

/// The file whose cell is kept if both files have it.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Preferred {
    Joined,
    Added,
}

/// Adds `file` to `joined`. Returns the number of cells that both have.
fn add(
    joined: &mut Joined,
    first: &str,
    name: &str,
    mut file: ResultFile,
    preferred: Preferred,
) -> anyhow::Result<usize> {
    let whole = &mut joined.file;
    check_goals(whole, first, name, &file)?;
    rename_models(whole, first, name, &mut file)?;
    joined.notes.extend(differences(whole, first, name, &file));
    if whole.plan != file.plan {
        let both = [&*whole, &file].into_iter();
        let mut algorithms: Vec<_> = both
            .flat_map(|file| file.planned_algorithms().into_iter().cloned())
            .collect();
        algorithms.sort_by(|a, b| a.label.cmp(&b.label));
        algorithms.dedup();
        whole.algorithms = algorithms;
        whole.plan = None;
    }
    if whole.tool != file.tool {
        for (sessions, tool) in [
            (&mut whole.sessions, &whole.tool),
            (&mut file.sessions, &file.tool),
        ] {
            for session in sessions {
                session.tool.get_or_insert_with(|| tool.clone());
            }
        }
    }
    for group in file.groups {
        match whole
            .groups
            .iter_mut()
            .find(|known| known.name == group.name)
        {
            Some(known) => {
                let known = &mut known.left_out_at_junctions;
                let new = group.left_out_at_junctions.into_iter();
                let new: Vec<String> = new.filter(|label| !known.contains(label)).collect();
                known.extend(new);
            }
            None => whole.groups.push(group),
        }
    }
    let known = whole.models.iter().enumerate();
    let known = known.map(|(place, model)| (model.name.clone(), place));
    let known: HashMap<String, usize> = known.collect();
    for model in file.models {
        let place = known.get(&model.name);
        match place.and_then(|&place| whole.models.get_mut(place)) {
            // A model without a hash was refused, for example because its file was missing.
            Some(known) if known.sha256.is_none() => *known = model,
            Some(known) => known.add_notes(model.notes),
            None => whole.models.push(model),
        }
    }
    let in_both = join_cells(&mut whole.cells, file.cells, preferred);
    // Times of concurrent cells stay marked as such.
    match (&mut whole.isolation, &file.isolation) {
        (Some(isolation), Some(other)) => isolation.jobs = isolation.jobs.max(other.jobs),
        (none @ None, other) => none.clone_from(other),
        (Some(_), None) => {}
    }
    if whole.pairing != file.pairing {
        whole.pairing = None;
    }
    let both = [whole.conditions.take(), file.conditions];
    whole.conditions = conditions::worst(both.into_iter().flatten());
    whole.sessions.append(&mut file.sessions);
    // RFC 3339 times sort as text.
    whole.started = whole.started.clone().min(file.started);
    whole.finished = whole.finished.clone().max(file.finished);
    Ok(in_both)
}

/// Adds `cells` to `whole`. A cell that is in both stays or is replaced; the number of these is
/// returned. A new cell comes behind the others of its group, model and source, or else at the end.
/// O(cells).
fn join_cells(whole: &mut Vec<Cell>, cells: Vec<Cell>, preferred: Preferred) -> usize {
    type Beside = (Option<String>, String, Option<SourceLabel>);
    let beside =
        |cell: &Cell| -> Beside { (cell.group.clone(), cell.model.clone(), cell.source.clone()) };
    let places = whole.iter().enumerate();
    let places: HashMap<CellId, usize> = places.map(|(place, cell)| (cell.id(), place)).collect();
    let lasts = whole.iter().enumerate();
    let lasts: HashMap<Beside, usize> = lasts.map(|(place, cell)| (beside(cell), place)).collect();
    let mut in_both = 0;
    // The new cells behind each place, and those at the end, together if they belong together.
    let mut behind: HashMap<usize, Vec<Cell>> = HashMap::new();
    let mut ends: HashMap<Beside, usize> = HashMap::new();
    let mut end: Vec<Vec<Cell>> = Vec::new();
    for cell in cells {
        if let Some(&place) = places.get(&cell.id()) {
            in_both += 1;
            if preferred == Preferred::Added {
                whole[place] = cell;
            }
        } else if let Some(&last) = lasts.get(&beside(&cell)) {
            behind.entry(last).or_default().push(cell);
        } else {
            let place = *ends.entry(beside(&cell)).or_insert(end.len());
            if place == end.len() {
                end.push(Vec::new());
            }
            end[place].push(cell);
        }
    }
    let old = std::mem::take(whole);
    for (place, cell) in old.into_iter().enumerate() {
        whole.push(cell);
        whole.extend(behind.remove(&place).into_iter().flatten());
    }
    whole.extend(end.into_iter().flatten());
    in_both
}

/// Renames the models of `file`: if `whole` has a model with the same hash, its name is used.
/// Refuses models of the same name with different hashes.
fn rename_models(
    whole: &ResultFile,
    first: &str,
    name: &str,
    file: &mut ResultFile,
) -> anyhow::Result<()> {
    let identity = |model: &ModelRecord| (model.name.clone(), model.sha256.clone());
    // A model without a hash was refused; its name is not given to another one.
    let refused = |model: &ModelRecord| (model.name.clone(), None);
    let own: HashSet<_> = file.models.iter().map(identity).collect();
    let mut renamed: HashMap<String, String> = HashMap::new();
    let mut given: HashSet<String> = HashSet::new();
    let hashed = whole.models.iter().filter(|known| known.sha256.is_some());
    let by_hash: HashMap<_, _> = by_key(hashed, |known| &known.sha256).into_iter().collect();
    let models = whole.models.iter().rev();
    let by_name: HashMap<&str, &ModelRecord> =
        models.map(|known| (known.name.as_str(), known)).collect();
    for model in &mut file.models {
        // Copies of a model have one hash. Each known name is given once.
        let is_free = |known: &&ModelRecord| {
            ![identity(known), refused(known)]
                .iter()
                .any(|taken| own.contains(taken))
                && !given.contains(&known.name)
        };
        let same_hash = by_hash.get(&model.sha256).map_or(&[][..], Vec::as_slice);
        let mut same_hash = same_hash.iter().copied();
        if same_hash.clone().any(|known| known.name == model.name) {
            continue;
        }
        if let Some(known) = same_hash.find(is_free) {
            given.insert(known.name.clone());
            renamed.insert(model.name.clone(), known.name.clone());
            model.name.clone_from(&known.name);
        } else if let Some(known) = by_name.get(model.name.as_str())
            && let (Some(a), Some(b)) = (&known.sha256, &model.sha256)
        {
            bail!(
                "{name}: its model {} is not that of {first}: the SHA-256 is {b} and not {a}",
                model.name
            );
        }
    }
    // All at once: the new name of one model may be the old one of another.
    for cell in &mut file.cells {
        if let Some(name) = renamed.get(&cell.model) {
            cell.model.clone_from(name);
        }
    }
    Ok(())
}

/// The differences between the program, the machine and the settings of two files, one line each.
fn differences(whole: &ResultFile, first: &str, name: &str, file: &ResultFile) -> Vec<String> {
    let value = |file: &ResultFile| {
        let settings = |group: &GroupRecord| {
            let planned = file.plan.iter().flat_map(|plan| &plan.groups);
            let planned = planned.clone().find(|planned| planned.name == group.name);
            let planned = planned.map(|planned| {
                serde_json::json!({
                    "warmup": planned.warmup,
                    "tolerance": planned.tolerance,
                    "repeat": planned.repeat,
                    "precision": planned.precision,
                    "seed": planned.seed,
                })
            });
            serde_json::json!({
                "timeout": group.timeout,
                "memory_limit": group.memory_limit,
                "plan": planned,
            })
        };
        let groups = file.groups.iter();
        let groups = groups.map(|g| (g.name.clone().unwrap_or_default(), settings(g)));
        (
            serde_json::json!({
                "tool": file.tool,
                "host": {"kernel": file.host.kernel, "simd": file.host.simd},
                "isolation": file.isolation,
            }),
            groups.collect::<Vec<(String, Value)>>(),
        )
    };
    let ((a, groups_a), (b, groups_b)) = (value(whole), value(file));
    let mut notes: Vec<String> = Vec::new();
    let mut note = |place: &str, a: &Value, b: &Value| {
        if let Some(found) = first_difference(a, b) {
            let at = match (place, found.place.as_str()) {
                ("", at) => at.to_owned(),
                (place, "") => place.to_owned(),
                (place, at) => format!("{place}.{at}"),
            };
            notes.push(format!(
                "`{at}` is {} in {name} and {} in {first}",
                found.right, found.left
            ));
        }
    };
    for key in ["tool", "host", "isolation"] {
        note(key, &a[key], &b[key]);
    }
    for (group, settings) in &groups_b {
        if let Some((_, known)) = groups_a.iter().find(|(name, _)| name == group) {
            let place = match group.as_str() {
                "" => String::new(),
                group => format!("group {group}"),
            };
            // Files without a plan have no settings to compare.
            if !known["plan"].is_null() && !settings["plan"].is_null() {
                note(&place, known, settings);
            }
        }
    }
    let changed = changed_program(whole.programs(), file.programs());
    notes.extend(changed.map(|changed| format!("{name}: {changed} as in {first}")));
    notes
}

#[cfg(test)]
mod tests {
    use super::*;
    use geobench_harness::exec::mock::MockBackend;
    use geobench_harness::run::mock::{plan, result, run_mock};
    use geobench_harness::schema::{ProgramRecord, SessionRecord};
    use geobench_registry::Provenance;

    use crate::history::pool::pool;

    fn file(models: &[&str], algorithms: &str) -> ResultFile {
        result(run_mock(
            &plan(models, algorithms, "0"),
            &MockBackend::default(),
        ))
    }

    fn names(file: &ResultFile) -> Vec<String> {
        let cells = file.cells.iter();
        cells
            .map(|c| format!("{} {}", c.model, c.algorithm))
            .collect()
    }

    #[test]
    fn cells_of_several_runs_stand_by_model_and_the_first_are_kept() {
        let a = file(&["horse", "cow"], "mmp,ich");
        let mut b = file(&["cow"], "ich,vtp");
        b.models[0].sha256.clone_from(&a.models[1].sha256);
        // The models of the mock all have the same hash; here they need different ones.
        let mut a = a;
        a.models[0].sha256 = Some("horse".into());
        let joined = join(vec![
            ("a.json".into(), a.clone()),
            ("b.json".into(), b.clone()),
        ]);
        let joined = joined.unwrap();
        assert_eq!(
            names(&joined.file),
            ["horse mmp", "horse ich", "cow mmp", "cow ich", "cow vtp"]
        );
        assert_eq!(joined.file.cells[3], a.cells[3]);
        assert_eq!(
            joined.notes,
            ["b.json: 1 of its cells are also in earlier files, whose times are kept"]
        );
        let extended = extend(("a.json", a), ("this run", b.clone())).unwrap();
        assert_eq!(extended.file.cells[3], b.cells[0]);
    }

    #[test]
    fn a_model_of_another_name_is_found_by_its_hash() {
        let a = file(&["horse"], "mmp");
        let b = file(&["pferd"], "vtp");
        let joined = join(vec![("a".into(), a), ("b".into(), b)]).unwrap();
        assert_eq!(names(&joined.file), ["horse mmp", "horse vtp"]);
        assert_eq!(joined.file.models.len(), 1);
    }

    #[test]
    fn names_that_files_have_swapped_put_cells_under_the_wrong_model() {
        let named = |models: [(&str, &str); 2]| {
            let mut file = file(&models.map(|(name, _)| name), "mmp");
            for (model, (_, hash)) in file.models.iter_mut().zip(models) {
                model.sha256 = Some(hash.into());
            }
            file
        };
        let joined = |a: [(&str, &str); 2], b: [(&str, &str); 2]| {
            let b = (String::from("b"), named(b));
            join(vec![("a".into(), named(a)), b]).unwrap().file
        };
        let whole = joined([("y", "1"), ("z", "2")], [("x", "1"), ("y", "2")]);
        assert_eq!(names(&whole), ["y mmp", "z mmp"]);
        // A copy of a model stays beside it.
        let copied = joined(
            [("horse", "1"), ("cow", "2")],
            [("horse", "1"), ("copy", "1")],
        );
        assert_eq!(names(&copied), ["horse mmp", "cow mmp", "copy mmp"]);
    }

    #[test]
    fn beside_each_other_cells_of_both_files_name_theirs() {
        let a = file(&["horse"], "mmp,vtp");
        let mut b = file(&["horse"], "vtp,ich");
        b.host.cores = 64;
        let joined = beside(vec![("x/a.json".into(), a), ("x/b.json".into(), b)]).unwrap();
        assert_eq!(
            names(&joined.file),
            ["horse mmp", "horse vtp (a)", "horse vtp (b)", "horse ich"]
        );
        assert!(joined.notes[0].contains("from another machine than x/a.json"));
    }

    #[test]
    fn runs_that_do_not_compare_are_refused_and_differences_noted() {
        let a = file(&["horse"], "mmp");
        let with = |change: fn(&mut ResultFile)| {
            let mut b = file(&["horse"], "vtp");
            change(&mut b);
            join(vec![("a".into(), a.clone()), ("b".into(), b)])
        };
        let refused = |change| with(change).unwrap_err().to_string();
        assert_eq!(
            refused(|b| b.models[0].sha256 = Some("beef".into())),
            "b: its model horse is not that of a: the SHA-256 is beef and not 00ff"
        );
        assert_eq!(
            refused(|b| b.host.cores = 64),
            "b: from another machine than a, so that their times do not compare: unknown processor, \
             64 cores, some system and not unknown processor, 2 cores, some system"
        );
        let joined = with(|b| b.tool.commit = Some("c0ffee".into())).unwrap();
        assert_eq!(
            joined.notes,
            ["`tool.commit` is \"c0ffee\" in b and null in a"]
        );
        let of_version = |version: &str| ProgramRecord {
            name: "ext:x".into(),
            provenance: Provenance {
                version: Some(version.into()),
                ..Provenance::default()
            },
            files: Vec::new(),
        };
        let with_program = |version| {
            let mut file = file(&["horse"], "vtp");
            file.sessions.push(SessionRecord {
                shard: None,
                host: file.host.clone(),
                command: Vec::new(),
                started: String::new(),
                finished: None,
                tool: None,
                programs: vec![of_version(version)],
            });
            file
        };
        let both = vec![
            ("a".into(), with_program("1")),
            ("b".into(), with_program("2")),
        ];
        let joined = join(both.clone()).unwrap();
        assert_eq!(
            joined.notes[0],
            "b: `version` of ext:x is \"2\" and not \"1\" as in a"
        );
        assert_eq!(joined.file.programs(), [&of_version("1"), &of_version("2")]);
        // Rounds of one benchmark have the same programs.
        let error = pool(both, None).unwrap_err().to_string();
        assert!(
            error.ends_with("`version` of ext:x is \"2\" and not \"1\""),
            "{error}"
        );
    }
}
