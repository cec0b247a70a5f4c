//! A benchmark as a Slurm job array: each shard of the plan is a job, and one more job merges the
//! files of the shards. Messages and types call a shard a *part*.
//!
//! Slurm schedules the jobs; this module writes their scripts, which hold the options of `sbatch`.
//! A directory visible to all nodes has the scripts, the journals, the logs and the files of the
//! parts; program, suite and models stay where they are. A part is done when its file has its final
//! name and holds the results of a completed run. The state of each part follows from the directory
//! and from the queue, in which the jobs have the name of the directory; it is not stored.

use std::collections::BTreeMap;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use anyhow::{Context, bail};
use geobench_export::escape::shell;
use geobench_export::output::{OutputFile, make_directory};
use geobench_registry::Selection;
use serde::Deserialize;

use crate::exec::model::ModelRef;
use crate::measure::number::ranges;
use crate::plan::Plan;
use crate::schema::Shard;

/// Memory in bytes that a job needs in addition to its children, for the process that starts them.
const OWN_MEMORY: u64 = 256 << 20;

/// Resources that each job of the array requests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Resources {
    /// Number of cores: the largest number of threads of a cell, for each cell at the same time.
    pub cores: usize,
    /// Main memory in bytes: for each cell at the same time twice the largest memory limit, for the
    /// cell that runs and for those that wait, plus the memory of the program itself. `None` if
    /// some cells have no limit; then Slurm's default applies.
    pub memory_bytes: Option<u64>,
    /// Time in seconds for the largest part, by the sizes of its models. `None` if the number of
    /// its runs is not known, or neither the size of a model nor a time limit; then Slurm's default
    /// applies.
    pub seconds: Option<u64>,
}

