//! Statistics of repeated times. All figures are robust; a mean never stands alone.
//!
//! * One set of samples: [`summarise`] gives median, deviation, interval and outliers.
//! * Two sets taken alternately: [`paired_ratio`] is unaffected by slow drift of the machine.
//! * Two independent sets: [`unpaired_ratio`] estimates the size of the difference,
//!   [`mann_whitney()`](super::mann_whitney::mann_whitney()) tests whether there is one.
//! * A function of several sets: [`interval_of`].
//!
//! Intervals of medians and of ratios are order statistics, which need neither random numbers nor a
//! distribution. Only [`interval_of`] resamples, by the percentile bootstrap of Efron (1979) with a
//! fixed seed.

use std::f64::consts::LN_2;

use geobench_mesh::SplitMix64;

use super::mann_whitney::{MOST_FOR_EXACT, arrangements};
use crate::schema::Time;

/// Minimum number of samples for a confidence interval. The least and the greatest of five samples
/// enclose the median in 93.75 % of cases only.
pub const FEWEST_FOR_INTERVAL: usize = 6;

/// Robust figures of a set of samples, in the unit of the samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Median; for an even number of samples the mean of the middle two.
    pub median: f64,
    /// Smallest sample.
    pub min: f64,
    /// Median absolute deviation from the median, unscaled.
    pub mad: f64,
    /// 95 % interval of the median of the samples, by order statistics.
    pub ci95: Option<[f64; 2]>,
    /// Number of [`outliers()`]. All other figures include them. `None` for fewer than
    /// [`FEWEST_FOR_INTERVAL`] samples.
    pub outliers: Option<usize>,
}

/// Summarises `samples`; `None` if there are none.
pub fn summarise(samples: &[f64]) -> Option<Summary> {
    let median = median(samples)?;
    let enough = samples.len() >= FEWEST_FOR_INTERVAL;
    Some(Summary {
        median,
        min: samples.iter().copied().fold(f64::INFINITY, f64::min),
        mad: deviation(samples, median)?,
        ci95: median_interval(samples),
        outliers: enough.then(|| outliers(samples).len()),
    })
}

/// The record of a cell's times: `samples` with their summary. Places and the fields of external
/// programs stay empty.
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
        ..Time::default()
    }
}

/// Tolerated relative difference between the clocks of a program and of the harness.
pub(crate) const CLOCKS: f64 = 0.01;

/// The record of the times of an external program with a protocol: for each run, the seconds that
/// it `claimed`, those from `outside`, and under protocol 2 those to answer a `ping`, which are
/// already subtracted from those from outside.
///
/// The claims are the times. Under protocol 2 they are doubted if they are below the times from
/// outside by more than the noise of these, which are then the times; but a run takes no less than
/// it claims, also where a slow ping leaves nothing of its time from outside. Under the other
/// protocols nothing confirms the claims.
pub fn time_of_program(
    claimed: Vec<f64>,
    outside: Vec<f64>,
    ping: Vec<f64>,
    setup: Option<f64>,
) -> Time {
    let doubted = are_doubted(&claimed, &outside, &ping);
    let samples = if doubted {
        let runs = claimed.iter().zip(&outside);
        runs.map(|(claimed, outside)| claimed.max(*outside))
            .collect()
    } else {
        claimed.clone()
    };
    let time = Time {
        doubted,
        unconfirmed: !doubted && are_unconfirmed(&claimed, &ping),
        ..time(samples, setup)
    };
    Time {
        outside,
        claimed,
        ping,
        ..time
    }
}

/// Whether the claims of a program under protocol 2 are below the times from outside by more than
/// their noise, in the median over the runs. The noise is the median ping of the run, for an answer
/// to `solve` is a little more work than an answer to `ping`, and the tolerance of the clocks.
fn are_doubted(claimed: &[f64], outside: &[f64], ping: &[f64]) -> bool {
    let runs = claimed.iter().zip(outside).zip(ping);
    let excess = runs.map(|((claimed, outside), ping)| {
        let noise = ping + CLOCKS * (outside + ping);
        outside - claimed - noise
    });
    median(&excess.collect::<Vec<f64>>()).is_some_and(|excess| excess > 0.0)
}

