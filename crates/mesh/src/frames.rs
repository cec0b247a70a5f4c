//! The shape of a triangle in the frames of its half-edges.
//!
//! Frames are computed from coordinates where there are any, not from edge lengths. A length has a
//! rounding error of its own. In a triangle with an angle near π this error moves the apex by its
//! square root: 1e-8 of an edge instead of 1e-16.

use crate::corner::corner_angle;
use crate::vector::{column, cross, dot, norm, sub};

/// Least height of a face over its longest edge, as a fraction of its shortest edge. It is far
/// below rounding, so no distance changes. It ensures that a ray passes each vertex on a definite
/// side.
const LEAST_HEIGHT: f64 = 1.0 / (1u128 << 100) as f64;

/// Height of a face, as a fraction of its longest edge, up to which its area is indistinguishable
/// from rounding errors.
pub(crate) const FLAT_HEIGHT: f64 = 16.0 * f64::EPSILON;

/// Distance of two points.
pub(crate) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    norm(sub(b, a))
}

/// Position of the third vertex in the frame of each half-edge of the triangle `corners` with
/// the edge lengths `lengths`.
///
/// x is a dot product over the length. y is twice the area over the length. The area comes from the
/// cross product of the two shorter edges, which has the smallest error.
pub(crate) fn apexes_from_positions(corners: [[f64; 3]; 3], lengths: [f64; 3]) -> [[f64; 2]; 3] {
    let [a, b, c] = corners;
    let edges = [sub(b, a), sub(c, b), sub(a, c)];
    let longest = longest_side(lengths);
    let normal = cross(edges[(longest + 1) % 3], edges[(longest + 2) % 3]);
    let twice_area = at_least_a_sliver(norm(normal), lengths);
    [0, 1, 2].map(|k| {
        let x = -dot(edges[k], edges[(k + 2) % 3]) / lengths[k];
        [x, twice_area / lengths[k]]
    })
}

/// The shapes of `N` faces in structures of arrays; see [`Mesh::shapes`](crate::Mesh::shapes).
#[derive(Clone, Copy, Debug)]
pub struct FaceShapes<const N: usize> {
    /// Lengths of the half-edges of each face.
    pub lengths: [[f64; N]; 3],
    /// Abscissa of the apex in the frame of each half-edge.
    pub apexes_x: [[f64; N]; 3],
    /// Ordinate of the apex times the length of the half-edge, which is the same for all three.
    pub twice_areas: [f64; N],
    /// The angle at the tail of each half-edge, in radians.
    pub angles: [[f64; N]; 3],
    pub(crate) longest: [f64; N],
}

impl<const N: usize> Default for FaceShapes<N> {
    fn default() -> Self {
        Self {
            lengths: [[0.0; N]; 3],
            apexes_x: [[0.0; N]; 3],
            twice_areas: [0.0; N],
            angles: [[0.0; N]; 3],
            longest: [0.0; N],
        }
    }
}

impl<const N: usize> FaceShapes<N> {
    /// Sets the lengths and apexes of face `i`.
    pub(crate) fn set(&mut self, i: usize, lengths: [f64; 3], apexes: [[f64; 2]; 3]) {
        for k in 0..3 {
            self.lengths[k][i] = lengths[k];
            self.apexes_x[k][i] = apexes[k][0];
            self.angles[k][i] = corner_angle(apexes[k]);
        }
        self.longest[i] = lengths[longest_side(lengths)];
        self.twice_areas[i] = apexes[0][1] * lengths[0];
    }
}

