//! The mesh laid out for crossing, in an order of its own.

use std::f64::consts::TAU;
use std::ops::Range;

use geobench_mesh::{FaceId, HalfEdgeId, Mesh, Numbering, VertexId};
use geobench_window::Probe;
use geobench_window::prefetch_line;
use geobench_window::trimming::KeptWindows;

use super::face_state::FaceState;
use super::kernels::{Gate, Triangle};
use super::store::COLUMNS;

/// The twin of a half-edge on the boundary.
pub(crate) const NO_TWIN: u32 = u32::MAX;

/// By how much the angle around a flat vertex may differ from 2π, in radians; whether windows fit
/// together is asked of each two of them.
const FLATNESS: f64 = 1e-8;

/// Number 4f + k for corner k of face f, so that face and corner are read off its bits.
pub(crate) const fn half_edge(face: u32, corner: usize) -> u32 {
    4 * face + corner as u32
}

/// The number here of a half-edge of the mesh.
fn number(numbering: &Numbering, h: HalfEdgeId) -> u32 {
    half_edge(numbering.new_face(h.face()).raw(), h.corner() as usize)
}

/// The face of a half-edge, and its corner.
#[inline]
pub(crate) const fn parts(h: u32) -> (usize, usize) {
    ((h >> 2) as usize, (h & 3) as usize)
}

/// The corner after this one: two bits of a constant for each, since no processor predicts corners.
#[inline]
pub(crate) const fn next(corner: usize) -> usize {
    0b00_10_01 >> (2 * corner) & 3
}

/// The corner before this one.
#[inline]
pub(crate) const fn prev(corner: usize) -> usize {
    0b01_00_10 >> (2 * corner) & 3
}

/// A face, in two cache lines: the first is read and changed when windows arrive, the second is
/// read when they cross.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(128))]
pub(crate) struct Face {
    /// Length of each half-edge.
    pub(crate) length: [f64; 3],
    /// The vertex at which each half-edge starts.
    pub(crate) vertex: [u32; 3],
    /// The half-edge of the neighbour along each, or [`NO_TWIN`].
    pub(crate) twin: [u32; 3],
    /// What changes, for a solver that keeps it here.
    pub(crate) state: FaceState,
    /// Abscissa of the opposite vertex in the frame of each half-edge.
    pub(crate) apex_x: [f64; 3],
    pub(crate) inverse_length: [f64; 3],
    pub(crate) twice_area: f64,
    /// Whether the surface is flat at the vertex opposite to each half-edge, so that windows which
    /// have passed it on either side and meet on that half-edge may be one.
    pub(crate) flat: [bool; 3],
}

const _: () = assert!(size_of::<Face>() == 128);

impl Face {
    fn new(mesh: &Mesh, numbering: &Numbering, face: u32) -> Self {
        let f = numbering.old_face(FaceId::new(face));
        let sides = [0, 1, 2].map(|corner| f.half_edge(corner));
        let length = sides.map(|h| mesh.length(h));
        let apexes = mesh.apexes(f);
        Self {
            length,
            vertex: sides.map(|h| numbering.new_vertex(mesh.tail(h)).raw()),
            twin: sides.map(|h| mesh.twin(h).map_or(NO_TWIN, |twin| number(numbering, twin))),
            state: FaceState::default(),
            apex_x: apexes.map(|[x, _]| x),
            inverse_length: length.map(f64::recip),
            twice_area: apexes[0][1] * length[0],
            flat: sides.map(|h| is_flat(mesh, mesh.tail(h.prev()))),
        }
    }

    /// The apex in the frame of a half-edge.
    #[inline]
    pub(crate) fn apex(&self, corner: usize) -> [f64; 2] {
        [
            self.apex_x[corner],
            self.twice_area * self.inverse_length[corner],
        ]
    }

