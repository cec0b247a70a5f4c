//! The side of a ray on which a point lies, within rounding.

use crate::precision::CLEARANCE;

/// Whether `point` lies left of the ray from `source` to `target` by more than rounding.
///
/// The images of one source, reached through different triangles, differ only by rounding, and so
/// do the sides of sources on one ray. A side that depends on rounding must not delete windows. In
/// this case both this function and [`is_clearly_right`] return false. `blur` is the rounding error
/// of the sources in addition to that of their own coordinates.
#[inline]
pub(crate) fn is_clearly_left(
    source: [f64; 2],
    target: [f64; 2],
    point: [f64; 2],
    blur: f64,
) -> bool {
    let (area, doubt) = twice_area(source, target, point, blur);
    area > doubt
}

/// Whether `point` lies right of the ray from `source` to `target` by more than rounding.
#[inline]
pub(crate) fn is_clearly_right(
    source: [f64; 2],
    target: [f64; 2],
    point: [f64; 2],
    blur: f64,
) -> bool {
    let (area, doubt) = twice_area(source, target, point, blur);
    area < -doubt
}

/// Twice the signed area of the three points, and a bound of its rounding error.
#[inline]
fn twice_area(source: [f64; 2], target: [f64; 2], point: [f64; 2], blur: f64) -> (f64, f64) {
    let ray = [target[0] - source[0], target[1] - source[1]];
    let off = [point[0] - source[0], point[1] - source[1]];
    let size = source[0].abs() + source[1].abs() + point[0].abs() + point[1].abs();
    let length = ray[0].abs() + ray[1].abs();
    (
        ray[0] * off[1] - ray[1] * off[0],
        length * (CLEARANCE * size + blur),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn left_and_right_of_a_ray() {
        let (source, target) = ([0.0, -1.0], [0.0, 1.0]);
        assert!(is_clearly_left(source, target, [-0.1, 5.0], 0.0));
        assert!(is_clearly_right(source, target, [0.1, -5.0], 0.0));
        assert!(!is_clearly_left(source, target, [0.1, 0.0], 0.0));
        assert!(!is_clearly_right(source, target, [-0.1, 0.0], 0.0));
    }

    #[test]
    fn a_point_on_the_ray_is_on_neither_side() {
        let (source, target) = ([0.3, -100.0], [0.7, 0.0]);
        for t in [0.0, 0.25, 0.5, 1.0, 3.0] {
            for noise in [-1e-14, 0.0, 1e-14] {
                let point = [0.3 + 0.4 * t + noise, -100.0 + 100.0 * t];
                assert!(!is_clearly_left(source, target, point, 0.0));
                assert!(!is_clearly_right(source, target, point, 0.0));
            }
        }
    }

    #[test]
    fn the_sides_do_not_depend_on_the_scale() {
        for scale in [1e-9, 1.0, 1e9] {
            let [source, target, point] =
                [[0.0, -1.0], [0.5, 0.0], [-1e-6, -1.0]].map(|p| p.map(|x| x * scale));
            assert!(is_clearly_left(source, target, point, 0.0));
        }
    }
}
