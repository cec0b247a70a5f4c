//! Ball arithmetic on double-doubles: a number of some 31 digits with a bound of its error.
//!
//! Interval arithmetic on doubles loses a few units in the last place in each operation, and these
//! add up over the faces that a path crosses. Inputs are exact here, so only the errors of the
//! distances are left in a proof.
//!
//! Let u be 2^-53. A number is kept as hi + lo with |lo| <= 2u |hi|. The low parts are added and
//! multiplied in plain arithmetic. They are at most 5u of the *size* of the operation: of the sum
//! of the absolute values of at most three products, or of the result, for a quotient or a root. A
//! dozen operations on them lose at most 60 u² of the size. Products of two low parts are left out:
//! another 4 u². So 2^-100 of the size bounds the error. That of a sum is at most 2^-104 of the
//! result (M. Joldes, J.-M. Muller, V. Popescu, Tight and rigorous error bounds for basic building
//! blocks of double-word arithmetic, 2017).

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::interval::{Interval, LEAST, above};

/// More than the error of an operation, as a fraction of its size: 2^-100.
const RELATIVE: f64 = 7.9e-31;

/// Covers the rounding of the operations on error bounds.
const GENEROUS: f64 = 1.0 + 1e-14;

/// More than the error of an operation that underflows, and the root of it.
const UNDERFLOW: f64 = 64.0 * LEAST;
const ROOT_OF_UNDERFLOW: f64 = 2e-161;

/// The real numbers that differ from `hi + lo` by at most `error`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ball {
    hi: f64,
    lo: f64,
    error: f64,
}

impl Ball {
    pub(crate) const ZERO: Self = Self::exact(0.0);

    /// The exact number `x`.
    pub(crate) const fn exact(x: f64) -> Self {
        Self {
            hi: x,
            lo: 0.0,
            error: 0.0,
        }
    }

    /// The result of an operation of this size, with this error of its operands.
    #[inline]
    fn rounded(hi: f64, lo: f64, error: f64, size: f64) -> Self {
        Self {
            hi,
            lo,
            error: (error + size * RELATIVE + UNDERFLOW) * GENEROUS,
        }
    }

    /// The number itself, rounded; NaN if its error has no bound.
    pub(crate) fn middle(self) -> f64 {
        if self.error.is_finite() {
            self.hi
        } else {
            f64::NAN
        }
    }

    /// The exact number in its middle.
    pub(crate) const fn without_error(self) -> Self {
        Self { error: 0.0, ..self }
    }

    /// An upper bound of all numbers.
    pub(crate) fn upper(self) -> f64 {
        let rest = self.lo + self.error;
        if rest == 0.0 {
            self.hi
        } else {
            above(self.hi + above(rest))
        }
    }

    /// A lower bound of all numbers.
    pub(crate) fn lower(self) -> f64 {
        -(-self).upper()
    }

    pub(crate) fn interval(self) -> Interval {
        Interval {
            lo: self.lower(),
            hi: self.upper(),
        }
    }

    pub(crate) fn abs(self) -> Self {
        // The absolute value is 1-Lipschitz.
        if self.hi < 0.0 { -self } else { self }
    }
}

impl Add for Ball {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        // Where two numbers are nearly equal, the direction of their difference counts. So the low
        // parts are added exactly as well, and the error is relative to the result.
        let (high, rest) = two_sum(self.hi, other.hi);
        let (low, lost) = two_sum(self.lo, other.lo);
        let (high, rest) = fast_two_sum(high, rest + low);
        let (hi, lo) = fast_two_sum(high, rest + lost);
        Self::rounded(hi, lo, self.error + other.error, hi.abs())
    }
}

impl Neg for Ball {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            hi: -self.hi,
            lo: -self.lo,
            error: self.error,
        }
    }
}

impl Sub for Ball {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Ball {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        dot([self], [other])
    }
}

impl Div for Ball {
    type Output = Self;

    /// NaN if the divisor may be zero.
    fn div(self, other: Self) -> Self {
        let divisor = other.hi.abs() * (1.0 - 1e-15) - other.error;
        if divisor <= 0.0 || divisor.is_nan() {
            return Self::exact(f64::NAN);
        }
        let quotient = self.hi / other.hi;
        // The rest of a rounded quotient is an `f64`.
        let rest = (-quotient).mul_add(other.hi, self.hi) + (self.lo - quotient * other.lo);
        let (hi, lo) = two_sum(quotient, rest / other.hi);
        let error = self.error + UNDERFLOW + hi.abs() * (1.0 + 1e-15) * other.error;
        Self::rounded(hi, lo, error / divisor, hi.abs())
    }
}

/// A vector whose coordinates are known up to balls.
pub(crate) type BallVector<const N: usize> = [Ball; N];

