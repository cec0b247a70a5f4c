//! The model of standard input, `-`: kept as a temporary file, because cells run in processes of
//! their own and each reads the model.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::PathBuf;
use std::sync::{Mutex, OnceLock};

use bytesize::ByteSize;
use geobench_export::temporary;
use geobench_mesh::io as mesh_io;
use tempfile::TempDir;

use crate::lock::lock;
use crate::usage;

/// The form of standard input, named like an ending. Set once, from the command line.
static FORM: OnceLock<String> = OnceLock::new();

/// The most bytes of it that are kept, as many as a compressed file may decompress to by default.
const MOST: u64 = 8 << 30;

/// The folder of the temporary file, once standard input is read.
static FOLDER: Mutex<Option<TempDir>> = Mutex::new(None);

/// Sets the form: an ending without its dot, such as `ply` or `off.gz`.
pub fn set_form(ending: &str) {
    // The command line is read once.
    let _ = FORM.set(ending.trim_start_matches('.').to_lowercase());
}

/// The file with the contents of standard input, which is read on the first call. An error is in
/// words.
pub(super) fn file() -> Result<PathBuf, String> {
    let form = FORM.get().map_or("", String::as_str);
    let name = format!("stdin.{form}");
    if !mesh_io::is_mesh_file(name.as_ref()) {
        return Err(format!(
            "-: --input-format says in which form the model is; use an ending without its dot: {}",
            mesh_io::READABLE
        ));
    }
    let mut folder = lock(&FOLDER);
    if let Some(folder) = &*folder {
        return Ok(folder.path().join(name));
    }
    let mut standard_input = usage::standard_input().map_err(|error| format!("-: {error}"))?;
    let keep = || {
        let make = || tempfile::Builder::new().prefix("geobench-").tempdir();
        let folder = temporary::registered(make)?;
        let path = folder.path().join(name);
        keep_at_most(MOST, &mut standard_input, &mut File::create(&path)?)?;
        Ok((folder, path))
    };
    let (kept, path) = keep().map_err(|error: io::Error| {
        format!("-: standard input cannot be kept as a file: {error}")
    })?;
    *folder = Some(kept);
    Ok(path)
}

/// Copies all of `input`, or fails if it is longer than `most` bytes.
fn keep_at_most(most: u64, input: &mut impl Read, kept: &mut impl Write) -> io::Result<()> {
    if io::copy(&mut input.take(most + 1), kept)? > most {
        let size = ByteSize(most).display().iec();
        return Err(io::Error::new(
            io::ErrorKind::FileTooLarge,
            format!("larger than {size}, the most that is read; name a file instead"),
        ));
    }
    Ok(())
}

/// Removes the temporary file.
pub fn remove() {
    drop(lock(&FOLDER).take());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn input_without_an_end_is_refused() {
        let mut kept = Vec::new();
        keep_at_most(5, &mut &b"solid"[..], &mut kept).unwrap();
        assert_eq!(kept, b"solid");
        let error = keep_at_most(1 << 10, &mut io::repeat(0), &mut kept).unwrap_err();
        let error = error.to_string();
        assert!(
            error.starts_with("larger than 1.0 KiB, the most"),
            "{error}"
        );
        assert_eq!(kept.len(), 5 + (1 << 10) + 1);
    }
}
