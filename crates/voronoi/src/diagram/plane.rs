//! Points and vectors in the plane of a face.

/// A point, or a vector.
pub(crate) type Point = [f64; 2];

#[inline]
pub(crate) fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

#[inline]
pub(crate) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

#[inline]
pub(crate) fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// The length of `a`. The squares of lengths do not overflow in a valid mesh, and `hypot` is
/// several times slower.
#[inline]
pub(crate) fn norm(a: Point) -> f64 {
    dot(a, a).sqrt()
}

/// The unit vector along `a`; zero if `a` is zero.
#[inline]
pub(crate) fn unit(a: Point) -> Point {
    let length = norm(a);
    if length > 0.0 {
        a.map(|c| c / length)
    } else {
        [0.0; 2]
    }
}

/// The point at fraction `t` of the way from `a` to `b`.
#[inline]
pub(crate) fn between(a: Point, b: Point, t: f64) -> Point {
    // Exact at both ends.
    if t == 1.0 {
        return b;
    }
    [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
}

/// `a` + `t`·`b`.
#[inline]
pub(crate) fn along(a: Point, t: f64, b: Point) -> Point {
    [a[0] + t * b[0], a[1] + t * b[1]]
}
