//! Upper bounds of the lengths of paths.

use geobench_mesh::{Mesh, VertexId};

use crate::ball::{self, Ball, BallVector, dot};
use crate::interval::{Interval, IntervalVector, minus, norm};

/// A point of a path.
///
/// ```
/// use geobench_certify::{Claim, PathPoint};
/// use geobench_mesh::{Mesh, VertexId};
///
/// // A unit square: from corner 1 to corner 3 across the middle of the diagonal.
/// let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(positions, vec![[0, 1, 2], [0, 2, 3]])?;
/// let [a, b, c, d] = [0, 1, 2, 3].map(VertexId::new);
/// let source = [b];
/// let path = |v| {
///     let mut points = vec![PathPoint::Vertex(b)];
///     if v == d {
///         points.push(PathPoint::Edge([a, c], 0.5));
///     }
///     points.push(PathPoint::Vertex(v));
///     Some(points)
/// };
/// let distances = [1.0, 0.0, 1.0, 2.0_f64.sqrt()];
/// let claim = Claim::new(&mesh, &source, &distances)?;
/// assert!(claim.not_too_short(path).relative < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PathPoint {
    /// A vertex.
    Vertex(VertexId),
    /// A point of the edge between two vertices. The number is its position, from 0 at the first
    /// vertex to 1 at the second.
    Edge([VertexId; 2], f64),
}

impl PathPoint {
    fn position(self, mesh: &Mesh) -> Option<IntervalVector<3>> {
        let of = |v: VertexId| Some(mesh.positions().get(v.index())?.map(Interval::exact));
        match self {
            Self::Vertex(v) => of(v),
            Self::Edge([a, b], part) => {
                let part = (0.0..=1.0)
                    .contains(&part)
                    .then_some(Interval::exact(part))?;
                let (a, b) = (of(a)?, of(b)?);
                let along = minus(b, a);
                Some(std::array::from_fn(|i| a[i] + along[i] * part))
            }
        }
    }

    /// The vertices between which it lies.
    fn ends(self) -> [VertexId; 2] {
        match self {
            Self::Vertex(v) => [v, v],
            Self::Edge(ends, _) => ends,
        }
    }

    /// Whether some face contains both points. Takes time proportional to the least degree of the
    /// vertices between which they lie.
    fn shares_face(self, mesh: &Mesh, other: Self) -> bool {
        let ends = [self.ends(), other.ends()];
        let fewest = ends.iter().flatten();
        let fewest = fewest.min_by_key(|v| mesh.outgoing(**v).len());
        fewest.is_some_and(|&v| {
            mesh.outgoing(v).iter().any(|h| {
                let corners = mesh.face_vertices(h.face());
                ends.iter().flatten().all(|v| corners.contains(v))
            })
        })
    }
}

/// The first vertex of the path through these points, and an upper bound of its length. `None` if
/// the path does not begin at a vertex and end at `target`, or leaves the surface.
pub(crate) fn greatest_length(
    mesh: &Mesh,
    points: &[PathPoint],
    target: VertexId,
) -> Option<(VertexId, f64)> {
    let &PathPoint::Vertex(start) = points.first()? else {
        return None;
    };
    if points.last()? != &PathPoint::Vertex(target) {
        return None;
    }
    let mut length = Interval::ZERO;
    let mut before = points[0].position(mesh)?;
    for pair in points.windows(2) {
        let here = pair[1].position(mesh)?;
        if !pair[0].shares_face(mesh, pair[1]) {
            return None;
        }
        length = length + norm(minus(here, before));
        before = here;
    }
    Some((start, length.hi))
}

/// Sweeps that move the points of a path.
const SWEEPS: usize = 20;

/// An upper bound of the length of a path along which `points` are moved on their edges, to where
/// it is shorter. For points of which [`greatest_length`] finds a length.
///
/// A position on an edge that is far longer than the path has no place in an `f64`: rounding moves
/// the point by more than the path is long. Here it is a double-double. Any position makes a valid
/// path, so nothing is assumed of how it was found.
pub(crate) fn least_length(mesh: &Mesh, points: &[PathPoint]) -> f64 {
    let of = |v: VertexId| mesh.positions()[v.index()].map(Ball::exact);
    let mut places: Vec<BallVector<3>> = Vec::with_capacity(points.len());
    for &point in points {
        let [a, b] = point.ends().map(of);
        places.push(match point {
            PathPoint::Vertex(_) => a,
            PathPoint::Edge(_, part) => on_edge([a, b], Ball::exact(part)),
        });
    }
    let length = |places: &[BallVector<3>]| {
        let steps = places
            .windows(2)
            .map(|pair| ball::norm(ball::minus(pair[1], pair[0])));
        steps.fold(Ball::ZERO, |sum, step| sum + step).upper()
    };
    let mut least = length(&places);
    for _ in 0..SWEEPS {
        for i in 1..points.len() - 1 {
            if matches!(points[i], PathPoint::Edge(..)) {
                let ends = points[i].ends().map(of);
                if let Some(part) = crossing(ends, places[i - 1], places[i + 1]) {
                    places[i] = on_edge(ends, part);
                }
            }
        }
        let found = length(&places);
        // Rounding is harmless here.
        if found.is_nan() || found >= least * (1.0 - 1e-15) {
            break;
        }
        least = found;
    }
    least
}

