//! The half-edge mesh that every solver reads.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::frames::{FaceShapes, apexes_from_lengths, apexes_from_positions, measure};
use crate::generate::{GenerateError, Spec, generate};
use crate::ids::{FaceId, HalfEdgeId, VertexId};
use crate::io::{FileError, ReadOptions};
use crate::junctions::Junctions;
use crate::report::{InvalidMesh, Report};
use crate::rows::RowTable;
use crate::soup::TriangleSoup;
use crate::stand_ins::StandIns;

/// A triangulated surface, with or without boundary, immutable after construction. At its
/// [junctions](Self::junction) it is no 2-manifold, or changes its orientation.
///
/// Half-edge `3 * face + corner` starts at that corner. [`HalfEdgeId::next`] and
/// [`HalfEdgeId::prev`] are arithmetic; only the twin is stored. In the *frame* of a half-edge the
/// tail is the origin, the head lies on the positive x-axis, and the face lies above (y > 0).
/// [`apex`](Mesh::apex) is the position of the third vertex in this frame. Geodesics depend only on
/// lengths and frames. A mesh built from lengths alone has no positions.
///
/// Vertices have the numbers of the file. Methods that take a vertex, face or half-edge panic if
/// the mesh has no such element.
///
/// Clones share the data, so cloning is O(1). Solvers keep a clone of the mesh that they are set up
/// for.
///
/// ```
/// use geobench_mesh::{FaceId, Mesh, TriangleSoup, VertexId};
///
/// let positions = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 3.0, 0.0], [4.0, 3.0, 0.0]];
/// let soup = TriangleSoup::new(positions, vec![[0, 1, 2], [1, 3, 2]]);
/// let (mesh, _report) = Mesh::from_soup(soup)?;
///
/// let h = FaceId::new(0).half_edge(1); // From vertex 1 to vertex 2.
/// assert_eq!((mesh.tail(h), mesh.head(h)), (VertexId::new(1), VertexId::new(2)));
/// assert_eq!(mesh.length(h), 5.0);
/// assert_eq!(mesh.twin(h), Some(FaceId::new(1).half_edge(2)));
/// assert_eq!(mesh.twin(h.next()), None); // The edge from 2 to 0 is on the boundary.
///
/// // Vertex 0 in the frame of that half-edge: 3.2 along it, 2.4 above it.
/// let [x, y] = mesh.apex(h);
/// assert!((x - 3.2).abs() < 1e-12 && (y - 2.4).abs() < 1e-12);
/// assert_eq!(mesh.neighbours(VertexId::new(0)).count(), 2);
/// # Ok::<(), geobench_mesh::InvalidMesh>(())
/// ```
#[derive(Clone, Debug)]
pub struct Mesh {
    pub(crate) data: Arc<MeshData>,
}

/// The arrays of a [`Mesh`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MeshData {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) tails: Vec<VertexId>,
    pub(crate) twins: Vec<u32>,
    pub(crate) lengths: Vec<f64>,
    pub(crate) outgoing_rows: RowTable,
    pub(crate) outgoing: Vec<HalfEdgeId>,
    pub(crate) total_angles: Vec<f64>,
    pub(crate) flags: Vec<VertexFlags>,
    pub(crate) extremes: Extremes,
    /// The apexes of the parts of split faces. Positions would give them less accurately.
    pub(crate) frames: BTreeMap<FaceId, [[f64; 2]; 3]>,
    pub(crate) stand_ins: StandIns,
    pub(crate) junctions: Junctions,
}

/// Extreme values over all faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Extremes {
    pub(crate) longest_edge: f64,
    /// Least height of a face, relative to its longest edge.
    pub(crate) least_height: f64,
}

impl Default for Extremes {
    fn default() -> Self {
        Self {
            longest_edge: 0.0,
            least_height: f64::INFINITY,
        }
    }
}

impl Extremes {
    /// The extremes of both sets of faces.
    pub(crate) fn with(self, other: Self) -> Self {
        Self {
            longest_edge: self.longest_edge.max(other.longest_edge),
            least_height: self.least_height.min(other.least_height),
        }
    }

    /// The extremes of one face.
    pub(crate) fn of(longest: f64, twice_area: f64) -> Self {
        Self {
            longest_edge: longest,
            least_height: twice_area / (longest * longest),
        }
    }
}

