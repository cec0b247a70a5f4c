//! `geobench cluster`.

use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, anyhow, bail};
use clap::{Args, Command, FromArgMatches};
use geobench_export::escape::shell;
use geobench_harness::measure::number::counted;
use geobench_harness::plan::Plan;
use geobench_harness::plan::suite::Plans;
use geobench_harness::run::cluster::{
    ClusterDirectory, ClusterJobs, EXCLUSIVE, PartState, Resources, parts_in_words,
};
use geobench_report::table::terminal::listing;
use geobench_report::table::{Column, Entry, Look, Table};

use super::run::{RunOptions, SuiteFileOption, possible_plans};
use crate::args::in_one_line;
use crate::terminal;
use crate::verdict::Verdict;

#[derive(Args, Debug)]
#[command(
    after_help = "Every part of the plan is a job of an array, and one job more joins their files. DIR must be on a \
    file system that all nodes see; it gets the scripts, journals, logs and the result. The nodes start this program \
    and read suite and models in place. Cores and memory \
    follow from --threads and --memory-limit of the plan, the time from the sizes of the models. A part that is started again on the same \
    node goes on from its journal; on another it starts anew, so that ratios are of one node."
)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is an option of its own"
)]
pub(crate) struct ClusterOptions {
    #[command(flatten)]
    pub(crate) suite_file: SuiteFileOption,

    /// Number of parts, each of which is a job
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) shards: Option<u32>,

    /// Partition of the cluster [default: that of Slurm]
    #[arg(long, value_name = "P")]
    pub(crate) partition: Option<String>,

    /// Keep other jobs off a node while a part runs there
    #[arg(long)]
    pub(crate) exclusive: bool,

    /// Time limit of each part [default: what its runs take on models of such sizes]
    #[arg(long, value_name = "DUR")]
    pub(crate) time: Option<humantime::Duration>,

    /// Further option of sbatch, such as --sbatch=--account=NAME; may be repeated
    #[arg(long, value_name = "OPTION", allow_hyphen_values = true)]
    pub(crate) sbatch: Vec<String>,

    /// Directory of the benchmark, on a file system that the nodes share
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: PathBuf,

    /// Show which parts are done, wait, run or have failed
    #[arg(long, conflicts_with_all = ["resume", "config", "shards", "run"])]
    pub(crate) status: bool,

    /// Submit the parts that have failed again; --time, --partition, --exclusive and --sbatch
    /// override those of before
    #[arg(long, conflicts_with_all = ["config", "shards", "run"])]
    pub(crate) resume: bool,

    /// Write the scripts and print the commands that would submit them
    #[arg(long, conflicts_with_all = ["status", "resume"])]
    pub(crate) no_submit: bool,

    /// Models and options of `geobench run`
    #[arg(last = true, value_name = "RUN OPTIONS")]
    pub(crate) run: Vec<String>,
}

pub(crate) fn cluster(options: &ClusterOptions, look: Look) -> anyhow::Result<Verdict> {
    let directory = ClusterDirectory::new(&options.output)?;
    if options.status {
        return status(&directory, look);
    }
    if options.resume {
        return resume(&directory, options);
    }
    start(&directory, options)
}

/// Writes the scripts of a benchmark, and submits them unless `--no-submit` is given.
fn start(directory: &ClusterDirectory, options: &ClusterOptions) -> anyhow::Result<Verdict> {
    let Some(parts) = options.shards else {
        bail!("--shards is missing: the number of parts, each of which is a job");
    };
    let mut words = vec!["run".to_owned()];
    if let Some(config) = &options.suite_file.config {
        let Some(config) = config.to_str() else {
            bail!(
                "{}: not text in UTF-8, so no script can name it",
                config.display()
            );
        };
        words.extend(["--config".to_owned(), config.to_owned()]);
    }
    words.extend(options.run.iter().cloned());
    let run = run_options(&words)?;
    let Plans { plans, notes, .. } = possible_plans(&run)?;
    let open = plans.iter().any(|plan| plan.sources.has_all());
    let units: u128 = plans.iter().map(Plan::units).sum();
    if !open && units < u128::from(parts) {
        let pairs = if units == 1 { "pair" } else { "pairs" };
        bail!(
            "--shards {parts}: the plan has {units} {pairs} of model and source, so at most as many parts"
        );
    }
    terminal::warnings(&notes);
    directory.create()?;
    let program = std::env::current_exe().context("cannot tell the path of this program")?;
    let here = std::env::current_dir().context("cannot tell the current directory")?;
    let mut lines = vec![format!(
        "the nodes start {} in {}, which they must see",
        program.display(),
        here.display()
    )];
    let mut resources = Resources::of(&plans, parts, run.jobs());
    if let Some(time) = options.time {
        resources.seconds = Some(Duration::from(time).as_secs());
    }
    directory.write(&ClusterJobs {
        parts,
        program,
        directory: here,
        run: words,
        resources,
        options: of_sbatch(options),
    })?;
    lines.push(asked(&resources));
    let quoted = |path: &Path| shell(&path.to_string_lossy());
    if options.no_submit {
        let merge = quoted(&directory.merge_script());
        lines.extend([
            "to submit:".to_owned(),
            format!("  sbatch {}", quoted(&directory.part_script())),
            format!("  sbatch --dependency=afterany:ARRAY {merge}"),
        ]);
    } else {
        let all: Vec<u32> = (1..=parts).collect();
        lines.extend(submit(directory, &all, &[], None)?);
        lines.push(format!(
            "`geobench cluster --status -o {}` shows the parts; the result will be {}",
            quoted(&options.output),
            directory.result().display()
        ));
    }
    terminal::print(&(lines.join("\n") + "\n"))?;
    Ok(Verdict::Passed)
}

