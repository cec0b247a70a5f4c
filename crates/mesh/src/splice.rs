//! Changes of a few faces of a mesh, made in place.

use std::sync::Arc;

use crate::ids::{FaceId, HalfEdgeId, VertexId};
use crate::junctions::Junctions;
use crate::mesh::{Extremes, Mesh, MeshData, NO_TWIN, VertexFlags};
use crate::point::SurfacePoint;

/// A change of a few faces of a mesh, to be made in place: the new content of these faces and of
/// their vertices, and the new numbers of faces and vertices.
///
/// An [`Insertion`](crate::Insertion) makes one that splits faces, and [`Mesh::splice`] returns the
/// one that undoes it. Code that has derived data from the faces of a mesh updates those of
/// [`faces`](Self::faces) and [`vertices`](Self::vertices) only.
#[derive(Clone, Debug, PartialEq)]
pub struct Splice {
    pub(crate) vertex_count: usize,
    pub(crate) face_count: usize,
    /// Whether it undoes another one.
    pub(crate) undoes: bool,
    pub(crate) faces: Vec<(FaceId, FaceData)>,
    pub(crate) vertices: Vec<(VertexId, VertexData)>,
    pub(crate) extremes: Extremes,
    /// `None` if they stay the same.
    pub(crate) junctions: Option<Junctions>,
    /// See [`points`](Self::points).
    pub(crate) points: Vec<SurfacePoint>,
}

/// The content of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FaceData {
    pub(crate) tails: [VertexId; 3],
    pub(crate) twins: [u32; 3],
    pub(crate) lengths: [f64; 3],
    /// The apexes of a part of a split face.
    pub(crate) apexes: Option<[[f64; 2]; 3]>,
}

impl FaceData {
    pub(crate) fn of(mesh: &Mesh, face: FaceId) -> Self {
        let data = &mesh.data;
        let h = face.half_edge(0).index();
        Self {
            tails: [0, 1, 2].map(|k| data.tails[h + k]),
            twins: [0, 1, 2].map(|k| data.twins[h + k]),
            lengths: [0, 1, 2].map(|k| data.lengths[h + k]),
            apexes: data.frames.get(&face).copied(),
        }
    }
}

/// The content of a vertex.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct VertexData {
    /// `None` on a mesh without positions.
    pub(crate) position: Option<[f64; 3]>,
    pub(crate) flags: VertexFlags,
    pub(crate) total_angle: f64,
    pub(crate) outgoing: Vec<HalfEdgeId>,
}

impl VertexData {
    pub(crate) fn of(mesh: &Mesh, v: VertexId) -> Self {
        Self {
            position: mesh.data.positions.get(v.index()).copied(),
            flags: mesh.data.flags[v.index()],
            total_angle: mesh.data.total_angles[v.index()],
            outgoing: mesh.outgoing(v).to_vec(),
        }
    }
}

impl Splice {
    /// Number of vertices afterwards.
    pub const fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// Number of faces afterwards.
    pub const fn face_count(&self) -> usize {
        self.face_count
    }

    /// Whether it undoes the last change of the mesh. Then
    /// [`RowTable::put_back`](crate::RowTable::put_back) restores the rows of the vertices.
    pub const fn undoes(&self) -> bool {
        self.undoes
    }

    /// The points at which vertices are added, in the order of their numbers, on the mesh without
    /// them. If this [undoes](Self::undoes) another change, the points whose vertices are removed.
    pub fn points(&self) -> &[SurfacePoint] {
        &self.points
    }

    /// The faces that change or are added, ascending. Neighbours of a split face are among them.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = FaceId> + Clone {
        self.faces.iter().map(|entry| entry.0)
    }

    /// The vertices that change or are added, ascending: the corners of split faces and of their
    /// parts.
    pub fn vertices(&self) -> impl ExactSizeIterator<Item = VertexId> + Clone {
        self.vertices.iter().map(|entry| entry.0)
    }
}

impl Mesh {
    /// Makes the change `splice`, which must have been made for this mesh. Returns the one that
    /// undoes it, bit for bit.
    ///
    /// Takes time in the size of the change. The data of a mesh of which there are clones are
    /// copied first.
    ///
    /// ```
    /// use geobench_mesh::Mesh;
    ///
    /// let mesh = Mesh::generate("sphere,subdiv=2")?;
    /// let insertion = mesh.insertion(&[mesh.point_in_face(7.into(), [0.2, 0.3, 0.5])?])?;
    /// let mut changed = mesh.clone();
    /// let undo = changed.splice(insertion.splice());
    /// assert_eq!(changed.face_count(), mesh.face_count() + 2);
    /// changed.splice(&undo);
    /// assert_eq!(changed.face_count(), mesh.face_count());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn splice(&mut self, splice: &Splice) -> Splice {
        let (vertices, faces) = (self.vertex_count(), self.face_count());
        let old_faces = splice.faces().filter(|f| f.index() < faces);
        let old_vertices = splice.vertices().filter(|v| v.index() < vertices);
        let undo = Splice {
            vertex_count: vertices,
            face_count: faces,
            undoes: !splice.undoes,
            faces: old_faces.map(|f| (f, FaceData::of(self, f))).collect(),
            vertices: old_vertices.map(|v| (v, VertexData::of(self, v))).collect(),
            extremes: self.data.extremes,
            junctions: (splice.junctions.as_ref()).map(|_| self.data.junctions.clone()),
            points: splice.points.clone(),
        };
        Arc::make_mut(&mut self.data).write(splice);
        undo
    }
}

impl MeshData {
    fn write(&mut self, splice: &Splice) {
        let half_edges = 3 * splice.face_count;
        self.tails.resize(half_edges, VertexId::default());
        self.twins.resize(half_edges, NO_TWIN);
        self.lengths.resize(half_edges, 0.0);
        self.frames
            .split_off(&FaceId::new(splice.face_count as u32));
        for (face, data) in &splice.faces {
            let own = face.half_edge(0).index()..face.half_edge(0).index() + 3;
            self.tails[own.clone()].copy_from_slice(&data.tails);
            self.twins[own.clone()].copy_from_slice(&data.twins);
            self.lengths[own].copy_from_slice(&data.lengths);
            match data.apexes {
                Some(apexes) => self.frames.insert(*face, apexes),
                None => self.frames.remove(face),
            };
        }
        let vertices = splice.vertex_count;
        if !self.positions.is_empty() {
            self.positions.resize(vertices, [0.0; 3]);
        }
        self.flags.resize(vertices, VertexFlags::default());
        self.total_angles.resize(vertices, 0.0);
        for (v, data) in &splice.vertices {
            let i = v.index();
            if let Some(position) = data.position {
                self.positions[i] = position;
            }
            self.flags[i] = data.flags;
            self.total_angles[i] = data.total_angle;
        }
        let old = splice.undoes.then(|| self.outgoing_rows.put_back(vertices));
        if let Some(old) = old.flatten() {
            self.outgoing.truncate(old);
        } else {
            let rows = splice.vertices.iter();
            let lengths = rows.map(|(v, data)| (v.index(), data.outgoing.len()));
            self.outgoing_rows
                .replace(vertices, self.outgoing.len(), lengths);
            for (_, data) in &splice.vertices {
                self.outgoing.extend_from_slice(&data.outgoing);
            }
        }
        self.extremes = splice.extremes;
        if let Some(junctions) = &splice.junctions {
            self.junctions = junctions.clone();
        }
    }
}