impl Resources {
    /// The resources that each of `parts` parts of `plans` needs at most, with `jobs` cells at a
    /// time.
    pub fn of(plans: &[Plan], parts: u32, jobs: usize) -> Self {
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
            cores: jobs * algorithms.map(Selection::threads).max().unwrap_or(1),
            memory_bytes: memory.map(|bytes| {
                let cell = bytes.saturating_mul(2).saturating_add(OWN_MEMORY);
                cell.saturating_mul(jobs as u64)
            }),
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
        options.extend(self.seconds.map(time_option));
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

/// An upper bound of the seconds per face that solvers take on models of 10,000 faces. It grows
/// with the square root of the number of faces.
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

/// A benchmark whose parts are to be submitted.
#[derive(Clone, Debug)]
pub struct ClusterJobs {
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
}

/// State of a part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PartState {
    /// The file of the part is complete.
    Done,
    /// The job of the part waits or runs.
    Queued {
        /// The state in Slurm's words, such as `RUNNING`.
        state: String,
        /// The node, or why the part waits.
        place: String,
    },
    /// The job ended without a complete file. Holds the last line of its log.
    Failed(String),
    /// The part has never been submitted: it has no log.
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

    /// The script of the parts.
    pub fn part_script(&self) -> PathBuf {
        self.path.join("part.sh")
    }

    /// The script of the merge job.
    pub fn merge_script(&self) -> PathBuf {
        self.path.join("merge.sh")
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

    /// The name of the job array. `squeue` separates names by commas.
    fn job_name(&self) -> String {
        format!("geobench:{}", self.path.display()).replace(',', "_")
    }

    /// Creates the directory and its subdirectories.
    ///
    /// # Errors
    ///
    /// If the directory has a benchmark already, or cannot be created.
    pub fn create(&self) -> anyhow::Result<()> {
        if self.part_script().exists() {
            bail!(
                "{}: has a benchmark already; go on with it by --resume, or name another directory",
                self.path.display()
            );
        }
        for name in ["parts", "journals", "logs"] {
            make_directory(&self.path.join(name))?;
        }
        Ok(())
    }

    /// Writes the scripts of `jobs`.
    ///
    /// # Errors
    ///
    /// If one of them cannot be written, or if a path in the scripts is not UTF-8.
    pub fn write(&self, jobs: &ClusterJobs) -> anyhow::Result<()> {
        write(&self.part_script(), &self.text_of_part(jobs)?)?;
        write(&self.merge_script(), &self.text_of_merge(jobs)?)
    }

    /// Number of parts, from the script.
    ///
    /// # Errors
    ///
    /// If there is no script with that number.
    pub fn parts(&self) -> anyhow::Result<u32> {
        let path = self.part_script();
        let text = fs::read_to_string(&path).with_context(|| {
            format!(
                "{}: cannot be read; `geobench cluster --config SUITE --shards N -o DIR` makes it",
                path.display()
            )
        })?;
        let mut lines = text.lines();
        let parts = lines.find_map(|line| line.strip_prefix(ARRAY)?.parse().ok());
        parts.with_context(|| format!("{}: lacks the line `{ARRAY}N`", path.display()))
    }

    /// The script of a part.
    ///
    /// A part that Slurm restarts resumes from its journal. The name of the journal includes that
    /// of the node. On another node the part starts anew, so all its times are from one node.
    fn text_of_part(&self, jobs: &ClusterJobs) -> anyhow::Result<String> {
        let [dir, program, start] =
            [&self.path, &jobs.program, &jobs.directory].map(|path| in_shell(path));
        let (dir, program, start) = (dir?, program?, start?);
        let words: Vec<String> = jobs.run.iter().map(|word| shell(word)).collect();
        let (words, count) = (words.join(" "), jobs.parts);
        let mut options = vec![
            "--nodes=1".to_owned(),
            "--ntasks=1".to_owned(),
            format!("--job-name={}", self.job_name()),
            // Slurm restarts a part whose node fails, on another node.
            "--requeue".to_owned(),
            "--open-mode=append".to_owned(),
            format!("--output={}", self.log("%a").display()),
        ];
        options.extend(jobs.resources.options());
        options.extend(jobs.options.iter().cloned());
        Ok(format!(
            "#!/bin/bash\n\
             # One part of a benchmark, made by `geobench cluster`. Slurm numbers the parts.\n\
             {ARRAY}{count}\n\
             {}\n\
             \n\
             part=$SLURM_ARRAY_TASK_ID\n\
             node=${{SLURMD_NODENAME:-$(hostname)}}\n\
             result={dir}/parts/\"$part.$node\".unfinished.json\n\
             cd {start} || exit 2\n\
             # A killed job may have left a file.\n\
             rm -f \"$result\"\n\
             {program} {words} --shard \"$part/{count}\" \\\n    \
                 --resume {dir}/journals/\"$part.$node\".jsonl \\\n    \
                 -o \"$result\" --format csv >/dev/null\n\
             status=$?\n\
             # 1: some cells failed; 2: some models were refused. Both are results, if there is a file.\n\
             [ \"$status\" -le 2 ] && [ -e \"$result\" ] || exit \"$status\"\n\
             mv \"$result\" {dir}/parts/\"$part\".json\n",
            directives(&options)?
        ))
    }

    /// The script that merges the files of the parts that are done.
    fn text_of_merge(&self, jobs: &ClusterJobs) -> anyhow::Result<String> {
        let (dir, program) = (in_shell(&self.path)?, in_shell(&jobs.program)?);
        let mut options = vec![
            "--nodes=1".to_owned(),
            "--ntasks=1".to_owned(),
            "--job-name=geobench-merge".to_owned(),
            format!("--output={}", self.log("merge").display()),
        ];
        options.extend(without_exclusive(&jobs.options));
        Ok(format!(
            "#!/bin/bash\n\
             # Joins the parts of a benchmark, made by `geobench cluster`.\n\
             {}\n\
             \n\
             cd {dir} || exit 2\n\
             shopt -s nullglob extglob\n\
             files=(parts/+([0-9]).json)\n\
             echo \"${{#files[@]}} of {} parts are done\"\n\
             exec {program} merge \"${{files[@]}}\" -o result.json -o result.csv\n",
            directives(&options)?,
            jobs.parts
        ))
    }

    /// The state of each part, that of part 1 first.
    ///
    /// # Errors
    ///
    /// If the number of parts or Slurm's queue cannot be read. The queue is not read if all parts
    /// are done or none has been submitted.
    pub fn states(&self) -> anyhow::Result<Vec<PartState>> {
        let parts = 1..=self.parts()?;
        let is_submitted = |index: u32| self.log(&index.to_string()).exists();
        let is_done: Vec<bool> = parts.clone().map(|i| is_complete(&self.part(i))).collect();
        let mut queue = BTreeMap::new();
        if is_done.contains(&false) && parts.clone().any(is_submitted) {
            let name = format!("--name={}", self.job_name());
            let format = ["--noheader", "--array", "--states=all", "--format=%K|%T|%R"];
            queue = parse_queue(&output(Command::new("squeue").args(format).arg(name))?);
        }
        let states = parts.zip(is_done).map(|(index, is_done)| {
            if is_done {
                PartState::Done
            } else if let Some(state) = queue.remove(&index) {
                state
            } else if is_submitted(index) {
                PartState::Failed(self.log_tail(&index.to_string()))
            } else {
                PartState::New
            }
        });
        Ok(states.collect())
    }

    /// The last line of the log `name` that is not blank; empty if there is none.
    pub fn log_tail(&self, name: &str) -> String {
        let text = fs::read(self.log(name)).unwrap_or_default();
        let text = String::from_utf8_lossy(&text).into_owned();
        let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
        lines.next_back().unwrap_or_default().to_owned()
    }

    /// Submits `parts` as a job array, and a merge job that waits for them; without parts, only
    /// the merge job. `options` of `sbatch`, and a time of the parts in seconds, override those of
    /// the scripts. Returns the number of each job.
    ///
    /// # Errors
    ///
    /// If Slurm refuses a job.
    pub fn submit(
        &self,
        parts: &[u32],
        options: &[String],
        seconds: Option<u64>,
    ) -> anyhow::Result<(Option<String>, String)> {
        let mut of_merge = without_exclusive(options);
        if parts.is_empty() {
            return Ok((None, submit(&self.merge_script(), &of_merge)?));
        }
        let mut of_parts = options.to_vec();
        of_parts.extend(seconds.map(time_option));
        of_parts.push(format!("--array={}", parts_in_words(parts)));
        let array = submit(&self.part_script(), &of_parts)?;
        for part in parts {
            // `states` takes a part with a log as submitted.
            let log = self.log(&part.to_string());
            fs::File::options().create(true).append(true).open(log)?;
        }
        // `afterany`: the merge job runs after failures, too, and its log names the missing parts.
        of_merge.push(format!("--dependency=afterany:{array}"));
        Ok((Some(array), submit(&self.merge_script(), &of_merge)?))
    }
}

/// The line of the script of a part that has the number of parts.
const ARRAY: &str = "#SBATCH --array=1-";

/// The `sbatch` option that keeps other jobs off a node. The merge job does not use it.
pub const EXCLUSIVE: &str = "--exclusive";

fn without_exclusive(options: &[String]) -> Vec<String> {
    let shared = |option: &&String| *option != EXCLUSIVE;
    options.iter().filter(shared).cloned().collect()
}

fn time_option(seconds: u64) -> String {
    format!("--time={}", seconds.div_ceil(60))
}

/// Options of `sbatch` as lines of a script.
///
/// # Errors
///
/// If one has a line break, behind which it would be a command of the script.
fn directives(options: &[String]) -> anyhow::Result<String> {
    if let Some(option) = options.iter().find(|option| option.contains(['\n', '\r'])) {
        bail!("{option:?}: no option of sbatch may have a line break");
    }
    let line = |option: &String| format!("#SBATCH {}", shell(option));
    Ok(options.iter().map(line).collect::<Vec<_>>().join("\n"))
}

fn write(script: &Path, text: &str) -> anyhow::Result<()> {
    OutputFile::prepare(script)?.write(text.as_bytes())
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

fn in_shell(path: &Path) -> anyhow::Result<String> {
    match path.to_str() {
        Some(path) => Ok(shell(path)),
        None => bail!(
            "{}: not text in UTF-8, so no script can name it",
            path.display()
        ),
    }
}

/// Submits `script` with `options` and returns the number of its job.
fn submit(script: &Path, options: &[String]) -> anyhow::Result<String> {
    let mut command = Command::new("sbatch");
    let text = output(command.arg("--parsable").args(options).arg(script))?;
    // With several clusters: `job;cluster`.
    let job = text.trim().split(';').next().unwrap_or_default();
    if job.is_empty() || !job.bytes().all(|b| b.is_ascii_digit()) {
        bail!(
            "sbatch answers `{}`, which is no number of a job",
            text.trim()
        );
    }
    Ok(job.to_owned())
}

/// Whether a part in this state will still run or be ended by Slurm.
fn is_alive(state: &str) -> bool {
    [
        "PENDING",
        "RUNNING",
        "CONFIGURING",
        "COMPLETING",
        "REQUEUED",
        "REQUEUE_HOLD",
        "REQUEUE_FED",
        "SUSPENDED",
        "STOPPED",
        "SIGNALING",
        "STAGE_OUT",
        "RESIZING",
    ]
    .contains(&state)
}

/// The parts that wait or run, in lines of `part|state|(reason) or node`.
fn parse_queue(text: &str) -> BTreeMap<u32, PartState> {
    let lines = text.lines().filter_map(|line| {
        let mut fields = line.trim().splitn(3, '|');
        let part = fields.next()?.parse().ok()?;
        let state = fields.next()?.to_owned();
        let place = fields.next()?.to_owned();
        is_alive(&state).then_some((part, PartState::Queued { state, place }))
    });
    lines.collect()
}

/// What one of Slurm's commands writes.
///
/// # Errors
///
/// If the command is missing or fails, with what it says.
fn output(command: &mut Command) -> anyhow::Result<String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let Output {
        status,
        stdout,
        stderr,
    } = command.output().map_err(|error| match error.kind() {
        ErrorKind::NotFound => anyhow::anyhow!(
            "{name}: not found; use a machine that submits to Slurm, or --no-submit for the scripts \
             alone"
        ),
        _ => anyhow::Error::new(error).context(format!("cannot run {name}")),
    })?;
    if !status.success() {
        let text = String::from_utf8_lossy(&stderr);
        let lines: Vec<&str> = text.lines().map(str::trim).collect();
        bail!("{name} fails: {}", lines.join("; "));
    }
    Ok(String::from_utf8_lossy(&stdout).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn jobs() -> ClusterJobs {
        let words = ["run", "--config", "it's.toml", "--algo", "vtp{a=1,b=2}"];
        ClusterJobs {
            parts: 20,
            program: "/apps/geo bench".into(),
            directory: "/home/ann".into(),
            run: words.map(str::to_owned).to_vec(),
            resources: Resources {
                cores: 2,
                memory_bytes: Some(1 << 30),
                seconds: Some(61),
            },
            options: vec!["--partition=fast".to_owned(), EXCLUSIVE.to_owned()],
        }
    }

    #[test]
    fn scripts_request_the_resources_of_the_plan() {
        let directory = ClusterDirectory::new(Path::new("/data/x y")).unwrap();
        let script = directory.text_of_part(&jobs()).unwrap();
        for line in [
            r#"'/apps/geo bench' run --config 'it'\''s.toml' --algo 'vtp{a=1,b=2}' --shard "$part/20" \"#,
            "#SBATCH --array=1-20",
            "#SBATCH --cpus-per-task=2",
            "#SBATCH --mem=1024M",
            "#SBATCH --time=2",
            "#SBATCH --partition=fast",
            "#SBATCH --exclusive",
            "#SBATCH '--output=/data/x y/logs/%a.log'",
        ] {
            assert!(
                script.lines().any(|found| found == line),
                "{line}: {script}"
            );
        }
        let merge = directory.text_of_merge(&jobs()).unwrap();
        assert!(merge.contains("--partition=fast"));
        assert!(!merge.contains("--exclusive"));
        // A line break would end the comment that Slurm reads.
        let directory = ClusterDirectory::new(Path::new("/data/x\ntouch y")).unwrap();
        let error = directory.text_of_part(&jobs()).unwrap_err().to_string();
        assert!(error.ends_with("may have a line break"), "{error}");
    }

    #[test]
    fn a_directory_holds_one_benchmark() {
        let place = tempfile::tempdir().unwrap();
        let directory = ClusterDirectory::new(&place.path().join("runs")).unwrap();
        let missing = format!("{:#}", directory.parts().unwrap_err());
        assert!(missing.contains("part.sh: cannot be read"), "{missing}");
        directory.create().unwrap();
        directory.write(&jobs()).unwrap();
        assert_eq!(directory.parts().unwrap(), 20);
        let twice = directory.create().unwrap_err().to_string();
        assert!(twice.contains("has a benchmark already"), "{twice}");
        assert_eq!(directory.states().unwrap(), vec![PartState::New; 20]);
        for part in 1..=20 {
            fs::write(directory.part(part), r#"{"conditions": {}}"#).unwrap();
        }
        fs::write(directory.part(3), r#"{"conditions": null}"#).unwrap();
        assert_eq!(directory.states().unwrap()[2], PartState::New);
        fs::write(directory.part(3), r#"{"conditions": {}}"#).unwrap();
        assert_eq!(directory.states().unwrap(), vec![PartState::Done; 20]);
    }

    #[test]
    fn parts_that_wait_or_run_are_read() {
        let text = "3|RUNNING|n1\n4|PENDING|(Resources)\n5|COMPLETED|n2\n6|NODE_FAIL|n2\n\
                    N/A|PENDING|(Dependency)\n";
        let parts = parse_queue(text);
        assert_eq!(parts.keys().copied().collect::<Vec<_>>(), [3, 4]);
        let (state, place) = ("PENDING".to_owned(), "(Resources)".to_owned());
        assert_eq!(parts[&4], PartState::Queued { state, place });
    }
}
