//! A history: a directory with a small file for each commit, machine class and suite.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::fs::{self, File};
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow, bail};
use geobench_export::output::{OutputFile, make_directory};
use geobench_harness::schema::{Cell, Host, PlannedAlgorithm, ResultFile, Status, labels};
use geobench_harness::usage::{check_schema, files_in};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::history::compare::{CellKey, CellKeys, Measure, TimeKind};

/// The schema of a record.
pub const SCHEMA: &str = "geobench-record/1";

/// The figures of one commit on one machine class.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Always [`SCHEMA`].
    pub schema: String,
    /// The commit that was measured.
    pub commit: String,
    /// First parents of the commit, the newest first, up to one that had a record before this one.
    /// Empty if unknown, and in older records.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ancestors: Vec<String>,
    /// The version of geobench that measured; null in older records.
    #[serde(default)]
    pub version: Option<String>,
    /// The time of the commit, RFC 3339 in UTC; null if unknown.
    pub committed: Option<String>,
    /// The first line of the message of the commit; null if unknown, and in older records.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub subject: Option<String>,
    /// When the first run started, RFC 3339 in UTC.
    pub started: String,
    /// The machine.
    pub host: Host,
    /// The suite; null without one.
    pub suite: Option<String>,
    /// The cells.
    pub cells: Vec<CellRecord>,
}

/// A cell of a record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CellRecord {
    /// The identity of the cell.
    pub cell: CellKey,
    /// All parameters of the algorithm, as in the plan. Null in older records; empty if the result
    /// file had no plan.
    #[serde(default)]
    pub parameters: Option<BTreeMap<String, serde_json::Value>>,
    /// Its outcome.
    pub status: Status,
    /// The vector instructions of its solves; null for an outside program, and in older records.
    #[serde(default)]
    pub simd: Option<String>,
    /// The vector instructions of the solve whose instructions were counted; null if none was, and
    /// in older records.
    #[serde(default)]
    pub instructions_simd: Option<String>,
    /// Every sample of its time.
    pub samples: Vec<f64>,
    /// Of an outside program, the times from outside; absent for others, and in older records.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outside: Vec<f64>,
    /// Of an outside program, the times that it claims; absent as those from outside.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub claimed: Vec<f64>,
    /// All other figures of the cell, by their names in result files.
    pub figures: BTreeMap<String, f64>,
}

impl CellRecord {
    /// The samples of a kind of time.
    pub(crate) fn samples_of(&self, kind: TimeKind) -> &[f64] {
        match kind {
            TimeKind::Time => &self.samples,
            TimeKind::Outside => &self.outside,
            TimeKind::Claimed => &self.claimed,
        }
    }
}

impl Record {
    /// The record of a result file of `suite`, measured at `commit`, of which `ancestors` are first
    /// parents, the newest first, and `committed` is the time.
    ///
    /// # Errors
    ///
    /// When the name of the commit is not alphanumeric, or a time is not RFC 3339.
    pub fn new(
        file: &ResultFile,
        commit: &str,
        ancestors: Vec<String>,
        committed: Option<String>,
        suite: Option<String>,
    ) -> anyhow::Result<Self> {
        if commit.is_empty() || !commit.chars().all(|c| c.is_ascii_alphanumeric()) {
            bail!("`{commit}` is not a commit; give its hash");
        }
        // Both become names of files.
        for (what, time) in [
            ("start of the run", Some(&file.started)),
            ("time of the commit", committed.as_ref()),
        ] {
            let Some(time) = time else { continue };
            humantime::parse_rfc3339(time)
                .map_err(|error| anyhow!("the {what}, `{time}`, is not a time: {error}"))?;
        }
        Ok(Self {
            schema: SCHEMA.to_owned(),
            commit: commit.to_owned(),
            ancestors,
            version: Some(file.tool.version.clone()),
            committed,
            subject: None,
            started: file.started.clone(),
            host: file.host.clone(),
            suite,
            cells: records(file),
        })
    }

    /// The machine class. Only records of the same class are compared with each other.
    pub fn machine(&self) -> String {
        self.host.in_words()
    }

