//! Random displacement of vertices along their normals.

use crate::random::SplitMix64;
use crate::soup::TriangleSoup;
use crate::vector::cross;

/// Moves every vertex along its normal by a random distance, uniform between minus and plus
/// `amplitude` times the mean length of the triangles' sides.
///
/// The normal of a vertex is the area-weighted mean over its triangles. A vertex without a normal
/// (isolated, or with triangles of no area only) stays. The displacement of a vertex depends on
/// `seed` and its number alone. Sides that are not finite, and triangles that name missing
/// vertices, are ignored.
///
/// Takes O(n) time for n triangles and vertices.
pub fn add_noise(soup: &mut TriangleSoup, amplitude: f64, seed: u64) {
    let mut normals = vec![[0.0; 3]; soup.positions.len()];
    // A running mean, because a sum of lengths might overflow.
    let (mut mean, mut count) = (0.0, 0u64);
    for triangle in &soup.triangles {
        let corner = |k: usize| soup.positions.get(triangle[k] as usize);
        let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) else {
            continue;
        };
        let [u, v, w] = [(b, a), (c, b), (a, c)].map(|(p, q)| [0, 1, 2].map(|k| p[k] - q[k]));
        for side in [u, v, w] {
            let length = norm(side);
            if length.is_finite() {
                count += 1;
                mean += (length - mean) / count as f64;
            }
        }
        let normal = cross(u, v);
        for &corner in triangle {
            for k in 0..3 {
                normals[corner as usize][k] += normal[k];
            }
        }
    }
    let random = SplitMix64::for_use(seed, 3);
    for (i, (position, normal)) in soup.positions.iter_mut().zip(&normals).enumerate() {
        let length = norm(*normal);
        if length > 0.0 && length.is_finite() {
            let step = amplitude * mean * random.signed_at(i as u64);
            for k in 0..3 {
                position[k] += step * (normal[k] / length);
            }
        }
    }
}

/// Length of a vector, without intermediate overflow or underflow.
fn norm(v: [f64; 3]) -> f64 {
    let largest = v.into_iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    let [x, y, z] = v.map(|x| x / largest);
    largest * (x * x + y * y + z * z).sqrt()
}
