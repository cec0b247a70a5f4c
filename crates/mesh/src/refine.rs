//! Refinement of a mesh so that given points are vertices.

mod patch;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::f64::consts::PI;

use crate::build::{flat_flags, in_fans, is_sliver};
use crate::ids::{FaceId, HalfEdgeId, VertexId};
use crate::junctions::Junctions;
use crate::mesh::{Extremes, Mesh, NO_TWIN};
use crate::point::{Place, PointError, SNAP, SurfacePoint};
use crate::splice::{FaceData, Splice, VertexData};
use patch::{Patch, PatchNeighbour};

/// A mesh with the same surface as another one, in which given points are vertices.
///
/// Solvers find the same distances on both, up to rounding. All lengths are the same, and the angle
/// at an added vertex is 2π, or π on the boundary.
#[derive(Clone, Debug)]
pub struct Refined {
    /// The refined mesh. The vertices of the original keep their numbers, and added ones follow. So
    /// do faces: one part of a split face keeps its number.
    pub mesh: Mesh,
    /// The vertex at each point, in the order of the points. Points at the same place share a
    /// vertex, which is never a copy.
    pub vertices: Vec<VertexId>,
    original: Mesh,
    /// The points of the original mesh at which vertices were added, in the order of their numbers.
    added: Vec<SurfacePoint>,
    /// The original face of each added face.
    parents: Vec<FaceId>,
}

impl Refined {
    /// The mesh that was refined.
    pub const fn original(&self) -> &Mesh {
        &self.original
    }

    /// The face of the original mesh that contains `face`.
    ///
    /// # Panics
    ///
    /// If the refined mesh has no such face.
    pub fn parent(&self, face: FaceId) -> FaceId {
        match face.index().checked_sub(self.original.face_count()) {
            None => face,
            Some(added) => self.parents[added],
        }
    }

    /// Converts the barycentric coordinates of a point of `face` to those in its
    /// [parent](Self::parent). A coordinate of 0 is exactly 0.
    ///
    /// ```
    /// use geobench_mesh::{FaceId, Mesh};
    ///
    /// let mesh = Mesh::generate("grid,n=2")?;
    /// let point = mesh.point_in_face(FaceId::new(0), [0.25, 0.25, 0.5])?;
    /// let refined = mesh.with_points(&[point])?;
    /// let part = refined.mesh.outgoing(refined.vertices[0])[0].face();
    /// let corners = refined.mesh.face_vertices(part);
    /// let k = corners.iter().position(|&v| v == refined.vertices[0]).unwrap();
    /// let mut corner = [0.0; 3];
    /// corner[k] = 1.0;
    /// assert_eq!(refined.in_parent(part, corner), [0.25, 0.25, 0.5]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Panics
    ///
    /// If the refined mesh has no such face.
    pub fn in_parent(&self, face: FaceId, barycentric: [f64; 3]) -> [f64; 3] {
        let parent = self.parent(face);
        let mut weights = [0.0; 3];
        for (corner, weight) in self.mesh.face_vertices(face).into_iter().zip(barycentric) {
            if weight != 0.0 {
                let of_corner = self.corner_in(parent, corner);
                (0..3).for_each(|k| weights[k] += weight * of_corner[k]);
            }
        }
        weights
    }

    /// The rigid motion from the plane of a face to that of its [parent](Self::parent). The first
    /// side of a face is on the x-axis of its plane and starts at the origin.
    ///
    /// # Panics
    ///
    /// If the refined mesh has no such face.
    pub fn motion(&self, face: FaceId) -> Motion {
        let parent = self.parent(face);
        let within = corners(&self.mesh, face);
        let vertices = self.mesh.face_vertices(face);
        if vertices == self.original.face_vertices(parent) {
            return Motion::NONE;
        }
        let outer = corners(&self.original, parent);
        let place = |k: usize| {
            let weights = self.corner_in(parent, vertices[k]);
            [0, 1].map(|axis| (0..3).map(|i| weights[i] * outer[i][axis]).sum::<f64>())
        };
        // The direction of the longest side has the smallest rounding error.
        let length = |k: u32| self.mesh.length(face.half_edge(k));
        let longest = (0..3).max_by(|&a, &b| length(a).total_cmp(&length(b)));
        let tail = longest.unwrap_or(0) as usize;
        let head = (tail + 1) % 3;
        Motion::between([within[tail], within[head]], [place(tail), place(head)])
    }

