//! Goals of runs: which distances are asked for, and when a run may end early.

use std::borrow::Cow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use geobench_mesh::{HalfEdgeId, Mesh, VertexId};

use crate::counters::Counter;
use crate::origins::Way;
use crate::probe::{Phase, Probe};
use crate::solver::Solution;
use crate::window::Window;

/// By how much the bound of all that waits must exceed a distance, relatively, for the distance to
/// be final. It is far more than the rounding that the labels of windows gather.
const MARGIN: f64 = 1e-9;

/// The distances that a run is to find: those of some vertices, those up to a radius, or all.
///
/// A run with a goal ends as soon as these distances are *final*: nothing that still waits can lead
/// to a shorter path. With both targets and a radius, only targets within the radius are asked for.
///
/// ```
/// use geobench_window::Goal;
///
/// let near = Goal::targets([3, 17]).within(2.5);
/// assert_eq!(near.radius(), 2.5);
/// assert!(Goal::everything().radius().is_infinite());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Goal {
    targets: Option<Vec<VertexId>>,
    radius: f64,
    stop: Option<Stop>,
}

/// A flag that ends runs early, from any thread. Clones share one flag.
///
/// ```
/// use geobench_window::{Goal, Stop};
///
/// let stop = Stop::default();
/// let goal = Goal::everything().unless(&stop);
/// stop.set(); // A run with this goal ends soon.
/// assert!(stop.is_set() && !goal.is_everything());
/// ```
#[derive(Clone, Debug, Default)]
pub struct Stop(Arc<AtomicBool>);

impl Stop {
    /// Ends all runs with this flag, present and future.
    pub fn set(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether [`set`](Self::set) has been called.
    #[inline]
    pub fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Whether both are one flag.
impl PartialEq for Stop {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Goal {
    /// Every distance; the run goes to its end.
    pub const fn everything() -> Self {
        Self {
            targets: None,
            radius: f64::INFINITY,
            stop: None,
        }
    }

    /// The distances of these vertices. With an empty list no distance is asked for.
    pub fn targets(targets: impl IntoIterator<Item = impl Into<VertexId>>) -> Self {
        Self {
            targets: Some(targets.into_iter().map(Into::into).collect()),
            ..Self::everything()
        }
    }

    /// The distances up to `radius` only, in the units of the mesh. NaN means no limit.
    #[must_use]
    pub fn within(self, radius: f64) -> Self {
        Self { radius, ..self }
    }

    /// The same goal, but a run ends early once `stop` is set. Distances that are not final then
    /// are infinite.
    #[must_use]
    pub fn unless(self, stop: &Stop) -> Self {
        let stop = Some(stop.clone());
        Self { stop, ..self }
    }

    /// The targets; `None` if all vertices are asked for.
    pub fn vertices(&self) -> Option<&[VertexId]> {
        self.targets.as_deref()
    }

    /// The largest distance asked for.
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    /// Whether the goal has no targets, no radius and no stop flag.
    pub fn is_everything(&self) -> bool {
        self.targets.is_none()
            && self.stop.is_none()
            && (self.radius.is_nan() || self.radius == f64::INFINITY)
    }

    /// The same goal, whose targets are no copies: the vertices of `mesh` that stand for them.
    pub(crate) fn on(&self, mesh: &Mesh) -> Cow<'_, Self> {
        let is_copy = |&v: &VertexId| mesh.is_copy(v);
        if !self.vertices().is_some_and(|all| all.iter().any(is_copy)) {
            return Cow::Borrowed(self);
        }
        let mut kept = self.clone();
        for target in kept.targets.iter_mut().flatten() {
            *target = mesh.kept_vertex(*target);
        }
        Cow::Owned(kept)
    }

    /// Makes the distances beyond the radius infinite, after a run that could not end early.
    pub fn limit(&self, solution: &mut Solution) {
        for d in &mut solution.distances {
            if *d > self.radius {
                *d = f64::INFINITY;
            }
        }
    }

    /// Runs `run` with `probe`, until this goal is reached, and makes infinite what is not final
    /// then. Returns what the run and the probe have found.
    pub(crate) fn bound<'g, P>(
        &'g self,
        probe: P,
        run: impl FnOnce(&mut Until<'g, P>) -> Solution,
    ) -> (Solution, P) {
        let mut until = Until::new(probe, self);
        let mut solution = run(&mut until);
        until.cut(&mut solution);
        (solution, until.probe)
    }
}

/// Wraps `probe` so that the run ends once `goal` is reached.
#[derive(Clone, Debug)]
pub(crate) struct Until<'g, P> {
    pub(crate) probe: P,
    goal: &'g Goal,
    /// The target that was not final at the last check; it is checked first.
    open: usize,
    /// No path that was still open when the run ended is shorter than this.
    bound: f64,
}

impl<'g, P> Until<'g, P> {
    pub(crate) fn new(probe: P, goal: &'g Goal) -> Self {
        Self {
            probe,
            goal,
            open: 0,
            bound: f64::INFINITY,
        }
    }