    /// How far the foot of the apex lies before the head of a half-edge: l - cx, with an error
    /// relative to itself. The half-edge from the head on and this one project onto each other
    /// alike.
    #[inline]
    pub(crate) fn apex_from_head(&self, corner: usize) -> f64 {
        let after = next(corner);
        self.apex_x[after] * self.length[after] * self.inverse_length[corner]
    }

    /// The apex in the frame of the neighbour's half-edge along this one, below it.
    #[inline]
    pub(crate) fn apex_below(&self, corner: usize) -> [f64; 2] {
        [
            self.apex_from_head(corner),
            -(self.twice_area * self.inverse_length[corner]),
        ]
    }

    /// The triangle seen from a half-edge.
    #[inline]
    pub(crate) fn triangle(&self, corner: usize) -> Triangle {
        let (after, before) = (next(corner), prev(corner));
        let l = self.length[corner];
        let [cx, cy] = self.apex(corner);
        let (to_c, from_c) = (self.inverse_length[before], self.inverse_length[after]);
        Triangle {
            l,
            exits: [self.length[before], self.length[after]],
            apex: [cx, cy],
            directions: [
                [cx * to_c, cy * to_c],
                [self.apex_from_head(corner) * from_c, -cy * from_c],
            ],
        }
    }
}

/// Paths and a window that start from a vertex across one of its faces.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spawn {
    /// The other two vertices of the face, counter-clockwise.
    pub(crate) ends: [u32; 2],
    /// The lengths of the paths to them along the edges.
    pub(crate) paths: [f64; 2],
    /// The half-edge to which the window comes, or [`NO_TWIN`].
    pub(crate) exit: u32,
    /// The window, over the whole half-edge: b0, b1, px, py, σ.
    pub(crate) window: [f64; COLUMNS],
}

/// Whether all rays go on straight when they pass `v`, on either side.
fn is_flat(mesh: &Mesh, v: VertexId) -> bool {
    let bends = mesh.is_boundary(v) || mesh.is_pseudo_source(v);
    !bends && (mesh.total_angle(v) - TAU).abs() <= FLATNESS
}

/// What stands at a vertex.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Vertex {
    /// Whether windows start from it when a path reaches it.
    pub(crate) pseudo_source: bool,
    /// Whether they must start in all directions: what lies in the shadow of the path is not known
    /// where fans meet or end, or angles are small.
    pub(crate) all_around: bool,
    /// Whether its last half-edge has no face on its other side.
    pub(crate) boundary: bool,
    /// Sum of the angles around it, in radians.
    pub(crate) total_angle: f32,
}

/// The mesh in the order of the solver.
#[derive(Clone, Debug)]
pub(crate) struct Surface {
    pub(crate) faces: Vec<Face>,
    pub(crate) vertices: Vec<Vertex>,
    /// Half-edges that start at each vertex, counter-clockwise.
    ring_starts: Vec<u32>,
    pub(crate) rings: Vec<u32>,
    /// The angle between each and the next edge, in radians.
    pub(crate) angles: Vec<f32>,
    pub(crate) mean_length: f64,
    /// The windows kept beside thin faces, at the start of a run.
    pub(crate) kept: KeptWindows,
}

impl Surface {
    pub(crate) fn new(mesh: &Mesh, numbering: &Numbering) -> Self {
        let faces: Vec<Face> = (0..mesh.face_count() as u32)
            .map(|face| Face::new(mesh, numbering, face))
            .collect();
        let mut ring_starts = vec![0];
        let mut rings = Vec::with_capacity(mesh.half_edge_count());
        let mut angles = Vec::with_capacity(mesh.half_edge_count());
        let angle = |h: u32| {
            let (face, corner) = parts(h);
            let [x, y] = faces[face].apex(corner);
            libm::atan2(y, x) as f32
        };
        let vertex_of = |v: u32| {
            let v = numbering.old_vertex(VertexId::new(v));
            let start = rings.len();
            rings.extend(mesh.outgoing(v).iter().map(|&h| number(numbering, h)));
            angles.extend(rings[start..].iter().map(|&h| angle(h)));
            ring_starts.push(rings.len() as u32);
            Vertex {
                pseudo_source: mesh.is_pseudo_source(v),
                all_around: mesh.is_boundary(v) || mesh.is_pinched(v) || mesh.is_beside_sliver(v),
                boundary: mesh.is_boundary(v),
                total_angle: mesh.total_angle(v) as f32,
            }
        };
        let vertices = (0..mesh.vertex_count() as u32).map(vertex_of).collect();
        let total: f64 = mesh.half_edges().map(|h| mesh.length(h)).sum();
        Self {
            faces,
            vertices,
            ring_starts,
            rings,
            angles,
            mean_length: total / mesh.half_edge_count().max(1) as f64,
            kept: KeptWindows::new(mesh, 4 * mesh.face_count(), |h| {
                number(numbering, h) as usize
            }),
        }
    }

