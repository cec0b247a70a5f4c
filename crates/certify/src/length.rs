//! Upper bounds of the lengths of paths.

use std::collections::HashSet;

use geobench_mesh::{Mesh, VertexId};

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

/// An upper bound of the length of the path through these points. `None` if the path does not begin
/// at one of `sources` and end at `target`, or leaves the surface.
pub(crate) fn greatest_length(
    mesh: &Mesh,
    points: &[PathPoint],
    sources: &HashSet<VertexId>,
    target: VertexId,
) -> Option<f64> {
    let starts = matches!(points.first()?, PathPoint::Vertex(v) if sources.contains(v));
    let ends = points.last()? == &PathPoint::Vertex(target);
    if !starts || !ends {
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
    Some(length.hi)
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
        let length = greatest_length(&square(), &points, &HashSet::from([b]), d).unwrap();
        assert!(length >= 2.0_f64.sqrt() && length < 2.0_f64.sqrt() + 1e-14);
    }

    #[test]
    fn what_leaves_the_surface_is_no_path() {
        let [a, b, c, d] = [0, 1, 2, 3].map(VertexId::new);
        let [from, to] = [b, d].map(PathPoint::Vertex);
        let none = |points: &[PathPoint]| {
            assert_eq!(
                greatest_length(&square(), points, &HashSet::from([b]), d),
                None
            );
        };
        none(&[from, to]); // Through the air: no face has both.
        none(&[from, PathPoint::Edge([a, c], 1.5), to]);
        none(&[from, PathPoint::Edge([b, d], 0.5), to]);
        none(&[from, PathPoint::Edge([a, VertexId::new(9)], 0.5), to]);
        none(&[PathPoint::Vertex(a), to]); // Not from the source.
        none(&[from, PathPoint::Vertex(c)]); // Not to the target.
        none(&[]);
    }
}
