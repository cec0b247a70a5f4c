//! The frame of a half-edge, and the compact table from which frames are read.

use geobench_mesh::{FaceId, HalfEdgeId, Mesh, VertexId};

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

/// On which side of the apex a window leaves a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Through AC.
    Left,
    /// Through CB.
    Right,
}

/// The edge by which a window leaves a triangle on one side, AC or CB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exit {
    /// 1 for the side on which it is, the left or the right one, and 0 for the other.
    pub(crate) is_left: f64,
    pub(crate) is_right: f64,
    /// The half-edge A → C, or C → B, of the neighbour there; `None` at the boundary.
    pub half_edge: Option<HalfEdgeId>,
    /// Length of the edge.
    pub length: f64,
    /// The unit vector along it, from A to C or from C to B, in the frame by which the window came.
    pub direction: [f64; 2],
    /// Position of the triangle's third vertex, B or A, in the frame by which the window leaves,
    /// below the edge.
    pub behind: [f64; 2],
    /// Where the edge begins, where it ends, and that third vertex.
    pub corners: [VertexId; 3],
}

/// The corner that follows, and the one that precedes.
pub(crate) const NEXT: [usize; 3] = [1, 2, 0];
pub(crate) const PREV: [usize; 3] = [2, 0, 1];

/// The corners at which the half-edges of the left and of the right exit start, C and B: those
/// after the entrance in reverse.
pub(crate) const EXITS: [[usize; 2]; 3] = [[2, 1], [0, 2], [1, 0]];

/// What a solver needs of one face, for all its three half-edges, in two cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(align(128))]
pub(crate) struct Face {
    pub(crate) length: [f64; 3],
    pub(crate) inverse_length: [f64; 3],
    pub(crate) apex_x: [f64; 3],
    pub(crate) twice_area: f64,
    pub(crate) vertex: [VertexId; 3],
    /// `u32::MAX` where there is no neighbour.
    pub(crate) twin: [u32; 3],
}

impl Face {
    /// Ordinate of the apex in the frame of the half-edge that starts at corner `k`; positive.
    #[inline(always)]
    #[allow(clippy::inline_always)] // It is compiled for the instructions of its caller.
    pub(crate) fn apex_y(&self, k: usize) -> f64 {
        self.twice_area * self.inverse_length[k]
    }
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

    /// The edge on one side by which a window leaves that came in through the half-edge of `frame`, `h`.
    ///
    /// Windows pass an apex on either side as often as not, and no processor foresees on which: both sides go the
    /// same way here and in all that depends on the exit, without a branch, and nothing is known of the side that would
    /// tempt the compiler to make one.
    #[inline]
    pub fn exit(&self, h: HalfEdgeId, frame: &Frame, side: Side) -> Exit {
        let face = &self.records[h.face().index()];
        let side = std::hint::black_box(side as u32);
        let e = EXITS[h.corner() as usize][side as usize];
        let is_right = f64::from(side);
        let is_left = 1.0 - is_right;
        let (length, inverse) = (face.length[e], face.inverse_length[e]);
        let twin = face.twin[e];
        Exit {
            is_left,
            is_right,
            half_edge: (twin != u32::MAX).then(|| HalfEdgeId::new(twin)),
            length,
            direction: [
                ((is_left - is_right) * frame.cx + is_right * frame.l) * inverse,
                (is_left - is_right) * frame.cy * inverse,
            ],
            behind: [length - face.apex_x[e], -face.twice_area * inverse],
            corners: [face.vertex[NEXT[e]], face.vertex[e], face.vertex[PREV[e]]],
        }
    }

    /// The face `f`.
    #[inline]
    pub(crate) fn record(&self, f: FaceId) -> &Face {
        &self.records[f.index()]
    }

    /// The vertices of the face of `h`.
    #[inline]
    pub fn vertices(&self, h: HalfEdgeId) -> &[VertexId; 3] {
        &self.records[h.face().index()].vertex
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

    /// The other edge of the face of `h` at the tail of `h`, if that is on the boundary: its other end and its length.
    #[inline]
    pub(crate) fn boundary_behind(&self, h: HalfEdgeId) -> Option<(VertexId, f64)> {
        let face = &self.records[h.face().index()];
        let prev = PREV[h.corner() as usize];
        (face.twin[prev] == u32::MAX).then(|| (face.vertex[prev], face.length[prev]))
    }

    /// Where a window that enters through `h` can go on: the half-edge A → C of the neighbour on
    /// the left and the half-edge C → B of the neighbour on the right.
    #[inline]
    pub fn exits(&self, h: HalfEdgeId) -> [Option<HalfEdgeId>; 2] {
        [self.twin(h.prev()), self.twin(h.next())]
    }
}
