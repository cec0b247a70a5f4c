//! Output files. They are checked before the work starts and replaced atomically.

use std::collections::HashSet;
use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::os::fd::AsFd;
use std::os::unix::fs::{FileTypeExt, MetadataExt, chown};
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use geobench_mesh::io::files_beside;

use crate::{FileFormat, STANDARD, temporary};

/// A file that a command writes when it ends.
#[derive(Clone, Debug)]
pub struct OutputFile {
    /// The path as the user wrote it.
    shown: String,
    /// The canonical path.
    path: PathBuf,
    /// Whether a write replaces the file. Only regular files are replaced; devices, pipes and
    /// standard output are written to.
    replace: bool,
}

/// The name of standard output in messages.
const STANDARD_OUTPUT: &str = "standard output";

impl OutputFile {
    /// Checks that `path` can be written. The file is not changed.
    ///
    /// # Errors
    ///
    /// When its directory does not exist or cannot be written to, or the path is a directory or a
    /// file that cannot be written.
    pub fn prepare(path: &Path) -> anyhow::Result<Self> {
        if path == Path::new(STANDARD) {
            return Ok(Self {
                shown: STANDARD_OUTPUT.to_owned(),
                path: path.to_owned(),
                replace: false,
            });
        }
        let shown = path.display().to_string();
        // A symbolic link is followed, so that its target is replaced and not the link.
        let path = canonical(path);
        let replace = match fs::metadata(&path) {
            Ok(found) if found.is_dir() => bail!("{shown}: cannot be written: it is a directory"),
            // The reader of a pipe would take a trial for the whole.
            Ok(found) if found.file_type().is_fifo() => false,
            Ok(found) => {
                OpenOptions::new()
                    .append(true)
                    .open(&path)
                    .map_err(|error| anyhow::anyhow!("{}", error.kind()))
                    .with_context(|| format!("{shown}: cannot be written"))?;
                found.is_file()
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => true,
            // Such as a circle of links.
            Err(error) => bail!("{shown}: cannot be written: {}", error.kind()),
        };
        let file = Self {
            shown,
            path,
            replace,
        };
        if replace {
            file.temporary("")
                .map_err(|error| file.plain(&error))
                .with_context(|| file.failure())?;
        }
        Ok(file)
    }

    /// As [`prepare`](Self::prepare), for a page, whose name ends with `.html` or `.htm`. Standard
    /// output, pipes and devices may have any name.
    ///
    /// # Errors
    ///
    /// As `prepare`, and when a file has another ending. So no result file is overwritten by a
    /// page.
    pub fn page(path: &Path) -> anyhow::Result<Self> {
        let file = Self::prepare(path)?;
        let is_page = |ending: &str| {
            let found = path.extension().unwrap_or_default();
            found.eq_ignore_ascii_case(ending)
        };
        if file.replace && !is_page("html") && !is_page("htm") {
            bail!(
                "{}: the page is HTML; let the name end with .html",
                path.display()
            );
        }
        Ok(file)
    }

    /// Its canonical path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether it is standard output.
    pub fn is_standard_output(&self) -> bool {
        self.path == Path::new(STANDARD)
    }

    /// Whether a write replaces the earlier content. Devices and pipes receive all writes.
    pub const fn is_replaced(&self) -> bool {
        self.replace
    }

    /// Writes the file. A regular file is replaced atomically: readers see either the old or the
    /// new content.
    ///
    /// # Errors
    ///
    /// When the system cannot write. A regular file is then unchanged.
    pub fn write(&self, contents: &[u8]) -> anyhow::Result<()> {
        if self.is_standard_output() {
            return write_standard_output(contents).with_context(|| self.failure());
        }
        if !self.replace {
            return fs::write(&self.path, contents).with_context(|| self.failure());
        }
        self.write_with("", |path| Ok(fs::write(path, contents)?))
    }

    /// Replaces the file by one that `write` creates under a temporary name that ends with
    /// `ending`. The new file is on disk before it takes the place of the old one, whose mode it
    /// gets, and whose owner and group if the system allows.
    ///
    /// # Errors
    ///
    /// When `write` or the replacement fails. The file is then unchanged.
    pub fn write_with(
        &self,
        ending: &str,
        write: impl FnOnce(&Path) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        if !self.replace {
            let file = temporary_file(&std::env::temp_dir(), ending)?;
            write(file.path()).with_context(|| self.failure())?;
            return self.write(&fs::read(file.path())?);
        }
        let file = self
            .temporary(ending)
            .map_err(|error| self.plain(&error))
            .with_context(|| self.failure())?;
        write(file.path()).with_context(|| self.failure())?;
        self.replace_by(file).with_context(|| self.failure())
    }

    fn replace_by(&self, file: tempfile::NamedTempFile) -> io::Result<()> {
        if let Ok(old) = fs::metadata(&self.path) {
            // Only root may give files away.
            let _ = chown(file.path(), Some(old.uid()), Some(old.gid()));
            file.as_file().set_permissions(old.permissions())?;
        }
        file.as_file().sync_all()?;
        file.persist(&self.path).map_err(|error| error.error)?;
        Ok(())
    }

    fn failure(&self) -> String {
        format!("{}: cannot be written", self.shown)
    }

    /// A temporary file in the same directory, so that it can be renamed to the path.
    fn temporary(&self, ending: &str) -> io::Result<tempfile::NamedTempFile> {
        temporary_file(self.directory(), ending)
    }

    fn directory(&self) -> &Path {
        match self.path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        }
    }

