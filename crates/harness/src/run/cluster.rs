//! A benchmark as a Slurm job array: each shard of the plan is a job, and one more job merges the
//! files of the shards. Messages and types call a shard a *part*.
//!
//! Slurm schedules the jobs; this module writes their scripts. A directory visible to all nodes
//! holds the scripts, the journals, the files of the parts and a record of the submissions. A part
//! is done when its file has its final name and holds the results of a completed run. The state of
//! each part therefore follows from the directory and the queue; it is not stored.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::{Component, Path, PathBuf};

use anyhow::{Context, bail};
use geobench_export::escape::shell;
use geobench_export::json_lines;
use geobench_export::output::OutputFile;
use geobench_registry::Selection;
use serde::{Deserialize, Serialize};

use crate::exec::model::ModelRef;
use crate::exec::slurm::{self, QueuedPart};
use crate::measure::number::ranges;
use crate::plan::Plan;
use crate::schema::Shard;
use crate::usage::check_schema;

/// Schema of `cluster.json`.
const SCHEMA: &str = "geobench-cluster/1";

/// Memory in bytes that a job needs in addition to its children, for the process that starts them.
const OWN_MEMORY: u64 = 256 << 20;

/// Resources that each job of the array requests.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Resources {
    /// Number of cores: the largest number of threads of a cell.
    pub cores: usize,
    /// Main memory in bytes: twice the largest memory limit of a cell, for the cell that runs and
    /// for those that wait, plus the memory of the program itself. Null if some cells have no limit;
    /// then Slurm's default applies.
    pub memory_bytes: Option<u64>,
    /// Time in seconds for the largest part, by the sizes of its models. Null if the number of its
    /// runs is not known, or neither the size of a model nor a time limit; then Slurm's default
    /// applies.
    pub seconds: Option<u64>,
}

impl Resources {
    /// The resources that each of `parts` parts of `plans` needs at most, with one cell at a time.
    pub fn of(plans: &[Plan], parts: u32) -> Self {
        let algorithms = plans.iter().flat_map(|plan| &plan.algorithms);
        let seconds_of = |index| {
            let mut parted = plans.to_vec();
            let count = parts;
            crate::plan::restrict(&mut parted, Shard { index, count });
            let models = parted.iter().flat_map(|plan| {
                let models = plan.models.iter().enumerate();
                models.map(move |(number, model)| (plan, model, plan.units_of_model(number)))
            });
            let mut models = models.filter(|(_, _, units)| *units > 0);
            models.try_fold(RESERVE, |sum, (plan, model, units)| {
                // Otherwise the number of vertices would have to be known.
                let unit = seconds_of_unit(plan, model).filter(|_| !plan.is_open())?;
                Some(sum + units as f64 * unit)
            })
        };
        let memory = plans
            .iter()
            .try_fold(0, |most: u64, plan| Some(most.max(plan.limits.memory.0?)));
        Self {
            cores: algorithms.map(Selection::threads).max().unwrap_or(1),
            memory_bytes: memory.map(|bytes| bytes.saturating_mul(2).saturating_add(OWN_MEMORY)),
            seconds: (1..=parts)
                .map(seconds_of)
                .try_fold(0.0, |most: f64, seconds| Some(most.max(seconds?)))
                .map(whole_seconds),
        }
    }

    /// The options of `sbatch` that request the resources.
    fn options(&self) -> Vec<String> {
        let mut options = vec![format!("--cpus-per-task={}", self.cores)];
        if let Some(bytes) = self.memory_bytes {
            options.push(format!("--mem={}M", bytes.div_ceil(1 << 20)));
        }
        if let Some(seconds) = self.seconds {
            options.push(format!("--time={}", seconds.div_ceil(60)));
        }
        options
    }
}

#[expect(clippy::cast_sign_loss, reason = "times are positive")]
fn whole_seconds(seconds: f64) -> u64 {
    seconds.ceil() as u64
}

/// Seconds that a part gets in addition to its runs: for a slow file system, and for one run that
/// takes the usual time limit.
const RESERVE: f64 = 900.0;

/// Seconds for starting a process and loading a model, in addition to the time per face.
const START: f64 = 1.0;

