//! Distances, gradients and paths at single points of a field.

use geobench_mesh::vector::{Point, add, norm, scale, sub};
use geobench_mesh::{FaceId, PointError, SurfacePoint};
use geobench_paths::{Path, Paths, TraceError};

use crate::DistanceField;
use crate::cones::FaceCones;

/// Relative difference of the lengths of paths that are equally short.
const SAME: f64 = 1e-9;

/// Why a [`DistanceField`] does not answer.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum QueryError {
    /// The point is not a point of the mesh.
    #[error(transparent)]
    Point(#[from] PointError),
    /// The path cannot be traced.
    #[error(transparent)]
    Trace(#[from] TraceError),
}

/// A point of a field: a vertex, or a point of a face of the refined mesh.
enum QueryPlace {
    Vertex(usize),
    Face(FaceId, Point),
}

/// Queries at any point of the surface, without another solve.
impl DistanceField {
    /// The distance of `point` from the nearest source; infinite if it is unreachable.
    ///
    /// The shortest path to a point inside a face enters it through an edge, where a stored window
    /// has it, or comes from a vertex of the face. O(windows that enter the face).
    ///
    /// ```
    /// use geobench_isolines::DistanceField;
    /// use geobench_mesh::Mesh;
    ///
    /// let mesh = Mesh::generate("grid,n=4")?;
    /// let field = DistanceField::new(&mesh, &[0.into()])?;
    /// let (point, _) = mesh.nearest_point([1.9, 0.3, 0.0])?;
    /// let [x, y, z] = mesh.positions()[0];
    /// let expected = f64::hypot(1.9 - x, 0.3 - y).hypot(z);
    /// assert!((field.distance(&point)? - expected).abs() < 1e-14);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the point is not one of the mesh.
    pub fn distance(&self, point: &SurfacePoint) -> Result<f64, PointError> {
        Ok(match self.site(point)? {
            QueryPlace::Vertex(v) => self.distances[v],
            QueryPlace::Face(face, x) => {
                let (cones, nearest) = self.nearest_cone(face, x);
                nearest.map_or(f64::INFINITY, |i| cones.cones[i].distance(x))
            }
        })
    }

    /// The gradient of the distance at `point`: the unit vector, in space, in which the distance
    /// grows fastest, away from the source. At an edge it is that in one of the faces, at a vertex
    /// that in a face through which a shortest path comes. `None` at sources, at unreachable
    /// points, in no face and on a mesh without positions. O(windows that enter the faces of the
    /// point).
    ///
    /// # Errors
    ///
    /// If the point is not one of the mesh.
    pub fn gradient(&self, point: &SurfacePoint) -> Result<Option<[f64; 3]>, PointError> {
        self.mesh.insertion(std::slice::from_ref(point))?;
        let mesh = &self.mesh;
        if mesh.positions().is_empty() {
            return Ok(None);
        }
        let Some((part, ray)) = self.last_ray(point) else {
            return Ok(None);
        };
        let face = self.refined.parent(part);
        let motion = self.refined.motion(part);
        let [from, to] = ray.map(|p| motion.of(p));
        let along = sub(to, from);
        let size = norm(along);
        if size == 0.0 {
            return Ok(None);
        }
        let [dx, dy] = scale(along, 1.0 / size);
        let [a, b, c] = mesh
            .face_vertices(face)
            .map(|v| mesh.positions()[v.index()]);
        // The first side is the x-axis of the plane of the face, the y-axis is perpendicular.
        let l = mesh.length(face.half_edge(0));
        let [cx, cy] = mesh.apex(face.half_edge(0));
        let e = [0, 1, 2].map(|k| (b[k] - a[k]) / l);
        let n = [0, 1, 2].map(|k| (c[k] - a[k] - cx * e[k]) / cy);
        Ok(Some([0, 1, 2].map(|k| dx * e[k] + dy * n[k])))
    }

    /// The last piece of a shortest path to `point`: a face of the refined mesh, and in its plane
    /// the apex of the cone that gives the point its distance, and the point.
    fn last_ray(&self, point: &SurfacePoint) -> Option<(FaceId, [Point; 2])> {
        let Some(v) = point.vertex() else {
            let (face, weights) = self.mesh.face_of(point)?;
            let (part, x) = self.in_part(face, weights);
            let (cones, nearest) = self.nearest_cone(part, x);
            return Some((part, [cones.cones[nearest?].centre, x]));
        };
        if self.distances[v.index()] == 0.0 {
            return None;
        }
        let mesh = &self.refined.mesh;
        let around = mesh.outgoing(mesh.kept_vertex(v)).iter();
        let mut rays = Vec::new();
        for h in around {
            let cones = self.cones(h.face());
            let i = h.corner() as usize;
            let found = cones.rays_to_corner(i);
            rays.extend(found.map(|(distance, centre, outside)| {
                (distance, outside, (h.face(), [centre, cones.corners[i]]))
            }));
        }
        // Windows of the other faces end at the vertex, and give it the same distance.
        let least = rays.iter().map(|ray| ray.0).reduce(f64::min)?;
        let shortest = rays.into_iter().filter(|ray| ray.0 <= least + SAME * least);
        let inside = shortest.min_by(|a, b| a.1.total_cmp(&b.1));
        inside.map(|(_, _, ray)| ray)
    }

    /// The shortest path from the nearest source to `point`; `None` if it is unreachable.
    ///
    /// Found by a search back from the point, in the band of faces where a shortest path can run.
    ///
    /// ```
    /// use geobench_isolines::DistanceField;
    /// use geobench_mesh::Mesh;
    ///
    /// let mesh = Mesh::generate("grid,n=4")?;
    /// let field = DistanceField::new(&mesh, &[0.into()])?;
    /// let (point, _) = mesh.nearest_point([0.9, 0.3, 0.0])?;
    /// let path = field.path(&point)?.expect("the grid is in one piece");
    /// assert!((path.length - field.distance(&point)?).abs() < 1e-14);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the point is not one of the mesh. Other errors are defects of the program.
    pub fn path(&self, point: &SurfacePoint) -> Result<Option<Path>, QueryError> {
        let distance = self.distance(point)?;
        if distance.is_infinite() {
            return Ok(None);
        }
        let target = match self.site(point)? {
            QueryPlace::Vertex(v) => (v as u32).into(),
            QueryPlace::Face(face, x) => {
                let weights = self.weights(face, x);
                self.refined.mesh.point_in_face(face, weights)?
            }
        };
        let with_target = self.refined.mesh.with_points(&[target])?;
        let mut distances = self.distances.clone();
        distances.resize(with_target.mesh.vertex_count(), distance);
        let paths = Paths::of_distances(&with_target.mesh, distances)?;
        let path = paths.to(with_target.vertices[0])?;
        Ok(path.map(|path| {
            let path = path.of_original(&with_target);
            path.of_original(&self.refined)
        }))
    }

    fn site(&self, point: &SurfacePoint) -> Result<QueryPlace, PointError> {
        // Checks the point.
        self.mesh.insertion(std::slice::from_ref(point))?;
        if let Some(v) = point.vertex() {
            return Ok(QueryPlace::Vertex(v.index()));
        }
        let Some((face, weights)) = self.mesh.face_of(point) else {
            return Err(PointError::NoPositions);
        };
        let (part, x) = self.in_part(face, weights);
        Ok(QueryPlace::Face(part, x))
    }

    /// The cones of a face of the refined mesh, and the one that gives `x` the shortest distance.
    fn nearest_cone(&self, face: FaceId, x: Point) -> (FaceCones, Option<usize>) {
        let cones = self.cones(face);
        let nearest = cones.nearest(x);
        let finite = nearest.filter(|&i| cones.cones[i].distance(x).is_finite());
        (cones, finite)
    }

    /// The part of `face`, of the original mesh, that contains the point with these weights, and
    /// its place in the plane of the part.
    fn in_part(&self, face: FaceId, weights: [f64; 3]) -> (FaceId, Point) {
        let refined = &self.refined;
        let place = |corners: [Point; 3], weights: [f64; 3]| {
            let parts = [0, 1, 2].map(|k| scale(corners[k], weights[k]));
            add(add(parts[0], parts[1]), parts[2])
        };
        let whole = crate::cones::corners(&self.mesh, face);
        let x = place(whole, weights);
        let added = self.mesh.face_count()..refined.mesh.face_count();
        let added = added.map(|f| FaceId::new(f as u32));
        let mut parts = added
            .filter(|&part| refined.parent(part) == face)
            .peekable();
        if parts.peek().is_none() {
            return (face, x);
        }
        // The part in which the least weight is greatest.
        let inside = |part: FaceId| {
            let own = crate::cones::corners(&refined.mesh, part);
            let motion = refined.motion(part);
            let weights = barycentric(own.map(|corner| motion.of(corner)), x);
            let least = weights.into_iter().fold(f64::INFINITY, f64::min);
            (least, part, place(own, weights))
        };
        let parts = parts.chain([face]).map(inside);
        let best = parts.max_by(|a, b| a.0.total_cmp(&b.0));
        best.map_or((face, x), |(_, part, x)| (part, x))
    }

    /// The barycentric coordinates of a point in the plane of a face of the refined mesh.
    fn weights(&self, face: FaceId, x: Point) -> [f64; 3] {
        let weights = barycentric(crate::cones::corners(&self.refined.mesh, face), x);
        let positive = weights.map(|w| w.max(0.0));
        let sum: f64 = positive.iter().sum();
        positive.map(|w| w / sum)
    }
}

/// The barycentric coordinates of `x` in a triangle with these corners.
fn barycentric(corners: [Point; 3], x: Point) -> [f64; 3] {
    let cross = |p: Point, q: Point| geobench_mesh::vector::cross_2d(p, q);
    let [a, b, c] = corners;
    let area = cross(sub(b, a), sub(c, a));
    let of = |p: Point, q: Point| cross(sub(p, x), sub(q, x)) / area;
    [of(b, c), of(c, a), of(a, b)]
}
