//! The numbers and corners of the file in a mesh that leaves out copies of vertices and triangles,
//! and turns triangles over.

use std::ops::Range;

use crate::ids::{FaceId, VertexId};
use crate::mesh::Mesh;
use crate::point::{PointError, SurfacePoint};

/// Vertices and triangles of the file for which others stand.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct StandIns {
    /// Copies of vertices, which are in no face, each with the vertex that stands for it;
    /// ascending.
    pub(crate) copies: Vec<[u32; 2]>,
    /// Triangles that the mesh lacks, in ascending order of their numbers.
    pub(crate) left_out: Vec<LeftOutTriangle>,
    /// The faces that are turned over: their last two corners are in the other order in the file.
    /// Ascending.
    pub(crate) turned: Vec<u32>,
}

/// A triangle of the file that the mesh lacks.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LeftOutTriangle {
    pub(crate) number: u32,
    /// Its corners after welding. Two are equal, or another triangle has the same three.
    pub(crate) corners: [u32; 3],
}

impl Mesh {
    /// The vertex that stands for `v`: the one with which it was [welded](crate::Weld), or itself.
    pub fn kept_vertex(&self, v: VertexId) -> VertexId {
        let copies = &self.data.stand_ins.copies;
        let found = copies.binary_search_by_key(&v.raw(), |copy| copy[0]);
        found.map_or(v, |place| VertexId::new(copies[place][1]))
    }

    /// Whether [`kept_vertex`](Self::kept_vertex) differs from `v`.
    pub fn is_copy(&self, v: VertexId) -> bool {
        self.kept_vertex(v) != v
    }

    /// The vertices for which another stands, each with that one, in ascending order.
    pub fn copies(&self) -> impl ExactSizeIterator<Item = [VertexId; 2]> {
        let copies = self.data.stand_ins.copies.iter();
        copies.map(|copy| copy.map(VertexId::new))
    }

    /// Gives each copy of a vertex the value of the vertex that stands for it.
    ///
    /// # Panics
    ///
    /// If there are fewer values than vertices.
    pub fn fill_copies<T: Clone>(&self, values: &mut [T]) {
        for [copy, kept] in self.copies() {
            values[copy.index()] = values[kept.index()].clone();
        }
    }

    /// The corners of all triangles of the file, with those that are left out. A mesh that is built
    /// of them and the [copies](Self::copies) leaves out the same ones.
    pub fn file_triangles(&self) -> Vec<[u32; 3]> {
        let left_out = &self.data.stand_ins.left_out;
        let mut all = Vec::with_capacity(self.face_count() + left_out.len());
        let mut rest = left_out.iter().peekable();
        let mut faces = self.faces();
        loop {
            if let Some(triangle) = rest.next_if(|t| t.number as usize == all.len()) {
                all.push(triangle.corners);
            } else if let Some(face) = faces.next() {
                all.push(self.turn(face, self.face_vertices(face).map(VertexId::raw)));
            } else {
                break;
            }
        }
        all
    }

    /// The number of `face` among the triangles of the file, some of which may be left out.
    pub fn file_triangle(&self, face: FaceId) -> u32 {
        let left_out = &self.data.stand_ins.left_out;
        let mut range = 0..left_out.len() as u32;
        // The number of those that are left out before the face.
        while let Range { start, end } = range
            && start < end
        {
            let middle = start.midpoint(end);
            range = if left_out[middle as usize].number - middle <= face.raw() {
                middle + 1..end
            } else {
                start..middle
            };
        }
        face.raw() + range.start
    }

    /// Whether the file has the last two corners of `face` in the other order.
    fn is_turned(&self, face: FaceId) -> bool {
        self.data
            .stand_ins
            .turned
            .binary_search(&face.raw())
            .is_ok()
    }

    /// The number of `face` among the triangles of the file, and the values of its corners in their
    /// order there, such as the barycentric coordinates of a point.
    pub fn in_file<T>(&self, face: FaceId, corners: [T; 3]) -> (u32, [T; 3]) {
        (self.file_triangle(face), self.turn(face, corners))
    }

    /// Between the order of the corners of `face` in the mesh and in the file, in both directions.
    fn turn<T>(&self, face: FaceId, mut corners: [T; 3]) -> [T; 3] {
        if self.is_turned(face) {
            corners.swap(1, 2);
        }
        corners
    }

    /// A point of the plane of `face` in the plane of its triangle of the file. In both the first
    /// corner is the origin, the second one on the positive x-axis, and the third one above.
    pub fn in_plane_of_file(&self, face: FaceId, [x, y]: [f64; 2]) -> [f64; 2] {
        if !self.is_turned(face) {
            return [x, y];
        }
        // The file's second corner is the third one here.
        let [right, up] = self.apex(face.half_edge(0));
        let length = right.hypot(up);
        let [right, up] = [right / length, up / length];
        [x * right + y * up, x * up - y * right]
    }

    /// As [`point_in_face`](Self::point_in_face), of a triangle with its number in the file. If the
    /// triangle is left out, the point is in the face or on the edge that stands for it.
    ///
    /// # Errors
    ///
    /// As [`point_in_face`](Self::point_in_face), and if no face and no edge stands for the
    /// triangle.
    pub fn point_in_file_triangle(
        &self,
        triangle: u32,
        barycentric: [f64; 3],
    ) -> Result<SurfacePoint, PointError> {
        let left_out = &self.data.stand_ins.left_out;
        let missing = PointError::NoSuchFace {
            face: FaceId::new(triangle),
            faces: self.face_count() + left_out.len(),
        };
        let place = match left_out.binary_search_by_key(&triangle, |one| one.number) {
            Err(before) => {
                let face = FaceId::new(triangle - before as u32);
                let found = self.point_in_face(face, self.turn(face, barycentric));
                return found.map_err(|error| match error {
                    PointError::NoSuchFace { .. } => missing,
                    other => other,
                });
            }
            Ok(place) => place,
        };
        let corners = left_out[place].corners.map(VertexId::new);
        // In the order of the corners of the face or edge that stands for it.
        let weights_at = |v: VertexId| {
            let own = corners.iter().zip(barycentric);
            own.filter(|(corner, _)| **corner == v)
                .map(|(_, w)| w)
                .sum::<f64>()
        };
        let [a, b, c] = corners;
        if a != b && b != c && c != a {
            let mut faces = self.outgoing(a).iter().map(|h| h.face());
            let stands_in = |face: &FaceId| {
                let vertices = self.face_vertices(*face);
                corners.iter().all(|corner| vertices.contains(corner))
            };
            let Some(face) = faces.find(stands_in) else {
                return Err(missing);
            };
            return self.point_in_face(face, self.face_vertices(face).map(weights_at));
        }
        match corners.into_iter().find(|&v| v != a) {
            Some(other) => self.point_on_edge([a, other], weights_at(other)),
            None => self.point_at_vertex(a),
        }
    }
}
