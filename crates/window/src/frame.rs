//! The frame of a half-edge, and the compact table from which frames are read.

use geobench_mesh::{HalfEdgeId, Mesh, VertexId};

use crate::prefetch::prefetch;

/// A triangle seen from one of its half-edges: tail A at the origin, head B at `(l, 0)`, apex C
/// above.
///
/// Walking A → C → B the triangle lies on the right and its neighbours on the left, so in the
/// frames of both exits (the twins of CA and BC) the source again lies below, and a smaller
/// abscissa again means further left as seen from the source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Length of the half-edge, |AB|.
    pub l: f64,
    /// Length |AC| of the left exit.
    pub la: f64,
    /// Length |CB| of the right exit.
    pub lb: f64,
    /// Abscissa of C.
    pub cx: f64,
    /// Ordinate of C; positive.
    pub cy: f64,
    /// Unit vector from A to C.
    pub left: [f64; 2],
    /// Unit vector from C to B.
    pub right: [f64; 2],
}

/// A face as a window meets it that enters it through one of its half-edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entrance {
    /// The triangle.
    pub frame: Frame,
    /// A, B and C.
    pub corners: [VertexId; 3],
    /// The half-edge A → C of the neighbour on the left and the half-edge C → B of the neighbour
    /// on the right; `None` at the boundary.
    pub exits: [Option<HalfEdgeId>; 2],
}

/// The corner that follows, and the one that precedes.
const NEXT: [usize; 3] = [1, 2, 0];
const PREV: [usize; 3] = [2, 0, 1];

/// What a solver needs of one face, for all its three half-edges, in two cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(align(128))]
struct Face {
    length: [f64; 3],
    inverse_length: [f64; 3],
    apex_x: [f64; 3],
    twice_area: f64,
    vertex: [VertexId; 3],
    /// `u32::MAX` where there is no neighbour.
    twin: [u32; 3],
}

/// The faces of a mesh laid out for crossing: one record a face instead of one array a quantity,
/// since a crossing reads nearly all of its face and nothing of the next one in memory.
#[derive(Clone, Debug)]
pub struct Faces {
    records: Vec<Face>,
}

impl Faces {
    /// Lays out the faces of `mesh`; O(faces).
    pub fn new(mesh: &Mesh) -> Self {
        let records = mesh
            .faces()
            .map(|f| {
                let sides = [0, 1, 2].map(|corner| f.half_edge(corner));
                let length = sides.map(|h| mesh.length(h));
                Face {
                    length,
                    inverse_length: length.map(f64::recip),
                    apex_x: sides.map(|h| mesh.apex(h)[0]),
                    twice_area: mesh.apex(sides[0])[1] * length[0],
                    vertex: mesh.face_vertices(f),
                    twin: sides.map(|h| mesh.twin(h).map_or(u32::MAX, HalfEdgeId::raw)),
                }
            })
            .collect();
        Self { records }
    }

    /// The frame of `h`.
    #[inline]
    pub fn frame(&self, h: HalfEdgeId) -> Frame {
        self.entrance(h).frame
    }

    /// All that a window meets that enters the face of `h` through it.
    #[inline]
    pub fn entrance(&self, h: HalfEdgeId) -> Entrance {
        let face = &self.records[h.face().index()];
        let k = h.corner() as usize;
        let (next, prev) = (NEXT[k], PREV[k]);
        let (l, cx) = (face.length[k], face.apex_x[k]);
        let cy = face.twice_area * face.inverse_length[k];
        let (to_c, from_c) = (face.inverse_length[prev], face.inverse_length[next]);
        let exit = |twin: u32| (twin != u32::MAX).then(|| HalfEdgeId::new(twin));
        Entrance {
            frame: Frame {
                l,
                la: face.length[prev],
                lb: face.length[next],
                cx,
                cy,
                left: [cx * to_c, cy * to_c],
                right: [(l - cx) * from_c, -cy * from_c],
            },
            corners: [face.vertex[k], face.vertex[next], face.vertex[prev]],
            exits: [exit(face.twin[prev]), exit(face.twin[next])],
        }
    }

    /// Asks for the memory in which the face of `h` lies.
    #[inline]
    pub fn announce(&self, h: HalfEdgeId) {
        prefetch(&self.records, h.face().index());
    }

    /// Length of `h`.
    #[inline]
    pub fn length(&self, h: HalfEdgeId) -> f64 {
        self.records[h.face().index()].length[h.corner() as usize]
    }

    /// Position of the third vertex of the face *below* `h`, whose half-edge along the same edge
    /// is `twin`, in the frame of `h`: (l - x, -y) of its position in the frame of `twin`.
    #[inline]
    pub fn apex_below(&self, twin: HalfEdgeId) -> [f64; 2] {
        let face = &self.records[twin.face().index()];
        let k = twin.corner() as usize;
        [
            face.length[k] - face.apex_x[k],
            -face.twice_area * face.inverse_length[k],
        ]
    }

    /// The tail, the head and the apex vertex of `h`: A, B, C of its frame.
    #[inline]
    pub fn corners(&self, h: HalfEdgeId) -> [VertexId; 3] {
        let vertex = &self.records[h.face().index()].vertex;
        [h, h.next(), h.prev()].map(|g| vertex[g.corner() as usize])
    }

    /// The neighbour's half-edge along the edge of `h`, or `None` at the boundary.
    #[inline]
    pub fn twin(&self, h: HalfEdgeId) -> Option<HalfEdgeId> {
        let twin = self.records[h.face().index()].twin[h.corner() as usize];
        (twin != u32::MAX).then(|| HalfEdgeId::new(twin))
    }

    /// Where a window that enters through `h` can go on: the half-edge A → C of the neighbour on
    /// the left and the half-edge C → B of the neighbour on the right.
    #[inline]
    pub fn exits(&self, h: HalfEdgeId) -> [Option<HalfEdgeId>; 2] {
        [self.twin(h.prev()), self.twin(h.next())]
    }
}
