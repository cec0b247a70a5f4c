//! Closed surfaces, and the lateral surface of a prism.

use std::collections::HashMap;
use std::f64::consts::PI;

use super::plane::{Diagonal, cells};
use crate::model::Model;
use crate::random::Random;

/// Gives equal points of an integer lattice equal numbers.
#[derive(Default)]
pub(crate) struct Lattice {
    numbers: HashMap<[u32; 3], u32>,
    pub(crate) positions: Vec<[f64; 3]>,
}

impl Lattice {
    pub(crate) fn vertex(&mut self, point: [u32; 3]) -> u32 {
        *self.numbers.entry(point).or_insert_with(|| {
            self.positions.push(point.map(f64::from));
            self.positions.len() as u32 - 1
        })
    }
}

/// The surface of a box of integer size, in unit cells. Vertex 0 is the origin.
pub fn cuboid(size: [u32; 3], diagonal: Diagonal) -> Model {
    let mut lattice = Lattice::default();
    lattice.vertex([0, 0, 0]);
    let mut triangles = Vec::new();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for top in [false, true] {
            let point = |i: u32, j: u32| {
                // Seen from outside, the lower faces are mirrored.
                let (i, j) = if top { (i, j) } else { (j, i) };
                let mut point = [0; 3];
                (point[axis], point[u], point[v]) = (if top { size[axis] } else { 0 }, i, j);
                point
            };
            let extent = if top {
                [size[u], size[v]]
            } else {
                [size[v], size[u]]
            };
            let face = cells(
                extent,
                diagonal,
                |_, _| true,
                |i, j| lattice.vertex(point(i, j)),
            );
            triangles.extend(face);
        }
    }
    let [a, b, c] = size;
    Model::new(
        format!("{a} x {b} x {c} box, {diagonal:?}"),
        lattice.positions,
        triangles,
    )
}

/// The tetrahedron with congruent faces that is inscribed in a box of this size.
pub fn disphenoid([p, q, r]: [f64; 3]) -> Model {
    let positions = vec![[0.0, 0.0, 0.0], [p, q, 0.0], [p, 0.0, r], [0.0, q, r]];
    let triangles = vec![[0, 1, 2], [1, 3, 2], [0, 3, 1], [0, 2, 3]];
    Model::new(
        format!("disphenoid in a {p} x {q} x {r} box"),
        positions,
        triangles,
    )
}

/// A doubly covered rectangle of m × n unit cells: two sheets joined along the boundary, all with z
/// = 0. The second list tells which vertices are on the lower sheet. Each cell has a vertex in its
/// middle, so that no edge joins two vertices of the boundary across a sheet.
pub(crate) fn pillow([m, n]: [u32; 2]) -> (Model, Vec<bool>) {
    let mut lattice = Lattice::default();
    let mut triangles = Vec::new();
    for sheet in [0, 1] {
        for i in 0..m {
            for j in 0..n {
                // In half cells, so that the middle has integer coordinates.
                let middle = lattice.vertex([2 * i + 1, 2 * j + 1, sheet]);
                let mut corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[di, dj]| {
                    let [x, y] = [i + di, j + dj];
                    let rim = x == 0 || y == 0 || x == m || y == n;
                    lattice.vertex([2 * x, 2 * y, if rim { 0 } else { sheet }])
                });
                if sheet == 1 {
                    corners.reverse();
                }
                triangles.extend((0..4).map(|k| [corners[k], corners[(k + 1) % 4], middle]));
            }
        }
    }
    let below = lattice.positions.iter().map(|p| p[2] > 0.0).collect();
    let flat = |[x, y, _]: [f64; 3]| [x / 2.0, y / 2.0, 0.0];
    let positions = lattice.positions.into_iter().map(flat).collect();
    (
        Model::new(format!("{m} x {n} pillow"), positions, triangles),
        below,
    )
}

/// A regular octahedron with edges of length √2.
pub fn octahedron() -> Model {
    let mut positions = Vec::new();
    for axis in 0..3 {
        for sign in [1.0, -1.0] {
            let mut point = [0.0; 3];
            point[axis] = sign;
            positions.push(point);
        }
    }
    let triangles = vec![
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
    ];
    Model::new("octahedron", positions, triangles)
}

