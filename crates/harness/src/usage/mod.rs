//! Input of users: errors in it, files and their schemas, and TOML documents.

pub mod document;

pub use document::DocumentError;
pub use geobench_registry::UsageError;

use std::path::{Path, PathBuf};

use anyhow::Context;

/// Checks the schema of the file `path`.
///
/// # Errors
///
/// When it is not the one of this version.
pub fn check_schema(path: &Path, found: &str, expected: &str) -> anyhow::Result<()> {
    anyhow::ensure!(
        found == expected,
        "{}: `schema` is `{found}`, but this version of geobench reads `{expected}`",
        path.display()
    );
    Ok(())
}

/// The text of a file, without a byte order mark; `-` is standard input.
///
/// # Errors
///
/// When it cannot be read or is not UTF-8.
pub fn read_text(path: &Path) -> std::io::Result<String> {
    if path == Path::new("-") {
        std::io::read_to_string(std::io::stdin()).map(without_mark)
    } else {
        read_file(path)
    }
}

/// As [`read_text`], but `-` is a file like others.
pub(crate) fn read_file(path: &Path) -> std::io::Result<String> {
    std::fs::read_to_string(path).map(without_mark)
}

fn without_mark(mut text: String) -> String {
    if text.starts_with('\u{feff}') {
        text.remove(0);
    }
    text
}

/// The files in `directory` with the extension `ending`, sorted by name. Hidden files are skipped.
///
/// # Errors
///
/// When the directory cannot be read.
pub fn files_in(directory: &Path, ending: &str) -> anyhow::Result<Vec<PathBuf>> {
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
