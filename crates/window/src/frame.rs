//! The frame of a half-edge, and the compact table from which frames are read.

use geobench_mesh::{FaceId, HalfEdgeId, Mesh, Numbering, Splice, VertexId};

use crate::origins::Way;
use crate::prefetch::prefetch;
use crate::window::Window;

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

/// A face as seen by a window that enters it through one of its half-edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceView {
    /// The triangle.
    pub frame: Frame,
    /// A, B and C.
    pub corners: [VertexId; 3],
    /// The half-edge A → C of the neighbour on the left and the half-edge C → B of the neighbour
    /// on the right; `None` at the boundary.
    pub exits: [Option<HalfEdgeId>; 2],
    /// Position of the vertex opposite to each exit, B and A, in the frame of the neighbour's
    /// half-edge there.
    pub behind: [[f64; 2]; 2],
}

impl FaceView {
    /// The face of `h` of `mesh`, for callers that cross few faces. [`Faces`] holds those of all
    /// faces.
    pub fn of(mesh: &Mesh, h: HalfEdgeId) -> Self {
        let sides = HalfEdge::of_face(mesh, &Numbering::same(), h.face());
        let [entry, left, right] = [h, h.prev(), h.next()].map(|e| &sides[e.corner() as usize]);
        Self::new(entry, [left, right])
    }

    #[inline]
    fn new(entry: &HalfEdge, [left, right]: [&HalfEdge; 2]) -> Self {
        let (l, [cx, cy]) = (entry.length, entry.apex);
        let (to_c, from_c) = (left.inverse_length, right.inverse_length);
        Self {
            frame: Frame {
                l,
                la: left.length,
                lb: right.length,
                cx,
                cy,
                left: [cx * to_c, cy * to_c],
                right: [entry.apex_from_head * from_c, -cy * from_c],
            },
            corners: entry.corners(),
            exits: [left.exit_edge.half_edge(), right.exit_edge.half_edge()],
            behind: [left.apex_below(), right.apex_below()],
        }
    }

    /// The edge on the given side. Use [`Faces::exit`] where the side is hard to predict.
    #[inline]
    pub fn exit(&self, side: Side) -> Exit {
        let Frame {
            la,
            lb,
            left,
            right,
            ..
        } = self.frame;
        let [a, b, c] = self.corners;
        match side {
            Side::Left => Exit {
                is_left: 1.0,
                is_right: 0.0,
                half_edge: self.exits[0],
                length: la,
                direction: left,
                behind: self.behind[0],
                corners: [a, c, b],
            },
            Side::Right => Exit {
                is_left: 0.0,
                is_right: 1.0,
                half_edge: self.exits[1],
                length: lb,
                direction: right,
                behind: self.behind[1],
                corners: [c, b, a],
            },
        }
    }
}

/// The side of the apex on which a window leaves a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Through AC.
    Left,
    /// Through CB.
    Right,
}

/// The edge through which a window leaves a triangle on one side, AC or CB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exit {
    /// 1 if this is the left exit, else 0.
    pub(crate) is_left: f64,
    pub(crate) is_right: f64,
    /// The half-edge A → C, or C → B, of the neighbour there; `None` at the boundary.
    pub half_edge: Option<HalfEdgeId>,
    /// Length of the edge.
    pub length: f64,
    /// The unit vector along the edge, from A to C or from C to B, in the frame of the entrance.
    pub direction: [f64; 2],
    /// Position of the triangle's third vertex, B or A, in the frame of the neighbour's half-edge,
    /// below it.
    pub behind: [f64; 2],
    /// The start of the edge, its end, and the third vertex.
    pub corners: [VertexId; 3],
}

/// The edge through which a window leaves a triangle, with its corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExitEdge {
    /// The neighbour's half-edge; at a junction the [gate](Faces::beyond); `u32::MAX` at the
    /// boundary.
    twin: u32,
    /// The start of the edge as seen from the neighbour, its end, and the third vertex of the
    /// triangle.
    pub corners: [VertexId; 3],
}

