//! Sines and cosines with the same bits on every machine.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

/// Cosine and sine of `part / whole` of a full turn, for `part <= whole` and `whole > 0`.
///
/// The angle is reduced to the first eighth of a turn in integers. Points that mirror each other
/// then have coordinates that mirror each other bit for bit, so that regular models keep their
/// ties.
pub(super) fn turn(part: u64, whole: u64) -> [f64; 2] {
    // In units of a quarter turn divided by `whole`.
    let mut a = 4 * part;
    let below = a > 2 * whole;
    if below {
        a = 4 * whole - a;
    }
    let behind = a > whole;
    if behind {
        a = 2 * whole - a;
    }
    let steep = 2 * a > whole;
    if steep {
        a = whole - a;
    }
    let (mut sin, mut cos) = libm::sincos(a as f64 / whole as f64 * FRAC_PI_2);
    if 2 * a == whole {
        // The sine and cosine of the rounded angle would differ in their last bit.
        (sin, cos) = (FRAC_1_SQRT_2, FRAC_1_SQRT_2);
    }
    if steep {
        (sin, cos) = (cos, sin);
    }
    [
        if behind { -cos } else { cos },
        if below { -sin } else { sin },
    ]
}

/// Cosine and sine of an angle in radians.
pub(super) fn angle(radians: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(radians);
    [cos, sin]
}

#[cfg(test)]
mod tests {
    use super::{angle, turn};
    use std::f64::consts::TAU;

    #[test]
    fn agrees_with_plain_angles() {
        for whole in [1, 3, 7, 8, 360] {
            for part in 0..=whole {
                let exact = turn(part, whole);
                let plain = angle(part as f64 / whole as f64 * TAU);
                for k in 0..2 {
                    assert!((exact[k] - plain[k]).abs() < 1e-15, "{part}/{whole}");
                }
            }
        }
    }

    #[test]
    fn quarter_turns_are_exact() {
        let axes = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
        for (k, axis) in axes.into_iter().enumerate() {
            assert_eq!(turn(3 * k as u64, 12), axis);
        }
    }

    #[test]
    fn mirrored_points_have_mirrored_bits() {
        for part in 0..=90 {
            let [x, y] = turn(part, 360);
            assert_eq!(turn(360 - part, 360), [x, -y]);
            assert_eq!(turn(180 - part, 360), [-x, y]);
            assert_eq!(turn(90 - part, 360), [y, x]);
        }
    }
}
