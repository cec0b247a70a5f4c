//! Points in faces and on edges, for algorithms whose data know the vertices of a mesh only.

use geobench_mesh::{FaceId, Mesh, Place, Splice, SurfacePoint, VertexId};

/// The points at which a [`Splice`] has added vertices. The data of the algorithm stay those of the
/// mesh without them. A point is joined to its surroundings by straight *ways* within its faces: a
/// run from it starts with their other ends, and its own distance follows from theirs when the run
/// ends. No path turns at a point, so that targets change no other distance.
#[derive(Clone, Debug)]
pub(crate) struct Attached {
    /// Number of vertices of the mesh without the points, whose numbers follow.
    vertices: usize,
    points: Vec<AttachedPoint>,
}

/// A point in a face or on an edge.
#[derive(Clone, Debug)]
pub(crate) struct AttachedPoint {
    /// The faces that contain it.
    pub(crate) faces: Vec<PointInFace>,
    /// The ends and lengths of its ways.
    pub(crate) ways: Vec<(VertexId, f64)>,
}

/// A point in a face, or on a side of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PointInFace {
    face: FaceId,
    pub(crate) corners: [VertexId; 3],
    /// Barycentric coordinates.
    #[cfg(feature = "heat")]
    pub(crate) weights: [f64; 3],
    /// Lengths of the sides; side k starts at corner k.
    pub(crate) sides: [f64; 3],
    /// The point in the frame of each side: the start is the origin, the end on the x-axis.
    pub(crate) places: [[f64; 2]; 3],
}

impl PointInFace {
    fn new(mesh: &Mesh, face: FaceId, weights: [f64; 3]) -> Self {
        let sides = mesh.side_lengths(face);
        let apexes = mesh.apexes(face);
        let place = |k: usize| {
            let [end, third] = [weights[(k + 1) % 3], weights[(k + 2) % 3]];
            let [x, y] = apexes[k];
            [end * sides[k] + third * x, third * y]
        };
        Self {
            face,
            corners: mesh.face_vertices(face),
            #[cfg(feature = "heat")]
            weights,
            sides,
            places: [0, 1, 2].map(place),
        }
    }

    /// Distances from the corners.
    pub(crate) fn corner_distances(&self) -> [f64; 3] {
        self.places.map(|[x, y]| x.hypot(y))
    }

    /// The distance of another point, if it is in the same face.
    fn distance_to(&self, other: &Self) -> Option<f64> {
        let ([x, y], [u, v]) = (self.places[0], other.places[0]);
        (self.face == other.face).then(|| (x - u).hypot(y - v))
    }
}

/// The faces that contain `point`, which is not a vertex.
fn faces_of(mesh: &Mesh, point: &SurfacePoint) -> Vec<PointInFace> {
    match point.place() {
        Place::Vertex(_) => Vec::new(),
        Place::Face(face, weights) => vec![PointInFace::new(mesh, face, weights)],
        Place::Edge(h, [tail, head]) => {
            let of_side = |side| {
                let is_turned = mesh.tail(side) != mesh.tail(h);
                let [first, second] = if is_turned {
                    [head, tail]
                } else {
                    [tail, head]
                };
                let corner = side.corner() as usize;
                let mut weights = [0.0; 3];
                weights[corner] = first;
                weights[(corner + 1) % 3] = second;
                PointInFace::new(mesh, side.face(), weights)
            };
            mesh.along_edge(h).map(of_side).collect()
        }
    }
}

impl Attached {
    /// No points on `mesh`.
    pub(crate) fn new(mesh: &Mesh) -> Self {
        Self {
            vertices: mesh.vertex_count(),
            points: Vec::new(),
        }
    }

    /// Makes the change of `mesh`, and attaches its points, or removes them if it undoes another
    /// change. Returns the change that undoes it; `None` if there are points already.
    pub(crate) fn splice(&mut self, mesh: &mut Mesh, splice: &Splice) -> Option<Splice> {
        if splice.undoes() {
            self.points.clear();
        } else if self.points.is_empty() {
            let faces = splice.points().iter().map(|point| faces_of(mesh, point));
            self.points = with_ways(faces.collect(), self.vertices);
        } else {
            return None;
        }
        Some(mesh.splice(splice))
    }