impl ExitEdge {
    /// No edge.
    pub(crate) const NONE: Self = Self {
        twin: u32::MAX,
        corners: [VertexId::new(0); 3],
    };

    /// The neighbour's half-edge; `None` at the boundary.
    #[inline]
    pub fn half_edge(&self) -> Option<HalfEdgeId> {
        (self.twin != u32::MAX).then(|| HalfEdgeId::new(self.twin))
    }
}

/// The data of one half-edge that solvers need, in one cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct HalfEdge {
    pub(crate) length: f64,
    pub(crate) inverse_length: f64,
    /// Position of the apex in its frame.
    pub(crate) apex: [f64; 2],
    /// l - cx, the distance from the foot of the apex to the head, with a small relative error.
    pub(crate) apex_from_head: f64,
    /// The edge seen by a window that leaves the face through this half-edge.
    pub(crate) exit_edge: ExitEdge,
    /// The exits of a window that enters through this half-edge. The left exit is the previous
    /// half-edge of the face, the right exit the next.
    pub(crate) exits: [HalfEdgeId; 2],
}

impl HalfEdge {
    /// The half-edges of `face` of `mesh`, with the numbers of `numbering`.
    fn of_face(mesh: &Mesh, numbering: &Numbering, face: FaceId) -> [Self; 3] {
        let apexes = mesh.apexes(face);
        // One area for all three corners, so that their heights are consistent.
        let twice_area = apexes[0][1] * mesh.length(face.half_edge(0));
        [0, 1, 2].map(|corner| {
            let h = face.half_edge(corner);
            let next = h.next().corner() as usize;
            let length = mesh.length(h);
            Self {
                length,
                inverse_length: length.recip(),
                apex: [apexes[corner as usize][0], twice_area * length.recip()],
                // Each of two adjacent sides projects on the other, which avoids the cancellation
                // in l - cx.
                apex_from_head: apexes[next][0] * mesh.length(h.next()) * length.recip(),
                exit_edge: ExitEdge {
                    twin: mesh
                        .twin(h)
                        .map_or(u32::MAX, |twin| numbering.new_half_edge(twin).raw()),
                    corners: [mesh.head(h), mesh.tail(h), mesh.tail(h.prev())],
                },
                exits: [h.prev(), h.next()].map(|e| numbering.new_half_edge(e)),
            }
        })
    }

    /// The tail, the head and the apex.
    #[inline]
    pub(crate) fn corners(&self) -> [VertexId; 3] {
        let [head, tail, apex] = self.exit_edge.corners;
        [tail, head, apex]
    }

    /// Position of the apex in the frame of the neighbour's half-edge, below it.
    #[inline]
    pub(crate) fn apex_below(&self) -> [f64; 2] {
        [self.apex_from_head, -self.apex[1]]
    }
}

/// A path along an edge from a (pseudo-)source.
#[derive(Clone, Copy, Debug)]
pub struct EdgePath {
    /// The other end of the edge.
    pub end: VertexId,
    /// Length of the edge.
    pub length: f64,
    /// The half-edge that starts at the other end, in a face of the edge.
    pub corner: HalfEdgeId,
    /// How the path crosses that face.
    pub way: Way,
}