    /// The barycentric coordinates in `parent` of a vertex of one of its parts.
    fn corner_in(&self, parent: FaceId, v: VertexId) -> [f64; 3] {
        let mut weights = [0.0; 3];
        let corners = self.original.face_vertices(parent);
        let mut add = |v: VertexId, weight: f64| {
            if let Some(k) = corners.iter().position(|&corner| corner == v) {
                weights[k] += weight;
            }
        };
        let Some(added) = v.index().checked_sub(self.original.vertex_count()) else {
            add(v, 1.0);
            return weights;
        };
        match self.added[added].place() {
            Place::Face(_, inside) => return inside,
            Place::Edge(h, [tail, head]) => {
                add(self.original.tail(h), tail);
                add(self.original.head(h), head);
            }
            Place::Vertex(_) => {}
        }
        weights
    }
}

/// A [`Splice`] that makes given points vertices; see [`Refined`].
#[derive(Clone, Debug)]
pub struct Insertion {
    splice: Splice,
    vertices: Vec<VertexId>,
    original: Mesh,
    parents: Vec<FaceId>,
}

impl Insertion {
    /// The change of the mesh.
    pub const fn splice(&self) -> &Splice {
        &self.splice
    }

    /// The vertex at each point, in the order of the points, after the change.
    pub fn vertices(&self) -> &[VertexId] {
        &self.vertices
    }

    /// The mesh before the change.
    pub const fn original(&self) -> &Mesh {
        &self.original
    }

    /// Whether all points are vertices of the mesh, so that nothing changes.
    pub fn is_empty(&self) -> bool {
        self.splice.points.is_empty()
    }

    /// The refined mesh, where `mesh` is the original with [`splice`](Self::splice).
    ///
    /// # Panics
    ///
    /// If `mesh` has another number of faces.
    pub fn into_refined(self, mesh: Mesh) -> Refined {
        assert_eq!(mesh.face_count(), self.splice.face_count(), "another mesh");
        Refined {
            mesh,
            vertices: self.vertices,
            original: self.original,
            added: self.splice.points,
            parents: self.parents,
        }
    }
}

/// The corners of `face` in the frame of its first half-edge.
fn corners(mesh: &Mesh, face: FaceId) -> [[f64; 2]; 3] {
    let h = face.half_edge(0);
    [[0.0; 2], [mesh.length(h), 0.0], mesh.apex(h)]
}

/// A rotation and a translation of the plane.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// A point and its image.
    from: [f64; 2],
    to: [f64; 2],
    /// The rotation, as a complex number.
    turn: [f64; 2],
}

impl Motion {
    const NONE: Self = Self {
        from: [0.0; 2],
        to: [0.0; 2],
        turn: [1.0, 0.0],
    };

    /// The motion that maps `a` to `p`, and `b` in the direction of `q`.
    fn between([a, b]: [[f64; 2]; 2], [p, q]: [[f64; 2]; 2]) -> Self {
        let (u, v) = ([b[0] - a[0], b[1] - a[1]], [q[0] - p[0], q[1] - p[1]]);
        let turn = [u[0] * v[0] + u[1] * v[1], u[0] * v[1] - u[1] * v[0]];
        let size = turn[0].hypot(turn[1]);
        Self {
            from: a,
            to: p,
            turn: turn.map(|x| x / size),
        }
    }

    /// The image of a point.
    pub fn of(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let ([x, y], [c, s]) = ([x - self.from[0], y - self.from[1]], self.turn);
        [self.to[0] + x * c - y * s, self.to[1] + x * s + y * c]
    }
}

/// An added vertex on an edge.
#[derive(Clone, Copy)]
struct EdgeVertex {
    /// Weights of the tail and the head of the half-edge with the lower number.
    weights: [f64; 2],
    vertex: u32,
}

/// The distance of two points of an edge, as a fraction of the edge; accurate for close ones.
fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    let near_head = a[1].min(b[1]) > 0.5;
    let k = usize::from(!near_head);
    (a[k] - b[k]).abs()
}

