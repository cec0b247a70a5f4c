//! From oriented triangles with edge lengths to a [`Mesh`].

use std::f64::consts::PI;

use crate::edges::EdgeGroups;
use crate::ids::{HalfEdgeId, VertexId};
use crate::mesh::{Mesh, NO_TWIN, VertexFlags};

/// Excess angle in radians that a vertex may have before it counts as a saddle. Ignoring an
/// excess of δ lengthens a path by at most about δ²/2 of itself.
const SADDLE_SLACK: f64 = 1e-8;

/// Height given to a face of no area, as a fraction of its longest edge: far below rounding, so
/// no distance changes, but enough for rays to have a side on which to pass its vertices.
const FLAT_HEIGHT: f64 = 1.0 / (1u128 << 100) as f64;

/// Builds the mesh of manifold, consistently oriented `triangles`.
///
/// `lengths[t][k]` is the length of the edge from corner `k` of triangle `t` to the next corner,
/// equal in both triangles of an edge.
pub(crate) fn build(
    vertex_count: usize,
    positions: Vec<[f64; 3]>,
    triangles: &[[u32; 3]],
    lengths: &[[f64; 3]],
) -> Mesh {
    let mut twins = vec![NO_TWIN; 3 * triangles.len()];
    for (_, _, mut half_edges) in EdgeGroups::new(vertex_count, triangles).iter() {
        if let (Some(a), Some(b)) = (half_edges.next(), half_edges.next()) {
            twins[a as usize] = b;
            twins[b as usize] = a;
        }
    }
    let mut apexes = Vec::with_capacity(3 * triangles.len());
    for l in lengths {
        apexes.extend_from_slice(&face_apexes(*l));
    }
    let mut mesh = Mesh {
        positions,
        tails: triangles
            .as_flattened()
            .iter()
            .map(|&v| VertexId::new(v))
            .collect(),
        twins,
        lengths: lengths.as_flattened().to_vec(),
        apexes,
        outgoing_starts: Vec::new(),
        outgoing: Vec::new(),
        total_angles: Vec::new(),
        flags: vec![VertexFlags::default(); vertex_count],
    };
    link_fans(&mut mesh);
    mesh
}

/// Position of the third vertex in the frame of each of a triangle's three half-edges.
///
/// With l the half-edge, a the side from its tail and b the side from its head,
/// x = (l² + (a-b)(a+b)) / 2l and y = 2S / l, the area S by Kahan's arrangement of Heron's
/// formula, which stays accurate on needles.
fn face_apexes(lengths: [f64; 3]) -> [[f64; 2]; 3] {
    let twice_area = twice_area(lengths);
    [0, 1, 2].map(|k| {
        let l = lengths[k];
        let (from_head, from_tail) = (lengths[(k + 1) % 3], lengths[(k + 2) % 3]);
        let x = (l * l + (from_tail - from_head) * (from_tail + from_head)) / (2.0 * l);
        [x, twice_area / l]
    })
}

/// Twice the area of a triangle with these sides, never below a sliver that keeps it upright.
fn twice_area(lengths: [f64; 3]) -> f64 {
    let mut sides = lengths;
    sides.sort_unstable_by(f64::total_cmp);
    let [c, b, a] = sides;
    // Factors of 16 S², scaled by the longest side so that their product cannot under- or overflow.
    let (p, q, r, s) = (a + (b + c), c - (a - b), c + (a - b), a + (b - c));
    let sixteen_s2 = (p / a) * (q / a) * (r / a) * (s / a);
    let relative = sixteen_s2.max(0.0).sqrt() / 2.0;
    relative.max(FLAT_HEIGHT) * a * a
}

/// Orders the half-edges around every vertex, and derives its angle and flags.
fn link_fans(mesh: &mut Mesh) {
    let vertex_count = mesh.flags.len();
    let mut starts = vec![0u32; vertex_count + 1];
    for v in &mesh.tails {
        starts[v.index() + 1] += 1;
    }
    for i in 0..vertex_count {
        starts[i + 1] += starts[i];
    }
    let mut cursor = starts.clone();
    let mut outgoing = vec![HalfEdgeId::default(); mesh.tails.len()];
    let mut angles = vec![0.0; vertex_count];
    let mut fans = vec![0u32; vertex_count];
    let mut seen = vec![false; mesh.tails.len()];
    // Open fans first, each from its clockwise end; what is left then are closed ones.
    for open in [true, false] {
        for h in (0..mesh.tails.len() as u32).map(HalfEdgeId::new) {
            if seen[h.index()] || open && mesh.twin(h).is_some() {
                continue;
            }
            let v = mesh.tail(h).index();
            let mut fan_angle = 0.0;
            let mut next = Some(h);
            while let Some(g) = next.filter(|g| !seen[g.index()]) {
                seen[g.index()] = true;
                outgoing[cursor[v] as usize] = g;
                cursor[v] += 1;
                let [x, y] = mesh.apex(g);
                fan_angle += y.atan2(x);
                next = mesh.twin(g.prev());
            }
            let limit = if open { PI } else { 2.0 * PI };
            let flags = &mut mesh.flags[v];
            flags.boundary |= open;
            flags.saddle |= fan_angle > limit + SADDLE_SLACK;
            angles[v] += fan_angle;
            fans[v] += 1;
        }
    }
    for (flags, &count) in mesh.flags.iter_mut().zip(&fans) {
        flags.pinched = count > 1;
    }
    mesh.outgoing_starts = starts;
    mesh.outgoing = outgoing;
    mesh.total_angles = angles;
}