/// The faces of a mesh laid out for crossing: one record for each half-edge instead of one array
/// for each quantity. A crossing reads the records of the entrance and of the exit, which are
/// neighbours in memory.
///
/// ```
/// use geobench_mesh::{HalfEdgeId, Mesh};
/// use geobench_window::{Faces, Crossing, spawn_window};
///
/// // A square cut along the diagonal from 0 to 2; vertex 1 sees vertex 3 across it.
/// let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(positions, vec![[0, 1, 2], [0, 2, 3]])?;
/// let faces = Faces::new(&mesh);
/// let (h, window) = spawn_window(&faces, HalfEdgeId::new(1), 0.0).expect("a face beyond");
/// assert_eq!(faces.corners(h)[2].raw(), 3);
/// let frame = faces.frame(h);
/// let crossing = Crossing::new(&frame, &window);
/// assert!(crossing.covers_apex());
/// assert!((crossing.straight_distance() - 2.0_f64.sqrt()).abs() < 1e-15);
/// # Ok::<(), geobench_mesh::InvalidMesh>(())
/// ```
#[derive(Clone, Debug)]
pub struct Faces {
    half_edges: Vec<HalfEdge>,
    /// The numbers here of the faces of the mesh.
    numbering: Numbering,
    /// The first gate. Gates follow the half-edges.
    first_gate: u32,
    /// Whether there are gates, if the mesh has junctions.
    has_gates: bool,
    /// For each gate the place of its half-edge in `sides`, and where its junction starts and ends
    /// there.
    gates: Vec<[u32; 3]>,
    /// The half-edges along junctions, junction after junction, as seen from the gate of the first
    /// one.
    sides: Vec<HalfEdgeBeyond>,
}

/// A half-edge through which windows go on beyond a [gate](Faces::beyond).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HalfEdgeBeyond {
    /// The half-edge.
    pub half_edge: HalfEdgeId,
    /// Whether it has the direction opposite to that of the gate, so that windows are
    /// [mirrored](Window::mirrored).
    pub mirrored: bool,
}

impl HalfEdgeBeyond {
    /// A window at the gate, whose length is `l`, in the frame of this half-edge; `None` if
    /// rounding leaves nothing of it.
    pub fn carry(&self, window: &Window, l: f64) -> Option<Window> {
        let carried = if self.mirrored {
            window.mirrored(l)
        } else {
            *window
        };
        (carried.b0 < carried.b1).then_some(carried)
    }
}

impl Faces {
    /// Lays out the faces of `mesh` in its own order; O(faces). At [junctions](Mesh::junction) the
    /// surface has a boundary.
    pub fn new(mesh: &Mesh) -> Self {
        Self::in_order(mesh, Numbering::same())
    }

    /// Lays out the faces of `mesh` in the order of `numbering`. Half-edges have its numbers in all
    /// arguments and results of the other methods; vertices keep theirs. O(faces). At
    /// [junctions](Mesh::junction) the surface has a boundary.
    pub fn in_order(mesh: &Mesh, mut numbering: Numbering) -> Self {
        let mut half_edges = Vec::with_capacity(mesh.half_edge_count());
        for f in 0..mesh.face_count() as u32 {
            let face = numbering.old_face(FaceId::new(f));
            half_edges.extend(HalfEdge::of_face(mesh, &numbering, face));
        }
        numbering.keep_new_faces();
        Self {
            first_gate: half_edges.len() as u32,
            half_edges,
            numbering,
            has_gates: false,
            gates: Vec::new(),
            sides: Vec::new(),
        }
    }

    /// The same faces, with a *gate* for each half-edge h along a junction of `mesh`, which is the
    /// mesh laid out.
    ///
    /// A gate has a number like a half-edge, above those of all half-edges, and takes the place of
    /// the twin of h: it has the opposite direction, and windows that leave the face of h through h
    /// arrive at the gate. They go on through all half-edges [`beyond`](Self::beyond) it. The
    /// methods that return corners and lengths accept it. It has no face, and nothing waits there.
    #[must_use]
    pub fn with_gates(mut self, mesh: &Mesh) -> Self {
        self.add_gates(mesh);
        self
    }

