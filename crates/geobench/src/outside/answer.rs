//! Distances that an outside program has written.

use std::path::Path;

use crate::expected;
use crate::record::Status;
use crate::runner::Failure;

/// Reads the distances of all `vertices` from a file of lines `vertex,distance`.
///
/// # Errors
///
/// When there is no such file or it is not understood (`crashed`), or a vertex has no distance or
/// two (`wrong`).
pub(super) fn read(path: &Path, vertices: usize) -> Result<Vec<f64>, Failure> {
    let field = expected::read(path, vertices).map_err(|error| Failure {
        status: Status::Crashed,
        message: format!("its distances cannot be used: {error}"),
    })?;
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

#[cfg(test)]
mod tests {
    use super::*;

    fn read_text(text: &str) -> Result<Vec<f64>, (Status, String)> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("d.csv");
        std::fs::write(&path, text).unwrap();
        read(&path, 3).map_err(|failure| (failure.status, failure.message))
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
}