    /// The error of making the temporary file, without its name, which would confuse users.
    fn plain(&self, error: &io::Error) -> anyhow::Error {
        match error.kind() {
            // As /proc, which has no other files than its own.
            io::ErrorKind::NotFound if self.directory().is_dir() => {
                anyhow::anyhow!("no file can be made in its directory")
            }
            io::ErrorKind::NotFound => anyhow::anyhow!("its directory does not exist"),
            kind => anyhow::anyhow!("{kind}"),
        }
    }
}

/// Writes to standard output. If its reader, such as `head`, has ended, the rest is dropped: the
/// command goes on, and its result decides.
///
/// # Errors
///
/// If standard output is full.
pub fn write_standard_output(contents: &[u8]) -> io::Result<()> {
    let mut out = io::stdout().lock();
    unless_reader_ended(out.write_all(contents).and_then(|()| out.flush()))
}

/// The result `written` of writing to standard output. It is no error that the reader has ended.
///
/// # Errors
///
/// The error of `written`, if it is another one.
pub fn unless_reader_ended(written: io::Result<()>) -> io::Result<()> {
    match written {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        written => written,
    }
}

/// A temporary file in `directory`. It has the usual mode of new files, restricted by the umask, so
/// that others can read what it is renamed to; `tempfile` alone would create a private file.
///
/// # Errors
///
/// When the file cannot be created.
pub fn temporary_file(directory: &Path, ending: &str) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".geobench-").suffix(ending);
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    temporary::registered(|| builder.tempfile_in(directory))
}

/// Makes a directory and those above it.
///
/// # Errors
///
/// When it cannot be made.
pub fn make_directory(path: &Path) -> anyhow::Result<()> {
    fs::create_dir_all(path).map_err(|error| {
        let problem = match error.kind() {
            io::ErrorKind::AlreadyExists => "a file has this name".to_owned(),
            io::ErrorKind::NotADirectory => "a part of its path is a file".to_owned(),
            // Directories that are not there would have been made.
            io::ErrorKind::NotFound => "the one above it takes no others".to_owned(),
            kind => kind.to_string(),
        };
        anyhow::anyhow!("{}: cannot be made: {problem}", path.display())
    })
}

/// Opens the file at `path` and locks it until the result is dropped, so that of several processes
/// that each read it and [replace](OutputFile::write) it, one does so at a time.
///
/// # Errors
///
/// When the file cannot be opened or locked.
pub fn lock(path: &Path) -> io::Result<fs::File> {
    loop {
        let file = fs::File::open(path)?;
        file.lock()?;
        // The process that had the lock may have replaced the file. Then this lock is on the old
        // one.
        if FileIdentity::of_open(&file)? == FileIdentity::of(path) {
            return Ok(file);
        }
    }
}

/// Links after which a chain of them is taken to be a circle, as by the system.
const MOST_LINKS: usize = 40;

/// The canonical path of a file, which need not exist. Links are followed, also to nothing.
fn canonical(path: &Path) -> PathBuf {
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        if let Ok(canonical) = fs::canonicalize(&path) {
            return canonical;
        }
        path = in_canonical_directory(&path);
        let Ok(target) = fs::read_link(&path) else {
            break;
        };
        path = path.parent().unwrap_or(Path::new("")).join(target);
    }
    path
}

/// The path of a file that does not exist yet, canonical if its directory exists.
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

/// Checks that no two outputs are the same file, and that none is among the files that the command
/// reads: `inputs`, files that models name ([`files_beside`]), and the file from which standard
/// input comes. Standard output may be none of them, either.
///
/// # Errors
///
/// Names the output.
pub fn check_files<'a>(
    outputs: impl IntoIterator<Item = &'a OutputFile>,
    inputs: impl IntoIterator<Item = impl AsRef<Path>>,
) -> anyhow::Result<()> {
    let mut written = HashSet::new();
    let outputs: Vec<&OutputFile> = outputs.into_iter().collect();
    for output in &outputs {
        if !written.insert(FileIdentity::of(&output.path)) {
            bail!("{}: given twice as output", output.shown);
        }
    }
    let mut read = HashSet::new();
    for input in inputs {
        read.insert(FileIdentity::of(input.as_ref()));
        let beside = files_beside(input.as_ref());
        read.extend(beside.iter().map(|path| FileIdentity::of(path)));
    }
    if FileIdentity::of_stream(&io::stdout()).is_some_and(|file| read.contains(&file)) {
        bail!("{STANDARD_OUTPUT}: would change a file that is read; name another output");
    }
    read.extend(FileIdentity::of_stream(&io::stdin()));
    for output in outputs.into_iter().filter(|output| output.replace) {
        if read.contains(&FileIdentity::of(&output.path)) {
            bail!(
                "{}: would replace a file that is read; name another output",
                output.shown
            );
        }
    }
    Ok(())
}

