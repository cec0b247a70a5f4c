//! Change-point detection: finds the commits at which the level of a figure changes.
//!
//! The method is optimal partitioning (Jackson et al. 2005) with the Gaussian cost of a change in
//! mean. It cuts a series into pieces of at least [`SHORTEST`] values. Of all such partitions, it
//! chooses the one with the least cost: the sum of squared deviations from the means of the pieces,
//! divided by the variance of the noise, plus a penalty for each cut. Three precautions make it
//! robust:
//!
//! * Values are logarithms, so that a change of level is a ratio.
//! * Outliers are replaced by the median of their neighbourhood before the partition (Hampel 1974).
//!   The first value after a step is not an outlier: its neighbours on one side share its level.
//! * The noise is estimated from the median of the absolute differences of successive values. A few
//!   steps hardly change this median.
//!
//! The penalty is `4 ln n + 6`. The Bayesian information criterion (Schwarz) would give `2 ln n`.
//! The penalty is larger because the noise is itself an estimate and times have heavier tails than
//! the normal distribution. The tests measure the rate of false positives on 200 values of noise.

/// The fewest values in a piece.
pub const SHORTEST: usize = 3;

/// The number of neighbours on each side of a value.
const NEIGHBOURS: usize = 2;

/// A value is an outlier if it differs from the median of its neighbourhood by more than this many
/// standard deviations of the noise.
pub(super) const FAR: f64 = 3.0;

/// The median absolute deviation of the normal distribution with standard deviation 1.
pub(super) const NORMAL_MAD: f64 = 0.674_489_750_196_081_7;

/// The share of an estimate of noise from a single difference by which it is enlarged.
const DOUBT: f64 = 12.0;

/// A change of the level of a series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelChange {
    /// Index of the first value of the new level.
    pub index: usize,
    /// Median of the piece before.
    pub before: f64,
    /// Median of the piece from there on.
    pub after: f64,
}

impl LevelChange {
    /// The new level, relative to the old one.
    pub fn ratio(&self) -> f64 {
        self.after / self.before
    }
}

/// The changes of level in `values` by a factor of at least `1 + least`, up or down. The standard
/// deviation of the noise is taken as at least `least / 5`.
///
/// Empty if there are fewer than 2 × [`SHORTEST`] values, or if a value is not finite and above 0.
/// O(n²), but O(n) if all values are the same, as most counters are.
pub fn changes(values: &[f64], least: f64) -> Vec<LevelChange> {
    if values.iter().all(|v| v.total_cmp(&values[0]).is_eq()) {
        return Vec::new();
    }
    if values.len() < 2 * SHORTEST || values.iter().any(|v| !(v.is_finite() && *v > 0.0)) {
        return Vec::new();
    }
    let logarithms: Vec<f64> = values.iter().map(|&value| libm::log(value)).collect();
    let noise = noise(&logarithms).max(least / 5.0);
    let clean = without_outliers(&logarithms, noise);
    let cuts = confirmed(&clean, &partition(&clean, noise));
    let mut pieces: Vec<(usize, usize)> = Vec::new();
    let mut start = 0;
    for end in cuts.into_iter().chain([values.len()]) {
        pieces.push((start, end));
        start = end;
    }
    let level = |&(start, end): &(usize, usize)| median(&values[start..end]);
    let mut found = Vec::new();
    // A step smaller than `least` does not end the earlier level.
    let mut before = level(&pieces[0]);
    for piece in &pieces[1..] {
        let after = level(piece);
        if libm::log(after / before).abs() >= libm::log(1.0 + least) {
            found.push(LevelChange {
                index: piece.0,
                before,
                after,
            });
            before = after;
        }
    }
    found
}

/// The standard deviation of the noise, from the differences of successive values. Few differences
/// can be small by chance, and noise would then be taken for a change: of 400 series of 6 to 15
/// commits with 2 % noise, up to 6 had one. The estimate is therefore enlarged by a share of
/// [`DOUBT`] in their number, which leaves none.
fn noise(values: &[f64]) -> f64 {
    let differences: Vec<f64> = values.windows(2).map(|w| (w[1] - w[0]).abs()).collect();
    let doubt = 1.0 + DOUBT / differences.len() as f64;
    doubt * median(&differences) / NORMAL_MAD / std::f64::consts::SQRT_2
}

/// The values, with each outlier replaced by the median of its neighbourhood.
fn without_outliers(values: &[f64], noise: f64) -> Vec<f64> {
    let clean = |index: usize| {
        let start = index.saturating_sub(NEIGHBOURS);
        let end = (index + NEIGHBOURS + 1).min(values.len());
        let level = median(&values[start..end]);
        if (values[index] - level).abs() > FAR * noise {
            level
        } else {
            values[index]
        }
    };
    (0..values.len()).map(clean).collect()
}

/// The start index of every piece except the first, in ascending order.
fn partition(values: &[f64], noise: f64) -> Vec<usize> {
    let n = values.len();
    let penalty = 4.0 * libm::log(n as f64) + 6.0;
    // Prefix sums of the values and of their squares. Values are taken relative to the first one,
    // which keeps the sums small.
    let (mut sums, mut squares) = (vec![0.0; n + 1], vec![0.0; n + 1]);
    for (i, value) in values.iter().enumerate() {
        let value = (value - values[0]) / noise;
        sums[i + 1] = sums[i] + value;
        squares[i + 1] = squares[i] + value * value;
    }
    let cost = |start: usize, end: usize| {
        let sum: f64 = sums[end] - sums[start];
        squares[end] - squares[start] - sum * sum / (end - start) as f64
    };
    // For each prefix of the values: its least cost, and the start of its last piece.
    let mut best = vec![(f64::INFINITY, 0); n + 1];
    best[0] = (-penalty, 0);
    for end in SHORTEST..=n {
        for start in 0..=end - SHORTEST {
            let total = best[start].0 + penalty + cost(start, end);
            if total < best[end].0 {
                best[end] = (total, start);
            }
        }
    }
    let mut cuts = Vec::new();
    let mut index = best[n].1;
    while index > 0 {
        cuts.push(index);
        index = best[index].1;
    }
    cuts.reverse();
    cuts
}