/// An upper bound of the seconds per face that solvers take on models of 10,000 faces. It grows with
/// the square root of the number of faces.
const SECONDS_PER_FACE: f64 = 1e-4;

/// Seconds for all runs of a model and source. A part that takes longer is ended by Slurm, and goes
/// on from its journal. `None` if neither the size of the model nor a limit is known.
fn seconds_of_unit(plan: &Plan, model: &ModelRef) -> Option<f64> {
    let limit = plan.limits.timeout.0.map(|limit| limit.as_secs_f64());
    let faces = model.faces_at_most();
    let run = |algorithm: &Selection| {
        let of_size = faces.map(|faces| match algorithm.algorithm().name {
            "ch" => 1e-7 * faces * faces,
            _ => SECONDS_PER_FACE * faces * (faces / 1e4).max(1.0).sqrt(),
        });
        let seconds = of_size.into_iter().chain(limit).reduce(f64::min);
        Some(seconds?.max(0.01))
    };
    let cell = |algorithm: &Selection| {
        let run = run(algorithm)?;
        // The profiled and the counted run, and one more of the reference.
        let untimed = plan.warmup as f64 + 3.0;
        Some(2.0 * START + untimed * run + plan.sampling.longest(run))
    };
    plan.algorithms
        .iter()
        .try_fold(0.0, |sum, algorithm| Some(sum + cell(algorithm)?))
}

/// A submission: the parts, their job array and the merge job.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Submission {
    /// Time of the submission, RFC 3339 in UTC.
    pub submitted: String,
    /// Indices of the submitted parts, from 1.
    pub parts: Vec<u32>,
    /// Slurm's ID of the job array; null if only the merge job was submitted.
    pub array: Option<String>,
    /// Slurm's ID of the job that merges the files of all parts; empty if Slurm refused it.
    pub merge: String,
}

/// The record of a benchmark on a cluster, `cluster.json` in its directory.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ClusterRecord {
    /// Always `geobench-cluster/1`.
    pub schema: String,
    /// Number of parts.
    pub parts: u32,
    /// The program that the nodes start.
    pub program: PathBuf,
    /// The working directory of the program.
    pub directory: PathBuf,
    /// Arguments of the program, without those for the part, the journal and the result file.
    pub run: Vec<String>,
    /// Resources that each job of the array requests.
    pub resources: Resources,
    /// Further options of `sbatch`, for all jobs.
    pub options: Vec<String>,
    /// The submissions, in order.
    pub submissions: Vec<Submission>,
}

/// State of a part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PartState {
    /// The file of the part is complete.
    Done,
    /// The job of the part waits or runs.
    Queued(QueuedPart),
    /// The job ended without a complete file. Holds the last line of its log.
    Failed(String),
    /// The part has never been submitted.
    New,
}

/// The directory of a benchmark on a cluster.
#[derive(Clone, Debug)]
pub struct ClusterDirectory {
    path: PathBuf,
}

impl ClusterDirectory {
    /// The directory at `path`. It is not accessed and need not exist.
    ///
    /// # Errors
    ///
    /// If the path cannot be made absolute.
    pub fn new(path: &Path) -> anyhow::Result<Self> {
        let path = std::path::absolute(path)
            .with_context(|| format!("{}: no path of a directory", path.display()))?;
        Ok(Self { path })
    }

