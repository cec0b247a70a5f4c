//! Number of timed runs of a cell, and of solves in a run.

use std::str::FromStr;

use geobench_registry::UsageError;

use crate::measure::statistics;
use crate::schema::Precision;

/// Determines the number of timed runs of each cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sampling {
    /// This many runs, each of one solve.
    Fixed(usize),
    /// As many runs as the precision needs, from [`FEWEST`] to [`MOST`]. Short solves are timed in
    /// batches.
    UntilPrecise(Precision),
}

/// Minimum number of timed runs if the number is not fixed: the minimum for a confidence interval.
pub const FEWEST: usize = statistics::FEWEST_FOR_INTERVAL;

/// Maximum number of timed runs if the number is not fixed.
pub const MOST: usize = 100;

/// A batch takes at least this fraction (1/20) of the minimum time of a cell.
const SAMPLES_IN_LEAST_TIME: f64 = 20.0;

/// Maximum number of solves in a batch.
const MOST_SOLVES: f64 = 10_000.0;

impl Precision {
    /// The defaults.
    pub const USUAL: Self = Self {
        relative: 0.03,
        min_time: 0.2,
        max_time: 20.0,
    };
}

impl Sampling {
    /// Minimum number of timed runs of a cell that succeeds.
    pub const fn fewest(&self) -> usize {
        match self {
            Self::Fixed(runs) => *runs,
            Self::UntilPrecise(_) => FEWEST,
        }
    }

    /// Maximum number of timed runs of a cell.
    pub const fn most(&self) -> usize {
        match self {
            Self::Fixed(runs) => *runs,
            Self::UntilPrecise(_) => MOST,
        }
    }

    /// The greatest number of seconds that the timed runs of a cell take together if a run takes up
    /// to `run` seconds.
    pub fn longest(&self, run: f64) -> f64 {
        let runs = self.fewest() as f64 * run;
        match self {
            Self::Fixed(_) => runs,
            // Another run may start just before the end.
            Self::UntilPrecise(precision) => {
                runs.max(precision.max_time.max(precision.min_time) + run)
            }
        }
    }

    /// The requested precision; `None` if the number of runs is fixed.
    pub const fn precision(&self) -> Option<Precision> {
        match self {
            Self::Fixed(_) => None,
            Self::UntilPrecise(precision) => Some(*precision),
        }
    }

    /// Number of solves in a timed run of an algorithm whose warm-up took `seconds`; 1 if unknown.
    pub fn solves(&self, seconds: Option<f64>) -> usize {
        let (Self::UntilPrecise(precision), Some(seconds)) = (self, seconds) else {
            return 1;
        };
        let batch = precision.min_time / SAMPLES_IN_LEAST_TIME;
        if seconds >= batch {
            return 1;
        }
        // A time of 0 gives infinity, which the maximum bounds.
        let solves = (batch / seconds).ceil().min(MOST_SOLVES);
        #[expect(clippy::cast_sign_loss, reason = "it is from 1 to the limit")]
        {
            solves.max(1.0) as usize
        }
    }

    /// Whether a cell with these samples, which took `spent` seconds in total, needs no more.
    pub(crate) fn is_enough(&self, samples: &[f64], spent: f64) -> bool {
        let Self::UntilPrecise(precision) = self else {
            return samples.len() >= self.fewest();
        };
        if samples.len() < FEWEST {
            return false;
        }
        if samples.len() >= MOST || spent >= precision.max_time.max(precision.min_time) {
            return true;
        }
        spent >= precision.min_time
            && statistics::time(samples.to_vec(), None)
                .half_width()
                .is_some_and(|width| width <= precision.relative)
    }
}

/// A share such as `3%` or `0.03`, above 0 and at most 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share(pub f64);

impl FromStr for Share {
    type Err = UsageError;

    fn from_str(text: &str) -> Result<Self, UsageError> {
        let trimmed = text.trim();
        let value = match trimmed.strip_suffix('%') {
            Some(percent) => percent.trim().parse().map(|p: f64| p / 100.0),
            None => trimmed.parse(),
        };
        match value {
            Ok(value) if value > 0.0 && value <= 1.0 => Ok(Self(value)),
            _ => Err(UsageError(format!(
                "`{text}` is not a precision: give a share of the median above 0 and at most 1, such \
                 as 3% or 0.03"
            ))),
        }
    }
}

/// Seconds such as `0.2s`, `200ms` or `1m 30s`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seconds(pub f64);

impl FromStr for Seconds {
    type Err = UsageError;

