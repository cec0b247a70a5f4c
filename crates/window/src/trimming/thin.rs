//! Faces so thin that windows wind around needles.

use geobench_mesh::{FaceId, HalfEdgeId, Mesh, Splice, VertexId};

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

/// Longest side of a face, relative to the longest edge of the mesh, below which it is tiny.
///
/// The filter deletes no window that is longer than a path through a vertex by less than the
/// [margin](MARGIN) of the distance, which may be that of the longest edge. A window in a region of
/// faces a hundred times as large as that margin is ended after some hundred crossings. Where they
/// are far smaller, beside a spike of 1e16 times their size, none would ever be.
const TINY: f64 = 100.0 * MARGIN;

/// Total angle of a vertex, in radians, below which it counts as the tip of a needle.
const TIP: f64 = 0.35;

/// The half-edges of thin faces, and of faces so small beside others that lengths do not tell their
/// windows apart.
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
    /// The number of thin faces of the mesh of the set-up.
    count: usize,
    doubt: f64,
    has_tip: bool,
    limits: ThinLimits,
    /// The doubt of the mesh of the set-up; negative if no face is thin there.
    own_doubt: f64,
}

/// The limits of a mesh below which a face is thin.
#[derive(Clone, Copy, Debug, Default)]
struct ThinLimits {
    /// Height relative to the longest side.
    height: f64,
    /// Longest side.
    side: f64,
}

impl ThinLimits {
    fn of(mesh: &Mesh, has_tip: bool) -> Self {
        Self {
            height: if has_tip { THIN_AROUND_TIPS } else { THIN },
            side: TINY * mesh.longest_edge(),
        }
    }

    fn is_thin(self, mesh: &Mesh, face: FaceId) -> bool {
        let h = face.half_edge(0);
        relative_height(mesh, h) < self.height || longest_side(mesh, h) < self.side
    }
}

impl ThinFaces {
    /// The thin faces of `mesh`. `number` gives the number of each half-edge, which is less than
    /// `numbers`; [gates](crate::Faces::with_gates) follow. O(faces).
    pub fn of(mesh: &Mesh, numbers: usize, number: impl Fn(HalfEdgeId) -> usize) -> Self {
        let has_tip = mesh.vertices().any(|v| is_tip(mesh, v));
        let limits = ThinLimits::of(mesh, has_tip);
        let mut thin = Self {
            has_tip,
            limits,
            own_doubt: -1.0,
            ..Self::default()
        };
        // Some rounding slack: the faces are selected by another formula.
        let any_thin = mesh.least_relative_height() <= 1.001 * limits.height;
        let any_tiny = mesh.half_edges().any(|h| mesh.length(h) < limits.side);
        if !(any_thin || any_tiny) {
            return thin;
        }
        for face in mesh.faces().filter(|&face| limits.is_thin(mesh, face)) {
            let gates = mesh.junction_sides().len();
            thin.beside.resize(numbers + gates, false);
            thin.count += 1;
            for h in face.half_edges() {
                thin.doubt = thin.doubt.max(MARGIN * mesh.length(h));
                for h in mesh.along_edge(h) {
                    thin.beside[number(h)] = true;
                    if let Some(gate) = mesh.junction_side(h) {
                        thin.beside[numbers + gate] = true;
                    }
                }
            }
        }
        if !thin.is_empty() {
            thin.own_doubt = thin.doubt;
        }
        thin
    }

    /// Follows a change of the mesh, which is `mesh` now; the other arguments are as for
    /// [`of`](Self::of). Takes time in the size of the change, unless the number of half-edges
    /// changes where faces are thin.
    ///
    /// Parts of a split face may be thin. Tips stay where they are: angles do not change.
    pub fn splice(
        &mut self,
        mesh: &Mesh,
        splice: &Splice,
        numbers: usize,
        number: impl Fn(HalfEdgeId) -> usize,
    ) {
        if self.own_doubt < 0.0 {
            // What is thin is what the last change has made.
            self.beside.clear();
        }
        self.doubt = self.own_doubt.max(0.0);
        let gates = mesh.junction_sides().len();
        if !self.is_empty() {
            self.beside.resize(numbers + gates, false);
        }
        for h in splice.faces().flat_map(FaceId::half_edges) {
            let beside = is_beside_thin(mesh, h, self.limits);
            if beside && self.is_empty() {
                self.beside.resize(numbers + gates, false);
            }
            if !self.is_empty() {
                for h in mesh.along_edge(h) {
                    self.beside[number(h)] = beside;
                }
            }
            if self.limits.is_thin(mesh, h.face()) {
                self.doubt = self.doubt.max(MARGIN * mesh.length(h));
            }
        }
        if !self.is_empty() {
            for (gate, h) in mesh.junction_sides().enumerate() {
                self.beside[numbers + gate] = self.beside[number(h)];
            }
        }
    }

    /// Whether the face on either side of `h` is thin, by the limits of the mesh of the set-up. For
    /// data that follow the same [changes](Self::splice).
    pub(super) fn is_beside_on(&self, mesh: &Mesh, h: HalfEdgeId) -> bool {
        is_beside_thin(mesh, h, self.limits)
    }

    /// The number of thin faces of the mesh of the set-up.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Whether `face` is thin, as [`is_beside_on`](Self::is_beside_on).
    pub(super) fn is_thin(&self, mesh: &Mesh, face: FaceId) -> bool {
        self.limits.is_thin(mesh, face)
    }

    /// The limits alone.
    pub(super) fn without_half_edges(self) -> Self {
        Self {
            beside: Vec::new(),
            ..self
        }
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

/// Whether the face on any side of `h` is thin.
fn is_beside_thin(mesh: &Mesh, h: HalfEdgeId, limits: ThinLimits) -> bool {
    mesh.along_edge(h).any(|h| limits.is_thin(mesh, h.face()))
}

/// Height of the face of `h`, relative to its longest edge.
pub(super) fn relative_height(mesh: &Mesh, h: HalfEdgeId) -> f64 {
    let longest = longest_side(mesh, h);
    mesh.length(h) * mesh.apex(h)[1] / (longest * longest)
}

/// Length of the longest side of the face of `h`.
pub(super) fn longest_side(mesh: &Mesh, h: HalfEdgeId) -> f64 {
    let lengths = [h, h.next(), h.prev()].map(|h| mesh.length(h));
    lengths.into_iter().fold(0.0, f64::max)
}

/// Whether windows may wind around `v` more than once.
fn is_tip(mesh: &Mesh, v: VertexId) -> bool {
    let angle = mesh.total_angle(v);
    0.0 < angle && angle < TIP && !mesh.is_boundary(v)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_far_smaller_than_others_count_as_thin() {
        for (size, expected) in [(1e-9, false), (1e-11, true)] {
            let positions = vec![
                [0.0; 3],
                [size, 0.0, 0.0],
                [0.0, size, 0.0],
                [3.0, 0.0, 0.0],
                [4.0, 0.0, 0.0],
                [3.0, 1.0, 0.0],
            ];
            let mesh = Mesh::new(positions, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
            let thin = ThinFaces::of(&mesh, 6, HalfEdgeId::index);
            let beside: Vec<bool> = (0..6).map(|h| thin.is_beside(h)).collect();
            assert_eq!(beside, [expected, expected, expected, false, false, false]);
        }
    }
}
