//! Checks that a path is a shortest one, from the path, its length and the mesh alone.

#![allow(dead_code)] // Each test program uses a part of it.

use std::f64::consts::PI;

use geobench_mesh::{FaceId, HalfEdgeId, Mesh, VertexId};
use geobench_paths::{Path, PathPlace, Point};

/// Checks that `path` goes from one of `sources` to `target`, has length `d`, is straight across
/// every edge, and has an angle of at least π on both sides of each vertex that it passes.
pub(crate) fn check_path(
    mesh: &Mesh,
    path: &Path,
    sources: &[u32],
    target: VertexId,
    d: f64,
) -> Result<(), String> {
    check_ends(path, sources, target)?;
    check_length(mesh, path, d)?;
    check_bends(mesh, path, d)
}

/// Checks that `path` goes from one of `sources` to `target`.
pub(crate) fn check_ends(path: &Path, sources: &[u32], target: VertexId) -> Result<(), String> {
    let points = &path.points;
    let ends = [points[0].vertex(), points[points.len() - 1].vertex()];
    if ends[1] != Some(target) || !ends[0].is_some_and(|v| sources.contains(&v.raw())) {
        return Err(format!("it goes from {:?} to {:?}", ends[0], ends[1]));
    }
    Ok(())
}

/// Checks that `path` has length `d`, to 1e-12 of `d` and the rounding of its points along edges.
pub(crate) fn check_length(mesh: &Mesh, path: &Path, d: f64) -> Result<(), String> {
    let slack = 2.0 * f64::EPSILON * longest_edge(mesh) * path.points.len() as f64;
    let mut length = 0.0;
    for pair in path.points.windows(2) {
        length += shared_faces(mesh, [&pair[0], &pair[1]])
            .map(|(_, [a, b])| (a[0] - b[0]).hypot(a[1] - b[1]))
            .fold(f64::INFINITY, f64::min);
    }
    for (what, found) in [("said", path.length), ("measured", length)] {
        let off = (found - d).abs();
        if off.is_nan() || off > 1e-12 * d + slack {
            return Err(format!(
                "{found} long as {what}, for a distance of {d}, {:e} of it too long",
                (found - d) / d
            ));
        }
    }
    Ok(())
}

/// Checks that `path`, of length `d`, is straight across every edge and cannot be cut short at a
/// vertex.
pub(crate) fn check_bends(mesh: &Mesh, path: &Path, d: f64) -> Result<(), String> {
    let points = &path.points;
    // If a path is short in comparison with its edges, the rounding of the edges exceeds its own.
    let longest = mesh
        .half_edges()
        .map(|h| mesh.length(h))
        .fold(0.0, f64::max);
    for triple in points.windows(3) {
        let [before, point, after] = [0, 1, 2].map(|k| &triple[k]);
        let (bend, most) = match point.place {
            PathPlace::Vertex(v) => (
                shortcut_at_vertex(mesh, v, [before, after]),
                1e-13 * d + 1e-15 * longest,
            ),
            PathPlace::Edge { .. } => (
                bend_at_edge(mesh, point, [before, after]),
                1e-10 * d + 1e-15 * longest,
            ),
            PathPlace::Face => (f64::INFINITY, 0.0),
        };
        if bend.is_nan() || bend > most {
            return Err(format!("a bend of {bend:e} at {point:?}, {d} long"));
        }
    }
    let crossed = path.edges().count();
    if crossed > mesh.face_count() {
        return Err(format!("{crossed} edges crossed"));
    }
    Ok(())
}

fn longest_edge(mesh: &Mesh) -> f64 {
    mesh.half_edges()
        .map(|h| mesh.length(h))
        .fold(0.0, f64::max)
}

/// The corners of the face of `h` in the frame of `h`, in the order of the face. In this frame, a
/// short edge from the tail of `h` is not the difference of two long ones.
fn corners(mesh: &Mesh, h: HalfEdgeId) -> [[f64; 2]; 3] {
    let own = [[0.0; 2], [mesh.length(h), 0.0], mesh.apex(h)];
    let first = h.corner() as usize;
    [0, 1, 2].map(|k| own[(k + 3 - first) % 3])
}

/// The position of a point in the frame of `h`; `None` if it is not on a side of the face of `h`.
fn place(mesh: &Mesh, h: HalfEdgeId, point: &Point) -> Option<[f64; 2]> {
    let f = h.face();
    let at = corners(mesh, h);
    let vertices = mesh.face_vertices(f);
    let corner = |v| vertices.iter().position(|&u| u == v);
    match point.place {
        PathPlace::Vertex(v) => corner(v).map(|k| at[k]),
        PathPlace::Edge { ends: [a, b], t } => {
            let own = point.face?;
            let edge = (0..3).map(|k| own.half_edge(k)).find(|&h| {
                let ends = [mesh.tail(h), mesh.head(h)];
                ends == [a, b] || ends == [b, a]
            })?;
            if own != f && mesh.twin(edge).map(HalfEdgeId::face) != Some(f) {
                return None;
            }
            let (a, b) = (at[corner(a)?], at[corner(b)?]);
            Some([0, 1].map(|k| (1.0 - t) * a[k] + t * b[k]))
        }
        PathPlace::Face => None,
    }
}