/// Pings that take longer, in seconds, hide a solve of their own length from the check of claims.
const SLOW_PING: f64 = 0.01;

/// Whether nothing confirms the claims of a program: its protocol has no pings, or its pings are so
/// slow that the noise is more than what it claims, in the median over the runs.
fn are_unconfirmed(claimed: &[f64], ping: &[f64]) -> bool {
    let excess = claimed.iter().zip(ping).map(|(claimed, ping)| {
        let noise = 2.0 * ping;
        if *ping > SLOW_PING {
            noise - claimed
        } else {
            -claimed
        }
    });
    ping.len() < claimed.len() || median(&excess.collect::<Vec<f64>>()).is_some_and(|e| e > 0.0)
}

/// The note that explains why there is no interval; `None` if there are enough `samples` for one.
pub(crate) fn too_few(samples: usize) -> Option<String> {
    (samples < FEWEST_FOR_INTERVAL)
        .then(|| format!("no confidence interval from fewer than {FEWEST_FOR_INTERVAL} samples"))
}

/// The minimum and the maximum of `values`; `None` if there are none.
pub fn range_of(values: impl IntoIterator<Item = f64>) -> Option<[f64; 2]> {
    let ends = values.into_iter().map(|value| [value; 2]);
    ends.reduce(|[least, most], [value, _]| [least.min(value), most.max(value)])
}

/// The median of unsorted `values`; `None` if there are none.
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

/// The 95 % confidence interval of the median of the distribution of `samples`; `None` for fewer
/// than [`FEWEST_FOR_INTERVAL`]. O(n log n).
///
/// The interval from the d-th least to the d-th greatest sample encloses the median with the
/// probability of d to n - d heads of n coins. Two neighbouring d have probabilities on either side
/// of 95 %; Hettmansperger and Sheather (1986, "Confidence intervals based on interpolated order
/// statistics", Statistics and Probability Letters 4, equation 1.2) interpolate between them.
pub(crate) fn median_interval(samples: &[f64]) -> Option<[f64; 2]> {
    let n = samples.len();
    if n < FEWEST_FOR_INTERVAL {
        return None;
    }
    let mut sorted = samples.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    // `inside` is the probability for d, `next` for d + 1; `coin` is the logarithm of that of
    // exactly d heads, which is below all numbers if there are thousands.
    let count = n as f64;
    let mut coin = -count * LN_2;
    let mut inside = 1.0 - 2.0 * libm::exp(coin);
    let mut d = 1;
    let next = loop {
        coin += libm::log((count - d as f64 + 1.0) / d as f64);
        let next = inside - 2.0 * libm::exp(coin);
        if next < CONFIDENCE {
            break next;
        }
        (inside, d) = (next, d + 1);
    };
    let share = (inside - CONFIDENCE) / (inside - next);
    let depth = d as f64;
    let inner = (count - depth) * share / (depth + (count - 2.0 * depth) * share);
    let between = |outer: f64, inside: f64| outer + inner * (inside - outer);
    Some([
        between(sorted[d - 1], sorted[d]),
        between(sorted[n - d], sorted[n - d - 1]),
    ])
}

/// The probability that an interval encloses its true value.
const CONFIDENCE: f64 = 0.95;

/// The median absolute deviation of `values` from `center`.
fn deviation(values: &[f64], center: f64) -> Option<f64> {
    let mut deviations: Vec<f64> = values.iter().map(|v| (v - center).abs()).collect();
    median_in_place(&mut deviations)
}

/// Minimum number of points of a fit.
pub const FEWEST_FOR_FIT: usize = 3;

/// The exponent e of the power law y = c x^e that fits `points` best, by least squares on
/// logarithms. `None` for fewer than [`FEWEST_FOR_FIT`] points, if all x are equal, or if a
/// coordinate is not positive.
pub fn exponent_of_growth(points: impl Iterator<Item = [f64; 2]>) -> Option<f64> {
    power_law(points).map(|[_, exponent]| exponent)
}