    /// Tells `probe` which numbers here vertices and half-edges of `mesh` have.
    pub(crate) fn renumber<P: Probe>(&self, mesh: &Mesh, numbering: &Numbering, probe: &mut P) {
        let corner = |v, i| {
            let ring = self.ring(numbering.new_vertex(v).raw());
            HalfEdgeId::new(ring[i])
        };
        probe.renumber(mesh, |v| numbering.new_vertex(v), corner);
    }

    /// The length of `h`.
    #[inline]
    pub(crate) fn length(&self, h: u32) -> f64 {
        let (f, corner) = parts(h);
        self.faces[f].length[corner]
    }

    /// The half-edges behind the exits of the face of `h`: behind the left and the right one.
    #[inline(always)]
    pub(crate) fn exits(&self, h: u32) -> [u32; 2] {
        let (f, corner) = parts(h);
        let face = &self.faces[f];
        [face.twin[prev(corner)], face.twin[next(corner)]]
    }

    /// Paths and a window that start across the face of `h` from its tail, at distance `sigma`.
    #[inline(always)]
    pub(crate) fn spawn(&self, h: u32, sigma: f64) -> Spawn {
        let (f, corner) = parts(h);
        let (after, before) = (next(corner), prev(corner));
        let face = &self.faces[f];
        let [px, py] = face.apex_below(after);
        Spawn {
            ends: [face.vertex[after], face.vertex[before]],
            paths: [sigma + face.length[corner], sigma + face.length[before]],
            exit: face.twin[after],
            window: [0.0, face.length[after], px, py, sigma],
        }
    }

    /// Requests the cache lines of a face.
    #[inline(always)]
    pub(crate) fn prefetch(&self, f: usize) {
        if let Some(face) = self.faces.get(f) {
            prefetch_line(face);
            prefetch_line(&face.apex_x);
        }
    }

    /// The half-edge `h` as the passes over its list see it, its ends at `ends`.
    #[inline]
    pub(crate) fn gate(&self, h: u32, ends: [f64; 2]) -> Gate {
        let (f, corner) = parts(h);
        let face = &self.faces[f];
        Gate {
            l: face.length[corner],
            apex: face.apex(corner),
            ends,
        }
    }

    /// The third vertex of the face below `h`, in the frame of `h`; a point infinitely far below if
    /// there is none.
    #[inline]
    pub(crate) fn behind(&self, h: u32) -> [f64; 2] {
        let (f, corner) = parts(h);
        let twin = self.faces[f].twin[corner];
        if twin == NO_TWIN {
            return [0.0, f64::NEG_INFINITY];
        }
        let (f, corner) = parts(twin);
        self.faces[f].apex_below(corner)
    }

    /// Where the half-edges that start at `v` stand in `rings` and `angles`.
    #[inline]
    pub(crate) fn ring_places(&self, v: u32) -> Range<usize> {
        let v = v as usize;
        self.ring_starts[v] as usize..self.ring_starts[v + 1] as usize
    }

    /// The half-edges that start at `v`, counter-clockwise.
    #[inline]
    pub(crate) fn ring(&self, v: u32) -> &[u32] {
        &self.rings[self.ring_places(v)]
    }
}
