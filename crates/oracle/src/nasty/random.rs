//! Random numbers for nasty meshes.

use crate::random::Random;

impl Random {
    /// A number from about 10^`from` to 10^`to` with a uniform logarithm; one in four is a power of
    /// two.
    pub(super) fn magnitude(&mut self, from: i32, to: i32) -> f64 {
        const BITS_PER_DIGIT: f64 = std::f64::consts::LOG2_10;
        let [least, most] = [from, to].map(|digits| f64::from(digits) * BITS_PER_DIGIT);
        let exponent = self.between(least, most).floor();
        let power = 2.0_f64.powi(exponent as i32);
        if self.below(4) == 0 {
            power
        } else {
            power * self.between(1.0, 2.0)
        }
    }

    /// An integer from `from` to `to`.
    pub(super) fn whole(&mut self, from: u32, to: u32) -> u32 {
        from + self.below(to - from + 1)
    }

    /// A fraction of an edge: a half, a quarter, an arbitrary one, or nearly 0.
    pub(super) fn part(&mut self) -> f64 {
        match self.below(4) {
            0 => 0.5,
            1 => 0.25,
            2 => self.between(0.05, 0.95),
            _ => self.magnitude(-14, -1),
        }
    }

    /// `true` half of the time.
    pub(super) fn coin(&mut self) -> bool {
        self.below(2) == 0
    }
}
