//! The journal of a benchmark. The outcome of each run is synced to disk before the next run
//! starts, so a killed benchmark loses at most the run in progress.
//!
//! A journal is a file of JSON lines. The first line is the [`JournalHeader`] with program and
//! plan. Each further line holds a session, a model, an instruction count, a run or a new plan. An
//! incomplete last line is cut off. Any other malformed line is an error, because the rest of the
//! file cannot be trusted then.
//!
//! A process may continue a journal only if the program and the conditions are the same. Its plan
//! may have other models, algorithms, sources and numbers of runs. Then a line with the new plan is
//! appended. Runs that the new plan does not have stay in the file and are ignored.
//!
//! A run has one line. Warm-ups are an exception: a later process repeats them before its timed
//! runs. It also repeats the run of the reference, because checks need the answer, which is too
//! large to store.

use std::collections::{HashMap, HashSet};
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, anyhow, bail};
use serde::{Deserialize, Serialize};

use crate::exec::{Failure, Observation, Pass};
use crate::run::proof::Decision;
use crate::schema::difference::first_difference;
use crate::schema::{
    Check, InstructionCount, ModelRecord, PlanRecord, PlannedGroup, SCHEMA, SessionRecord,
    SourceLabel, Tool, changed_program,
};

#[cfg(test)]
mod tests;

/// Identifies a run within a plan.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct RunId {
    /// Name of the group; null for a group without a name.
    pub group: Option<String>,
    /// Name of the model.
    pub model: String,
    /// The source, or several sources together.
    pub source: SourceLabel,
    /// Label of the algorithm.
    pub algorithm: String,
    /// Purpose of the run.
    #[serde(rename = "purpose")]
    pub pass: Pass,
    /// Index among the runs of this pass, from 0.
    pub round: usize,
}

/// Identifies the runs from one source, or from several together.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub(super) struct UnitId {
    /// Name of the group; null for a group without a name.
    pub(super) group: Option<String>,
    /// Name of the model.
    pub(super) model: String,
    /// The source, or several sources together.
    pub(super) source: SourceLabel,
}

/// The outcome of a run, after the check of its answer.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RunOutcome {
    /// The measurements. The distances are not stored.
    pub observation: Observation,
    /// Comparison of the distances with the reference.
    pub check: Check,
    /// Why there was no reference answer although one was requested.
    pub unchecked: Option<String>,
    /// Failure of the run, which fails the cell.
    pub failure: Option<Failure>,
    /// Position of a timed run in its round. Null for other runs, for concurrent cells, and in
    /// journals of older versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place: Option<usize>,
}

/// An open, locked journal.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    /// Length of all complete lines in bytes.
    length: u64,
    /// The plan of the first line, and of later ones.
    plans: Vec<PlanRecord>,
    /// The names in each plan.
    names: Vec<PlanNames>,
    sessions: Vec<SessionRecord>,
    models: HashMap<String, ModelRecord>,
    outcomes: HashMap<RunId, RunOutcome>,
    instructions: HashMap<RunId, InstructionCount>,
    decisions: HashMap<UnitId, Decision>,
}

/// Maximum time to wait for the lock.
const LOCK_TIMEOUT: Duration = Duration::from_secs(5);

/// Time between two attempts to lock.
const PAUSE: Duration = Duration::from_millis(10);

/// Locks a journal, waiting up to [`LOCK_TIMEOUT`].
///
/// If a process is killed while it starts a child, the child holds the lock until exec. Without the
/// wait, a run that is resumed immediately would be refused.
fn lock(file: &File) -> Result<(), TryLockError> {
    let deadline = Instant::now() + LOCK_TIMEOUT;
    loop {
        match file.try_lock() {
            Err(TryLockError::WouldBlock) if Instant::now() < deadline => thread::sleep(PAUSE),
            outcome => return outcome,
        }
    }
}

