//! Input of users: errors in it, files and their schemas, and TOML documents.

pub mod document;

pub use document::DocumentError;
pub use geobench_registry::UsageError;

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, Read};
use std::os::unix::fs::FileTypeExt;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use anyhow::Context;
use bytesize::ByteSize;
use flate2::read::MultiGzDecoder;

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

/// Maximum size of a text in bytes, decompressed.
const MOST_TEXT: u64 = 1 << 30;

/// Maximum size of a text from a device, which may have no end.
const MOST_FROM_DEVICE: u64 = 1 << 20;

/// The text of a file, which may be compressed by gzip: without a byte order mark, with lines that
/// end in `\n`. `-` is standard input.
///
/// # Errors
///
/// When it cannot be read, is too large or is not UTF-8.
pub fn read_text(path: &Path) -> io::Result<String> {
    if path == Path::new("-") {
        text_of(standard_input()?, MOST_TEXT)
    } else {
        read_file(path)
    }
}

/// Standard input, for the only argument that reads it.
///
/// # Errors
///
/// If another argument has read it. It would be empty now.
pub(crate) fn standard_input() -> io::Result<io::StdinLock<'static>> {
    static IS_READ: AtomicBool = AtomicBool::new(false);
    if IS_READ.swap(true, Relaxed) {
        return Err(io::Error::other(
            "two arguments are standard input, which can be read once; name a file for one of them",
        ));
    }
    Ok(io::stdin().lock())
}

/// As [`read_text`], but `-` is a file like others.
pub(crate) fn read_file(path: &Path) -> io::Result<String> {
    let file = File::open(path)?;
    let kind = file.metadata()?.file_type();
    let is_device = kind.is_char_device() || kind.is_block_device();
    text_of(
        file,
        if is_device {
            MOST_FROM_DEVICE
        } else {
            MOST_TEXT
        },
    )
}

/// Reads a text of at most `most` bytes.
fn text_of(file: impl Read, most: u64) -> io::Result<String> {
    let all = |reader: &mut dyn Read| -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        reader.take(most + 1).read_to_end(&mut bytes)?;
        if bytes.len() as u64 > most {
            let size = ByteSize(most).display().iec();
            let message = format!("larger than {size}, the most that is read");
            return Err(io::Error::new(io::ErrorKind::FileTooLarge, message));
        }
        Ok(bytes)
    };
    let mut bytes = all(&mut { file })?;
    if bytes.starts_with(&[0x1f, 0x8b]) {
        bytes = all(&mut MultiGzDecoder::new(&bytes[..]))?;
    }
    let text = String::from_utf8(bytes);
    let text = text.map_err(|_| io::Error::new(io::ErrorKind::InvalidData, "not text in UTF-8"))?;
    Ok(plain_lines(text))
}

/// `text` without a byte order mark and with lines that end in `\n` alone.
fn plain_lines(mut text: String) -> String {
    if text.starts_with('\u{feff}') {
        text.remove(0);
    }
    if text.contains('\r') {
        text = text.replace("\r\n", "\n").replace('\r', "\n");
    }
    text
}

/// The first field of a line of CSV, without its quotes, and the rest behind the comma, if there is
/// one.
pub(crate) fn first_field(line: &str) -> (Cow<'_, str>, Option<&str>) {
    let line = line.trim();
    if let Some(quoted) = line.strip_prefix('"') {
        let mut end = None;
        let mut quotes = quoted.match_indices('"').peekable();
        while let Some((at, _)) = quotes.next() {
            // Two quotes stand for one.
            if quotes.next_if(|(next, _)| *next == at + 1).is_none() {
                end = Some(at);
                break;
            }
        }
        if let Some(end) = end {
            let rest = quoted[end + 1..].trim_start().strip_prefix(',');
            return (quoted[..end].replace("\"\"", "\"").into(), rest);
        }
    }
    match line.split_once(',') {
        Some((field, rest)) => (field.trim_end().into(), Some(rest)),
        None => (line.into(), None),
    }
}

/// The start of a text that a message quotes.
pub(crate) fn quoted(text: &str) -> Cow<'_, str> {
    beginning(text, 60)
}

/// At most the first `most` characters of a text.
pub(crate) fn beginning(text: &str, most: usize) -> Cow<'_, str> {
    match text.char_indices().nth(most) {
        Some((end, _)) => format!("{}...", &text[..end]).into(),
        None => text.into(),
    }
}

/// The files in `directory` with the extension `ending`, sorted by name. Hidden files are skipped.
///
/// # Errors
///
/// When the directory cannot be read, or one of them is a folder, a pipe or a device.
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
            let is_other = path.metadata().is_ok_and(|found| !found.is_file());
            anyhow::ensure!(!is_other, "{}: not a regular file", path.display());
            paths.push(path);
        }
    }
    paths.sort_unstable();
    Ok(paths)
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    #[test]
    fn texts_of_other_programs_are_read() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("x");
        let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        gzip.write_all("\u{feff}a\r\nb\rc".as_bytes()).unwrap();
        std::fs::write(&path, gzip.finish().unwrap()).unwrap();
        assert_eq!(read_text(&path).unwrap(), "a\nb\nc");
        std::fs::write(&path, [0xff]).unwrap();
        let error = read_text(&path).unwrap_err().to_string();
        assert_eq!(error, "not text in UTF-8");
    }

    #[test]
    fn a_device_without_an_end_is_refused() {
        let error = read_text(Path::new("/dev/zero")).unwrap_err().to_string();
        assert!(error.contains("larger than 1.0 MiB"), "{error}");
        assert_eq!(read_text(Path::new("/dev/null")).unwrap(), "");
    }

    #[test]
    fn files_of_a_directory_are_regular() {
        let directory = tempfile::tempdir().unwrap();
        let path = |name: &str| directory.path().join(name);
        std::fs::write(path("b.json"), "{}").unwrap();
        std::fs::write(path("a.JSON"), "{}").unwrap();
        std::fs::write(path("a.txt"), "").unwrap();
        let found = files_in(directory.path(), "json").unwrap();
        assert_eq!(found, [path("a.JSON"), path("b.json")]);
        std::os::unix::fs::symlink("/dev/zero", path("z.json")).unwrap();
        let error = files_in(directory.path(), "json").unwrap_err().to_string();
        assert!(error.ends_with("z.json: not a regular file"), "{error}");
    }

    #[test]
    fn fields_lose_their_quotes() {
        let field = |line| {
            let (field, rest) = first_field(line);
            (field.into_owned(), rest.map(str::to_owned))
        };
        let some = |text: &str| Some(text.to_owned());
        assert_eq!(field("17,2.5"), ("17".into(), some("2.5")));
        assert_eq!(
            field("\"face:0,1,0,0\" ,2"),
            ("face:0,1,0,0".into(), some("2"))
        );
        assert_eq!(field("\"a\"\"b\""), ("a\"b".into(), None));
        assert_eq!(field("\"a"), ("\"a".into(), None));
    }
}
