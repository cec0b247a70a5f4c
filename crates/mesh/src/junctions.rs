//! Junctions: edges at which no half-edge has a twin although several faces meet.

use crate::ids::HalfEdgeId;
use crate::mesh::Mesh;

/// The junctions of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Junctions {
    /// The half-edges along each junction, ascending, junction after junction.
    half_edges: Vec<HalfEdgeId>,
    /// The same half-edges, ascending, each with the range of its junction in `half_edges`.
    sides: Vec<(HalfEdgeId, [u32; 2])>,
}

impl Junctions {
    /// The junctions with these half-edges.
    pub(crate) fn new<G: IntoIterator<Item = HalfEdgeId>>(
        junctions: impl IntoIterator<Item = G>,
    ) -> Self {
        let mut all = Self::default();
        for junction in junctions {
            let start = all.half_edges.len();
            all.half_edges.extend(junction);
            all.half_edges[start..].sort_unstable();
            let range = [start, all.half_edges.len()].map(|i| i as u32);
            let own = all.half_edges[start..].iter();
            all.sides.extend(own.map(|&h| (h, range)));
        }
        all.sides.sort_unstable();
        all
    }

    /// The half-edges along each junction.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &[HalfEdgeId]> {
        let firsts = self
            .sides
            .iter()
            .filter(|(h, [start, _])| self.half_edges[*start as usize] == *h);
        firsts.map(|(_, range)| self.range(*range))
    }

    fn range(&self, [start, end]: [u32; 2]) -> &[HalfEdgeId] {
        &self.half_edges[start as usize..end as usize]
    }

    fn place(&self, h: HalfEdgeId) -> Option<usize> {
        self.sides.binary_search_by_key(&h, |side| side.0).ok()
    }
}

/// A *junction* is an edge with more than two faces, or with two whose half-edges have the same
/// direction, as somewhere on every surface that cannot be oriented. A path may go on from any of
/// the faces into any other.
///
/// A half-edge along a junction has no [twin](Mesh::twin). To code that asks for no more, the mesh
/// is cut apart along its junctions, which meet at [pinched](Mesh::is_pinched) vertices only.
impl Mesh {
    /// Whether the mesh has a junction.
    #[inline]
    pub fn has_junctions(&self) -> bool {
        !self.data.junctions.sides.is_empty()
    }

    /// Whether some edge has more than two faces.
    pub fn has_edges_of_many_faces(&self) -> bool {
        self.data
            .junctions
            .iter()
            .any(|junction| junction.len() > 2)
    }

    /// All half-edges along the junction of `h`, ascending, with `h` itself; empty if the edge of
    /// `h` is no junction. Those with the [tail](Mesh::tail) of `h` have its direction.
    ///
    /// ```
    /// use geobench_mesh::{FaceId, Mesh};
    ///
    /// // Three triangles on the edge from 0 to 1.
    /// let positions = vec![
    ///     [0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0],
    /// ];
    /// let mesh = Mesh::new(positions, vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]])?;
    /// let first = [0, 1, 2].map(|face| FaceId::new(face).half_edge(0));
    /// assert_eq!(mesh.junction(first[1]), first);
    /// assert!(mesh.junction(first[1].next()).is_empty());
    /// assert_eq!(mesh.twin(first[1]), None);
    /// # Ok::<(), geobench_mesh::InvalidMesh>(())
    /// ```
    pub fn junction(&self, h: HalfEdgeId) -> &[HalfEdgeId] {
        let junctions = &self.data.junctions;
        let place = junctions.place(h);
        place.map_or(&[], |i| junctions.range(junctions.sides[i].1))
    }

    /// All half-edges along junctions, ascending.
    pub fn junction_sides(&self) -> impl ExactSizeIterator<Item = HalfEdgeId> {
        self.data.junctions.sides.iter().map(|side| side.0)
    }

    /// The place of `h` among the [half-edges along junctions](Self::junction_sides).
    pub fn junction_side(&self, h: HalfEdgeId) -> Option<usize> {
        self.data.junctions.place(h)
    }

    /// The half-edge with the lowest number along the edge of `h`. It stands for the edge.
    #[inline]
    pub fn edge_of(&self, h: HalfEdgeId) -> HalfEdgeId {
        match self.twin(h) {
            Some(twin) => twin.min(h),
            None => self.junction(h).first().copied().unwrap_or(h),
        }
    }

    /// All half-edges along the edge of `h`, in no order.
    pub fn along_edge(&self, h: HalfEdgeId) -> impl Iterator<Item = HalfEdgeId> {
        let others = self.junction(h).iter().copied();
        let others = others.filter(move |&other| other != h);
        [h].into_iter().chain(self.twin(h)).chain(others)
    }

    /// Whether the edge of `h` has one face only.
    #[inline]
    pub fn is_boundary_edge(&self, h: HalfEdgeId) -> bool {
        self.twin(h).is_none() && self.junction(h).is_empty()
    }
}
