//! Circular arcs inside faces.

use std::f64::consts::PI;

use geobench_mesh::{FaceId, Mesh};

use crate::cones::corners;
use geobench_mesh::vector::{Point, add, cross_2d, dot, nearest_on_segment, norm, sub};

/// Tolerance within which the centres, the radii and the ends of two arcs of one circle agree,
/// relative to the radius and the coordinates.
const SAME: f64 = 1e-11;

/// The minimum number of chords of a full circle.
const CHORDS: f64 = 12.0;

/// A counter-clockwise arc of a circle in a face. Points nearer to the source are on its left.
///
/// Coordinates are in the plane of the face. The first corner is the origin, the second has a
/// positive abscissa and the ordinate 0, and the third has a positive ordinate.
///
/// ```
/// use geobench_isolines::DistanceField;
/// use geobench_mesh::{Mesh, VertexId};
///
/// let mesh = Mesh::generate("sphere,subdiv=3")?;
/// let pole = mesh.point_at_vertex(VertexId::new(0))?;
/// let isoline = DistanceField::new(&mesh, &[pole])?.isoline(0.5);
/// for arc in &isoline.lines[0].arcs {
///     assert!((arc.length() - arc.radius * arc.angle()).abs() < 1e-15);
///     assert!(arc.points(1e-6).iter().all(|&at| arc.position(&mesh, at).is_some()));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CircleArc {
    /// The face.
    pub face: FaceId,
    /// The image of the source, or of the last vertex at which paths turn, the pseudo-source.
    pub centre: [f64; 2],
    /// The radius, in units of the mesh.
    pub radius: f64,
    /// Its start and its end.
    pub ends: [[f64; 2]; 2],
}

impl CircleArc {
    pub(crate) fn new(face: FaceId, ends: [Point; 2], centre: Point) -> Self {
        Self {
            face,
            centre,
            radius: f64::midpoint(norm(sub(ends[0], centre)), norm(sub(ends[1], centre))),
            ends,
        }
    }

    /// The angle that it spans at the centre, in radians. Arcs of isolines span at most π up to
    /// rounding; the result is between 0 and 1.5π.
    pub fn angle(&self) -> f64 {
        let [from, to] = self.ends.map(|end| sub(end, self.centre));
        let angle = libm::atan2(cross_2d(from, to), dot(from, to));
        // An arc spans at most half a circle. Rounding can make the angle of a half circle
        // slightly more than π, and that of a very short arc negative.
        if angle < -0.5 * PI {
            angle + 2.0 * PI
        } else {
            angle.max(0.0)
        }
    }

    /// Its length, in the units of the mesh.
    pub fn length(&self) -> f64 {
        self.radius * self.angle()
    }

    pub(crate) fn has_length(&self) -> bool {
        self.ends[0] != self.ends[1]
    }

    /// Points along the arc, from its start to its end. The chords between them deviate from the
    /// arc by at most `tolerance`, and a full circle would have at least 12. Chords span at least
    /// about 1e-4 radians, so a tolerance below 1.25e-9 of the radius is not met.
    pub fn points(&self, tolerance: f64) -> Vec<[f64; 2]> {
        let angle = self.angle();
        // A chord over the angle 2a deviates from the arc by r (1 - cos a).
        let half = libm::acos((1.0 - tolerance / self.radius).clamp(-1.0, 1.0));
        let chord = (2.0 * half).clamp(1e-4, 2.0 * PI / CHORDS);
        let parts = (angle / chord).ceil().max(1.0);
        let mut points = vec![self.ends[0]];
        let from = sub(self.ends[0], self.centre);
        for i in (1_u32..).map(f64::from).take_while(|&i| i < parts) {
            let (sin, cos) = libm::sincos(angle * i / parts);
            let spoke = [cos * from[0] - sin * from[1], sin * from[0] + cos * from[1]];
            points.push(add(self.centre, spoke));
        }
        points.push(self.ends[1]);
        points
    }