    /// Its absolute path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn record_path(&self) -> PathBuf {
        self.path.join("cluster.json")
    }

    /// Path of the merged result file.
    pub fn result(&self) -> PathBuf {
        self.path.join("result.json")
    }

    fn part(&self, index: u32) -> PathBuf {
        self.path.join("parts").join(format!("{index}.json"))
    }

    fn log(&self, name: &str) -> PathBuf {
        self.path.join("logs").join(format!("{name}.log"))
    }

    /// Creates the directory and its subdirectories.
    ///
    /// # Errors
    ///
    /// If the directory has a benchmark already, or cannot be created.
    pub fn create(&self) -> anyhow::Result<()> {
        if self.record_path().exists() {
            bail!(
                "{}: has a benchmark already; go on with it by --resume, or name another directory",
                self.path.display()
            );
        }
        for name in ["parts", "journals", "logs"] {
            let folder = self.path.join(name);
            fs::create_dir_all(&folder)
                .with_context(|| format!("{}: cannot be made", folder.display()))?;
        }
        Ok(())
    }

    /// The record of the benchmark in the directory.
    ///
    /// # Errors
    ///
    /// If there is no record, it cannot be parsed, or it has another schema.
    pub fn record(&self) -> anyhow::Result<ClusterRecord> {
        let path = self.record_path();
        let text = fs::read_to_string(&path).with_context(|| {
            format!(
                "{}: cannot be read; `geobench cluster --config SUITE --shards N -o DIR` makes it",
                path.display()
            )
        })?;
        let record: ClusterRecord = serde_json::from_str(&text)
            .with_context(|| format!("{}: not a record of a cluster", path.display()))?;
        check_schema(&path, &record.schema, SCHEMA)?;
        Ok(record)
    }

    /// Writes the record and the scripts.
    ///
    /// # Errors
    ///
    /// If one of them cannot be written, or if a path in the scripts is not UTF-8.
    pub fn write(&self, record: &ClusterRecord) -> anyhow::Result<()> {
        let files = [
            (self.path.join("part.sh"), self.part_script(record)?),
            (self.path.join("merge.sh"), self.merge_script(record)?),
            (self.record_path(), json_lines(record)?),
        ];
        for (path, text) in files {
            OutputFile::prepare(&path)?.write(text.as_bytes())?;
        }
        Ok(())
    }

    /// The script of a part.
    ///
    /// A part that Slurm restarts resumes from its journal. The name of the journal includes that
    /// of the node. On another node the part starts anew, so all its times are from one node.
    fn part_script(&self, record: &ClusterRecord) -> anyhow::Result<String> {
        let [dir, program, start] =
            [&self.path, &record.program, &record.directory].map(|p| in_shell(p));
        let (dir, program, start) = (dir?, program?, start?);
        let mut words = String::new();
        for word in &record.run {
            write!(words, " {}", shell(word))?;
        }
        let count = record.parts;
        Ok(format!(
            "#!/bin/bash\n\
             # One part of a benchmark, made by `geobench cluster`. Slurm numbers the parts.\n\
             part=$SLURM_ARRAY_TASK_ID\n\
             node=${{SLURMD_NODENAME:-$(hostname)}}\n\
             cd {start} || exit 2\n\
             # A killed job may have left a file.\n\
             rm -f {dir}/parts/\"$part.$node\".unfinished.json\n\
             {program}{words} --shard \"$part/{count}\" \\\n    \
                 --resume {dir}/journals/\"$part.$node\".jsonl \\\n    \
                 -o {dir}/parts/\"$part.$node\".unfinished.json --format csv >/dev/null\n\
             status=$?\n\
             # 1: some cells failed; 2: some models were refused. Both are results, if there is a file.\n\
             [ \"$status\" -le 2 ] && [ -e {dir}/parts/\"$part.$node\".unfinished.json ] || exit \"$status\"\n\
             mv {dir}/parts/\"$part.$node\".unfinished.json {dir}/parts/\"$part\".json\n"
        ))
    }

    /// The script that merges the files of the parts that are done.
    fn merge_script(&self, record: &ClusterRecord) -> anyhow::Result<String> {
        let (dir, program) = (in_shell(&self.path)?, in_shell(&record.program)?);
        let count = record.parts;
        Ok(format!(
            "#!/bin/bash\n\
             # Joins the parts of a benchmark, made by `geobench cluster`.\n\
             cd {dir} || exit 2\n\
             shopt -s nullglob extglob\n\
             files=(parts/+([0-9]).json)\n\
             echo \"${{#files[@]}} of {count} parts are done\"\n\
             exec {program} merge \"${{files[@]}}\" -o result.json -o result.csv\n"
        ))
    }

    /// The state of each part, that of part 1 first.
    ///
    /// # Errors
    ///
    /// If Slurm's queue cannot be read. It is not queried if all parts are done.
    pub fn states(&self, record: &ClusterRecord) -> anyhow::Result<Vec<PartState>> {
        let done: Vec<bool> = (1..=record.parts)
            .map(|index| is_complete(&self.part(index)))
            .collect();
        let jobs: Vec<&str> = record
            .submissions
            .iter()
            .filter_map(|submission| submission.array.as_deref())
            .collect();
        let queue = if done.iter().all(|done| *done) {
            BTreeMap::new()
        } else {
            slurm::queued(&jobs)?
        };
        let submitted =
            |index| (record.submissions.iter()).any(|submission| submission.parts.contains(&index));
        Ok((1..)
            .zip(done)
            .map(|(index, done)| {
                if done {
                    PartState::Done
                } else if let Some(part) = queue.get(&index) {
                    PartState::Queued(part.clone())
                } else if submitted(index) {
                    PartState::Failed(self.log_tail(&index.to_string()))
                } else {
                    PartState::New
                }
            })
            .collect())
    }

    /// The last line of the log `name` that is not blank; empty if there is none.
    pub fn log_tail(&self, name: &str) -> String {
        let text = fs::read(self.log(name)).unwrap_or_default();
        let text = String::from_utf8_lossy(&text).into_owned();
        let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
        lines.next_back().unwrap_or_default().to_owned()
    }

    /// The options of the two `sbatch` commands that submit `parts` and the merge job. The script
    /// and the dependency of the merge job are not included.
    pub fn commands(&self, record: &ClusterRecord, parts: &[u32]) -> [Vec<String>; 2] {
        let log = |name: &str| format!("--output={}", self.log(name).display());
        let mut array = vec![
            "--job-name=geobench".to_owned(),
            format!("--array={}", parts_in_words(parts)),
            "--nodes=1".to_owned(),
            "--ntasks=1".to_owned(),
            // Slurm restarts a part whose node fails, on another node.
            "--requeue".to_owned(),
            "--open-mode=append".to_owned(),
            log("%a"),
        ];
        array.extend(record.resources.options());
        array.extend(record.options.iter().cloned());
        let mut merge = vec![
            "--job-name=geobench-merge".to_owned(),
            "--nodes=1".to_owned(),
            "--ntasks=1".to_owned(),
            log("merge"),
        ];
        let shared = |option: &&String| *option != EXCLUSIVE;
        merge.extend(record.options.iter().filter(shared).cloned());
        [array, merge]
    }

    /// Submits `parts` as a job array, and a merge job that waits for them. Without parts, submits
    /// only the merge job. Adds the submission, with the time `now`, to the record and writes that.
    ///
    /// # Errors
    ///
    /// If Slurm refuses a job, or if the record cannot be written. If Slurm refuses the merge job,
    /// the record still has the job array.
    pub fn submit(
        &self,
        record: &mut ClusterRecord,
        parts: &[u32],
        now: &str,
    ) -> anyhow::Result<()> {
        let [array, mut merge] = self.commands(record, parts);
        let array = match parts {
            [] => None,
            _ => Some(slurm::submit(&self.path.join("part.sh"), &array)?),
        };
        if let Some(job) = &array {
            // `afterany`: the merge job runs after failures, too, and its log names the missing
            // parts.
            merge.push(format!("--dependency=afterany:{job}"));
        }
        let joining = slurm::submit(&self.path.join("merge.sh"), &merge);
        record.submissions.push(Submission {
            submitted: now.to_owned(),
            parts: parts.to_vec(),
            array,
            merge: joining.as_deref().unwrap_or_default().to_owned(),
        });
        self.write(record)?;
        joining.map(drop)
    }
}