    fn add_gates(&mut self, mesh: &Mesh) {
        self.has_gates = true;
        // Where the junction of each half-edge starts.
        let mut starts: Vec<usize> = Vec::with_capacity(mesh.junction_sides().len());
        for h in mesh.junction_sides() {
            // The first half-edge of a junction comes before the others.
            let junction = mesh.junction(h);
            let first = junction[0];
            let start = match mesh.junction_side(first) {
                Some(place) if first != h => starts[place],
                _ => self.sides.len(),
            };
            if first == h {
                self.sides
                    .extend(junction.iter().map(|&side| HalfEdgeBeyond {
                        half_edge: self.numbering.new_half_edge(side),
                        mirrored: mesh.tail(side) == mesh.tail(first),
                    }));
            }
            starts.push(start);
            let own = start + junction.partition_point(|&side| side < h);
            let end = start + junction.len();
            self.gates.push([own, start, end].map(|place| place as u32));
            let gate = self.half_edges.len() as u32;
            let own = &mut self.half_edges[self.numbering.new_half_edge(h).index()];
            own.exit_edge.twin = gate;
            let [tail, head, apex] = own.exit_edge.corners;
            let record = HalfEdge {
                exit_edge: ExitEdge {
                    twin: u32::MAX,
                    corners: [head, tail, apex],
                },
                exits: [HalfEdgeId::new(gate); 2],
                ..*own
            };
            self.half_edges.push(record);
        }
    }

    /// Follows a change of the mesh, which is `mesh` now. Takes time in the size of the change, and
    /// with [gates](Self::with_gates) in their number.
    pub fn splice(&mut self, mesh: &Mesh, splice: &Splice) {
        self.half_edges.truncate(self.first_gate as usize);
        self.first_gate = mesh.half_edge_count() as u32;
        let none = HalfEdge {
            length: 0.0,
            inverse_length: 0.0,
            apex: [0.0; 2],
            apex_from_head: 0.0,
            exit_edge: ExitEdge::NONE,
            exits: [HalfEdgeId::default(); 2],
        };
        self.half_edges.resize(self.first_gate as usize, none);
        for face in splice.faces() {
            let first = self.numbering.new_face(face).half_edge(0).index();
            let records = HalfEdge::of_face(mesh, &self.numbering, face);
            self.half_edges[first..first + 3].copy_from_slice(&records);
        }
        self.gates.clear();
        self.sides.clear();
        if self.has_gates {
            self.add_gates(mesh);
        }
    }

    /// The half-edges of the other faces at a junction, if `h` is a
    /// [gate](Self::with_gates), else `None`.
    pub fn beyond(&self, h: HalfEdgeId) -> Option<impl Iterator<Item = HalfEdgeBeyond>> {
        let gate = h.raw().checked_sub(self.first_gate)? as usize;
        let [own, start, end] = self.gates[gate].map(|place| place as usize);
        let others = (start..end).filter(move |&side| side != own);
        // Of two half-edges, both or neither have the direction of the first.
        Some(others.map(move |side| HalfEdgeBeyond {
            mirrored: self.sides[side].mirrored == self.sides[own].mirrored,
            ..self.sides[side]
        }))
    }

    /// The number here of half-edge `h` of the mesh.
    #[inline]
    pub fn number(&self, h: HalfEdgeId) -> HalfEdgeId {
        self.numbering.new_half_edge(h)
    }

    /// The half-edge `h`.
    #[inline(always)]
    #[allow(clippy::inline_always)] // It is compiled for the instructions of its caller.
    pub(crate) fn half_edge(&self, h: HalfEdgeId) -> &HalfEdge {
        &self.half_edges[h.index()]
    }

    /// The frame of `h`.
    #[inline]
    pub fn frame(&self, h: HalfEdgeId) -> Frame {
        self.face_view(h).frame
    }

    /// The face of `h`, as seen by a window that enters through `h`.
    #[inline]
    pub fn face_view(&self, h: HalfEdgeId) -> FaceView {
        let entry = self.half_edge(h);
        FaceView::new(entry, entry.exits.map(|e| self.half_edge(e)))
    }

