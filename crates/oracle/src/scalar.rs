//! The two number types of the oracle.

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::DoubleDouble;

/// A real number of some precision: [`f64`] with 53 bits or [`DoubleDouble`] with about 105.
pub trait RealNumber:
    Copy
    + Debug
    + PartialOrd
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Excess angle in radians above which a vertex is a saddle. It is well above the rounding of
    /// this type. Ignoring a smaller excess changes the length of a path by half its square, which
    /// is below that rounding.
    const SADDLE_SLACK: f64;

    /// Height of a triangle, relative to its longest side, below which its corners count as points
    /// where paths bend: seen over that height, the rounding of a position on a side is a
    /// noticeable angle.
    const THIN: f64;

    /// Relative excess of length from which a path is dropped in favour of another: well above the
    /// rounding of both.
    const LEAD: f64;

    /// The number `value`, exactly.
    fn from_f64(value: f64) -> Self;

    /// The nearest `f64`.
    fn to_f64(self) -> f64;

    /// The square root of a non-negative number.
    #[must_use]
    fn sqrt(self) -> Self;

    /// 0.
    fn zero() -> Self {
        Self::from_f64(0.0)
    }

    /// The smaller of two numbers.
    #[must_use]
    fn min(self, other: Self) -> Self {
        if other < self { other } else { self }
    }

    /// The larger of two numbers.
    #[must_use]
    fn max(self, other: Self) -> Self {
        if other > self { other } else { self }
    }

    /// The length of the plane vector `(self, y)`.
    #[must_use]
    fn hypot(self, y: Self) -> Self {
        (self * self + y * y).sqrt()
    }
}

impl RealNumber for f64 {
    const SADDLE_SLACK: f64 = 1e-10;
    const THIN: f64 = 1e-7;
    const LEAD: f64 = 1e-12;

    fn from_f64(value: f64) -> Self {
        value
    }

    fn to_f64(self) -> f64 {
        self
    }

    fn sqrt(self) -> Self {
        self.sqrt()
    }
}

impl RealNumber for DoubleDouble {
    const SADDLE_SLACK: f64 = 1e-15;
    const THIN: f64 = 1e-15;
    const LEAD: f64 = 1e-15;

    fn from_f64(value: f64) -> Self {
        Self::new(value)
    }

    fn to_f64(self) -> f64 {
        self.high()
    }

    fn sqrt(self) -> Self {
        self.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hypot_min_and_max_work_in_both_types() {
        assert_eq!(RealNumber::hypot(3.0_f64, 4.0), 5.0);
        let (three, four) = (DoubleDouble::new(3.0), DoubleDouble::new(4.0));
        assert_eq!(three.hypot(four).to_f64(), 5.0);
        assert_eq!(three.min(four).to_f64(), 3.0);
        assert_eq!(three.max(four).to_f64(), 4.0);
    }
}
