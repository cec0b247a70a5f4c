//! Where faces are so thin that windows wind around needles.

use geobench_mesh::{HalfEdgeId, Mesh};

/// Height of a face, relative to its longest edge, below which it is thin.
///
/// A path that winds N times around a needle of length L and girth c is longer than a straight one
/// by some (Nc)²/2L. The vertex filter deletes its window once that is more than the detour by way
/// of a vertex, which is up to c: at N = √(2L/c), three turns where faces are as thin as this, and
/// 2,000 where they are 100,000 times thinner. Lengths do not tell both paths apart at all, to the
/// [margin](crate::precision::MARGIN) m, up to N = √(2m)·L/c.
const THIN: f64 = 6.5e-3;

/// The half-edges of thin faces.
#[derive(Clone, Debug, Default)]
pub struct ThinFaces {
    /// By number of half-edge, whether the face on either side is thin; empty if none is.
    beside: Vec<bool>,
}

impl ThinFaces {
    /// Looks for those of `mesh`, whose half-edges have the numbers that `number` gives, all less
    /// than `numbers`; O(faces).
    pub fn of(mesh: &Mesh, numbers: usize, number: impl Fn(HalfEdgeId) -> usize) -> Self {
        let mut thin = Self::default();
        for face in mesh
            .faces()
            .filter(|&face| is_thin(mesh, face.half_edge(0)))
        {
            thin.beside.resize(numbers, false);
            for h in [0, 1, 2].map(|corner| face.half_edge(corner)) {
                for h in [Some(h), mesh.twin(h)].into_iter().flatten() {
                    thin.beside[number(h)] = true;
                }
            }
        }
        thin
    }

    /// Whether no face is thin, as on nearly all meshes.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.beside.is_empty()
    }

    /// Whether the face on either side of half-edge number `h` is thin.
    #[inline]
    pub fn is_beside(&self, h: usize) -> bool {
        self.beside.get(h).copied().unwrap_or(false)
    }
}

/// Whether the face of `h` is thin.
fn is_thin(mesh: &Mesh, h: HalfEdgeId) -> bool {
    let lengths = [h, h.next(), h.prev()].map(|h| mesh.length(h));
    let longest = lengths.into_iter().fold(0.0, f64::max);
    lengths[0] * mesh.apex(h)[1] < THIN * longest * longest
}