/// The faces that contain both points, with the positions of the points in each.
fn shared_faces(mesh: &Mesh, [a, b]: [&Point; 2]) -> impl Iterator<Item = (FaceId, [[f64; 2]; 2])> {
    let around = |point: &Point| -> Vec<FaceId> {
        if let PathPlace::Vertex(v) = point.place {
            return mesh.outgoing(v).iter().map(|h| h.face()).collect();
        }
        let own = point.face.into_iter();
        let halves = own.flat_map(|f| (0..3).map(move |k| f.half_edge(k)));
        let beyond = halves.filter_map(|h| mesh.twin(h)).map(HalfEdgeId::face);
        beyond.chain(point.face).collect()
    };
    let faces = around(a).into_iter();
    let shared = faces.filter_map(|f| {
        let h = f.half_edge(0);
        Some((f, [place(mesh, h, a)?, place(mesh, h, b)?]))
    });
    shared.collect::<Vec<_>>().into_iter()
}

/// By how much the path bends where it crosses an edge: the deviation from a straight angle, times
/// the length of the shorter adjacent piece.
///
/// The angles are measured in the frames of the crossed edge. In the frame of a long edge, the ends
/// of a short one are differences of long vectors.
fn bend_at_edge(mesh: &Mesh, point: &Point, [before, after]: [&Point; 2]) -> f64 {
    let PathPlace::Edge { ends, t } = point.place else {
        return f64::INFINITY;
    };
    let own = point
        .face
        .into_iter()
        .flat_map(|f| (0..3).map(move |k| f.half_edge(k)));
    let sides = own.flat_map(|h| [Some(h), mesh.twin(h)]).flatten();
    let sides: Vec<HalfEdgeId> = sides
        .filter(|&h| {
            let found = [mesh.tail(h), mesh.head(h)];
            found == ends || found == [ends[1], ends[0]]
        })
        .collect();
    // The angle at the point between the first end of the edge and `to`, and the distance of `to`.
    let seen = |h: HalfEdgeId, to: &Point| -> Option<(f64, f64)> {
        let [x, y] = place(mesh, h, to)?;
        let (l, is_forward) = (mesh.length(h), mesh.tail(h) == ends[0]);
        let x = if is_forward {
            x - t * l
        } else {
            x - (1.0 - t) * l
        };
        let towards = if is_forward { -x } else { x };
        Some((y.atan2(towards), norm([x, y])))
    };
    let mut least = f64::INFINITY;
    for &h in &sides {
        for &g in sides.iter().filter(|&&g| g != h) {
            if let (Some((a, p)), Some((b, q))) = (seen(h, before), seen(g, after)) {
                least = least.min((a + b - PI).abs() * p.min(q));
            }
        }
    }
    least
}

/// An upper bound of what the path could save by a shortcut through the faces around a vertex, on a
/// side with an angle below π. 0 for a pinched vertex.
///
/// Beside the tip of a needle, the angle alone is no criterion: the path passes one of two vertices
/// that are 1e-12 apart, and the other one blocks the shortcut.
fn shortcut_at_vertex(mesh: &Mesh, v: VertexId, [before, after]: [&Point; 2]) -> f64 {
    if mesh.is_pinched(v) {
        return 0.0;
    }
    let total = mesh.total_angle(v);
    let directions = |point: &Point| -> Vec<(f64, f64)> {
        let mut sum = 0.0;
        let mut found = Vec::new();
        for &h in mesh.outgoing(v) {
            let angle = |[x, y]: [f64; 2]| y.atan2(x);
            if let Some(p) = place(mesh, h, point) {
                found.push((sum + angle(p), norm(p)));
            }
            sum += angle(mesh.apex(h));
        }
        found
    };
    let mut sum = 0.0;
    let mut spokes = Vec::new();
    for &h in mesh.outgoing(v) {
        spokes.push((sum, mesh.length(h)));
        let [x, y] = mesh.apex(h);
        sum += y.atan2(x);
    }
    // A shortcut on a side with this angle crosses the spokes there. Through a point at most `s`
    // from `v` it saves at most `s (cos α + cos β)`, where α + β is the angle.
    let saved = |angle: f64, arm: f64, is_inside: &dyn Fn(f64) -> bool| {
        let bend = (PI - angle).max(0.0);
        let inside = spokes.iter().filter(|&&(at, _)| is_inside(at));
        let nearest = inside.map(|&(_, s)| s).fold(f64::INFINITY, f64::min);
        if bend == 0.0 {
            return 0.0;
        }
        (arm * bend * bend / 2.0).min(nearest * bend)
    };
    let mut least = f64::INFINITY;
    for (a, p) in directions(before) {
        for &(b, q) in &directions(after) {
            let (low, high) = (a.min(b), a.max(b));
            let mut found = saved(high - low, p.min(q), &|at| low < at && at < high);
            if !mesh.is_boundary(v) {
                let outside = |at| at < low || at > high;
                found = found.max(saved(total - (high - low), p.min(q), &outside));
            }
            least = least.min(found);
        }
    }
    least
}

fn sub(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn norm([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}