    /// Makes distances infinite that are not final or exceed the radius.
    pub(crate) fn cut(&self, solution: &mut Solution) {
        for d in &mut solution.distances {
            if !is_below(*d, self.bound) || *d > self.goal.radius {
                *d = f64::INFINITY;
            }
        }
    }
}

/// Whether `d` is final, when no path of less than `bound` is still open.
#[inline]
fn is_below(d: f64, bound: f64) -> bool {
    d < bound * (1.0 - MARGIN)
}

impl<P: Probe> Probe for Until<'_, P> {
    const COUNTS: bool = P::COUNTS;
    const STOPS: bool = true;
    const TRACES: bool = P::TRACES;

    #[inline]
    fn add(&mut self, counter: Counter, n: u64) {
        self.probe.add(counter, n);
    }

    #[inline]
    fn raise(&mut self, counter: Counter, value: u64) {
        self.probe.raise(counter, value);
    }

    #[inline]
    fn wants_sample(&mut self, parents: u64) -> bool {
        self.probe.wants_sample(parents)
    }

    fn sample(&mut self, labels: impl Iterator<Item = f64>) {
        self.probe.sample(labels);
    }

    #[inline]
    fn wants_windows(&self) -> bool {
        self.probe.wants_windows()
    }

    fn take_windows(&mut self, waiting: impl Iterator<Item = ([VertexId; 2], Window)>) {
        self.probe.take_windows(waiting);
    }

    #[inline]
    fn enter(&mut self, phase: Phase) {
        self.probe.enter(phase);
    }

    #[inline]
    fn is_reached(&mut self, bound: f64, distance: impl Fn(VertexId) -> f64) -> bool {
        let is_stopped = self.goal.stop.as_ref().is_some_and(Stop::is_set);
        if is_stopped
            || is_below(self.goal.radius, bound)
            || self.probe.is_reached(bound, &distance)
        {
            return true;
        }
        let Some(targets) = &self.goal.targets else {
            return false;
        };
        let is_open = |i: &usize| !is_below(distance(targets[*i]), bound);
        if self.open < targets.len() && is_open(&self.open) {
            return false;
        }
        match (0..targets.len()).find(is_open) {
            Some(open) => {
                self.open = open;
                false
            }
            None => true,
        }
    }

    #[inline]
    fn reach(&mut self, v: VertexId, corner: HalfEdgeId, way: Way) {
        self.probe.reach(v, corner, way);
    }

    fn renumber(
        &mut self,
        mesh: &Mesh,
        vertex: impl Fn(VertexId) -> VertexId,
        corner: impl Fn(VertexId, usize) -> HalfEdgeId,
    ) {
        self.probe.renumber(mesh, vertex, corner);
    }

    fn open_bound(&self) -> f64 {
        self.bound
    }

    fn end(&mut self, bound: f64) {
        self.bound = bound;
    }
}