    /// The time of the commit if known, else that of the run.
    pub fn time(&self) -> &str {
        self.committed.as_deref().unwrap_or(&self.started)
    }

    /// The first 12 digits of the commit.
    pub fn short(&self) -> &str {
        self.commit.get(..12).unwrap_or(&self.commit)
    }

    /// The name of the record's file: date, `commit`, the first words of the machine class and
    /// suite, and a hash of both.
    fn file_name(&self, commit: &str) -> String {
        let date = self.time().get(..10).unwrap_or("0000-00-00");
        let class = format!(
            "{} {}",
            self.machine(),
            self.suite.as_deref().unwrap_or_default()
        );
        let mut words: Vec<String> = class
            .split(|c: char| !c.is_ascii_alphanumeric())
            .filter(|word| !word.is_empty())
            .map(str::to_lowercase)
            .collect();
        words.truncate(4);
        let digest = Sha256::digest(class.as_bytes());
        let digits = u32::from_be_bytes([0, digest[0], digest[1], digest[2]]);
        format!("{date}-{commit}-{}-{digits:06x}.json", words.join("-"))
    }

    /// Adds the cells of a later run of the same commit. If both runs solved a cell, its samples
    /// are concatenated, and its other figures come from the later run. If one failed, or ran with
    /// other vector instructions, the later cell is kept. Samples that the record has already,
    /// because a file is recorded again, are not repeated.
    fn merge(&mut self, later: Self) {
        if self.ancestors.is_empty() {
            self.ancestors = later.ancestors;
        }
        self.version = later.version.or(self.version.take());
        self.subject = later.subject.or(self.subject.take());
        let known = self.cells.iter().enumerate();
        let mut places: HashMap<CellKey, usize> = known
            .map(|(place, known)| (known.cell.identity(), place))
            .collect();
        for cell in later.cells {
            let next = self.cells.len();
            let place = *places.entry(cell.cell.identity()).or_insert(next);
            match self.cells.get_mut(place) {
                Some(known)
                    if known.status == Status::Ok
                        && cell.status == Status::Ok
                        && known.simd == cell.simd =>
                {
                    let count = cell.samples.len().max(1);
                    if !known.samples.windows(count).any(|w| w == cell.samples) {
                        known.samples.extend(cell.samples);
                        known.outside.extend(cell.outside);
                        known.claimed.extend(cell.claimed);
                    }
                    known.cell.claimed |= cell.cell.claimed;
                    known.figures.extend(cell.figures);
                    known.instructions_simd =
                        cell.instructions_simd.or(known.instructions_simd.take());
                }
                Some(known) => *known = cell,
                None => self.cells.push(cell),
            }
        }
    }
}

/// The records of the cells of `file`.
fn records(file: &ResultFile) -> Vec<CellRecord> {
    let (keys, planned) = (CellKeys::of(file), file.planned_algorithms());
    let cells = file.cells.iter();
    cells.map(|cell| record(&keys, &planned, cell)).collect()
}

fn record(keys: &CellKeys<'_>, planned: &[&PlannedAlgorithm], cell: &Cell) -> CellRecord {
    let figures = Measure::all().filter_map(|measure| {
        let value = measure.of(cell)?;
        Some((measure.name().to_owned(), value))
    });
    let planned = planned.iter().find(|one| one.label == cell.algorithm);
    let parameters = planned.map_or_else(BTreeMap::new, |one| one.parameters.clone());
    CellRecord {
        cell: keys.key(cell),
        parameters: Some(parameters),
        status: cell.status,
        simd: cell.simd.clone(),
        instructions_simd: cell.instructions_simd.clone(),
        samples: cell.time.samples.clone(),
        outside: cell.time.outside.clone(),
        claimed: cell.time.claimed.clone(),
        figures: figures.collect(),
    }
}

