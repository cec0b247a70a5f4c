//! How far apart the windows of a wavefront are, sampled over a run.

/// Most samples kept; when they are reached every second one is dropped.
const CAPACITY: usize = 512;

/// Samples of the standard deviation of the windows' least distances on the wavefront, at even
/// intervals of propagated windows however many these will be (Xu et al. 2015, section 7.2; the
/// less they differ, the better the wavefront keeps the order of the distances).
#[derive(Clone, Debug)]
pub(crate) struct Wavefront {
    deviations: Vec<f64>,
    /// Windows propagated from one sample to the next, and those left until the next one.
    interval: u64,
    left: u64,
}

impl Default for Wavefront {
    fn default() -> Self {
        Self {
            deviations: Vec::with_capacity(CAPACITY),
            interval: 1,
            left: 1,
        }
    }
}

impl Wavefront {
    /// `parents` more windows were propagated; returns whether a sample is due.
    #[inline]
    pub(crate) fn advance(&mut self, parents: u64) -> bool {
        self.left = self.left.saturating_sub(parents);
        self.left == 0
    }

    /// Takes a sample of the wavefront whose windows have these least distances.
    pub(crate) fn sample(&mut self, labels: impl Iterator<Item = f64>) {
        // Welford's recurrence: one pass, and no cancellation far from the source.
        let (mut count, mut mean, mut squares) = (0.0, 0.0, 0.0);
        for label in labels {
            count += 1.0;
            let delta: f64 = label - mean;
            mean += delta / count;
            squares += delta * (label - mean);
        }
        if count > 0.0 {
            self.deviations.push(f64::sqrt(squares / count));
        }
        if self.deviations.len() == CAPACITY {
            let mut even = false;
            self.deviations.retain(|_| {
                even = !even;
                even
            });
            self.interval *= 2;
        }
        self.left = self.interval;
    }

    /// Mean of the samples; `None` if there is none.
    pub(crate) fn deviation(&self) -> Option<f64> {
        let n = self.deviations.len();
        (n > 0).then(|| self.deviations.iter().sum::<f64>() / n as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviation_of_known_labels() {
        let mut wavefront = Wavefront::default();
        assert_eq!(wavefront.deviation(), None);
        wavefront.sample([2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0].into_iter());
        assert_eq!(wavefront.deviation(), Some(2.0));
        wavefront.sample([1.0].into_iter());
        assert_eq!(wavefront.deviation(), Some(1.0));
    }

    #[test]
    fn samples_stay_few_and_even() {
        let mut wavefront = Wavefront::default();
        let mut taken = 0;
        for _ in 0..100_000 {
            if wavefront.advance(1) {
                wavefront.sample([1.0, 3.0].into_iter());
                taken += 1;
            }
        }
        assert!(wavefront.deviations.len() < CAPACITY);
        assert!((CAPACITY..20 * CAPACITY).contains(&taken), "{taken}");
        assert_eq!(wavefront.deviation(), Some(1.0));
    }
}
