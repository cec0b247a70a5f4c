//! Observation of a run: none, or counts; [`phases`](crate::phases) samples its phases.
//!
//! Solvers are generic over a [`Probe`] and call it at every event. Timings are taken with `()`,
//! whose methods are empty and compile to nothing; counts and phases come from separate runs, so
//! that observing never disturbs a time.

use geobench_mesh::{HalfEdgeId, Mesh, VertexId};

use crate::counters::{Counter, Counters};
use crate::origins::Way;
use crate::wavefront::WavefrontSampler;

/// What a solver does at a moment, for [`Phases`](crate::Phases).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Computing child windows and apex distances.
    Propagation,
    /// Filters, trims and checks between windows.
    Pruning,
    /// Queues, lists, storage and everything else.
    Management,
}

/// Listens to a run.
///
/// ```
/// use geobench_window::{Count, Counter, Probe};
///
/// fn run(probe: &mut impl Probe) {
///     probe.add(Counter::Propagated, 2);
/// }
/// run(&mut ()); // Compiles to nothing.
/// let mut count = Count::default();
/// run(&mut count);
/// let counters = count.counters(&[Counter::Propagated]);
/// assert_eq!(counters.get(Counter::Propagated), Some(2));
/// ```
pub trait Probe {
    /// Whether counts are wanted: what serves counters only is kept in that case only.
    const COUNTS: bool = false;

    /// Whether the run may end before all distances are final.
    const STOPS: bool = false;

    /// Whether it is told where paths come from.
    const TRACES: bool = false;

    /// Whether it is told which vertices are reached, and from where.
    const EXPLORES: bool = false;

    /// Adds `n` to a counter.
    #[inline]
    fn add(&mut self, counter: Counter, n: u64) {
        let _ = (counter, n);
    }

    /// Raises a counter to `value` if it is less.
    #[inline]
    fn raise(&mut self, counter: Counter, value: u64) {
        let _ = (counter, value);
    }

    /// `parents` more windows were propagated; returns whether [`sample`](Probe::sample) should be
    /// called now.
    #[inline]
    fn wants_sample(&mut self, parents: u64) -> bool {
        let _ = parents;
        false
    }

    /// Takes a sample of the wavefront, given the least distance of every window on it.
    fn sample(&mut self, labels: impl Iterator<Item = f64>) {
        let _ = labels;
    }

    /// Time from now on belongs to `phase`.
    #[inline]
    fn enter(&mut self, phase: Phase) {
        let _ = phase;
    }

    /// Whether all that is wanted is final if nothing that waits leads to a path shorter than
    /// `bound`, given the distances known. Asked of a probe that [stops](Self::STOPS) runs.
    #[inline]
    fn is_reached(&mut self, bound: f64, distance: impl Fn(VertexId) -> f64) -> bool {
        let _ = (bound, distance);
        false
    }

    /// A path to `v` is the shortest so far; it crosses the face of `corner`, a half-edge that
    /// starts at `v`, last. In the numbers of the solver. Told to a probe that
    /// [traces](Self::TRACES) paths.
    #[inline]
    fn reach(&mut self, v: VertexId, corner: HalfEdgeId, way: Way) {
        let _ = (v, corner, way);
    }

    /// A path of length `d` to `v` is the shortest so far; it turns last at a vertex at distance
    /// `sigma`. Told to a probe that [explores](Self::EXPLORES), by solvers that take one window at
    /// a time.
    #[inline]
    fn improve(&mut self, v: VertexId, d: f64, sigma: f64) {
        let _ = (v, d, sigma);
    }

    /// The run has ended. The solver has the number `vertex(v)` for vertex `v` of `mesh`, and
    /// `corner(v, i)` for its outgoing half-edge at place `i`.
    fn renumber(
        &mut self,
        mesh: &Mesh,
        vertex: impl Fn(VertexId) -> VertexId,
        corner: impl Fn(VertexId, usize) -> HalfEdgeId,
    ) {
        let _ = (mesh, vertex, corner);
    }

    /// The run ends; nothing that waits leads to a path shorter than `bound`.
    #[inline]
    fn end(&mut self, bound: f64) {
        let _ = bound;
    }
}

/// Observes nothing, at no cost.
impl Probe for () {}

/// Samples of the wavefront that are handed out, if there are so many; less than twice as many are.
const SAMPLES: usize = 50;

/// Counts.
#[derive(Clone, Debug, Default)]
pub struct Count {
    values: [u64; Counter::ALL.len()],
    /// The K of the round that is under way, of a queue that works in rounds.
    k: Option<u64>,
    wavefront: WavefrontSampler,
}

impl Count {
    /// The counts of those counters that the algorithm has.
    pub fn counters(&self, has: &[Counter]) -> Counters {
        let mut counters = Counters::default();
        for &counter in has {
            counters.set(counter, self.values[counter as usize]);
        }
        counters.wavefront_deviation = self.wavefront.deviation();
        counters.wavefront = self.wavefront.course(SAMPLES);
        counters
    }
}

impl Probe for Count {
    const COUNTS: bool = true;

    #[inline]
    fn add(&mut self, counter: Counter, n: u64) {
        self.values[counter as usize] += n;
    }

    #[inline]
    fn raise(&mut self, counter: Counter, value: u64) {
        let count = &mut self.values[counter as usize];
        *count = value.max(*count);
        if counter == Counter::KPeak {
            self.k = Some(value);
        }
    }

    #[inline]
    fn wants_sample(&mut self, parents: u64) -> bool {
        self.wavefront.advance(parents)
    }

    fn sample(&mut self, labels: impl Iterator<Item = f64>) {
        self.wavefront.sample(labels, self.k);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn count_adds_and_raises() {
        let mut count = Count::default();
        count.add(Counter::Children, 2);
        count.add(Counter::Children, 3);
        count.raise(Counter::QueuePeak, 9);
        count.raise(Counter::QueuePeak, 4);
        count.sample([1.0].into_iter());
        for k in [30, 20] {
            count.raise(Counter::KPeak, k);
        }
        count.sample([2.0].into_iter());
        let counters = count.counters(&[Counter::Children, Counter::QueuePeak]);
        assert_eq!(counters.get(Counter::Children), Some(5));
        assert_eq!(counters.get(Counter::QueuePeak), Some(9));
        assert_eq!(counters.get(Counter::Kept), None);
        let ks: Vec<Option<u64>> = counters.wavefront.iter().map(|s| s.k).collect();
        assert_eq!(ks, [None, Some(20)]);
    }
}