/// Adds `record` to the history in `directory`, and returns the path of its file. Creates the
/// directory if it does not exist. A lock file serialises concurrent processes. The file is
/// replaced atomically, so a killed process leaves it unchanged.
///
/// # Errors
///
/// When the directory cannot be written to, or the file of that name is not a record.
pub fn add(directory: &Path, mut record: Record) -> anyhow::Result<PathBuf> {
    let shown = directory.display();
    let failed = || format!("{shown}: cannot be written");
    make_directory(directory)?;
    let lock = File::create(directory.join(".lock")).with_context(failed)?;
    lock.lock().with_context(failed)?;
    // The commits before the first recorded one are behind its record.
    let names = files_in(directory, "json")?;
    let recorded: HashSet<&str> = names.iter().filter_map(|path| commit_of(path)).collect();
    let is_recorded = |commit: &String| commit.get(..12).is_some_and(|c| recorded.contains(c));
    if let Some(first) = record.ancestors.iter().position(is_recorded) {
        record.ancestors.truncate(first + 1);
    }
    let mut path = directory.join(record.file_name(record.short()));
    let mut known = path.exists().then(|| read(&path)).transpose()?;
    // Another commit whose first digits agree.
    if known
        .as_ref()
        .is_some_and(|known| known.commit != record.commit)
    {
        path = directory.join(record.file_name(&record.commit));
        known = path.exists().then(|| read(&path)).transpose()?;
    }
    let record = match known {
        Some(mut known) => {
            known.merge(record);
            known
        }
        None => record,
    };
    let text = serde_json::to_string(&record)? + "\n";
    OutputFile::prepare(&path)?.write(text.as_bytes())?;
    Ok(path)
}

/// The first digits of the commit in the name of a record's file.
fn commit_of(path: &Path) -> Option<&str> {
    let name = path.file_name()?.to_str()?;
    name.split('-').nth(3)?.get(..12)
}

/// Reads a record.
fn read(path: &Path) -> anyhow::Result<Record> {
    let shown = path.display();
    let text = fs::read_to_string(path).with_context(|| format!("{shown}: cannot be read"))?;
    let mut record: Record = serde_json::from_str(&text)
        .map_err(|error| anyhow!("{shown}: not a record of `geobench record`: {error}"))?;
    check_schema(path, &record.schema, SCHEMA)?;
    for CellRecord {
        cell, parameters, ..
    } in &mut record.cells
    {
        // Empty ones are of a file without a plan, whose labels have all that is known.
        if parameters.as_ref().is_none_or(|all| !all.is_empty()) {
            let known = parameters.clone().unwrap_or_default();
            cell.algorithm = labels::renewed(&cell.algorithm, known);
        }
    }
    Ok(record)
}

/// All records in `directory`, by the names of their files; see
/// [`OrderedHistory`](super::order::OrderedHistory) for their order.
///
/// # Errors
///
/// When there are none, or a JSON file is not a record.
pub fn read_all(directory: &Path) -> anyhow::Result<Vec<Record>> {
    let paths = files_in(directory, "json")?;
    let records = paths.iter().map(|path| read(path));
    let records = records.collect::<anyhow::Result<Vec<Record>>>()?;
    if records.is_empty() {
        bail!(
            "{}: no records in this directory; add some with `geobench record`",
            directory.display()
        );
    }
    Ok(records)
}

#[cfg(test)]
mod tests {
    use super::*;
    use geobench_harness::exec::mock::MockBackend;
    use geobench_harness::run::mock::{plan, result, run_mock};

    fn record(commit: &str) -> Record {
        let records = run_mock(&plan(&["horse"], "mmp,vtp", "0"), &MockBackend::default());
        let committed = Some("2025-03-04T05:06:07Z".to_owned());
        Record::new(
            &result(records),
            commit,
            Vec::new(),
            committed,
            Some("quick".into()),
        )
        .unwrap()
    }

