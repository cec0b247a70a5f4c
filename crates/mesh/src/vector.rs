//! Vectors in a plane and in space, as arrays. For the crates of the suite; it may change.

/// A point or vector in the plane of a face.
pub type Point = [f64; 2];

/// Entry `i` of each array. `map` of an array is not always compiled inline, and then a loop over
/// `i` has no vector instructions.
#[inline]
pub fn column<const N: usize>(arrays: &[[f64; N]; 3], i: usize) -> [f64; 3] {
    [arrays[0][i], arrays[1][i], arrays[2][i]]
}

/// a + b.
#[inline]
pub fn add<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|i| a[i] + b[i])
}

/// a - b.
#[inline]
pub fn sub<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|i| a[i] - b[i])
}

/// t · a.
#[inline]
pub fn scale<const N: usize>(a: [f64; N], t: f64) -> [f64; N] {
    a.map(|x| x * t)
}

/// The scalar product.
#[inline]
pub fn dot<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
    let mut sum = a[0] * b[0];
    for i in 1..N {
        sum += a[i] * b[i];
    }
    sum
}

/// The vector product in space.
#[inline]
pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The area of the parallelogram of two vectors in the plane; positive if `b` is to the left of
/// `a`.
#[inline]
pub fn cross_2d(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// The length of `a`. The squares of lengths do not overflow in a valid mesh, and `hypot` is
/// several times slower.
#[inline]
pub fn norm<const N: usize>(a: [f64; N]) -> f64 {
    dot(a, a).sqrt()
}

/// The unit vector along `a`; zero if `a` is zero.
#[inline]
pub fn unit<const N: usize>(a: [f64; N]) -> [f64; N] {
    let length = norm(a);
    if length > 0.0 {
        a.map(|x| x / length)
    } else {
        [0.0; N]
    }
}

/// The point at fraction `t` of the way from `a` to `b`; exact at both ends.
#[inline]
pub fn between<const N: usize>(a: [f64; N], b: [f64; N], t: f64) -> [f64; N] {
    if t == 1.0 {
        return b;
    }
    std::array::from_fn(|i| a[i] + t * (b[i] - a[i]))
}

/// a + t · b.
#[inline]
pub fn along<const N: usize>(a: [f64; N], t: f64, b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|i| a[i] + t * b[i])
}

/// `a` turned to the left by a right angle.
#[inline]
pub fn turned(a: Point) -> Point {
    [-a[1], a[0]]
}

/// The distance of `x` from the segment between `a` and `b`, and the position of the nearest point
/// on the segment, from 0 at `a` to 1 at `b`.
pub fn nearest_on_segment(x: Point, [a, b]: [Point; 2]) -> (f64, f64) {
    let ab = sub(b, a);
    let size = dot(ab, ab);
    let t = if size > 0.0 {
        (dot(sub(x, a), ab) / size).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (norm(sub(x, add(a, scale(ab, t)))), t)
}