impl Mesh {
    /// Builds a mesh with a vertex at each of `points`; see [`Refined`].
    ///
    /// A face is split into the Delaunay triangulation of its points, which avoids slivers where
    /// possible. New lengths follow from barycentric coordinates and the lengths of the face, not
    /// from positions in space. Points closer to each other than 1e-12 of the longest edge of their
    /// face share a vertex. Takes time linear in the size of the mesh, and quadratic in the number
    /// of points of one face.
    ///
    /// ```
    /// use geobench_mesh::{FaceId, Mesh};
    ///
    /// let mesh = Mesh::generate("sphere,subdiv=1")?;
    /// let point = mesh.point_in_face(FaceId::new(7), [0.2, 0.3, 0.5])?;
    /// let refined = mesh.with_points(&[point, 3.into()])?;
    /// assert_eq!(refined.mesh.vertex_count(), mesh.vertex_count() + 1);
    /// assert_eq!(refined.mesh.face_count(), mesh.face_count() + 2);
    /// assert_eq!(refined.vertices, [42.into(), 3.into()]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If a point is not one of this mesh, or the numbers of vertices or faces exceed 32 bits.
    pub fn with_points(&self, points: &[SurfacePoint]) -> Result<Refined, PointError> {
        let insertion = self.insertion(points)?;
        let mut mesh = self.clone();
        if !insertion.is_empty() {
            mesh.splice(insertion.splice());
        }
        Ok(insertion.into_refined(mesh))
    }

    /// The change of this mesh by which [`with_points`](Self::with_points) refines it. Takes time
    /// in the size of the faces around the points only.
    ///
    /// # Errors
    ///
    /// As [`with_points`](Self::with_points).
    pub fn insertion(&self, points: &[SurfacePoint]) -> Result<Insertion, PointError> {
        let mut edges: BTreeMap<HalfEdgeId, Vec<EdgeVertex>> = BTreeMap::new();
        let mut faces: BTreeMap<FaceId, Vec<([f64; 3], u32)>> = BTreeMap::new();
        let mut vertices = Vec::with_capacity(points.len());
        let mut places = Vec::new();
        // Each point adds at most one vertex and two faces.
        let most = self.half_edge_count() as u64 + 6 * points.len() as u64;
        if most.max((self.vertex_count() + points.len()) as u64) >= u64::from(u32::MAX) {
            let points = points.len();
            return Err(PointError::TooMany { points });
        }
        let next = |places: &Vec<SurfacePoint>| (self.vertex_count() + places.len()) as u32;
        for point in points {
            let vertex = match point.place() {
                Place::Vertex(vertex) => {
                    self.point_at_vertex(vertex)?;
                    self.kept_vertex(vertex).raw()
                }
                Place::Edge(h, weights) => {
                    self.check_face(h.face())?;
                    let h = self.edge_of(h);
                    let stops = edges.entry(h).or_default();
                    let same = |stop: &&EdgeVertex| apart(stop.weights, weights) <= SNAP;
                    if let Some(stop) = stops.iter().find(same) {
                        stop.vertex
                    } else {
                        let vertex = next(&places);
                        stops.push(EdgeVertex { weights, vertex });
                        places.push(*point);
                        vertex
                    }
                }
                Place::Face(face, weights) => {
                    self.check_face(face)?;
                    let inside = faces.entry(face).or_default();
                    let shape = patch::BarycentricShape::new(self, face);
                    let same = |(other, _): &&([f64; 3], u32)| {
                        shape.distance(*other, weights) <= SNAP * shape.longest()
                    };
                    if let Some(&(_, vertex)) = inside.iter().find(same) {
                        vertex
                    } else {
                        let vertex = next(&places);
                        inside.push((weights, vertex));
                        places.push(*point);
                        vertex
                    }
                }
            };
            vertices.push(VertexId::new(vertex));
        }
        let refinement = Refinement {
            mesh: self,
            edges,
            faces,
            places,
        };
        let (splice, parents) = refinement.build();
        Ok(Insertion {
            splice,
            vertices,
            original: self.clone(),
            parents,
        })
    }

    pub(crate) fn check_face(&self, face: FaceId) -> Result<(), PointError> {
        let faces = self.face_count();
        if face.index() < faces {
            Ok(())
        } else {
            Err(PointError::NoSuchFace { face, faces })
        }
    }
}

/// The vertices to add to a mesh.
struct Refinement<'m> {
    mesh: &'m Mesh,
    /// Vertices inside edges, by the half-edge with the lower number.
    edges: BTreeMap<HalfEdgeId, Vec<EdgeVertex>>,
    /// Vertices inside faces, with their barycentric coordinates.
    faces: BTreeMap<FaceId, Vec<([f64; 3], u32)>>,
    /// The points of the added vertices.
    places: Vec<SurfacePoint>,
}

