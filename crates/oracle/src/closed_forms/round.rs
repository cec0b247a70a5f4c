//! Surfaces that unfold into the plane repeatedly: boxes, tetrahedra, tori, prisms, cones.

use std::f64::consts::PI;

use super::ClosedForm;
use crate::model::Model;
use crate::zoo::{
    Diagonal, EQUILATERAL, SADDLE_FANS, cone, cuboid, disphenoid, flat_torus, icosahedron,
    octahedron, pillow, prism,
};

const ROOT_3: f64 = 1.732_050_807_568_877_2;
const ROOT_7: f64 = 2.645_751_311_064_590_7;

/// Number of copies to consider on either side, more than any shortest path crosses.
const REACH: i32 = 4;

pub(super) fn boxes() -> Vec<ClosedForm> {
    let mut cases = Vec::new();
    for diagonal in [Diagonal::Rising, Diagonal::Falling, Diagonal::Alternating] {
        for size in [
            [1, 1, 1],
            [2, 2, 2],
            [8, 8, 8],
            [3, 4, 5],
            [1, 2, 9],
            [6, 6, 1],
        ] {
            let model = cuboid(size, diagonal);
            let points = model.positions().unwrap_or_default().to_vec();
            let size = size.map(f64::from);
            cases.push(ClosedForm::new(model.only_from(&[0]), move |_, to| {
                from_corner(size, points[to as usize])
            }));
        }
    }
    cases
}

/// The distance from the origin, a corner of the box, to `point` on its surface.
fn from_corner(size: [f64; 3], point: [f64; 3]) -> Option<f64> {
    if point.contains(&0.0) {
        return Some(point[0].hypot(point[1]).hypot(point[2]));
    }
    let far = (0..3).filter(|&axis| point[axis] == size[axis]);
    if size[0] == size[1] && size[1] == size[2] {
        // Over either of the two faces that lie between the corner and a face at the opposite
        // corner.
        let over = |axis: usize| {
            let [a, b] = [point[(axis + 1) % 3], point[(axis + 2) % 3]];
            (size[axis] + a).hypot(b).min((size[axis] + b).hypot(a))
        };
        return far.map(over).reduce(f64::min);
    }
    let [a, b, c] = size;
    (point == size).then(|| (a + b).hypot(c).min((a + c).hypot(b)).min((b + c).hypot(a)))
}

pub(super) fn disphenoids() -> Vec<ClosedForm> {
    let mut cases = Vec::new();
    for size in [[1.0, 1.0, 1.0], [2.0, 3.0, 4.0], [3.0, 3.0, 1.0]] {
        for parts in [1, 2, 3, 8] {
            let whole = disphenoid(size);
            let [a, b, c] = [
                size[0].hypot(size[1]),
                size[0].hypot(size[2]),
                size[1].hypot(size[2]),
            ];
            // The first face in the plane, with its corner 0 at the origin.
            let x = (a * a + b * b - c * c) / (2.0 * a);
            let [u, v] = [[a, 0.0], [x, (b * b - x * x).sqrt()]];
            let places = crate::subdivide(4, &whole.triangles, parts).weights;
            let layout = places.iter().map(|weights| {
                let part = |corner: u32| {
                    let weight = weights.iter().find(|(v, _)| *v == corner);
                    weight.map_or(0.0, |(_, w)| f64::from(*w) / f64::from(parts))
                };
                // The other faces, rotated about the midpoints of the edges of the first.
                let [p, q, r] = [1, 2, 3].map(part);
                let [along_u, along_v] = if part(0) == 0.0 {
                    [p + r, q + r]
                } else if p == 0.0 {
                    [-r, q + r]
                } else {
                    [p + r, q - r]
                };
                [0, 1].map(|axis| along_u * u[axis] + along_v * v[axis])
            });
            let spans = [u, v].map(|w| w.map(|x| 2.0 * x));
            cases.push(turned_plane(
                whole.subdivided(parts),
                layout.collect(),
                spans,
            ));
        }
    }
    cases
}

pub(super) fn pillows() -> Vec<ClosedForm> {
    let of_size = |[m, n]: [u32; 2]| {
        let (model, below) = pillow([m, n]);
        let points = model.positions().unwrap_or_default().iter().zip(below);
        let layout = points.map(|(&[x, y, _], below)| [if below { -x } else { x }, y]);
        let spans = [[2.0 * f64::from(m), 0.0], [0.0, 2.0 * f64::from(n)]];
        let layout = layout.collect();
        turned_plane(model, layout, spans)
    };
    [[2, 2], [3, 2], [6, 6], [10, 2]].map(of_size).into()
}

