//! The percentile bootstrap of figures that are made of medians.

use super::median_in_place;
use crate::measure::rng::SplitMix64;

/// Resamples of the bootstrap.
const RESAMPLES: usize = 10_000;

/// Seed of the bootstrap, fixed so that the same samples always give the same interval.
const SEED: u64 = 0x6765_6f62_656e_6368;

/// The 2.5th and 97.5th percentiles of `figure`, a function of the medians of resamples that are
/// drawn with replacement from each of `samples`, none of which is empty. O(10,000 n log n).
pub(super) fn interval<const N: usize>(
    samples: &[&[f64]; N],
    figure: impl Fn([f64; N]) -> f64,
) -> [f64; 2] {
    let mut random = SplitMix64::new(SEED);
    let mut resample = Vec::new();
    let mut figures: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            figure(samples.map(|samples| {
                resample.clear();
                resample.extend(samples.iter().map(|_| samples[random.below(samples.len())]));
                median_in_place(&mut resample).unwrap_or(f64::NAN)
            }))
        })
        .collect();
    figures.sort_unstable_by(f64::total_cmp);
    let tail = RESAMPLES / 40;
    [figures[tail], figures[RESAMPLES - 1 - tail]]
}
