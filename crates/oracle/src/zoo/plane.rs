//! Plates: whole, with holes, and folded.

use std::collections::HashMap;

use crate::model::{Geometry, Model};
use crate::random::Random;

/// The diagonals along which the cells of a grid are cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Diagonal {
    /// From the corner with the smallest coordinates to the one with the largest.
    Rising,
    /// The other diagonal.
    Falling,
    /// Both alternately, as on a chessboard.
    Alternating,
}

/// The open rectangle between two opposite corners, in cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rectangle {
    /// Smallest coordinates.
    pub from: [i32; 2],
    /// Largest coordinates.
    pub to: [i32; 2],
}

impl Rectangle {
    /// The rectangle between these coordinates.
    pub const fn new(from: [i32; 2], to: [i32; 2]) -> Self {
        Self { from, to }
    }

    const fn covers_cell(&self, i: u32, j: u32) -> bool {
        let (i, j) = (i.cast_signed(), j.cast_signed());
        self.from[0] <= i && i < self.to[0] && self.from[1] <= j && j < self.to[1]
    }
}

/// The two triangles of each of the m × n cells that satisfy `present`, with corners `vertex(i,
/// j)`.
pub(crate) fn cells(
    [m, n]: [u32; 2],
    diagonal: Diagonal,
    present: impl Fn(u32, u32) -> bool,
    mut vertex: impl FnMut(u32, u32) -> u32,
) -> Vec<[u32; 3]> {
    let mut triangles = Vec::new();
    for i in 0..m {
        for j in 0..n {
            if !present(i, j) {
                continue;
            }
            let [a, b] = [vertex(i, j), vertex(i + 1, j)];
            let [c, d] = [vertex(i + 1, j + 1), vertex(i, j + 1)];
            let rising = match diagonal {
                Diagonal::Rising => true,
                Diagonal::Falling => false,
                Diagonal::Alternating => (i + j) % 2 == 0,
            };
            if rising {
                triangles.extend([[a, b, c], [a, c, d]]);
            } else {
                triangles.extend([[a, b, d], [b, c, d]]);
            }
        }
    }
    triangles
}

/// A plate of m × n unit cells without the cells in `holes`. A hole may extend beyond the plate.
pub fn plate([m, n]: [u32; 2], diagonal: Diagonal, holes: &[Rectangle]) -> Model {
    let mut numbers = HashMap::new();
    let mut positions = Vec::new();
    let present = |i, j| !holes.iter().any(|hole| hole.covers_cell(i, j));
    let triangles = cells([m, n], diagonal, present, |i, j| {
        *numbers.entry((i, j)).or_insert_with(|| {
            positions.push([f64::from(i), f64::from(j), 0.0]);
            positions.len() as u32 - 1
        })
    });
    let name = match holes.len() {
        0 => format!("{m} x {n} grid, {diagonal:?}"),
        count => format!("{m} x {n} plate, {count} holes, {diagonal:?}"),
    };
    Model::new(name, positions, triangles)
}

/// A plate of m × n unit cells without holes.
pub fn grid(size: [u32; 2], diagonal: Diagonal) -> Model {
    plate(size, diagonal, &[])
}

impl Model {
    /// The same surface with every interior vertex moved by up to `amount` in x and in y.
    ///
    /// # Panics
    ///
    /// If the model has no positions.
    #[must_use]
    pub(crate) fn jittered(mut self, amount: f64) -> Self {
        let surface = self.surface::<f64>();
        let mut random = Random::new(self.triangles.len() as u64);
        let Geometry::Positions(positions) = &mut self.geometry else {
            panic!("{} has no positions to move", self.name);
        };
        for (v, position) in positions.iter_mut().enumerate() {
            if !surface.is_boundary(v as u32) {
                position[0] += random.between(-amount, amount);
                position[1] += random.between(-amount, amount);
            }
        }
        self.name += ", jittered";
        self
    }

    /// The same surface with its positions changed by `place`.
    ///
    /// # Panics
    ///
    /// If the model has no positions.
    #[must_use]
    pub fn moved(mut self, what: &str, place: impl FnMut([f64; 3]) -> [f64; 3]) -> Self {
        let Geometry::Positions(positions) = &mut self.geometry else {
            panic!("{} has no positions to move", self.name);
        };
        *positions = positions.iter().copied().map(place).collect();
        self.name = format!("{}, {what}", self.name);
        self
    }
}

/// A plate folded into a staircase along lines of constant x, by right angles.
pub(crate) fn staircase(plate: Model) -> Model {
    plate.moved("folded into stairs", |[x, y, _]| {
        let whole = x.floor();
        let odd = whole.rem_euclid(2.0);
        let tread = (whole - odd) / 2.0;
        if odd == 0.0 {
            [tread + (x - whole), y, tread]
        } else {
            [tread + 1.0, y, tread + (x - whole)]
        }
    })
}

/// A plate whose part beyond the line x + y = `at` is folded up by a right angle.
pub(crate) fn dog_ear(plate: Model, at: f64) -> Model {
    plate.moved("with a corner turned up", |[x, y, _]| {
        let beyond = (x + y - at).max(0.0);
        let height = beyond / std::f64::consts::SQRT_2;
        [x - beyond / 2.0, y - beyond / 2.0, height]
    })
}

/// The same surface with `count` faces of no area, each along an edge between two triangles: a
/// vertex is inserted into the edge at the fraction `at`, on one side only. All vertices have
/// different positions.
///
/// # Panics
///
/// If the model has no positions, or no edge between two triangles.
pub fn with_flat_faces(mut model: Model, count: u32, at: f64) -> Model {
    let mut random = Random::new(u64::from(count));
    let mut inserted = 0;
    while inserted < count {
        let t = random.below(model.triangles.len() as u32) as usize;
        let k = random.below(3) as usize;
        let [a, b, c] = [0, 1, 2].map(|i| model.triangles[t][(k + i) % 3]);
        let shared =
            |triangle: &[u32; 3]| (0..3).any(|i| [triangle[i], triangle[(i + 1) % 3]] == [b, a]);
        let Geometry::Positions(positions) = &mut model.geometry else {
            panic!("{} has no positions", model.name);
        };
        let ends = [a, b].map(|v| positions[v as usize]);
        let point = [0, 1, 2].map(|i| ends[0][i] + at * (ends[1][i] - ends[0][i]));
        let taken = |p: &[f64; 3]| (0..3).all(|i| (p[i] - point[i]).abs() < 1e-9);
        if positions.iter().any(taken) || !model.triangles.iter().any(shared) {
            continue;
        }
        let middle = positions.len() as u32;
        positions.push(point);
        model.triangles[t] = [a, middle, c];
        model.triangles.extend([[middle, b, c], [a, b, middle]]);
        inserted += 1;
    }
    model.vertex_count += count as usize;
    model.name = format!("{}, {count} flat faces at {at}", model.name);
    let last = model.vertex_count as u32 - 1;
    model.starting_at(&[last, last - 1])
}
