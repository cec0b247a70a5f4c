//! The plane of directions at a vertex: the logarithm of a path that starts there, and the
//! exponential map, which follows a straight line on the surface.

use std::f64::consts::TAU;

use geobench_mesh::{FaceId, HalfEdgeId, Mesh, VertexId};
use geobench_paths::{Path, PathPlace};

/// A direction in the tangent plane, times a length.
pub(super) type Vector = [f64; 2];

/// The directions at a vertex, as angles from its first half-edge.
///
/// At an inner vertex, angles on the surface are scaled so that they add up to 2π in the plane. At
/// a boundary vertex they are not scaled.
pub(super) struct Tangents<'a> {
    mesh: &'a Mesh,
    vertex: VertexId,
    /// For each half-edge that starts at the vertex, its angle on the surface.
    angles: Vec<f64>,
    /// The sum of the angles of all faces at the vertex.
    total: f64,
    /// Ratio of angles in the plane to angles on the surface.
    scale: f64,
}

impl<'a> Tangents<'a> {
    pub(super) fn new(mesh: &'a Mesh, vertex: VertexId) -> Self {
        let mut total = 0.0;
        let mut angles = Vec::new();
        for &h in mesh.outgoing(vertex) {
            angles.push(total);
            total += mesh.corner_angle(h);
        }
        let is_whole = !mesh.is_boundary(vertex) && total > 0.0;
        Self {
            mesh,
            vertex,
            angles,
            total,
            scale: if is_whole { TAU / total } else { 1.0 },
        }
    }

    /// The direction in which `path` leaves the vertex, times the length of the path; `None` if the
    /// path does not start here.
    pub(super) fn logarithm(&self, path: &Path) -> Option<Vector> {
        let Some(next) = path.points.get(1) else {
            return Some([0.0, 0.0]);
        };
        let angle = self.scale * self.angle_of(next.place)?;
        Some([libm::cos(angle), libm::sin(angle)].map(|x| path.length * x))
    }

    /// The angle on the surface at which the vertex sees a point that is on an edge or a vertex of
    /// one of its faces; `None` for any other point.
    fn angle_of(&self, place: PathPlace) -> Option<f64> {
        let mesh = self.mesh;
        let along = |v: VertexId| {
            let mut edges = mesh.outgoing(self.vertex).iter().zip(&self.angles);
            edges.find_map(|(&h, &angle)| match v {
                v if v == mesh.head(h) => Some(angle),
                v if v == mesh.apex_vertex(h) => Some(angle + mesh.corner_angle(h)),
                _ => None,
            })
        };
        match place {
            PathPlace::Vertex(v) => along(v),
            PathPlace::Edge { ends: [a, b], .. } if a == self.vertex => along(b),
            PathPlace::Edge { ends: [a, b], .. } if b == self.vertex => along(a),
            PathPlace::Edge { ends: [a, b], t } => {
                let mut edges = mesh.outgoing(self.vertex).iter().zip(&self.angles);
                edges.find_map(|(&h, angle)| {
                    let t = match [mesh.head(h), mesh.apex_vertex(h)] {
                        ends if ends == [a, b] => t,
                        ends if ends == [b, a] => 1.0 - t,
                        _ => return None,
                    };
                    let (l, [x, y]) = (mesh.length(h), mesh.apex(h));
                    Some(angle + libm::atan2(t * y, l + t * (x - l)))
                })
            }
            PathPlace::Face => None,
        }
    }

    /// The end of the straight line on the surface that starts along `vector` and has its length.
    /// The line ends early at the boundary, and after as many faces as the mesh has: around needles
    /// it may wind further. `None` if the vertex is in no face.
    pub(super) fn exponential(&self, vector: Vector) -> Option<LineEnd> {
        let length = libm::hypot(vector[0], vector[1]);
        let angle = libm::atan2(vector[1], vector[0]).rem_euclid(TAU) / self.scale;
        let angle = angle.min(self.total);
        let k = self.angles.partition_point(|&start| start <= angle);
        let k = k.checked_sub(1)?;
        let h = self.mesh.outgoing(self.vertex)[k];
        let angle = angle - self.angles[k];
        let ray = Ray {
            x: 0.0,
            direction: [libm::cos(angle), libm::sin(angle)],
            length,
        };
        Some(ray.walk(self.mesh, h))
    }
}

/// The end of a straight line on the surface.
pub(super) struct LineEnd {
    pub(super) face: FaceId,
    /// Barycentric coordinates in the face.
    pub(super) weights: [f64; 3],
    /// The length of the line.
    pub(super) length: f64,
}

/// A ray that starts on a half-edge, in its frame.
struct Ray {
    x: f64,
    direction: Vector,
    length: f64,
}