    fn from_str(text: &str) -> Result<Self, UsageError> {
        let trimmed = text.trim();
        let number = trimmed.strip_suffix('s').unwrap_or(trimmed).trim();
        let seconds = number
            .parse()
            .ok()
            .or_else(|| Some(humantime::parse_duration(trimmed).ok()?.as_secs_f64()));
        match seconds {
            // The limit is one year.
            Some(seconds) if (0.0..=31_557_600.0).contains(&seconds) => Ok(Self(seconds)),
            _ => Err(UsageError(format!(
                "`{text}` is not a time; give one such as 0.2s, 200ms or 1m 30s"
            ))),
        }
    }
}

#[cfg(test)]
mod tests {
    use geobench_mesh::SplitMix64;

    use super::*;

    const USUAL: Sampling = Sampling::UntilPrecise(Precision::USUAL);

    #[test]
    fn a_fixed_number_of_runs_has_one_solve_each() {
        let fixed = Sampling::Fixed(3);
        assert_eq!((fixed.fewest(), fixed.most()), (3, 3));
        assert_eq!(fixed.solves(Some(1e-6)), 1);
        assert!(!fixed.is_enough(&[1.0; 2], 1e9) && fixed.is_enough(&[9.0, 1.0, 5.0], 0.0));
    }

    #[test]
    fn equal_samples_need_the_least_number_and_time() {
        assert!(!USUAL.is_enough(&[1.0; 5], 5.0));
        assert!(USUAL.is_enough(&[1.0; 6], 6.0));
        assert!(!USUAL.is_enough(&[0.01; 19], 0.19));
        assert!(USUAL.is_enough(&[0.01; 20], 0.2));
    }

    #[test]
    fn wide_samples_end_with_the_time_or_the_number() {
        let wide: Vec<f64> = (0..100).map(|i| 1.0 + f64::from(i % 10)).collect();
        assert!(!USUAL.is_enough(&wide[..7], 19.0));
        assert!(USUAL.is_enough(&wide[..7], 20.0));
        assert!(!USUAL.is_enough(&wide[..99], 1.0));
        assert!(USUAL.is_enough(&wide, 1.0));
        // The minimum number of runs is made even if it exceeds the maximum time.
        assert!(!USUAL.is_enough(&wide[..4], 1000.0));
    }

    #[test]
    fn short_solves_are_batched() {
        assert_eq!(USUAL.solves(None), 1);
        assert_eq!(USUAL.solves(Some(0.01)), 1);
        assert_eq!(USUAL.solves(Some(0.0095)), 2);
        assert_eq!(USUAL.solves(Some(0.0005)), 20);
        assert_eq!(USUAL.solves(Some(0.0)), 10_000);
    }

    /// Stopping at the first narrow interval prefers intervals that are narrow by chance. The
    /// coverage of the true median nevertheless stays close to that of a fixed number of samples.
    #[test]
    fn the_interval_still_holds_the_median_after_stopping() {
        let mut random = SplitMix64::new(11);
        let mut sample = || {
            // Triangular around 1, half-width 10 %.
            let uniform = |r: &mut SplitMix64| r.below(1 << 30) as f64 / f64::from(1 << 30);
            1.0 + 0.1 * (uniform(&mut random) - uniform(&mut random))
        };
        let (trials, mut held, mut taken) = (150, 0, 0);
        for _ in 0..trials {
            let mut samples: Vec<f64> = Vec::new();
            while !USUAL.is_enough(&samples, samples.iter().sum::<f64>().min(19.0)) {
                samples.push(sample());
            }
            taken += samples.len();
            let [low, high] = statistics::summarise(&samples).unwrap().ci95.unwrap();
            held += usize::from(low <= 1.0 && 1.0 <= high);
        }
        // Of 150 intervals, 85 % or more; about 92 % expected.
        assert!(held * 100 >= trials * 85, "{held} of {trials}");
        assert!((5..60).contains(&(taken / trials)), "{taken}");
    }

    #[test]
    fn precisions_and_times_are_read() {
        assert_eq!("3%".parse(), Ok(Share(0.03)));
        assert_eq!(" 0.5 % ".parse(), Ok(Share(0.005)));
        assert_eq!("0.03".parse(), Ok(Share(0.03)));
        for wrong in ["", "0", "-1%", "101%", "3", "nan", "%"] {
            assert!(wrong.parse::<Share>().is_err(), "{wrong}");
        }
        assert_eq!("0.2s".parse(), Ok(Seconds(0.2)));
        assert_eq!("0.2".parse(), Ok(Seconds(0.2)));
        assert_eq!("200ms".parse(), Ok(Seconds(0.2)));
        assert_eq!("1m 30s".parse(), Ok(Seconds(90.0)));
        for wrong in ["", "s", "-1s", "soon", "inf", "nan", "1e99"] {
            assert!(wrong.parse::<Seconds>().is_err(), "{wrong}");
        }
    }
}
