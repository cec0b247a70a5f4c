//! `geobench trend`.

use std::path::{Path, PathBuf};

use anyhow::bail;
use clap::Args;
use geobench_export::json_lines;
use geobench_export::output::{OutputFile, check_files};
use geobench_harness::usage::files_in;
use geobench_report::history::compare::Rules;
use geobench_report::history::order::OrderedHistory;
use geobench_report::history::records::Record;
use geobench_report::history::{gate, records, trend};
use geobench_report::page::trend_page;
use geobench_report::table::{self, Look};

use crate::args::{FormatOption, ListFormat};
use crate::git::{first_parents, full_hash, subjects};
use crate::terminal;
use crate::verdict::Verdict;

#[derive(Args, Debug)]
pub(crate) struct TrendOptions {
    /// Directory of the history
    #[arg(value_name = "DIR")]
    pub(crate) history: PathBuf,

    /// Page to write: one self-contained HTML file
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) line: LineOptions,

    #[command(flatten)]
    pub(crate) gate: GateOption,

    #[command(flatten)]
    pub(crate) format: FormatOption<ListFormat>,
}

/// A commit of a history.
#[derive(Args, Debug)]
pub(crate) struct CommitOption {
    /// The last commit that counts [default: the one that is checked out, else the last one
    /// recorded]
    #[arg(long, value_name = "HASH")]
    pub(crate) commit: Option<String>,
}

/// What counts as worse.
#[derive(Args, Debug)]
pub(crate) struct GateOption {
    /// Fail if the last commit that counts breaks one of these rules, against all earlier ones,
    /// such as time=5%,propagated=0
    #[arg(long, value_name = "RULES")]
    pub(crate) fail_on: Option<Rules>,
}

/// Which records of a history count.
#[derive(Args, Debug)]
pub(crate) struct LineOptions {
    #[command(flatten)]
    pub(crate) last: CommitOption,

    /// Only records of machines with this in their description
    #[arg(long, value_name = "TEXT")]
    pub(crate) machine: Option<String>,
}

/// More commits than any line of first parents has.
const ALL: usize = 1_000_000_000;

/// The records in `directory` that count by `options`, in the order of the last commit and its
/// first parents.
pub(crate) fn ordered(directory: &Path, options: &LineOptions) -> anyhow::Result<OrderedHistory> {
    let mut records = records::read_all(directory)?;
    let commit = options.last.commit.as_deref();
    if let Some(machine) = &options.machine {
        records.retain(|record| record.machine().contains(machine));
        if records.is_empty() {
            bail!("--machine {machine}: no record is of such a machine");
        }
    }
    let known = first_parents(commit.unwrap_or("HEAD"), ALL).unwrap_or_default();
    if let (Some(commit), true) = (commit, known.is_empty()) {
        let recorded = records
            .iter()
            .find(|record| record.commit.starts_with(commit));
        let Some(recorded) = recorded else {
            bail!("--commit {commit}: neither the repository here nor a record knows it");
        };
        let head = vec![recorded.commit.clone()];
        return Ok(OrderedHistory::new(records, &head));
    }
    Ok(OrderedHistory::new(records, &known))
}

pub(crate) fn trend(options: &TrendOptions, look: Look) -> anyhow::Result<Verdict> {
    let page = options
        .output
        .as_deref()
        .map(OutputFile::page)
        .transpose()?;
    check_files(&page, files_in(&options.history, "json")?)?;
    let mut history = ordered(&options.history, &options.line)?;
    if page.is_some() && history.records.iter().any(|r| r.subject.is_none()) {
        let known = subjects(options.line.last.commit.as_deref().unwrap_or("HEAD"));
        for record in &mut history.records {
            let subject = || known.get(&record.commit).cloned();
            record.subject = record.subject.take().or_else(subject);
        }
    }
    terminal::notes(&history.notes);
    let series = trend::series(&history.records);
    let found = trend::change_points(&series);
    if let Some(page) = page {
        page.write(trend_page(&history, &series, &found).as_bytes())?;
        if page.is_standard_output() {
            return Ok(Verdict::Passed);
        }
    }
    let gate = match &options.gate.fail_on {
        Some(rules) => {
            let records = up_to_head(&options.history, history.records, &options.line)?;
            let earlier: Vec<String> = records.iter().map(|r| r.commit.clone()).collect();
            Some(gate::gate(&records, &[], &earlier, rules)?)
        }
        None => None,
    };
    let mut text = match options.format.chosen() {
        ListFormat::Json => json_lines(&found)?,
        ListFormat::Table => table::change_points(&found, look),
    };
    if let Some(gate) = &gate {
        match options.format.chosen() {
            ListFormat::Table => text = [text, "\n".to_owned(), table::gate(gate, look)].concat(),
            // Standard output has the change points alone.
            ListFormat::Json => {
                for line in gate.lines.iter().filter(|line| line.broken.is_some()) {
                    let change = line.in_words();
                    terminal::error(&format!("{}: {} {change}", line.cell, line.figure));
                }
            }
        }
    }
    terminal::print_rendered(&text)?;
    match gate {
        Some(gate) if gate.has_compared_nothing() => bail!("nothing could be compared"),
        Some(gate) => Ok(Verdict::of(!gate.is_worse())),
        None => Ok(Verdict::Passed),
    }
}

/// The records up to the last commit that counts by `options`. Without a repository all of them.
pub(crate) fn up_to_head(
    directory: &Path,
    mut records: Vec<Record>,
    options: &LineOptions,
) -> anyhow::Result<Vec<Record>> {
    let head = options.last.commit.as_deref().unwrap_or("HEAD");
    if let Some(hash) = full_hash(head) {
        let is_of_head = |record: &Record| hash.starts_with(&record.commit);
        let Some(last) = records.iter().rposition(is_of_head) else {
            bail!(
                "{}: no record of {head} ({}); add it with `geobench record`, or name another \
                 commit with --commit",
                directory.display(),
                &hash[..12]
            );
        };
        records.truncate(last + 1);
    }
    Ok(records)
}