/// A surface that is the plane with x and -x + (a lattice vector) identified.
fn turned_plane(model: Model, layout: Vec<[f64; 2]>, spans: [[f64; 2]; 2]) -> ClosedForm {
    ClosedForm::new(model, move |from, to| {
        let [s, t] = [from, to].map(|v| layout[v as usize]);
        let turned = t.map(|x| -x);
        Some(to_nearest_copy(s, t, spans).min(to_nearest_copy(s, turned, spans)))
    })
}

fn to_nearest_copy(s: [f64; 2], t: [f64; 2], [u, v]: [[f64; 2]; 2]) -> f64 {
    let mut best = f64::INFINITY;
    for i in -REACH..=REACH {
        for j in -REACH..=REACH {
            let (i, j) = (f64::from(i), f64::from(j));
            let [x, y] = [0, 1].map(|axis| t[axis] - s[axis] + (i * u[axis] + j * v[axis]));
            best = best.min(x.hypot(y));
        }
    }
    best
}

pub(super) fn platonic_solids() -> Vec<ClosedForm> {
    // By the number of edges between two corners, for edges of length 1.
    let of_corners = |model: Model, edge: f64, by_steps: &'static [f64]| {
        let triangles = model.triangles.clone();
        let adjacent =
            move |a: u32, b: u32| triangles.iter().any(|t| t.contains(&a) && t.contains(&b));
        let count = model.vertex_count as u32;
        ClosedForm::new(model, move |from, to| {
            let steps = if from == to {
                0
            } else if adjacent(from, to) {
                1
            } else if (0..count).any(|via| adjacent(from, via) && adjacent(via, to)) {
                2
            } else {
                3
            };
            Some(edge * by_steps[steps])
        })
    };
    vec![
        of_corners(octahedron(), std::f64::consts::SQRT_2, &[0.0, 1.0, ROOT_3]),
        of_corners(icosahedron(), 2.0, &[0.0, 1.0, ROOT_3, ROOT_7]),
    ]
}

pub(super) fn flat_tori() -> Vec<ClosedForm> {
    let mut cases = Vec::new();
    for size in [[3, 3], [8, 8], [12, 4]] {
        for [u, v] in [
            [[1.0, 0.0], [0.0, 1.0]],
            [[1.0, 0.0], [0.5, 0.75]],
            [[4.0, 0.0], [0.0, 3.0]],
        ] {
            for jitter in [0.0, 0.2] {
                let (model, layout) = flat_torus(size, u, v, jitter);
                let spans = [
                    u.map(|x| x * f64::from(size[0])),
                    v.map(|x| x * f64::from(size[1])),
                ];
                cases.push(ClosedForm::new(model, move |from, to| {
                    let [s, t] = [from, to].map(|v| layout[v as usize]);
                    Some(to_nearest_copy(s, t, spans))
                }));
            }
        }
    }
    cases
}

pub(super) fn prisms() -> Vec<ClosedForm> {
    let mut cases = Vec::new();
    for diagonal in [Diagonal::Rising, Diagonal::Alternating] {
        for (corners, levels, step) in [(4, 4, 1.0), (6, 10, 0.5), (16, 8, 1.0), (3, 12, 0.25)] {
            let model = prism(corners, levels, step, diagonal);
            cases.push(ClosedForm::new(model, move |from, to| {
                let [s, t] = [from, to].map(|v| [f64::from(v % corners), f64::from(v / corners)]);
                let around = (s[0] - t[0]).abs();
                let around = around.min(f64::from(corners) - around);
                Some(around.hypot(step * (s[1] - t[1])))
            }));
        }
    }
    cases
}

pub(super) fn cones() -> Vec<ClosedForm> {
    let mut fans: Vec<_> = [3, 4, 5, 6]
        .into_iter()
        .chain(SADDLE_FANS)
        .map(|n| (n, EQUILATERAL))
        .collect();
    // Total angles of 1.06, 1.12, 1.88 and 3.09 full turns, and exactly one full turn in 5 and 8
    // wedges.
    fans.extend(
        [
            (7, 1.06),
            (7, 1.12),
            (12, 1.88),
            (20, 3.09),
            (5, 1.0),
            (8, 1.0),
        ]
        .map(|(wedges, turns)| (wedges, 2.0 * PI * turns / f64::from(wedges))),
    );
    let mut cases = Vec::new();
    for (wedges, angle) in fans {
        for parts in [1, 2, 5] {
            let (model, polar) = cone(wedges, angle, parts);
            let total = f64::from(wedges) * angle;
            cases.push(ClosedForm::new(model, move |from, to| {
                let [[r, phi], [s, psi]] = [from, to].map(|v| polar[v as usize]);
                let apart = (phi - psi).abs();
                let apart = apart.min(total - apart);
                // In this form small distances keep their digits.
                let across = 2.0 * (r * s).sqrt() * (apart / 2.0).sin();
                Some(if apart < PI {
                    (r - s).hypot(across)
                } else {
                    r + s
                })
            }));
        }
    }
    cases
}