fn on_edge([a, b]: [BallVector<3>; 2], part: Ball) -> BallVector<3> {
    let along = ball::minus(b, a);
    std::array::from_fn(|i| a[i] + along[i] * part)
}

/// Where the shortest path between two points crosses the line through `ends`, in a plane into
/// which the faces on either side are unfolded: from 0 at the first end to 1 at the second, and
/// never beyond.
fn crossing(ends: [BallVector<3>; 2], from: BallVector<3>, to: BallVector<3>) -> Option<Ball> {
    let along = ball::minus(ends[1], ends[0]);
    let square = dot(along, along);
    // The part along the line and the distance from the line.
    let [(part_from, from), (part_to, to)] = [from, to].map(|point| {
        let offset = ball::minus(point, ends[0]);
        let part = dot(offset, along) / square;
        let across = std::array::from_fn(|i| offset[i] - along[i] * part);
        (part, ball::norm::<3>(across))
    });
    let part = ((part_from * to + part_to * from) / (from + to)).without_error();
    if part.middle().is_nan() {
        return None;
    }
    Some(if part.lower() < 0.0 {
        Ball::ZERO
    } else if part.upper() > 1.0 {
        Ball::exact(1.0)
    } else {
        part
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Mesh {
        let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        Mesh::new(positions, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
    }

    #[test]
    fn a_path_across_an_edge_has_its_length() {
        let [a, b, c, d] = [0, 1, 2, 3].map(VertexId::new);
        let middle = PathPoint::Edge([a, c], 0.5);
        let points = [PathPoint::Vertex(b), middle, PathPoint::Vertex(d)];
        let (start, length) = greatest_length(&square(), &points, d).unwrap();
        assert_eq!(start, b);
        assert!(length >= 2.0_f64.sqrt() && length < 2.0_f64.sqrt() + 1e-14);
    }

    /// A path of 1e-9 across an edge of 1e6.
    #[test]
    fn points_on_a_long_edge_are_placed_below_rounding() {
        let positions = vec![
            [0.0; 3],
            [1e6, 1e6, 0.0],
            [3e5, 3e5 - 1e-9, 0.0],
            [3e5, 3e5 + 1e-9, 0.0],
        ];
        let distance = positions[3][1] - positions[2][1];
        let mesh = Mesh::new(positions, vec![[0, 2, 1], [0, 1, 3]]).unwrap();
        let [a, b, c, d] = [0, 1, 2, 3].map(VertexId::new);
        let points = [
            PathPoint::Vertex(c),
            PathPoint::Edge([a, b], 0.3),
            PathPoint::Vertex(d),
        ];
        let (_, rounded) = greatest_length(&mesh, &points, d).unwrap();
        let found = least_length(&mesh, &points);
        assert!(rounded > distance * (1.0 + 1e-6), "{rounded}");
        assert!(
            found >= distance && found < distance * (1.0 + 1e-12),
            "{found}"
        );
    }

    #[test]
    fn paths_that_leave_the_surface_have_no_length() {
        let [a, b, c, d] = [0, 1, 2, 3].map(VertexId::new);
        let [from, to] = [b, d].map(PathPoint::Vertex);
        let none = |points: &[PathPoint]| {
            assert_eq!(greatest_length(&square(), points, d), None);
        };
        none(&[from, to]); // Through the air: no face has both.
        none(&[from, PathPoint::Edge([a, c], 1.5), to]);
        none(&[from, PathPoint::Edge([b, d], 0.5), to]);
        none(&[from, PathPoint::Edge([a, VertexId::new(9)], 0.5), to]);
        none(&[PathPoint::Edge([a, b], 0.5), PathPoint::Vertex(c), to]); // Not from a vertex.
        none(&[from, PathPoint::Vertex(c)]); // Not to the target.
        none(&[]);
    }
}
