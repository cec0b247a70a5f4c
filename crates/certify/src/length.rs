//! Upper bounds of the lengths of paths.

use geobench_mesh::{HalfEdgeId, Mesh, VertexId};

use crate::interval::{Interval, Vector, minus, norm};

/// A point of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PathPoint {
    /// A vertex.
    Vertex(VertexId),
    /// The point of an edge that divides it in this ratio from the tail of the half-edge: 0 is the
    /// tail, 1 the head.
    Edge(HalfEdgeId, f64),
}

impl PathPoint {
    fn position(self, mesh: &Mesh) -> Option<Vector<3>> {
        let of = |v: VertexId| mesh.positions()[v.index()].map(Interval::exact);
        match self {
            Self::Vertex(v) => Some(of(v)),
            Self::Edge(h, ratio) => {
                let ratio = (0.0..=1.0)
                    .contains(&ratio)
                    .then_some(Interval::exact(ratio))?;
                let (tail, head) = (of(mesh.tail(h)), of(mesh.head(h)));
                let along = minus(head, tail);
                Some(std::array::from_fn(|i| tail[i] + along[i] * ratio))
            }
        }
    }

    /// Whether a face has both points.
    fn shares_face(self, mesh: &Mesh, other: Self) -> bool {
        let has = |corners: &[VertexId; 3], point: Self| match point {
            Self::Vertex(v) => corners.contains(&v),
            Self::Edge(h, _) => corners.contains(&mesh.tail(h)) && corners.contains(&mesh.head(h)),
        };
        let faces = |point: Self| -> Vec<HalfEdgeId> {
            match point {
                Self::Vertex(v) => mesh.outgoing(v).to_vec(),
                Self::Edge(h, _) => [Some(h), mesh.twin(h)].into_iter().flatten().collect(),
            }
        };
        faces(self)
            .into_iter()
            .any(|h| has(&mesh.face_vertices(h.face()), other))
    }
}

/// An upper bound of the length of the path over these points, which begins at one of `sources`
/// and ends at `target`; `None` if it is no such path, or leaves the surface.
pub(crate) fn greatest_length(
    mesh: &Mesh,
    points: &[PathPoint],
    sources: &[VertexId],
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
        if !pair[0].shares_face(mesh, pair[1]) {
            return None;
        }
        let here = pair[1].position(mesh)?;
        length = length + norm(minus(here, before));
        before = here;
    }
    Some(length.hi)
}
