//! `geobench compare`.

use std::path::PathBuf;

use anyhow::bail;
use clap::Args;
use geobench_export::{json_lines, output};
use geobench_harness::schema::result_file;
use geobench_harness::usage::files_in;
use geobench_report::history::compare::{self as comparing, BaselineComparisons};
use geobench_report::history::gate;
use geobench_report::table::{self, ComparisonFormat, Look};

use super::trend::{GateOption, LineOptions, ordered, up_to_head};
use crate::args::FormatOption;
use crate::git::{full_hash, git};
use crate::terminal;
use crate::verdict::Verdict;

/// Help text of `compare` on rules.
const FAIL_ON_HELP: &str = "What counts as a regression, separated by commas; without any, only a cell \
    that does not end well any more";

const RULES_HELP: &str = "A rule is NAME=LIMIT, such as time=10%,propagated=0,heap_peak_bytes=5%. `time` is broken if the \
    95 % interval of the ratio of the times lies wholly beyond the limit. A counter (`geobench algos \
    --counters`) may change by no more than the limit in either direction, or, with a plus as in \
    propagated=+0, only not grow by more. `instructions` and the memories papers_bytes, \
    windows_peak_bytes, heap_peak_bytes and rss_peak_bytes may shrink. `missing` is broken if the new file lacks \
    more than this share of the cells of the old one. Exit status: 0 nothing is worse; 1 \
    something is worse; 2 a file cannot be used, or nothing could be compared. With --against, until records of \
    three of the commits exist: 0, learning.";

#[derive(Args, Debug)]
#[command(
    after_help = RULES_HELP,
    mut_arg("fail_on", |rules| rules.help(FAIL_ON_HELP)),
)]
pub(crate) struct CompareOptions {
    /// Result files (.json), the older ones first; with --against the directory of a history
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<PathBuf>,

    /// The file that counts as 1 [default: the first]
    #[arg(long, value_name = "FILE", conflicts_with = "against")]
    pub(crate) baseline: Option<PathBuf>,

    /// Compare the record of a commit in a history with those of these commits, such as
    /// HEAD~10..HEAD; the noise of a time is that from commit to commit
    #[arg(long, value_name = "RANGE")]
    pub(crate) against: Option<String>,

    #[command(flatten)]
    pub(crate) line: LineOptions,

    #[command(flatten)]
    pub(crate) gate: GateOption,

    #[command(flatten)]
    pub(crate) format: FormatOption<ComparisonFormat>,

    /// File to write as well, by its ending: .json, .md or .txt; may be repeated
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Vec<PathBuf>,
}

pub(crate) fn compare(options: &CompareOptions, look: Look) -> anyhow::Result<Verdict> {
    if let Some(range) = &options.against {
        return against(options, range, look);
    }
    if options.line.last.commit.is_some() || options.line.machine.is_some() {
        bail!("--commit and --machine choose among the records of a history; add --against");
    }
    let outputs = output::prepare::<ComparisonFormat>(&options.output)?;
    let mut paths = options.files.clone();
    if let Some(baseline) = &options.baseline {
        // The baseline may also be among the files. It must come first, once.
        paths.retain(|path| path != baseline);
        paths.insert(0, baseline.clone());
    }
    if paths.len() < 2 {
        bail!("{}: give two or more files to compare", paths[0].display());
    }
    output::check_files(outputs.iter().map(|(_, file)| file), &paths)?;
    let files = result_file::read_all(&paths)?;
    let rules = options.gate.fail_on.clone().unwrap_or_default();
    let (name, first) = &files[0];
    let render: Box<dyn Fn(ComparisonFormat, Look) -> anyhow::Result<String>>;
    let is_worse;
    let unjudged;
    if let [(new_name, new)] = &files[1..] {
        let comparison = comparing::compare((name, first), (new_name, new), &rules)?;
        is_worse = comparison.is_worse();
        unjudged = comparison.unjudged_rule(&rules);
        render = Box::new(move |format, look| format.render(&comparison, look));
    } else {
        let several = BaselineComparisons::new((name, first), &files[1..], &rules)?;
        is_worse = several.is_worse();
        let mut files = several.comparisons.iter();
        unjudged = files.find_map(|file| file.unjudged_rule(&rules));
        render = Box::new(move |format, look| format.render_several(&several, look));
    }
    for (format, file) in &outputs {
        file.write(render(*format, Look::default())?.as_bytes())?;
    }
    if outputs.iter().all(|(_, file)| !file.is_standard_output()) {
        terminal::print_rendered(&render(options.format.chosen(), look)?)?;
    }
    if let (Some(rule), false) = (unjudged, is_worse) {
        bail!(
            "the rule {rule}: an interval of the time takes six runs of each file, with times above 0"
        );
    }
    Ok(Verdict::of(!is_worse))
}

