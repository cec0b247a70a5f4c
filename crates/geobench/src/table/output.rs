//! Files that a command writes: found unwritable before the work starts, and replaced whole.

use std::fs::{self, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

use crate::table::{Format, UnknownEnding};

/// A file to be written at the end of some work.
#[derive(Clone, Debug)]
pub struct OutputFile {
    /// As the user wrote it.
    shown: String,
    /// The same for all ways to write it.
    path: PathBuf,
    /// Devices and pipes are written to as they are; a regular file is replaced.
    replace: bool,
}

impl OutputFile {
    /// Makes sure that `path` can be written, without changing anything there.
    ///
    /// # Errors
    ///
    /// When its directory does not exist or cannot be written to, or the path is a directory or a
    /// file that cannot be written.
    pub fn prepare(path: &Path) -> anyhow::Result<Self> {
        let shown = path.display().to_string();
        // A link is followed, so that the file that it points to is replaced and not the link.
        let path = canonical(path);
        let replace = match fs::metadata(&path) {
            Ok(found) if found.is_dir() => bail!("{shown}: cannot be written: it is a directory"),
            Ok(found) => {
                OpenOptions::new()
                    .append(true)
                    .open(&path)
                    .map_err(|error| plain(&error))
                    .with_context(|| format!("{shown}: cannot be written"))?;
                found.is_file()
            }
            Err(_) => true,
        };
        let file = Self {
            shown,
            path,
            replace,
        };
        if replace {
            file.temporary("")
                .map_err(|error| plain(&error))
                .with_context(|| file.failure())?;
        }
        Ok(file)
    }

    /// Where it is written; equal for files that are the same.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether writing replaces what was written before; devices and pipes take one after the
    /// other.
    pub const fn is_replaced(&self) -> bool {
        self.replace
    }

    /// Writes `contents`; whoever reads the file sees either what was there before or all of it.
    ///
    /// # Errors
    ///
    /// When the system cannot write; the file is then as it was.
    pub fn write(&self, contents: &[u8]) -> anyhow::Result<()> {
        if !self.replace {
            return fs::write(&self.path, contents).with_context(|| self.failure());
        }
        self.write_with("", |path| Ok(fs::write(path, contents)?))
    }

    /// Lets `write` write a file of some other name that ends in `ending`, and puts it in place.
    ///
    /// # Errors
    ///
    /// When `write` fails or the file cannot be put in place; what was there before is then as it
    /// was.
    pub fn write_with(
        &self,
        ending: &str,
        write: impl FnOnce(&Path) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        let file = self
            .temporary(ending)
            .map_err(|error| plain(&error))
            .with_context(|| self.failure())?;
        write(file.path()).with_context(|| self.failure())?;
        file.persist(&self.path)
            .map_err(|error| error.error)
            .with_context(|| self.failure())?;
        Ok(())
    }

    fn failure(&self) -> String {
        format!("{}: cannot be written", self.shown)
    }

    /// A file in the same directory, which a rename can then put in place.
    fn temporary(&self, ending: &str) -> io::Result<tempfile::NamedTempFile> {
        let directory = match self.path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        let mut builder = tempfile::Builder::new();
        builder.prefix(".geobench-").suffix(ending);
        // What the process's umask leaves of it; without this nobody else could read the file.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        builder.tempfile_in(directory)
    }
}

/// The one way to name a file, whether it exists or not.
pub(crate) fn canonical(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| in_canonical_directory(path))
}

/// A file that does not exist yet, in the one way to name it if its directory exists.
fn in_canonical_directory(path: &Path) -> PathBuf {
    let canonical = || {
        let directory = match path.parent()? {
            parent if parent.as_os_str().is_empty() => Path::new("."),
            parent => parent,
        };
        Some(fs::canonicalize(directory).ok()?.join(path.file_name()?))
    };
    canonical().unwrap_or_else(|| path.to_owned())
}

/// The error without the name of a temporary file, which means nothing to a user.
fn plain(error: &io::Error) -> anyhow::Error {
    match error.kind() {
        io::ErrorKind::NotFound => anyhow::anyhow!("its directory does not exist"),
        kind => anyhow::anyhow!("{kind}"),
    }
}

/// The result files at `paths`, found to be writable.
pub(crate) fn results(paths: &[PathBuf]) -> anyhow::Result<Vec<(Format, OutputFile)>> {
    prepare(paths, Format::of_path)
}

/// The files at `paths`, found to be writable, with the forms that `form` knows.
pub(crate) fn prepare<F>(
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_whole_and_nothing_is_left_beside_it() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("x.csv");
        let file = OutputFile::prepare(&path).unwrap();
        assert!(!path.exists(), "preparing writes nothing");
        file.write(b"long contents").unwrap();
        file.write(b"short").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"short");
        assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 1);
    }

    #[test]
    fn what_cannot_be_written_is_found_at_once() {
        let directory = tempfile::tempdir().unwrap();
        let error = OutputFile::prepare(directory.path()).unwrap_err();
        assert!(error.to_string().contains("it is a directory"));
        let missing = directory.path().join("no/such/x.csv");
        let error = OutputFile::prepare(&missing).unwrap_err();
        assert!(
            format!("{error:#}").contains("x.csv: cannot be written: its directory does not exist")
        );
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_a_link() {
        let directory = tempfile::tempdir().unwrap();
        let (real, link) = (directory.path().join("real"), directory.path().join("link"));
        fs::write(&real, "old").unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        OutputFile::prepare(&link).unwrap().write(b"new").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&real).unwrap(), b"new");
    }
}