/// The factor c and the exponent e of the fit of [`exponent_of_growth`].
pub fn power_law(points: impl Iterator<Item = [f64; 2]>) -> Option<[f64; 2]> {
    let points: Vec<[f64; 2]> = points.map(|point| point.map(libm::log)).collect();
    let count = points.len();
    let mean = |axis: usize| points.iter().map(|p| p[axis]).sum::<f64>() / count as f64;
    let [mx, my] = [mean(0), mean(1)];
    let spread: f64 = points.iter().map(|[x, _]| (x - mx) * (x - mx)).sum();
    let shared: f64 = points.iter().map(|[x, y]| (x - mx) * (y - my)).sum();
    // Means of equal numbers round, so the spread of equal x need not be 0.
    let is_varied = points.iter().any(|[x, _]| *x != points[0][0]);
    let exponent = shared / spread;
    let factor = libm::exp(my - exponent * mx);
    let is_fit = count >= FEWEST_FOR_FIT && is_varied && exponent.is_finite();
    is_fit.then_some([factor, exponent])
}

/// Number of resamples of the bootstrap.
const RESAMPLES: usize = 1_000;

/// Seed of the bootstrap. It is fixed so that the same samples always give the same interval.
const SEED: u64 = 0x6765_6f62_656e_6368;

/// An input of a computed figure, with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Variable<'s> {
    /// An exact number.
    Exact(f64),
    /// The median of samples.
    Samples(&'s [f64]),
    /// An estimate with a normal error, such as a share found by sampling.
    Estimate {
        /// The estimate.
        value: f64,
        /// Its standard error.
        error: f64,
    },
}

impl Variable<'_> {
    /// Its value; `None` without samples.
    pub fn value(&self) -> Option<f64> {
        match *self {
            Self::Exact(value) | Self::Estimate { value, .. } => Some(value),
            Self::Samples(samples) => median(samples),
        }
    }

    /// A random draw of its value: the median of a resample, or a normal deviate.
    fn draw(&self, random: &mut SplitMix64, resample: &mut Vec<f64>) -> f64 {
        match *self {
            Self::Exact(value) => value,
            Self::Samples(samples) => {
                resample.clear();
                resample.extend(samples.iter().map(|_| samples[random.below(samples.len())]));
                median_in_place(resample).unwrap_or(f64::NAN)
            }
            Self::Estimate { value, error } => value + error * normal_deviate(random),
        }
    }
}

/// A random number of the standard normal distribution, by the transform of Box and Muller (1958).
fn normal_deviate(random: &mut SplitMix64) -> f64 {
    // The argument of the logarithm is positive.
    let radius = (-2.0 * libm::log(1.0 - random.unit())).sqrt();
    radius * libm::cos(std::f64::consts::TAU * random.unit())
}

/// The 2.5th and 97.5th percentiles of `figure`, a function of the values of `variables`. Samples
/// are drawn with replacement; no set of samples is empty. O(1,000 n log n).
fn bootstrap_interval(variables: &[Variable<'_>], figure: impl Fn(&[f64]) -> f64) -> [f64; 2] {
    let mut random = SplitMix64::new(SEED);
    let (mut resample, mut values) = (Vec::new(), Vec::new());
    let mut figures: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            values.clear();
            let draws = variables.iter();
            values.extend(draws.map(|variable| variable.draw(&mut random, &mut resample)));
            figure(&values)
        })
        .collect();
    figures.sort_unstable_by(f64::total_cmp);
    let tail = RESAMPLES / 40;
    [figures[tail], figures[RESAMPLES - 1 - tail]]
}

/// The modified z-score above which a sample is an outlier. It is ten times that of one standard
/// deviation of a normal distribution.
///
/// The usual threshold of 3.5 is too low for five samples. Their MAD is often small by chance. On a
/// quiet machine every fifth cell would have an outlier.
pub(crate) const OUTLIER_SCORE: f64 = 10.0;

/// Mean absolute deviation of the standard normal distribution, sqrt(2/π).
const NORMAL_MEAN_DEVIATION: f64 = 0.797_884_560_802_865_4;

