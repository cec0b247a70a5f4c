//! Input of users: errors in it, files and their schemas, and TOML documents.

pub(crate) mod document;

pub use document::DocumentError;
pub use geobench_registry::UsageError;

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

/// The text of a file; `-` is standard input.
pub(crate) fn read_text(path: &Path) -> std::io::Result<String> {
    if path == Path::new("-") {
        std::io::read_to_string(std::io::stdin())
    } else {
        std::fs::read_to_string(path)
    }
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

/// A temporary file in `directory`. It has the usual mode of new files, restricted by the umask, so
/// that others can read what it is renamed to; `tempfile` alone would create a private file.
pub(crate) fn temporary_file(
    directory: &Path,
    ending: &str,
) -> std::io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".geobench-").suffix(ending);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(directory)
}