/// What two names of one file share, whether one is a symbolic or a hard link to the other.
#[derive(PartialEq, Eq, Hash)]
enum FileIdentity {
    /// Device and inode of a file.
    Inode(u64, u64),
    /// The canonical path of a file that does not exist yet.
    Path(PathBuf),
}

impl FileIdentity {
    fn of(path: &Path) -> Self {
        if let Ok(found) = fs::metadata(path) {
            return Self::Inode(found.dev(), found.ino());
        }
        Self::Path(canonical(path))
    }

    fn of_open(file: &fs::File) -> io::Result<Self> {
        let found = file.metadata()?;
        Ok(Self::Inode(found.dev(), found.ino()))
    }

    /// The regular file that `stream` reads or writes, if it does.
    fn of_stream(stream: &impl AsFd) -> Option<Self> {
        let file = fs::File::from(stream.as_fd().try_clone_to_owned().ok()?);
        let is_file = file.metadata().ok()?.is_file();
        is_file.then(|| Self::of_open(&file).ok()).flatten()
    }
}

/// The file at `path` with its format.
///
/// # Errors
///
/// When no format has the extension, or the file cannot be written.
pub fn prepare_one<F: FileFormat>(path: &Path) -> anyhow::Result<(F, OutputFile)> {
    Ok((F::of_path(path)?, OutputFile::prepare(path)?))
}

/// The files at `paths` with their formats.
///
/// # Errors
///
/// When a format is unknown, a file cannot be written, or two paths are the same file.
pub fn prepare<F: FileFormat>(paths: &[PathBuf]) -> anyhow::Result<Vec<(F, OutputFile)>> {
    let outputs = paths.iter().map(|path| prepare_one(path));
    let outputs = outputs.collect::<anyhow::Result<Vec<(F, OutputFile)>>>()?;
    check_files(outputs.iter().map(|(_, file)| file), [""; 0])?;
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
    fn outputs_that_cannot_be_written_are_errors_at_once() {
        let directory = tempfile::tempdir().unwrap();
        let error = OutputFile::prepare(directory.path()).unwrap_err();
        assert!(error.to_string().contains("it is a directory"));
        let missing = directory.path().join("no/such/x.csv");
        let error = OutputFile::prepare(&missing).unwrap_err();
        assert!(
            format!("{error:#}").contains("x.csv: cannot be written: its directory does not exist")
        );
        if cfg!(target_os = "linux") {
            let error = OutputFile::prepare(Path::new("/proc/x.csv")).unwrap_err();
            let error = format!("{error:#}");
            assert!(
                error.ends_with(": no file can be made in its directory"),
                "{error}"
            );
            let error = make_directory(Path::new("/proc/x/y")).unwrap_err();
            let error = error.to_string();
            assert!(
                error.ends_with(": the one above it takes no others"),
                "{error}"
            );
        }
    }

    #[test]
    fn a_directory_is_made_unless_a_file_is_there() {
        let directory = tempfile::tempdir().unwrap();
        let path = |name: &str| directory.path().join(name);
        make_directory(&path("a/b")).unwrap();
        make_directory(&path("a/b")).unwrap();
        fs::write(path("x"), "").unwrap();
        for (name, problem) in [
            ("x", "a file has this name"),
            ("x/y", "a part of its path is a file"),
        ] {
            let error = make_directory(&path(name)).unwrap_err().to_string();
            assert!(
                error.ends_with(&format!("cannot be made: {problem}")),
                "{error}"
            );
        }
    }

    #[test]
    fn a_file_keeps_its_mode() {
        use std::os::unix::fs::PermissionsExt;
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("x.csv");
        fs::write(&path, "old").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        OutputFile::prepare(&path).unwrap().write(b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(
            fs::metadata(&path).unwrap().permissions().mode() & 0o777,
            0o640
        );
    }

    #[test]
    fn a_link_stays_a_link() {
        let directory = tempfile::tempdir().unwrap();
        let circle = directory.path().join("circle");
        std::os::unix::fs::symlink(&circle, &circle).unwrap();
        let error = OutputFile::prepare(&circle).unwrap_err().to_string();
        assert!(error.contains("circle: cannot be written: "), "{error}");
        let (real, link) = (directory.path().join("real"), directory.path().join("link"));
        fs::write(&real, "old").unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        OutputFile::prepare(&link).unwrap().write(b"new").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&real).unwrap(), b"new");
    }
}