/// Properties of a vertex; see the accessors of [`Mesh`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(clippy::struct_excessive_bools)] // Four independent facts, one byte each.
pub(crate) struct VertexFlags {
    pub(crate) boundary: bool,
    pub(crate) saddle: bool,
    pub(crate) pinched: bool,
    pub(crate) beside_sliver: bool,
}

/// The entry of `twins` for a boundary half-edge.
pub(crate) const NO_TWIN: u32 = u32::MAX;

/// The least and the greatest coordinates; `None` without positions.
pub(crate) fn bounding_box_of<'a>(
    mut positions: impl Iterator<Item = &'a [f64; 3]>,
) -> Option<[[f64; 3]; 2]> {
    let first = positions.next()?;
    Some(positions.fold([*first; 2], |[low, high], p| {
        let [least, most] = [f64::min, f64::max];
        [
            [0, 1, 2].map(|i| least(low[i], p[i])),
            [0, 1, 2].map(|i| most(high[i], p[i])),
        ]
    }))
}

/// The distance of two opposite corners of a box.
pub(crate) fn diagonal_of([low, high]: [[f64; 3]; 2]) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|k| high[k] - low[k]);
    x.hypot(y).hypot(z)
}

/// Why a mesh could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] FileError),
    /// The spec is invalid.
    #[error(transparent)]
    Generate(#[from] GenerateError),
    /// The file has fatal defects.
    #[error("{path}: {error}")]
    Invalid {
        /// The path of the file.
        path: PathBuf,
        /// All defects.
        #[source]
        error: InvalidMesh,
    },
}

impl Mesh {
    /// Builds the mesh of `triangles`, whose corners are indices of `positions`.
    ///
    /// Repairs and notes are not returned; [`from_soup`](Self::from_soup) returns them.
    ///
    /// # Errors
    ///
    /// If the mesh is invalid. The error has every defect with its elements.
    pub fn new(positions: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Result<Self, InvalidMesh> {
        Self::from_soup(TriangleSoup::new(positions, triangles)).map(|(mesh, _)| mesh)
    }

    /// Reads a file in a format of [`io`](crate::io), which may be compressed with gzip, and builds
    /// its mesh.
    /// Combines [`io::read`](crate::io::read) and [`from_soup`](Self::from_soup).
    ///
    /// # Errors
    ///
    /// If the file cannot be read or its mesh is invalid. The message names the file, and the line
    /// or the elements.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, MeshError> {
        Self::read_with(path, ReadOptions::default()).map(|(mesh, _)| mesh)
    }

    /// As [`read`](Self::read), with these options. Returns the repairs and notes as well.
    ///
    /// ```
    /// use geobench_mesh::{Mesh, Weld, io::ReadOptions};
    ///
    /// # let dir = tempfile::tempdir()?;
    /// # let path = dir.path().join("seam.off");
    /// // Vertices 1 and 2 are given once more, for the second triangle.
    /// let text = "OFF\n6 2 0\n0 0 0\n1 0 0\n0 1 0\n1 0 0\n0 1 0\n1 1 0\n3 0 1 2\n3 3 5 4\n";
    /// std::fs::write(&path, text)?;
    /// let options = ReadOptions { weld: Some(Weld::COINCIDENT), ..ReadOptions::default() };
    /// let (mesh, _report) = Mesh::read_with(&path, options)?;
    /// assert_eq!(mesh.kept_vertex(4.into()), 2.into());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`read`](Self::read).
    pub fn read_with(
        path: impl AsRef<Path>,
        options: ReadOptions,
    ) -> Result<(Self, Report), MeshError> {
        let path = path.as_ref();
        let invalid = |error| MeshError::Invalid {
            path: path.to_owned(),
            error,
        };
        Self::from_soup(options.read(path)?).map_err(invalid)
    }

    /// Makes the model of a spec, such as `torus,faces=5000`; see [`generate`](crate::generate).
    ///
    /// ```
    /// let mesh = geobench_mesh::Mesh::generate("sphere,subdiv=2")?;
    /// assert_eq!((mesh.vertex_count(), mesh.face_count()), (162, 320));
    /// # Ok::<(), geobench_mesh::MeshError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the spec is invalid.
    pub fn generate(spec: &str) -> Result<Self, MeshError> {
        let spec: Spec = spec.parse()?;
        let invalid = |error| MeshError::Invalid {
            path: spec.to_string().into(),
            error,
        };
        let (mesh, _) = Self::from_soup(generate(&spec)?).map_err(invalid)?;
        Ok(mesh)
    }

    /// Number of vertices, including isolated ones.
    pub fn vertex_count(&self) -> usize {
        self.data.flags.len()
    }

