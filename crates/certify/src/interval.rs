//! Interval arithmetic: every result encloses the result of the exact operation.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Slightly more than half a unit in the last place of 1.
const HALF_ULP: f64 = f64::EPSILON / 2.0 * (1.0 + f64::EPSILON);

/// The least positive (subnormal) number.
pub(crate) const LEAST: f64 = f64::from_bits(1);

/// A number below `x` by one or two units in the last place: without branches, unlike
/// `next_down` (S. Rump, P. Zimmermann, S. Boldo, G. Melquiond, Computing predecessor and successor
/// in rounding to nearest, 2009).
fn below(x: f64) -> f64 {
    x - (x.abs() * HALF_ULP + LEAST)
}

/// A number above `x` by one or two units in the last place.
pub(crate) fn above(x: f64) -> f64 {
    x + (x.abs() * HALF_ULP + LEAST)
}

/// The greater number, or `b` if one of them is NaN. One instruction, unlike `f64::max`.
pub(crate) fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The lesser number, or `b` if one of them is NaN.
pub(crate) fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The real numbers from `lo` to `hi`. Ends are moved outwards by at least one unit in the last
/// place, which is more than the rounding of an operation.
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

    /// The interval between two rounded results, widened by their rounding errors.
    fn outwards(lo: f64, hi: f64) -> Self {
        Self {
            lo: below(lo),
            hi: above(hi),
        }
    }

    pub(crate) fn square(self) -> Self {
        let Self { lo, hi } = self.abs();
        let (a, b) = (lo * lo, hi * hi);
        Self {
            // A square is never negative, so the lower end can stay at 0.
            lo: greater(below(a), 0.0),
            hi: above(b),
        }
    }

    /// The square root. Negative numbers in the interval are ignored: the exact argument is never
    /// negative.
    pub(crate) fn sqrt(self) -> Self {
        Self {
            lo: greater(below(greater(self.lo, 0.0).sqrt()), 0.0),
            hi: above(greater(self.hi, 0.0).sqrt()),
        }
    }

    pub(crate) fn abs(self) -> Self {
        // At most one of both is positive.
        Self {
            lo: greater(greater(self.lo, -self.hi), 0.0),
            hi: greater(self.hi, -self.lo),
        }
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
        let (a, b) = (self.lo * other.lo, self.lo * other.hi);
        let (c, d) = (self.hi * other.lo, self.hi * other.hi);
        Self::outwards(
            lesser(lesser(a, b), lesser(c, d)),
            greater(greater(a, b), greater(c, d)),
        )
    }
}

impl Div for Interval {
    type Output = Self;

    /// The whole line if the divisor may be zero.
    fn div(self, other: Self) -> Self {
        if other.lo <= 0.0 && other.hi >= 0.0 {
            return Self {
                lo: f64::NEG_INFINITY,
                hi: f64::INFINITY,
            };
        }
        let (a, b) = (self.lo / other.lo, self.lo / other.hi);
        let (c, d) = (self.hi / other.lo, self.hi / other.hi);
        Self::outwards(
            lesser(lesser(a, b), lesser(c, d)),
            greater(greater(a, b), greater(c, d)),
        )
    }
}

/// A vector of the plane or of space whose coordinates are known up to intervals.
pub(crate) type IntervalVector<const N: usize> = [Interval; N];

pub(crate) fn minus<const N: usize>(
    a: IntervalVector<N>,
    b: IntervalVector<N>,
) -> IntervalVector<N> {
    std::array::from_fn(|i| a[i] - b[i])
}

pub(crate) fn norm<const N: usize>(a: IntervalVector<N>) -> Interval {
    let squares = a.map(Interval::square);
    let rest = squares[1..].iter();
    rest.fold(squares[0], |sum, &x| sum + x).sqrt()
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

    proptest! {
        #[test]
        fn ends_move_by_a_unit_in_the_last_place(bits in any::<u64>()) {
            let x = f64::from_bits(bits);
            if x.is_finite() {
                prop_assert!(below(x) <= x.next_down() && above(x) >= x.next_up());
                prop_assert!(below(x) >= x.next_down().next_down());
                prop_assert!(above(x) <= x.next_up().next_up());
            }
        }
    }

    #[test]
    fn ends_move_at_powers_of_two_and_at_zero() {
        for x in [
            0.0,
            -0.0,
            1.0,
            -1.0,
            0.5,
            f64::MIN_POSITIVE,
            -f64::MIN_POSITIVE,
            f64::MAX,
        ] {
            assert!(below(x) < x && above(x) > x, "{x}");
        }
        assert_eq!(above(f64::INFINITY), f64::INFINITY);
        assert_eq!(below(f64::NEG_INFINITY), f64::NEG_INFINITY);
    }

    #[test]
    fn a_tenth_ten_times_is_enclosed_but_not_one() {
        let tenth = Interval::exact(1.0) / Interval::exact(10.0);
        let sum = (0..10).fold(Interval::ZERO, |sum, _| sum + tenth);
        assert!(encloses(sum, 1.0) && sum.lo < sum.hi && sum.hi - sum.lo < 1e-14);
    }
}
