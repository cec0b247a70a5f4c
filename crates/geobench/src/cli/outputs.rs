//! Files that a command is to write, each in the form that its ending asks for.

use std::path::{Path, PathBuf};

use anyhow::bail;

use crate::table::output::OutputFile;
use crate::table::{Format, UnknownEnding};

/// The result files at `paths`, found to be writable.
pub(super) fn results(paths: &[PathBuf]) -> anyhow::Result<Vec<(Format, OutputFile)>> {
    prepare(paths, Format::of_path)
}

/// The files at `paths`, found to be writable, with the forms that `form` knows.
pub(super) fn prepare<F>(
    paths: &[PathBuf],
    form: fn(&Path) -> Result<F, UnknownEnding>,
) -> anyhow::Result<Vec<(F, OutputFile)>> {
    let mut outputs: Vec<(F, OutputFile)> = Vec::new();
    for path in paths {
        let form = form(path)?;
        let file = OutputFile::prepare(path)?;
        if outputs.iter().any(|(_, other)| other.path() == file.path()) {
            bail!("{}: given twice as output", path.display());
        }
        outputs.push((form, file));
    }
    Ok(outputs)
}
