//! A path and its points.

use geobench_mesh::{FaceId, Mesh, VertexId};

/// Where a point of a path lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// On a vertex.
    Vertex(VertexId),
    /// On an edge.
    Edge {
        /// Its vertices.
        ends: [VertexId; 2],
        /// How far from the first to the second: from 0 to 1.
        t: f64,
    },
    /// Inside a face.
    Face,
}

/// A point of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// What it lies on.
    pub place: Place,
    /// A face that contains it; none if it is an isolated vertex.
    pub face: Option<FaceId>,
    /// Its barycentric coordinates there, in the order of the corners of the face.
    pub barycentric: [f64; 3],
}

impl Point {
    /// Vertex `v` of `mesh`.
    pub fn at_vertex(mesh: &Mesh, v: VertexId) -> Self {
        let mut barycentric = [0.0; 3];
        let corner = mesh.outgoing(v).first();
        if let Some(h) = corner {
            barycentric[h.corner() as usize] = 1.0;
        }
        Self {
            place: Place::Vertex(v),
            face: corner.map(|h| h.face()),
            barycentric,
        }
    }

    /// The vertex that it is, if it is one.
    pub fn vertex(&self) -> Option<VertexId> {
        match self.place {
            Place::Vertex(v) => Some(v),
            _ => None,
        }
    }

    /// Its position in space; `None` for a mesh that has none.
    pub fn position(&self, mesh: &Mesh) -> Option<[f64; 3]> {
        let at = |v: VertexId| mesh.positions().get(v.index()).copied();
        let combine = |corners: &[(VertexId, f64)]| {
            let mut sum = [0.0; 3];
            for &(v, weight) in corners {
                let p = at(v)?;
                (0..3).for_each(|k| sum[k] += weight * p[k]);
            }
            Some(sum)
        };
        match self.place {
            Place::Vertex(v) => at(v),
            Place::Edge { ends: [a, b], t } => combine(&[(a, 1.0 - t), (b, t)]),
            Place::Face => {
                let corners = mesh.face_vertices(self.face?);
                let weighted: [_; 3] = std::array::from_fn(|k| (corners[k], self.barycentric[k]));
                combine(&weighted)
            }
        }
    }
}

/// A shortest path.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// Its length.
    pub length: f64,
    /// Its points in order from the source: one for each edge that it crosses and each vertex that
    /// it passes. Between two of them it runs straight across a face or along an edge.
    pub points: Vec<Point>,
}

impl Path {
    /// The vertices at which it starts, ends, or passes from one straight piece to the next.
    pub fn vertices(&self) -> impl Iterator<Item = VertexId> {
        self.points.iter().filter_map(Point::vertex)
    }

    /// The edges that it crosses, with how far from their first to their second vertex.
    pub fn edges(&self) -> impl Iterator<Item = ([VertexId; 2], f64)> {
        self.points.iter().filter_map(|point| match point.place {
            Place::Edge { ends, t } => Some((ends, t)),
            _ => None,
        })
    }

    /// The positions of its points; empty for a mesh that has none.
    pub fn polyline(&self, mesh: &Mesh) -> Vec<[f64; 3]> {
        let points = self.points.iter();
        points.filter_map(|point| point.position(mesh)).collect()
    }
}
