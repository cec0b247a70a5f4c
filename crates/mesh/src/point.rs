//! Points of the surface: at vertices, on edges, in faces.

use crate::defect::SHORTEST_EDGE;
use crate::ids::{FaceId, HalfEdgeId, VertexId};
use crate::mesh::Mesh;

/// The distance from an edge or a vertex, as a fraction of the longest edge of the face, within
/// which a point is moved to that edge or vertex.
pub(crate) const SNAP: f64 = 1e-12;

/// Tolerance of the sum of three barycentric coordinates, which must be 1: ten roundings in single
/// precision.
const SUM_SLACK: f64 = 1e-6;

/// A point of the surface of a mesh.
///
/// [`Mesh::point_on_edge`] and [`Mesh::point_in_face`] check their arguments and recognise points
/// on edges and vertices. A [`VertexId`] or a vertex number converts into a point.
/// [`Mesh::nearest_point`] returns the point nearest to a position.
///
/// ```
/// use geobench_mesh::{FaceId, Mesh, Place, PointError, VertexId};
///
/// let positions = vec![[0.0; 3], [3.0, 0.0, 0.0], [0.0, 3.0, 0.0]];
/// let mesh = Mesh::new(positions, vec![[0, 1, 2]])?;
/// let middle = mesh.point_in_face(FaceId::new(0), [1.0, 1.0, 1.0].map(|w| w / 3.0))?;
/// assert_eq!(mesh.position_of(&middle), Some([1.0, 1.0, 0.0]));
///
/// let corner = mesh.point_in_face(FaceId::new(0), [0.0, 1.0, 0.0])?;
/// assert_eq!(corner.place(), Place::Vertex(VertexId::new(1)));
/// assert_eq!(corner, VertexId::new(1).into());
///
/// let outside = mesh.point_in_face(FaceId::new(0), [-0.5, 1.0, 0.5]);
/// assert!(matches!(outside, Err(PointError::Coordinate { .. })));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    place: Place,
    moved: f64,
}

/// The location of a [`SurfacePoint`] in the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// At a vertex.
    Vertex(VertexId),
    /// Inside an edge: a half-edge, whose number is lower than that of its twin, and the weights of
    /// its tail and head. Both weights are positive, and their sum is 1.
    Edge(HalfEdgeId, [f64; 2]),
    /// Inside a face: its barycentric coordinates. They are positive, and their sum is 1.
    Face(FaceId, [f64; 3]),
}

impl SurfacePoint {
    /// The location in the mesh.
    pub const fn place(&self) -> Place {
        self.place
    }

    /// The distance by which the point was moved to an edge or vertex, at most 1e-12 of the longest
    /// edge of its face; 0 if it was not moved.
    pub const fn moved(&self) -> f64 {
        self.moved
    }

    /// The vertex at which the point is; `None` elsewhere.
    pub const fn vertex(&self) -> Option<VertexId> {
        match self.place {
            Place::Vertex(vertex) => Some(vertex),
            Place::Edge(..) | Place::Face(..) => None,
        }
    }
}

impl From<VertexId> for SurfacePoint {
    fn from(vertex: VertexId) -> Self {
        Self {
            place: Place::Vertex(vertex),
            moved: 0.0,
        }
    }
}

impl From<u32> for SurfacePoint {
    fn from(vertex: u32) -> Self {
        VertexId::new(vertex).into()
    }
}

