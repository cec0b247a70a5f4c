//! The git repository of the current directory.

use std::collections::HashMap;
use std::process::Command;

use geobench_harness::schema::RepositoryRecord;

/// Options that override any configuration: nothing is written, no program of the repository is
/// started, and signatures are not shown among the texts.
const ALWAYS: [&str; 5] = [
    "--no-optional-locks",
    "-c",
    "core.fsmonitor=false",
    "-c",
    "log.showSignature=false",
];

/// Standard output of `git` with these arguments, run in the current directory. `None` if it fails.
pub(crate) fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(ALWAYS).args(arguments).output();
    let output = output.ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then_some(text)
}

/// The state of the repository; `None` outside of one, and before its first commit.
pub(crate) fn repository() -> Option<RepositoryRecord> {
    let mut line = first_parents("HEAD", RepositoryRecord::FIRST_PARENTS + 1)?;
    let changes = git(&["status", "--porcelain", "--untracked-files=no"])?;
    Some(RepositoryRecord {
        commit: line.remove(0),
        dirty: !changes.is_empty(),
        ancestors: line,
    })
}

/// The hashes of a commit and its first parents, the newest first, at most `count`. `None` if the
/// commit is unknown.
pub(crate) fn first_parents(commit: &str, count: usize) -> Option<Vec<String>> {
    let count = format!("--max-count={count}");
    let text = git(&[
        "rev-list",
        "--first-parent",
        &count,
        "--end-of-options",
        commit,
    ])?;
    let line: Vec<String> = text.lines().map(str::to_owned).collect();
    (!line.is_empty()).then_some(line)
}

/// The first lines of the messages of a commit and all before it, by their hashes; empty if the
/// commit is unknown.
pub(crate) fn subjects(commit: &str) -> HashMap<String, String> {
    let text = git(&["log", "--format=%H %s", "--end-of-options", commit]).unwrap_or_default();
    let lines = text.lines().filter_map(|line| line.split_once(' '));
    let lines = lines.map(|(hash, subject)| (hash.to_owned(), subject.to_owned()));
    lines.collect()
}

/// The full hash of a commit. `None` if it is unknown.
pub(crate) fn full_hash(commit: &str) -> Option<String> {
    let commit = format!("{commit}^{{commit}}");
    let arguments = ["rev-parse", "--verify", "--quiet", "--end-of-options"];
    let hash = git(&[&arguments[..], &[&commit]].concat())?;
    Some(hash.trim().to_owned())
}
