//! `geobench record`, `geobench trend`, and `geobench compare DIR --against RANGE`.

use std::path::PathBuf;
use std::process::Command;
use std::time::{Duration, SystemTime};

use anyhow::{Context, bail};
use clap::Args;
use geobench_export::json_lines;
use geobench_export::output::OutputFile;
use geobench_harness::schema::result_file;
use geobench_report::history::records::{self, Record};
use geobench_report::history::{gate, trend};
use geobench_report::page as report;
use geobench_report::table::{self, ComparisonFormat, Look};

use super::Verdict;
use super::args::ListFormat;
use super::compare::CompareOptions;
use super::terminal;

#[derive(Args, Debug)]
pub(super) struct RecordOptions {
    /// Result files (.json)
    #[arg(value_name = "RESULT", required = true)]
    pub(super) results: Vec<PathBuf>,

    /// Directory of the history; made if it does not exist
    #[arg(long, value_name = "DIR")]
    pub(super) into: PathBuf,

    /// The commit that was measured [default: that of the result file]
    #[arg(long, value_name = "HASH")]
    pub(super) commit: Option<String>,

    /// The suite; records of different suites are not compared [default: the name of the suite file]
    #[arg(long, value_name = "NAME")]
    pub(super) suite: Option<String>,

    /// Do not print the path of the record
    #[arg(long)]
    pub(super) quiet: bool,
}

#[derive(Args, Debug)]
pub(super) struct TrendOptions {
    /// Directory of the history
    #[arg(value_name = "DIR")]
    pub(super) history: PathBuf,

    /// Page to write: one self-contained HTML file
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,

    /// How to show the change points
    #[arg(long, value_name = "FORMAT", value_enum, default_value_t)]
    pub(super) format: ListFormat,
}

pub(super) fn record(options: &RecordOptions) -> anyhow::Result<Verdict> {
    let mut all = Vec::new();
    for path in &options.results {
        let file = result_file::read(path)?;
        // All records of a commit have its full hash, so that they are joined.
        let named = options.commit.as_deref();
        let named = named.map(|name| full_hash(name).unwrap_or_else(|| name.to_owned()));
        let commit = named.as_deref().or(file.tool.commit.as_deref());
        let committed = commit.and_then(time_of);
        let suite = options.suite.clone().or_else(|| file.suite());
        let record = Record::new(&file, named.as_deref(), committed, suite);
        all.push(record.with_context(|| path.display().to_string())?);
    }
    for record in all {
        let path = records::add(&options.into, record)?;
        if !options.quiet {
            terminal::print(&format!("{}\n", path.display()))?;
        }
    }
    Ok(Verdict::Passed)
}

/// Standard output of `git` with these arguments, run in the current directory. `None` if it fails.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then_some(text)
}

/// The full hash of a commit in the repository of the current directory. `None` if it is unknown
/// there.
fn full_hash(commit: &str) -> Option<String> {
    let commit = format!("{commit}^{{commit}}");
    let hash = git(&[
        "rev-parse",
        "--verify",
        "--quiet",
        "--end-of-options",
        &commit,
    ])?;
    Some(hash.trim().to_owned())
}

/// Commit time in the repository of the current directory, RFC 3339 in UTC. `None` if the commit is
/// unknown there.
fn time_of(commit: &str) -> Option<String> {
    let seconds = git(&["show", "-s", "--format=%ct", "--end-of-options", commit])?;
    let seconds = Duration::from_secs(seconds.trim().parse().ok()?);
    let time = SystemTime::UNIX_EPOCH.checked_add(seconds)?;
    Some(humantime::format_rfc3339_seconds(time).to_string())
}

pub(super) fn trend(options: &TrendOptions, look: Look) -> anyhow::Result<Verdict> {
    let page = options
        .output
        .as_deref()
        .map(OutputFile::page)
        .transpose()?;
    let records = records::read_all(&options.history)?;
    let series = trend::series(&records);
    let found = trend::change_points(&series);
    if let Some(page) = page {
        page.write(report::trend_page(&records, &series, &found).as_bytes())?;
        if page.is_standard_output() {
            return Ok(Verdict::Passed);
        }
    }
    terminal::print_rendered(&match options.format {
        ListFormat::Json => json_lines(&found)?,
        ListFormat::Table => table::change_points(&found, look),
    })?;
    Ok(Verdict::Passed)
}

/// `compare --against`: compares the newest record of a history with those of a range of commits.
pub(super) fn against(
    options: &CompareOptions,
    range: &str,
    look: Look,
) -> anyhow::Result<Verdict> {
    let [history] = &options.files[..] else {
        bail!("--against compares within one history; give its directory alone");
    };
    let records = records::read_all(history)?;
    let Some(commits) = git(&["rev-list", "--end-of-options", range]) else {
        bail!("--against {range}: not a range of commits of the git repository here");
    };
    let commits: Vec<String> = commits.lines().map(str::to_owned).collect();
    let rules = options.fail_on.clone().unwrap_or_default();
    let gate = gate::gate(&records, &commits, &rules)?;
    let table = || table::gate(&gate, look);
    terminal::print_rendered(&match options.format {
        ComparisonFormat::Json => json_lines(&gate)?,
        ComparisonFormat::Table => table(),
        ComparisonFormat::Markdown => format!("```text\n{}```\n", table()),
    })?;
    Ok(Verdict::of(!gate.is_worse()))
}