/// Why a point does not exist.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PointError {
    /// No vertex has this number.
    #[error("vertex {vertex} does not exist: the mesh has {vertices} vertices, numbered from 0")]
    NoSuchVertex {
        /// The vertex asked for.
        vertex: VertexId,
        /// Number of vertices of the mesh.
        vertices: usize,
    },
    /// No face has this number.
    #[error("face {face} does not exist: the mesh has {faces} faces, numbered from 0")]
    NoSuchFace {
        /// The face asked for.
        face: FaceId,
        /// Number of faces of the mesh.
        faces: usize,
    },
    /// No edge joins these vertices.
    #[error("no edge joins the vertices {} and {}", ends[0], ends[1])]
    NoSuchEdge {
        /// The ends asked for.
        ends: [VertexId; 2],
    },
    /// The fraction of an edge is not from 0 to 1.
    #[error("{value} is not a place on an edge: give a number from 0 to 1")]
    Parameter {
        /// The value.
        value: f64,
    },
    /// A barycentric coordinate is negative or not finite.
    #[error("the barycentric coordinate {value} is not a number from 0 to 1")]
    Coordinate {
        /// The value.
        value: f64,
    },
    /// The sum of the barycentric coordinates is not 1.
    #[error("the barycentric coordinates have the sum {sum}, not 1")]
    Sum {
        /// Their sum.
        sum: f64,
    },
    /// A coordinate of a position is infinite or not a number.
    #[error("{value} is not a coordinate of a position")]
    Position {
        /// The value.
        value: f64,
    },
    /// The mesh was built from lengths, so its points have no positions.
    #[error("the mesh is known by its edge lengths alone, so no position is near it")]
    NoPositions,
    /// So many points would exceed the 32-bit numbers of vertices and faces.
    #[error("{points} points are more than the mesh can have vertices for")]
    TooMany {
        /// Number of points.
        points: usize,
    },
}

/// `weights` scaled to the sum 1. The largest one takes the rounding error.
fn normalised<const N: usize>(weights: [f64; N]) -> [f64; N] {
    let sum: f64 = weights.iter().sum();
    if sum == 1.0 {
        return weights;
    }
    let mut weights = weights.map(|w| w / sum);
    let largest = largest(weights);
    weights[largest] = 0.0;
    weights[largest] = 1.0 - weights.iter().sum::<f64>();
    weights
}

/// The index of the largest of `weights`.
pub(crate) fn largest<const N: usize>(weights: [f64; N]) -> usize {
    (0..N).fold(
        0,
        |best, k| if weights[k] > weights[best] { k } else { best },
    )
}

impl Mesh {
    /// The point at `vertex`.
    ///
    /// # Errors
    ///
    /// If there is no such vertex.
    pub fn point_at_vertex(&self, vertex: VertexId) -> Result<SurfacePoint, PointError> {
        let vertices = self.vertex_count();
        if vertex.index() >= vertices {
            return Err(PointError::NoSuchVertex { vertex, vertices });
        }
        Ok(vertex.into())
    }

    /// The point at the fraction `t` of the way from `ends[0]` to `ends[1]`, which an edge joins.
    ///
    /// # Errors
    ///
    /// If a vertex or the edge does not exist, or `t` is not from 0 to 1.
    pub fn point_on_edge(&self, ends: [VertexId; 2], t: f64) -> Result<SurfacePoint, PointError> {
        for end in ends {
            self.point_at_vertex(end)?;
        }
        if !(0.0..=1.0).contains(&t) {
            return Err(PointError::Parameter { value: t });
        }
        let [from, to] = ends.map(|end| self.kept_vertex(end));
        // An edge of the file whose ends are one place.
        if from == to && ends[0] != ends[1] {
            return self.point_at_vertex(from);
        }
        let leaving = |from: VertexId, to: VertexId| {
            let mut outgoing = self.outgoing(from).iter().copied();
            outgoing.find(|&h| self.head(h) == to)
        };
        let (h, weights) = match (leaving(from, to), leaving(to, from)) {
            (Some(h), _) => (h, [1.0 - t, t]),
            (None, Some(h)) => (h, [t, 1.0 - t]),
            (None, None) => return Err(PointError::NoSuchEdge { ends }),
        };
        let snap = (SNAP * self.length(h)).max(SHORTEST_EDGE);
        Ok(self.snapped_on_edge(h, weights, snap, 0.0))
    }

