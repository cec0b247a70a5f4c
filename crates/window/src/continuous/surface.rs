//! The faces of a mesh and the vertex distances of a run.

use geobench_mesh::{HalfEdgeId, Mesh, Numbering, Splice, VertexId};

use super::edge::{Behind, EdgeView};
use crate::frame::Faces;
use crate::prefetch::prefetch;

/// The faces of the mesh, with the least distance found so far of every vertex.
///
/// ```
/// use geobench_mesh::{Mesh, VertexId};
/// use geobench_window::continuous::Surface;
///
/// let mesh = Mesh::generate("grid,n=2")?;
/// let mut surface = Surface::new(&mesh);
/// surface.reset(mesh.vertex_count());
/// let v = VertexId::new(0);
/// assert!(surface.offer(v, 2.0) && !surface.offer(v, 3.0));
/// assert_eq!(surface.distance(v), 2.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Surface {
    faces: Faces,
    distances: Vec<f64>,
}

impl Surface {
    /// The order in which faces are laid out: breadth first. Half-edges have its numbers during a
    /// run. O(faces).
    pub fn order(mesh: &Mesh) -> Numbering {
        Numbering::breadth_first(mesh)
    }

    /// The faces of `mesh`, laid out in their [order](Self::order), with
    /// [gates](Faces::with_gates) at junctions; O(faces).
    pub fn new(mesh: &Mesh) -> Self {
        Self {
            faces: Faces::in_order(mesh, Self::order(mesh)).with_gates(mesh),
            distances: Vec::new(),
        }
    }

    /// Follows a change of the mesh, as [`Faces::splice`].
    pub fn splice(&mut self, mesh: &Mesh, splice: &Splice) {
        self.faces.splice(mesh, splice);
    }

    /// Sets the distances of all `vertices` to infinity.
    pub fn reset(&mut self, vertices: usize) {
        self.distances.clear();
        self.distances.resize(vertices, f64::INFINITY);
    }

    /// Changes the number of vertices. The distances of added ones are infinite.
    pub(super) fn resize(&mut self, vertices: usize) {
        self.distances.resize(vertices, f64::INFINITY);
    }

    /// Sets the distance of `v` to infinity.
    pub(super) fn forget(&mut self, v: VertexId) {
        self.distances[v.index()] = f64::INFINITY;
    }

    /// Takes the distances, leaving none.
    pub fn take_distances(&mut self) -> Vec<f64> {
        std::mem::take(&mut self.distances)
    }

    /// The faces of the mesh.
    #[inline]
    pub fn faces(&self) -> &Faces {
        &self.faces
    }

    /// Length of the shortest path to `v` found so far. A window is stale if its σ exceeds the
    /// distance of its (pseudo-)source.
    #[inline]
    pub fn distance(&self, v: VertexId) -> f64 {
        self.distances[v.index()]
    }

    /// Offers `v` a path of length `d`; returns whether it is the shortest so far.
    #[inline]
    pub fn offer(&mut self, v: VertexId, d: f64) -> bool {
        let known = &mut self.distances[v.index()];
        let improves = d < *known;
        if improves {
            *known = d;
        }
        improves
    }

    /// Prefetches the face of `h`, which a window is likely to enter soon.
    #[inline]
    pub fn announce(&self, h: HalfEdgeId) {
        self.faces.announce(h);
    }

    /// Prefetches the distances of the vertices of the face of `h`, which a window is likely to
    /// enter in one or two turns.
    #[inline]
    pub fn prepare(&self, h: HalfEdgeId) {
        for v in self.faces.corners(h) {
            self.announce_vertex(v);
        }
    }

    /// Prefetches the [distance](Self::distance) of `v`.
    #[inline]
    pub fn announce_vertex(&self, v: VertexId) {
        prefetch(&self.distances, v.index());
    }

    /// The edge of `h`, for a window that starts there.
    #[inline]
    pub fn edge(&self, h: HalfEdgeId) -> EdgeView {
        let [tail, head, _] = self.faces.corners(h).map(|v| self.distance(v));
        EdgeView {
            length: self.faces.length(h),
            tail,
            head,
            behind: Behind {
                position: [0.0; 2],
                distance: f64::INFINITY,
                is_left: 1.0,
                is_right: 0.0,
            },
        }
    }
}
