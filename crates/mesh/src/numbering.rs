//! An order of vertices and faces that keeps neighbours near each other in memory.

use crate::{FaceId, HalfEdgeId, Mesh, VertexId};

/// A bijection between a mesh's numbers of vertices and faces and *new* numbers.
///
/// A solver with its own layout orders elements as a wavefront meets them, whatever the order of
/// the file. New numbers are used inside the solver only. The corners of a face keep their order.
///
/// Without a map, numbers stay the same, and so do those of elements that were added to the mesh
/// later. This holds for [`same`](Self::same) and after
/// [`keep_new_vertices`](Self::keep_new_vertices) or [`keep_new_faces`](Self::keep_new_faces).
///
/// ```
/// use geobench_mesh::{Mesh, Numbering, VertexId};
///
/// let mesh = Mesh::generate("sphere,subdiv=1")?;
/// let numbering = Numbering::breadth_first(&mesh);
/// let v = VertexId::new(7);
/// assert_eq!(numbering.old_vertex(numbering.new_vertex(v)), v);
/// # Ok::<(), geobench_mesh::MeshError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Numbering {
    /// All maps are empty if the numbers stay the same.
    old_vertices: Vec<u32>,
    new_vertices: Vec<u32>,
    old_faces: Vec<u32>,
    new_faces: Vec<u32>,
}

/// The new number of elements that have none yet.
const NONE: u32 = u32::MAX;

impl Numbering {
    /// The numbering that changes nothing.
    pub fn same() -> Self {
        Self {
            old_vertices: vec![],
            new_vertices: vec![],
            old_faces: vec![],
            new_faces: vec![],
        }
    }

    /// Breadth first from the first vertex of each component: close to the order in which a
    /// wavefront meets the elements, wherever it starts. O(faces).
    pub fn breadth_first(mesh: &Mesh) -> Self {
        let mut vertices = Order::new(mesh.vertex_count());
        let mut faces = Order::new(mesh.face_count());
        for start in mesh.vertices() {
            let mut place = vertices.count;
            vertices.take(start.raw());
            while place < vertices.count {
                let v = VertexId::new(vertices.old[place]);
                place += 1;
                let ring = mesh.outgoing(v);
                for &h in ring {
                    faces.take(h.face().raw());
                    vertices.take(mesh.head(h).raw());
                    // In a fan the apex is the next head, except for the last half-edge.
                    if mesh.is_pinched(v) {
                        vertices.take(mesh.apex_vertex(h).raw());
                    }
                }
                if let Some(&last) = ring.last() {
                    vertices.take(mesh.apex_vertex(last).raw());
                }
            }
        }
        let ([old_vertices, new_vertices], [old_faces, new_faces]) =
            (vertices.maps(), faces.maps());
        Self {
            old_vertices,
            new_vertices,
            old_faces,
            new_faces,
        }
    }

    /// The vertex of the mesh whose new number is `v`.
    #[inline]
    pub fn old_vertex(&self, v: VertexId) -> VertexId {
        self.old_vertices
            .get(v.index())
            .map_or(v, |&v| VertexId::new(v))
    }

    /// The new number of vertex `v` of the mesh.
    #[inline]
    pub fn new_vertex(&self, v: VertexId) -> VertexId {
        self.new_vertices
            .get(v.index())
            .map_or(v, |&v| VertexId::new(v))
    }

    /// The face of the mesh whose new number is `f`.
    #[inline]
    pub fn old_face(&self, f: FaceId) -> FaceId {
        self.old_faces.get(f.index()).map_or(f, |&f| FaceId::new(f))
    }

    /// The new number of face `f` of the mesh.
    #[inline]
    pub fn new_face(&self, f: FaceId) -> FaceId {
        self.new_faces.get(f.index()).map_or(f, |&f| FaceId::new(f))
    }

    /// The new number of half-edge `h` of the mesh: the same corner of the renumbered face.
    #[inline]
    pub fn new_half_edge(&self, h: HalfEdgeId) -> HalfEdgeId {
        self.new_face(h.face()).half_edge(h.corner())
    }

    /// Keeps the map from vertices to new numbers and drops the other maps, which only set-up
    /// needs.
    pub fn keep_new_vertices(&mut self) {
        (self.old_faces, self.new_faces) = (Vec::new(), Vec::new());
        self.old_vertices = Vec::new();
    }

    /// Keeps the map from faces to new numbers and drops the other maps.
    pub fn keep_new_faces(&mut self) {
        (self.old_vertices, self.new_vertices) = (Vec::new(), Vec::new());
        self.old_faces = Vec::new();
    }

    /// Reorders the `values` of vertices from new numbers to the mesh's numbers.
    ///
    /// # Panics
    ///
    /// If there are fewer values than vertices.
    pub fn restore(&self, values: &[f64]) -> Vec<f64> {
        if self.new_vertices.is_empty() {
            return values.to_vec();
        }
        // Vertices that were added later follow in both orders.
        let added = &values[self.new_vertices.len()..];
        let places = self.new_vertices.iter();
        let known = places.map(|&place| values[place as usize]);
        known.chain(added.iter().copied()).collect()
    }
}

/// Numbers elements in the order in which they are taken.
struct Order {
    /// Elements by new number, with one more entry.
    old: Vec<u32>,
    new: Vec<u32>,
    count: usize,
}

impl Order {
    fn new(elements: usize) -> Self {
        Self {
            old: vec![0; elements + 1],
            new: vec![NONE; elements],
            count: 0,
        }
    }

    /// Gives `element` the next number if it has none. Whether it has one is hard to predict, so
    /// there is no branch.
    #[inline]
    fn take(&mut self, element: u32) {
        let new = &mut self.new[element as usize];
        let is_next = *new == NONE;
        *new = if is_next { self.count as u32 } else { *new };
        self.old[self.count] = element;
        self.count += usize::from(is_next);
    }

    /// The maps from new numbers to elements, and back.
    fn maps(mut self) -> [Vec<u32>; 2] {
        self.old.truncate(self.count);
        [self.old, self.new]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TriangleSoup;

    #[test]
    fn every_vertex_and_face_has_one_number_and_neighbours_are_near() {
        // Two triangles with a common edge, one apart, and a vertex without a face.
        let positions = (0..8)
            .map(|i| [f64::from(i * i), f64::from(i), 0.0])
            .collect();
        let triangles = vec![[0, 5, 7], [7, 5, 2], [1, 3, 4]];
        let (mesh, _) = Mesh::from_soup(TriangleSoup::new(positions, triangles)).unwrap();
        let numbering = Numbering::breadth_first(&mesh);
        let mut component = [0, 5, 7, 2].map(|v| numbering.new_vertex(VertexId::new(v)).raw());
        component.sort_unstable();
        assert_eq!(component, [0, 1, 2, 3]);
        check(&mesh, &numbering);
        let values: Vec<f64> = (0..8).map(f64::from).collect();
        assert_eq!(Numbering::same().restore(&values), values);
    }

    fn check(mesh: &Mesh, numbering: &Numbering) {
        for v in mesh.vertices() {
            assert_eq!(numbering.old_vertex(numbering.new_vertex(v)), v);
        }
        for h in mesh.half_edges() {
            let new = numbering.new_half_edge(h);
            assert_eq!(numbering.old_face(new.face()).half_edge(new.corner()), h);
        }
        let values: Vec<f64> = (0..8)
            .map(|v| f64::from(numbering.old_vertex(VertexId::new(v)).raw()))
            .collect();
        let restored = numbering.restore(&values);
        assert_eq!(restored, (0..8).map(f64::from).collect::<Vec<_>>());
    }
}