/// The `sbatch` option that keeps other jobs off a node. The merge job does not use it.
pub const EXCLUSIVE: &str = "--exclusive";

/// Where the nodes find the program and the models.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClusterFiles {
    /// The executable.
    pub program: PathBuf,
    /// The working directory of the jobs, to which paths of models are relative.
    pub directory: PathBuf,
    /// Messages to the user on what was copied and what is used in place.
    pub notes: Vec<String>,
}

impl ClusterFiles {
    /// Decides whether the nodes use `program` and `files` in place. The program is copied to `to`
    /// if it is on another file system. All files are copied to `to` if one of them, or `here`, to
    /// which paths of files are relative, is on another file system.
    ///
    /// # Errors
    ///
    /// If a file to copy has an absolute path or is outside `here`, or if a file cannot be read or
    /// copied, or if files must be copied while the benchmark needs `fixed`, which cannot.
    pub fn find(
        to: &ClusterDirectory,
        program: &Path,
        here: &Path,
        files: &[PathBuf],
        fixed: Option<&str>,
    ) -> anyhow::Result<Self> {
        let shared = device(&to.path)?;
        let mut notes = Vec::new();
        let program = if device(program)? == shared {
            notes.push(format!(
                "the nodes use {} in place: it is on the file system of {}",
                program.display(),
                to.path.display()
            ));
            program.to_owned()
        } else {
            let copy = to.path.join("geobench");
            fs::copy(program, &copy)
                .with_context(|| format!("{}: cannot be copied", program.display()))?;
            notes.push(format!(
                "the nodes use {}, a copy of this program",
                copy.display()
            ));
            copy
        };
        let sees_here = device(here)? == shared;
        let mut in_place = true;
        for file in files {
            let is_found = sees_here || file.is_absolute();
            in_place &= is_found && device(&here.join(file))? == shared;
        }
        if in_place {
            let directory = if sees_here { here } else { &to.path };
            if !files.is_empty() {
                notes.push(format!(
                    "the nodes read suite and models in place, from {}",
                    directory.display()
                ));
            }
            return Ok(Self {
                program,
                directory: directory.to_owned(),
                notes,
            });
        }
        if let Some(fixed) = fixed {
            bail!(
                "not all files are on the file system of {}, and {fixed} cannot be copied there; start in a \
                 directory on that file system",
                to.path.display()
            );
        }
        let directory = to.path.join("files");
        for file in files {
            let inside = inside(file).with_context(|| {
                format!(
                    "{}: not on the file system of {}, so the nodes may not see it; copy it there, or \
                     start in a directory that holds it",
                    file.display(),
                    to.path.display()
                )
            })?;
            let copy = directory.join(&inside);
            if let Some(parent) = copy.parent() {
                fs::create_dir_all(parent)
                    .with_context(|| format!("{}: cannot be made", parent.display()))?;
            }
            fs::copy(here.join(file), &copy)
                .with_context(|| format!("{}: cannot be copied", file.display()))?;
        }
        notes.push(format!(
            "the nodes read copies of suite and models, in {}",
            directory.display()
        ));
        Ok(Self {
            program,
            directory,
            notes,
        })
    }
}

