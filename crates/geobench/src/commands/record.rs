//! `geobench record`.

use std::path::PathBuf;
use std::time::{Duration, SystemTime};

use anyhow::{Context, bail};
use clap::Args;
use geobench_harness::schema::{RepositoryRecord, ResultFile, result_file};
use geobench_report::history::records::{self, Record};

use super::trend::CommitOption;
use crate::args::QuietOption;
use crate::git::{first_parents, full_hash, git};
use crate::terminal;
use crate::verdict::Verdict;

#[derive(Args, Debug)]
#[command(
    mut_arg("commit", |commit| commit.help(
        "The commit that was measured [default: that of the repository in which the run was started]"
    )),
    mut_arg("quiet", |quiet| quiet.help("Do not print the path of the record")),
)]
pub(crate) struct RecordOptions {
    /// Result files (.json)
    #[arg(value_name = "RESULT", required = true)]
    pub(crate) results: Vec<PathBuf>,

    /// Directory of the history; made if it does not exist
    #[arg(long, value_name = "DIR")]
    pub(crate) into: PathBuf,

    #[command(flatten)]
    pub(crate) measured: CommitOption,

    /// The time of a commit that the repository here does not know, such as 2025-03-04T05:06:07Z
    #[arg(long, value_name = "TIME", value_parser = time)]
    pub(crate) date: Option<String>,

    /// Record also what was measured with changes that no commit has
    #[arg(long)]
    pub(crate) dirty: bool,

    /// The suite; records of different suites are not compared [default: the name of the suite
    /// file]
    #[arg(long, value_name = "SUITE")]
    pub(crate) suite: Option<String>,

    #[command(flatten)]
    pub(crate) quiet: QuietOption,
}

pub(crate) fn record(options: &RecordOptions) -> anyhow::Result<Verdict> {
    let mut all = Vec::new();
    for path in &options.results {
        let file = result_file::read(path)?;
        let record = of_file(&file, options).with_context(|| path.display().to_string())?;
        all.push(record);
    }
    for record in all {
        let path = records::add(&options.into, record)?;
        if !options.quiet.is_set {
            terminal::print(&format!("{}\n", path.display()))?;
        }
    }
    Ok(Verdict::Passed)
}

/// The record of a result file.
fn of_file(file: &ResultFile, options: &RecordOptions) -> anyhow::Result<Record> {
    let suite = options.suite.clone().or_else(|| file.suite());
    let measured = measured(file, options)?;
    // All records of a commit have its full hash, so that they are joined.
    let mut line = first_parents(&measured, RepositoryRecord::FIRST_PARENTS + 1);
    if line.is_none() {
        let stored = file.repository.iter();
        let mut stored = stored.filter(|stored| stored.commit == measured);
        line = stored.next().map(|stored| {
            let commit = std::iter::once(stored.commit.clone());
            commit.chain(stored.ancestors.iter().cloned()).collect()
        });
    }
    let committed = options.date.clone().or_else(|| time_of(&measured));
    if line.is_none() && committed.is_none() {
        bail!(
            "neither the file nor the repository here knows the commit {measured}; give the one \
             that was measured with --commit, or its time with --date"
        );
    }
    let mut line = line.unwrap_or_else(|| vec![measured]);
    let commit = line.remove(0);
    let subject = git(&["show", "-s", "--format=%s", "--end-of-options", &commit]);
    let mut record = Record::new(file, &commit, line, committed, suite)?;
    record.subject = subject.map(|subject| subject.trim().to_owned());
    Ok(record)
}

/// The commit that was measured: that of `--commit`; else the one that the program was built from,
/// if the repository here has it, so that it is the repository of geobench; else the one that was
/// checked out where the run was started.
fn measured(file: &ResultFile, options: &RecordOptions) -> anyhow::Result<String> {
    let built = file.tool.commit.clone();
    if let Some(commit) = &options.measured.commit {
        return Ok(commit.clone());
    }
    if let Some(commit) = built.as_ref().filter(|commit| full_hash(commit).is_some()) {
        return Ok(commit.clone());
    }
    if let Some(repository) = &file.repository {
        if repository.dirty && !options.dirty {
            bail!(
                "it was measured with changes that {} does not have; commit them and run again, or \
                 record it all the same with --dirty",
                repository.commit
            );
        }
        return Ok(repository.commit.clone());
    }
    match built {
        Some(commit) if options.date.is_some() => Ok(commit),
        _ => bail!(
            "the file does not say which commit was measured; give it with --commit, and its time \
             with --date if no repository here knows it"
        ),
    }
}

/// Parses a time: RFC 3339 with any offset, or a date alone.
fn time(text: &str) -> Result<String, String> {
    let whole = [text.to_owned(), format!("{text}T00:00:00Z")];
    let utc = whole
        .iter()
        .find_map(|text| humantime::parse_rfc3339(text).ok());
    let found = utc.or_else(|| with_offset(text));
    let found = found.ok_or("give a time such as 2025-03-04T05:06:07Z, or a date")?;
    Ok(humantime::format_rfc3339_seconds(found).to_string())
}

/// Parses a time such as `2025-03-04T05:06:07+02:00`, as `git log --format=%cI` prints it.
fn with_offset(text: &str) -> Option<SystemTime> {
    let (local, offset) = text.split_at_checked(text.len().checked_sub("+00:00".len())?)?;
    let sign = offset.chars().next().filter(|sign| "+-".contains(*sign))?;
    let (hours, minutes) = offset[1..].split_once(':')?;
    let number = |digits: &str| {
        let is_number = digits.len() == 2 && digits.bytes().all(|b| b.is_ascii_digit());
        is_number.then(|| digits.parse::<u64>().ok()).flatten()
    };
    let offset = Duration::from_secs(3600 * number(hours)? + 60 * number(minutes)?);
    let local = humantime::parse_rfc3339(&format!("{local}Z")).ok()?;
    if sign == '+' {
        local.checked_sub(offset)
    } else {
        local.checked_add(offset)
    }
}

/// Commit time in the repository of the current directory, RFC 3339 in UTC. `None` if the commit is
/// unknown there.
fn time_of(commit: &str) -> Option<String> {
    let seconds = git(&["show", "-s", "--format=%ct", "--end-of-options", commit])?;
    let seconds = Duration::from_secs(seconds.trim().parse().ok()?);
    let time = SystemTime::UNIX_EPOCH.checked_add(seconds)?;
    Some(humantime::format_rfc3339_seconds(time).to_string())
}
