//! A mesh with sources, and the verdicts on an answer.

use std::fmt;

use geobench_oracle::nasty::{Kind, Nasty};
use geobench_oracle::{Random, Transform};
use serde::{Deserialize, Serialize};

/// Most faces of a case that is not large.
const MOST_SMALL: usize = 1000;

/// A mesh, its sources, and the limits of an algorithm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Case {
    pub(crate) vertices: Vec<[f64; 3]>,
    pub(crate) faces: Vec<[u32; 3]>,
    pub(crate) sources: Vec<u32>,
    /// The algorithms whose windows are limited.
    pub(crate) limited: Limited,
    /// A change of the mesh that must not change distances, by its seed; see [`Case::transform`].
    pub(crate) transform: Option<u64>,
}

/// The algorithms that may take at most [`MOST_WORK`](crate::judge::MOST_WORK) times as many
/// windows as `mmp-fast`.
///
/// A hang is a failure of the others as well.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Limited {
    None,
    /// Those that take the nearest first, on the kinds built against algorithms.
    ///
    /// On a chain of cells, a comb or a spike, a vertex has many paths of few edges that are longer
    /// than its shortest path. A breadth-first or coarse order, which is that of some papers,
    /// finds them first. Each sends windows, and each vertex behind repeats this. That is the cost
    /// of such an order and no defect.
    NearestFirst,
    /// All, on needles and slivers. There windows wind around a vertex until a nearer one beats
    /// them. Their number would depend on the coordinates, not on the size of the mesh, if only the
    /// order ended them.
    All,
}

impl Case {
    /// Whether the case is large: only some algorithms solve it, and take longer.
    pub(crate) fn is_large(&self) -> bool {
        self.faces.len() > MOST_SMALL
    }

    /// The change of the mesh, and its random numbers.
    pub(crate) fn transform(&self) -> Option<(Transform, Random)> {
        let seed = self.transform?;
        let place = seed % Transform::ALL.len() as u64;
        Some((Transform::ALL[place as usize], Random::new(seed)))
    }
}

impl From<Nasty> for Case {
    fn from(mesh: Nasty) -> Self {
        Self {
            vertices: mesh.model.positions().unwrap_or_default().to_vec(),
            faces: mesh.model.triangles,
            sources: mesh.model.sources,
            limited: match mesh.kind {
                Kind::NeedleTip => Limited::All,
                kind if Kind::BUILT.contains(&kind) => Limited::NearestFirst,
                _ => Limited::None,
            },
            transform: Some(mesh.seed),
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
    /// The certificate does not prove the distances. It claims nothing false.
    Unproven,
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
    /// A path is missing, or it is no shortest one.
    Path,
    /// Other distances after a change of the mesh that must not change them.
    Transform,
    /// A proof of wrong distances.
    Proof,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.kind, self.text)
    }
}

impl FailureKind {
    pub(crate) const ALL: [Self; 9] = [
        Self::TooLong,
        Self::TooShort,
        Self::Lost,
        Self::Panic,
        Self::Hang,
        Self::Work,
        Self::Path,
        Self::Transform,
        Self::Proof,
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
            Self::Path => "path",
            Self::Transform => "transform",
            Self::Proof => "proof",
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

/// What decides which distances are right.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) enum Reference {
    /// Known distances, or those of the oracle.
    Oracle,
    /// On large meshes, distances with a proof.
    Certificate,
    /// On other large meshes, the distances on which most of some algorithms agree.
    Agreement,
}
