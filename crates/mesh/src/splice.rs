//! Changes of a few faces of a mesh, made in place.

use std::sync::Arc;

use crate::ids::{FaceId, HalfEdgeId, VertexId};
use crate::junctions::Junctions;
use crate::mesh::{Extremes, Mesh, MeshData, NO_TWIN, VertexFlags};

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
    pub(crate) faces: Vec<(FaceId, FaceData)>,
    pub(crate) vertices: Vec<(VertexId, VertexData)>,
    pub(crate) extremes: Extremes,
    /// `None` if they stay the same.
    pub(crate) junctions: Option<Junctions>,
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
    /// O(vertices + faces) at the rate of copying memory, and O(1) for each face of the change. The
    /// data of a mesh of which there are clones are copied first.
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
            faces: old_faces.map(|f| (f, FaceData::of(self, f))).collect(),
            vertices: old_vertices.map(|v| (v, VertexData::of(self, v))).collect(),
            extremes: self.data.extremes,
            junctions: (splice.junctions.as_ref()).map(|_| self.data.junctions.clone()),
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
        let mut rows = Vec::with_capacity(splice.vertices.len());
        for (v, data) in &splice.vertices {
            let i = v.index();
            if let Some(position) = data.position {
                self.positions[i] = position;
            }
            self.flags[i] = data.flags;
            self.total_angles[i] = data.total_angle;
            rows.push((i, data.outgoing.as_slice()));
        }
        self.outgoing = with_rows(&self.outgoing_starts, &self.outgoing, vertices, &rows);
        move_starts(
            &mut self.outgoing_starts,
            vertices,
            rows.iter().map(|&(i, row)| (i, row.len())),
        );
        self.extremes = splice.extremes;
        if let Some(junctions) = &splice.junctions {
            self.junctions = junctions.clone();
        }
    }
}

/// The values of `count` rows, where row i of `values` begins at `starts[i]`, with other content
/// for `rows`, ascending. Rows that `values` lacks must be among them.
pub fn with_rows<T: Copy>(
    starts: &[u32],
    values: &[T],
    count: usize,
    rows: &[(usize, &[T])],
) -> Vec<T> {
    let added: usize = rows.iter().map(|(_, row)| row.len()).sum();
    let mut all = Vec::with_capacity(values.len() + added);
    let start = |i: usize| starts.get(i).map_or(values.len(), |&start| start as usize);
    let mut next = 0;
    for &(i, row) in rows {
        all.extend_from_slice(&values[start(next)..start(i)]);
        all.extend_from_slice(row);
        next = i + 1;
    }
    if next < count {
        all.extend_from_slice(&values[start(next)..start(count)]);
    }
    all
}

/// Moves the starts of `count` rows to where they are once each row of `lengths`, ascending, has
/// its new length. Rows that `starts` lacks must be among them.
pub fn move_starts(
    starts: &mut Vec<u32>,
    count: usize,
    lengths: impl Iterator<Item = (usize, usize)>,
) {
    let old = starts.len() - 1;
    // Modulo 2^32: rows may also shrink.
    let mut moved = 0_u32;
    let mut next = 0;
    let end = starts[old.min(count)];
    starts.resize(count + 1, end);
    let mut lengths = lengths.peekable();
    while let Some((i, length)) = lengths.next() {
        // The start of the row has been moved, its end has not.
        let before = if i < old {
            starts[i + 1].wrapping_sub(starts[i].wrapping_sub(moved))
        } else {
            0
        };
        let gap = lengths.peek().map_or(count + 1, |&(after, _)| after + 1);
        if next == 0 {
            next = i + 1;
        }
        moved = moved.wrapping_add(length as u32).wrapping_sub(before);
        for start in &mut starts[next..gap] {
            *start = start.wrapping_add(moved);
        }
        next = gap;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_grow_shrink_and_are_added_and_removed() {
        let (mut starts, values) = (vec![0, 2, 3, 3, 5], vec![1, 2, 3, 4, 5]);
        let rows: [(usize, &[i32]); 3] = [(1, &[6, 7, 8]), (3, &[9]), (4, &[10])];
        let grown = with_rows(&starts, &values, 5, &rows);
        assert_eq!(grown, [1, 2, 6, 7, 8, 9, 10]);
        move_starts(&mut starts, 5, rows.iter().map(|(i, row)| (*i, row.len())));
        assert_eq!(starts, [0, 2, 5, 5, 6, 7]);
        let rows: [(usize, &[i32]); 2] = [(1, &[3]), (3, &[4, 5])];
        assert_eq!(with_rows(&starts, &grown, 4, &rows), values);
        move_starts(&mut starts, 4, rows.iter().map(|(i, row)| (*i, row.len())));
        assert_eq!(starts, [0, 2, 3, 3, 5]);
    }
}
