//! Changes of a mesh that do not change its distances.

use std::fmt;

use crate::model::{Geometry, Model};
use crate::random::Random;

/// A change of a mesh in space that keeps the distances between its vertices, up to a factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Transform {
    /// Permutes vertices and faces, and rotates the corners of faces.
    Renumber,
    /// Turns the mesh inside out.
    Reverse,
    /// Scales by a power of two. An algorithm with one order of steps returns the same bits.
    Scale,
    /// Rotates and moves the mesh.
    Rotate,
    /// Cuts each face into similar ones.
    Refine,
    /// Inserts vertices in faces and on edges.
    InsertPoints,
}

impl Transform {
    /// Every transform.
    pub const ALL: [Self; 6] = [
        Self::Renumber,
        Self::Reverse,
        Self::Scale,
        Self::Rotate,
        Self::Refine,
        Self::InsertPoints,
    ];

    /// `model` after this change, with random numbers of its own.
    ///
    /// ```
    /// use geobench_oracle::{Random, Transform, distances, rounded, zoo};
    ///
    /// let model = zoo::octahedron();
    /// let changed = Transform::Renumber.apply(&model, &mut Random::new(1));
    /// let found = rounded(&distances(&changed.model.surface::<f64>(), &changed.sources(&[0])));
    /// let expected = rounded(&distances(&model.surface::<f64>(), &[0]));
    /// assert_eq!(changed.restored(&found), expected);
    /// ```
    ///
    /// # Panics
    ///
    /// If the model has no positions.
    pub fn apply(self, model: &Model, random: &mut Random) -> Transformed {
        let Geometry::Positions(positions) = &model.geometry else {
            panic!("{} has no positions", model.name);
        };
        let extent = positions
            .as_flattened()
            .iter()
            .fold(0.0, |a: f64, x| a.max(x.abs()));
        let mut numbers: Vec<u32> = (0..model.vertex_count as u32).collect();
        let mut factor = 1.0;
        // In units of the last digit of the largest coordinate.
        let mut rounding = 0.0;
        let mut changed = match self {
            Self::Renumber => {
                numbers = shuffled(model.vertex_count, random);
                renumbered(positions, &model.triangles, &numbers, random)
            }
            Self::Reverse => {
                let turned = model.triangles.iter().map(|&[a, b, c]| [a, c, b]);
                Model::new("", positions.clone(), turned.collect())
            }
            Self::Scale => {
                factor = f64::from(random.below(81)) - 40.0;
                factor = factor.exp2();
                model.clone().scaled(factor)
            }
            Self::Rotate => {
                rounding = 8.0;
                rotated(positions, &model.triangles, extent, random)
            }
            Self::Refine => {
                rounding = 2.0;
                model.subdivided(2 + random.below(2))
            }
            Self::InsertPoints => {
                rounding = 2.0;
                with_points(positions.clone(), model.triangles.clone(), random)
            }
        };
        changed.name = format!("{}, {self}", model.name);
        Transformed {
            model: changed,
            numbers,
            factor,
            moved: rounding * f64::EPSILON * extent,
        }
    }
}

impl fmt::Display for Transform {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Renumber => "renumbered",
            Self::Reverse => "reversed",
            Self::Scale => "scaled",
            Self::Rotate => "rotated",
            Self::Refine => "refined",
            Self::InsertPoints => "with points inserted",
        })
    }
}

/// A transformed model.
#[derive(Clone, Debug)]
pub struct Transformed {
    /// The new model.
    pub model: Model,
    /// The factor of all distances, a power of two.
    pub factor: f64,
    /// The new number of each old vertex.
    numbers: Vec<u32>,
    /// How far the rounding of positions moves a point of the surface at most.
    moved: f64,
}

impl Transformed {
    /// The new numbers of vertices.
    pub fn sources(&self, old: &[u32]) -> Vec<u32> {
        old.iter().map(|&v| self.numbers[v as usize]).collect()
    }

