//! Errors of mesh files, each with a remedy.

use std::fmt;
use std::io;
use std::path::PathBuf;

/// Why a mesh file could not be read or written. The message names the file, the position in it and
/// a remedy.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// There is no such file.
    #[error("{path}: no such file; check the path")]
    NotFound {
        /// The path asked for.
        path: PathBuf,
    },
    /// The path leads to a directory.
    #[error("{path}: is a directory; name a mesh file in it")]
    Directory {
        /// The path asked for.
        path: PathBuf,
    },
    /// The operating system failed to read it.
    #[error("{path}: cannot be read: {source}")]
    NotRead {
        /// The path asked for.
        path: PathBuf,
        /// The error of the system.
        source: io::Error,
    },
    /// The file extension belongs to no format that can be read.
    #[error("{path}: {}", super::problem_of_ending(.path))]
    UnknownFormat {
        /// The path asked for.
        path: PathBuf,
    },
    /// The file is empty, or decompresses to nothing.
    #[error("{path}: the file is empty; write it anew")]
    Empty {
        /// The path asked for.
        path: PathBuf,
    },
    /// The gzip data is damaged or ends early.
    #[error("{path}: the gzip data is damaged or cut off ({source}); fetch or compress it again")]
    Gzip {
        /// The path asked for.
        path: PathBuf,
        /// The error of the decompressor.
        source: io::Error,
    },
    /// The gzip data decompresses to more than the limit.
    #[error(
        "{path}: its {compressed} bytes decompress to more than {limit}, the limit; raise the limit if the file can be trusted"
    )]
    TooLarge {
        /// The path asked for.
        path: PathBuf,
        /// Size of the compressed file in bytes.
        compressed: u64,
        /// The most bytes that it may decompress to.
        limit: u64,
    },
    /// What the file holds takes more than the limit of decompressed sizes: parts of an archive,
    /// arrays, or the meshes that the nodes of a scene place.
    #[error("{path}: {place}{problem}; raise the limit if the file can be trusted")]
    OverLimit {
        /// The path asked for.
        path: PathBuf,
        /// The position in the file.
        place: FilePosition,
        /// What takes more than the limit.
        problem: String,
    },
    /// The content is not valid in its format.
    #[error("{path}: {place}{problem}")]
    Malformed {
        /// The path asked for.
        path: PathBuf,
        /// The position in the file.
        place: FilePosition,
        /// The problem, and a remedy.
        problem: String,
    },
    /// The operating system failed to write it.
    #[error("{path}: cannot be written: {source}")]
    NotWritten {
        /// The path asked for.
        path: PathBuf,
        /// The error of the system.
        source: io::Error,
    },
    /// The file extension belongs to no format that can be written.
    #[error(
        "{path}: the ending does not tell a format that can be written; use .obj, .ply, .off or .stl, each also with .gz"
    )]
    UnknownOutput {
        /// The path asked for.
        path: PathBuf,
    },
}

/// A position in a file, as precise as the format allows. Its text goes before a message: it ends
/// with a colon and a space, and is empty for the whole file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FilePosition {
    /// The file as a whole.
    File,
    /// A line of a text file, counted from 1. For a statement of several lines, the first one.
    Line(u64),
    /// A place in a binary file: its offset in bytes, in the decompressed data.
    Byte(u64),
    /// An element of a binary file.
    Element {
        /// What the format calls it: `vertex`, `face`, `triangle`.
        kind: &'static str,
        /// Its number, counted from 0.
        number: u64,
        /// Offset in bytes at which it starts, in the decompressed data.
        byte: u64,
    },
}

impl fmt::Display for FilePosition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => Ok(()),
            Self::Line(line) => write!(f, "line {line}: "),
            Self::Byte(byte) => write!(f, "byte {byte}: "),
            Self::Element { kind, number, byte } => write!(f, "{kind} {number} (byte {byte}): "),
        }
    }
}

/// A [`FileError::Malformed`] or [`FileError::OverLimit`] without its path.
#[derive(Debug)]
pub(super) struct Flaw {
    pub(super) place: FilePosition,
    pub(super) problem: String,
    /// Whether the file may be valid, and takes more than the limit.
    pub(super) is_over_limit: bool,
}

impl Flaw {
    /// A problem at a position.
    pub(super) fn at(place: FilePosition, problem: impl Into<String>) -> Self {
        Self {
            place,
            problem: problem.into(),
            is_over_limit: false,
        }
    }

    /// A problem with the file as a whole.
    pub(super) fn file(problem: impl Into<String>) -> Self {
        Self::at(FilePosition::File, problem)
    }

    /// A problem in line `line`, counted from 1.
    pub(super) fn line(line: u64, problem: impl Into<String>) -> Self {
        Self::at(FilePosition::Line(line), problem)
    }

    /// The same, of a file that takes more than the limit.
    pub(super) fn over_limit(self) -> Self {
        Self {
            is_over_limit: true,
            ..self
        }
    }

    /// The same, in a part of the file.
    pub(super) fn within(mut self, part: &str) -> Self {
        self.problem.insert_str(0, &format!("{part}: "));
        self
    }
}
