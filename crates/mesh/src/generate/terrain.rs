//! Fractal terrain: a square with boundary, raised by several octaves of value noise.

use super::keys::{Key, Params};
use super::plate::cut;
use crate::random::SplitMix64;
use crate::soup::TriangleSoup;

pub(super) const KEYS: &[Key] = &[
    Key::whole("n", 50, [1, 25_000], "cells along each side"),
    Key::real(
        "roughness",
        0.6,
        [0.0, 1.0],
        "height of each octave relative to the one twice as coarse",
    ),
    Key::real(
        "height",
        0.3,
        [0.0, 1e3],
        "largest possible height above or below 0, the sides being 1",
    ),
];

pub(super) fn faces(params: &Params<'_>) -> u64 {
    let n = params.whole("n");
    2 * n * n
}

/// The unit square in n × n cells, cut along alternating diagonals; vertices are numbered row by
/// row.
pub(super) fn build(params: &Params<'_>) -> TriangleSoup {
    let n = params.count("n");
    let heights = heights(params, n);
    let mut positions = Vec::with_capacity((n + 1) * (n + 1));
    for (i, &z) in heights.iter().enumerate() {
        let [x, y] = [i % (n + 1), i / (n + 1)].map(|k| k as f64 / n as f64);
        positions.push([x, y, z]);
    }
    let mut triangles = Vec::with_capacity(2 * n * n);
    for y in 0..n {
        for x in 0..n {
            let corner = y * (n + 1) + x;
            let corners = [corner, corner + 1, corner + n + 2, corner + n + 1];
            triangles.extend(cut(corners.map(|i| i as u32), (x + y).is_multiple_of(2)));
        }
    }
    TriangleSoup::new(positions, triangles)
}

/// Heights row by row. They are a weighted sum of octaves: random lattices with 2, 4, 8, ... cells
/// a side, as long as a lattice is coarser than the grid, interpolated smoothly. The weights keep
/// the sum in range.
fn heights(params: &Params<'_>, n: usize) -> Vec<f64> {
    let roughness = params.real("roughness");
    let mut heights = vec![0.0; (n + 1) * (n + 1)];
    let (mut weight, mut total) = (1.0, 0.0);
    for octave in 0.. {
        let cells = 2u64 << octave;
        if octave > 0 && cells as usize > n || weight == 0.0 {
            break;
        }
        let random = SplitMix64::for_use(params.seed, 0x100 + octave);
        let value = |x: u64, y: u64| random.signed_at(x * (cells + 1) + y);
        for (y, row) in heights.chunks_exact_mut(n + 1).enumerate() {
            let (cell_y, t_y) = place(y, n, cells);
            let mut known = None;
            for (x, height) in row.iter_mut().enumerate() {
                let (cell_x, t_x) = place(x, n, cells);
                let corners = match known {
                    Some((cell, corners)) if cell == cell_x => corners,
                    _ => [0, 1, 2, 3].map(|k| value(cell_x + k % 2, cell_y + k / 2)),
                };
                known = Some((cell_x, corners));
                let below = corners[0] + t_x * (corners[1] - corners[0]);
                let above = corners[2] + t_x * (corners[3] - corners[2]);
                *height += weight * (below + t_y * (above - below));
            }
        }
        total += weight;
        weight *= roughness;
    }
    let scale = params.real("height") / total;
    for height in &mut heights {
        *height *= scale;
    }
    heights
}

/// The lattice cell of grid line `i` of `n`, and the weight of its upper side: the position in the
/// cell, smoothed to have slope 0 at both ends.
fn place(i: usize, n: usize, cells: u64) -> (u64, f64) {
    let scaled = i as u64 * cells;
    let cell = (scaled / n as u64).min(cells - 1);
    let fraction = (scaled - cell * n as u64) as f64 / n as f64;
    (cell, fraction * fraction * (3.0 - 2.0 * fraction))
}
