//! What is reported of repeated times: robust figures, never the mean alone.

use crate::rng::SplitMix64;

/// Fewest samples from which a confidence interval is given.
pub const FEWEST_FOR_INTERVAL: usize = 5;

/// Resamples of the bootstrap.
const RESAMPLES: usize = 10_000;

/// Seed of the bootstrap, fixed so that the same samples always give the same interval.
const SEED: u64 = 0x6765_6f62_656e_6368;

/// Robust figures of a set of samples, in the unit of the samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Median; of an even number of samples the mean of the middle two.
    pub median: f64,
    /// Smallest sample.
    pub min: f64,
    /// Median absolute deviation from the median, unscaled.
    pub mad: f64,
    /// 95 % confidence interval of the median by the percentile bootstrap; none from fewer than
    /// [`FEWEST_FOR_INTERVAL`] samples.
    pub ci95: Option<[f64; 2]>,
}

/// Summarises `samples`, or nothing if there are none.
pub fn summarise(samples: &[f64]) -> Option<Summary> {
    let median = median(samples)?;
    let deviations: Vec<f64> = samples.iter().map(|s| (s - median).abs()).collect();
    Some(Summary {
        median,
        min: samples.iter().copied().fold(f64::INFINITY, f64::min),
        mad: self::median(&deviations)?,
        ci95: (samples.len() >= FEWEST_FOR_INTERVAL).then(|| bootstrap(samples)),
    })
}

/// The median of `values`, in any order; none if there are none.
pub fn median(values: &[f64]) -> Option<f64> {
    let mut values = values.to_vec();
    median_in_place(&mut values)
}

fn median_in_place(values: &mut [f64]) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    let n = values.len();
    match n {
        0 => None,
        _ if n % 2 == 1 => Some(values[n / 2]),
        _ => Some(f64::midpoint(values[n / 2 - 1], values[n / 2])),
    }
}

/// The 2.5th and 97.5th percentiles of the medians of resamples drawn with replacement.
fn bootstrap(samples: &[f64]) -> [f64; 2] {
    let mut random = SplitMix64::new(SEED);
    let mut resample = vec![0.0; samples.len()];
    let mut medians: Vec<f64> = (0..RESAMPLES)
        .filter_map(|_| {
            for slot in &mut resample {
                *slot = samples[random.below(samples.len())];
            }
            median_in_place(&mut resample)
        })
        .collect();
    medians.sort_unstable_by(f64::total_cmp);
    let tail = RESAMPLES / 40;
    [medians[tail], medians[RESAMPLES - 1 - tail]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn odd_even_and_no_samples() {
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&[4.0, 1.0, 3.0, 2.0]), Some(2.5));
        assert_eq!(summarise(&[]), None);
    }

    #[test]
    fn an_outlier_moves_neither_median_nor_deviation() {
        let summary = summarise(&[1.0, 1.1, 0.9, 1.0, 50.0]).unwrap();
        assert_eq!(summary.median, 1.0);
        assert_eq!(summary.min, 0.9);
        assert!((summary.mad - 0.1).abs() < 1e-12);
    }

    #[test]
    fn few_samples_have_no_interval() {
        assert_eq!(summarise(&[1.0, 2.0, 3.0, 4.0]).unwrap().ci95, None);
        assert!(
            summarise(&[1.0, 2.0, 3.0, 4.0, 5.0])
                .unwrap()
                .ci95
                .is_some()
        );
    }

    #[test]
    fn the_interval_holds_the_median_and_narrows_with_more_samples() {
        let spread = |n: usize| -> f64 {
            let samples: Vec<f64> = (0..n).map(|i| (i * 37 % 101) as f64).collect();
            let summary = summarise(&samples).unwrap();
            let [low, high] = summary.ci95.unwrap();
            assert!(low <= summary.median && summary.median <= high);
            high - low
        };
        // 95 % intervals of the median of 101 and of 10 values spread over 0..=100: about
        // 100 / sqrt(n) to either side.
        let (few, many) = (spread(10), spread(101));
        assert!(many < few, "{many} {few}");
        assert!((10.0..40.0).contains(&many), "{many}");
    }

    #[test]
    fn equal_samples_have_a_point_interval_and_the_seed_is_fixed() {
        assert_eq!(summarise(&[2.0; 7]).unwrap().ci95, Some([2.0, 2.0]));
        let samples = [0.3, 0.1, 0.9, 0.4, 0.7, 0.2];
        assert_eq!(summarise(&samples), summarise(&samples));
    }
}