    /// The barycentric coordinates in the face of a point of its plane. A point outside the face,
    /// for example due to rounding, gets those of the nearest point of the face.
    pub fn barycentric(&self, mesh: &Mesh, at: [f64; 2]) -> [f64; 3] {
        let corners = corners(mesh, self.face);
        let [_, [l, _], [x, y]] = corners;
        let third = at[1] / y;
        let second = (at[0] - third * x) / l;
        let inside = [1.0 - second - third, second, third];
        if inside.iter().all(|&w| w >= 0.0) {
            return inside;
        }
        let mut nearest = (f64::INFINITY, [1.0, 0.0, 0.0]);
        for k in 0..3 {
            let side = [corners[k], corners[(k + 1) % 3]];
            let (off, t) = nearest_on_segment(at, side);
            if off < nearest.0 {
                let mut weights = [0.0; 3];
                weights[k] = 1.0 - t;
                weights[(k + 1) % 3] = t;
                nearest = (off, weights);
            }
        }
        nearest.1
    }

    /// The position in space of a point of the plane; `None` for a mesh without positions.
    pub fn position(&self, mesh: &Mesh, at: [f64; 2]) -> Option<[f64; 3]> {
        let weights = self.barycentric(mesh, at);
        let mut sum = [0.0; 3];
        for (v, weight) in mesh.face_vertices(self.face).into_iter().zip(weights) {
            let p = mesh.positions().get(v.index())?;
            (0..3).for_each(|k| sum[k] += weight * p[k]);
        }
        Some(sum)
    }

    /// The union of both arcs, if `next` continues this one on the same circle and the union is
    /// shorter than half a circle.
    fn with(&self, next: &Self) -> Option<Self> {
        let slack = SAME * (self.radius + norm(self.centre) + 1e-3 * next.radius);
        let is_same = self.face == next.face
            && norm(sub(self.centre, next.centre)) <= slack
            && (self.radius - next.radius).abs() <= slack
            && norm(sub(self.ends[1], next.ends[0])) <= slack
            && self.angle() + next.angle() < 0.99 * PI;
        is_same.then(|| Self {
            ends: [self.ends[0], next.ends[1]],
            ..*self
        })
    }
}

/// Merges consecutive arcs that continue each other on one circle in one face, the last with the
/// first too if the line is closed. Splitting faces at sources divides such arcs.
pub(crate) fn joined(arcs: Vec<CircleArc>, closed: bool) -> Vec<CircleArc> {
    let mut all: Vec<CircleArc> = Vec::with_capacity(arcs.len());
    for arc in arcs {
        match all
            .last_mut()
            .and_then(|last| Some((last.with(&arc)?, last)))
        {
            Some((both, last)) => *last = both,
            None => all.push(arc),
        }
    }
    if closed
        && let [first, .., last] = all[..]
        && let Some(both) = last.with(&first)
    {
        all[0] = both;
        all.pop();
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use geobench_mesh::vector::scale;

    fn arc(angles: [f64; 2]) -> CircleArc {
        let at = |angle: f64| [1.0 + 3.0 * angle.cos(), 2.0 + 3.0 * angle.sin()];
        CircleArc::new(FaceId::new(0), angles.map(at), [1.0, 2.0])
    }

    #[test]
    fn chords_are_within_the_tolerance() {
        for tolerance in [1e-6, 1e-3, 0.1, 100.0] {
            let arc = arc([0.5, 3.0]);
            assert!((arc.length() - 7.5).abs() < 1e-14);
            let points = arc.points(tolerance);
            for pair in points.windows(2) {
                let middle = scale(add(pair[0], pair[1]), 0.5);
                let off = 3.0 - norm(sub(middle, arc.centre));
                assert!(off >= 0.0 && off <= tolerance * 1.0001, "{off}");
            }
            assert!(points.len() >= 5);
        }
    }

    #[test]
    fn arcs_of_one_circle_are_one() {
        let arcs = vec![arc([0.0, 1.0]), arc([1.0, 2.0]), arc([2.5, 3.0])];
        let all = joined(arcs, false);
        assert_eq!(all.len(), 2);
        assert!((all[0].angle() - 2.0).abs() < 1e-14);
        // Not merged: the ends do not determine the angle of an arc of more than half a circle.
        let all = joined(vec![arc([0.0, 2.0]), arc([2.0, 4.0])], false);
        assert_eq!(all.len(), 2);
    }
}
