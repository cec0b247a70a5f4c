//! Files that hold data of a mesh file, beside it.

use std::fs::{self, File};
use std::io::{Read, Seek, SeekFrom};
use std::path::{Component, Path, PathBuf};

/// Where the file is that the one at `path` calls `name`: in the folder of that one or below.
/// `None` for any other place.
pub(super) fn place(path: &Path, name: &str) -> Option<PathBuf> {
    let parts = Path::new(name).components();
    let parts = parts.filter(|part| *part != Component::CurDir);
    let is_inside = |part| matches!(part, Component::Normal(_));
    if name.contains(':') || !parts.clone().all(is_inside) {
        return None;
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    Some(folder.join(parts.collect::<PathBuf>()))
}

/// At most `length` bytes of the file at `path`, from the one at `start`; `None` if it cannot be
/// read. Never waits for a pipe.
pub(super) fn part(path: &Path, start: u64, length: u64) -> Option<Vec<u8>> {
    if !fs::metadata(path).is_ok_and(|metadata| metadata.is_file()) {
        return None;
    }
    let mut file = File::open(path).ok()?;
    file.seek(SeekFrom::Start(start)).ok()?;
    let mut bytes = Vec::new();
    file.take(length).read_to_end(&mut bytes).ok()?;
    Some(bytes)
}
