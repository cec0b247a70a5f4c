//! Random numbers that are the same on every machine and in every version.

/// `SplitMix64` of Steele, Lea and Flood (2014). Written out here because the random sources of a
/// benchmark, and so its results, must not change with the version of a library.
#[derive(Clone, Debug)]
pub(crate) struct SplitMix64(u64);

impl SplitMix64 {
    /// The sequence that `seed` starts.
    pub(crate) const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The sequence that belongs to one source in one model under `seed`.
    pub(crate) fn of(seed: u64, model: &str, source: u32) -> Self {
        let bytes = model.bytes().chain(source.to_le_bytes());
        Self(bytes.fold(seed, |state, byte| Self(state ^ u64::from(byte)).next()))
    }

    /// The next number.
    pub(crate) const fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number from 0 to `n - 1`; `n` is positive. The bias of about n/2^64 is of no account.
    pub(crate) const fn below(&mut self, n: usize) -> usize {
        ((self.next() as u128 * n as u128) >> 64) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_sequence() {
        let mut random = SplitMix64::new(1_234_567);
        assert_eq!(random.next(), 6_457_827_717_110_365_317);
        assert_eq!(random.next(), 3_203_168_211_198_807_973);
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
}
