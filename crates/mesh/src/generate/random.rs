//! A small generator of pseudo-random numbers that will never change.

/// `SplitMix64` (Steele, Lea, Flood 2014): a counter stepped by an odd constant, and a mixing
/// function that turns the counter into the output.
///
/// A spec promises the same bits for ever, so this stands here instead of a dependency whose next
/// version might draw otherwise.
#[derive(Clone, Debug)]
pub(super) struct Random {
    counter: u64,
}

/// 2^64 divided by the golden ratio, made odd.
const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

const fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

impl Random {
    /// A generator for `seed` and one use of it; different uses draw unrelated numbers.
    pub(super) const fn new(seed: u64, usage: u64) -> Self {
        Self {
            counter: mix(mix(seed.wrapping_add(STEP)) ^ usage),
        }
    }

    /// The next 64 bits.
    pub(super) const fn next(&mut self) -> u64 {
        self.counter = self.counter.wrapping_add(STEP);
        mix(self.counter)
    }

    /// Uniform in [0, 1), a multiple of 2^-53.
    pub(super) fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// Uniform in [-1, 1).
    pub(super) fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// Uniform in [-1, 1), a function of `place` alone that leaves the generator as it was.
    pub(super) fn signed_at(&self, place: u64) -> f64 {
        let mut there = Self {
            counter: mix(self.counter ^ mix(place)),
        };
        there.signed()
    }
}

#[cfg(test)]
mod tests {
    use super::Random;

    /// The published test values of `SplitMix64` with seed 1234567.
    #[test]
    fn draws_the_published_numbers() {
        let mut random = Random { counter: 1_234_567 };
        let drawn = [random.next(), random.next(), random.next()];
        let published = [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
        ];
        assert_eq!(drawn, published);
    }

    #[test]
    fn units_fill_their_interval_evenly() {
        let mut random = Random::new(1, 0);
        let drawn: Vec<f64> = (0..10_000).map(|_| random.unit()).collect();
        let mean = drawn.iter().sum::<f64>() / 10_000.0;
        assert!((mean - 0.5).abs() < 0.01, "mean {mean}");
        assert!(drawn.iter().all(|x| (0.0..1.0).contains(x)));
    }

    #[test]
    fn seeds_uses_and_places_differ() {
        let first = |seed, usage| Random::new(seed, usage).next();
        assert_ne!(first(1, 0), first(2, 0));
        assert_ne!(first(1, 0), first(1, 1));
        let random = Random::new(1, 0);
        assert_ne!(random.signed_at(0), random.signed_at(1));
        assert_eq!(random.signed_at(5), random.signed_at(5));
    }
}