/// Whether the result file at `path` is of a completed run. Only a completed run records the
/// conditions of the machine.
fn is_complete(path: &Path) -> bool {
    #[derive(Deserialize)]
    struct Head {
        conditions: Option<serde::de::IgnoredAny>,
    }
    let text = fs::read(path).unwrap_or_default();
    serde_json::from_slice::<Head>(&text).is_ok_and(|head| head.conditions.is_some())
}

/// The numbers of parts in Slurm's notation for job arrays, such as `1-3,7`.
pub fn parts_in_words(parts: &[u32]) -> String {
    ranges(&parts.iter().map(|&part| part as usize).collect::<Vec<_>>())
}

/// ID of the device, and thus of the file system, of the file at `path`.
fn device(path: &Path) -> anyhow::Result<u64> {
    let metadata =
        fs::metadata(path).with_context(|| format!("{}: cannot be read", path.display()))?;
    Ok(metadata.dev())
}

/// `path` without `.` and `..`. `None` if it is absolute or leaves the directory that it starts
/// from.
fn inside(path: &Path) -> Option<PathBuf> {
    let mut inside = PathBuf::new();
    for component in path.components() {
        match component {
            Component::Normal(name) => inside.push(name),
            Component::CurDir => {}
            Component::ParentDir if inside.pop() => {}
            _ => return None,
        }
    }
    Some(inside)
}

fn in_shell(path: &Path) -> anyhow::Result<String> {
    match path.to_str() {
        Some(path) => Ok(shell(path)),
        None => bail!(
            "{}: not text in UTF-8, so no script can name it",
            path.display()
        ),
    }
}