impl Journal {
    /// Opens and locks the journal of the benchmark that `header` describes, and adds `session`. A
    /// missing or empty file becomes a new journal, and so does one that ends within this header.
    ///
    /// # Errors
    ///
    /// If the file cannot be written, is in use, is not a journal, belongs to another benchmark or
    /// is damaged. Unless writing failed, the file is unchanged.
    pub fn open(
        path: &Path,
        header: &JournalHeader,
        session: &SessionRecord,
    ) -> anyhow::Result<Self> {
        let name = path.display();
        let failed = |action| format!("journal {name}: cannot be {action}");
        let existed = path.exists();
        if existed && !path.is_file() {
            bail!("journal {name}: not a regular file");
        }
        let file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path)
            .with_context(|| failed("opened for writing"))?;
        match lock(&file) {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                bail!("journal {name}: another process is writing it")
            }
            Err(TryLockError::Error(error)) => {
                return Err(error).with_context(|| failed("locked"));
            }
        }
        let mut journal = Self {
            path: path.to_owned(),
            file,
            length: 0,
            plans: Vec::new(),
            names: Vec::new(),
            sessions: Vec::new(),
            models: HashMap::new(),
            outcomes: HashMap::new(),
            instructions: HashMap::new(),
            decisions: HashMap::new(),
        };
        let mut bytes = Vec::new();
        let read = journal.file.read_to_end(&mut bytes);
        read.with_context(|| failed("read"))?;
        let first = header.line();
        let begun = if bytes.len() < first.len() && first.as_bytes().starts_with(&bytes) {
            // The file is new, or its first line is incomplete.
            journal.add_plan(header.plan.clone());
            journal.start(&first)
        } else {
            journal.read(&bytes, header)?;
            let lacks_line_end = journal.length == bytes.len() as u64 && !bytes.ends_with(b"\n");
            journal.cut().and_then(|()| {
                if lacks_line_end {
                    // A torn write of the first line.
                    journal.append_text("\n")
                } else {
                    Ok(())
                }
            })
        };
        let earlier = journal.sessions.iter().flat_map(|one| &one.programs);
        if let Some(difference) = changed_program(earlier, &session.programs) {
            bail!(
                "journal {name}: belongs to another run: {difference}; repeat that run or name another file"
            );
        }
        let begun = begun.and_then(|()| {
            if journal.plans.contains(&header.plan) {
                Ok(())
            } else {
                journal.append(&JournalLine::Plan(header.plan.clone()))
            }
        });
        let noted = begun.and_then(|()| journal.append(&JournalLine::Session(session.clone())));
        if noted.is_err() && !existed {
            // The file is useless but harmless, so a failure to remove it is ignored.
            let _ = fs::remove_file(path);
        }
        noted.with_context(|| failed("written"))?;
        journal.sessions.push(session.clone());
        Ok(journal)
    }

    /// The sessions so far; that of this process is last.
    pub fn sessions(&self) -> &[SessionRecord] {
        &self.sessions
    }

    /// Writes the first line and syncs the file and its directory.
    fn start(&mut self, first: &str) -> io::Result<()> {
        self.cut()?;
        self.append_text(first)?;
        self.file.sync_all()?;
        if cfg!(unix) {
            let directory = match self.path.parent() {
                Some(parent) if !parent.as_os_str().is_empty() => parent,
                _ => Path::new("."),
            };
            File::open(directory)?.sync_all()?;
        }
        Ok(())
    }

    /// Reads and checks all complete lines.
    fn read(&mut self, bytes: &[u8], header: &JournalHeader) -> anyhow::Result<()> {
        let name = self.path.display().to_string();
        let mut lines = bytes.split_inclusive(|&byte| byte == b'\n');
        let first = lines.next().unwrap_or_default();
        let Ok(found) = serde_json::from_slice::<JournalHeader>(first) else {
            bail!(
                "journal {name}: not a journal of geobench; name a file that does not exist to start a new one"
            );
        };
        if let Some(difference) = found.difference(header) {
            bail!(
                "journal {name}: belongs to another run: {difference}; repeat that run or name another file"
            );
        }
        self.length = first.len() as u64;
        self.add_plan(found.plan);
        for (number, line) in (2..).zip(lines) {
            if !line.ends_with(b"\n") {
                break;
            }
            let taken = serde_json::from_slice(line)
                .map_err(|error| format!("not a line of a journal: {error}"))
                .and_then(|line: JournalLine| {
                    line.run().map_or(Ok(()), |run| self.check(run))?;
                    self.store(line)
                });
            if let Err(problem) = taken {
                bail!(
                    "journal {name}, line {number}: {problem}; take the line out, or name another file"
                );
            }
            self.length += line.len() as u64;
        }
        Ok(())
    }

    /// Stores the contents of a line in memory.
    fn store(&mut self, line: JournalLine) -> Result<(), String> {
        match line {
            JournalLine::Plan(plan) => self.add_plan(plan),
            JournalLine::Session(session) => self.sessions.push(session),
            JournalLine::Model(model) => {
                self.models.insert(model.name.clone(), model);
            }
            JournalLine::Instructions { id, found } => {
                self.instructions.insert(id, found);
            }
            JournalLine::Decision { id, found } => {
                self.decisions.insert(id, found);
            }
            JournalLine::Run { id, found } => self.note(id, found)?,
        }
        Ok(())
    }

    fn add_plan(&mut self, plan: PlanRecord) {
        self.names.push(PlanNames::of(&plan));
        self.plans.push(plan);
    }

    /// Checks that a run is part of one of the plans.
    fn check(&self, run: &RunId) -> Result<(), String> {
        let mut problem = None;
        for names in &self.names {
            match names.check(run) {
                Ok(()) => return Ok(()),
                Err(found) => problem = problem.or(Some(found)),
            }
        }
        problem.map_or(Ok(()), Err)
    }

    /// Stores the outcome of a run. Of repeated warm-ups the first counts, because it includes the
    /// set-up, unless a later one failed.
    fn note(&mut self, id: RunId, found: RunOutcome) -> Result<(), String> {
        match self.outcomes.get_mut(&id) {
            None => {
                self.outcomes.insert(id, found);
            }
            Some(known) if id.pass == Pass::Warmup => {
                if known.failure.is_none() && found.failure.is_some() {
                    *known = found;
                }
            }
            Some(_) => return Err("the run is on an earlier line already".to_owned()),
        }
        Ok(())
    }

    /// Truncates the file after the complete lines.
    fn cut(&mut self) -> io::Result<()> {
        self.file.set_len(self.length)?;
        self.file.seek(SeekFrom::Start(self.length))?;
        Ok(())
    }

    fn append(&mut self, line: &JournalLine) -> io::Result<()> {
        let mut text = serde_json::to_string(line)?;
        text.push('\n');
        self.append_text(&text)
    }

    /// Writes a line and syncs it.
    fn append_text(&mut self, line: &str) -> io::Result<()> {
        let written = self
            .file
            .write_all(line.as_bytes())
            .and_then(|()| self.file.sync_data());
        match written {
            Ok(()) => self.length += line.len() as u64,
            // Removes the incomplete line, so that later lines stay readable.
            Err(_) => self.cut()?,
        }
        written
    }

    /// Writes a line to the file and stores its contents in memory.
    ///
    /// # Errors
    ///
    /// If the file cannot be written. The benchmark must end then.
    pub(super) fn keep(&mut self, line: JournalLine) -> anyhow::Result<()> {
        self.append(&line).map_err(|error| {
            anyhow!(
                "journal {}: cannot be written: {error}; it holds all runs up to here, so go on with --resume",
                self.path.display()
            )
        })?;
        self.store(line).map_err(anyhow::Error::msg)
    }

    /// The record of a model.
    pub(super) fn model(&self, name: &str) -> Option<&ModelRecord> {
        self.models.get(name)
    }

    /// The outcome of a run, if it is done.
    pub(super) fn outcome(&self, run: &RunId) -> Option<&RunOutcome> {
        self.outcomes.get(run)
    }

    /// What a proof has decided about disagreeing answers.
    pub(super) fn decision(&self, unit: &UnitId) -> Option<&Decision> {
        self.decisions.get(unit)
    }

    /// The instruction count of a cell. `run` is the counting run of that cell.
    pub(super) fn instructions(&self, run: &RunId) -> Option<&InstructionCount> {
        self.instructions.get(run)
    }
}

