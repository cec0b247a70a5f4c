//! A number as the unevaluated sum of two `f64`, with about 31 digits.

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The sum `high + low`, where `low` is at most half a unit in the last place of `high`.
///
/// Sums, products, quotients and square roots have relative errors of some 1e-31, within the
/// exponent range of `f64`. They use the error-free sum and product (the latter by fused
/// multiply-add), as analysed by Joldes, Muller and Popescu, "Tight and rigorous error bounds for
/// basic building blocks of double-word arithmetic" (2017). The `twofloat` crate (0.8.4) is not
/// used, because its division is accurate to 1e-16 only.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DoubleDouble {
    high: f64,
    low: f64,
}

impl DoubleDouble {
    /// The number `value`, exactly.
    pub const fn new(value: f64) -> Self {
        Self {
            high: value,
            low: 0.0,
        }
    }

    /// The nearest `f64`.
    pub const fn high(self) -> f64 {
        self.high
    }

    /// The difference from [`high`](Self::high), rounded to `f64`.
    pub const fn low(self) -> f64 {
        self.low
    }

    /// `a + b` exactly.
    fn sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let b_part = high - a;
        let a_part = high - b_part;
        let low = (a - a_part) + (b - b_part);
        Self { high, low }
    }

    /// `a + b` exactly, for `a` at least as large as `b`.
    fn ordered_sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let low = b - (high - a);
        Self { high, low }
    }

    /// `a * b` exactly.
    fn product(a: f64, b: f64) -> Self {
        let high = a * b;
        let low = a.mul_add(b, -high);
        Self { high, low }
    }

    fn times(self, factor: f64) -> Self {
        let product = Self::product(self.high, factor);
        Self::ordered_sum(product.high, self.low.mul_add(factor, product.low))
    }

    /// The square root; 0 for 0, NaN for negative numbers.
    #[must_use]
    pub fn sqrt(self) -> Self {
        if self.high == 0.0 {
            return Self::default();
        }
        // One Newton step from the root in f64 doubles the number of correct digits.
        let root = self.high.sqrt();
        let rest = self - Self::product(root, root);
        Self::ordered_sum(root, rest.high / (2.0 * root))
    }
}

impl Add for DoubleDouble {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let high = Self::sum(self.high, other.high);
        let low = Self::sum(self.low, other.low);
        let partly = Self::ordered_sum(high.high, high.low + low.high);
        Self::ordered_sum(partly.high, partly.low + low.low)
    }
}

impl Sub for DoubleDouble {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let product = Self::product(self.high, other.high);
        let crossed = self.high.mul_add(other.low, self.low * other.high);
        Self::ordered_sum(product.high, product.low + crossed)
    }
}

impl Div for DoubleDouble {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        // Long division with digits of 53 bits.
        let first = self.high / other.high;
        let rest = self - other.times(first);
        let second = rest.high / other.high;
        let rest = rest - other.times(second);
        let third = rest.high / other.high;
        Self::ordered_sum(first, second) + Self::new(third)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl PartialOrd for DoubleDouble {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        match self.high.partial_cmp(&other.high) {
            Some(Ordering::Equal) => self.low.partial_cmp(&other.low),
            order => order,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2^-104, twice the rounding of one operation.
    const ROUNDING: f64 = 1.0 / (1_u128 << 104) as f64;

    fn assert_is(x: DoubleDouble, high: f64, low: f64) {
        let error = x - DoubleDouble::sum(high, low);
        assert!(
            error.high.abs() <= ROUNDING * high.abs(),
            "{x:?} is not {high:e} + {low:e}"
        );
    }

    #[test]
    fn quotients_and_roots_match_known_digits() {
        // Each expected value is the nearest double and the remainder, from an arbitrary-precision
        // calculator.
        let [one, two, three] = [1.0, 2.0, 3.0].map(DoubleDouble::new);
        assert_is(one / three, 1.0 / 3.0, 1.850_371_707_708_594_3e-17);
        assert_is(
            two.sqrt(),
            std::f64::consts::SQRT_2,
            -9.667_293_313_452_913e-17,
        );
        let a = DoubleDouble::new(7.1) + DoubleDouble::new(1e-17);
        let b = DoubleDouble::new(3.3) + DoubleDouble::new(1e-18);
        assert_is(
            DoubleDouble::new(7.1) / b,
            2.151_515_151_515_151_4,
            1.420_764_218_985_508_9e-16,
        );
        assert_is(a * b, 23.429_999_999_999_996, 1.443_421_903_126_198e-15);
    }

    #[test]
    fn operations_undo_each_other() {
        for k in -200..200 {
            let x = DoubleDouble::new(1.7_f64.powi(k)) / DoubleDouble::new(0.3);
            let y = DoubleDouble::new(f64::from(k.abs()) + 0.7).sqrt();
            assert_is((x / y) * y, x.high, x.low);
            let sum = x + y;
            let error = (sum - x) - y;
            assert!(error.high.abs() <= ROUNDING * sum.high, "{x:?} + {y:?}");
            let root = x.sqrt();
            assert_is(root * root, x.high, x.low);
        }
    }

    #[test]
    fn the_low_part_decides_equal_high_parts() {
        let one = DoubleDouble::new(1.0);
        let more = one + DoubleDouble::new(1e-25);
        assert!(one < more && one >= one);
        assert!(DoubleDouble::new(f64::NAN).partial_cmp(&one).is_none());
    }
}
