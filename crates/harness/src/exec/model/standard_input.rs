//! The model of standard input, `-`: kept as a temporary file, because cells run in processes of
//! their own and each reads the model.

use std::fs::File;
use std::io;
use std::path::PathBuf;
use std::sync::{Mutex, OnceLock};

use geobench_export::temporary;
use geobench_mesh::io as mesh_io;
use tempfile::TempDir;

use crate::lock::lock;

/// The form of standard input, named like an ending. Set once, from the command line.
static FORM: OnceLock<String> = OnceLock::new();

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
    let keep = || {
        let folder = tempfile::Builder::new().prefix("geobench-").tempdir()?;
        temporary::register(folder.path());
        let path = folder.path().join(name);
        io::copy(&mut io::stdin().lock(), &mut File::create(&path)?)?;
        Ok((folder, path))
    };
    let (kept, path) = keep().map_err(|error: io::Error| {
        format!("-: standard input cannot be kept as a file: {error}")
    })?;
    *folder = Some(kept);
    Ok(path)
}

/// Removes the temporary file.
pub fn remove() {
    drop(lock(&FOLDER).take());
}