/// Median absolute deviation of the standard normal distribution, its 75th percentile.
const NORMAL_MEDIAN_DEVIATION: f64 = 0.674_489_750_196_081_7;

/// The indices of the samples whose modified z-score (Iglewicz and Hoaglin 1993), 0.6745 |x -
/// median| / MAD, is above 10. If more than half of the samples are equal, the MAD
/// is 0, and the mean absolute deviation replaces it.
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

/// A ratio with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratio {
    /// The estimate.
    pub ratio: f64,
    /// 95 % interval; `None` for fewer than [`FEWEST_FOR_INTERVAL`] samples on a side.
    pub ci95: Option<[f64; 2]>,
}

/// The median of `over[i] / under[i]`, where the two samples with index i were taken next to each
/// other. Slow changes of the machine affect both and cancel out. The interval is that of the
/// median of the ratios.
///
/// `None` if the lengths differ, there are no samples, or a sample is not finite and positive.
pub fn paired_ratio(over: &[f64], under: &[f64]) -> Option<Ratio> {
    if over.len() != under.len() || !usable(over) || !usable(under) {
        return None;
    }
    let ratios: Vec<f64> = over.iter().zip(under).map(|(a, b)| a / b).collect();
    Some(Ratio {
        ratio: median(&ratios)?,
        ci95: median_interval(&ratios),
    })
}

/// The ratio of two independent sets of samples: the estimate of Hodges and Lehmann (1963) of the
/// shift of their logarithms, which is the median of the ratios of all pairs. Its interval inverts
/// the test of Mann and Whitney (Lehmann 1975, section 2.3): it holds the factors by which
/// `under` can be multiplied so that the test finds no difference. O(m n log(m n)).
///
/// `None` if a set is empty, or a sample is not finite and positive.
pub fn unpaired_ratio(over: &[f64], under: &[f64]) -> Option<Ratio> {
    if !usable(over) || !usable(under) {
        return None;
    }
    let pairs = over.iter().flat_map(|a| under.iter().map(move |b| a / b));
    let mut ratios: Vec<f64> = pairs.collect();
    let ratio = median_in_place(&mut ratios)?;
    let enough = over.len().min(under.len()) >= FEWEST_FOR_INTERVAL;
    Some(Ratio {
        ratio,
        ci95: enough.then(|| {
            let rank = rank_of_end(over.len(), under.len());
            [ratios[rank - 1], ratios[ratios.len() - rank]]
        }),
    })
}

/// The rank, from 1, of the ratio of a pair at which the 95 % interval begins, for sets of these
/// sizes: the greatest k so that U < k has a probability of at most 2.5 %.
fn rank_of_end(m: usize, n: usize) -> usize {
    let tail = (1.0 - CONFIDENCE) / 2.0;
    let rank = if m + n <= MOST_FOR_EXACT {
        let counts = arrangements(m, n);
        let most = tail * counts.iter().sum::<f64>();
        let sums = counts.iter().scan(0.0, |sum, count| {
            *sum += count;
            Some(*sum)
        });
        sums.take_while(|sum| *sum <= most).count()
    } else {
        let (m, n) = (m as f64, n as f64);
        let deviation = (m * n / 12.0 * (m + n + 1.0)).sqrt();
        // The conversion saturates at 0.
        #[expect(
            clippy::cast_sign_loss,
            reason = "sets of six or more have a positive bound"
        )]
        let rank = (m * n / 2.0 - NORMAL_975 * deviation) as usize;
        rank
    };
    rank.max(1)
}

/// The 97.5th percentile of the standard normal distribution.
const NORMAL_975: f64 = 1.959_963_984_540_054;