/// `compare --against`: compares the newest record of a history with those of a range of commits.
fn against(options: &CompareOptions, range: &str, look: Look) -> anyhow::Result<Verdict> {
    let [directory] = &options.files[..] else {
        bail!("--against compares within one history; give its directory alone");
    };
    let outputs = output::prepare::<ComparisonFormat>(&options.output)?;
    let read = files_in(directory, "json")?;
    output::check_files(outputs.iter().map(|(_, file)| file), read)?;
    let history = ordered(directory, &options.line)?;
    terminal::notes(&history.notes);
    let records = up_to_head(directory, history.records, &options.line)?;
    let commits = commits_of(range, &history.line)?;
    let rules = options.gate.fail_on.clone().unwrap_or_default();
    let gate = gate::gate(&records, &history.apart, &commits, &rules)?;
    let render = |format: ComparisonFormat, look: Look| match format {
        ComparisonFormat::Json => json_lines(&gate),
        ComparisonFormat::Table => Ok(table::gate(&gate, look)),
        ComparisonFormat::Markdown => Ok(table::gate_in_markdown(&gate)),
    };
    for (format, file) in &outputs {
        file.write(render(*format, Look::default())?.as_bytes())?;
    }
    if outputs.iter().all(|(_, file)| !file.is_standard_output()) {
        terminal::print_rendered(&render(options.format.chosen(), look)?)?;
    }
    if gate.has_compared_nothing() {
        bail!("nothing could be compared");
    }
    Ok(Verdict::of(!gate.is_worse()))
}

/// The commits of a range, full hashes. A range that begins before the first commit begins there,
/// with a note. What the repository here does not know, as a shallow clone or none, is looked for
/// in `line`, the commits that the history knows, the newest first.
fn commits_of(range: &str, line: &[String]) -> anyhow::Result<Vec<String>> {
    let list = |range: &str| git(&["rev-list", "--end-of-options", range]);
    let mut found = list(range);
    // `None` without a repository.
    let is_shallow = git(&["rev-parse", "--is-shallow-repository"]);
    let is_shallow = is_shallow.map(|text| text.trim() == "true");
    if found.is_none()
        && is_shallow != Some(false)
        && let Some(commits) = range_in(range, line)
    {
        return Ok(commits.to_vec());
    }
    // `HEAD~10` where `HEAD` has fewer commits before it.
    let is_before_all = |begin: &str| {
        let commit = begin.split(['~', '^']).next();
        commit.is_some_and(|commit| commit != begin && full_hash(commit).is_some())
    };
    if let (None, Some((begin, end))) = (&found, range.split_once(".."))
        && is_before_all(begin)
    {
        if is_shallow == Some(true) {
            bail!(
                "--against {range}: this clone is shallow and has no such beginning; fetch more of it"
            );
        }
        let end = if end.is_empty() { "HEAD" } else { end };
        found = list(end);
        if found.is_some() {
            terminal::notes(&[format!(
                "--against {range}: the repository here has no such beginning; all commits up to {end}"
            )]);
        }
    }
    let Some(found) = found else {
        bail!("--against {range}: not a range of commits of the git repository here");
    };
    Ok(found.lines().map(str::to_owned).collect())
}

/// The commits of `line`, the newest first, in a range `BEGIN..END`, or up to a single commit. An
/// end is `HEAD`, the first commit, or the beginning of a hash, with `~N` or `^`; one of `BEGIN`
/// that is beyond the line takes all.
fn range_in<'l>(range: &str, line: &'l [String]) -> Option<&'l [String]> {
    let place = |name: &str| {
        let (commit, back) = match name.split_once(['~', '^']) {
            Some((commit, "")) => (commit, 1),
            Some((commit, back)) => (commit, back.parse().ok()?),
            None => (name, 0),
        };
        let found = match commit {
            "" | "HEAD" => 0,
            hash if hash.len() >= 4 => line.iter().position(|known| known.starts_with(hash))?,
            _ => return None,
        };
        found.checked_add(back)
    };
    let (begin, end) = range.split_once("..").unwrap_or(("", range));
    let until = match begin {
        "" if !range.contains("..") => line.len(),
        begin => place(begin)?.min(line.len()),
    };
    line.get(place(end)?..until)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_of_commits_are_found_in_a_history() {
        let line: Vec<String> = (0..5).map(|k| format!("{k}abcdef")).collect();
        let found = |range| range_in(range, &line).map(<[String]>::len);
        assert_eq!(range_in("HEAD~3..HEAD", &line), Some(&line[..3]));
        assert_eq!(range_in("3abc..1abc", &line), Some(&line[1..3]));
        assert_eq!(range_in("HEAD^..", &line), Some(&line[..1]));
        assert_eq!(found("2abcd"), Some(3));
        assert_eq!(found("HEAD~9..HEAD~1"), Some(4));
        assert_eq!(found("main..HEAD"), None);
        assert_eq!(found("HEAD~x..HEAD"), None);
    }
}
