//! Temporary files and folders, which go whatever ends the program.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Those that were made. Most are gone: their names, which never return, cost little.
static MADE: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Lets [`remove_all`] remove the temporary file or folder at `path`.
pub fn register(path: &Path) {
    let mut made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
    made.push(path.to_owned());
}

/// Removes all temporary files and folders of this process. For a signal that ends it, since then
/// nothing is dropped.
pub fn remove_all() {
    let made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
    for path in made.iter() {
        let _ = fs::remove_file(path).or_else(|_| fs::remove_dir_all(path));
    }
}
