//! Which cells of two files are the same.

use std::collections::HashMap;
use std::fmt;

use serde::Serialize;

use crate::schema::{Cell, ResultFile};

/// What makes a cell the one it is.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Key {
    /// Name of the model, in the file that has the cell; in the new one if both have.
    pub model: String,
    /// Hash of the model, if it could be read.
    pub sha256: Option<String>,
    /// Algorithm with its parameters.
    pub algorithm: String,
    /// Source vertex.
    pub source: Option<u32>,
    /// Threads.
    pub threads: usize,
    /// Name of the group.
    pub group: Option<String>,
}

/// All but the name of the model, which is only what people call it; without a hash, the name.
#[derive(PartialEq, Eq, Hash)]
struct Identity {
    model: Result<String, String>,
    algorithm: String,
    source: Option<u32>,
    threads: usize,
    group: Option<String>,
}

/// The cells of two files.
pub(super) struct Matched<'f> {
    /// Those of both, in the order of the new file.
    pub(super) common: Vec<(Key, &'f Cell, &'f Cell)>,
    /// Those of the old file alone.
    pub(super) missing: Vec<Key>,
    /// Those of the new file alone.
    pub(super) added: Vec<Key>,
    /// Models that have the same name and are not the same.
    pub(super) notes: Vec<String>,
}

/// Matches the cells of two files.
pub(super) fn matched<'f>(old: &'f ResultFile, new: &'f ResultFile) -> Matched<'f> {
    // Copies of one model are the same by their hash; each has its own cells.
    let mut waiting: HashMap<Identity, Vec<(Key, &Cell)>> = HashMap::new();
    for cell in &old.cells {
        let key = Key::of(old, cell);
        waiting.entry(key.identity()).or_default().push((key, cell));
    }
    let (mut common, mut added) = (Vec::new(), Vec::new());
    for cell in &new.cells {
        let key = Key::of(new, cell);
        match waiting.get_mut(&key.identity()) {
            Some(candidates) if !candidates.is_empty() => {
                let namesake = candidates.iter().position(|(k, _)| k.model == key.model);
                let (_, old) = candidates.remove(namesake.unwrap_or(0));
                common.push((key, old, cell));
            }
            _ => added.push(key),
        }
    }
    let is_left = |key: &Key| {
        let candidates = waiting.get(&key.identity());
        candidates.is_some_and(|c| c.iter().any(|(k, _)| k == key))
    };
    let missing = old.cells.iter().map(|cell| Key::of(old, cell));
    let missing = missing.filter(is_left).collect();
    Matched {
        common,
        missing,
        added,
        notes: changed_models(old, new),
    }
}

fn changed_models(old: &ResultFile, new: &ResultFile) -> Vec<String> {
    let changed = new.models.iter().filter(|model| {
        let before = old.models.iter().find(|m| m.name == model.name);
        before.is_some_and(|m| {
            m.sha256.is_some() && model.sha256.is_some() && m.sha256 != model.sha256
        })
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

impl Key {
    fn of(file: &ResultFile, cell: &Cell) -> Self {
        let model = file.models.iter().find(|m| m.name == cell.model);
        Self {
            model: cell.model.clone(),
            sha256: model.and_then(|m| m.sha256.clone()),
            algorithm: cell.algorithm.clone(),
            source: cell.source,
            threads: cell.threads,
            group: cell.group.clone(),
        }
    }

    fn identity(&self) -> Identity {
        Identity {
            model: self.sha256.clone().ok_or_else(|| self.model.clone()),
            algorithm: self.algorithm.clone(),
            source: self.source,
            threads: self.threads,
            group: self.group.clone(),
        }
    }
}

impl Key {
    /// What a reader needs to find the cell among others: `horse, vtp, source 0`, after the group;
    /// group and source only if they are asked for.
    pub fn among(&self, with_group: bool, with_source: bool) -> String {
        let group = match &self.group {
            Some(group) if with_group => format!("{group}: "),
            _ => String::new(),
        };
        let source = match self.source {
            Some(source) if with_source => format!(", source {source}"),
            _ => String::new(),
        };
        let threads = match self.threads {
            1 => String::new(),
            threads => format!(", {threads} threads"),
        };
        format!("{group}{}, {}{source}{threads}", self.model, self.algorithm)
    }
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.among(true, true))
    }
}