impl Refinement<'_> {
    /// The change of the mesh, and the parents of the added faces.
    fn build(mut self) -> (Splice, Vec<FaceId>) {
        for stops in self.edges.values_mut() {
            // From the tail to the head. Near the head the weight of the tail distinguishes points.
            stops.sort_by(|a, b| {
                let by_head = a.weights[1].total_cmp(&b.weights[1]);
                by_head.then(b.weights[0].total_cmp(&a.weights[0]))
            });
        }
        let mesh = self.mesh;
        let mut changed: BTreeMap<FaceId, FaceData> = BTreeMap::new();
        let mut parents = Vec::new();
        // Half-edges along the edges of the original, by the original half-edge and the rank of the
        // part from its tail.
        let mut along: BTreeMap<(HalfEdgeId, usize), u32> = BTreeMap::new();
        for (&face, patch) in &self.patches() {
            let first = mesh.face_count() + parents.len();
            let number = |t: usize| if t == 0 { face.index() } else { first + t - 1 };
            for (t, triangle) in patch.triangles().iter().enumerate() {
                let place = FaceId::new(number(t) as u32);
                if t > 0 {
                    parents.push(face);
                }
                let shape = patch.shape_of(triangle, |side, rank| self.part(face, side, rank));
                let mut twins = [NO_TWIN; 3];
                for (k, neighbour) in triangle.neighbours.iter().enumerate() {
                    match *neighbour {
                        PatchNeighbour::Inside(other, edge) => {
                            twins[k] = (3 * number(other) + edge) as u32;
                        }
                        PatchNeighbour::Side(side) => {
                            let rank = patch.rank_of_edge(triangle, k, side);
                            let h = place.half_edge(k as u32);
                            along.insert((face.half_edge(side as u32), rank), h.raw());
                        }
                    }
                }
                let part = FaceData {
                    tails: triangle.corners.map(|p| VertexId::new(patch.vertex(p))),
                    twins,
                    lengths: shape.lengths,
                    apexes: Some(shape.apexes),
                };
                changed.insert(place, part);
            }
        }
        let parts: Vec<FaceId> = changed.keys().copied().collect();
        let mut link = |h: HalfEdgeId, twin: u32| {
            let face = h.face();
            let data = changed
                .entry(face)
                .or_insert_with(|| FaceData::of(mesh, face));
            data.twins[h.corner() as usize] = twin;
        };
        for (&(parent, rank), &h) in &along {
            let twin = mesh.twin(parent).map_or(NO_TWIN, |twin| {
                let parts = self.stops(parent).len() + 1;
                let rank = parts - 1 - rank;
                along.get(&(twin, rank)).copied().unwrap_or(twin.raw())
            });
            link(HalfEdgeId::new(h), twin);
            // The neighbour may be a face that is not split.
            if twin != NO_TWIN {
                link(HalfEdgeId::new(twin), h);
            }
        }
        let (vertices, extremes) = self.vertices(&changed, &parts);
        let junctions = mesh.has_junctions().then(|| self.junctions(&along));
        let splice = Splice {
            vertex_count: mesh.vertex_count() + self.places.len(),
            face_count: mesh.face_count() + parents.len(),
            undoes: false,
            faces: changed.into_iter().collect(),
            vertices,
            extremes,
            junctions,
            points: self.places,
        };
        (splice, parents)
    }

    /// The corners of `parts`, which are among the `changed` faces, and the extremes of all faces.
    /// Angles and flags of vertices of the original stay as they are: rounding in the parts of
    /// split faces must not change them. Corners of new slivers are flagged.
    fn vertices(
        &self,
        changed: &BTreeMap<FaceId, FaceData>,
        parts: &[FaceId],
    ) -> (Vec<(VertexId, VertexData)>, Extremes) {
        let mesh = self.mesh;
        let mut vertices: BTreeMap<VertexId, VertexData> = BTreeMap::new();
        for (i, place) in self.places.iter().enumerate() {
            let (faces, is_junction) = match place.place() {
                Place::Edge(h, _) => {
                    let faces = mesh.along_edge(h).count() as u32;
                    (faces, !mesh.junction(h).is_empty())
                }
                _ => (2, false),
            };
            let data = VertexData {
                position: mesh.position_of(place),
                flags: flat_flags(faces, is_junction),
                total_angle: f64::from(faces) * PI,
                outgoing: Vec::new(),
            };
            vertices.insert(VertexId::new((mesh.vertex_count() + i) as u32), data);
        }
        let mut extremes = mesh.data.extremes;
        for face in parts {
            let data = &changed[face];
            let longest = data.lengths.into_iter().fold(0.0, f64::max);
            let height = data.apexes.map_or(0.0, |apexes| apexes[0][1]);
            let twice_area = data.lengths[0] * height;
            extremes = extremes.with(Extremes::of(longest, twice_area));
            for (k, &v) in data.tails.iter().enumerate() {
                let vertex = vertices.entry(v).or_insert_with(|| {
                    let mut vertex = VertexData::of(mesh, v);
                    // A split face keeps its number for one of its parts.
                    vertex
                        .outgoing
                        .retain(|h| parts.binary_search(&h.face()).is_err());
                    vertex
                });
                vertex.outgoing.push(face.half_edge(k as u32));
                vertex.flags.beside_sliver |= is_sliver(longest, twice_area);
            }
        }
        for vertex in vertices.values_mut() {
            vertex.outgoing.sort_unstable();
            let twin = |h: HalfEdgeId| match changed.get(&h.face()) {
                Some(face) => {
                    let twin = face.twins[h.corner() as usize];
                    (twin != NO_TWIN).then(|| HalfEdgeId::new(twin))
                }
                None => mesh.twin(h),
            };
            vertex.outgoing = in_fans(&vertex.outgoing, twin);
        }
        (vertices.into_iter().collect(), extremes)
    }

    /// The junctions of the refined mesh: the parts of those of the original.
    fn junctions(&self, along: &BTreeMap<(HalfEdgeId, usize), u32>) -> Junctions {
        let parts = self.mesh.data.junctions.iter().flat_map(|junction| {
            let edge = junction[0];
            let last = self.edges.get(&edge).map_or(0, Vec::len);
            (0..=last).map(move |rank| {
                junction.iter().map(move |&h| {
                    let is_turned = self.mesh.tail(h) != self.mesh.tail(edge);
                    let rank = if is_turned { last - rank } else { rank };
                    let part = along.get(&(h, rank));
                    part.map_or(h, |&part| HalfEdgeId::new(part))
                })
            })
        });
        Junctions::new(parts)
    }

    /// The parts of the faces that are split.
    fn patches(&self) -> BTreeMap<FaceId, Patch> {
        let mut patches = BTreeMap::new();
        let mut touched: Vec<FaceId> = self.faces.keys().copied().collect();
        for &h in self.edges.keys() {
            touched.extend(self.mesh.along_edge(h).map(HalfEdgeId::face));
        }
        for face in touched {
            patches.entry(face).or_insert_with(|| self.patch(face));
        }
        patches
    }

    fn patch(&self, face: FaceId) -> Patch {
        let mut patch = Patch::new(self.mesh, face);
        for side in 0..3 {
            for stop in self.stops(face.half_edge(side)) {
                patch.add_on_side(side as usize, stop.weights, stop.vertex);
            }
        }
        for &(weights, vertex) in self.faces.get(&face).into_iter().flatten() {
            patch.add_inside(weights, vertex);
        }
        patch
    }

    /// The added vertices on `h`, from its tail to its head, with the weights of its tail and head.
    fn stops(&self, h: HalfEdgeId) -> Vec<EdgeVertex> {
        let edge = self.mesh.edge_of(h);
        let Some(stops) = self.edges.get(&edge) else {
            return Vec::new();
        };
        if self.mesh.tail(edge) == self.mesh.tail(h) {
            return stops.clone();
        }
        let turn = |stop: &EdgeVertex| EdgeVertex {
            weights: [stop.weights[1], stop.weights[0]],
            ..*stop
        };
        stops.iter().rev().map(turn).collect()
    }

    /// Length of a part of a side of `face`; `rank` counts from the tail of the side. It is the
    /// same number from all faces of the edge.
    fn part(&self, face: FaceId, side: usize, rank: usize) -> f64 {
        let h = face.half_edge(side as u32);
        let edge = self.mesh.edge_of(h);
        let length = self.mesh.length(h);
        let Some(stops) = self.edges.get(&edge) else {
            return length;
        };
        let rank = if self.mesh.tail(edge) == self.mesh.tail(h) {
            rank
        } else {
            stops.len() - rank
        };
        let before = rank.checked_sub(1).map_or([1.0, 0.0], |r| stops[r].weights);
        let after = stops.get(rank).map_or([0.0, 1.0], |stop| stop.weights);
        apart(before, after) * length
    }
}
