//! A path and its points.

use geobench_mesh::{FaceId, HalfEdgeId, Mesh, Place, SurfacePoint, VertexId};

/// Where a point of a path lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PathPlace {
    /// On a vertex.
    Vertex(VertexId),
    /// On an edge.
    Edge {
        /// The vertices of the edge.
        ends: [VertexId; 2],
        /// Position between them: 0 at the first vertex, 1 at the second.
        t: f64,
    },
    /// Inside a face.
    Face,
}

/// A point of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// The vertex, edge or face on which it lies.
    pub place: PathPlace,
    /// A face that contains the point; `None` for an isolated vertex.
    pub face: Option<FaceId>,
    /// Barycentric coordinates in that face, in the order of its corners; all 0 without a face.
    pub barycentric: [f64; 3],
}

impl Point {
    /// The point at vertex `v` of `mesh`.
    ///
    /// Its face is one of those around `v`; it has none if `v` is isolated.
    ///
    /// # Panics
    ///
    /// If `mesh` has no such vertex.
    pub fn at_vertex(mesh: &Mesh, v: VertexId) -> Self {
        let mut barycentric = [0.0; 3];
        let corner = mesh.outgoing(v).first();
        if let Some(h) = corner {
            barycentric[h.corner() as usize] = 1.0;
        }
        Self {
            place: PathPlace::Vertex(v),
            face: corner.map(|h| h.face()),
            barycentric,
        }
    }

    /// A point of the surface of `mesh`.
    pub(crate) fn of(mesh: &Mesh, point: &SurfacePoint) -> Self {
        match point.place() {
            Place::Vertex(v) => Self::at_vertex(mesh, mesh.kept_vertex(v)),
            Place::Edge(h, [_, t]) => Self::on_edge(h, [mesh.tail(h), mesh.head(h)], t),
            Place::Face(face, barycentric) => Self {
                place: PathPlace::Face,
                face: Some(face),
                barycentric,
            },
        }
    }

    /// The point at fraction `t` of `h`, from `ends[0]` to `ends[1]`.
    #[inline]
    pub(crate) fn on_edge(h: HalfEdgeId, ends: [VertexId; 2], t: f64) -> Self {
        let barycentric = match h.corner() {
            0 => [1.0 - t, t, 0.0],
            1 => [0.0, 1.0 - t, t],
            _ => [t, 0.0, 1.0 - t],
        };
        Self {
            place: PathPlace::Edge { ends, t },
            face: Some(h.face()),
            barycentric,
        }
    }

    /// The vertex at which the point lies; `None` on an edge or inside a face.
    pub fn vertex(&self) -> Option<VertexId> {
        match self.place {
            PathPlace::Vertex(v) => Some(v),
            _ => None,
        }
    }

    /// Position in space, in the units of the mesh; `None` if `mesh`, the mesh of the point, has no
    /// positions.
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
            PathPlace::Vertex(v) => at(v),
            PathPlace::Edge { ends: [a, b], t } => combine(&[(a, 1.0 - t), (b, t)]),
            PathPlace::Face => {
                let corners = mesh.face_vertices(self.face?);
                let weighted: [_; 3] = std::array::from_fn(|k| (corners[k], self.barycentric[k]));
                combine(&weighted)
            }
        }
    }
}

/// A path over the surface: a shortest path, several that follow each other, or a
/// [`line`](crate::line).
///
/// ```
/// use geobench_mesh::Mesh;
/// use geobench_paths::{Path, Paths};
/// use geobench_vtp::VtpFast;
/// use geobench_window::Goal;
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let mut solver = VtpFast::new(&mesh);
/// // From one corner of the square to the next, and on to the opposite one.
/// let one = Paths::find(&mut solver, &mesh, 0, &Goal::targets([4]))?.to(4.into())?;
/// let other = Paths::find(&mut solver, &mesh, 4, &Goal::targets([24]))?.to(24.into())?;
/// let path = Path::joined(one.into_iter().chain(other));
/// assert!((path.length - 8.0).abs() < 1e-12);
/// assert_eq!(path.polyline(&mesh)[0], mesh.positions()[0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// Length, in the units of the mesh.
    pub length: f64,
    /// The points in order, from the source to the target: one for each edge crossed and each
    /// vertex passed. Between two consecutive points, the path runs straight across a face or along
    /// an edge.
    pub points: Vec<Point>,
}

impl Path {
    /// The vertices on the path, in order: its ends, and the vertices at which straight pieces
    /// meet. An end inside a face or on an edge is left out.
    pub fn vertices(&self) -> impl Iterator<Item = VertexId> {
        self.points.iter().filter_map(Point::vertex)
    }

    /// The edges that the path crosses, in order, each with its vertices and the position of the
    /// point between them, as in [`PathPlace::Edge`].
    pub fn edges(&self) -> impl Iterator<Item = ([VertexId; 2], f64)> {
        self.points.iter().filter_map(|point| match point.place {
            PathPlace::Edge { ends, t } => Some((ends, t)),
            _ => None,
        })
    }

    /// The direction in which the path starts, a vector of length 1 in space; `None` if all points
    /// are at one place, or `mesh` has no positions. From there [`line`](crate::line) follows a
    /// path that passes no vertex.
    pub fn start_direction(&self, mesh: &Mesh) -> Option<[f64; 3]> {
        let mut points = self.points.iter();
        let start = points.next()?.position(mesh)?;
        points.find_map(|point| {
            let end = point.position(mesh)?;
            let way = [0, 1, 2].map(|k| end[k] - start[k]);
            let length = way.iter().fold(0.0, |sum: f64, x| libm::hypot(sum, *x));
            (length > 0.0).then(|| way.map(|x| x / length))
        })
    }

    /// Paths that follow each other, each from the end of the one before, as one path. Of no paths
    /// the result has no points and the length 0. That each begins where the one before ends is not
    /// checked. O(points).
    pub fn joined(paths: impl IntoIterator<Item = Self>) -> Self {
        let mut paths = paths.into_iter();
        let mut all = paths.next().unwrap_or(Self {
            length: 0.0,
            points: Vec::new(),
        });
        for path in paths {
            all.length += path.length;
            all.points.extend(path.points.into_iter().skip(1));
        }
        all
    }

    /// The positions of the points, in order; empty if `mesh`, the mesh of the path, has no
    /// positions. O(points).
    pub fn polyline(&self, mesh: &Mesh) -> Vec<[f64; 3]> {
        let points = self.points.iter();
        points.filter_map(|point| point.position(mesh)).collect()
    }
}
