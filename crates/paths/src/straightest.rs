//! Straightest geodesics: the line in a given direction.

use geobench_mesh::vector::{cross_2d, dot, norm, scale, sub};
use geobench_mesh::{HalfEdgeId, Mesh, Place, SurfacePoint, VertexId};
use thiserror::Error;

use crate::path::{Path, PathPlace, Point};

/// How close to a vertex a line must pass, relative to the longest edge of the face, to pass
/// through the vertex.
const SNAP: f64 = 1e-12;

/// Maximum number of points of a line.
const MOST_POINTS: usize = 10_000_000;

/// A line that cannot be traced.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum LineError {
    /// The length is negative or not finite.
    #[error("{length} is no length: give a finite number from 0 on")]
    Length {
        /// The length.
        length: f64,
    },
    /// The direction has no part along the surface.
    #[error("the direction ({}, {}, {}) does not point along the surface", .direction[0], .direction[1], .direction[2])]
    Direction {
        /// The direction.
        direction: [f64; 3],
    },
    /// The mesh was made from lengths alone, so that directions in space mean nothing.
    #[error("the mesh has no positions, so that a direction in space means nothing")]
    NoPositions,
    /// The start is an isolated vertex or not on the mesh.
    #[error("the start is in no face of the mesh")]
    NoFace,
    /// The line crosses too many faces.
    #[error("the line crosses more than {MOST_POINTS} faces")]
    TooLong,
}

/// A ray in the plane of a face, in the frame of one of its half-edges: its tail is the origin, its
/// head on the positive x-axis, and the face above it.
#[derive(Clone, Copy, Debug)]
struct Heading {
    h: HalfEdgeId,
    from: [f64; 2],
    /// Of length 1.
    direction: [f64; 2],
}

/// Where a ray leaves its face.
enum LineExit {
    /// At the vertex from which this half-edge of the face starts.
    Vertex(HalfEdgeId),
    /// Through this half-edge of the face, at the fraction of the way from its tail.
    Edge(HalfEdgeId, f64),
}

fn unit(a: [f64; 2]) -> [f64; 2] {
    let length = libm::hypot(a[0], a[1]);
    a.map(|x| x / length)
}

/// The straightest geodesic from `start` in the given direction, as defined by Polthier and
/// Schmies, "Straightest geodesics on polyhedral surfaces" (1998).
///
/// The line is straight in every face and across every edge. At a vertex it goes on with equal
/// angles to its left and its right. It ends after `length`, or earlier where the surface ends: at
/// an edge or a vertex of the boundary, and at an edge of more than two faces. Then the
/// [length](Path::length) of the path is shorter. A line that passes within 1e-12 of a vertex, in
/// longest edges of the face, passes through the vertex.
///
/// `direction` is a vector in space, of any length. The line starts in the direction of the surface
/// that is closest to it: at a point in a face its projection; on an edge and at a vertex that of
/// all directions of the faces there with the least angle to it.
///
/// Shortest paths that pass no vertex are such lines, but a line need not be a shortest path.
///
/// O(faces crossed).
///
/// ```
/// use geobench_mesh::Mesh;
/// use geobench_paths::line;
///
/// // Around a cube and back to the start.
/// let cube = Mesh::generate("cube,n=1")?;
/// let start = cube.nearest_point([0.5, 0.3, 1.0])?.0;
/// let around = line(&cube, &start, [1.0, 0.0, 0.0], 4.0)?;
/// let positions = around.polyline(&cube);
/// let (first, last) = (positions[0], positions[positions.len() - 1]);
/// assert!((0..3).all(|k| (first[k] - last[k]).abs() < 1e-12));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// If the length is negative or not finite, the direction is perpendicular to the surface, the
/// start is in no face, the mesh has no positions, or the line crosses more than 10,000,000 faces.
pub fn line(
    mesh: &Mesh,
    start: &SurfacePoint,
    direction: [f64; 3],
    length: f64,
) -> Result<Path, LineError> {
    if !(length.is_finite() && length >= 0.0) {
        return Err(LineError::Length { length });
    }
    if mesh.positions().is_empty() {
        return Err(LineError::NoPositions);
    }
    if mesh.face_of(start).is_none() {
        return Err(LineError::NoFace);
    }
    let ray = towards(mesh, start, direction).ok_or(LineError::Direction { direction })?;
    follow(mesh, start, ray, length)
}

