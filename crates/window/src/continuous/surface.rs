//! The faces and what is known of the vertices during a run.

use geobench_mesh::{HalfEdgeId, Mesh, VertexId};

use crate::filter::{is_beaten_across, is_beaten_from_ends};
use crate::frame::Faces;
use crate::window::Window;

/// The faces of the mesh, with the distance that every vertex has been reached by so far.
#[derive(Clone, Debug)]
pub struct Surface {
    faces: Faces,
    distances: Vec<f64>,
    /// How often each distance has improved.
    stamps: Vec<u32>,
}

/// Which child of a crossing a window is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// It left through AC.
    Left,
    /// It left through CB.
    Right,
}

impl Surface {
    pub(super) fn new(mesh: &Mesh) -> Self {
        Self {
            faces: Faces::new(mesh),
            distances: Vec::new(),
            stamps: Vec::new(),
        }
    }

    pub(super) fn reset(&mut self, vertices: usize) {
        self.distances.clear();
        self.distances.resize(vertices, f64::INFINITY);
        self.stamps.clear();
        self.stamps.resize(vertices, 0);
    }

    pub(super) fn take_distances(&mut self) -> Vec<f64> {
        std::mem::take(&mut self.distances)
    }

    /// The faces of the mesh.
    #[inline]
    pub fn faces(&self) -> &Faces {
        &self.faces
    }

    /// Length of the shortest path to `v` found so far.
    #[inline]
    pub fn distance(&self, v: VertexId) -> f64 {
        self.distances[v.index()]
    }

    /// How often the distance of `v` has improved: a window that started from `v` at an earlier
    /// count starts from too long a path.
    #[inline]
    pub fn stamp(&self, v: VertexId) -> u32 {
        self.stamps[v.index()]
    }

    /// A path of length `d` reaches `v`; returns whether it is the shortest so far.
    #[inline]
    pub(super) fn offer(&mut self, v: VertexId, d: f64) -> bool {
        let known = &mut self.distances[v.index()];
        let improves = d < *known;
        if improves {
            *known = d;
            self.stamps[v.index()] += 1;
        }
        improves
    }

    /// The vertex filter on a window that arrives at `h`: whether a path through one of the
    /// vertices around beats all of it. `side` tells which child of a crossing it is; without it
    /// the third test, from the vertex behind the edge, is left out.
    #[inline]
    pub fn beats(&self, h: HalfEdgeId, w: &Window, side: Option<Side>) -> bool {
        let [tail, head, _] = self.faces.corners(h).map(|v| self.distances[v.index()]);
        is_beaten_from_ends(w, self.faces.length(h), tail, head)
            || side.is_some_and(|side| self.beats_from_behind(h, w, side))
    }

    #[inline]
    fn beats_from_behind(&self, h: HalfEdgeId, w: &Window, side: Side) -> bool {
        let Some(twin) = self.faces.twin(h) else {
            return false;
        };
        let [_, _, vertex] = self.faces.corners(twin);
        let end = match side {
            Side::Left => w.b0,
            Side::Right => w.b1,
        };
        is_beaten_across(
            w,
            end,
            self.faces.apex_below(twin),
            self.distances[vertex.index()],
        )
    }
}
