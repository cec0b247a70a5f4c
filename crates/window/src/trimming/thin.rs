//! Faces so thin that windows wind around needles.

use geobench_mesh::{FaceId, HalfEdgeId, Mesh, VertexId};

use crate::precision::MARGIN;

/// Height of a face, relative to its longest edge, below which it is thin.
///
/// A path that winds N times around a needle of length L and girth c is longer than a straight one
/// by some (Nc)²/2L. The vertex filter deletes its window once this exceeds the detour through a
/// vertex, which is up to c: at N = √(2L/c). That is three turns at this limit, and 2,000 turns
/// where faces are 100,000 times thinner. Up to N = √(2m)·L/c the lengths differ by less than the
/// [margin](crate::precision::MARGIN) m, and cannot be told apart at all.
const THIN: f64 = 6.5e-3;

/// As [`THIN`], on a mesh with a tip.
///
/// On a needle 20 times as long as wide no face is thin by [`THIN`], but windows still wind around
/// it ten times. Scans have no tips, so they do not pay for this wider limit.
const THIN_AROUND_TIPS: f64 = 0.1;

/// Total angle of a vertex, in radians, below which it counts as the tip of a needle.
const TIP: f64 = 0.35;

/// The half-edges of thin faces.
///
/// ```
/// use geobench_mesh::{HalfEdgeId, Mesh};
/// use geobench_window::trimming::ThinFaces;
///
/// let mesh = Mesh::new(
///     vec![[0.0; 3], [1.0, 0.0, 0.0], [0.5, 1e-3, 0.0], [0.5, -1.0, 0.0]],
///     vec![[0, 1, 2], [1, 0, 3]],
/// )?;
/// let thin = ThinFaces::of(&mesh, 6, HalfEdgeId::index);
/// let beside: Vec<bool> = (0..6).map(|h| thin.is_beside(h)).collect();
/// assert_eq!(beside, [true, true, true, true, false, false]);
/// # Ok::<(), geobench_mesh::InvalidMesh>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct ThinFaces {
    /// Whether the face on either side is thin, by number of half-edge; empty if no face is thin.
    beside: Vec<bool>,
    doubt: f64,
    has_tip: bool,
}

impl ThinFaces {
    /// The thin faces of `mesh`. `number` gives the number of each half-edge, which is less than
    /// `numbers`. O(faces).
    pub fn of(mesh: &Mesh, numbers: usize, number: impl Fn(HalfEdgeId) -> usize) -> Self {
        let mut thin = Self {
            has_tip: mesh.vertices().any(|v| is_tip(mesh, v)),
            ..Self::default()
        };
        let limit = if thin.has_tip { THIN_AROUND_TIPS } else { THIN };
        // Some rounding slack: the faces are selected by another formula.
        if mesh.least_relative_height() > 1.001 * limit {
            return thin;
        }
        let is_thin = |face: &FaceId| relative_height(mesh, face.half_edge(0)) < limit;
        for face in mesh.faces().filter(is_thin) {
            thin.beside.resize(numbers, false);
            for h in [0, 1, 2].map(|corner| face.half_edge(corner)) {
                thin.doubt = thin.doubt.max(MARGIN * mesh.length(h));
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

    /// How much longer than the shortest path a window may be that was stored first among equals:
    /// beside thin faces up to the [margin](MARGIN) of their longest side.
    #[inline]
    pub fn doubt(&self) -> f64 {
        self.doubt
    }

    /// Whether the mesh has the tip of a needle, around which windows may wind more than once.
    #[inline]
    pub fn has_tip(&self) -> bool {
        self.has_tip
    }

    /// Whether the face on either side of half-edge number `h` is thin.
    #[inline]
    pub fn is_beside(&self, h: usize) -> bool {
        self.beside.get(h).copied().unwrap_or(false)
    }
}

/// Height of the face of `h`, relative to its longest edge.
fn relative_height(mesh: &Mesh, h: HalfEdgeId) -> f64 {
    let lengths = [h, h.next(), h.prev()].map(|h| mesh.length(h));
    let longest = lengths.into_iter().fold(0.0, f64::max);
    lengths[0] * mesh.apex(h)[1] / (longest * longest)
}

/// Whether windows may wind around `v` more than once.
fn is_tip(mesh: &Mesh, v: VertexId) -> bool {
    let angle = mesh.total_angle(v);
    0.0 < angle && angle < TIP && !mesh.is_boundary(v)
}