    /// The point of `face` with these barycentric coordinates, in the order of
    /// [`face_vertices`](Self::face_vertices).
    ///
    /// # Errors
    ///
    /// If there is no such face, a coordinate is negative or not finite, or their sum is not 1
    /// within 1e-6. The coordinates are then scaled to the sum 1.
    pub fn point_in_face(
        &self,
        face: FaceId,
        barycentric: [f64; 3],
    ) -> Result<SurfacePoint, PointError> {
        let faces = self.face_count();
        if face.index() >= faces {
            return Err(PointError::NoSuchFace { face, faces });
        }
        let is_weight = |w: &f64| (-SNAP..=2.0).contains(w);
        if let Some(&value) = barycentric.iter().find(|w| !is_weight(w)) {
            return Err(PointError::Coordinate { value });
        }
        let sum: f64 = barycentric.iter().sum();
        if (sum - 1.0).abs() > SUM_SLACK {
            return Err(PointError::Sum { sum });
        }
        let weights = normalised(barycentric.map(|w| w.max(0.0)));
        let lengths = self.side_lengths(face);
        let snap = (SNAP * lengths[largest(lengths)]).max(SHORTEST_EDGE);
        let twice_area = lengths[0] * self.apexes(face)[0][1];
        // Corner k is opposite to half-edge k + 1.
        let height = |k: usize| weights[k] * twice_area / lengths[(k + 1) % 3];
        let nearest = (0..3).min_by(|&i, &j| height(i).total_cmp(&height(j)));
        let k = nearest.unwrap_or_default();
        if height(k) > snap {
            return Ok(SurfacePoint {
                place: Place::Face(face, weights),
                moved: 0.0,
            });
        }
        let h = face.half_edge(k as u32).next();
        // Moves to the foot of the perpendicular: in a thin face the weight of the far corner may
        // be large.
        let (l, [x, _]) = (self.length(h), self.apex(h));
        let tail = weights[(k + 1) % 3] + weights[k] * ((l - x) / l);
        let head = weights[(k + 2) % 3] + weights[k] * (x / l);
        let on_edge = normalised([tail.max(0.0), head.max(0.0)]);
        Ok(self.snapped_on_edge(h, on_edge, snap, height(k)))
    }

    /// The point on `h` with these weights, or the end of `h` within `snap`. It was moved there by
    /// `moved` from inside its face.
    fn snapped_on_edge(
        &self,
        h: HalfEdgeId,
        weights: [f64; 2],
        snap: f64,
        moved: f64,
    ) -> SurfacePoint {
        let length = self.length(h);
        let nearer = usize::from(weights[1] >= weights[0]);
        let along = weights[1 - nearer] * length;
        if along <= snap {
            let vertex = [self.tail(h), self.head(h)][nearer];
            return SurfacePoint {
                place: Place::Vertex(vertex),
                moved: libm::hypot(moved, along),
            };
        }
        let edge = self.edge_of(h);
        let place = if self.tail(edge) == self.tail(h) {
            Place::Edge(edge, weights)
        } else {
            Place::Edge(edge, [weights[1], weights[0]])
        };
        SurfacePoint { place, moved }
    }

    /// A face that contains `point`, and its barycentric coordinates there; `None` at an isolated
    /// vertex and for a point of another mesh.
    pub fn face_of(&self, point: &SurfacePoint) -> Option<(FaceId, [f64; 3])> {
        let at = |h: HalfEdgeId, weights: [f64; 2]| {
            let mut all = [0.0; 3];
            all[h.corner() as usize] = weights[0];
            all[h.next().corner() as usize] = weights[1];
            (h.face(), all)
        };
        match point.place {
            Place::Vertex(v) if v.index() >= self.vertex_count() => None,
            Place::Vertex(v) => {
                let corner = *self.outgoing(self.kept_vertex(v)).first()?;
                Some(at(corner, [1.0, 0.0]))
            }
            Place::Edge(h, weights) => (h.index() < self.half_edge_count()).then(|| at(h, weights)),
            Place::Face(face, weights) => {
                (face.index() < self.face_count()).then_some((face, weights))
            }
        }
    }