    /// The points with their numbers.
    pub(crate) fn numbered(&self) -> impl Iterator<Item = (VertexId, &AttachedPoint)> {
        let numbers = self.vertices as u32..;
        numbers.map(VertexId::new).zip(&self.points)
    }

    /// As [`numbered`](Self::numbered), to add ways.
    pub(crate) fn numbered_mut(&mut self) -> impl Iterator<Item = (VertexId, &mut AttachedPoint)> {
        let numbers = self.vertices as u32..;
        numbers.map(VertexId::new).zip(&mut self.points)
    }

    /// The point with the number `v`, if it is not a vertex of the mesh without the points.
    pub(crate) fn point(&self, v: VertexId) -> Option<(usize, &AttachedPoint)> {
        let i = v.index().checked_sub(self.vertices)?;
        self.points.get(i).map(|point| (i, point))
    }

    /// The distances with which a run begins, of vertices and points: 0 at `sources`, and those of
    /// the ways of sources. Calls `push` with the distances of vertices.
    pub(crate) fn begin(
        &self,
        sources: &[VertexId],
        mut push: impl FnMut(f64, VertexId),
    ) -> Vec<f64> {
        let mut distances = vec![f64::INFINITY; self.vertices + self.points.len()];
        for &source in sources {
            distances[source.index()] = 0.0;
            let Some((_, point)) = self.point(source) else {
                push(0.0, source);
                continue;
            };
            for &(end, length) in &point.ways {
                let known = &mut distances[end.index()];
                if length < *known {
                    *known = length;
                    if self.point(end).is_none() {
                        push(length, end);
                    }
                }
            }
        }
        distances
    }

    /// The distance of vertex or point `v`, given those of the vertices. `inside` gives a distance
    /// that point `i` has by other means than its ways.
    pub(crate) fn distance(
        &self,
        distances: &[f64],
        v: VertexId,
        inside: impl Fn(usize) -> f64,
    ) -> f64 {
        let known = distances[v.index()];
        self.point(v).map_or(known, |(i, point)| {
            let ways = point.ways.iter();
            let by_way = ways.map(|&(end, length)| distances[end.index()] + length);
            by_way.fold(known.min(inside(i)), f64::min)
        })
    }

    /// Sets the distances of the points, given those of the vertices; `inside` as in
    /// [`distance`](Self::distance).
    pub(crate) fn finish(&self, distances: &mut [f64], inside: impl Fn(usize, &[f64]) -> f64) {
        let numbers = (self.vertices..distances.len()).map(|i| VertexId::new(i as u32));
        let found = numbers.map(|v| self.distance(distances, v, |i| inside(i, distances)));
        let found: Vec<f64> = found.collect();
        distances[self.vertices..].copy_from_slice(&found);
    }
}

/// The points in these faces, with straight ways to the corners and to other points of a face.
fn with_ways(faces: Vec<Vec<PointInFace>>, vertices: usize) -> Vec<AttachedPoint> {
    let ways_of = |own: &[PointInFace]| {
        let to_corners = own.iter().flat_map(|face| {
            let lengths = face.corner_distances();
            face.corners.into_iter().zip(lengths)
        });
        let to_others = faces.iter().enumerate().flat_map(|(i, others)| {
            let pairs = own
                .iter()
                .flat_map(|face| others.iter().filter_map(|other| face.distance_to(other)));
            // A point is at 0 from itself.
            let lengths = pairs.filter(|&length| length > 0.0);
            lengths.map(move |length| (VertexId::new((vertices + i) as u32), length))
        });
        to_corners.chain(to_others).collect()
    };
    let ways: Vec<Vec<_>> = faces.iter().map(|own| ways_of(own)).collect();
    let all = faces.into_iter().zip(ways);
    all.map(|(faces, ways)| AttachedPoint { faces, ways })
        .collect()
}