#[inline]
pub(crate) fn minus<const N: usize>(a: BallVector<N>, b: BallVector<N>) -> BallVector<N> {
    std::array::from_fn(|i| a[i] - b[i])
}

/// The sum of at most three products, without the errors of the factors, and its size.
#[inline]
fn sum_of_products<const N: usize>(a: &BallVector<N>, b: &BallVector<N>) -> [f64; 3] {
    let product = |i: usize| {
        let (product, rest) = two_product(a[i].hi, b[i].hi);
        (product, rest + (a[i].hi * b[i].lo + a[i].lo * b[i].hi))
    };
    let (mut high, mut low) = product(0);
    let mut size = high.abs();
    for i in 1..N {
        let (product, rest) = product(i);
        let (sum, lost) = two_sum(high, product);
        high = sum;
        low += lost + rest;
        size += product.abs();
    }
    [high, low, size]
}

#[inline]
pub(crate) fn dot<const N: usize>(a: BallVector<N>, b: BallVector<N>) -> Ball {
    let [high, low, size] = sum_of_products(&a, &b);
    let (hi, lo) = two_sum(high, low);
    let errors = a.iter().zip(&b);
    let error = errors.fold(0.0, |sum, (a, b)| {
        sum + (a.hi.abs() * b.error + (b.hi.abs() + b.error) * a.error)
    });
    Ball::rounded(hi, lo, error, size)
}

/// The length of a vector. It changes by no more than the vector.
#[inline]
pub(crate) fn norm<const N: usize>(a: BallVector<N>) -> Ball {
    let [high, low, _] = sum_of_products(&a, &a);
    let root = high.sqrt();
    let rest = (-root).mul_add(root, high) + low;
    let rest = if root > 0.0 { rest / (2.0 * root) } else { 0.0 };
    let (hi, lo) = two_sum(root, rest);
    let error = a.iter().fold(ROOT_OF_UNDERFLOW, |sum, a| sum + a.error);
    Ball::rounded(hi, lo, error, hi)
}

/// The third coordinate of the cross product of two vectors of the plane.
#[inline]
pub(crate) fn cross(a: BallVector<2>, b: BallVector<2>) -> Ball {
    dot([a[0], -a[1]], [b[1], b[0]])
}

/// The length of the cross product of two vectors of space.
pub(crate) fn cross_length(a: BallVector<3>, b: BallVector<3>) -> Ball {
    let in_plane = |i: usize, j: usize| cross([a[i], a[j]], [b[i], b[j]]);
    norm([in_plane(1, 2), in_plane(2, 0), in_plane(0, 1)])
}

/// The rounded sum and its rounding error.
pub(crate) fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let from_b = sum - a;
    (sum, (a - (sum - from_b)) + (b - from_b))
}

/// As [`two_sum`], if `a` is 0 or has no lower exponent than `b`.
fn fast_two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// The rounded product and its rounding error.
pub(crate) fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    (product, a.mul_add(b, -product))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn square(x: Ball) -> Ball {
        x * x
    }

    #[test]
    fn errors_are_enclosed_and_small() {
        let third = Ball::exact(1.0) / Ball::exact(3.0);
        let one = third + third + third;
        let zero = one - Ball::exact(1.0);
        assert!(zero.lower() <= 0.0 && zero.upper() >= 0.0);
        assert!(zero.upper() - zero.lower() < 1e-29);
        let two = square(norm([Ball::exact(1.0); 2])) - Ball::exact(2.0);
        assert!(two.lower() <= 0.0 && two.upper() >= 0.0 && two.upper() < 1e-29);
        assert!((Ball::exact(1.0) / (third - third)).middle().is_nan());
    }

    proptest! {
        /// Identities of exact numbers hold up to the errors.
        #[test]
        fn identities_hold(a in -1e3..1e3f64, b in -1e3..1e3f64, c in -1e-3..1e-3f64) {
            let [a, b, c] = [a, b, c].map(Ball::exact);
            let encloses_zero = |x: Ball| x.lower() <= 0.0 && x.upper() >= 0.0;
            let sum = a + c;
            prop_assert!(encloses_zero(sum * b - a * b - c * b));
            prop_assert!(encloses_zero(square(sum) - square(a) - square(c) - a * c - c * a));
            prop_assert!(encloses_zero(norm([sum]) - sum.abs()));
            prop_assert!(encloses_zero(square(norm([sum, b])) - dot([sum, b], [sum, b])));
            if !encloses_zero(b) {
                prop_assert!(encloses_zero(sum / b * b - sum));
                // Again with inexact operands.
                let x = sum / b;
                prop_assert!(encloses_zero(square(norm([x, c])) - square(x) - square(c)));
                prop_assert!(encloses_zero(cross([x, a], [b, sum]) - x * sum + a * b));
                prop_assert!(encloses_zero((x + b) * (x - b) - square(x) + square(b)));
            }
        }
    }
}