/// The cuts, each moved to the position of least cost between its neighbours. A cut with fewer than
/// [`SHORTEST`] values on one side of that position is dropped: a few slow runs are no level.
fn confirmed(values: &[f64], cuts: &[usize]) -> Vec<usize> {
    let deviation = |values: &[f64]| {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        values
            .iter()
            .map(|value| (value - mean).powi(2))
            .sum::<f64>()
    };
    let mut found: Vec<usize> = Vec::new();
    for (i, _) in cuts.iter().enumerate() {
        let start = found.last().copied().unwrap_or(0);
        let end = cuts.get(i + 1).copied().unwrap_or(values.len());
        let both = |cut: usize| deviation(&values[start..cut]) + deviation(&values[cut..end]);
        let best = (start + 1..end).min_by(|&a, &b| both(a).total_cmp(&both(b)));
        let is_confirmed = |cut: &usize| cut - start >= SHORTEST && end - cut >= SHORTEST;
        found.extend(best.filter(is_confirmed));
    }
    found
}

fn median(values: &[f64]) -> f64 {
    geobench_harness::measure::statistics::median(values).unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use geobench_mesh::SplitMix64;

    use super::*;

    /// A uniform number between 0 and 1.
    fn uniform(random: &mut SplitMix64) -> f64 {
        (random.below(1 << 30) as f64 + 0.5) / f64::from(1 << 30)
    }

    fn normal(random: &mut SplitMix64) -> f64 {
        let (r, turn) = (uniform(random), uniform(random));
        (-2.0 * r.ln()).sqrt() * (std::f64::consts::TAU * turn).cos()
    }

    /// Laplace noise: its tails are as heavy as those of times on a busy machine.
    fn laplace(random: &mut SplitMix64) -> f64 {
        let u = uniform(random) - 0.5;
        -u.signum() * (1.0 - 2.0 * u.abs()).ln() / std::f64::consts::SQRT_2
    }

    /// Normal noise in which one commit in fifty is slower by ten standard deviations.
    fn spiky(random: &mut SplitMix64) -> f64 {
        let value = normal(random);
        value + if random.below(50) == 0 { 10.0 } else { 0.0 }
    }

    type Noise = fn(&mut SplitMix64) -> f64;

    /// 200 commits around 1 s with noise of 3 %.
    fn series(random: &mut SplitMix64, noise: Noise) -> Vec<f64> {
        (0..200).map(|_| (0.03 * noise(random)).exp()).collect()
    }

    /// The false-positive rate that justifies the penalty: the share of series without a change in
    /// which a change is found.
    #[test]
    fn two_hundred_commits_of_noise_hardly_ever_have_a_change() {
        let mut random = SplitMix64::new(5);
        for (name, noise, most) in [
            ("normal", normal as Noise, 0.01),
            ("laplace", laplace, 0.02),
            ("spiky", spiky, 0.03),
        ] {
            let trials = 400;
            let alarms = (0..trials)
                .filter(|_| !changes(&series(&mut random, noise), 0.02).is_empty())
                .count();
            let share = alarms as f64 / f64::from(trials);
            println!("{name}: {alarms} of {trials}");
            assert!(share <= most, "{name}: {share}");
        }
    }

    #[test]
    fn a_step_is_found_where_it_is() {
        let mut random = SplitMix64::new(7);
        let trials = 100;
        let mut near = 0;
        for _ in 0..trials {
            let mut values = series(&mut random, normal);
            let index = 3 + random.below(194);
            for value in &mut values[index..] {
                *value *= 1.2;
            }
            let found = changes(&values, 0.02);
            near += usize::from(found.len() == 1 && found[0].index.abs_diff(index) <= 1);
        }
        assert!(near >= 95, "{near}");
    }

    #[test]
    fn figures_without_noise_show_small_steps_at_once_confirmed() {
        let mut values = vec![1e9; 20];
        values[17..].fill(1.01e9);
        let found = changes(&values, 0.005);
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].index, found[0].before), (17, 1e9));
        assert!((found[0].ratio() - 1.01).abs() < 1e-12);
        // Two commits do not confirm a step. No earlier commit is reported in their place.
        values.fill(1e9);
        values[18..].fill(1.01e9);
        assert_eq!(changes(&values, 0.005), []);
        // A step up and a step down are two changes. A single slow commit is none.
        values.fill(1e9);
        values[8..12].fill(1.01e9);
        let places: Vec<usize> = changes(&values, 0.005).iter().map(|c| c.index).collect();
        assert_eq!(places, [8, 12]);
        values.fill(1e9);
        values[8] = 2e9;
        assert_eq!(changes(&values, 0.005), []);
    }

    #[test]
    fn short_series_and_series_with_a_zero_have_no_change() {
        assert_eq!(changes(&[], 0.02), []);
        assert_eq!(changes(&[1.0, 1.0, 1.0, 2.0, 2.0], 0.02), []);
        assert_eq!(changes(&[1.0, 1.0, 1.0, 0.0, 2.0, 2.0, 2.0], 0.02), []);
        let all = changes(&[1.0, 1.0, 1.0, 2.0, 2.0, 2.0], 0.02);
        assert_eq!(all.len(), 1);
    }
}