/// A regular icosahedron with edges of length 2.
pub fn icosahedron() -> Model {
    let golden = f64::midpoint(1.0, 5.0_f64.sqrt());
    let mut positions = Vec::new();
    for axis in 0..3 {
        for short in [1.0, -1.0] {
            for long in [golden, -golden] {
                let mut point = [0.0; 3];
                point[(axis + 1) % 3] = short;
                point[(axis + 2) % 3] = long;
                positions.push(point);
            }
        }
    }
    let adjacent = |a: usize, b: usize| {
        let square = |i: usize| {
            let [a, b]: [[f64; 3]; 2] = [positions[a], positions[b]];
            (a[i] - b[i]).powi(2)
        };
        a != b && (square(0) + square(1) + square(2) - 4.0).abs() < 0.1
    };
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in (a + 1..12).filter(|&b| adjacent(a, b)) {
            for c in (b + 1..12).filter(|&c| adjacent(a, c) && adjacent(b, c)) {
                let [p, q, r] = [a, b, c].map(|v| positions[v]);
                let determinant = p[0] * (q[1] * r[2] - q[2] * r[1])
                    + p[1] * (q[2] * r[0] - q[0] * r[2])
                    + p[2] * (q[0] * r[1] - q[1] * r[0]);
                let [a, b, c] = [a as u32, b as u32, c as u32];
                triangles.push(if determinant > 0.0 {
                    [a, b, c]
                } else {
                    [a, c, b]
                });
            }
        }
    }
    Model::new("icosahedron", positions, triangles)
}

/// The icosahedron with each face cut `doublings` times into four, on the unit sphere.
pub fn icosphere(doublings: u32) -> Model {
    let onto_sphere = |[x, y, z]: [f64; 3]| {
        let radius = (x * x + y * y + z * z).sqrt();
        [x / radius, y / radius, z / radius]
    };
    let mut model = icosahedron().moved("round", onto_sphere);
    for _ in 0..doublings {
        model = model.subdivided(2).moved("round", onto_sphere);
    }
    model.name = format!("icosphere {doublings}");
    model
}

/// An icosphere with radii from 1 - `noise` to 1 + `noise`.
pub(crate) fn noisy_sphere(doublings: u32, noise: f64) -> Model {
    let mut random = Random::new(u64::from(doublings));
    let name = format!("with noise {noise}");
    icosphere(doublings).moved(&name, |p| {
        let radius = random.between(1.0 - noise, 1.0 + noise);
        p.map(|x| x * radius)
    })
}

/// A torus of m x n cells around the radii `large` and `small`.
pub fn torus([m, n]: [u32; 2], large: f64, small: f64) -> Model {
    let mut positions = Vec::new();
    for i in 0..m {
        let (sin_i, cos_i) = (2.0 * PI * f64::from(i) / f64::from(m)).sin_cos();
        for j in 0..n {
            let (sin_j, cos_j) = (2.0 * PI * f64::from(j) / f64::from(n)).sin_cos();
            let radius = large + small * cos_j;
            positions.push([radius * cos_i, radius * sin_i, small * sin_j]);
        }
    }
    let triangles = cells(
        [m, n],
        Diagonal::Rising,
        |_, _| true,
        |i, j| (i % m) * n + j % n,
    );
    Model::new(
        format!("{m} x {n} torus {large}:{small}"),
        positions,
        triangles,
    )
}

/// The lateral surface of a prism over a regular polygon with `corners` sides of length 1, in cells
/// of height `step`. Its vertices are numbered `level * corners + corner`.
pub fn prism(corners: u32, levels: u32, step: f64, diagonal: Diagonal) -> Model {
    let radius = 0.5 / (PI / f64::from(corners)).sin();
    let mut positions = Vec::new();
    for level in 0..=levels {
        for corner in 0..corners {
            let (sin, cos) = (2.0 * PI * f64::from(corner) / f64::from(corners)).sin_cos();
            positions.push([radius * cos, radius * sin, f64::from(level) * step]);
        }
    }
    let triangles = cells(
        [corners, levels],
        diagonal,
        |_, _| true,
        |corner, level| level * corners + corner % corners,
    );
    Model::new(
        format!("side of a {corners}-gonal prism, {diagonal:?}"),
        positions,
        triangles,
    )
}
