//! Samples that lie far from all others.

use super::{deviation, median};

/// The modified z-score from which a sample counts as an outlier: ten times the distance that one
/// standard deviation of a normal distribution has.
///
/// The 3.5 that is often taken would call one of the usual five samples an outlier in every fifth
/// cell of a machine that is perfectly quiet, because the deviation of so few is often small by
/// chance.
pub const OUTLIER_SCORE: f64 = 10.0;

/// Mean absolute deviation of the standard normal distribution, sqrt(2/π).
const NORMAL_MEAN_DEVIATION: f64 = 0.797_884_560_802_865_4;

/// Median absolute deviation of the standard normal distribution, its 75th percentile.
const NORMAL_MEDIAN_DEVIATION: f64 = 0.674_489_750_196_081_7;

/// The places of the samples whose modified z-score (Iglewicz and Hoaglin 1993),
/// 0.6745 |x - median| / MAD, is above [`OUTLIER_SCORE`]. If more than half of the samples are equal, so that
/// their median absolute deviation is 0, the mean absolute deviation takes its place.
pub fn outliers(samples: &[f64]) -> Vec<usize> {
    let Some(median) = median(samples) else {
        return Vec::new();
    };
    let scale = match deviation(samples, median) {
        Some(mad) if mad > 0.0 => mad / NORMAL_MEDIAN_DEVIATION,
        _ => {
            let sum: f64 = samples.iter().map(|x| (x - median).abs()).sum();
            sum / samples.len() as f64 / NORMAL_MEAN_DEVIATION
        }
    };
    let far = |x: f64| (x - median).abs() > OUTLIER_SCORE * scale;
    (0..samples.len()).filter(|&i| far(samples[i])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lies_far_out_on_either_side_is_found() {
        let samples = [1.0, 1.02, 0.98, 1.01, 0.99, 9.0, 0.1];
        assert_eq!(outliers(&samples), [5, 6]);
        assert!(outliers(&[1.0, 1.02, 0.98, 1.01, 0.99]).is_empty());
        assert!(outliers(&[]).is_empty());
    }

    #[test]
    fn where_most_samples_are_equal_the_mean_deviation_decides() {
        assert!(outliers(&[2.0; 9]).is_empty());
        let mut samples = [2.0; 99];
        samples[17] = 2.5;
        assert_eq!(outliers(&samples), [17]);
        // Of nine, one is no less than a ninth of all deviation there is.
        assert!(outliers(&samples[..9]).is_empty());
    }

    /// The figure that the choice of [`OUTLIER_SCORE`] rests on.
    #[test]
    fn a_quiet_machine_has_few_outliers() {
        let mut random = crate::measure::rng::SplitMix64::new(3);
        let mut uniform = || (random.below(1 << 30) as f64 + 0.5) / f64::from(1 << 30);
        let mut share = |n: usize| {
            let cells = 20_000;
            let hit = (0..cells)
                .filter(|_| {
                    let samples: Vec<f64> = (0..n)
                        .map(|_| {
                            let (r, turn) = (uniform(), uniform());
                            (-2.0 * r.ln()).sqrt() * (std::f64::consts::TAU * turn).cos()
                        })
                        .collect();
                    !outliers(&samples).is_empty()
                })
                .count();
            hit as f64 / f64::from(cells)
        };
        let (five, twenty) = (share(5), share(20));
        assert!(five < 0.05 && twenty < 0.001, "{five} {twenty}");
    }
}