/// The line from `start` along `ray`.
fn follow(
    mesh: &Mesh,
    start: &SurfacePoint,
    mut ray: Heading,
    length: f64,
) -> Result<Path, LineError> {
    let mut points = vec![Point::of(mesh, start)];
    // The way so far is summed, as what is left of a far greater length would have no digits for
    // it.
    let mut gone = 0.0;
    while gone < length {
        if points.len() >= MOST_POINTS {
            return Err(LineError::TooLong);
        }
        let (way, leaving) = ray.leave(mesh);
        if way >= length - gone {
            points.push(ray.end(mesh, length - gone));
            gone = length;
            break;
        }
        gone += way;
        let next = match leaving {
            LineExit::Vertex(h) => {
                points.push(Point::at_vertex(mesh, mesh.tail(h)));
                ray.around_vertex(mesh, h)
            }
            LineExit::Edge(h, t) => {
                points.push(Point::on_edge(h, [mesh.tail(h), mesh.head(h)], t));
                ray.across(mesh, h, t)
            }
        };
        let Some(next) = next else {
            break;
        };
        ray = next;
    }
    Ok(Path {
        length: gone,
        points,
    })
}

/// The directions from a point into one of the faces that contain it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sector {
    /// The half-edge in whose frame the point and the directions are.
    pub(crate) h: HalfEdgeId,
    pub(crate) from: [f64; 2],
    /// The angle of the directions, from that of the half-edge on; `None` if it is the full one.
    pub(crate) angle: Option<f64>,
}

/// The sectors at `start`, counter-clockwise within each fan of faces.
pub(crate) fn sectors(mesh: &Mesh, start: &SurfacePoint) -> Vec<Sector> {
    match start.place() {
        Place::Face(face, weights) => {
            let h = face.half_edge(0);
            let [l, apex] = [[mesh.length(h), 0.0], mesh.apex(h)];
            let from = [0, 1].map(|k| weights[1] * l[k] + weights[2] * apex[k]);
            let angle = None;
            vec![Sector { h, from, angle }]
        }
        Place::Edge(h, weights) => {
            let of_side = |side| {
                let weight = weights[usize::from(mesh.tail(side) == mesh.tail(h))];
                Sector {
                    h: side,
                    from: [weight * mesh.length(side), 0.0],
                    angle: Some(std::f64::consts::PI),
                }
            };
            mesh.along_edge(h).map(of_side).collect()
        }
        Place::Vertex(v) => {
            let at_corner = |&h: &HalfEdgeId| Sector {
                h,
                from: [0.0; 2],
                angle: Some(mesh.corner_angle(h)),
            };
            let outgoing = mesh.outgoing(mesh.kept_vertex(v)).iter();
            outgoing.map(at_corner).collect()
        }
    }
}

/// The ray from `start` whose direction is closest to `direction`; `None` if that is perpendicular
/// to all faces there or away from them.
fn towards(mesh: &Mesh, start: &SurfacePoint, direction: [f64; 3]) -> Option<Heading> {
    let size = direction.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let direction = direction.map(|x| x / size);
    let rays = sectors(mesh, start).into_iter().filter_map(|sector| {
        let Sector { h, from, angle } = sector;
        let [x, y] = in_plane(mesh, h, direction)?;
        let ends = angle.map(|angle| [[1.0, 0.0], [libm::cos(angle), libm::sin(angle)]]);
        let outside = angle.filter(|&angle| {
            let own = libm::atan2(y, x);
            !(0.0..=angle).contains(&own)
        });
        let direction = match (outside, ends) {
            (Some(_), Some([a, b])) if dot(a, [x, y]) >= dot(b, [x, y]) => a,
            (Some(_), Some([_, b])) => b,
            _ => unit([x, y]),
        };
        let ray = Heading { h, from, direction };
        let closeness = dot(direction, [x, y]);
        (closeness > SNAP).then_some((closeness, ray))
    });
    let best = rays.max_by(|a, b| a.0.total_cmp(&b.0));
    best.map(|(_, ray)| ray)
}

/// A vector in space, projected to the plane of the face of `h`, in the frame of `h`.
fn in_plane(mesh: &Mesh, h: HalfEdgeId, vector: [f64; 3]) -> Option<[f64; 2]> {
    let at = |v: VertexId| mesh.positions().get(v.index()).copied();
    let (tail, head, apex) = (
        at(mesh.tail(h))?,
        at(mesh.head(h))?,
        at(mesh.apex_vertex(h))?,
    );
    // Without area: NaN.
    let unit = |a: [f64; 3]| a.map(|x| x / norm(a));
    let e1 = unit(sub(head, tail));
    let up = sub(apex, tail);
    let along = dot(up, e1);
    let e2 = unit(sub(up, scale(e1, along)));
    let found = [dot(vector, e1), dot(vector, e2)];
    found.iter().all(|x| x.is_finite()).then_some(found)
}