/// Identifies the benchmark of a journal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JournalHeader {
    /// Schema of the records, the same as that of result files.
    journal: String,
    /// Version and build of the program.
    tool: Tool,
    /// The plan, with the hashes of the model files.
    plan: PlanRecord,
}

impl JournalHeader {
    /// The header of a journal in which `tool` runs `plan`.
    pub fn new(tool: Tool, plan: PlanRecord) -> Self {
        Self {
            journal: SCHEMA.to_owned(),
            tool,
            plan,
        }
    }

    /// The header as a line of JSON.
    fn line(&self) -> String {
        let mut line = serde_json::to_string(self).unwrap_or_default();
        line.push('\n');
        line
    }

    /// Describes the first difference from `now` that prevents runs of one benchmark from being
    /// used in the other. `None` if there is none.
    fn difference(&self, now: &Self) -> Option<String> {
        let value = |header: &Self, other: &Self| {
            let plan = conditions(&header.plan, &other.plan);
            serde_json::to_value(Self {
                plan,
                ..header.clone()
            })
            .unwrap_or_default()
        };
        let found = first_difference(&value(self, now), &value(now, self))?;
        Some(format!(
            "`{}` is {} there and {} now",
            found.place, found.left, found.right
        ))
    }
}

/// The settings of `plan` that must be the same in `other` so that their runs can be combined:
/// isolation, shard, and the settings of the groups that both plans have, with the models and
/// algorithms that both have. Sources and numbers of timed runs may differ.
fn conditions(plan: &PlanRecord, other: &PlanRecord) -> PlanRecord {
    let pairs = plan.groups.iter().filter_map(|group| {
        let same = other.groups.iter().find(|other| other.name == group.name);
        Some((group, same?))
    });
    let mut groups: Vec<PlannedGroup> = pairs
        .map(|(group, other)| {
            let mut group = group.clone();
            let names = other.models.iter().map(|model| &model.name);
            let names: HashSet<&String> = names.collect();
            group.models.retain(|model| names.contains(&model.name));
            group
                .algorithms
                .retain(|one| other.algorithms.iter().any(|a| a.label == one.label));
            // The order of models and algorithms may differ.
            group.models.sort_by(|a, b| a.name.cmp(&b.name));
            group.algorithms.sort_by(|a, b| a.label.cmp(&b.label));
            PlannedGroup {
                sources: String::new(),
                repeat: 0,
                precision: None,
                ..group
            }
        })
        .collect();
    groups.sort_by(|a, b| a.name.cmp(&b.name));
    PlanRecord {
        groups,
        ..plan.clone()
    }
}

