//! Turns around a vertex, from one direction to another.

use std::collections::HashMap;
use std::f64::consts::PI;

use geobench_mesh::{HalfEdgeId, Mesh, VertexId};

use crate::lines::{LineDirection, PLACE};

/// Greatest rounding of the place where a path bends, as a fraction of the pieces that meet there.
pub(crate) const BEND: f64 = 1e-12;

/// A passage from one face into another across their common edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct EdgeCrossing {
    /// The half-edge of the edge in the face that is left.
    pub(crate) from: HalfEdgeId,
    /// The half-edge of the edge in the face that is entered.
    pub(crate) to: HalfEdgeId,
}

impl EdgeCrossing {
    /// Whether `v` is an end of the edge.
    pub(crate) fn touches(self, mesh: &Mesh, v: VertexId) -> bool {
        mesh.tail(self.from) == v || mesh.head(self.from) == v
    }
}

/// A turn around a vertex from edge to edge, within faces.
#[derive(Clone, Debug)]
pub(crate) struct SideTurn {
    /// Infinite if no way leads from one direction to the other.
    pub(crate) angle: f64,
    /// The edges that are crossed on the way.
    pub(crate) crossings: Vec<EdgeCrossing>,
}

/// How an edge at a vertex is reached.
#[derive(Clone, Copy)]
struct ReachedEdge {
    /// The angle from the first direction.
    angle: f64,
    /// The corner through which the last part of the turn leads: its half-edge at the vertex.
    corner: HalfEdgeId,
    /// The edge before, by its other end; `None` if the turn starts in `corner`.
    before: Option<VertexId>,
}

impl SideTurn {
    /// The least turn at `v` from direction `a` to `b`.
    ///
    /// Turns lead around `v` on either side of a vertex inside the surface, on one side at the
    /// boundary, and from an edge of several faces into each of them. If no turn leads from one to
    /// the other, a path may bend at `v` anyhow.
    pub(crate) fn least(mesh: &Mesh, v: VertexId, [a, b]: [LineDirection; 2]) -> Self {
        let reached = reached_edges(mesh, v, a);
        let ([first, second], angle) = sides_of(mesh, b.corner);
        let ends = [(first, b.angle), (second, angle - b.angle)].into_iter();
        let by_edges = ends.filter_map(|(edge, angle)| {
            let reached = reached.get(&edge)?;
            Some((reached.angle + angle, Some(edge)))
        });
        let within = (a.corner == b.corner).then_some(((a.angle - b.angle).abs(), None));
        let least = by_edges.chain(within).min_by(|a, b| a.0.total_cmp(&b.0));
        let (angle, mut edge) = least.unwrap_or((f64::INFINITY, None));
        let along = |corner: HalfEdgeId, edge: VertexId| {
            if mesh.head(corner) == edge {
                corner
            } else {
                corner.prev()
            }
        };
        let mut crossings = Vec::new();
        let mut into = b.corner;
        while let Some((end, at)) = edge.and_then(|end| Some((end, reached.get(&end)?))) {
            if at.corner != into {
                let [from, to] = [at.corner, into].map(|corner| along(corner, end));
                crossings.push(EdgeCrossing { from, to });
            }
            (into, edge) = (at.corner, at.before);
        }
        crossings.reverse();
        Self { angle, crossings }
    }

    /// Whether a path is straight where it takes this turn at `v`, between pieces of these lengths,
    /// up to a `bend` as a fraction of them: no shortcut exists on either side.
    pub(crate) fn is_straight(
        &self,
        mesh: &Mesh,
        v: VertexId,
        lengths: [f64; 2],
        bend: f64,
    ) -> bool {
        let longest = mesh.neighbours(v).map(|(_, length)| length);
        let longest = longest.fold(0.0, f64::max);
        let [a, b] = lengths;
        (PI - self.angle) * a.min(b) <= bend * (a + b) + PLACE * longest
    }
}

/// The edges on both sides of a corner, each named by its other end, and the angle between.
fn sides_of(mesh: &Mesh, corner: HalfEdgeId) -> ([VertexId; 2], f64) {
    let ends = [mesh.head(corner), mesh.apex_vertex(corner)];
    (ends, mesh.corner_angle(corner))
}

/// How the edges at `v`, each named by its other end, are reached by the least turn from a
/// direction. Edges to which no turn leads are left out.
fn reached_edges(
    mesh: &Mesh,
    v: VertexId,
    direction: LineDirection,
) -> HashMap<VertexId, ReachedEdge> {
    let corners: Vec<_> = (mesh.outgoing(v).iter())
        .map(|&corner| (corner, sides_of(mesh, corner)))
        .collect();
    let mut reached: HashMap<VertexId, ReachedEdge> = HashMap::new();
    let LineDirection { corner, angle } = direction;
    let ([first, second], whole) = sides_of(mesh, corner);
    for (edge, angle) in [(first, angle), (second, whole - angle)] {
        let before = None;
        let start = ReachedEdge {
            angle,
            corner,
            before,
        };
        reached.insert(edge, start);
    }
    let mut is_done = false;
    while !is_done {
        is_done = true;
        // Once around in each direction is enough where no edge has more than two faces.
        for &(corner, ([first, second], angle)) in corners.iter().chain(corners.iter().rev()) {
            for [from, to] in [[first, second], [second, first]] {
                let known = |edge| reached.get(edge).map_or(f64::INFINITY, |r| r.angle);
                let angle = known(&from) + angle;
                if angle < known(&to) {
                    let before = Some(from);
                    let by_corner = ReachedEdge {
                        angle,
                        corner,
                        before,
                    };
                    reached.insert(to, by_corner);
                    is_done = false;
                }
            }
        }
    }
    reached
}
