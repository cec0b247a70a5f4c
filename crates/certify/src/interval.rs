//! Interval arithmetic: every result encloses the result of the exact operation.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// The real numbers from `lo` to `hi`. Ends are rounded outwards by one unit in the last place,
/// which is more than the rounding of an operation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interval {
    pub(crate) lo: f64,
    pub(crate) hi: f64,
}

impl Interval {
    pub(crate) const ZERO: Self = Self { lo: 0.0, hi: 0.0 };

    /// Both bounds, in this order.
    pub(crate) fn new(lo: f64, hi: f64) -> Self {
        debug_assert!(lo <= hi, "{lo} {hi}");
        Self { lo, hi }
    }

    /// The exact number `x`.
    pub(crate) const fn exact(x: f64) -> Self {
        Self { lo: x, hi: x }
    }

    /// Encloses the numbers between two, whichever is less.
    fn outwards(lo: f64, hi: f64) -> Self {
        Self {
            lo: lo.next_down(),
            hi: hi.next_up(),
        }
    }

    pub(crate) fn square(self) -> Self {
        let (a, b) = (self.lo * self.lo, self.hi * self.hi);
        let least = if self.lo <= 0.0 && self.hi >= 0.0 {
            0.0
        } else {
            a.min(b).next_down().max(0.0)
        };
        Self {
            lo: least,
            hi: a.max(b).next_up(),
        }
    }

    /// The root of its numbers that are not negative; exact arguments never are.
    pub(crate) fn sqrt(self) -> Self {
        Self {
            lo: self.lo.max(0.0).sqrt().next_down().max(0.0),
            hi: self.hi.max(0.0).sqrt().next_up(),
        }
    }

    pub(crate) fn abs(self) -> Self {
        if self.lo >= 0.0 {
            self
        } else if self.hi <= 0.0 {
            -self
        } else {
            Self {
                lo: 0.0,
                hi: self.hi.max(-self.lo),
            }
        }
    }

    /// The number that stands for it where rounding does not matter.
    pub(crate) fn middle(self) -> f64 {
        f64::midpoint(self.lo, self.hi)
    }
}

impl Add for Interval {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::outwards(self.lo + other.lo, self.hi + other.hi)
    }
}

impl Sub for Interval {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self::outwards(self.lo - other.hi, self.hi - other.lo)
    }
}

impl Neg for Interval {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            lo: -self.hi,
            hi: -self.lo,
        }
    }
}

impl Mul for Interval {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let products = [
            self.lo * other.lo,
            self.lo * other.hi,
            self.hi * other.lo,
            self.hi * other.hi,
        ];
        let lo = products.into_iter().fold(f64::INFINITY, f64::min);
        let hi = products.into_iter().fold(f64::NEG_INFINITY, f64::max);
        Self::outwards(lo, hi)
    }
}

impl Div for Interval {
    type Output = Self;

    /// All numbers if the divisor may be zero.
    fn div(self, other: Self) -> Self {
        if other.lo <= 0.0 && other.hi >= 0.0 {
            return Self {
                lo: f64::NEG_INFINITY,
                hi: f64::INFINITY,
            };
        }
        let quotients = [
            self.lo / other.lo,
            self.lo / other.hi,
            self.hi / other.lo,
            self.hi / other.hi,
        ];
        let lo = quotients.into_iter().fold(f64::INFINITY, f64::min);
        let hi = quotients.into_iter().fold(f64::NEG_INFINITY, f64::max);
        Self::outwards(lo, hi)
    }
}

/// A vector of the plane or of space whose coordinates are known up to intervals.
pub(crate) type Vector<const N: usize> = [Interval; N];

pub(crate) fn minus<const N: usize>(a: Vector<N>, b: Vector<N>) -> Vector<N> {
    std::array::from_fn(|i| a[i] - b[i])
}

pub(crate) fn dot<const N: usize>(a: Vector<N>, b: Vector<N>) -> Interval {
    (0..N).fold(Interval::ZERO, |sum, i| sum + a[i] * b[i])
}

pub(crate) fn norm<const N: usize>(a: Vector<N>) -> Interval {
    a.iter()
        .fold(Interval::ZERO, |sum, x| sum + x.square())
        .sqrt()
}

/// The third coordinate of the cross product of two vectors of the plane.
pub(crate) fn cross(a: Vector<2>, b: Vector<2>) -> Interval {
    a[0] * b[1] - a[1] * b[0]
}

/// The length of the cross product of two vectors of space.
pub(crate) fn cross_length(a: Vector<3>, b: Vector<3>) -> Interval {
    norm([
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn encloses(interval: Interval, x: f64) -> bool {
        interval.lo <= x && x <= interval.hi
    }

    proptest! {
        #[test]
        fn operations_enclose_those_of_numbers(
            a in -10.0..10.0f64, b in -10.0..10.0f64, r in 0.0..1.0f64, s in 0.0..1.0f64,
            t in 0.0..=1.0f64,
        ) {
            let (x, y) = (Interval::new(a, a + r), Interval::new(b, b + s));
            let (p, q) = ((a + t * r).clamp(a, a + r), (b + t * s).clamp(b, b + s));
            prop_assert!(encloses(x + y, p + q));
            prop_assert!(encloses(x - y, p - q));
            prop_assert!(encloses(x * y, p * q));
            prop_assert!(encloses(x / y, p / q));
            prop_assert!(encloses(x.square(), p * p));
            prop_assert!(encloses(x.abs(), p.abs()));
            prop_assert!(encloses(x.square().sqrt(), p.abs()));
        }
    }

    #[test]
    fn a_tenth_ten_times_is_enclosed_but_not_one() {
        let tenth = Interval::exact(1.0) / Interval::exact(10.0);
        let sum = (0..10).fold(Interval::ZERO, |sum, _| sum + tenth);
        assert!(encloses(sum, 1.0) && sum.lo < sum.hi && sum.hi - sum.lo < 1e-14);
    }
}
