//! `geobench record`.

use std::path::PathBuf;
use std::time::{Duration, SystemTime};

use anyhow::{Context, bail};
use clap::Args;
use geobench_harness::schema::result_file;
use geobench_report::history::records::{self, Record};

use crate::git::git;
use crate::terminal;
use crate::verdict::Verdict;

#[derive(Args, Debug)]
pub(crate) struct RecordOptions {
    /// Result files (.json)
    #[arg(value_name = "RESULT", required = true)]
    pub(crate) results: Vec<PathBuf>,

    /// Directory of the history; made if it does not exist
    #[arg(long, value_name = "DIR")]
    pub(crate) into: PathBuf,

    /// The commit that was measured [default: that of the result file]
    #[arg(long, value_name = "HASH")]
    pub(crate) commit: Option<String>,

    /// The time of a commit that the repository here does not know, such as 2025-03-04T05:06:07Z
    #[arg(long, value_name = "TIME", value_parser = time)]
    pub(crate) date: Option<String>,

    /// The suite; records of different suites are not compared [default: the name of the suite file]
    #[arg(long, value_name = "NAME")]
    pub(crate) suite: Option<String>,

    /// Do not print the path of the record
    #[arg(long)]
    pub(crate) quiet: bool,
}

pub(crate) fn record(options: &RecordOptions) -> anyhow::Result<Verdict> {
    let mut all = Vec::new();
    for path in &options.results {
        let file = result_file::read(path)?;
        // All records of a commit have its full hash, so that they are joined.
        let named = options.commit.as_deref();
        let named = named.map(|name| full_hash(name).unwrap_or_else(|| name.to_owned()));
        let commit = named.as_deref().or(file.tool.commit.as_deref());
        let committed = options.date.clone().or_else(|| commit.and_then(time_of));
        if let (Some(commit), None) = (commit, &committed) {
            bail!(
                "{}: the repository here does not know the commit {commit}; give the one that was \
                 measured with --commit, or its time with --date",
                path.display()
            );
        }
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

/// Parses a time: RFC 3339 in UTC, or a date alone.
fn time(text: &str) -> Result<String, String> {
    let whole = [text.to_owned(), format!("{text}T00:00:00Z")];
    let found = whole
        .iter()
        .find_map(|text| humantime::parse_rfc3339(text).ok());
    let found = found.ok_or("give a time such as 2025-03-04T05:06:07Z, or a date")?;
    Ok(humantime::format_rfc3339_seconds(found).to_string())
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
