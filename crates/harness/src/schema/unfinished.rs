//! The store of a run that has not ended: `FILE.unfinished` beside its output FILE.
//!
//! An output is written whole, since most formats cannot be appended to. Writing it after each
//! model would take quadratic time, so it is written at growing intervals. The store has a line of
//! JSON for each model, on disk before the next one starts. A run that ends removes it. If a run
//! was killed, [`read`](super::result_file::read) takes what the output lacks from the store.
//!
//! The first line is the result file without cells. An incomplete last line is ignored.
//!
//! A run that adds to a file has a store, too, whose first line is that of the joined file. It
//! holds a lock on it, so that another run which adds to the file meanwhile does not replace it.

use std::collections::HashMap;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufRead, Write};
use std::path::{Path, PathBuf};

use anyhow::bail;
use geobench_export::output::{OutputFile, temporary_file};
use serde::{Deserialize, Serialize};

use super::{Cell, GroupRecord, ModelRecord, ResultFile, SessionRecord};

/// The ending of its name.
const ENDING: &str = "unfinished";

/// A line after the first.
#[derive(Serialize, Deserialize)]
struct UnfinishedLine<'l> {
    /// The groups so far.
    groups: std::borrow::Cow<'l, [GroupRecord]>,
    /// The model that has ended.
    model: std::borrow::Cow<'l, ModelRecord>,
    /// Its cells.
    cells: std::borrow::Cow<'l, [Cell]>,
}

/// An open store.
#[derive(Debug)]
pub struct Unfinished {
    file: File,
    path: PathBuf,
}

/// The path of the store of an output.
fn path_of(output: &Path) -> PathBuf {
    let mut name = OsString::from(output);
    name.push(".");
    name.push(ENDING);
    name.into()
}

impl Unfinished {
    /// The file of the store of `output`, before the run. It replaces a store only.
    ///
    /// # Errors
    ///
    /// If there is something else in its place.
    pub fn prepare(output: &Path) -> anyhow::Result<OutputFile> {
        let path = path_of(output);
        if fs::symlink_metadata(&path).is_ok_and(|found| !is_store(&path, &found)) {
            bail!(
                "{}: it is in the place where the run stores results until it ends; rename it, or \
                 name another output",
                path.display()
            );
        }
        OutputFile::prepare(&path)
    }

    /// A new store for `output`, of a run with this `head`.
    ///
    /// # Errors
    ///
    /// If it cannot be written, or there is something else in its place, or the store of a run that
    /// goes on.
    pub fn create(output: &Path, head: &ResultFile) -> io::Result<Self> {
        let path = path_of(output);
        // A run that is killed at any moment leaves no part of a first line: the next run would not
        // take that for a store.
        let directory = path.parent().filter(|parent| *parent != Path::new(""));
        let mut new = temporary_file(directory.unwrap_or(Path::new(".")), "")?;
        new.as_file().try_lock()?;
        write_line(
            new.as_file_mut(),
            &ResultFile {
                groups: Vec::new(),
                models: Vec::new(),
                cells: Vec::new(),
                ..head.clone()
            },
        )?;
        let replaced = fs::symlink_metadata(&path).is_ok_and(|found| is_store(&path, &found));
        let file = if replaced {
            File::open(&path)?.try_lock()?;
            new.persist(&path)?
        } else {
            new.persist_noclobber(&path)?
        };
        Ok(Self { file, path })
    }

    /// Adds a model that has ended, with its cells.
    ///
    /// # Errors
    ///
    /// If it cannot be written.
    pub fn add(
        &mut self,
        groups: &[GroupRecord],
        model: &ModelRecord,
        cells: &[Cell],
    ) -> io::Result<()> {
        use std::borrow::Cow::Borrowed;
        let line = UnfinishedLine {
            groups: Borrowed(groups),
            model: Borrowed(model),
            cells: Borrowed(cells),
        };
        write_line(&mut self.file, &line)
    }

    /// Removes the store: the output is complete.
    pub fn remove(self) {
        // What stays is harmless.
        let _ = fs::remove_file(&self.path);
    }
}

/// Removes the store of `output` that a killed run has left: the output has its results.
pub fn remove_abandoned(output: &Path) {
    let path = path_of(output);
    let is_abandoned = fs::symlink_metadata(&path).is_ok_and(|found| is_store(&path, &found))
        && File::open(&path).is_ok_and(|store| store.try_lock().is_ok());
    if is_abandoned {
        // What stays is harmless.
        let _ = fs::remove_file(&path);
    }
}

/// Adds a line, which is on disk when this returns.
fn write_line(file: &mut File, line: &impl Serialize) -> io::Result<()> {
    let mut text = serde_json::to_string(line)?;
    text.push('\n');
    file.write_all(text.as_bytes())?;
    file.sync_data()
}

/// Whether the file at `path` is a store: no link, and with the first line of one.
fn is_store(path: &Path, found: &fs::Metadata) -> bool {
    let first_line = || {
        let mut line = String::new();
        io::BufReader::new(File::open(path)?).read_line(&mut line)?;
        io::Result::Ok(line)
    };
    found.is_file() && first_line().is_ok_and(|line| parse(&line).is_some())
}

/// Whether `path` is that of a store.
pub(super) fn is_one(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == ENDING)
}

/// The result in the text of a store; `None` if it is none.
pub(super) fn parse(text: &str) -> Option<ResultFile> {
    let mut lines = text.split_inclusive('\n');
    let mut file: ResultFile = serde_json::from_str(lines.next()?).ok()?;
    for line in lines.filter(|line| line.ends_with('\n')) {
        let line: UnfinishedLine<'_> = serde_json::from_str(line).ok()?;
        file.groups = line.groups.into_owned();
        file.add_model(&line.model);
        file.cells.extend(line.cells.into_owned());
    }
    Some(file)
}

/// `file`, which is in `output`, with what the store beside it has of its run, or of one that adds
/// to it. Returns whether there is anything.
pub(super) fn complete(output: &Path, file: &mut ResultFile) -> bool {
    let text = fs::read_to_string(path_of(output));
    let store = text.ok().as_deref().and_then(parse);
    let is_same =
        |store: &ResultFile| (&store.started, &store.command) == (&file.started, &file.command);
    let Some(store) = store.filter(is_same) else {
        return false;
    };
    let is_known = |one: &SessionRecord| {
        let mut known = file.sessions.iter();
        known.any(|known| (&known.started, &known.command) == (&one.started, &one.command))
    };
    let sessions: Vec<_> = store
        .sessions
        .into_iter()
        .filter(|one| !is_known(one))
        .collect();
    file.sessions.extend(sessions);
    for group in store.groups {
        if file.groups.iter().all(|known| known.name != group.name) {
            file.groups.push(group);
        }
    }
    let models = file.models.iter().enumerate();
    let models: HashMap<String, usize> = models.map(|(at, m)| (m.name.clone(), at)).collect();
    for model in store.models {
        match models.get(&model.name).map(|&at| &mut file.models[at]) {
            // A model without a hash was refused.
            Some(known) if known.sha256.is_none() => *known = model,
            Some(_) => {}
            None => file.models.push(model),
        }
    }
    let cells = file.cells.iter().enumerate();
    let cells: HashMap<_, _> = cells.map(|(at, cell)| (cell.id(), at)).collect();
    for cell in store.cells {
        match cells.get(&cell.id()) {
            Some(&at) => file.cells[at] = cell,
            None => file.cells.push(cell),
        }
    }
    true
}
