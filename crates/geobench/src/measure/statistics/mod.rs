//! What is reported of repeated times: robust figures, never the mean alone.
//!
//! * One set of samples: [`summarise`], median, deviation, interval and outliers.
//! * Two sets that were taken in turns: [`paired_ratio`], which a drifting machine does not disturb.
//! * Two sets that were not: [`unpaired_ratio`] for the size of the difference, [`mann_whitney()`] for
//!   whether there is one.
//!
//! Intervals come from the percentile bootstrap of Efron (1979) with a fixed seed, so that the same
//! samples always give the same interval.

mod bootstrap;
mod mann_whitney;
mod outliers;
mod ratio;

pub use mann_whitney::{MannWhitney, mann_whitney};
pub use outliers::{OUTLIER_SCORE, outliers};
pub use ratio::{Ratio, paired_ratio, unpaired_ratio};

use crate::schema::Time;

/// Fewest samples from which a confidence interval is given.
pub const FEWEST_FOR_INTERVAL: usize = 5;

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
    /// How many of the samples are [`outliers()`]; they count in all other figures. None from fewer
    /// than [`FEWEST_FOR_INTERVAL`] samples.
    pub outliers: Option<usize>,
}

/// Summarises `samples`, or nothing if there are none.
pub fn summarise(samples: &[f64]) -> Option<Summary> {
    let median = median(samples)?;
    let enough = samples.len() >= FEWEST_FOR_INTERVAL;
    Some(Summary {
        median,
        min: samples.iter().copied().fold(f64::INFINITY, f64::min),
        mad: deviation(samples, median)?,
        ci95: enough.then(|| bootstrap::interval(&[samples], |resamples| resamples[0])),
        outliers: enough.then(|| outliers(samples).len()),
    })
}

/// The samples of a cell and what result files say of them; their places are left empty.
pub fn time(samples: Vec<f64>, setup: Option<f64>) -> Time {
    let summary = summarise(&samples);
    Time {
        median: summary.map(|s| s.median),
        min: summary.map(|s| s.min),
        mad: summary.map(|s| s.mad),
        ci95: summary.and_then(|s| s.ci95),
        note: too_few(samples.len()),
        outliers: summary.and_then(|s| s.outliers),
        setup,
        samples,
        places: Vec::new(),
    }
}

/// Why `samples` samples have no interval, if they have none.
pub fn too_few(samples: usize) -> Option<String> {
    (samples < FEWEST_FOR_INTERVAL)
        .then(|| format!("no confidence interval from fewer than {FEWEST_FOR_INTERVAL} samples"))
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

/// The median absolute deviation of `values` from `center`.
fn deviation(values: &[f64], center: f64) -> Option<f64> {
    let mut deviations: Vec<f64> = values.iter().map(|v| (v - center).abs()).collect();
    median_in_place(&mut deviations)
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
        assert_eq!(summary.outliers, Some(1));
    }

    #[test]
    fn few_samples_have_no_interval_and_say_so() {
        let few = summarise(&[1.0, 2.0, 3.0, 4.0]).unwrap();
        assert_eq!((few.ci95, few.outliers), (None, None));
        assert!(too_few(4).unwrap().contains("fewer than 5"));
        let enough = summarise(&[1.0, 2.0, 3.0, 4.0, 5.0]).unwrap();
        assert!(enough.ci95.is_some() && too_few(5).is_none());
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