/// The 95 % interval of `figure`, a function of independent variables. One set of samples has the
/// interval of its median: `figure`, which is monotone, maps its ends. Several variables have that
/// of a bootstrap.
///
/// `None` if one of them has fewer than [`FEWEST_FOR_INTERVAL`] samples.
pub fn interval_of(variables: &[Variable<'_>], figure: impl Fn(&[f64]) -> f64) -> Option<[f64; 2]> {
    if let [Variable::Samples(samples)] = *variables {
        let [a, b] = median_interval(samples)?.map(|end| figure(&[end]));
        return Some([a.min(b), a.max(b)]);
    }
    let is_enough = |variable: &Variable<'_>| match variable {
        Variable::Samples(samples) => samples.len() >= FEWEST_FOR_INTERVAL,
        _ => true,
    };
    let enough = variables.iter().all(is_enough);
    enough.then(|| bootstrap_interval(variables, figure))
}

fn usable(samples: &[f64]) -> bool {
    !samples.is_empty() && samples.iter().all(|&x| x.is_finite() && x > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Claims within the noise of the time from outside are the times; lower ones are not.
    #[test]
    fn claims_are_checked_in_the_median_over_the_runs() {
        let ping = vec![2e-5; 3];
        let time = |claims: [f64; 3], outside: [f64; 3], ping: &[f64]| {
            time_of_program(claims.to_vec(), outside.to_vec(), ping.to_vec(), None)
        };
        let fast = time([1e-6; 3], [8e-6, 0.0, 1.5e-5], &ping);
        assert_eq!((fast.doubted, fast.median), (false, Some(1e-6)));
        // One late answer, by the load of the machine, is no lie.
        let loaded = time([0.1; 3], [0.1001, 0.15, 0.1002], &ping);
        assert_eq!((loaded.doubted, loaded.median), (false, Some(0.1)));
        let lie = time([0.012; 3], [0.1, 0.1001, 0.1002], &ping);
        assert_eq!((lie.doubted, lie.median), (true, Some(0.1001)));
        assert_eq!(lie.claimed, [0.012; 3]);
        // A slow ping leaves nothing of a time from outside; the claim is the least that it took.
        let late = time([0.012; 3], [0.1, 0.0, 0.1002], &ping);
        assert_eq!(
            (late.doubted, late.samples),
            (true, vec![0.1, 0.012, 0.1002])
        );
        // Without pings, nothing confirms a claim.
        let alone = time([0.012; 3], [0.1; 3], &[]);
        assert_eq!((alone.doubted, alone.unconfirmed), (false, true));
        assert_eq!(alone.median, Some(0.012));
        assert!(!lie.unconfirmed && !fast.unconfirmed);
        // Slow pings would hide the whole solve.
        let hidden = time([1e-6; 3], [0.0; 3], &[0.2; 3]);
        assert_eq!((hidden.doubted, hidden.unconfirmed), (false, true));
        let long = time([30.0; 3], [30.1; 3], &[0.2; 3]);
        assert_eq!((long.doubted, long.unconfirmed), (false, false));
    }

    #[test]
    fn odd_even_and_no_samples() {
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&[4.0, 1.0, 3.0, 2.0]), Some(2.5));
        assert_eq!(summarise(&[]), None);
    }

    #[test]
    fn an_outlier_moves_neither_median_nor_deviation() {
        let summary = summarise(&[1.0, 1.1, 0.9, 1.0, 1.0, 0.9, 50.0]).unwrap();
        assert_eq!(summary.median, 1.0);
        assert_eq!(summary.min, 0.9);
        assert!((summary.mad - 0.1).abs() < 1e-12);
        assert_eq!(summary.outliers, Some(1));
    }

    #[test]
    fn the_interval_of_a_function_of_medians() {
        let over: Vec<f64> = (0..9).map(|i| 2.0 + f64::from(i) / 10.0).collect();
        let under = [1.0, 1.1, 0.9, 1.05, 0.95, 1.0];
        let ratio = |x: &[f64]| x[0] / x[1];
        let [over, under] = [&over[..], &under[..]].map(Variable::Samples);
        let [low, high] = interval_of(&[over, under], ratio).unwrap();
        assert!(
            (1.9..2.4).contains(&low) && (2.4..2.9).contains(&high),
            "{low} {high}"
        );
        let exact = [3.0, 2.0].map(Variable::Exact);
        assert_eq!(interval_of(&exact, ratio), Some([1.5, 1.5]));
        assert_eq!(
            interval_of(&[over, Variable::Samples(&[1.0, 2.0])], ratio),
            None
        );
        assert_eq!(interval_of(&[over, Variable::Samples(&[])], ratio), None);
    }

    #[test]
    fn one_set_of_samples_has_the_interval_of_its_median() {
        let samples = [1.0, 1.3, 1.1, 1.2, 0.9, 4.0];
        let [low, high] = median_interval(&samples).unwrap();
        let of = |figure: fn(&[f64]) -> f64| interval_of(&[Variable::Samples(&samples)], figure);
        assert_eq!(of(|x| x[0]), Some([low, high]));
        assert_eq!(of(|x| 1.0 - x[0]), Some([1.0 - high, 1.0 - low]));
        assert_eq!(
            interval_of(&[Variable::Samples(&samples[..5])], |x| x[0]),
            None
        );
    }

    #[test]
    fn an_estimate_varies_by_its_standard_error() {
        let share = Variable::Estimate {
            value: 0.4,
            error: 0.01,
        };
        let [low, high] = interval_of(&[share], |x| x[0]).unwrap();
        // ±1.96 standard errors.
        assert!(
            (low - 0.3804).abs() < 1e-3 && (high - 0.4196).abs() < 1e-3,
            "{low} {high}"
        );
    }

    #[test]
    fn fewer_than_six_samples_have_no_interval() {
        let few = summarise(&[1.0, 2.0, 3.0, 4.0, 5.0]).unwrap();
        assert_eq!((few.ci95, few.outliers), (None, None));
        assert!(too_few(5).unwrap().contains("fewer than 6"));
        let enough = summarise(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).unwrap();
        assert!(enough.ci95.is_some() && too_few(6).is_none());
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
        let samples = [Variable::Samples(&[0.3, 0.1, 0.9, 0.4, 0.7, 0.2]); 2];
        let product = |x: &[f64]| x[0] * x[1];
        assert_eq!(
            interval_of(&samples, product),
            interval_of(&samples, product)
        );
    }

    /// Ends computed by hand from equation 1.2 of Hettmansperger and Sheather. For six samples,
    /// d = 1: 31/32 and 25/32, so I = 0.1 and the ends are 5 I / (1 + 4 I) = 5/14 from the least.
    #[test]
    fn ends_lie_between_order_statistics() {
        let [low, high] = median_interval(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).unwrap();
        close(low, 1.0 + 5.0 / 14.0);
        close(high, 6.0 - 5.0 / 14.0);
        let many: Vec<f64> = (0..2_000).map(f64::from).collect();
        let [low, high] = median_interval(&many).unwrap();
        // 1.96 sqrt(n) / 2 = 43.8 ranks on either side of 999.5.
        assert!(
            (low - 955.7).abs() < 1.0 && (high - 1043.3).abs() < 1.0,
            "{low} {high}"
        );
    }

    /// Shares of 4,000 simulated cells whose interval encloses the truth, in noise as it is seen: a
    /// normal machine, times with a long tail, and a machine that is 10 % slower in every third
    /// run. `docs/methodology.md` has a table of such shares.
    #[test]
    fn intervals_enclose_the_truth_as_often_as_they_say() {
        type Noise = fn(&mut SplitMix64) -> f64;
        let kinds: [(&str, Noise, f64); 3] = [
            ("normal", |r| 1.0 + 0.02 * normal_deviate(r), 1.0),
            (
                "long tail",
                |r| 1.0 - 0.02 * libm::log(1.0 - r.unit()),
                1.0 + 0.02 * LN_2,
            ),
            (
                "two speeds",
                |r| if r.below(3) == 0 { 1.1 } else { 1.0 } * (1.0 + 0.01 * normal_deviate(r)),
                1.006_745,
            ),
        ];
        let cells = 4_000;
        for (name, noise, truth) in kinds {
            for n in [6_u32, 7, 10, 20] {
                let mut random = SplitMix64::new(u64::from(n));
                let encloses = |ends: [f64; 2], truth: f64| ends[0] <= truth && truth <= ends[1];
                let (mut medians, mut pairs, mut sets) = (0, 0, 0);
                for _ in 0..cells {
                    let mut draw = || (0..n).map(|_| noise(&mut random)).collect::<Vec<f64>>();
                    let (over, under) = (draw(), draw());
                    medians += usize::from(encloses(median_interval(&over).unwrap(), truth));
                    let ends = |ratio: Option<Ratio>| ratio.unwrap().ci95.unwrap();
                    pairs += usize::from(encloses(ends(paired_ratio(&over, &under)), 1.0));
                    sets += usize::from(encloses(ends(unpaired_ratio(&over, &under)), 1.0));
                }
                let shares = [medians, pairs, sets].map(|hits| hits as f64 / f64::from(cells));
                println!("{name}, {n}: {shares:.3?}");
                // Three standard errors of 0.95 are 0.010.
                assert!(
                    shares.iter().all(|share| (0.925..=0.985).contains(share)),
                    "{name} {n}: {shares:?}"
                );
            }
        }
    }

    #[test]
    fn outliers_on_both_sides_are_found() {
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
        // Of nine samples, one has at least a ninth of the total deviation, so its score stays low.
        assert!(outliers(&samples[..9]).is_empty());
    }

    /// Verifies the claim in the documentation of `OUTLIER_SCORE`.
    #[test]
    fn a_quiet_machine_has_few_outliers() {
        let mut random = geobench_mesh::SplitMix64::new(3);
        let mut share = |n: usize| {
            let cells = 20_000;
            let hit = (0..cells)
                .filter(|_| {
                    let samples: Vec<f64> = (0..n).map(|_| normal_deviate(&mut random)).collect();
                    !outliers(&samples).is_empty()
                })
                .count();
            hit as f64 / f64::from(cells)
        };
        let (five, twenty) = (share(5), share(20));
        assert!(five < 0.05 && twenty < 0.001, "{five} {twenty}");
    }

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

        let unpaired = unpaired_ratio(&over, &under).unwrap();
        assert!((unpaired.ratio - 1.2).abs() < 1e-12);
        let [low, high] = unpaired.ci95.unwrap();
        assert!(low < 0.9 && high > 1.5, "{low} {high}");
    }

    #[test]
    fn too_few_samples_have_a_ratio_and_no_interval() {
        let ratio = paired_ratio(&[3.0, 3.0], &[2.0, 2.0]).unwrap();
        assert_eq!((ratio.ratio, ratio.ci95), (1.5, None));
        let ratio = unpaired_ratio(&[3.0; 9], &[2.0; 4]).unwrap();
        assert_eq!((ratio.ratio, ratio.ci95), (1.5, None));
    }

    #[test]
    fn unusable_samples_have_no_ratio() {
        assert_eq!(paired_ratio(&[], &[]), None);
        assert_eq!(paired_ratio(&[1.0], &[1.0, 2.0]), None);
        assert_eq!(paired_ratio(&[1.0], &[0.0]), None);
        assert_eq!(unpaired_ratio(&[1.0], &[]), None);
        assert_eq!(unpaired_ratio(&[f64::NAN], &[1.0]), None);
    }

    fn close(found: f64, published: f64) {
        assert!((found - published).abs() < 1e-12, "{found} {published}");
    }

    #[test]
    fn the_exponent_of_a_power_is_found_and_of_nothing_is_none() {
        let power = |e: f64| [2e3, 1e4, 5e4, 3e5].map(|x: f64| [x, 7e-8 * x.powf(e)]);
        for e in [1.0, 1.37, 2.0, -0.5] {
            let found = exponent_of_growth(power(e).into_iter()).unwrap();
            assert!((found - e).abs() < 1e-12, "{found} is not {e}");
        }
        assert_eq!(exponent_of_growth(power(1.0).into_iter().take(2)), None);
        assert_eq!(exponent_of_growth([[1e4, 2.0]; 5].into_iter()), None);
        assert_eq!(
            exponent_of_growth([[1e4, 2.0], [2e4, 0.0], [4e4, 1.0]].into_iter()),
            None
        );
    }
}
