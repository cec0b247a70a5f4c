//! Distances that an outside program has written.
//!
//! What stands in place of the file was put there by the program: a link, a pipe or a device must
//! neither be followed nor waited for, and a regular file may have any size.

use std::fs::{File, OpenOptions};
use std::io::{self, Read};
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;
use std::time::Instant;

use rustix::fs::OFlags;

use crate::exec::Failure;
use crate::exec::expected;
use crate::exec::isolate::Trouble;
use crate::exec::limits::Limits;
use crate::schema::Status;

/// Most bytes of the line of a vertex, with what stands before and behind its two numbers.
const LINE: u64 = 128;

/// Most bytes of everything else.
const REST: u64 = 1 << 16;

/// Bytes that are read between two looks at the clock.
const BLOCK: u64 = 1 << 20;

/// Reads the distances of all `vertices` from a file of lines `vertex,distance`, until `deadline` at
/// most.
///
/// # Errors
///
/// When there is no such file, it is no regular one, it is too large or it is not understood
/// (`crashed`), when the time is over (`timeout`), or a vertex has no distance or two (`wrong`).
pub(super) fn read(
    path: &Path,
    vertices: usize,
    limits: &Limits,
    deadline: Option<Instant>,
) -> Result<Vec<f64>, Failure> {
    let unusable = |problem: String| Failure {
        status: Status::Crashed,
        message: format!("its distances cannot be used: {problem}"),
    };
    let is_over = || deadline.is_some_and(|deadline| Instant::now() >= deadline);
    let file = open(path).map_err(|problem| unusable(format!("{}: {problem}", path.display())))?;
    let most = REST + LINE * vertices as u64;
    let mut bytes = Vec::new();
    loop {
        if is_over() {
            return Err(Trouble::Timeout.failure(limits, "having its distances read"));
        }
        let block = (&file).take(BLOCK).read_to_end(&mut bytes);
        let block = block.map_err(|error| unusable(format!("{}: {error}", path.display())))?;
        if bytes.len() as u64 > most {
            return Err(unusable(format!(
                "{}: it has more than {most} bytes, too many for {vertices} vertices; write lines \
                 `vertex,distance` alone",
                path.display()
            )));
        }
        if block == 0 {
            break;
        }
    }
    let text = String::from_utf8(bytes).map_err(|_| {
        unusable(format!(
            "{}: it is no text; write lines `vertex,distance`",
            path.display()
        ))
    })?;
    let field = expected::parse(path, &text, vertices).map_err(|e| unusable(e.to_string()))?;
    let wrong = |message: String| Failure {
        status: Status::Wrong,
        message,
    };
    let mut distances = vec![None; vertices];
    for (vertex, distance) in field.distances {
        if distances[vertex].replace(distance).is_some() {
            return Err(wrong(format!("it wrote two distances of vertex {vertex}")));
        }
    }
    let missing = distances.iter().filter(|d| d.is_none()).count();
    match distances.iter().position(Option::is_none) {
        None => Ok(distances.into_iter().flatten().collect()),
        Some(first) => Err(wrong(format!(
            "it wrote no distance of {missing} of {vertices} vertices, the first of them {first}"
        ))),
    }
}

/// Opens a regular file without following a link and without waiting.
fn open(path: &Path) -> Result<File, String> {
    const OTHER: &str = "it is no regular file; write the distances to a file of this name";
    let flags = (OFlags::NOFOLLOW | OFlags::NONBLOCK | OFlags::NOCTTY).bits();
    let opened = OpenOptions::new()
        .read(true)
        .custom_flags(flags.cast_signed())
        .open(path);
    let file = opened.map_err(|error| match std::fs::symlink_metadata(path) {
        Ok(found) if !found.is_file() => OTHER.to_owned(),
        _ => error.to_string(),
    })?;
    let is_file = |file: &File| -> io::Result<bool> { Ok(file.metadata()?.is_file()) };
    match is_file(&file) {
        Ok(true) => Ok(file),
        Ok(false) => Err(OTHER.to_owned()),
        Err(error) => Err(error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    fn read_text(text: &str) -> Result<Vec<f64>, (Status, String)> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("d.csv");
        std::fs::write(&path, text).unwrap();
        read(&path, 3, &Limits::USUAL, None).map_err(|failure| (failure.status, failure.message))
    }

    #[test]
    fn every_vertex_has_one_distance() {
        let all = read_text("vertex,distance\n2,inf\n0,0\n1,0.5\n").unwrap();
        assert_eq!(all, [0.0, 0.5, f64::INFINITY]);
        let (status, message) = read_text("0,0\n1,1\n").unwrap_err();
        assert_eq!(status, Status::Wrong);
        assert_eq!(
            message,
            "it wrote no distance of 1 of 3 vertices, the first of them 2"
        );
        let (status, message) = read_text("0,0\n1,1\n1,1\n").unwrap_err();
        assert_eq!(status, Status::Wrong);
        assert_eq!(message, "it wrote two distances of vertex 1");
        assert_eq!(read_text("0,nan\n").unwrap_err().0, Status::Crashed);
        assert_eq!(read_text("").unwrap_err().0, Status::Crashed);
    }

    #[test]
    fn a_file_is_read_within_its_size_and_time() {
        let (status, message) = read_text(&"0,0\n".repeat(30_000)).unwrap_err();
        assert_eq!(status, Status::Crashed);
        assert!(
            message.contains("it has more than 65920 bytes"),
            "{message}"
        );
        let file = tempfile::NamedTempFile::new().unwrap();
        let over = Instant::now().checked_sub(Duration::from_millis(1));
        let failure = read(file.path(), 3, &Limits::USUAL, over).unwrap_err();
        assert_eq!(failure.status, Status::Timeout);
    }
}