/// Submits parts with further options of `sbatch`, and describes the jobs, one per line.
fn submit(
    directory: &ClusterDirectory,
    parts: &[u32],
    options: &[String],
    seconds: Option<u64>,
) -> anyhow::Result<Vec<String>> {
    let (array, merge) = directory.submit(parts, options, seconds)?;
    let (parts, of) = (parts_in_words(parts), directory.parts()?);
    let array = array.map(|job| format!("job {job}: parts {parts} (of {of})"));
    let merge = format!("job {merge}: joins the parts");
    Ok(array.into_iter().chain([merge]).collect())
}

/// The options of `sbatch` that the user gives.
fn of_sbatch(options: &ClusterOptions) -> Vec<String> {
    let partition = options.partition.iter();
    let partition = partition.map(|name| format!("--partition={name}"));
    let exclusive = options.exclusive.then(|| EXCLUSIVE.to_owned());
    let others = options.sbatch.iter().cloned();
    partition.chain(exclusive).chain(others).collect()
}

/// Parses the arguments of the `run` command of the parts. Rejects options that are set for each
/// part separately.
fn run_options(words: &[String]) -> anyhow::Result<RunOptions> {
    let command = RunOptions::augment_args(Command::new("geobench run"));
    let matches = command.try_get_matches_from(words);
    let options = matches.and_then(|matches| RunOptions::from_arg_matches(&matches));
    let options =
        options.map_err(|error| anyhow!("the options of `run`: {}", in_one_line(&error)))?;
    options
        .isolation
        .check(options.jobs(), &options.settings.limits)?;
    let taken = [
        ("--shard", options.shard.is_some()),
        ("--resume", options.resume.is_some()),
        ("--add-to", options.add_to.is_some()),
        ("--output", !options.output.is_empty()),
        (
            "--format",
            words.iter().any(|word| word.starts_with("--format")),
        ),
    ];
    if let Some((name, _)) = taken.iter().find(|(_, given)| *given) {
        bail!("{name}: each part has one of its own; leave it out");
    }
    Ok(options)
}

/// Describes the resources that each job requests.
fn asked(resources: &Resources) -> String {
    let cores = counted(resources.cores, "core");
    let memory = resources.memory_bytes.map_or_else(
        || "the partition's default memory (the plan has no --memory-limit)".to_owned(),
        |bytes| bytesize::ByteSize(bytes).display().iec().to_string(),
    );
    let time = resources.seconds.map_or_else(
        || "the partition's default time".to_owned(),
        |seconds| {
            let time = Duration::from_secs(seconds.div_ceil(60) * 60);
            humantime::format_duration(time).to_string()
        },
    );
    format!("each part asks for {cores}, {memory} and {time}")
}

/// Submits the parts that are neither done nor queued, and the merge job. If all parts are done and
/// only the merged file is missing, submits the merge job alone.
fn resume(directory: &ClusterDirectory, options: &ClusterOptions) -> anyhow::Result<Verdict> {
    let states = directory.states()?;
    let missing: Vec<u32> = (1..)
        .zip(&states)
        .filter(|(_, state)| matches!(state, PartState::Failed(_) | PartState::New))
        .map(|(part, _)| part)
        .collect();
    let done = states.iter().all(|state| *state == PartState::Done);
    let text = if done && directory.result().exists() {
        format!("all parts are done: {}\n", directory.result().display())
    } else if missing.is_empty() && !done {
        "no part has failed; the others wait or run\n".to_owned()
    } else {
        let seconds = options.time.map(|time| Duration::from(time).as_secs());
        submit(directory, &missing, &of_sbatch(options), seconds)?.join("\n") + "\n"
    };
    terminal::print(&text)?;
    Ok(Verdict::Passed)
}

/// Prints the number of parts in each state, and a table of the parts that are not done.
fn status(directory: &ClusterDirectory, look: Look) -> anyhow::Result<Verdict> {
    let states = directory.states()?;
    let count = |is: fn(&PartState) -> bool| states.iter().filter(|state| is(state)).count();
    let done = count(|state| *state == PartState::Done);
    let queued = count(|state| matches!(state, PartState::Queued { .. }));
    let failed = count(|state| matches!(state, PartState::Failed(_)));
    let rows = (1..).zip(&states).filter_map(|(part, state)| {
        let (state, place) = match state {
            PartState::Done => return None,
            PartState::Queued { state, place } => (state.to_lowercase(), place.clone()),
            PartState::Failed(log) => ("failed".to_owned(), log.clone()),
            PartState::New => ("not submitted".to_owned(), String::new()),
        };
        Some([part.to_string(), state, place].map(Entry::new).to_vec())
    });
    let columns = Column::of(["part", "state", "node, or why"], [""; 0]);
    let table = Table::new(columns, rows.collect());
    let head = format!(
        "{done} of {} parts done, {queued} waiting or running, {failed} failed\n",
        states.len()
    );
    let rest = if done < states.len() {
        listing(&table, look)
    } else if directory.result().exists() {
        format!("result: {}\n", directory.result().display())
    } else {
        format!("not joined yet: {}\n", directory.log_tail("merge"))
    };
    let advice = if failed > 0 {
        let path = shell(&directory.path().to_string_lossy());
        format!("`geobench cluster --resume -o {path}` submits the failed parts again\n")
    } else {
        String::new()
    };
    terminal::print_rendered(&[head, rest, advice].concat())?;
    Ok(Verdict::of(failed == 0))
}
