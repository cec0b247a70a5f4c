//! The git repository of the current directory.

use std::process::Command;

/// Standard output of `git` with these arguments, run in the current directory. `None` if it fails.
pub(crate) fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then_some(text)
}
