//! The file of distances that an external program writes.

use std::fs::{File, OpenOptions};
use std::io::Read;
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;
use std::time::Instant;

use rustix::fs::OFlags;

use super::child::ChildError;
use crate::exec::limits::Timeout;
use crate::exec::{Failure, expected};
use crate::schema::Status;

/// Maximum length of the line of a vertex.
const LINE: u64 = 128;

/// Maximum number of bytes in addition to the lines of the vertices.
const REST: u64 = 1 << 16;

/// Bytes read between two checks of the deadline.
const BLOCK: u64 = 1 << 20;

/// Reads the distances of all `vertices` from a file of lines `vertex,distance`. Gives up when
/// `timeout` has passed since `start`.
///
/// The file comes from an external program and is not trusted. Links, pipes and devices are refused
/// without following or blocking on them, and the size is bounded.
///
/// # Errors
///
/// `crashed` if there is no such regular file, or it is too large or malformed; `timeout` after the
/// deadline; `wrong` if a vertex has no distance or more than one.
pub(super) fn read_distances(
    path: &Path,
    vertices: usize,
    timeout: Timeout,
    start: Instant,
) -> Result<Vec<f64>, Failure> {
    let unusable = |problem: String| {
        Failure::new(
            Status::Crashed,
            format!("its distances cannot be used: {problem}"),
        )
    };
    let in_file = |problem: String| unusable(format!("{}: {problem}", path.display()));
    let file = open(path).map_err(in_file)?;
    let most = REST + LINE * vertices as u64;
    let mut bytes = Vec::new();
    loop {
        if timeout.0.is_some_and(|timeout| start.elapsed() >= timeout) {
            return Err(ChildError::Timeout(timeout).failure("having its distances read"));
        }
        let block = (&file).take(BLOCK).read_to_end(&mut bytes);
        let block = block.map_err(|error| in_file(error.to_string()))?;
        if bytes.len() as u64 > most {
            return Err(in_file(format!(
                "it has more than {most} bytes, too many for {vertices} vertices; write lines \
                 `vertex,distance` alone"
            )));
        }
        if block == 0 {
            break;
        }
    }
    let text = String::from_utf8(bytes)
        .map_err(|_| in_file("it is no text; write lines `vertex,distance`".to_owned()))?;
    let field = expected::parse(path, &text, vertices).map_err(|e| unusable(e.to_string()))?;
    let wrong = |message: String| Err(Failure::new(Status::Wrong, message));
    let mut distances = vec![None; vertices];
    for (vertex, distance) in field.distances {
        if distances[vertex].replace(distance).is_some() {
            return wrong(format!("it wrote two distances of vertex {vertex}"));
        }
    }
    let missing = distances.iter().filter(|d| d.is_none()).count();
    match distances.iter().position(Option::is_none) {
        None => Ok(distances.into_iter().flatten().collect()),
        Some(first) => wrong(format!(
            "it wrote no distance of {missing} of {vertices} vertices, the first of them {first}"
        )),
    }
}

/// Opens a regular file without following a link and without blocking.
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
    match file.metadata() {
        Ok(found) if found.is_file() => Ok(file),
        Ok(_) => Err(OTHER.to_owned()),
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
        read_distances(&path, 3, Timeout(None), Instant::now())
            .map_err(|failure| (failure.status, failure.message))
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
        let over = Timeout(Some(Duration::ZERO));
        let failure = read_distances(file.path(), 3, over, Instant::now()).unwrap_err();
        assert_eq!(failure.status, Status::Timeout);
    }
}
