//! Observation of a run: nothing, counts (with pictures of the wavefront),
//! [phases](crate::phases) or origins of paths.
//!
//! Solvers are generic over a [`Probe`] and call it at every event. Timed runs use `()`, whose
//! methods are empty and compile to nothing. Counts and phases come from separate runs, so
//! observation never affects a time.

use geobench_mesh::{HalfEdgeId, Mesh, VertexId};

use crate::counters::{Counter, Counters};
use crate::origins::Way;
use crate::wavefront::{Fronts, WavefrontSampler};
use crate::window::Window;

/// The kind of work that a solver does, for [`Phases`](crate::Phases).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Computing child windows and apex distances.
    Propagation,
    /// Filters, trims and checks between windows.
    Pruning,
    /// Queues, lists, storage and everything else.
    Management,
}

/// Observes a run. All methods have empty defaults.
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
    /// Whether the probe counts. Solvers keep state that serves counters alone only if it does.
    const COUNTS: bool = false;

    /// Whether the run may end before all distances are final.
    const STOPS: bool = false;

    /// Whether the probe is told where paths come from, by [`reach`](Self::reach).
    const TRACES: bool = false;

    /// Whether the probe is told which vertices are reached, by [`improve`](Self::improve).
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

    /// Tells that `parents` more windows were propagated. Returns whether [`sample`](Probe::sample)
    /// should be called now.
    #[inline]
    fn wants_sample(&mut self, parents: u64) -> bool {
        let _ = parents;
        false
    }

    /// Takes a sample of the wavefront, given the least distance of every window on it.
    fn sample(&mut self, labels: impl Iterator<Item = f64>) {
        let _ = labels;
    }

    /// Whether [`take_windows`](Self::take_windows) should be called now, after a sample.
    #[inline]
    fn wants_windows(&self) -> bool {
        false
    }

    /// Takes all windows of the wavefront, each with the ends of its half-edge: tail and head, in
    /// the numbers of the solver.
    fn take_windows(&mut self, waiting: impl Iterator<Item = ([VertexId; 2], Window)>) {
        let _ = waiting;
    }

    /// Tells that `phase` begins.
    #[inline]
    fn enter(&mut self, phase: Phase) {
        let _ = phase;
    }

    /// Whether everything that the probe wants is final, if no path of less than `bound` is open.
    /// `distance` gives the known distances. Called for probes that [stop](Self::STOPS) runs.
    #[inline]
    fn is_reached(&mut self, bound: f64, distance: impl Fn(VertexId) -> f64) -> bool {
        let _ = (bound, distance);
        false
    }

    /// Tells that a path to `v` is the shortest so far. It crosses the face of `corner` last, a
    /// half-edge that starts at `v`. Both are in the numbers of the solver. Called for probes that
    /// [trace](Self::TRACES) paths.
    #[inline]
    fn reach(&mut self, v: VertexId, corner: HalfEdgeId, way: Way) {
        let _ = (v, corner, way);
    }

    /// Tells that a path of length `d` to `v` is the shortest so far, and that it turns last at a
    /// vertex at distance `sigma`. Called for probes that [explore](Self::EXPLORES), by solvers
    /// that take one window at a time.
    #[inline]
    fn improve(&mut self, v: VertexId, d: f64, sigma: f64) {
        let _ = (v, d, sigma);
    }

    /// Tells at the end of the run how the solver numbers `mesh`: vertex `v` has the number
    /// `vertex(v)`, and outgoing half-edge `i` of `v` the number `corner(v, i)`.
    fn renumber(
        &mut self,
        mesh: &Mesh,
        vertex: impl Fn(VertexId) -> VertexId,
        corner: impl Fn(VertexId, usize) -> HalfEdgeId,
    ) {
        let _ = (mesh, vertex, corner);
    }

    /// The bound of [`end`](Self::end); infinite if the run did not end early.
    fn open_bound(&self) -> f64 {
        f64::INFINITY
    }

    /// Tells that the run ends early, with no open path of less than `bound`.
    #[inline]
    fn end(&mut self, bound: f64) {
        let _ = bound;
    }
}

/// Observes nothing, at no cost.
impl Probe for () {}

/// Least number of wavefront samples to return if the run has so many. Fewer than twice as many are
/// returned.
const SAMPLES: usize = 50;

/// The probe that counts.
#[derive(Clone, Debug, Default)]
pub struct Count {
    values: [u64; Counter::ALL.len()],
    /// The K of the current round, for a queue that works in rounds.
    k: Option<u64>,
    wavefront: WavefrontSampler,
    /// The vertices of the mesh by their numbers in the solver, if these differ.
    mesh_vertices: Vec<VertexId>,
}

impl Count {
    /// One that also finds `fronts`.
    pub(crate) fn watching(fronts: Fronts) -> Self {
        Self {
            wavefront: WavefrontSampler::watching(fronts),
            ..Self::default()
        }
    }

    /// The wavefronts found.
    pub fn fronts(&self) -> Fronts {
        let vertices = &self.mesh_vertices;
        self.wavefront
            .fronts(|v| vertices.get(v.index()).copied().unwrap_or(v))
    }

    /// The counts of the counters in `has`, those that the algorithm keeps.
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

    /// Once all wavefronts that were wanted are found.
    #[inline]
    fn is_reached(&mut self, _: f64, _: impl Fn(VertexId) -> f64) -> bool {
        self.wavefront.is_done()
    }

    #[inline]
    fn wants_windows(&self) -> bool {
        self.wavefront.wants_windows()
    }

    fn take_windows(&mut self, waiting: impl Iterator<Item = ([VertexId; 2], Window)>) {
        self.wavefront.take_windows(waiting);
    }

    fn renumber(
        &mut self,
        mesh: &Mesh,
        vertex: impl Fn(VertexId) -> VertexId,
        _: impl Fn(VertexId, usize) -> HalfEdgeId,
    ) {
        if self.wavefront.has_fronts() {
            self.mesh_vertices = mesh.vertices().collect();
            for v in mesh.vertices() {
                self.mesh_vertices[vertex(v).index()] = v;
            }
        }
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
