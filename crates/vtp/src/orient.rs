//! On which side of a ray a point lies, beyond doubt.

/// Fraction of the coordinates' size by which a point must lie off a ray to count as beside it:
/// far more than rounding can move an image, far less than what matters for a distance.
const CLEARANCE: f64 = 1e-12;

/// Whether `point` lies left of the ray from `source` to `target`.
///
/// Sources that are one point reached through different triangles, and sources on one ray, differ
/// by rounding only. A side read from that difference is noise, and noise must not delete windows:
/// then neither this nor [`is_clearly_right`] holds.
#[inline]
pub(crate) fn is_clearly_left(source: [f64; 2], target: [f64; 2], point: [f64; 2]) -> bool {
    let (area, doubt) = twice_area(source, target, point);
    area > doubt
}

/// Whether `point` lies right of the ray from `source` to `target`.
#[inline]
pub(crate) fn is_clearly_right(source: [f64; 2], target: [f64; 2], point: [f64; 2]) -> bool {
    let (area, doubt) = twice_area(source, target, point);
    area < -doubt
}

/// Twice the signed area of the three points, and how much of it may be rounding.
#[inline]
fn twice_area(source: [f64; 2], target: [f64; 2], point: [f64; 2]) -> (f64, f64) {
    let ray = [target[0] - source[0], target[1] - source[1]];
    let off = [point[0] - source[0], point[1] - source[1]];
    let size = source[0].abs() + source[1].abs() + point[0].abs() + point[1].abs();
    let length = ray[0].abs() + ray[1].abs();
    (ray[0] * off[1] - ray[1] * off[0], CLEARANCE * length * size)
}
