//! A mesh with sources, and the verdicts on an answer.

use std::fmt;

use geobench_oracle::nasty::{Kind, Nasty};
use serde::{Deserialize, Serialize};

/// A mesh, its sources, and the limits of an algorithm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Case {
    pub(crate) vertices: Vec<[f64; 3]>,
    pub(crate) faces: Vec<[u32; 3]>,
    pub(crate) sources: Vec<u32>,
    /// Whether windows are counted: at most [`MOST_WORK`](crate::judge::MOST_WORK) times as many as
    /// those of `mmp-fast` are allowed.
    pub(crate) bounded: bool,
}

impl From<Nasty> for Case {
    fn from(mesh: Nasty) -> Self {
        Self {
            vertices: mesh.model.positions().unwrap_or_default().to_vec(),
            faces: mesh.model.triangles,
            sources: mesh.model.sources,
            bounded: mesh.kind == Kind::NeedleTip,
        }
    }
}

/// Distances; `None` if unreachable.
pub(crate) type Expected = Vec<Option<f64>>;

/// The verdict on an answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Verdict {
    Right,
    /// Wrong by no more than [`precision::doubt`](geobench_window::precision::doubt) states for the
    /// mesh.
    InDoubt,
    /// The algorithm is known to take too long on such a mesh.
    LeftOut,
    Failed(Failure),
}

impl Verdict {
    pub(crate) fn is_hang(&self) -> bool {
        matches!(self, Self::Failed(failure) if failure.kind == FailureKind::Hang)
    }
}

/// A defect of an answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Failure {
    pub(crate) kind: FailureKind,
    pub(crate) text: String,
}

/// The kinds of failures, which are the columns of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) enum FailureKind {
    TooLong,
    TooShort,
    /// Infinite at a reachable vertex.
    Lost,
    Panic,
    Hang,
    /// Too many windows.
    Work,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.kind, self.text)
    }
}

impl FailureKind {
    pub(crate) const ALL: [Self; 6] = [
        Self::TooLong,
        Self::TooShort,
        Self::Lost,
        Self::Panic,
        Self::Hang,
        Self::Work,
    ];
}

impl fmt::Display for FailureKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::TooLong => "too long",
            Self::TooShort => "too short",
            Self::Lost => "lost",
            Self::Panic => "panic",
            Self::Hang => "hang",
            Self::Work => "work",
        })
    }
}

/// Why a case is not judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) enum Skip {
    /// The mesh is refused.
    Refused,
    /// Building the mesh panics, which counts as a failure.
    MeshPanics,
    /// The oracle takes too long.
    GaveUp,
    /// Two searches of the oracle disagree.
    Unsure,
}
