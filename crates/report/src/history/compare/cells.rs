//! The identity of cells, by which those of two files match.

use std::collections::HashMap;
use std::fmt;

use geobench_harness::figures::CLAIMED;
use geobench_harness::schema::{Cell, ResultFile, SourceLabel};
use serde::{Deserialize, Serialize};

/// The identity of a cell.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct CellKey {
    /// Name of the model in its file. In a comparison, the name in the new file if both have the
    /// cell.
    pub model: String,
    /// Hash of the model, if it could be read.
    pub sha256: Option<String>,
    /// Algorithm with its parameters.
    pub algorithm: String,
    /// The source.
    pub source: Option<SourceLabel>,
    /// The goal of its runs; absent for the distances of all vertices.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub goal: Option<String>,
    /// Threads.
    pub threads: usize,
    /// Name of the group.
    pub group: Option<String>,
    /// Whether its times are claims of an outside program that nothing confirms. Not part of the
    /// identity.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub claimed: bool,
}

/// The cells of two files.
pub(super) struct Matched<'f> {
    /// Cells of both files, in the order of the new one.
    pub(super) common: Vec<(CellKey, &'f Cell, &'f Cell)>,
    /// Cells of the old file alone.
    pub(super) missing: Vec<CellKey>,
    /// Cells of the new file alone.
    pub(super) added: Vec<CellKey>,
    /// Notes on models of the same name with different hashes.
    pub(super) notes: Vec<String>,
}

/// Matches the cells of two files.
pub(super) fn matched<'f>(old: &'f ResultFile, new: &'f ResultFile) -> Matched<'f> {
    // A file can have copies of a model under several names. They share a hash, so several cells
    // can have the same identity.
    let mut waiting: HashMap<CellKey, Vec<(CellKey, &Cell)>> = HashMap::new();
    let (old_keys, new_keys) = (CellKeys::of(old), CellKeys::of(new));
    for cell in &old.cells {
        let key = old_keys.key(cell);
        waiting.entry(key.identity()).or_default().push((key, cell));
    }
    let (mut common, mut added) = (Vec::new(), Vec::new());
    for cell in &new.cells {
        let key = new_keys.key(cell);
        match waiting.get_mut(&key.identity()) {
            Some(candidates) if !candidates.is_empty() => {
                let namesake = candidates.iter().position(|(k, _)| k.model == key.model);
                let (former, old) = candidates.remove(namesake.unwrap_or(0));
                let claimed = key.claimed || former.claimed;
                common.push((CellKey { claimed, ..key }, old, cell));
            }
            _ => added.push(key),
        }
    }
    let is_left = |key: &CellKey| {
        let candidates = waiting.get(&key.identity());
        candidates.is_some_and(|c| c.iter().any(|(k, _)| k == key))
    };
    let missing = old.cells.iter().map(|cell| old_keys.key(cell));
    let missing = missing.filter(is_left).collect();
    Matched {
        common,
        missing,
        added,
        notes: changed_models(old, new),
    }
}

fn changed_models(old: &ResultFile, new: &ResultFile) -> Vec<String> {
    let CellKeys { hashes } = CellKeys::of(old);
    let changed = new.models.iter().filter(|model| {
        let before = hashes.get(model.name.as_str()).copied().flatten();
        let now = model.sha256.as_deref();
        before.is_some() && now.is_some() && before != now
    });
    changed
        .map(|model| {
            format!(
                "the model {} is not what it was: its hash differs",
                model.name
            )
        })
        .collect()
}

/// The identities of the cells of a file.
pub(crate) struct CellKeys<'f> {
    /// The hash of each model.
    hashes: HashMap<&'f str, Option<&'f str>>,
}

impl<'f> CellKeys<'f> {
    /// Those of the cells of `file`.
    pub(crate) fn of(file: &'f ResultFile) -> Self {
        let models = file.models.iter().rev();
        Self {
            hashes: models
                .map(|model| (model.name.as_str(), model.sha256.as_deref()))
                .collect(),
        }
    }

    /// The identity of a cell of the file.
    pub(crate) fn key(&self, cell: &Cell) -> CellKey {
        let hash = self.hashes.get(cell.model.as_str()).copied().flatten();
        CellKey {
            model: cell.model.clone(),
            sha256: hash.map(str::to_owned),
            algorithm: cell.algorithm.clone(),
            source: cell.source.clone(),
            goal: cell.goal.clone(),
            threads: cell.threads,
            group: cell.group.clone(),
            claimed: cell.time.unconfirmed,
        }
    }
}

impl CellKey {
    /// Whether both identify the same cell. Names of models are ignored if there are hashes.
    pub fn is_same(&self, other: &Self) -> bool {
        self.identity() == other.identity()
    }

    /// The key without the name of the model, unless the model has no hash. Keys of the same cell
    /// have the same identity.
    pub(crate) fn identity(&self) -> Self {
        let mut key = self.clone();
        key.claimed = false;
        if key.sha256.is_some() {
            key.model.clear();
        }
        key
    }

    /// The identity in words: group, model, algorithm, source, goal and threads. Group and source
    /// are included only if `with_group` and `with_source` are set.
    pub fn among(&self, with_group: bool, with_source: bool) -> String {
        let group = match &self.group {
            Some(group) if with_group => format!("{group}: "),
            _ => String::new(),
        };
        let source = match &self.source {
            Some(source) if with_source => format!(", source {source}"),
            _ => String::new(),
        };
        let threads = match self.threads {
            1 => String::new(),
            threads => format!(", {threads} threads"),
        };
        let goal = self.goal.as_ref();
        let goal = goal.map_or_else(String::new, |goal| format!(", {goal}"));
        let claimed = if self.claimed {
            format!(" {CLAIMED}")
        } else {
            String::new()
        };
        format!(
            "{group}{}, {}{claimed}{source}{goal}{threads}",
            self.model, self.algorithm
        )
    }
}

impl fmt::Display for CellKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.among(true, true))
    }
}
