//! Temporary files and folders, which go whatever ends the program.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::{fs, io, mem};

/// Those that were made. Most are gone: their names, which never return, cost little.
static MADE: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Makes a temporary file or folder, which [`remove_all`] can remove from its first moment on.
///
/// # Errors
///
/// Those of `make`.
pub fn registered<T: AsRef<Path>>(make: impl FnOnce() -> io::Result<T>) -> io::Result<T> {
    let mut made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
    let new = make()?;
    made.push(new.as_ref().to_owned());
    Ok(new)
}

/// Removes all temporary files and folders of this process. For a signal that ends it, since then
/// nothing is dropped. None can be made afterwards: a thread that tries waits for the end.
pub fn remove_all() {
    let made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
    for path in made.iter() {
        let _ = fs::remove_file(path).or_else(|_| fs::remove_dir_all(path));
    }
    mem::forget(made);
}
