//! Samples of the wavefront over a run: the number of windows and the spread of their distances.

/// Most samples stored. When they are reached, every second one is dropped.
const CAPACITY: usize = 512;

/// The wavefront at one moment of a run. Distances are the least distances of its windows, in the
/// units of the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WavefrontRecord {
    /// Windows propagated so far.
    pub parents: u64,
    /// Windows that wait to be propagated, at least one; never more than
    /// [`PeakWavefront`](crate::Counter::PeakWavefront) of the run.
    pub windows: u64,
    /// Mean of their distances.
    pub distance: f64,
    /// Standard deviation of their distances. The smaller it is, the closer the run is to the order
    /// of distances (Xu et al. 2015, section 6; transfer report of February 2016, section 5.5.2).
    pub deviation: f64,
    /// The number of windows that the current round was to take, for a queue that works in rounds.
    pub k: Option<u64>,
}

/// Takes samples at even intervals of propagated windows, for runs of any length.
#[derive(Clone, Debug)]
pub(crate) struct WavefrontSampler {
    samples: Vec<WavefrontRecord>,
    parents: u64,
    /// Windows propagated between two samples; `left` is the number until the next sample.
    interval: u64,
    left: u64,
}

impl Default for WavefrontSampler {
    fn default() -> Self {
        Self {
            samples: Vec::with_capacity(CAPACITY),
            parents: 0,
            interval: 1,
            left: 1,
        }
    }
}

impl WavefrontSampler {
    /// Adds `parents` propagated windows; returns whether a sample is due.
    #[inline]
    pub(crate) fn advance(&mut self, parents: u64) -> bool {
        self.parents += parents;
        self.left = self.left.saturating_sub(parents);
        self.left == 0
    }

    /// Takes a sample of the wavefront: the least distances of its windows, and the K of the round.
    pub(crate) fn sample(&mut self, labels: impl Iterator<Item = f64>, k: Option<u64>) {
        // Welford's recurrence: one pass, and no cancellation far from the source.
        let (mut windows, mut mean, mut squares) = (0, 0.0, 0.0);
        for label in labels {
            windows += 1;
            let delta: f64 = label - mean;
            mean += delta / windows as f64;
            squares += delta * (label - mean);
        }
        if windows > 0 {
            self.samples.push(WavefrontRecord {
                parents: self.parents,
                windows,
                distance: mean,
                deviation: f64::sqrt(squares / windows as f64),
                k,
            });
        }
        if self.samples.len() == CAPACITY {
            let mut even = false;
            self.samples.retain(|_| {
                even = !even;
                even
            });
            self.interval *= 2;
        }
        self.left = self.interval;
    }

    /// Mean of the deviations; `None` if there is no sample.
    pub(crate) fn deviation(&self) -> Option<f64> {
        let n = self.samples.len();
        (n > 0).then(|| self.samples.iter().map(|s| s.deviation).sum::<f64>() / n as f64)
    }

    /// The samples in the order of the run: fewer than twice `wanted`, and at least `wanted` if
    /// there are so many. `wanted` must not be 0.
    pub(crate) fn course(&self, wanted: usize) -> Vec<WavefrontRecord> {
        let step = (self.samples.len() / wanted).max(1);
        self.samples.iter().copied().step_by(step).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviation_of_known_labels() {
        let mut wavefront = WavefrontSampler::default();
        assert_eq!(wavefront.deviation(), None);
        wavefront.advance(7);
        wavefront.sample([2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0].into_iter(), None);
        assert_eq!(wavefront.deviation(), Some(2.0));
        wavefront.sample([1.0].into_iter(), Some(3));
        assert_eq!(wavefront.deviation(), Some(1.0));
        // Without windows there is no wavefront to sample.
        wavefront.sample([].into_iter(), Some(3));
        let first = WavefrontRecord {
            parents: 7,
            windows: 8,
            distance: 5.0,
            deviation: 2.0,
            k: None,
        };
        let second = WavefrontRecord {
            windows: 1,
            distance: 1.0,
            deviation: 0.0,
            k: Some(3),
            ..first
        };
        assert_eq!(wavefront.course(10), [first, second]);
        assert_eq!(wavefront.course(1), [first]);
    }

    #[test]
    fn samples_stay_few_and_even() {
        let mut wavefront = WavefrontSampler::default();
        let mut taken = 0;
        for _ in 0..100_000 {
            if wavefront.advance(1) {
                wavefront.sample([1.0, 3.0].into_iter(), None);
                taken += 1;
            }
        }
        assert!(wavefront.samples.len() < CAPACITY);
        assert!((CAPACITY..20 * CAPACITY).contains(&taken), "{taken}");
        assert_eq!(wavefront.deviation(), Some(1.0));
        let course = wavefront.course(50);
        assert!((50..100).contains(&course.len()), "{}", course.len());
        let gaps = course.windows(2).map(|w| w[1].parents - w[0].parents);
        let (least, most) = gaps.fold((u64::MAX, 0), |(a, b), gap| (a.min(gap), b.max(gap)));
        // After every second sample was dropped, the next one is due a little later.
        assert!(most - least <= least / 10, "{least} to {most}");
    }
}