impl Ray {
    /// Follows the ray from face to face, at most as many as the mesh has, until its length is used
    /// up or it meets the boundary.
    fn walk(mut self, mesh: &Mesh, mut h: HalfEdgeId) -> LineEnd {
        let whole = self.length;
        let end = |h: HalfEdgeId, place, length| LineEnd {
            face: h.face(),
            weights: weights(mesh, h, place),
            length,
        };
        for _ in 0..mesh.face_count() {
            let (l, [ax, ay]) = (mesh.length(h), mesh.apex(h));
            let [dx, dy] = self.direction;
            let passes_right = dx * ay - dy * (ax - self.x) > 0.0;
            let (exit, from, to) = if passes_right {
                (h.next(), [l, 0.0], [ax, ay])
            } else {
                (h.prev(), [ax, ay], [0.0, 0.0])
            };
            let exit_length = mesh.length(exit);
            let along = [to[0] - from[0], to[1] - from[1]].map(|x| x / exit_length);
            // Its normal into the face.
            let normal = [-along[1], along[0]];
            let speed = -(dx * normal[0] + dy * normal[1]);
            let gap = (self.x - from[0]) * normal[0] - from[1] * normal[1];
            let step = (gap / speed).max(0.0);
            let goes_on = speed > 0.0 && step < self.length;
            let twin = mesh.twin(exit).filter(|_| goes_on);
            let step = if goes_on { step } else { self.length };
            let place = [self.x + step * dx, step * dy];
            let Some(twin) = twin else {
                return end(h, place, whole - self.length + step);
            };
            let at = (place[0] - from[0]) * along[0] + (place[1] - from[1]) * along[1];
            self = Self {
                x: (exit_length - at).clamp(0.0, exit_length),
                direction: [-(dx * along[0] + dy * along[1]), speed],
                length: self.length - step,
            };
            h = twin;
        }
        end(h, [self.x, 0.0], whole - self.length)
    }
}

/// The barycentric coordinates of a position in the frame of `h`, clamped to its face.
fn weights(mesh: &Mesh, h: HalfEdgeId, [x, y]: Vector) -> [f64; 3] {
    let (l, [ax, ay]) = (mesh.length(h), mesh.apex(h));
    let apex = (y / ay).clamp(0.0, 1.0);
    let head = ((x - apex * ax) / l).clamp(0.0, 1.0 - apex);
    let mut weights = [0.0; 3];
    weights[h.corner() as usize] = 1.0 - apex - head;
    weights[h.next().corner() as usize] = head;
    weights[h.prev().corner() as usize] = apex;
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The position of a point of a face.
    fn position(mesh: &Mesh, end: &LineEnd) -> [f64; 3] {
        let point = mesh.point_in_face(end.face, end.weights).unwrap();
        mesh.position_of(&point).unwrap()
    }

    #[test]
    fn lines_in_a_plane_are_straight_and_end_at_the_boundary() {
        let mesh = Mesh::generate("grid,n=8").unwrap();
        let middle = VertexId::new(40);
        let origin = mesh.positions()[middle.index()];
        let tangents = Tangents::new(&mesh, middle);
        let first = mesh.head(mesh.outgoing(middle)[0]);
        let first = mesh.positions()[first.index()];
        let turn = libm::atan2(first[1] - origin[1], first[0] - origin[0]);
        for i in 0..50 {
            let angle = f64::from(i) * TAU / 50.0;
            let vector = [3.9 * libm::cos(angle), 3.9 * libm::sin(angle)];
            let end = tangents.exponential(vector).unwrap();
            assert!((end.length - 3.9).abs() < 1e-12);
            let end = position(&mesh, &end);
            let expected = [
                origin[0] + 3.9 * libm::cos(angle + turn),
                origin[1] + 3.9 * libm::sin(angle + turn),
            ];
            assert!((end[0] - expected[0]).abs() < 1e-12, "{i}: {end:?}");
            assert!((end[1] - expected[1]).abs() < 1e-12, "{i}: {end:?}");
        }
        let far = tangents.exponential([100.0, 0.0]).unwrap();
        let length = far.length;
        let far = position(&mesh, &far);
        let off = [far[0] - origin[0], far[1] - origin[1]].map(f64::abs);
        assert!((off[0].max(off[1]) - 4.0).abs() < 1e-12, "{far:?}");
        assert!(
            (length - libm::hypot(off[0], off[1])).abs() < 1e-12,
            "{far:?}"
        );
    }

    #[test]
    fn the_logarithm_of_the_end_of_a_line_is_its_vector() {
        use geobench_paths::Paths;
        use geobench_vtp::VtpFast;
        use geobench_window::Goal;

        let mesh = Mesh::generate("sphere,subdiv=3").unwrap();
        let tangents = Tangents::new(&mesh, VertexId::new(0));
        for i in 0..40 {
            let angle = 0.05 + f64::from(i) * TAU / 40.0;
            let vector = [0.7 * libm::cos(angle), 0.7 * libm::sin(angle)];
            let end = tangents.exponential(vector).unwrap();
            let end = mesh.point_in_face(end.face, end.weights).unwrap();
            let refined = mesh.with_points(&[end]).unwrap();
            let mut solver = VtpFast::new(&refined.mesh);
            let paths = Paths::find(&mut solver, &refined.mesh, 0, &Goal::everything()).unwrap();
            let path = paths.to(refined.vertices[0]).unwrap().unwrap();
            let tangents = Tangents::new(&refined.mesh, VertexId::new(0));
            let found = tangents.logarithm(&path).unwrap();
            // The vertex is a cone: a straight line near an edge may not be the shortest path.
            let off = libm::hypot(found[0] - vector[0], found[1] - vector[1]);
            assert!(off < 0.05, "{i}: {found:?} for {vector:?}");
        }
    }
}
