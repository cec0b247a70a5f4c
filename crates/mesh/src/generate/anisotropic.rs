//! A torus whose triangles are stretched to a given mean anisotropy, without changing its shape.

use std::f64::consts::TAU;

use super::GenerateError;
use super::keys::{Key, Params};
use super::lattice::wrapped;
use super::torus::rounded;
use super::turn::{angle, turn};
use crate::soup::TriangleSoup;
use crate::vector::{cross, norm, sub};

pub(super) const KEYS: &[Key] = &[
    Key::real(
        "g",
        4.0,
        [1.05, 1e5],
        "wanted mean anisotropy; large ones need many faces",
    ),
    Key::whole(
        "faces",
        5_000,
        [1_000, super::MAX_FACES],
        "wanted number of faces",
    ),
];

/// Radius of the tube; the centre line has radius 1.
const TUBE: f64 = 0.4;

/// With fewer rings the surface would no longer look like a torus.
const MIN_RINGS: u64 = 12;

/// Limit of the concentration of vertices near the outer equator: their density there is at most `1
/// / (1 - MAX_CROWDING)` times the mean.
const MAX_CROWDING: f64 = 0.75;

pub(super) fn faces(params: &Params<'_>) -> Result<u64, GenerateError> {
    let stretched = Stretched::new(params)?;
    Ok(2 * stretched.rings * stretched.per_ring)
}

/// Triangles are long along the torus and short around its tube: isosceles needles between rings.
/// Vertices are numbered ring by ring.
pub(super) fn build(params: &Params<'_>) -> Result<TriangleSoup, GenerateError> {
    let stretched = Stretched::new(params)?;
    let [rings, per_ring] = [stretched.rings, stretched.per_ring];
    let mut positions = Vec::with_capacity((rings * per_ring) as usize);
    for i in 0..rings {
        positions.extend((0..per_ring).map(|j| stretched.position(i, j)));
    }
    let shift = per_ring - stretched.offset() % per_ring;
    let triangles = wrapped(rings as usize, per_ring as usize, shift as usize);
    Ok(TriangleSoup::new(positions, triangles))
}

/// A torus of `rings` rings, each offset by half a vertex from the one before.
struct Stretched {
    rings: u64,
    per_ring: u64,
    crowding: f64,
}

impl Stretched {
    /// Finds the torus with the given anisotropy.
    ///
    /// Fewer rings of more vertices stretch the triangles, in steps. Concentrating the vertices of
    /// each ring near the outer equator provides the rest.
    fn new(params: &Params<'_>) -> Result<Self, GenerateError> {
        let (wanted, cells) = (params.real("g"), params.whole("faces") / 2);
        let even = |rings| Self {
            rings,
            per_ring: rounded(cells as f64 / rings as f64),
            crowding: 0.0,
        };
        // The fewest rings that do not exceed the given mean. With `many` rings triangles are
        // nearly equilateral.
        let (mut few, mut many) = (MIN_RINGS, rounded((cells as f64 / (0.87 * TUBE)).sqrt()));
        while few < many {
            let middle = few.midpoint(many);
            if even(middle).anisotropy() > wanted {
                few = middle + 1;
            } else {
                many = middle;
            }
        }
        let crowded = |crowding| Self {
            crowding,
            ..even(few)
        };
        let even_mean = crowded(0.0).anisotropy();
        let [mut low, mut high] = if wanted < even_mean {
            // Rings are closer to each other at the inner equator than at the outer one. Evenly
            // spread vertices therefore have a mean above 1. Concentrating them inwards makes all
            // triangles alike.
            [-TUBE, 0.0]
        } else {
            [0.0, MAX_CROWDING]
        };
        let reach = [low, high].map(|crowding| crowded(crowding).anisotropy());
        if wanted < reach[0] || wanted > reach[1] {
            let family = "anisotropic";
            let faces = params.whole("faces");
            let why = if wanted < reach[0] {
                format!("with faces={faces} g cannot go below {:.3}", reach[0])
            } else {
                // The greatest anisotropy grows with the number of faces; 2 % more allows for
                // rounding.
                let enough = rounded(faces as f64 * wanted / reach[1] * 1.02) + 1;
                format!(
                    "g={wanted} would leave too few rings to form a torus: with faces={faces} g goes \
                     up to {:.3}, and for this g there must be at least faces={enough}",
                    reach[1]
                )
            };
            return Err(GenerateError::Unfit { family, why });
        }
        for _ in 0..40 {
            let middle = f64::midpoint(low, high);
            if crowded(middle).anisotropy() < wanted {
                low = middle;
            } else {
                high = middle;
            }
        }
        Ok(crowded(low))
    }

    /// The offset between the last ring and the first, in vertices.
    const fn offset(&self) -> u64 {
        self.rings / 2
    }

    fn position(&self, ring: u64, vertex: u64) -> [f64; 3] {
        let [x, y] = turn(ring % self.rings, self.rings);
        let turned = self.offset() as f64 * ring as f64 / self.rings as f64;
        let w = TAU * (vertex as f64 - turned) / self.per_ring as f64;
        let [out, up] = angle(w - self.crowding * libm::sin(w));
        let distance = 1.0 + TUBE * out;
        [distance * x, distance * y, TUBE * up]
    }

    /// Mean g of the triangles between the first two rings, or of an even sample of them. Other
    /// rings differ only in the positions of their vertices around the tube.
    fn anisotropy(&self) -> f64 {
        let samples = self.per_ring.min(2_000);
        let sum: f64 = (0..samples)
            .map(|sample| {
                let j = sample * self.per_ring / samples;
                let a = self.position(0, j);
                let b = self.position(1, j);
                let c = self.position(1, j + 1);
                let d = self.position(0, j + 1);
                anisotropy([a, b, c]) + anisotropy([a, c, d])
            })
            .sum();
        sum / (2 * samples) as f64
    }
}

/// g = P·H / (2√3·S) of a triangle: P half the perimeter, H the longest side, S the area (Xu et al.
/// 2015, section 5). 1 for an equilateral triangle, infinite without area.
fn anisotropy([a, b, c]: [[f64; 3]; 3]) -> f64 {
    let sides = [sub(b, a), sub(c, b), sub(a, c)];
    let lengths = sides.map(norm);
    let longest = lengths.into_iter().fold(0.0, f64::max);
    // Relative to the longest side, so that areas of tiny triangles do not vanish.
    let half_perimeter = (lengths[0] + lengths[1] + lengths[2]) / longest / 2.0;
    let [u, v, _] = sides.map(|side| side.map(|x| x / longest));
    let area = norm(cross(u, v)) / 2.0;
    half_perimeter / (12f64.sqrt() * area)
}