/// The next half-edge from the tail of `h`, counter-clockwise.
fn next_around(mesh: &Mesh, h: HalfEdgeId) -> Option<HalfEdgeId> {
    mesh.twin(h.prev())
}

impl Heading {
    /// The length of the ray in its face, and where it leaves the face.
    fn leave(&self, mesh: &Mesh) -> (f64, LineExit) {
        let Self { h, from, direction } = *self;
        let sides = [h, h.next(), h.prev()];
        let corners = [[0.0; 2], [mesh.length(h), 0.0], mesh.apex(h)];
        let longest = sides.map(|side| mesh.length(side)).into_iter();
        let snap = SNAP * longest.fold(0.0, f64::max);
        let ways = corners.map(|corner| dot(sub(corner, from), direction));
        let offs = corners.map(|corner| cross_2d(direction, sub(corner, from)));
        let ahead = (0..3).filter(|&k| ways[k] > snap);
        let hit = ahead.clone().filter(|&k| offs[k].abs() <= snap);
        if let Some(k) = hit.min_by(|&a, &b| ways[a].total_cmp(&ways[b])) {
            return (ways[k], LineExit::Vertex(sides[k]));
        }
        for k in 0..3 {
            let next = (k + 1) % 3;
            if offs[k] < 0.0 && offs[next] > 0.0 {
                let t = offs[k] / (offs[k] - offs[next]);
                let way = (1.0 - t) * ways[k] + t * ways[next];
                return (way.max(0.0), LineExit::Edge(sides[k], t));
            }
        }
        // By rounding the ray leaves no side: it passes beside a corner of a thin face.
        let nearest = ahead.min_by(|&a, &b| offs[a].abs().total_cmp(&offs[b].abs()));
        let k = nearest.unwrap_or(0);
        (ways[k].max(0.0), LineExit::Vertex(sides[k]))
    }

    /// The direction in the frame of another half-edge of the face.
    fn direction_from(&self, mesh: &Mesh, h: HalfEdgeId) -> [f64; 2] {
        let corners = [[0.0; 2], [mesh.length(self.h), 0.0], mesh.apex(self.h)];
        let k = (0..3).find(|&k| [self.h, self.h.next(), self.h.prev()][k] == h);
        let k = k.unwrap_or(0);
        let along = unit(sub(corners[(k + 1) % 3], corners[k]));
        [dot(along, self.direction), cross_2d(along, self.direction)]
    }

    /// The ray in the face behind `h`, which it leaves at `t`; `None` at the boundary.
    fn across(&self, mesh: &Mesh, h: HalfEdgeId, t: f64) -> Option<Self> {
        let twin = mesh.twin(h)?;
        let [x, y] = self.direction_from(mesh, h);
        Some(Self {
            h: twin,
            from: [(1.0 - t) * mesh.length(twin), 0.0],
            direction: unit([-x, (-y).max(0.0)]),
        })
    }

    /// The ray that goes on at the tail of `h`, a half-edge of the face, with equal angles on both
    /// sides; `None` at the boundary.
    fn around_vertex(&self, mesh: &Mesh, h: HalfEdgeId) -> Option<Self> {
        let [x, y] = self.direction_from(mesh, h);
        let mut all = mesh.corner_angle(h);
        let mut at = next_around(mesh, h)?;
        while at != h {
            all += mesh.corner_angle(at);
            at = next_around(mesh, at)?;
        }
        // Counter-clockwise from the way back.
        let mut angle = libm::atan2(-y, -x).clamp(0.0, mesh.corner_angle(h)) + 0.5 * all;
        let mut at = h;
        while angle > mesh.corner_angle(at) {
            angle -= mesh.corner_angle(at);
            at = next_around(mesh, at)?;
        }
        Some(Self {
            h: at,
            from: [0.0; 2],
            direction: [libm::cos(angle), libm::sin(angle)],
        })
    }

    /// The point of the face after this length.
    fn end(&self, mesh: &Mesh, length: f64) -> Point {
        let Self { h, from, direction } = *self;
        let [x, y] = [0, 1].map(|k| from[k] + length * direction[k]);
        let (l, apex) = (mesh.length(h), mesh.apex(h));
        let up = (y / apex[1]).clamp(0.0, 1.0);
        let along = ((x - up * apex[0]) / l).clamp(0.0, 1.0 - up);
        let mut weights = [0.0; 3];
        let corner = h.corner() as usize;
        weights[corner] = 1.0 - up - along;
        weights[(corner + 1) % 3] = along;
        weights[(corner + 2) % 3] = up;
        match mesh.point_in_face(h.face(), weights) {
            Ok(point) => Point::of(mesh, &point),
            Err(_) => Point {
                place: PathPlace::Face,
                face: Some(h.face()),
                barycentric: weights,
            },
        }
    }
}

