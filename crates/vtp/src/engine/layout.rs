//! The mesh laid out for crossing, in the solver's own order.

use std::collections::HashMap;
use std::f64::consts::{PI, TAU};
use std::ops::Range;

use geobench_mesh::vector::column;
use geobench_mesh::{FaceId, HalfEdgeId, Mesh, Numbering, RowTable, Splice, VertexId, threads};
use geobench_window::Probe;
use geobench_window::prefetch_line;
use geobench_window::trimming::KeptWindows;
use rayon::iter::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};

use super::face_state::FaceState;
use super::kernels::{Gate, Triangle};
use super::spawn_wedge::WIDENING;
use super::store::COLUMNS;
use crate::precision::blur;

/// The twin of a half-edge on the boundary.
pub(crate) const NO_TWIN: u32 = u32::MAX;

/// By how much the angle around a flat vertex may differ from 2π, in radians. Whether two windows
/// can be coalesced is checked for each pair.
const FLATNESS: f64 = 1e-8;

/// Vertices that [have shadows](has_shadow) send windows if they are at most one in this many.
const DARK: usize = 64;

/// Length of the longest side of a face, in typical lengths, above which its lists cross when their
/// nearest windows are due.
///
/// A face joins at the turn of its nearest vertex, which may be many times as far from the source
/// as the middle of its longest side. What lies behind the face would be reached late, after
/// vertices there have sent windows at longer distances.
const LONG: f64 = 8.0;

/// The largest number of edges of which the median is taken.
const SAMPLE: usize = 10_000;

