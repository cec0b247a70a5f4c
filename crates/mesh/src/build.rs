//! Builds a [`Mesh`] from oriented triangles with edge lengths.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::Arc;

use crate::corner::corner_angle;
use crate::ids::{HalfEdgeId, VertexId};
use crate::junctions::Junctions;
use crate::mesh::{Extremes, Mesh, MeshData, VertexFlags};
use crate::precision::SLIVER_HEIGHT;
use crate::rows::RowTable;
use crate::stand_ins::StandIns;

/// Excess angle in radians that a vertex may have without being a saddle. Ignoring an excess of δ
/// lengthens a path by at most about δ²/2 of itself.
const SADDLE_SLACK: f64 = 1e-8;

/// Builds the mesh of `triangles`, which are oriented consistently except at junctions.
///
/// `lengths[t][k]` is the length of the edge from corner `k` of triangle `t` to the next corner. It
/// is the same in all triangles of an edge. `twins` pairs the half-edges that are along no
/// junction. `positions` may be empty. Copies in `stand_ins` are in no triangle.
pub(crate) fn build(
    vertex_count: usize,
    positions: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    lengths: Vec<[f64; 3]>,
    (twins, junctions): (Vec<u32>, Junctions),
    stand_ins: StandIns,
) -> Mesh {
    let data = MeshData {
        positions,
        tails: triangles
            .into_flattened()
            .into_iter()
            .map(VertexId::new)
            .collect(),
        twins,
        lengths: lengths.into_flattened(),
        outgoing_rows: RowTable::default(),
        outgoing: Vec::new(),
        total_angles: Vec::new(),
        flags: vec![VertexFlags::default(); vertex_count],
        extremes: Extremes::default(),
        frames: BTreeMap::new(),
        stand_ins,
        junctions,
    };
    let data = Arc::new(data);
    let mut mesh = Mesh { data };
    link_fans(&mut mesh);
    mark_slivers(&mut mesh);
    mesh
}

/// The flags of a vertex inside a face, or on an edge of `faces` faces, which may be a junction.
pub(crate) fn flat_flags(faces: u32, is_junction: bool) -> VertexFlags {
    VertexFlags {
        boundary: faces == 1,
        pinched: is_junction,
        ..VertexFlags::default()
    }
}

/// The ascending half-edges that leave a vertex, in the order of [`Mesh::outgoing`].
pub(crate) fn in_fans(
    outgoing: &[HalfEdgeId],
    twin: impl Fn(HalfEdgeId) -> Option<HalfEdgeId>,
) -> Vec<HalfEdgeId> {
    let mut fans = Vec::with_capacity(outgoing.len());
    let mut seen = vec![false; outgoing.len()];
    let mut is_new = |h: &HalfEdgeId| {
        let place = outgoing.binary_search(h);
        place.is_ok_and(|place| !std::mem::replace(&mut seen[place], true))
    };
    // Open fans first, each from its clockwise end. All remaining fans are closed.
    for open in [true, false] {
        for &h in outgoing {
            let mut next = Some(h).filter(|&h| !(open && twin(h).is_some()));
            while let Some(g) = next.filter(&mut is_new) {
                fans.push(g);
                next = twin(g.prev());
            }
        }
    }
    fans
}

/// Whether a face with this longest edge and twice this area is a sliver.
pub(crate) fn is_sliver(longest: f64, twice_area: f64) -> bool {
    twice_area < SLIVER_HEIGHT * longest * longest
}

/// The data of a mesh that is not shared yet, so that nothing is copied.
fn data_of(mesh: &mut Mesh) -> &mut MeshData {
    Arc::make_mut(&mut mesh.data)
}

/// Flags the corners of slivers and sets the extremes of all faces.
fn mark_slivers(mesh: &mut Mesh) {
    let mut extremes = Extremes::default();
    for face in mesh.faces() {
        let lengths = mesh.side_lengths(face);
        let longest = lengths[0].max(lengths[1]).max(lengths[2]);
        let twice_area = lengths[0] * mesh.apexes(face)[0][1];
        extremes = extremes.with(Extremes::of(longest, twice_area));
        if is_sliver(longest, twice_area) {
            for v in mesh.face_vertices(face) {
                data_of(mesh).flags[v.index()].beside_sliver = true;
            }
        }
    }
    data_of(mesh).extremes = extremes;
}

/// Whether a fan with this sum of angles makes its vertex a saddle.
pub(crate) fn is_saddle(fan_angle: f64, open: bool) -> bool {
    fan_angle > if open { PI } else { 2.0 * PI } + SADDLE_SLACK
}

/// Orders the half-edges around every vertex and sets its angle and flags.
fn link_fans(mesh: &mut Mesh) {
    let mut all_flags = std::mem::take(&mut data_of(mesh).flags);
    let tails = &mesh.data.tails;
    let vertex_count = all_flags.len();
    let mut starts = vec![0u32; vertex_count + 1];
    for v in tails {
        starts[v.index() + 1] += 1;
    }
    for i in 0..vertex_count {
        starts[i + 1] += starts[i];
    }
    let mut cursor = starts.clone();
    let mut outgoing = vec![HalfEdgeId::default(); tails.len()];
    let mut angles = vec![0.0; vertex_count];
    let mut fans = vec![0u32; vertex_count];
    let mut seen = vec![false; tails.len()];
    let corner_angles: Vec<[f64; 3]> = mesh
        .faces()
        .map(|face| mesh.apexes(face).map(corner_angle))
        .collect();
    // Open fans first, each from its clockwise end. All remaining fans are closed.
    for open in [true, false] {
        for h in (0..tails.len() as u32).map(HalfEdgeId::new) {
            if seen[h.index()] || open && mesh.twin(h).is_some() {
                continue;
            }
            let v = mesh.tail(h).index();
            let mut fan_angle = 0.0;
            let mut next = Some(h);
            let mut last = h;
            while let Some(g) = next.filter(|g| !seen[g.index()]) {
                seen[g.index()] = true;
                outgoing[cursor[v] as usize] = g;
                cursor[v] += 1;
                fan_angle += corner_angles[g.face().index()][g.corner() as usize];
                last = g.prev();
                next = mesh.twin(last);
            }
            let flags = &mut all_flags[v];
            flags.boundary |= open && [h, last].iter().any(|&end| mesh.is_boundary_edge(end));
            flags.saddle |= is_saddle(fan_angle, open);
            angles[v] += fan_angle;
            fans[v] += 1;
        }
    }
    for (flags, &count) in all_flags.iter_mut().zip(&fans) {
        flags.pinched = count > 1;
    }
    let data = data_of(mesh);
    data.outgoing_rows = RowTable::of_starts(&starts);
    data.outgoing = outgoing;
    data.total_angles = angles;
    data.flags = all_flags;
}
