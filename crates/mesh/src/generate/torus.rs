//! Torus, smooth or with random low bumps.

use std::f64::consts::TAU;

use super::keys::{Key, Params};
use super::lattice::wrapped;
use super::turn::turn;
use crate::random::SplitMix64;
use crate::soup::TriangleSoup;

pub(super) const KEYS: &[Key] = &[
    Key::whole(
        "faces",
        5_000,
        [18, super::MAX_FACES],
        "wanted number of faces",
    ),
    Key::real(
        "r",
        0.4,
        [0.01, 0.65],
        "radius of the tube, that of its centre line being 1",
    ),
    Key::real(
        "bump",
        0.0,
        [0.0, 0.5],
        "largest random change of the tube's radius, relative to it",
    ),
];

pub(super) fn faces(params: &Params<'_>) -> u64 {
    let [rings, per_ring] = counts(params);
    2 * rings * per_ring
}

fn counts(params: &Params<'_>) -> [u64; 2] {
    ring_counts(params.whole("faces"), 1.0 / params.real("r"))
}

/// The numbers of rings and of vertices in each that give nearly `faces` triangles with sides of
/// similar length along and across the tube. The tube is `slender` times as long as around. `faces`
/// must be at least 18, for three rings of three vertices.
pub(super) fn ring_counts(faces: u64, slender: f64) -> [u64; 2] {
    let cells = faces / 2;
    let ideal = rounded((cells as f64 / slender).sqrt()).clamp(3, cells / 3);
    // Tries numbers near the ideal one, and takes the one with the count closest to `faces`.
    let slack = ideal / 10;
    let mut best = [0u64; 2];
    for step in 0..=2 * slack {
        // From the middle outwards, so that the first of equals is nearest to the ideal.
        let around = if step % 2 == 0 {
            ideal + step / 2
        } else {
            ideal - step.div_ceil(2)
        };
        let around = around.clamp(3, cells / 3);
        let along = rounded(cells as f64 / around as f64).max(3);
        if (along * around).abs_diff(cells) < (best[0] * best[1]).abs_diff(cells) {
            best = [along, around];
        }
    }
    best
}

/// The whole number nearest to a positive number.
#[allow(clippy::cast_sign_loss)] // Called with positive numbers only.
pub(super) fn rounded(x: f64) -> u64 {
    x.round() as u64
}

/// Around the z-axis, numbered ring by ring; vertex 0 is outermost on the x-axis.
pub(super) fn build(params: &Params<'_>) -> TriangleSoup {
    let [rings, per_ring] = counts(params);
    let r = params.real("r");
    let bumps = Bumps::new(params.seed, params.real("bump"));
    let circle: Vec<_> = (0..per_ring).map(|j| turn(j, per_ring)).collect();
    let mut positions = Vec::with_capacity((rings * per_ring) as usize);
    for i in 0..rings {
        let [x, y] = turn(i, rings);
        for (j, [out, up]) in circle.iter().enumerate() {
            let r = r * bumps.factor(i as f64 / rings as f64, j as f64 / per_ring as f64);
            let distance = 1.0 + r * out;
            positions.push([distance * x, distance * y, r * up]);
        }
    }
    let triangles = wrapped(rings as usize, per_ring as usize, 0);
    TriangleSoup::new(positions, triangles)
}

/// A sum of waves over the torus, each with a few periods along and around it.
struct Bumps {
    waves: [[f64; 3]; 6],
    height: f64,
}

impl Bumps {
    fn new(seed: u64, height: f64) -> Self {
        let mut random = SplitMix64::for_use(seed, 2);
        let waves =
            [(1, 2), (2, -1), (3, 1), (4, -2), (5, 0), (0, 3)].map(|(along, around): (i8, i8)| {
                [
                    f64::from(along) * TAU,
                    f64::from(around) * TAU,
                    random.unit() * TAU,
                ]
            });
        Self { waves, height }
    }

    /// The factor of the tube's radius at a position given in turns along and around: from `1 -
    /// height` to `1 + height`.
    fn factor(&self, along: f64, around: f64) -> f64 {
        if self.height == 0.0 {
            return 1.0;
        }
        let wave = |[a, b, phase]: &[f64; 3]| libm::cos(a * along + b * around + phase);
        let sum: f64 = self.waves.iter().map(wave).sum();
        1.0 + self.height * sum / self.waves.len() as f64
    }
}
