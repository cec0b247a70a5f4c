//! A tube along the trefoil knot.

use super::MAX_FACES;
use super::keys::{Key, Params};
use super::lattice::wrapped;
use super::torus::ring_counts;
use super::turn::turn;
use crate::soup::TriangleSoup;
use crate::vector::cross;

pub(super) const KEYS: &[Key] = &[
    Key::whole("faces", 6_000, [300, MAX_FACES], "wanted number of faces"),
    Key::real(
        "r",
        0.4,
        [0.01, 0.6],
        "radius of the tube; the knot winds around a torus of radii 2 and 1",
    ),
];

/// Length of the centre line, divided by 2π.
const SLENDER: f64 = 5.09;

pub(super) fn faces(params: &Params<'_>) -> u64 {
    let [rings, per_ring] = counts(params);
    2 * rings * per_ring
}

fn counts(params: &Params<'_>) -> [u64; 2] {
    ring_counts(params.whole("faces"), SLENDER / params.real("r"))
}

/// Vertices are numbered ring by ring along the knot.
pub(super) fn build(params: &Params<'_>) -> TriangleSoup {
    let [rings, per_ring] = counts(params);
    let r = params.real("r");
    let circle: Vec<_> = (0..per_ring).map(|j| turn(j, per_ring)).collect();
    let mut positions = Vec::with_capacity((rings * per_ring) as usize);
    for i in 0..rings {
        let (centre, first, second) = frame(i, rings);
        positions.extend(
            circle
                .iter()
                .map(|[x, y]| [0, 1, 2].map(|k| centre[k] + r * (x * first[k] + y * second[k]))),
        );
    }
    let triangles = wrapped(rings as usize, per_ring as usize, 0);
    TriangleSoup::new(positions, triangles)
}

/// A point of the knot and two unit vectors across it.
///
/// The curve winds twice around the axis and three times around the tube of a torus. The first
/// vector is the normal of the torus. It turns steadily and closes up, which Frenet's frame need
/// not.
fn frame(i: u64, rings: u64) -> ([f64; 3], [f64; 3], [f64; 3]) {
    let [x, y] = turn(2 * i % rings, rings);
    // Downwards: in this direction the cells of the tube lean towards the diagonals that cut them.
    let [out, down] = turn(3 * i % rings, rings);
    let up = -down;
    let distance = 2.0 + out;
    let centre = [distance * x, distance * y, up];
    let normal = [out * x, out * y, up];
    // The derivative: 2 radians around the axis for 3 radians down around the tube.
    let (a, b) = (2.0 * distance, -3.0);
    let length = (a * a + b * b).sqrt();
    let (a, b) = (a / length, b / length);
    let tangent = [-a * y - b * up * x, a * x - b * up * y, b * out];
    (centre, normal, cross(normal, tangent))
}
