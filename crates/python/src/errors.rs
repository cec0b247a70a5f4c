//! Python exceptions for the errors of the library.

use geodesics::io::FileError;
use geodesics::paths::TraceError;
use geodesics::{InvalidMesh, PathError, SolveError};
use pyo3::exceptions::{
    PyFileNotFoundError, PyIndexError, PyIsADirectoryError, PyOSError, PyRuntimeError,
    PyUserWarning, PyValueError,
};
use pyo3::prelude::*;
use pyo3::{create_exception, intern};

create_exception!(
    geodesics,
    MeshError,
    PyValueError,
    "A mesh that cannot be used, or a file that holds none. The message names the vertices, faces \
     or the line; `defects` has a sentence for each kind of defect."
);

create_exception!(
    geodesics,
    PrecisionWarning,
    PyUserWarning,
    "Distances that floating-point numbers cannot tell well, beside faces that are far larger."
);

/// A `MeshError` for an invalid mesh. `place` precedes the message unless it is empty.
pub(crate) fn invalid(py: Python<'_>, error: &InvalidMesh, place: &str) -> PyErr {
    let message = if place.is_empty() {
        error.to_string()
    } else {
        format!("{place}: {error}")
    };
    let defects: Vec<String> = error
        .report
        .summaries()
        .into_iter()
        .map(|s| s.text)
        .collect();
    mesh_error(py, message, defects)
}

/// A `MeshError` with this message and this `defects` attribute.
pub(crate) fn mesh_error(py: Python<'_>, message: String, defects: Vec<String>) -> PyErr {
    let error = MeshError::new_err(message);
    match error.value(py).setattr(intern!(py, "defects"), defects) {
        Ok(()) => error,
        Err(other) => other,
    }
}

/// The exception for a file that cannot be read or written.
pub(crate) fn unreadable(py: Python<'_>, error: &FileError) -> PyErr {
    let message = match error {
        // No argument raises the limit.
        FileError::TooLarge { path, limit, .. } => format!(
            "{}: it decompresses to more than {limit} bytes; decompress it first if it can be \
             trusted",
            path.display()
        ),
        FileError::OverLimit {
            path,
            place,
            problem,
        } => format!(
            "{}: {place}{problem}; save it as OBJ or PLY",
            path.display()
        ),
        _ => error.to_string(),
    };
    match error {
        FileError::NotFound { .. } => PyFileNotFoundError::new_err(message),
        FileError::Directory { .. } => PyIsADirectoryError::new_err(message),
        FileError::NotRead { .. } | FileError::NotWritten { .. } => PyOSError::new_err(message),
        FileError::UnknownFormat { .. } | FileError::UnknownOutput { .. } => {
            PyValueError::new_err(message)
        }
        _ => mesh_error(py, message, Vec::new()),
    }
}

/// The exception for a failed run.
pub(crate) fn solve_error(error: SolveError) -> PyErr {
    let message = error.to_string();
    match error {
        SolveError::NoSuchVertex { .. } | SolveError::NoSuchTarget { .. } => {
            PyIndexError::new_err(message)
        }
        SolveError::NoThreads { .. } => PyOSError::new_err(message),
        _ => PyValueError::new_err(message),
    }
}

/// The exception for a failed computation of paths.
pub(crate) fn path_error(error: PathError) -> PyErr {
    match error {
        PathError::Solve(error) => solve_error(error),
        PathError::Trace(error) => trace_error(error),
        other => PyRuntimeError::new_err(other.to_string()),
    }
}

/// The exception for a path that cannot be traced back to its source.
pub(crate) fn trace_error(error: TraceError) -> PyErr {
    PyRuntimeError::new_err(error.to_string())
}