impl ClusterRecord {
    /// The record of a benchmark before its first submission.
    pub fn new(
        parts: u32,
        placement: &ClusterFiles,
        run: Vec<String>,
        resources: Resources,
        options: Vec<String>,
    ) -> Self {
        Self {
            schema: SCHEMA.to_owned(),
            parts,
            program: placement.program.clone(),
            directory: placement.directory.clone(),
            run,
            resources,
            options,
            submissions: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record() -> ClusterRecord {
        let placement = ClusterFiles {
            program: "/apps/geo bench".into(),
            directory: "/home/ann".into(),
            notes: Vec::new(),
        };
        let resources = Resources {
            cores: 2,
            memory_bytes: Some(1 << 30),
            seconds: Some(61),
        };
        let words = ["run", "--config", "it's.toml", "--algo", "vtp{a=1,b=2}"];
        let run = words.map(str::to_owned).to_vec();
        let options = vec!["--partition=fast".to_owned(), EXCLUSIVE.to_owned()];
        ClusterRecord::new(20, &placement, run, resources, options)
    }

    #[test]
    fn words_are_quoted_for_the_shell() {
        let script = ClusterDirectory::new(Path::new("/data/x"))
            .unwrap()
            .part_script(&record())
            .unwrap();
        assert!(
            script.contains(r#"'/apps/geo bench' run --config 'it'\''s.toml' --algo 'vtp{a=1,b=2}' --shard "$part/20""#),
            "{script}"
        );
    }

    #[test]
    fn jobs_ask_for_what_the_plan_needs() {
        let directory = ClusterDirectory::new(Path::new("/data/x")).unwrap();
        let [array, merge] = directory.commands(&record(), &[1, 2, 3]);
        for option in [
            "--array=1-3",
            "--cpus-per-task=2",
            "--mem=1024M",
            "--time=2",
            "--partition=fast",
            "--exclusive",
            "--output=/data/x/logs/%a.log",
        ] {
            assert!(array.contains(&option.to_owned()), "{option}: {array:?}");
        }
        assert!(merge.contains(&"--partition=fast".to_owned()));
        assert!(!merge.contains(&"--exclusive".to_owned()));
    }

    #[test]
    fn a_directory_holds_one_benchmark() {
        let place = tempfile::tempdir().unwrap();
        let directory = ClusterDirectory::new(&place.path().join("runs")).unwrap();
        let missing = format!("{:#}", directory.record().unwrap_err());
        assert!(
            missing.contains("cluster.json: cannot be read"),
            "{missing}"
        );
        directory.create().unwrap();
        directory.write(&record()).unwrap();
        assert_eq!(directory.record().unwrap(), record());
        let twice = directory.create().unwrap_err().to_string();
        assert!(twice.contains("has a benchmark already"), "{twice}");
        let states = directory.states(&record()).unwrap();
        assert_eq!(states, vec![PartState::New; 20]);
        for part in 1..=20 {
            fs::write(directory.part(part), r#"{"conditions": {}}"#).unwrap();
        }
        fs::write(directory.part(3), r#"{"conditions": null}"#).unwrap();
        assert_eq!(directory.states(&record()).unwrap()[2], PartState::New);
        fs::write(directory.part(3), r#"{"conditions": {}}"#).unwrap();
        assert_eq!(
            directory.states(&record()).unwrap(),
            vec![PartState::Done; 20]
        );
    }

    #[test]
    fn files_on_the_same_file_system_stay_where_they_are() {
        let place = tempfile::tempdir().unwrap();
        let here = place.path();
        for file in ["geobench", "a.obj"] {
            fs::write(here.join(file), "").unwrap();
        }
        let directory = ClusterDirectory::new(&here.join("runs")).unwrap();
        directory.create().unwrap();
        let files = ["a.obj".into()];
        let placement =
            ClusterFiles::find(&directory, &here.join("geobench"), here, &files, None).unwrap();
        assert_eq!(placement.program, here.join("geobench"));
        assert_eq!(placement.directory, here);
    }

    #[test]
    fn paths_that_leave_the_directory_are_not_copied() {
        assert_eq!(inside(Path::new("a/../b/./c.obj")), Some("b/c.obj".into()));
        assert_eq!(inside(Path::new("../c.obj")), None);
        assert_eq!(inside(Path::new("/c.obj")), None);
    }
}