/// The shapes of `N` triangles. `corners[k][axis][i]` is a coordinate of corner `k` of triangle
/// `i`.
#[inline]
pub(crate) fn measure<const N: usize>(corners: &[[[f64; N]; 3]; 3]) -> FaceShapes<N> {
    let mut shapes = FaceShapes::default();
    let mut projections = [[0.0; N]; 3];
    #[allow(clippy::needless_range_loop)] // It is the place in all arrays.
    for i in 0..N {
        let [a, b, c] = [
            column(&corners[0], i),
            column(&corners[1], i),
            column(&corners[2], i),
        ];
        let edges = [sub(b, a), sub(c, b), sub(a, c)];
        let [p, q, r] = [norm(edges[0]), norm(edges[1]), norm(edges[2])];
        let lengths = [p, q, r];
        let (first, second) = (p >= q && p >= r, q >= r);
        // Selects the two shorter edges without a branch.
        let one = |x: f64, y: f64, z: f64| {
            let other = if second { y } else { z };
            if first { x } else { other }
        };
        let select = |x: [f64; 3], y: [f64; 3], z: [f64; 3]| {
            [
                one(x[0], y[0], z[0]),
                one(x[1], y[1], z[1]),
                one(x[2], y[2], z[2]),
            ]
        };
        let normal = cross(
            select(edges[1], edges[2], edges[0]),
            select(edges[2], edges[0], edges[1]),
        );
        let twice_area = at_least_a_sliver(norm(normal), lengths);
        for k in 0..3 {
            shapes.lengths[k][i] = lengths[k];
            projections[k][i] = -dot(edges[k], edges[(k + 2) % 3]);
            shapes.apexes_x[k][i] = projections[k][i] / lengths[k];
        }
        shapes.longest[i] = p.max(q).max(r);
        shapes.twice_areas[i] = twice_area / p * p;
    }
    for (angles, projections) in shapes.angles.iter_mut().zip(projections) {
        for ((angle, x), y) in angles.iter_mut().zip(projections).zip(shapes.twice_areas) {
            *angle = corner_angle([x, y]);
        }
    }
    shapes
}

/// As [`apexes_from_positions`], for a triangle known by its edge lengths alone.
///
/// Let l be the length of the half-edge, a that of the side from its tail and b that of the side
/// from its head. Then x = (l² + (a-b)(a+b)) / 2l and y = 2S / l. The area S comes from Kahan's
/// form of Heron's formula, which stays accurate on needles.
pub(crate) fn apexes_from_lengths(lengths: [f64; 3]) -> [[f64; 2]; 3] {
    let twice_area = twice_area_from_lengths(lengths);
    [0, 1, 2].map(|k| {
        let l = lengths[k];
        let (from_head, from_tail) = (lengths[(k + 1) % 3], lengths[(k + 2) % 3]);
        let x = (l * l + (from_tail - from_head) * (from_tail + from_head)) / (2.0 * l);
        [x, twice_area / l]
    })
}

/// Whether a triangle with these edge lengths, and `apex` in the frame of its first edge, has no
/// area beyond rounding errors.
pub(crate) fn is_flat(lengths: [f64; 3], apex: [f64; 2]) -> bool {
    let longest = lengths[longest_side(lengths)];
    lengths[0] * apex[1] <= FLAT_HEIGHT * longest * longest
}

fn twice_area_from_lengths(lengths: [f64; 3]) -> f64 {
    let mut sides = lengths;
    sides.sort_unstable_by(f64::total_cmp);
    let [c, b, a] = sides;
    // The factors of 16 S² are scaled by the longest side. Their product then cannot under- or
    // overflow.
    let (p, q, r, s) = (a + (b + c), c - (a - b), c + (a - b), a + (b - c));
    let sixteen_s2 = (p / a) * (q / a) * (r / a) * (s / a);
    at_least_a_sliver(sixteen_s2.max(0.0).sqrt() / 2.0 * a * a, lengths)
}

/// `twice_area`, raised if needed to keep [`LEAST_HEIGHT`] in a triangle with these sides.
pub(crate) fn at_least_a_sliver(twice_area: f64, [a, b, c]: [f64; 3]) -> f64 {
    let (longest, shortest) = (a.max(b).max(c), a.min(b).min(c));
    twice_area.max(LEAST_HEIGHT * longest * shortest)
}