    /// The edge on one side through which a window leaves that entered through `h`, the half-edge
    /// of `frame`.
    ///
    /// Windows pass an apex on either side about equally often, in no predictable order. So both
    /// sides are computed by the same instructions, here and in all code that depends on the exit.
    /// `black_box` keeps the compiler from introducing a branch on the side.
    #[inline]
    pub fn exit(&self, h: HalfEdgeId, frame: &Frame, side: Side) -> Exit {
        let side = std::hint::black_box(side as u32);
        let entry = self.half_edge(h);
        let exit = self.half_edge(entry.exits[side as usize]);
        let is_right = f64::from(side);
        let is_left = 1.0 - is_right;
        Exit {
            is_left,
            is_right,
            half_edge: exit.exit_edge.half_edge(),
            length: exit.length,
            direction: [
                (is_left * frame.cx + is_right * entry.apex_from_head) * exit.inverse_length,
                (is_left - is_right) * frame.cy * exit.inverse_length,
            ],
            behind: exit.apex_below(),
            corners: exit.exit_edge.corners,
        }
    }

    /// The vertices of the face of `h`: its tail, its head and its apex.
    #[inline]
    pub fn corners(&self, h: HalfEdgeId) -> [VertexId; 3] {
        self.half_edge(h).corners()
    }

    /// The ends of `h`, tail and head; of a gate, too.
    pub fn ends(&self, h: HalfEdgeId) -> [VertexId; 2] {
        let ends = |h| {
            let [tail, head, _] = self.corners(h);
            [tail, head]
        };
        match self.beyond(h).and_then(|mut entrances| entrances.next()) {
            Some(first) if first.mirrored => {
                let [tail, head] = ends(first.half_edge);
                [head, tail]
            }
            Some(first) => ends(first.half_edge),
            None => ends(h),
        }
    }

    /// Prefetches the memory of the face of `h`.
    #[inline]
    pub fn announce(&self, h: HalfEdgeId) {
        let first = h.face().half_edge(0).index();
        for corner in 0..3 {
            prefetch(&self.half_edges, first + corner);
        }
    }

    /// Length of `h`.
    #[inline]
    pub fn length(&self, h: HalfEdgeId) -> f64 {
        self.half_edge(h).length
    }

    /// Position of the third vertex of the face *below* a half-edge, in the frame of that
    /// half-edge. `twin` is the other half-edge of its edge, in whose frame the vertex is at (x,
    /// y); the result is (l - x, -y).
    #[inline]
    pub fn apex_below(&self, twin: HalfEdgeId) -> [f64; 2] {
        self.half_edge(twin).apex_below()
    }

    /// The neighbour's half-edge along the edge of `h`, or the [gate](Self::with_gates) there, or
    /// `None` at the boundary.
    #[inline]
    pub fn twin(&self, h: HalfEdgeId) -> Option<HalfEdgeId> {
        self.half_edge(h).exit_edge.half_edge()
    }

    /// The paths from the tail of `h` along the edge of `h`, and along the other edge of its face
    /// at the tail if that is on the boundary or a junction. Over all half-edges that leave a
    /// vertex, each edge of the vertex occurs once, a junction once for each face.
    #[inline]
    pub fn edge_paths(&self, h: HalfEdgeId) -> impl Iterator<Item = EdgePath> + use<> {
        let own = self.half_edge(h);
        let back = self.half_edge(own.exits[0]);
        let [tail, ..] = back.corners();
        // Gates have higher numbers than half-edges, and the boundary the highest.
        let is_boundary = back.exit_edge.twin >= self.first_gate;
        let along = EdgePath {
            end: own.corners()[1],
            length: own.length,
            corner: h.next(),
            way: Way::FromHead,
        };
        let along_boundary = EdgePath {
            end: tail,
            length: back.length,
            corner: h.prev(),
            way: Way::FromTail,
        };
        std::iter::once(along).chain(is_boundary.then_some(along_boundary))
    }

    /// The exits of a window that enters through `h`: the half-edge A → C of the neighbour on the
    /// left and the half-edge C → B of the neighbour on the right.
    #[inline]
    pub fn exits(&self, h: HalfEdgeId) -> [Option<HalfEdgeId>; 2] {
        self.half_edge(h).exits.map(|e| self.twin(e))
    }
}
