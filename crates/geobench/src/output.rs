//! Files that a command writes: found unwritable before the work starts, and replaced whole.

use std::fs::{self, OpenOptions, Permissions};
use std::io;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

/// A file to be written at the end of some work.
#[derive(Clone, Debug)]
pub struct OutputFile {
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
        let shown = path.display();
        // A link is followed, so that the file that it points to is replaced and not the link.
        let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let replace = match fs::metadata(&path) {
            Ok(found) if found.is_dir() => bail!("{shown}: cannot be written: it is a directory"),
            Ok(found) => {
                OpenOptions::new()
                    .append(true)
                    .open(&path)
                    .map_err(plain)
                    .with_context(|| format!("{shown}: cannot be written"))?;
                found.is_file()
            }
            Err(_) => true,
        };
        let file = Self { path, replace };
        if replace {
            file.temporary("")
                .map_err(plain)
                .with_context(|| format!("{shown}: cannot be written"))?;
        }
        Ok(file)
    }

    /// Where it is written.
    pub fn path(&self) -> &Path {
        &self.path
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
            .map_err(plain)
            .with_context(|| self.failure())?;
        write(file.path()).with_context(|| self.failure())?;
        file.persist(&self.path)
            .map_err(|error| error.error)
            .with_context(|| self.failure())?;
        Ok(())
    }

    fn failure(&self) -> String {
        format!("{}: cannot be written", self.path.display())
    }

    /// A file in the same directory, which a rename can then put in place.
    fn temporary(&self, ending: &str) -> io::Result<tempfile::NamedTempFile> {
        let directory = match self.path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        let mut builder = tempfile::Builder::new();
        builder.prefix(".geobench-").suffix(ending);
        let permissions = usual_permissions();
        if let Some(permissions) = permissions {
            builder.permissions(permissions);
        }
        builder.tempfile_in(directory)
    }
}

/// The error without the name of a temporary file, which means nothing to a user.
fn plain(error: io::Error) -> anyhow::Error {
    match error.kind() {
        io::ErrorKind::NotFound => anyhow::anyhow!("its directory does not exist"),
        kind => anyhow::anyhow!("{kind}"),
    }
}

/// What the process's umask leaves of reading and writing for everyone.
#[cfg(unix)]
fn usual_permissions() -> Option<Permissions> {
    use std::os::unix::fs::PermissionsExt;
    Some(Permissions::from_mode(0o666))
}

#[cfg(not(unix))]
fn usual_permissions() -> Option<Permissions> {
    None
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
