//! Ball arithmetic on double-doubles: a number of some 31 digits with a bound of its error.
//!
//! Interval arithmetic on doubles loses a few units in the last place in each operation, and these
//! add up over the faces that a path crosses. Inputs are exact here, so only the errors of the
//! distances are left in a proof. The relative errors of sums, products, quotients and roots of
//! double-doubles are at most 2^-100 (M. Joldes, J.-M. Muller, V. Popescu, Tight and rigorous error
//! bounds for basic building blocks of double-word arithmetic, 2017; V. Lefèvre, N. Louvet, J.-M.
//! Muller, J. Picot, L. Rideau, Accurate calculation of Euclidean norms using double-word
//! arithmetic, 2023).

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::interval::{Interval, LEAST, above, lesser};

/// More than the relative error of an operation: 2^-100.
const RELATIVE: f64 = 7.9e-31;

/// Covers the rounding of the operations on error bounds.
const GENEROUS: f64 = 1.0 + 1e-14;

/// More than the error of an operation that underflows.
const UNDERFLOW: f64 = 16.0 * LEAST;

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

    /// The result of an operation with this error of its operands.
    fn rounded(hi: f64, lo: f64, error: f64) -> Self {
        Self {
            hi,
            lo,
            error: (error + hi.abs() * RELATIVE + UNDERFLOW) * GENEROUS,
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

    /// The square root. Negative numbers are ignored: the exact argument is never negative.
    pub(crate) fn sqrt(self) -> Self {
        let root = self.hi.sqrt();
        if self.hi <= 0.0 {
            let error = ((self.error + UNDERFLOW).sqrt() + self.hi.abs().sqrt()) * GENEROUS;
            return Self::rounded(0.0, 0.0, error);
        }
        let rest = (-root).mul_add(root, self.hi) + self.lo;
        let (hi, lo) = two_sum(root, rest / (2.0 * root));
        // |√(x + e) - √x| is at most e / √x, and at most √e.
        let error = lesser(self.error / root, self.error.sqrt());
        Self::rounded(hi, lo, error * (1.0 + 1e-12))
    }
}

impl Add for Ball {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (s, e) = two_sum(self.hi, other.hi);
        let (t, f) = two_sum(self.lo, other.lo);
        let (s, e) = fast_two_sum(s, e + t);
        let (hi, lo) = fast_two_sum(s, e + f);
        Self::rounded(hi, lo, self.error + other.error)
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

    fn mul(self, other: Self) -> Self {
        let (high, low) = two_product(self.hi, other.hi);
        let crossed = self.lo.mul_add(other.hi, self.hi * other.lo);
        let (hi, lo) = fast_two_sum(high, low + crossed);
        let [a, b] = [self, other].map(|x| x.hi.abs() * (1.0 + 1e-15));
        let error = a * other.error + b * self.error + self.error * other.error;
        Self::rounded(hi, lo, error)
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
        // The rest is exact up to the relative error of a product and a sum.
        let exact = |x: Self| Self { error: 0.0, ..x };
        let rest = exact(self) - exact(other) * Self::exact(quotient);
        let (hi, lo) = two_sum(quotient, rest.hi / other.hi);
        let error = self.error + hi.abs() * (1.0 + 1e-15) * other.error + rest.error;
        Self::rounded(hi, lo, error / divisor)
    }
}

/// A vector whose coordinates are known up to balls.
pub(crate) type BallVector<const N: usize> = [Ball; N];

pub(crate) fn minus<const N: usize>(a: BallVector<N>, b: BallVector<N>) -> BallVector<N> {
    std::array::from_fn(|i| a[i] - b[i])
}

pub(crate) fn dot<const N: usize>(a: BallVector<N>, b: BallVector<N>) -> Ball {
    (1..N).fold(a[0] * b[0], |sum, i| sum + a[i] * b[i])
}

pub(crate) fn norm<const N: usize>(a: BallVector<N>) -> Ball {
    dot(a, a).sqrt()
}

/// The third coordinate of the cross product of two vectors of the plane.
pub(crate) fn cross(a: BallVector<2>, b: BallVector<2>) -> Ball {
    a[0] * b[1] - a[1] * b[0]
}

/// The length of the cross product of two vectors of space.
pub(crate) fn cross_length(a: BallVector<3>, b: BallVector<3>) -> Ball {
    norm([
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ])
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
        let two = square(Ball::exact(2.0).sqrt()) - Ball::exact(2.0);
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
            prop_assert!(encloses_zero(square(sum).sqrt() - sum.abs()));
            if !encloses_zero(b) {
                prop_assert!(encloses_zero(sum / b * b - sum));
                // Again with inexact operands.
                let x = sum / b;
                prop_assert!(encloses_zero(square(x).sqrt() - x.abs()));
                prop_assert!(encloses_zero((x + b) * (x - b) - square(x) + square(b)));
            }
        }
    }
}