/// The names in a plan, by group.
#[derive(Debug, Default)]
struct PlanNames(HashMap<Option<String>, GroupNames>);

/// The names in a group of a plan, and its numbers of runs.
#[derive(Debug)]
struct GroupNames {
    models: HashSet<String>,
    algorithms: HashSet<String>,
    reference: String,
    warmup: usize,
    repeat: usize,
}

impl PlanNames {
    fn of(plan: &PlanRecord) -> Self {
        let groups = plan.groups.iter().map(|group| {
            let names = GroupNames {
                models: group.models.iter().map(|one| one.name.clone()).collect(),
                algorithms: group
                    .algorithms
                    .iter()
                    .map(|one| one.label.clone())
                    .collect(),
                reference: group.reference.clone(),
                warmup: group.warmup,
                repeat: group.repeat,
            };
            (group.name.clone(), names)
        });
        Self(groups.collect())
    }

    /// Checks that a run is part of the plan.
    fn check(&self, run: &RunId) -> Result<(), String> {
        let Some(group) = self.0.get(&run.group) else {
            return Err(format!(
                "there is no group `{}` in the plan",
                run.group.as_deref().unwrap_or_default()
            ));
        };
        if !group.models.contains(&run.model) {
            return Err(format!("there is no model `{}` in the plan", run.model));
        }
        let is_reference = group.reference == run.algorithm && run.pass == Pass::Warmup;
        if !is_reference && !group.algorithms.contains(&run.algorithm) {
            return Err(format!(
                "there is no algorithm `{}` in the plan",
                run.algorithm
            ));
        }
        let rounds = match run.pass {
            Pass::Warmup => group.warmup.max(1),
            Pass::Time => group.repeat,
            Pass::Count | Pass::Profile => 1,
        };
        if run.round >= rounds {
            return Err(format!("there is no round {} in the plan", run.round));
        }
        Ok(())
    }
}

/// A line of a journal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[expect(clippy::large_enum_variant, reason = "there is but one at a time")]
pub(super) enum JournalLine {
    /// A plan that differs from the earlier ones. It applies from this line on.
    Plan(PlanRecord),
    /// A process started.
    Session(SessionRecord),
    /// A model was loaded for the first time.
    Model(ModelRecord),
    /// The instructions of a cell were counted.
    Instructions {
        /// The counting run of that cell.
        id: RunId,
        /// The count and the kind of instructions.
        #[serde(flatten)]
        found: InstructionCount,
    },
    /// Answers disagreed, and a proof was sought.
    Decision {
        /// The runs concerned.
        id: UnitId,
        /// What it says.
        found: Decision,
    },
    /// A run ended.
    Run {
        /// The run.
        id: RunId,
        /// The outcome.
        found: RunOutcome,
    },
}

impl JournalLine {
    /// The run that the line refers to, if any.
    const fn run(&self) -> Option<&RunId> {
        match self {
            Self::Plan(_) | Self::Session(_) | Self::Model(_) | Self::Decision { .. } => None,
            Self::Instructions { id, .. } | Self::Run { id, .. } => Some(id),
        }
    }
}
