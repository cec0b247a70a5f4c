//! Points and vectors in the plane of a face.

pub(crate) type Point = [f64; 2];

pub(crate) fn add(a: Point, b: Point) -> Point {
    [a[0] + b[0], a[1] + b[1]]
}

pub(crate) fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

pub(crate) fn scale(a: Point, by: f64) -> Point {
    [a[0] * by, a[1] * by]
}

pub(crate) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

pub(crate) fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub(crate) fn norm(a: Point) -> f64 {
    dot(a, a).sqrt()
}

/// `a` turned to the left by a right angle.
pub(crate) fn turned(a: Point) -> Point {
    [-a[1], a[0]]
}

/// The distance of `x` from the segment between `a` and `b`, and the position of the nearest point
/// on the segment, from 0 at `a` to 1 at `b`.
pub(crate) fn nearest_on_segment(x: Point, [a, b]: [Point; 2]) -> (f64, f64) {
    let along = sub(b, a);
    let size = dot(along, along);
    let t = if size > 0.0 {
        (dot(sub(x, a), along) / size).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (norm(sub(x, add(a, scale(along, t)))), t)
}