/// The line in the direction at `angle`, in normalised angles from the first sector on.
#[cfg(test)]
pub(crate) fn line_at(
    mesh: &Mesh,
    start: &SurfacePoint,
    angle: f64,
    length: f64,
) -> Result<Path, LineError> {
    use std::f64::consts::TAU;

    let sectors = sectors(mesh, start);
    let all: f64 = sectors.iter().filter_map(|sector| sector.angle).sum();
    let mut angle = if all > 0.0 {
        angle.rem_euclid(TAU) * all / TAU
    } else {
        angle
    };
    for Sector {
        h,
        from,
        angle: own,
    } in sectors
    {
        if own.is_none_or(|own| angle <= own) {
            let direction = [libm::cos(angle), libm::sin(angle)];
            return follow(mesh, start, Heading { h, from, direction }, length);
        }
        angle -= own.unwrap_or(0.0);
    }
    Err(LineError::NoFace)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use geobench_mesh::FaceId;

    use super::*;

    fn ends(mesh: &Mesh, path: &Path) -> [[f64; 3]; 2] {
        let positions = path.polyline(mesh);
        [positions[0], positions[positions.len() - 1]]
    }

    fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
        (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
    }

    fn length(mesh: &Mesh, path: &Path) -> f64 {
        let positions = path.polyline(mesh);
        positions
            .windows(2)
            .map(|pair| apart(pair[0], pair[1]))
            .sum()
    }

    #[test]
    fn lines_of_the_plane_are_straight_and_end_at_its_border() {
        let grid = Mesh::generate("grid,n=10,jitter=0.2,seed=4").unwrap();
        let [low, high] = grid.bounding_box().unwrap();
        for i in 0..40 {
            let angle = 0.16 * f64::from(i);
            let direction = [angle.cos(), angle.sin(), 0.5];
            let at = [0, 1].map(|k| low[k] + (high[k] - low[k]) * (0.3 + 0.01 * f64::from(i)));
            let start = if i % 3 == 0 {
                SurfacePoint::from(VertexId::new(60))
            } else {
                grid.nearest_point([at[0], at[1], 0.0]).unwrap().0
            };
            for wanted in [0.0, 0.37, 2.9, 100.0, 1e300] {
                let path = line(&grid, &start, direction, wanted).unwrap();
                let [first, last] = ends(&grid, &path);
                let end = [0, 1].map(|k| first[k] + path.length * [angle.cos(), angle.sin()][k]);
                assert!(apart(last, [end[0], end[1], 0.0]) < 1e-9, "{i} {wanted}");
                let at_border =
                    (0..2).any(|k| (last[k] - low[k]).abs().min((last[k] - high[k]).abs()) < 1e-9);
                assert!(path.length == wanted || at_border, "{i} {wanted}: {last:?}");
                assert!((length(&grid, &path) - path.length).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_line_around_a_cube_closes() {
        for n in [1, 3, 4] {
            let cube = Mesh::generate(&format!("cube,n={n}")).unwrap();
            for [x, direction] in [[0.3, 0.0], [0.5, 0.0], [0.25, 1.0]] {
                // At right angles around four faces; in a diagonal around six.
                let (direction, around) = if direction == 0.0 {
                    ([1.0, 0.0, 0.0], 4.0)
                } else {
                    ([1.0, 1.0, 0.0], 18.0_f64.sqrt())
                };
                let (start, off) = cube.nearest_point([0.5, x, 1.0]).unwrap();
                let top = cube.bounding_box().unwrap()[1][2];
                assert!((off - (1.0 - top)).abs() < 1e-12);
                let path = line(&cube, &start, direction, around).unwrap();
                let [first, last] = ends(&cube, &path);
                assert!(apart(first, last) < 1e-9, "{n} {x}: {first:?} {last:?}");
                assert_eq!(path.length, around);
            }
        }
    }

    #[test]
    fn vertices_halve_the_angle() {
        // At the tip of a cone, the line back to the start is as far to the left as to the right:
        // half of the angle of the cone on both sides.
        for slices in [3, 4, 7, 48] {
            for angle in [60, 180, 300] {
                let cone = format!("cone,angle={angle},slices={slices},stacks=4");
                let cone = Mesh::generate(&cone).unwrap();
                let tip = VertexId::new(0);
                let start = cone.outgoing(tip)[0];
                let weights = [0.2, 0.5, 0.3];
                let corner = start.corner() as usize;
                let mut placed = [0.0; 3];
                (0..3).for_each(|k| placed[(corner + k) % 3] = weights[k]);
                let start = cone.point_in_face(start.face(), placed).unwrap();
                let [from, to] = [
                    cone.position_of(&start).unwrap(),
                    cone.positions()[tip.index()],
                ];
                let direction = [0, 1, 2].map(|k| to[k] - from[k]);
                let before = apart(from, to);
                let path = line(&cone, &start, direction, before + 0.1 * before).unwrap();
                assert_eq!(path.points[1].vertex(), Some(tip));
                let last = path.points[2];
                let back = |point: &Point| {
                    let face = point.face.unwrap();
                    let h = (0..3)
                        .map(|k| face.half_edge(k))
                        .find(|&h| cone.tail(h) == tip);
                    let h = h.unwrap();
                    let corner = h.corner() as usize;
                    let [one, up] = [1, 2].map(|k| point.barycentric[(corner + k) % 3]);
                    let apex = cone.apex(h);
                    let within = libm::atan2(up * apex[1], one * cone.length(h) + up * apex[0]);
                    let around = cone.outgoing(tip).iter().take_while(|&&other| other != h);
                    around.map(|&h| cone.corner_angle(h)).sum::<f64>() + within
                };
                let turned = (back(&last) - back(&path.points[0])).abs();
                let half = 0.5 * cone.total_angle(tip);
                assert!(
                    (turned - half).abs() < 1e-9,
                    "{slices} {angle}: {turned} {half}"
                );
            }
        }
    }

    #[test]
    fn great_circles_nearly_close() {
        let sphere = Mesh::generate("sphere,subdiv=5").unwrap();
        let start = sphere.nearest_point([0.3, 0.5, 0.6]).unwrap().0;
        let path = line(&sphere, &start, [1.0, -0.2, 0.1], 2.0 * PI).unwrap();
        let [first, last] = ends(&sphere, &path);
        assert!(apart(first, last) < 0.02, "{first:?} {last:?}");
        // All its points are near the plane of the circle.
        let positions = path.polyline(&sphere);
        let middle = positions[positions.len() / 4];
        let normal = [
            first[1] * middle[2] - first[2] * middle[1],
            first[2] * middle[0] - first[0] * middle[2],
            first[0] * middle[1] - first[1] * middle[0],
        ];
        let off = |p: &[f64; 3]| (0..3).map(|k| p[k] * normal[k]).sum::<f64>().abs();
        assert!(positions.iter().all(|p| off(p) < 0.02));
    }

    #[test]
    fn a_line_can_be_retraced() {
        let torus = Mesh::generate("torus,faces=2000,bump=0.2,seed=3").unwrap();
        for face in (0..2000).step_by(171) {
            let start = torus
                .point_in_face(FaceId::new(face), [0.2, 0.3, 0.5])
                .unwrap();
            let there = line(&torus, &start, [0.3, -0.8, 0.5], 1.5).unwrap();
            let [first, last] = ends(&torus, &there);
            let before = there.polyline(&torus)[there.points.len() - 2];
            let end = there.points[there.points.len() - 1];
            let end = torus.point_in_face(end.face.unwrap(), end.barycentric);
            let back = [0, 1, 2].map(|k| before[k] - last[k]);
            let back = line(&torus, &end.unwrap(), back, 1.5).unwrap();
            assert!(apart(ends(&torus, &back)[1], first) < 1e-7, "{face}");
        }
    }

    #[test]
    fn invalid_directions_and_lengths_are_errors() {
        let grid = Mesh::generate("grid,n=2").unwrap();
        let start = grid.point_in_face(0.into(), [0.2, 0.3, 0.5]).unwrap();
        let fails = |direction, length| line(&grid, &start, direction, length).unwrap_err();
        for length in [-1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                fails([1.0, 0.0, 0.0], length),
                LineError::Length { .. }
            ));
        }
        for direction in [[0.0; 3], [0.0, 0.0, 1.0], [f64::NAN, 0.0, 0.0]] {
            assert!(matches!(fails(direction, 1.0), LineError::Direction { .. }));
        }
        let start = SurfacePoint::from(VertexId::new(99));
        assert_eq!(
            line(&grid, &start, [1.0, 0.0, 0.0], 1.0),
            Err(LineError::NoFace)
        );
    }
}