    /// All faces that contain `point`, each once, with its barycentric coordinates there. None at
    /// an isolated vertex.
    ///
    /// # Errors
    ///
    /// If the point is not one of this mesh.
    pub fn faces_of(&self, point: &SurfacePoint) -> Result<Vec<(FaceId, [f64; 3])>, PointError> {
        let at = |h: HalfEdgeId, [tail, head]: [f64; 2]| {
            let mut all = [0.0; 3];
            all[h.corner() as usize] = tail;
            all[h.next().corner() as usize] = head;
            (h.face(), all)
        };
        Ok(match point.place {
            Place::Vertex(v) => {
                self.point_at_vertex(v)?;
                let corners = self.outgoing(self.kept_vertex(v)).iter();
                corners.map(|&h| at(h, [1.0, 0.0])).collect()
            }
            Place::Edge(h, weights) => {
                self.check_face(h.face())?;
                let sides = self.along_edge(h);
                let sides = sides.map(|side| {
                    let [tail, head] = weights;
                    let is_turned = self.tail(side) != self.tail(h);
                    at(side, if is_turned { [head, tail] } else { weights })
                });
                sides.collect()
            }
            Place::Face(face, weights) => {
                self.check_face(face)?;
                vec![(face, weights)]
            }
        })
    }

    /// The position of `point`; `None` for a mesh built from lengths alone and for a point of
    /// another mesh.
    pub fn position_of(&self, point: &SurfacePoint) -> Option<[f64; 3]> {
        if let Some(vertex) = point.vertex() {
            return self
                .positions()
                .get(self.kept_vertex(vertex).index())
                .copied();
        }
        let (face, weights) = self.face_of(point)?;
        let corners = self.face_vertices(face).map(VertexId::index);
        let positions = self.positions();
        if positions.is_empty() {
            return None;
        }
        let base = largest(weights);
        let origin = positions[corners[base]];
        let toward = |k: usize, i: usize| weights[k] * (positions[corners[k]][i] - origin[i]);
        let (next, last) = ((base + 1) % 3, (base + 2) % 3);
        Some([0, 1, 2].map(|i| origin[i] + (toward(next, i) + toward(last, i))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles, 0 1 2 and 1 3 2, of a square of side 4.
    fn square() -> Mesh {
        let positions = vec![[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [4.0, 4.0, 0.0]];
        Mesh::new(positions, vec![[0, 1, 2], [1, 3, 2]]).unwrap()
    }

    fn in_face(face: u32, barycentric: [f64; 3]) -> Result<SurfacePoint, PointError> {
        square().point_in_face(FaceId::new(face), barycentric)
    }

    fn on_edge(a: u32, b: u32, t: f64) -> Result<SurfacePoint, PointError> {
        square().point_on_edge([a, b].map(VertexId::new), t)
    }

    #[test]
    fn a_point_beside_a_long_side_of_a_thin_face_moves_across_it_only() {
        let thin = vec![[0.0; 3], [1e-14, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let mesh = Mesh::new(thin, vec![[0, 1, 2]]).unwrap();
        let face = FaceId::new(0);
        let point = mesh.point_in_face(face, [0.25, 0.5, 0.25]).unwrap();
        assert!(matches!(point.place(), Place::Edge(..)));
        let [_, y, _] = mesh.position_of(&point).unwrap();
        assert!((y - 1.0).abs() < 1e-15, "{y}");
        assert!(point.moved() < 1e-14);
        // Beyond the end of the side the point moves to that end.
        let skew = vec![[0.0; 3], [4.0, 0.0, 0.0], [5.0, 1e-14, 0.0]];
        let mesh = Mesh::new(skew, vec![[0, 1, 2]]).unwrap();
        let point = mesh.point_in_face(face, [0.125, 0.5, 0.375]).unwrap();
        let [x, ..] = mesh.position_of(&point).unwrap();
        assert!((x - 3.875).abs() < 1e-15, "{x}");
    }

    #[test]
    fn points_on_edges_and_vertices_are_recognised_from_every_side() {
        let middle = on_edge(1, 2, 0.25).unwrap();
        assert_eq!(middle, on_edge(2, 1, 0.75).unwrap());
        assert_eq!(middle, in_face(0, [0.0, 0.75, 0.25]).unwrap());
        assert_eq!(middle, in_face(1, [0.75, 0.0, 0.25]).unwrap());
        assert!(matches!(middle.place(), Place::Edge(..)) && middle.moved() == 0.0);
        assert_eq!(square().position_of(&middle), Some([3.0, 1.0, 0.0]));
        for (a, b, t) in [(1, 2, 0.0), (2, 1, 1.0), (1, 3, 0.0), (0, 1, 1.0)] {
            assert_eq!(on_edge(a, b, t).unwrap().vertex(), Some(VertexId::new(1)));
        }
        assert_eq!(in_face(1, [0.0, 0.0, 1.0]).unwrap(), 2.into());
    }

    #[test]
    fn points_next_to_edges_and_vertices_are_moved_there() {
        let near = in_face(0, [1e-13, 0.5, 0.5 - 1e-13]).unwrap();
        assert!(matches!(near.place(), Place::Edge(..)));
        assert!(near.moved() > 0.0 && near.moved() <= 1e-12 * 32.0_f64.sqrt());
        let near = in_face(0, [1e-13, 1e-13, 1.0 - 2e-13]).unwrap();
        assert_eq!(near.vertex(), Some(VertexId::new(2)));
        assert!(near.moved() > 0.0);
        assert!(on_edge(0, 1, 1.0 - 1e-13).unwrap().moved() > 0.0);
        // Points slightly further away stay.
        assert!(matches!(
            in_face(0, [1e-11, 0.5, 0.5 - 1e-11]).unwrap().place(),
            Place::Face(..)
        ));
        assert_eq!(on_edge(0, 1, 1e-11).unwrap().vertex(), None);
        // A sum with a rounding error becomes 1 exactly.
        let Place::Face(_, sum) = in_face(0, [0.1, 0.2, 0.7 + 1e-10]).unwrap().place() else {
            panic!("not inside");
        };
        assert!((sum.iter().sum::<f64>() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn errors_name_the_vertex_edge_or_weight() {
        let says = |result: Result<SurfacePoint, PointError>| result.unwrap_err().to_string();
        assert_eq!(
            says(on_edge(0, 9, 0.5)),
            "vertex 9 does not exist: the mesh has 4 vertices, numbered from 0"
        );
        assert_eq!(
            says(on_edge(0, 3, 0.5)),
            "no edge joins the vertices 0 and 3"
        );
        assert_eq!(
            says(on_edge(2, 2, 0.5)),
            "no edge joins the vertices 2 and 2"
        );
        assert_eq!(
            says(in_face(2, [1.0, 0.0, 0.0])),
            "face 2 does not exist: the mesh has 2 faces, numbered from 0"
        );
        assert_eq!(
            says(in_face(0, [0.5, 0.6, 0.0])),
            "the barycentric coordinates have the sum 1.1, not 1"
        );
        for bad in [-0.1, f64::NAN, f64::INFINITY, -f64::INFINITY] {
            assert!(matches!(
                on_edge(0, 1, bad),
                Err(PointError::Parameter { .. })
            ));
            assert!(matches!(
                in_face(0, [bad, 0.5, 0.5]),
                Err(PointError::Coordinate { .. })
            ));
        }
        let lengths = [[1.0; 3]];
        let (mesh, _) = Mesh::from_lengths(3, &[[0, 1, 2]], &lengths).unwrap();
        let point = mesh.point_in_face(FaceId::new(0), [0.2, 0.3, 0.5]).unwrap();
        assert_eq!(mesh.position_of(&point), None);
    }
}
