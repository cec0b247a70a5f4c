//! A small generator of pseudo-random numbers that never changes.

/// `SplitMix64` (Steele, Lea, Flood 2014): a counter stepped by an odd constant, and a mixing
/// function that turns the counter into the output.
///
/// The specs of generated models and the random sources of a benchmark must give the same numbers
/// in all versions. A dependency might change its numbers.
///
/// ```
/// let mut random = geobench_mesh::SplitMix64::new(1_234_567);
/// assert_eq!(random.next(), 6_457_827_717_110_365_317);
/// ```
#[derive(Clone, Debug)]
pub struct SplitMix64 {
    counter: u64,
}

/// 2^64 divided by the golden ratio, rounded to an odd number.
const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

const fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

impl SplitMix64 {
    /// The published sequence of `seed`.
    pub const fn new(seed: u64) -> Self {
        Self { counter: seed }
    }

    /// The sequence for one use of `seed`. Different uses draw unrelated numbers.
    pub(crate) const fn for_use(seed: u64, usage: u64) -> Self {
        Self::new(mix(mix(seed.wrapping_add(STEP)) ^ usage))
    }

    /// The next 64 bits.
    pub const fn next(&mut self) -> u64 {
        self.counter = self.counter.wrapping_add(STEP);
        mix(self.counter)
    }

    /// A number from 0 to `n - 1`; 0 if `n` is 0. Its bias of about n/2^64 is negligible.
    pub const fn below(&mut self, n: usize) -> usize {
        ((self.next() as u128 * n as u128) >> 64) as usize
    }

    /// Uniform in [0, 1), a multiple of 2^-53.
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// Uniform in [-1, 1).
    pub(crate) fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// Uniform in [-1, 1), as a function of the seed and `place` alone. Does not advance the
    /// generator.
    pub(crate) fn signed_at(&self, place: u64) -> f64 {
        Self::new(mix(self.counter ^ mix(place))).signed()
    }
}

#[cfg(test)]
mod tests {
    use super::SplitMix64;

    /// The published test values of `SplitMix64` with seed 1234567.
    #[test]
    fn draws_the_published_numbers() {
        let mut random = SplitMix64::new(1_234_567);
        let drawn = [random.next(), random.next(), random.next()];
        let published = [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
        ];
        assert_eq!(drawn, published);
    }

    #[test]
    fn below_reaches_every_number_and_no_other() {
        let mut random = SplitMix64::new(0);
        let mut seen = [false; 7];
        for _ in 0..200 {
            seen[random.below(7)] = true;
        }
        assert_eq!(seen, [true; 7]);
    }

    #[test]
    fn units_fill_their_interval_evenly() {
        let mut random = SplitMix64::for_use(1, 0);
        let drawn: Vec<f64> = (0..10_000).map(|_| random.unit()).collect();
        let mean = drawn.iter().sum::<f64>() / 10_000.0;
        assert!((mean - 0.5).abs() < 0.01, "mean {mean}");
        assert!(drawn.iter().all(|x| (0.0..1.0).contains(x)));
    }

    #[test]
    fn seeds_uses_and_places_differ() {
        let first = |seed, usage| SplitMix64::for_use(seed, usage).next();
        assert_ne!(first(1, 0), first(2, 0));
        assert_ne!(first(1, 0), first(1, 1));
        let random = SplitMix64::for_use(1, 0);
        assert_ne!(random.signed_at(0), random.signed_at(1));
        assert_eq!(random.signed_at(5), random.signed_at(5));
    }
}
