//! Result files that a command is to write.

use std::path::PathBuf;

use anyhow::bail;

use crate::export::Format;
use crate::output::OutputFile;

/// The files at `paths`, each with the form that its ending asks for, found to be writable.
pub(super) fn results(paths: &[PathBuf]) -> anyhow::Result<Vec<(Format, OutputFile)>> {
    let mut outputs: Vec<(Format, OutputFile)> = Vec::new();
    for path in paths {
        let format = Format::of_path(path)?;
        let file = OutputFile::prepare(path)?;
        if outputs.iter().any(|(_, other)| other.path() == file.path()) {
            bail!("{}: given twice as output", path.display());
        }
        outputs.push((format, file));
    }
    Ok(outputs)
}
