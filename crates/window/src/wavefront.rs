//! Samples of the wavefront over a run: the number of windows and the spread of their distances; at
//! chosen distances the windows themselves.

use geobench_mesh::VertexId;

use crate::window::Window;

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

/// A window that waits to be propagated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrontWindow {
    /// The ends of its half-edge: tail and head.
    pub ends: [VertexId; 2],
    /// Where its interval begins and ends: distances from the tail, in the units of the mesh.
    pub interval: [f64; 2],
    /// The least distance that it offers on its interval.
    pub distance: f64,
}

/// The windows of the wavefront at one moment of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct WavefrontMoment {
    /// The distance that was asked for.
    pub at: f64,
    /// Their number, mean distance and deviation.
    pub record: WavefrontRecord,
    /// The windows, in no particular order.
    pub windows: Vec<FrontWindow>,
}

/// The wavefronts of a run at chosen distances, for pictures like those of the papers (transfer
/// report of February 2016, figure 5.7; Xu et al. 2015, figures 3 and 11).
///
/// The wavefront is at distance d when the mean of the least distances of its windows is first seen
/// to be d or more. It is looked at often: whenever the run has propagated a thirty-second of its
/// windows. The run ends soon after the last distance; what is not final then is infinite.
///
/// ```
/// use geobench_ich::ich;
/// use geobench_mesh::Mesh;
/// use geobench_window::{Fronts, Goal, Observer, Solver};
///
/// let mesh = Mesh::generate("sphere,subdiv=3")?;
/// let mut fronts = Fronts::at([0.5, 1.0]);
/// ich(&mesh).run(&[0.into()], &Goal::everything(), Observer::Fronts(&mut fronts))?;
/// let [half, one] = fronts.found() else { panic!("the sphere is larger") };
/// assert!(half.record.distance >= 0.5 && one.record.distance >= 1.0);
/// assert!(half.windows.len() < one.windows.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fronts {
    /// The distances that are still to come, the next one last.
    wanted: Vec<f64>,
    found: Vec<WavefrontMoment>,
}

impl Fronts {
    /// Asks for the wavefront at each of these distances, in the units of the mesh.
    pub fn at(distances: impl IntoIterator<Item = f64>) -> Self {
        let mut wanted: Vec<f64> = distances.into_iter().collect();
        wanted.sort_by(|a, b| b.total_cmp(a));
        let found = Vec::new();
        Self { wanted, found }
    }

    /// Those that the run has come to, in the order of their distances. Algorithms without windows
    /// have none, nor do those that propagate on several threads.
    pub fn found(&self) -> &[WavefrontMoment] {
        &self.found
    }
}

/// The part of the windows of a wavefront that is propagated between two samples, if the run is
/// watched for [`Fronts`].
const WATCHED_PART: u64 = 32;

/// Takes samples at even intervals of propagated windows, for runs of any length.
#[derive(Clone, Debug)]
pub(crate) struct WavefrontSampler {
    samples: Vec<WavefrontRecord>,
    parents: u64,
    /// Windows propagated between two samples; `left` is the number until the next sample.
    interval: u64,
    left: u64,
    fronts: Fronts,
}

impl Default for WavefrontSampler {
    fn default() -> Self {
        Self {
            samples: Vec::with_capacity(CAPACITY),
            parents: 0,
            interval: 1,
            left: 1,
            fronts: Fronts::default(),
        }
    }
}

impl WavefrontSampler {
    /// One that also finds `fronts`.
    pub(crate) fn watching(fronts: Fronts) -> Self {
        Self {
            fronts,
            ..Self::default()
        }
    }

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
        self.left = if self.fronts.wanted.is_empty() {
            self.interval
        } else {
            (windows / WATCHED_PART).max(1)
        };
    }

    /// Whether the wavefront of the last sample is the next one that is wanted.
    #[inline]
    pub(crate) fn wants_windows(&self) -> bool {
        let next = self.fronts.wanted.last();
        next.is_some_and(|d| self.samples.last().is_some_and(|s| s.distance >= *d))
    }

    /// Takes the windows of the last sample, with the ends of their half-edges.
    pub(crate) fn take_windows(&mut self, waiting: impl Iterator<Item = ([VertexId; 2], Window)>) {
        let windows: Vec<FrontWindow> = waiting
            .map(|(ends, window)| FrontWindow {
                ends,
                interval: [window.b0, window.b1],
                distance: window.min_distance(),
            })
            .collect();
        while self.wants_windows()
            && let Some(at) = self.fronts.wanted.pop()
            && let Some(&record) = self.samples.last()
        {
            let windows = windows.clone();
            self.fronts.found.push(WavefrontMoment {
                at,
                record,
                windows,
            });
        }
    }

    /// The wavefronts found, with vertices as `mesh_vertex` numbers them.
    pub(crate) fn fronts(&self, mesh_vertex: impl Fn(VertexId) -> VertexId) -> Fronts {
        let mut fronts = self.fronts.clone();
        let windows = fronts.found.iter_mut().flat_map(|front| &mut front.windows);
        windows.for_each(|window| window.ends = window.ends.map(&mesh_vertex));
        fronts
    }

    /// Whether it has found wavefronts.
    pub(crate) fn has_fronts(&self) -> bool {
        !self.fronts.found.is_empty()
    }

    /// Whether it has found all wavefronts that were wanted.
    pub(crate) fn is_done(&self) -> bool {
        self.has_fronts() && self.fronts.wanted.is_empty()
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