    /// Records of earlier versions do not hold parameters: their queues were calendars.
    #[test]
    fn a_record_of_an_earlier_version_is_of_a_calendar_queue() {
        let directory = tempfile::tempdir().unwrap();
        let mut old = record("c0ffee0123456789");
        for cell in &mut old.cells {
            cell.parameters = None;
        }
        add(directory.path(), old).unwrap();
        let mut new = record("c0ffee0123456780");
        for cell in &mut new.cells {
            let crossing = geobench_registry::find(&cell.cell.algorithm)
                .unwrap()
                .crossing;
            cell.parameters = Some([("crossing".to_owned(), crossing.into())].into());
        }
        add(directory.path(), new).unwrap();
        let read = read_all(directory.path()).unwrap();
        let labels = |record: &Record| {
            let cells = record.cells.iter().map(|c| c.cell.algorithm.clone());
            cells.collect::<Vec<_>>()
        };
        let mut all: Vec<String> = read.iter().flat_map(labels).collect();
        all.sort_unstable();
        assert_eq!(all, ["mmp", "mmp{queue=calendar}", "vtp", "vtp"]);
    }

    #[test]
    fn a_record_comes_back_and_grows() {
        let directory = tempfile::tempdir().unwrap();
        let history = directory.path().join("a/b");
        let first = record("c0ffee0123456789");
        let path = add(&history, first.clone()).unwrap();
        let name = path.file_name().unwrap().to_str().unwrap();
        assert!(
            name.starts_with("2025-03-04-c0ffee012345-unknown-processor-2-cores-"),
            "{name}"
        );
        assert_eq!(read_all(&history).unwrap(), std::slice::from_ref(&first));
        assert_eq!(first.cells[0].figures["propagated"], 3_000_009.0);
        let mut second = first.clone();
        for sample in &mut second.cells[0].samples {
            *sample *= 1.5;
        }
        // The second record twice: its samples are there once.
        for _ in 0..2 {
            assert_eq!(add(&history, second.clone()).unwrap(), path);
        }
        let grown = &read_all(&history).unwrap()[0];
        assert_eq!(grown.cells[0].samples.len(), 12);
        assert_eq!(grown.cells.len(), 2);
    }

    #[test]
    fn commits_with_the_same_first_digits_are_not_joined() {
        let directory = tempfile::tempdir().unwrap();
        let [one, other] = ["c0ffee0123456789", "c0ffee01234567ff"].map(record);
        let path = add(directory.path(), one.clone()).unwrap();
        assert_ne!(add(directory.path(), other.clone()).unwrap(), path);
        // Each again joins its own.
        for record in [one, other] {
            add(directory.path(), record).unwrap();
        }
        let mut found = read_all(directory.path()).unwrap();
        found.sort_by(|a, b| a.commit.cmp(&b.commit));
        let commits: Vec<&str> = found.iter().map(|record| &record.commit[..]).collect();
        assert_eq!(commits, ["c0ffee0123456789", "c0ffee01234567ff"]);
    }

    #[test]
    fn writers_wait_for_each_other() {
        let directory = tempfile::tempdir().unwrap();
        std::thread::scope(|scope| {
            for writer in 0..8 {
                let path = directory.path();
                scope.spawn(move || {
                    let mut record = record("c0ffee");
                    record.cells.truncate(1);
                    record.cells[0].samples = vec![f64::from(writer)];
                    add(path, record).unwrap();
                });
            }
        });
        let mut samples = read_all(directory.path()).unwrap()[0].cells[0]
            .samples
            .clone();
        samples.sort_by(f64::total_cmp);
        assert_eq!(samples, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    }

    #[test]
    fn directories_without_valid_records_are_refused() {
        let directory = tempfile::tempdir().unwrap();
        let error = read_all(directory.path()).unwrap_err().to_string();
        assert!(error.contains("no records in this directory"), "{error}");
        fs::write(directory.path().join("x.json"), "{}").unwrap();
        let error = read_all(directory.path()).unwrap_err().to_string();
        assert!(
            error.contains("x.json: not a record of `geobench record`"),
            "{error}"
        );
        let records = run_mock(&plan(&["horse"], "mmp", "0"), &MockBackend::default());
        let file = result(records);
        let error = Record::new(&file, "../x", Vec::new(), None, None).unwrap_err();
        assert!(error.to_string().contains("is not a commit"), "{error}");
        let mut file = file;
        file.started = "../../../x".to_owned();
        let error = Record::new(&file, "c0ffee", Vec::new(), None, None).unwrap_err();
        assert!(error.to_string().contains(", is not a time"), "{error}");
    }
}
