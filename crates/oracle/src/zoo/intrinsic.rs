//! Surfaces given by edge lengths, most of which have no embedding in space.

use std::collections::HashMap;
use std::f64::consts::PI;

use super::plane::{Diagonal, cells};
use crate::model::Model;
use crate::random::Random;

/// A flat surface given by positions in the plane, triangle by triangle.
pub(crate) fn from_layout(
    name: String,
    vertex_count: usize,
    triangles: Vec<[u32; 3]>,
    corners: &[[[f64; 2]; 3]],
) -> Model {
    let length = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    // Copies of an edge elsewhere in the plane round differently, so the length of the first one is
    // used for all.
    let mut by_ends = HashMap::new();
    let mut lengths = vec![[0.0; 3]; triangles.len()];
    for (t, triangle) in triangles.iter().enumerate() {
        for k in 0..3 {
            let [v, w] = [triangle[k], triangle[(k + 1) % 3]];
            let computed = length(corners[t][k], corners[t][(k + 1) % 3]);
            lengths[t][k] = *by_ends.entry([v.min(w), v.max(w)]).or_insert(computed);
        }
    }
    Model::from_lengths(name, vertex_count, triangles, lengths)
}

/// A flat torus of m × n cells spanned by `u` and `v`, and the position of each vertex in the
/// plane. Vertices are moved by up to `jitter` cells.
///
/// # Panics
///
/// If there are fewer than three cells in a direction, in which case two edges would join the same
/// vertices.
pub(crate) fn flat_torus(
    [m, n]: [u32; 2],
    u: [f64; 2],
    v: [f64; 2],
    jitter: f64,
) -> (Model, Vec<[f64; 2]>) {
    assert!(m >= 3 && n >= 3, "{m} x {n} cells are too few");
    let mut random = Random::new(u64::from(m * n));
    let span = |i: f64, j: f64| [0, 1].map(|axis| i * u[axis] + j * v[axis]);
    let offsets: Vec<_> = (0..m * n)
        .map(|_| [0; 2].map(|_| random.between(-jitter, jitter)))
        .collect();
    let number = |i: u32, j: u32| (i % m) * n + j % n;
    let place = |i: u32, j: u32| {
        let [di, dj] = offsets[number(i, j) as usize];
        span(f64::from(i) + di, f64::from(j) + dj)
    };
    // One triangulation with open seams and one with closed seams: the triangles are the same.
    let all = |_, _| true;
    let open = cells([m, n], Diagonal::Rising, all, |i, j| i * (n + 1) + j);
    let closed = cells([m, n], Diagonal::Rising, all, number);
    let corner = |w: u32| place(w / (n + 1), w % (n + 1));
    let corners: Vec<_> = open.iter().map(|t| t.map(corner)).collect();
    let layout = (0..m).flat_map(|i| (0..n).map(move |j| (i, j)));
    let layout = layout.map(|(i, j)| place(i, j)).collect();
    let name = format!("flat {m} x {n} torus {u:?} {v:?}, jitter {jitter}");
    (
        from_layout(name, (m * n) as usize, closed, &corners),
        layout,
    )
}

/// A cone of `wedges` triangles around vertex 0, and the polar coordinates of each vertex. Each
/// triangle has sides of length 1 and `angle` at vertex 0, and is cut into `parts`² triangles.
pub fn cone(wedges: u32, angle: f64, parts: u32) -> (Model, Vec<[f64; 2]>) {
    let corners: Vec<_> = (0..wedges)
        .map(|i| [0, i + 1, (i + 1) % wedges + 1])
        .collect();
    let base = 2.0 * (angle / 2.0).sin();
    let lengths = vec![[1.0, base, 1.0]; wedges as usize];
    let name = format!("cone of {wedges} wedges of {angle:.4}");
    let model = Model::from_lengths(name, wedges as usize + 1, corners.clone(), lengths);
    let cut = crate::subdivide(wedges as usize + 1, &corners, parts);
    let polar = cut.weights.iter().map(|weights| {
        let rim: Vec<_> = weights.iter().filter(|(v, _)| *v > 0).collect();
        let part = |weight: u32| f64::from(weight) / f64::from(parts);
        match rim[..] {
            [] => [0.0, 0.0],
            [&(v, weight)] => [part(weight), f64::from(v - 1) * angle],
            [&(v, a), &(w, b), ..] => {
                // Between adjacent spokes; the last wedge is between the last and the first.
                let ((v, a), b) = if w == v + 1 { ((v, a), b) } else { ((w, b), a) };
                let (sin, cos) = angle.sin_cos();
                let [x, y] = [part(a) + part(b) * cos, part(b) * sin];
                [x.hypot(y), f64::from(v - 1) * angle + y.atan2(x)]
            }
        }
    });
    let polar = polar.collect();
    (model.subdivided(parts).starting_at(&[0, 1]), polar)
}

/// Numbers of equilateral triangles with which a cone has more than a full turn.
pub(crate) const SADDLE_FANS: [u32; 3] = [7, 8, 12];

/// The angle of an equilateral triangle.
pub(crate) const EQUILATERAL: f64 = PI / 3.0;