/// Decides when a run may end, for queues that do not know their least label.
///
/// The least label is found by a search of everything that waits. To keep the run time linear, a
/// search that saw k windows is followed by at least k propagations before the next one.
#[derive(Clone, Copy, Debug, Default)]
pub struct EndCheck {
    left: usize,
}

impl EndCheck {
    /// Resets the state for a new run.
    pub fn clear(&mut self) {
        self.left = 0;
    }

    /// Tells that this many windows were propagated since the last call.
    #[inline]
    pub fn advance(&mut self, windows: usize) {
        self.left = self.left.saturating_sub(windows);
    }

    /// Whether the run may end: everything that `probe` wants is final, given the known distances
    /// and the labels of all that waits. `nearest` is an estimate of the least label; `waiting` is
    /// searched only if the goal would be reached at that label.
    pub fn ends<P: Probe, L: Iterator<Item = f64>>(
        &mut self,
        probe: &mut P,
        nearest: f64,
        distance: impl Fn(VertexId) -> f64,
        waiting: impl FnOnce() -> L,
    ) -> bool {
        if self.left > 0 || !probe.is_reached(nearest, &distance) {
            return false;
        }
        let (mut least, mut count) = (f64::INFINITY, 0);
        for label in waiting() {
            least = label.min(least);
            count += 1;
        }
        self.left = count;
        let ends = probe.is_reached(least, &distance);
        if ends {
            probe.end(least);
        }
        ends
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn known(distances: [f64; 3]) -> impl Fn(VertexId) -> f64 {
        move |v| distances[v.index()]
    }

    #[test]
    fn targets_are_final_once_nothing_nearer_waits() {
        let goal = Goal::targets([2, 0]);
        let mut until = Until::new((), &goal);
        assert!(!until.is_reached(5.0, known([1.0, 9.0, f64::INFINITY])));
        assert!(!until.is_reached(5.0, known([1.0, 9.0, 5.0])), "a tie");
        assert!(until.is_reached(5.0, known([1.0, 9.0, 4.0])));
        assert!(!until.is_reached(1.0, known([1.0, 9.0, 0.5])));
        until.end(5.0);
        let mut solution = Solution::new(vec![1.0, 9.0, 4.0]);
        until.cut(&mut solution);
        assert_eq!(solution.distances, [1.0, f64::INFINITY, 4.0]);
    }

    #[test]
    fn beyond_the_radius_nothing_is_known() {
        let goal = Goal::everything().within(3.0);
        let mut until = Until::new((), &goal);
        assert!(!until.is_reached(3.0, known([1.0, 2.0, 3.0])));
        assert!(until.is_reached(3.1, known([1.0, 2.0, 3.0])));
        until.end(4.0);
        let mut solution = Solution::new(vec![3.0, 3.5, 1.0]);
        until.cut(&mut solution);
        assert_eq!(solution.distances, [3.0, f64::INFINITY, 1.0]);
    }

    #[test]
    fn a_stopped_run_is_at_its_end() {
        let stop = Stop::default();
        let goal = Goal::targets([0]).unless(&stop);
        let mut until = Until::new((), &goal);
        assert!(!until.is_reached(1.0, known([5.0; 3])));
        stop.set();
        assert!(until.is_reached(1.0, known([5.0; 3])));
        assert_ne!(goal, Goal::targets([0]).unless(&Stop::default()));
    }

    #[test]
    fn a_lookout_looks_again_after_as_many_windows_as_it_saw() {
        let goal = Goal::targets([0]);
        let mut until = Until::new((), &goal);
        let mut end_check = EndCheck::default();
        let mut looks = 0;
        let mut ends = |end_check: &mut EndCheck, waiting: [f64; 2]| {
            end_check.ends(&mut until, 8.0, known([5.0; 3]), || {
                looks += 1;
                waiting.into_iter()
            })
        };
        assert!(!ends(&mut end_check, [4.0, 9.0]));
        assert!(!ends(&mut end_check, [9.0, 9.0]));
        end_check.advance(2);
        assert!(ends(&mut end_check, [9.0, 8.0]));
        assert_eq!(looks, 2);
    }
}
