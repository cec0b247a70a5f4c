//! Input of users: errors in it, and TOML files.

pub(crate) mod document;

pub use document::DocumentError;

use std::path::{Path, PathBuf};

use anyhow::Context;

/// Returns an error if the schema of the file `path` is not the one of this version.
pub(crate) fn check_schema(path: &Path, found: &str, expected: &str) -> anyhow::Result<()> {
    anyhow::ensure!(
        found == expected,
        "{}: `schema` is `{found}`, but this version of geobench reads `{expected}`",
        path.display()
    );
    Ok(())
}

/// The files in `directory` with the extension `ending`, sorted by name. Hidden files are skipped.
pub(crate) fn files_in(directory: &Path, ending: &str) -> anyhow::Result<Vec<PathBuf>> {
    let failed = || format!("{}: cannot be read", directory.display());
    let mut paths = Vec::new();
    for entry in directory.read_dir().with_context(failed)? {
        let path = entry.with_context(failed)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let has_ending = path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case(ending));
        if has_ending && !name.starts_with('.') {
            paths.push(path);
        }
    }
    paths.sort_unstable();
    Ok(paths)
}

/// An invalid value from the command line or a file. The message quotes the value and names the
/// allowed ones.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct UsageError(pub(crate) String);
