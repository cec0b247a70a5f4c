//! How many times as long one thing takes as another.

use super::{FEWEST_FOR_INTERVAL, bootstrap, median};

/// A ratio with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratio {
    /// The estimate.
    pub ratio: f64,
    /// Its 95 % interval by the percentile bootstrap; none from fewer than
    /// [`FEWEST_FOR_INTERVAL`] samples on a side.
    pub ci95: Option<[f64; 2]>,
}

impl Ratio {
    /// Whether the interval lies wholly above `limit`.
    pub fn exceeds(&self, limit: f64) -> bool {
        self.ci95.is_some_and(|[low, _]| low > limit)
    }

    /// Whether the interval lies wholly below `limit`.
    pub fn falls_below(&self, limit: f64) -> bool {
        self.ci95.is_some_and(|[_, high]| high < limit)
    }
}

/// The median of `over[i] / under[i]`, where the samples at the same place were taken next to each
/// other. Whatever changes slowly on the machine changes both, and leaves their ratio alone.
///
/// None unless there are as many of both, at least one, and all are finite and above 0.
pub fn paired_ratio(over: &[f64], under: &[f64]) -> Option<Ratio> {
    if over.len() != under.len() || !usable(over) || !usable(under) {
        return None;
    }
    let ratios: Vec<f64> = over.iter().zip(under).map(|(a, b)| a / b).collect();
    Some(Ratio {
        ratio: median(&ratios)?,
        ci95: (ratios.len() >= FEWEST_FOR_INTERVAL)
            .then(|| bootstrap::interval(&[&ratios], |[ratio]| ratio)),
    })
}

/// The ratio of the medians of two sets of samples that have nothing to do with each other; for
/// the interval each is resampled by itself.
///
/// None unless there is at least one of each and all are finite and above 0.
pub fn unpaired_ratio(over: &[f64], under: &[f64]) -> Option<Ratio> {
    if !usable(over) || !usable(under) {
        return None;
    }
    let enough = over.len().min(under.len()) >= FEWEST_FOR_INTERVAL;
    Some(Ratio {
        ratio: median(over)? / median(under)?,
        ci95: enough.then(|| bootstrap::interval(&[over, under], |[a, b]| a / b)),
    })
}

fn usable(samples: &[f64]) -> bool {
    !samples.is_empty() && samples.iter().all(|&x| x.is_finite() && x > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drift_leaves_a_paired_ratio_alone() {
        // The machine becomes three times as slow; the second program always takes 1.2 times as
        // long as the first.
        let under: Vec<f64> = (0..9).map(|i| 1.0 + 0.25 * f64::from(i)).collect();
        let over: Vec<f64> = under.iter().map(|t| 1.2 * t).collect();
        let paired = paired_ratio(&over, &under).unwrap();
        assert!((paired.ratio - 1.2).abs() < 1e-12);
        let [low, high] = paired.ci95.unwrap();
        assert!((low - 1.2).abs() < 1e-12 && (high - 1.2).abs() < 1e-12);
        assert!(paired.exceeds(1.1) && !paired.exceeds(1.21) && !paired.falls_below(1.1));

        let unpaired = unpaired_ratio(&over, &under).unwrap();
        assert!((unpaired.ratio - 1.2).abs() < 1e-12);
        let [low, high] = unpaired.ci95.unwrap();
        assert!(low < 0.9 && high > 1.5, "{low} {high}");
        assert!(!unpaired.exceeds(1.0));
    }

    #[test]
    fn too_few_samples_have_a_ratio_and_no_interval() {
        let ratio = paired_ratio(&[3.0, 3.0], &[2.0, 2.0]).unwrap();
        assert_eq!((ratio.ratio, ratio.ci95), (1.5, None));
        assert!(!ratio.exceeds(1.0) && !ratio.falls_below(9.0));
        let ratio = unpaired_ratio(&[3.0; 9], &[2.0; 4]).unwrap();
        assert_eq!((ratio.ratio, ratio.ci95), (1.5, None));
    }

    #[test]
    fn what_has_no_ratio_has_none() {
        assert_eq!(paired_ratio(&[], &[]), None);
        assert_eq!(paired_ratio(&[1.0], &[1.0, 2.0]), None);
        assert_eq!(paired_ratio(&[1.0], &[0.0]), None);
        assert_eq!(unpaired_ratio(&[1.0], &[]), None);
        assert_eq!(unpaired_ratio(&[f64::NAN], &[1.0]), None);
    }
}