    /// The distances of the old vertices by distances of the new model.
    pub fn restored(&self, found: &[f64]) -> Vec<f64> {
        let numbers = self.numbers.iter();
        numbers.map(|&v| found[v as usize] / self.factor).collect()
    }

    /// Whether no position is rounded.
    pub const fn is_exact(&self) -> bool {
        self.moved == 0.0
    }

    /// The largest difference of a distance that rounded positions explain, in units of the old
    /// model.
    ///
    /// Map each new face linearly to the place where it would be without rounding. Both maps agree
    /// on edges, and each end of the segment of a path in a face moves by at most the rounding. A
    /// shortest path has at most one segment in each face, so its image is longer by at most twice
    /// the rounding for each face. The same holds for the inverse map.
    pub fn slack(&self) -> f64 {
        2.0 * self.moved * self.model.triangles.len() as f64
    }
}

/// A random permutation of the numbers below `count`.
pub(crate) fn shuffled(count: usize, random: &mut Random) -> Vec<u32> {
    let mut order: Vec<u32> = (0..count as u32).collect();
    for i in (1..count).rev() {
        order.swap(i, random.below(i as u32 + 1) as usize);
    }
    order
}

fn renumbered(
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
    numbers: &[u32],
    random: &mut Random,
) -> Model {
    let mut places = positions.to_vec();
    for (&number, &position) in numbers.iter().zip(positions) {
        places[number as usize] = position;
    }
    let order = shuffled(triangles.len(), random);
    let new = order.iter().map(|&t| {
        let mut triangle = triangles[t as usize].map(|v| numbers[v as usize]);
        triangle.rotate_left(random.below(3) as usize);
        triangle
    });
    Model::new("", places, new.collect())
}

fn rotated(
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
    extent: f64,
    random: &mut Random,
) -> Model {
    let axis = random.in_ball();
    let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    let [x, y, z] = axis.map(|a| a / length);
    let (sin, cos) = random.between(0.0, std::f64::consts::TAU).sin_cos();
    let shift = random.in_ball().map(|s| s * extent);
    let place = |p: &[f64; 3]| {
        // Rodrigues' rotation formula.
        let along = (x * p[0] + y * p[1] + z * p[2]) * (1.0 - cos);
        let cross = [
            y * p[2] - z * p[1],
            z * p[0] - x * p[2],
            x * p[1] - y * p[0],
        ];
        [0, 1, 2].map(|i| p[i] * cos + cross[i] * sin + [x, y, z][i] * along + shift[i])
    };
    Model::new(
        "",
        positions.iter().map(place).collect(),
        triangles.to_vec(),
    )
}

fn with_points(
    mut positions: Vec<[f64; 3]>,
    mut triangles: Vec<[u32; 3]>,
    random: &mut Random,
) -> Model {
    for _ in 0..=random.below(4) {
        let t = random.below(triangles.len() as u32) as usize;
        let mut corners = triangles[t];
        corners.rotate_left(random.below(3) as usize);
        let near = if random.below(3) == 0 { 1e-6 } else { 1.0 };
        let weights = if random.below(2) == 0 {
            let b = near * random.between(0.1, 0.9);
            [1.0 - b, b, 0.0]
        } else {
            let [b, c] = [0; 2].map(|_| near * random.between(0.1, 0.4));
            [1.0 - b - c, b, c]
        };
        let new = positions.len() as u32;
        let points = corners.map(|v| positions[v as usize]);
        positions.push([0, 1, 2].map(|i| {
            (1..3).fold(points[0][i], |sum, k| {
                sum + weights[k] * (points[k][i] - points[0][i])
            })
        }));
        let [a, b, c] = corners;
        if weights[2] > 0.0 {
            triangles[t] = [a, b, new];
            triangles.extend([[b, c, new], [c, a, new]]);
            continue;
        }
        for t in 0..triangles.len() {
            let halves = [a, b].map(|gone| triangles[t].map(|v| if v == gone { new } else { v }));
            if triangles[t].contains(&a) && triangles[t].contains(&b) {
                triangles[t] = halves[0];
                triangles.push(halves[1]);
            }
        }
    }
    Model::new("", positions, triangles)
}