    /// Number of triangles.
    pub fn face_count(&self) -> usize {
        self.data.tails.len() / 3
    }

    /// Number of half-edges: three for each face.
    pub fn half_edge_count(&self) -> usize {
        self.data.tails.len()
    }

    /// All vertices, in the file's order.
    pub fn vertices(&self) -> impl ExactSizeIterator<Item = VertexId> + Clone + use<> {
        (0..self.vertex_count() as u32).map(VertexId::new)
    }

    /// All faces.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = FaceId> + Clone + use<> {
        (0..self.face_count() as u32).map(FaceId::new)
    }

    /// All half-edges.
    pub fn half_edges(&self) -> impl ExactSizeIterator<Item = HalfEdgeId> + Clone + use<> {
        (0..self.half_edge_count() as u32).map(HalfEdgeId::new)
    }

    /// Coordinates of every vertex; empty for a mesh built from edge lengths alone.
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.data.positions
    }

    /// The least and the greatest coordinates of the vertices; `None` without positions.
    pub fn bounding_box(&self) -> Option<[[f64; 3]; 2]> {
        bounding_box_of(self.positions().iter())
    }

    /// The diagonal of the [bounding box](Self::bounding_box); 0 without positions.
    pub fn diagonal(&self) -> f64 {
        self.bounding_box().map_or(0.0, diagonal_of)
    }

    /// The positions and the corners of the faces, to write or change them; O(faces).
    pub fn to_soup(&self) -> TriangleSoup {
        let corners = |face| self.face_vertices(face).map(VertexId::raw);
        let triangles = self.faces().map(corners).collect();
        TriangleSoup {
            copies: self.data.stand_ins.copies.clone(),
            ..TriangleSoup::new(self.positions().to_vec(), triangles)
        }
    }

    /// The vertex at which `h` starts.
    #[inline]
    pub fn tail(&self, h: HalfEdgeId) -> VertexId {
        self.data.tails[h.index()]
    }

    /// The vertex at which `h` ends.
    #[inline]
    pub fn head(&self, h: HalfEdgeId) -> VertexId {
        self.data.tails[h.next().index()]
    }

    /// The vertex of the face of `h` that is not on `h`.
    #[inline]
    pub fn apex_vertex(&self, h: HalfEdgeId) -> VertexId {
        self.data.tails[h.prev().index()]
    }

    /// The three vertices of `face`, counter-clockwise.
    #[inline]
    pub fn face_vertices(&self, face: FaceId) -> [VertexId; 3] {
        let i = face.half_edge(0).index();
        [
            self.data.tails[i],
            self.data.tails[i + 1],
            self.data.tails[i + 2],
        ]
    }

    /// The half-edge of the neighbouring face along the same edge, or `None` at the boundary and at
    /// a [junction](Self::junction).
    #[inline]
    pub fn twin(&self, h: HalfEdgeId) -> Option<HalfEdgeId> {
        let twin = self.data.twins[h.index()];
        (twin != NO_TWIN).then(|| HalfEdgeId::new(twin))
    }

    /// Length of `h`, bitwise equal to that of its twin, from
    /// [`SHORTEST_EDGE`](crate::SHORTEST_EDGE) to [`LONGEST_EDGE`](crate::LONGEST_EDGE).
    #[inline]
    pub fn length(&self, h: HalfEdgeId) -> f64 {
        self.data.lengths[h.index()]
    }

    /// Length of the longest edge; 0 without edges.
    pub fn longest_edge(&self) -> f64 {
        self.data.extremes.longest_edge
    }

    /// Least height of a face relative to its longest edge, up to rounding; infinite without faces.
    pub fn least_relative_height(&self) -> f64 {
        self.data.extremes.least_height
    }

    /// The lengths of the half-edges of `face`, that of corner 0 first.
    #[inline]
    pub fn side_lengths(&self, face: FaceId) -> [f64; 3] {
        face.half_edges().map(|h| self.length(h))
    }

    /// Position of the apex vertex in the frame of `h`. Its y is positive. In a face without area
    /// it is about 1e-30 of the shorter edges.
    ///
    /// Computed on each call: stored apexes would take a third of the mesh, and solvers keep them
    /// in their own layout. [`apexes`](Self::apexes) computes those of a whole face.
    pub fn apex(&self, h: HalfEdgeId) -> [f64; 2] {
        self.apexes(h.face())[h.corner() as usize]
    }

    /// The [`apex`](Self::apex) in the frame of each half-edge of `face`.
    pub fn apexes(&self, face: FaceId) -> [[f64; 2]; 3] {
        if !self.data.frames.is_empty()
            && let Some(&apexes) = self.data.frames.get(&face)
        {
            return apexes;
        }
        let lengths = self.side_lengths(face);
        if self.data.positions.is_empty() {
            apexes_from_lengths(lengths)
        } else {
            let corners = self
                .face_vertices(face)
                .map(|v| self.data.positions[v.index()]);
            apexes_from_positions(corners, lengths)
        }
    }

    /// The shapes of several faces, computed together in a fraction of the time that single faces
    /// take.
    pub fn shapes<const N: usize>(&self, faces: [FaceId; N]) -> FaceShapes<N> {
        let mut shapes = FaceShapes::<N>::default();
        if self.data.positions.is_empty() || !self.data.frames.is_empty() {
            for (i, &face) in faces.iter().enumerate() {
                let lengths = self.side_lengths(face);
                shapes.set(i, lengths, self.apexes(face));
            }
            return shapes;
        }
        let mut corners = [[[0.0; N]; 3]; 3];
        for (i, &face) in faces.iter().enumerate() {
            for (corner, v) in corners.iter_mut().zip(self.face_vertices(face)) {
                let position = self.data.positions[v.index()];
                for (axis, x) in corner.iter_mut().zip(position) {
                    axis[i] = x;
                }
            }
        }
        measure(&corners)
    }

    /// The half-edges that start at `v`, counter-clockwise within each fan, fan after fan.
    ///
    /// Empty for an isolated vertex. An open fan starts with the half-edge that has no twin, and
    /// ends with the half-edge whose `prev` has no twin.
    #[inline]
    pub fn outgoing(&self, v: VertexId) -> &[HalfEdgeId] {
        &self.data.outgoing[self.data.outgoing_rows.range(v.index())]
    }

    /// The vertices joined to `v` by an edge, with the lengths of those edges; without repeats,
    /// except for [junctions](Self::junction).
    pub fn neighbours(&self, v: VertexId) -> impl Iterator<Item = (VertexId, f64)> {
        self.outgoing(v).iter().flat_map(move |&h| {
            let back = h.prev();
            let last = self
                .twin(back)
                .is_none()
                .then(|| (self.tail(back), self.length(back)));
            std::iter::once((self.head(h), self.length(h))).chain(last)
        })
    }

    /// The angle at the tail of `h` in its face, in radians.
    pub fn corner_angle(&self, h: HalfEdgeId) -> f64 {
        let [x, y] = self.apex(h);
        libm::atan2(y, x)
    }

    /// Sum of the corner angles at `v` in radians, over all fans; 0 for an isolated vertex.
    #[inline]
    pub fn total_angle(&self, v: VertexId) -> f64 {
        self.data.total_angles[v.index()]
    }

    /// Whether `v` lies on a boundary edge.
    #[inline]
    pub fn is_boundary(&self, v: VertexId) -> bool {
        self.data.flags[v.index()].boundary
    }

    /// Whether a shortest path can bend at `v` within one fan: the fan spans more than 2π, or more
    /// than π if it is open. A slack of 1e-8 changes the length of a path by less than 1e-16 of it.
    #[inline]
    pub fn is_saddle(&self, v: VertexId) -> bool {
        self.data.flags[v.index()].saddle
    }

    /// Whether several fans of faces meet at `v` without a common edge, or with a
    /// [junction](Self::junction) as the only one.
    #[inline]
    pub fn is_pinched(&self, v: VertexId) -> bool {
        self.data.flags[v.index()].pinched
    }

    /// Whether `v` is a corner of a sliver: a face whose height is below
    /// [`SLIVER_HEIGHT`](crate::precision::SLIVER_HEIGHT) of its longest edge. Rounding may decide
    /// on which side of such a corner a ray passes.
    #[inline]
    pub fn is_beside_sliver(&self, v: VertexId) -> bool {
        self.data.flags[v.index()].beside_sliver
    }

    /// Whether `v` becomes a pseudo-source when a path reaches it. This is the case at a saddle,
    /// where a shortest path may bend, at a pinched vertex, where it may pass from one fan into
    /// another, and beside slivers, where rounding can lose all rays of an angle between two
    /// triangles.
    #[inline]
    pub fn is_pseudo_source(&self, v: VertexId) -> bool {
        let flags = self.data.flags[v.index()];
        flags.saddle || flags.pinched || flags.beside_sliver
    }
}
