//! Curves on a surface: polylines whose segments lie in faces.

use std::collections::BTreeMap;

use crate::ids::{FaceId, HalfEdgeId, VertexId};
use crate::mesh::Mesh;
use crate::point::{PointError, SurfacePoint};

/// A polyline on the surface of a mesh: points, each joined to the next by a straight segment in a
/// face or along an edge. A curve of one point is that point.
///
/// ```
/// use geobench_mesh::{Curve, CurveError, FaceId, Mesh};
///
/// let mesh = Mesh::generate("grid,n=2")?;
/// let inside = mesh.point_in_face(FaceId::new(0), [0.25, 0.25, 0.5])?;
/// let corner = mesh.face_vertices(FaceId::new(0))[1];
/// let curve = Curve::new([inside, corner.into()]);
/// assert_eq!(curve.segments(&mesh)?.len(), 1);
///
/// // No face contains two opposite corners of the grid.
/// let across = Curve::new([0, 8]);
/// assert_eq!(across.segments(&mesh), Err(CurveError::Apart { ends: [0, 1] }));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    points: Vec<SurfacePoint>,
    is_closed: bool,
}

/// A straight part of a curve in a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveSegment {
    /// The face.
    pub face: FaceId,
    /// Barycentric coordinates of both ends in the face. One of a point on a side is exactly 0.
    pub ends: [[f64; 3]; 2],
}

/// Why a curve does not lie on a mesh. Points are numbered from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CurveError {
    /// A curve has no point.
    #[error("a curve needs a point")]
    Empty,
    /// A point is not on the mesh.
    #[error("point {index}: {error}")]
    Point {
        /// The number of the point.
        index: usize,
        /// What is wrong with it.
        error: PointError,
    },
    /// No face contains two points that follow each other.
    #[error(
        "no face contains the points {} and {}: add the points at which the curve crosses edges",
        ends[0], ends[1]
    )]
    Apart {
        /// The numbers of the points.
        ends: [usize; 2],
    },
    /// Several faces contain two points that follow each other, and no edge does.
    #[error(
        "{faces} faces contain the points {} and {}: add a point between them, inside one face",
        ends[0], ends[1]
    )]
    Ambiguous {
        /// The numbers of the points.
        ends: [usize; 2],
        /// Number of faces.
        faces: usize,
    },
}

impl Curve {
    /// The curve through `points` in this order.
    pub fn new(points: impl IntoIterator<Item = impl Into<SurfacePoint>>) -> Self {
        Self {
            points: points.into_iter().map(Into::into).collect(),
            is_closed: false,
        }
    }

    /// The curve through `points` in this order and back to the first one.
    pub fn closed(points: impl IntoIterator<Item = impl Into<SurfacePoint>>) -> Self {
        Self {
            is_closed: true,
            ..Self::new(points)
        }
    }

    /// The points, in order.
    pub fn points(&self) -> &[SurfacePoint] {
        &self.points
    }

    /// Whether a segment leads from the last point to the first.
    pub const fn is_closed(&self) -> bool {
        self.is_closed
    }

    /// The segments on `mesh`, in order. A segment along an edge occurs once for each face of the
    /// edge. Points that follow each other at one place have no segment.
    ///
    /// # Errors
    ///
    /// If there is no point, a point is not on the mesh, or two that follow each other lie in no
    /// common face, or in several without a common edge.
    pub fn segments(&self, mesh: &Mesh) -> Result<Vec<CurveSegment>, CurveError> {
        let places: Vec<Vec<(FaceId, [f64; 3])>> = (self.points.iter().enumerate())
            .map(|(index, point)| {
                let faces = mesh.faces_of(point);
                faces.map_err(|error| CurveError::Point { index, error })
            })
            .collect::<Result<_, _>>()?;
        let last = places.len().checked_sub(1).ok_or(CurveError::Empty)?;
        let back = (self.is_closed && last > 0).then_some([last, 0]);
        let pairs = (0..last).map(|i| [i, i + 1]).chain(back);
        let mut segments = Vec::new();
        for ends in pairs {
            if self.points[ends[0]].place() == self.points[ends[1]].place() {
                continue;
            }
            let [from, to] = ends.map(|i| &places[i]);
            let first = segments.len();
            for &(face, start) in from {
                let end = to.iter().find(|(other, _)| *other == face);
                segments.extend(end.map(|&(_, end)| CurveSegment {
                    face,
                    ends: [start, end],
                }));
            }
            let found = &segments[first..];
            match found.len() {
                0 => return Err(CurveError::Apart { ends }),
                faces if faces > 1 && !found.iter().all(|s| s.side().is_some()) => {
                    return Err(CurveError::Ambiguous { ends, faces });
                }
                _ => {}
            }
        }
        Ok(segments)
    }
}

impl CurveSegment {
    /// The side of the face on which both ends are; `None` if the segment is inside the face.
    pub fn side(&self) -> Option<HalfEdgeId> {
        let [from, to] = self.ends;
        let opposite = (0..3).find(|&k| from[k] == 0.0 && to[k] == 0.0)?;
        Some(self.face.half_edge(opposite as u32).next())
    }
}

impl Mesh {
    /// The edges that have one face only, as curves from vertex to vertex. They are closed, unless
    /// an odd number of such edges meets at a [junction](Self::junction).
    ///
    /// ```
    /// use geobench_mesh::Mesh;
    ///
    /// let borders = Mesh::generate("grid,n=3")?.borders();
    /// assert_eq!(borders.len(), 1);
    /// assert!(borders[0].is_closed() && borders[0].points().len() == 12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn borders(&self) -> Vec<Curve> {
        let edges: Vec<HalfEdgeId> = (self.half_edges())
            .filter(|&h| self.is_boundary_edge(h))
            .collect();
        let mut at: BTreeMap<VertexId, Vec<HalfEdgeId>> = BTreeMap::new();
        for &h in &edges {
            for end in [self.tail(h), self.head(h)] {
                at.entry(end).or_default().push(h);
            }
        }
        let mut is_done = vec![false; self.half_edge_count()];
        let walk = |(start, first): (VertexId, HalfEdgeId)| {
            let mut vertices = vec![start];
            let mut last = start;
            let mut next = Some(first).filter(|h| !is_done[h.index()]);
            while let Some(h) = next {
                is_done[h.index()] = true;
                let [tail, head] = [self.tail(h), self.head(h)];
                last = if tail == last { head } else { tail };
                if last == start {
                    return Some(Curve::closed(vertices));
                }
                vertices.push(last);
                next = at[&last].iter().copied().find(|h| !is_done[h.index()]);
            }
            (vertices.len() > 1).then(|| Curve::new(vertices))
        };
        // Open borders first, from one of their ends.
        let odd = at.iter().filter(|(_, around)| around.len() % 2 == 1);
        let odd = odd.flat_map(|(&v, around)| around.iter().map(move |&h| (v, h)));
        let all = edges.iter().map(|&h| (self.tail(h), h));
        odd.chain(all).filter_map(walk).collect()
    }
}