/// The median length of some edges, taken at equal steps.
fn median_length(mesh: &Mesh) -> f64 {
    let step = mesh.half_edge_count().div_ceil(SAMPLE).max(1);
    let sampled = mesh.half_edges().step_by(step);
    let mut lengths: Vec<f64> = sampled.map(|h| mesh.length(h)).collect();
    let middle = lengths.len() / 2;
    if lengths.is_empty() {
        return 0.0;
    }
    *lengths.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The number 4f + k of the half-edge at corner k of face f. Face and corner can be read from its
/// bits.
pub(crate) const fn half_edge(face: u32, corner: usize) -> u32 {
    4 * face + corner as u32
}

/// The number here of half-edge `h` of the mesh.
fn number(numbering: &Numbering, h: HalfEdgeId) -> u32 {
    half_edge(numbering.new_face(h.face()).raw(), h.corner() as usize)
}

/// The face of a half-edge, and its corner.
#[inline]
pub(crate) const fn parts(h: u32) -> (usize, usize) {
    ((h >> 2) as usize, (h & 3) as usize)
}

/// The next corner, read from a constant without a branch, because corners are unpredictable.
#[inline]
pub(crate) const fn next(corner: usize) -> usize {
    0b00_10_01 >> (2 * corner) & 3
}

/// The previous corner.
#[inline]
pub(crate) const fn prev(corner: usize) -> usize {
    0b01_00_10 >> (2 * corner) & 3
}

/// A face, in two cache lines. The first is read and changed when windows arrive, the second is
/// read when they cross.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(128))]
pub(crate) struct FaceLayout {
    /// Length of each half-edge.
    pub(crate) length: [f64; 3],
    /// The vertex at which each half-edge starts.
    pub(crate) vertex: [u32; 3],
    /// The neighbour's half-edge along each half-edge, or [`NO_TWIN`].
    pub(crate) twin: [u32; 3],
    /// The state during a run, for solvers that store it here.
    pub(crate) state: FaceState,
    /// Abscissa of the opposite vertex in the frame of each half-edge.
    pub(crate) apex_x: [f64; 3],
    pub(crate) inverse_length: [f64; 3],
    pub(crate) twice_area: f64,
    /// Whether the surface is flat at the vertex opposite to each half-edge. Windows that have
    /// passed this vertex on both sides and meet on the half-edge may then be coalesced.
    pub(crate) flat: [bool; 3],
}

const _: () = assert!(size_of::<FaceLayout>() == 128);

/// Number of faces that are laid out together.
const TOGETHER: usize = 8;

impl FaceLayout {
    /// The faces numbered from `first` on, fewer than [`TOGETHER`] at the end, and the angles of
    /// their corners.
    fn several(
        mesh: &Mesh,
        numbering: &Numbering,
        vertices: &[VertexFacts],
        first: usize,
    ) -> ([Self; TOGETHER], [[f32; 3]; TOGETHER]) {
        let last = mesh.face_count() - 1;
        let old: [FaceId; TOGETHER] =
            std::array::from_fn(|i| numbering.old_face(FaceId::new((first + i).min(last) as u32)));
        let vertex = |v| numbering.new_vertex(v).raw();
        Self::of(mesh, old, vertex, |h| number(numbering, h), vertices)
    }

    /// These faces of `mesh`, and the angles of their corners.
    fn of<const N: usize>(
        mesh: &Mesh,
        old: [FaceId; N],
        vertex: impl Fn(VertexId) -> u32,
        number: impl Fn(HalfEdgeId) -> u32,
        vertices: &[VertexFacts],
    ) -> ([Self; N], [[f32; 3]; N]) {
        let shapes = mesh.shapes(old);
        let mut inverse = shapes.lengths;
        for length in inverse.as_flattened_mut() {
            *length = length.recip();
        }
        let faces = std::array::from_fn(|i| {
            let [a, b, c] = mesh.face_vertices(old[i]);
            let vertex = [vertex(a), vertex(b), vertex(c)];
            let twin = |corner| {
                let twin = mesh.twin(old[i].half_edge(corner));
                twin.map_or(NO_TWIN, &number)
            };
            let flat = |corner: usize| vertices[vertex[corner] as usize].flat;
            Self {
                length: column(&shapes.lengths, i),
                vertex,
                twin: [twin(0), twin(1), twin(2)],
                state: FaceState::default(),
                apex_x: column(&shapes.apexes_x, i),
                inverse_length: column(&inverse, i),
                twice_area: shapes.twice_areas[i],
                flat: [flat(2), flat(0), flat(1)],
            }
        });
        let angles = std::array::from_fn(|i| column(&shapes.angles, i).map(|angle| angle as f32));
        (faces, angles)
    }

    /// Whether a side is [long](LONG).
    fn is_long(&self, typical_length: f64) -> bool {
        self.length.iter().any(|&l| l > LONG * typical_length)
    }

    /// The apex in the frame of a half-edge.
    #[inline]
    pub(crate) fn apex(&self, corner: usize) -> [f64; 2] {
        [
            self.apex_x[corner],
            self.twice_area * self.inverse_length[corner],
        ]
    }

    /// l - cx, the distance from the foot of the apex to the head of a half-edge, with a small
    /// relative error: two adjacent sides project on each other.
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

    /// The triangle in the frame of a half-edge.
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

/// The paths and the window that a vertex sends across one of its faces.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spawn {
    /// The other two vertices of the face, counter-clockwise.
    pub(crate) ends: [u32; 2],
    /// The lengths of the edges to them.
    pub(crate) paths: [f64; 2],
    /// The half-edge at which the window arrives, or [`NO_TWIN`].
    pub(crate) exit: u32,
    /// The window, over the whole half-edge: b0, b1, px, py, σ.
    pub(crate) window: [f64; COLUMNS],
}

/// Whether the surface is flat at `v`, so that all rays continue straight on either side.
fn is_flat(mesh: &Mesh, v: VertexId) -> bool {
    let bends = mesh.is_boundary(v) || mesh.is_pseudo_source(v);
    !bends && (mesh.total_angle(v) - TAU).abs() <= FLATNESS
}

/// Whether the surface is flat at `v`, or its boundary straight, up to rounding, and `v` sends no
/// windows. Behind such a vertex may be a shadow, as narrow as the rounding of its angle.
fn has_shadow(mesh: &Mesh, v: VertexId) -> bool {
    let straight = if mesh.is_boundary(v) { PI } else { TAU };
    !mesh.is_pseudo_source(v) && mesh.total_angle(v) - straight >= -FLATNESS
}

/// Whether the direction of an edge of this length is known within the widening of spawn wedges.
fn is_known(mesh: &Mesh, length: f64) -> bool {
    blur(mesh.longest_edge()) < f64::from(WIDENING) * length
}

/// All of `parts`, one after the other.
fn concatenated<T: Copy>(mut parts: Vec<Vec<T>>) -> Vec<T> {
    if parts.len() == 1 {
        parts.remove(0)
    } else {
        parts.concat()
    }
}

/// Properties of a vertex.
#[derive(Clone, Copy, Debug, Default)]
#[allow(clippy::struct_excessive_bools)] // Four facts, one byte each.
pub(crate) struct VertexFacts {
    /// Whether the vertex sends windows when a path reaches it.
    pub(crate) pseudo_source: bool,
    /// Whether it must send them in all directions: where fans meet or end, angles are small, or
    /// edges are hardly longer than the rounding of a path's place, the spawn wedge is not known.
    pub(crate) all_around: bool,
    /// Whether the last half-edge of its ring has no face on its other side.
    pub(crate) boundary: bool,
    /// Whether the surface is flat at the vertex.
    flat: bool,
    /// Sum of the angles around it, in radians.
    pub(crate) total_angle: f32,
}

impl VertexFacts {
    /// The properties of `v`. With `lit`, vertices that [have shadows](has_shadow) send windows.
    fn new(mesh: &Mesh, v: VertexId, lit: bool) -> Self {
        let is_known = |(_, length): (VertexId, f64)| is_known(mesh, length);
        Self::of(mesh, v, lit, || mesh.neighbours(v).all(is_known))
    }

    /// The same; `is_known` tells whether the directions of all edges at `v` are known.
    fn of(mesh: &Mesh, v: VertexId, lit: bool, is_known: impl Fn() -> bool) -> Self {
        Self {
            pseudo_source: mesh.is_pseudo_source(v) || lit && has_shadow(mesh, v),
            all_around: mesh.is_boundary(v)
                || mesh.is_pinched(v)
                || mesh.is_beside_sliver(v)
                || !is_known(),
            boundary: mesh.is_boundary(v),
            flat: is_flat(mesh, v),
            total_angle: mesh.total_angle(v) as f32,
        }
    }
}

/// The numbers of the faces around a [change](MeshLayout::splice) in the layout.
pub(crate) struct FacesAround(HashMap<FaceId, u32>);

impl FacesAround {
    /// The number of a half-edge around the change. Added faces have the same number in both.
    fn number(&self, h: HalfEdgeId) -> u32 {
        let face = self.0.get(&h.face()).copied();
        half_edge(face.unwrap_or(h.face().raw()), h.corner() as usize)
    }
}

/// The mesh in the order of the solver.
#[derive(Clone, Debug)]
pub(crate) struct MeshLayout {
    pub(crate) faces: Vec<FaceLayout>,
    pub(crate) vertices: Vec<VertexFacts>,
    /// Where the half-edges that start at each vertex stand in `rings`, counter-clockwise.
    ring_rows: RowTable,
    pub(crate) rings: Vec<u32>,
    /// The angle between each half-edge and the next one, in radians.
    pub(crate) angles: Vec<f32>,
    /// The length of the longest edge.
    pub(crate) longest_edge: f64,
    /// The mean length of an edge, or twice the median where few edges are far longer than others.
    pub(crate) typical_length: f64,
    /// Whether the list on each half-edge crosses when its nearest window is due: beside thin faces
    /// and on [long](LONG) ones. Empty if there are none.
    by_distance: Vec<bool>,
    /// Whether there are some on the mesh of the set-up.
    waits_by_distance: bool,
    /// The windows stored beside thin faces, as at the start of a run.
    pub(crate) kept: KeptWindows,
    /// Whether vertices that [have shadows](has_shadow) send windows.
    lit: bool,
}

impl MeshLayout {
    pub(crate) fn new(mesh: &Mesh, numbering: &Numbering) -> Self {
        let vertex_count = mesh.vertex_count();
        let old_vertex = |v: usize| numbering.old_vertex(VertexId::new(v as u32));
        // In one pass over the lengths, which spares one around each vertex.
        let all_known = mesh.half_edges().all(|h| is_known(mesh, mesh.length(h)));
        let facts = |v| {
            if all_known {
                VertexFacts::of(mesh, v, false, || true)
            } else {
                VertexFacts::new(mesh, v, false)
            }
        };
        let vertices = threads::each(threads::ranges(vertex_count, 4), |range| {
            range.map(|v| facts(old_vertex(v))).collect()
        });
        let vertices: Vec<VertexFacts> = concatenated(vertices);
        let several = |block| FaceLayout::several(mesh, numbering, &vertices, TOGETHER * block);
        let blocks = mesh.face_count().div_ceil(TOGETHER);
        let (mut faces, mut corners) = (Vec::new(), Vec::new());
        if threads::count() == 1 {
            (faces, corners) = (0..blocks).map(several).unzip();
        } else {
            let blocks = (0..blocks).into_par_iter().map(several);
            blocks.unzip_into_vecs(&mut faces, &mut corners);
        }
        let mut faces = faces.into_flattened();
        faces.truncate(mesh.face_count());
        let corners = corners.into_flattened();

        let mut ring_starts = Vec::with_capacity(vertex_count + 1);
        ring_starts.push(0);
        let mut end = 0;
        for v in 0..vertex_count {
            end += mesh.outgoing(old_vertex(v)).len();
            ring_starts.push(end as u32);
        }
        let mut rings = vec![0; end];
        let mut angles = vec![0.0; end];
        let ranges = threads::ranges(vertex_count, 4);
        let sizes = || {
            let size = |range: &Range<usize>| ring_starts[range.end] - ring_starts[range.start];
            ranges.iter().map(move |range| size(range) as usize)
        };
        let shares = (ranges.iter())
            .zip(threads::cut(&mut rings, sizes()))
            .zip(threads::cut(&mut angles, sizes()))
            .collect();
        threads::each(shares, |((range, rings), angles)| {
            let mut places = rings.iter_mut().zip(angles);
            for v in range.clone() {
                for (&h, (ring, angle)) in mesh.outgoing(old_vertex(v)).iter().zip(&mut places) {
                    *ring = number(numbering, h);
                    let (face, corner) = parts(*ring);
                    *angle = corners[face][corner];
                }
            }
        });
        let total: f64 = mesh.half_edges().map(|h| mesh.length(h)).sum();
        let mean = total / mesh.half_edge_count().max(1) as f64;
        let typical_length = mean.min(2.0 * median_length(mesh));
        let place = |h| number(numbering, h) as usize;
        let kept = KeptWindows::new(mesh, 4 * mesh.face_count(), place).in_groups(mesh, place);
        let is_long = |f: &FaceLayout| f.is_long(typical_length);
        let waits_by_distance = !kept.is_empty() || faces.iter().any(is_long);
        let mut layout = Self {
            faces,
            vertices,
            ring_rows: RowTable::of_starts(&ring_starts),
            rings,
            angles,
            longest_edge: mesh.longest_edge(),
            typical_length,
            by_distance: Vec::new(),
            waits_by_distance,
            kept,
            lit: false,
        };
        if waits_by_distance {
            layout.by_distance.resize(4 * layout.faces.len(), false);
            (0..layout.faces.len()).for_each(|f| layout.mark(f));
        }
        layout
    }

    /// Lets vertices that [have shadows](has_shadow) send windows, if they are few. Returns whether
    /// no shadows are left.
    pub(crate) fn light_shadows(&mut self, mesh: &Mesh, numbering: &Numbering) -> bool {
        let dark = mesh.vertices().filter(|&v| has_shadow(mesh, v));
        let dark: Vec<VertexId> = dark.map(|v| numbering.new_vertex(v)).collect();
        self.lit = DARK * dark.len() <= self.vertices.len();
        for v in dark.into_iter().filter(|_| self.lit) {
            self.vertices[v.index()].pseudo_source = true;
        }
        self.lit
    }

    /// Marks what waits by distance at face `f`, and where windows are not coalesced.
    fn mark(&mut self, f: usize) {
        let face = &mut self.faces[f];
        let is_long = face.is_long(self.typical_length);
        for corner in 0..3 {
            let h = half_edge(f as u32, corner) as usize;
            let thin = self.kept.is_beside(h);
            // Stored windows are found by their images, which coalescing changes.
            face.flat[corner] &= !thin;
            self.by_distance[h] = is_long || thin;
        }
    }

    /// The numbers here of the faces around a change of `mesh`, which has not been made yet. Every
    /// edge of a changed face has an end that changes.
    pub(crate) fn around(
        &self,
        mesh: &Mesh,
        numbering: &Numbering,
        splice: &Splice,
    ) -> FacesAround {
        let known = splice
            .vertices()
            .filter(|v| v.index() < mesh.vertex_count());
        let faces = known.flat_map(|v| {
            let ring = self.ring(numbering.new_vertex(v).raw()).iter();
            let outgoing = mesh.outgoing(v).iter();
            outgoing
                .zip(ring)
                .map(|(h, &number)| (h.face(), number >> 2))
        });
        FacesAround(faces.collect())
    }

    /// Follows a change of the mesh, which is `mesh` now, between two runs. Takes time in the size
    /// of the change.
    pub(crate) fn splice(
        &mut self,
        mesh: &Mesh,
        numbering: &Numbering,
        splice: &Splice,
        around: &FacesAround,
    ) {
        let vertex = |v| numbering.new_vertex(v).raw();
        let number = |h| around.number(h);
        let vertex_count = mesh.vertex_count();
        self.vertices.resize(vertex_count, VertexFacts::default());
        for v in splice.vertices() {
            self.vertices[vertex(v) as usize] = VertexFacts::new(mesh, v, self.lit);
        }
        let none = self.faces.first().copied();
        self.faces.truncate(mesh.face_count());
        if let Some(none) = none {
            self.faces.resize(mesh.face_count(), none);
        }
        for face in splice.faces() {
            let ([layout], _) = FaceLayout::of(mesh, [face], vertex, number, &self.vertices);
            self.faces[number(face.half_edge(0)) as usize >> 2] = layout;
        }
        let old = splice
            .undoes()
            .then(|| self.ring_rows.put_back(vertex_count));
        if let Some(old) = old.flatten() {
            self.rings.truncate(old);
            self.angles.truncate(old);
        } else {
            let row = |v| (vertex(v) as usize, mesh.outgoing(v).len());
            let lengths = splice.vertices().map(row);
            self.ring_rows
                .replace(vertex_count, self.rings.len(), lengths);
            for &h in splice.vertices().flat_map(|v| mesh.outgoing(v)) {
                let angles = mesh.shapes([h.face()]).angles;
                self.rings.push(number(h));
                self.angles.push(angles[h.corner() as usize][0] as f32);
            }
        }
        let half_edges = 4 * mesh.face_count();
        self.kept
            .splice(mesh, splice, half_edges, |h| number(h) as usize);
        if !self.waits_by_distance && self.kept.is_empty() {
            self.by_distance.clear();
            return;
        }
        self.by_distance.resize(half_edges, false);
        for face in splice.faces() {
            self.mark(number(face.half_edge(0)) as usize >> 2);
        }
    }

    /// All half-edges.
    pub(crate) fn half_edges(&self) -> impl Iterator<Item = u32> {
        (0..self.faces.len() as u32).flat_map(|f| (0..3).map(move |corner| half_edge(f, corner)))
    }

    /// The ends of `h`: tail and head.
    pub(crate) fn ends(&self, h: u32) -> [VertexId; 2] {
        let (f, corner) = parts(h);
        [corner, next(corner)].map(|k| VertexId::new(self.faces[f].vertex[k]))
    }

    /// Tells `probe` the numbers here of the vertices and half-edges of `mesh`.
    pub(crate) fn renumber<P: Probe>(&self, mesh: &Mesh, numbering: &Numbering, probe: &mut P) {
        let corner = |v, i| {
            let ring = self.ring(numbering.new_vertex(v).raw());
            HalfEdgeId::new(ring[i])
        };
        probe.renumber(mesh, |v| numbering.new_vertex(v), corner);
    }

    /// Whether the list on `h` crosses when its nearest window is due, not in first-in, first-out
    /// order once its face has joined.
    #[inline(always)]
    pub(crate) fn is_by_distance(&self, h: u32) -> bool {
        !self.by_distance.is_empty() && self.by_distance[h as usize]
    }

    /// The length of `h`.
    #[inline]
    pub(crate) fn length(&self, h: u32) -> f64 {
        let (f, corner) = parts(h);
        self.faces[f].length[corner]
    }

    /// The half-edges behind the left and the right exit of the face of `h`.
    #[inline(always)]
    pub(crate) fn exits(&self, h: u32) -> [u32; 2] {
        let (f, corner) = parts(h);
        let face = &self.faces[f];
        [face.twin[prev(corner)], face.twin[next(corner)]]
    }

    /// The paths and the window that the tail of `h` sends across the face of `h`, at distance
    /// `sigma`.
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

    /// Prefetches a face.
    #[inline(always)]
    pub(crate) fn prefetch(&self, f: usize) {
        if let Some(face) = self.faces.get(f) {
            prefetch_line(face);
            prefetch_line(&face.apex_x);
        }
    }

    /// The data of half-edge `h` for the passes over its list; `ends` are the distances of its
    /// ends.
    #[inline]
    pub(crate) fn gate(&self, h: u32, ends: [f64; 2]) -> Gate {
        let (f, corner) = parts(h);
        let face = &self.faces[f];
        Gate {
            l: face.length[corner],
            apex: face.apex(corner),
            ends,
            longest: self.longest_edge,
        }
    }

    /// The third vertex of the face below `h`, in the frame of `h`; a point infinitely far below if
    /// there is no face.
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

    /// The range of the half-edges that start at `v` in `rings` and `angles`.
    #[inline]
    pub(crate) fn ring_places(&self, v: u32) -> Range<usize> {
        self.ring_rows.range(v as usize)
    }

    /// The half-edges that start at `v`, counter-clockwise.
    #[inline]
    pub(crate) fn ring(&self, v: u32) -> &[u32] {
        &self.rings[self.ring_places(v)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn same(found: &str, expected: &str) {
        for (found, expected) in found.lines().zip(expected.lines()) {
            assert_eq!(found, expected);
        }
    }

    #[test]
    fn a_changed_layout_is_that_of_the_changed_mesh_and_is_undone() {
        for spec in [
            "terrain,n=8,seed=1",
            "strip,n=30,aspect=40",
            "torus,faces=200",
        ] {
            let mut mesh = Mesh::generate(spec).unwrap();
            let numbering = Numbering::breadth_first(&mesh);
            let mut layout = MeshLayout::new(&mesh, &numbering);
            let text = |layout: &MeshLayout, digits: usize, stored: bool| {
                let MeshLayout {
                    faces,
                    vertices,
                    ring_rows,
                    rings,
                    angles,
                    by_distance,
                    ..
                } = layout;
                let kept = |h| {
                    if stored {
                        layout.kept.holds(h)
                    } else {
                        layout.kept.is_beside(h)
                    }
                };
                let kept: Vec<bool> = (0..4 * faces.len()).map(kept).collect();
                let angles = ring_rows.ranges().map(|row| &angles[row]);
                let angles: Vec<&[f32]> = angles.collect();
                let rings: Vec<&[u32]> = ring_rows.ranges().map(|row| &rings[row]).collect();
                let rest = format!("{rings:?} {by_distance:?} {kept:?}");
                let faces = faces.iter().map(|f| format!("{f:.digits$?}"));
                let faces: Vec<String> = faces.collect();
                format!(
                    "{}\n{vertices:.digits$?}\n{angles:.digits$?}\n{rest}",
                    faces.join("\n")
                )
            };
            let before = text(&layout, 17, true);
            for face in 0..20 {
                let inside = mesh
                    .point_in_face(FaceId::new(face), [0.1, 0.01, 0.89])
                    .unwrap();
                let [a, b, _] = mesh.face_vertices(FaceId::new(face + 1));
                let on_edge = mesh.point_on_edge([a, b], 0.3).unwrap();
                let insertion = mesh.insertion(&[inside, on_edge]).unwrap();
                let around = layout.around(&mesh, &numbering, insertion.splice());
                let undo = mesh.splice(insertion.splice());
                layout.splice(&mesh, &numbering, insertion.splice(), &around);
                let anew = MeshLayout::new(&mesh, &numbering);
                // Unchanged faces of a refined mesh are measured by another formula, and parts of
                // faces are in no group.
                same(&text(&layout, 5, false), &text(&anew, 5, false));
                let around = layout.around(&mesh, &numbering, &undo);
                mesh.splice(&undo);
                layout.splice(&mesh, &numbering, &undo, &around);
                same(&text(&layout, 17, true), &before);
            }
        }
    }
}
