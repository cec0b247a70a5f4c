//! Comparing times.

use serde::Serialize;

use super::percent;
use crate::measure::statistics::{mann_whitney, paired_ratio, unpaired_ratio};
use crate::schema::Time;

/// How times are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TimeMethod {
    /// Sample by sample, which were taken next to each other.
    Paired,
    /// All with all.
    Unpaired,
}

/// The times of a cell in two files.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TimeChange {
    /// How they were compared.
    pub method: TimeMethod,
    /// Medians of the old and the new times, in seconds.
    pub medians: [f64; 2],
    /// Numbers of old and new samples.
    pub samples: [usize; 2],
    /// New to old: the median of the ratios of pairs, or the ratio of the medians.
    pub ratio: f64,
    /// 95 % interval of the ratio; null from fewer than five samples.
    pub ci95: Option<[f64; 2]>,
    /// The probability of Mann and Whitney that times so different come from the same
    /// distribution; null for pairs.
    pub p: Option<f64>,
}

impl TimeChange {
    /// How `new` compares with `old`; none if one of them has no samples, or one of 0.
    pub(super) fn between(old: &Time, new: &Time, paired: bool) -> Option<Self> {
        let pairs = paired_ratio(&new.samples, &old.samples).filter(|_| paired);
        let (method, ratio) = match pairs {
            Some(ratio) => (TimeMethod::Paired, ratio),
            None => (
                TimeMethod::Unpaired,
                unpaired_ratio(&new.samples, &old.samples)?,
            ),
        };
        Some(Self {
            method,
            medians: [old.median?, new.median?],
            samples: [old.samples.len(), new.samples.len()],
            ratio: ratio.ratio,
            ci95: ratio.ci95,
            p: mann_whitney(&new.samples, &old.samples)
                .filter(|_| method == TimeMethod::Unpaired)
                .map(|test| test.p),
        })
    }

    /// Whether it has certainly grown by more than `limit`, a share of the old time.
    pub fn is_above(&self, limit: f64) -> bool {
        self.ci95.is_some_and(|[low, _]| low > 1.0 + limit)
    }

    /// The change with its interval, such as `+3.00 % (+1.0 to +5.0)`.
    pub fn in_words(&self) -> String {
        let change = percent(self.ratio);
        if let Some(ends) = self.ci95 {
            let [low, high] = ends.map(|ratio| 100.0 * (ratio - 1.0));
            format!("{change} ({low:+.1} to {high:+.1})")
        } else {
            let samples = self.samples[0].min(self.samples[1]);
            format!("{change} (of {samples}: no interval)")
        }
    }
}