/// Index of the longest of three lengths, the first of equal ones.
pub(crate) fn longest_side(lengths: [f64; 3]) -> usize {
    let [a, b, c] = lengths;
    if a >= b && a >= c {
        0
    } else if b >= c {
        1
    } else {
        2
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SplitMix64;

    fn lengths_of([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
        [distance(a, b), distance(b, c), distance(c, a)]
    }

    fn from_positions(corners: [[f64; 3]; 3]) -> [[f64; 2]; 3] {
        apexes_from_positions(corners, lengths_of(corners))
    }

    #[test]
    fn a_3_4_5_triangle_comes_out_exactly_both_ways() {
        let corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 3.0, 0.0]];
        let expected = [[0.0, 3.0], [3.2, 2.4], [3.0, 4.0]];
        for apexes in [
            from_positions(corners),
            apexes_from_lengths(lengths_of(corners)),
        ] {
            for (apex, expected) in apexes.as_flattened().iter().zip(expected.as_flattened()) {
                assert!((apex - expected).abs() <= 4.0 * f64::EPSILON, "{apexes:?}");
            }
        }
    }

    #[test]
    fn a_cap_keeps_its_height_where_the_lengths_have_lost_it() {
        let height = 2f64.powi(-30);
        let corners = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, height, 0.0]];
        assert_eq!(from_positions(corners)[0], [1.0, height]);
        // Both shorter edges round to 1. By its lengths this cap is a straight line.
        assert!(apexes_from_lengths(lengths_of(corners))[0][1] < height / 2.0);
    }

    #[test]
    fn needles_keep_their_width() {
        for width in [1e-3, 1e-8, 1e-14] {
            let corners = [[0.0; 3], [width, 0.0, 0.0], [0.0, 1.0, 0.0]];
            for apexes in [
                from_positions(corners),
                apexes_from_lengths([width, 1.0f64.hypot(width), 1.0]),
            ] {
                let [_, y] = apexes[2];
                assert!((y / width - 1.0).abs() < 1e-12, "{width}: {apexes:?}");
                assert!((apexes[0][1] - 1.0).abs() < 1e-12, "{width}: {apexes:?}");
            }
        }
    }

    #[test]
    fn collinear_corners_stand_upright_but_count_as_flat() {
        let corners = [[0.0; 3], [0.1, 0.1, 0.1], [0.3, 0.3, 0.3]];
        let lengths = lengths_of(corners);
        for apexes in [from_positions(corners), apexes_from_lengths(lengths)] {
            assert!(apexes.iter().all(|apex| apex[1] > 0.0), "{apexes:?}");
            assert!(apexes.iter().all(|apex| apex[1] < 1e-7), "{apexes:?}");
        }
        assert!(is_flat(lengths, from_positions(corners)[0]));
        let thin = [[0.0; 3], [1.0, 0.0, 0.0], [0.5, 1e-10, 0.0]];
        assert!(!is_flat(lengths_of(thin), from_positions(thin)[0]));
    }

    #[test]
    fn an_extreme_needle_is_not_widened() {
        let corners = [[0.0; 3], [0.0, 0.0, 1.0], [0.0, 0.0, -1e50]];
        let apexes = from_positions(corners);
        assert!(apexes[0][1] <= 1e-30 * 1e50, "{apexes:?}");
        assert!(apexes[2][1] <= 1e-30, "{apexes:?}");
    }

    #[test]
    fn powers_of_two_scale_every_bit() {
        let corners = [[0.1, 0.7, -3.0], [1.3, 0.2, 0.9], [-2.7, 0.4, 0.33]];
        for exponent in [-150, -7, 1, 150] {
            let scale = 2f64.powi(exponent);
            let scaled = corners.map(|p| p.map(|x| x * scale));
            let expected = from_positions(corners).map(|apex| apex.map(|x| x * scale));
            assert_eq!(from_positions(scaled), expected);
            let lengths = lengths_of(corners);
            assert_eq!(lengths_of(scaled), lengths.map(|l| l * scale));
            assert_eq!(
                apexes_from_lengths(lengths.map(|l| l * scale)),
                apexes_from_lengths(lengths).map(|apex| apex.map(|x| x * scale))
            );
        }
    }

    #[test]
    fn triangles_measured_together_have_the_bits_of_each_alone() {
        let mut random = SplitMix64::new(7);
        for _ in 0..2000 {
            let mut corners = [[[0.0; 4]; 3]; 3];
            for x in corners.as_flattened_mut().as_flattened_mut() {
                *x = (4.0 * random.unit()).floor() / 3.0 + 1e-3 * random.unit();
            }
            let (found, mut expected) = (measure(&corners), FaceShapes::default());
            for i in 0..4 {
                let own = corners.map(|corner| corner.map(|x| x[i]));
                let lengths = lengths_of(own);
                expected.set(i, lengths, apexes_from_positions(own, lengths));
            }
            assert_eq!(found.lengths, expected.lengths);
            assert_eq!(found.longest, expected.longest);
            assert_eq!(found.apexes_x, expected.apexes_x);
            assert_eq!(found.twice_areas, expected.twice_areas);
            for (a, b) in found
                .angles
                .as_flattened()
                .iter()
                .zip(expected.angles.as_flattened())
            {
                assert!((a - b).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn turning_a_face_over_mirrors_its_frames_bit_for_bit() {
        let [a, b, c] = [[0.1, 0.7, -3.0], [1.3, 0.2, 0.9], [-2.7, 0.4, 0.33]];
        let (front, back) = (from_positions([a, b, c]), from_positions([a, c, b]));
        for k in 0..3 {
            assert_eq!(front[k][1], back[2 - k][1]);
        }
    }
}
