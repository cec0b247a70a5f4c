//! The main loop of algorithms that take one window at a time.

// Keeps a window in registers between its crossing and the place where it is stored.
#![allow(clippy::inline_always)]

use geobench_mesh::{HalfEdgeId, Mesh, Splice, VertexId};

use super::edge::EdgeView;
use super::lookahead::Lookahead;
use super::policy::{Arrival, Child, Dequeued, Policy};
use super::surface::Surface;
use crate::counters::Counter;
use crate::crossing::{Crossing, length_past_end};
use crate::crossings::CrossedChild;
use crate::frame::{Exit, FaceView, Side};
use crate::goal::EndCheck;
use crate::origins::Way;
use crate::probe::{Phase, Probe};
use crate::queue::{Discipline, Event, EventKind};
use crate::simd::Instructions;
use crate::solver::{CompiledRuns, Propagate, Solution};
use crate::spawn::spawn_window;
use crate::window::Window;

/// The counters of every algorithm of these families.
const COUNTERS: &[Counter] = &[
    Counter::Propagated,
    Counter::Parents,
    Counter::Children,
    Counter::Kept,
    Counter::Spawned,
    Counter::WindowBytes,
    Counter::PseudoSources,
];

/// How many turns ahead the memory of a window is prefetched. Prefetching the windows that it will
/// be compared with costs more than it saves.
const AHEAD: usize = 5;

/// An algorithm that takes one window at a time: `policy` under `queue`, on one mesh. With
/// `RELAYS`, every vertex relays paths and is preferred to the windows that passed it
/// ([`relaying`](Self::relaying)).
///
/// ```
/// use geobench_ich::Splitting;
/// use geobench_mesh::Mesh;
/// use geobench_window::continuous::Continuous;
/// use geobench_window::queue::HeapQueue;
/// use geobench_window::{Solver, VertexFilter};
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// // ICH: windows are filtered and split, and taken by least distance.
/// let policy = Splitting::new(&mesh, VertexFilter::On);
/// let mut solver = Continuous::new(&mesh, policy, HeapQueue::default());
/// let distances = solver.distances_from(0)?;
/// assert!((distances[24] - 32.0_f64.sqrt()).abs() < 1e-12); // Across the whole grid.
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Continuous<W, Q, const RELAYS: bool = false> {
    runs: CompiledRuns<Self>,
    pub(super) mesh: Mesh,
    pub(super) surface: Surface,
    pub(super) policy: W,
    pub(super) queue: Q,
    lookahead: Lookahead,
    end_check: EndCheck,
    /// Children narrower than this are dropped.
    threshold: f64,
    /// The fraction ε/(1+ε) of a straight path that the value of its end vertex omits; see
    /// [`relaying`](Self::relaying).
    advantage: f64,
}

impl<W: Policy, Q: Discipline> Continuous<W, Q> {
    /// Sets up for `mesh`; O(faces).
    pub fn new(mesh: &Mesh, policy: W, queue: Q) -> Self {
        Self::set_up(mesh, policy, queue)
    }
}

impl<W: Policy, Q: Discipline> Continuous<W, Q, true> {
    /// Sets up for `mesh` with an error of at most `epsilon`, for which fewer windows are needed;
    /// O(faces). Distances are at most 1 + `epsilon` times the exact ones, and never less. An
    /// `epsilon` that is not positive counts as 0.
    ///
    /// A run keeps a *value* V of each vertex. The source has the value 0. A straight path of
    /// length d from a vertex r gives vertex v the value V(r) + d/(1+ε), and windows from r start
    /// with σ = V(r). Windows and vertices are compared as in an exact algorithm, by V(r) + d. So a
    /// vertex beats a window that has passed it on a long enough path, and the windows of the
    /// vertex replace it.
    ///
    /// *Never less:* (1+ε)·V(v) is at least the length of some path to v.
    ///
    /// *At most 1 + ε times as long:* let d(r, q) be the exact distance. Let r be the vertex of
    /// least V(r) + d(r, q), of several the nearest to q. Assume that the path from r to q turns
    /// first at r', or that its window is dropped in favour of one of r'. Then V(r') + d(r', q) is
    /// no more, up to rounding, and r' is nearer or the sum is less, which contradicts the choice
    /// of r. So the path is straight and its window reaches q. Hence V(q) ≤ V(r) + d(r, q)/(1+ε) ≤
    /// V(r) + d(r, q) ≤ d(s, q) for every source s.
    pub fn relaying(mesh: &Mesh, policy: W, queue: Q, epsilon: f64) -> Self {
        let epsilon = if epsilon > 0.0 { epsilon } else { 0.0 };
        Self {
            advantage: epsilon / (1.0 + epsilon),
            ..Self::set_up(mesh, policy, queue)
        }
    }
}

impl<W: Policy, Q: Discipline, const RELAYS: bool> Continuous<W, Q, RELAYS> {
    fn set_up(mesh: &Mesh, policy: W, queue: Q) -> Self {
        Self {
            runs: CompiledRuns::new(),
            mesh: mesh.clone(),
            surface: Surface::new(mesh),
            policy,
            queue,
            lookahead: Lookahead::default(),
            end_check: EndCheck::default(),
            threshold: 0.0,
            advantage: 0.0,
        }
    }

    /// Drops children whose interval is narrower than `width`, in the units of the mesh. The papers
    /// use a millionth of the model's size. Distances are then no longer exact.
    #[must_use]
    pub fn with_threshold(self, width: f64) -> Self {
        Self {
            threshold: width,
            ..self
        }
    }

    /// The factor 1 + ε from values to distances.
    fn scale(&self) -> f64 {
        (1.0 - self.advantage).recip()
    }

    /// The value of a vertex reached by a path of length `d` that turns last at a vertex with value
    /// `sigma`.
    #[inline(always)]
    fn value(&self, d: f64, sigma: f64) -> f64 {
        if RELAYS {
            d - (d - sigma) * self.advantage
        } else {
            d
        }
    }

    /// Whether paths may turn at `v`.
    #[inline(always)]
    fn turns_at(&self, v: VertexId) -> bool {
        RELAYS || self.mesh.is_pseudo_source(v)
    }

    /// Uses `instructions`, or narrower ones if the processor lacks them. The default is the widest
    /// set of the processor. Distances and counts do not depend on it.
    #[must_use]
    pub fn with_instructions(self, instructions: Instructions) -> Self {
        Self {
            lookahead: Lookahead::new(instructions),
            ..self
        }
    }

    /// The same algorithm with its policy replaced by `change` of it.
    #[must_use]
    pub fn map_policy(self, change: impl FnOnce(W) -> W) -> Self {
        Self {
            policy: change(self.policy),
            ..self
        }
    }

    /// The policy, with the state that it keeps from the last run.
    pub fn policy(&self) -> &W {
        &self.policy
    }

    /// The number that the policy uses for half-edge `h` of the mesh.
    pub fn number(&self, h: HalfEdgeId) -> HalfEdgeId {
        self.surface.faces().number(h)
    }

    /// The waiting windows and their half-edges.
    fn waiting(&self) -> impl Iterator<Item = (HalfEdgeId, Window)> {
        let events = self.queue.events();
        events.filter_map(|(_, event)| match event.kind() {
            EventKind::Window(h, id) => Some((h, self.policy.waiting(h, id, &self.surface)?)),
            EventKind::Vertex(_) => None,
        })
    }

    /// Whether everything that `probe` wants is final, now that an event under `label` has left the
    /// queue.
    pub(super) fn ends<P: Probe>(&mut self, label: f64, probe: &mut P) -> bool {
        let (surface, scale) = (&self.surface, self.scale());
        let distance = |v| {
            let value = surface.distance(v);
            if RELAYS { value * scale } else { value }
        };
        self.end_check.advance(1);
        self.queue.ends(label, &mut self.end_check, distance, probe)
    }

    /// Offers `v` a path of length `d` and returns whether it is the shortest so far. Only vertices
    /// at which a path may turn are queued, unless the discipline wants every vertex.
    #[inline(never)]
    fn offer<P: Probe>(&mut self, v: VertexId, d: f64, probe: &mut P) -> bool {
        let improves = self.surface.offer(v, d);
        if improves && (Q::EVERY_VERTEX || self.turns_at(v)) {
            probe.enter(Phase::Management);
            self.queue.push(d, Event::vertex(v), probe);
            probe.enter(Phase::Propagation);
        }
        improves
    }

    /// Offers the apex of `h` a path of `window` of length `d`.
    #[inline(always)]
    fn offer_apex<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        apex: VertexId,
        d: f64,
        window: impl Fn(&Self) -> Window,
        probe: &mut P,
    ) {
        if !self.offer(apex, d, probe) {
            return;
        }
        if P::TRACES {
            let way = Way::of(&window(self), &self.surface.faces().frame(h));
            probe.reach(apex, h.prev(), way);
        }
        if P::EXPLORES {
            probe.improve(apex, d, window(self).sigma);
        }
    }

    /// [`length_past_end`] for the path of `window` to the apex of `h`, which has length `d` by its
    /// window.
    #[inline(always)]
    fn length_past_end(&self, h: HalfEdgeId, d: f64, window: impl Fn(&Self) -> Window) -> f64 {
        let [tail, head, _] = self.surface.faces().corners(h);
        let ends = [tail, head].map(|v| self.surface.distance(v));
        if RELAYS || ends[0].max(ends[1]) <= d {
            return d;
        }
        let frame = self.surface.faces().frame(h);
        let entry = window(self).entry(&frame);
        length_past_end(d, entry, frame.l, ends, [frame.la, frame.lb])
    }

    /// Offers distances along the edges of `v` and sends windows across its faces.
    fn spawn<P: Probe>(&mut self, v: VertexId, probe: &mut P) {
        probe.enter(Phase::Propagation);
        probe.add(Counter::PseudoSources, 1);
        let sigma = self.surface.distance(v);
        // By index, since `self` changes meanwhile.
        let degree = self.mesh.outgoing(v).len();
        for i in 0..degree {
            let h = self.surface.faces().number(self.mesh.outgoing(v)[i]);
            for path in self.surface.faces().edge_paths(h) {
                let d = self.value(sigma + path.length, sigma);
                if !self.offer(path.end, d, probe) {
                    continue;
                }
                if P::TRACES {
                    probe.reach(path.end, path.corner, path.way);
                }
                if P::EXPLORES {
                    probe.improve(path.end, d, sigma);
                }
            }
        }
        let lineage = self.policy.root(v, &self.surface);
        for i in 0..degree {
            let h = self.surface.faces().number(self.mesh.outgoing(v)[i]);
            if let Some((target, window)) = spawn_window(self.surface.faces(), h, sigma) {
                probe.add(Counter::Spawned, 1);
                let edge = self.surface.edge(target);
                self.arrive(
                    &Arrival {
                        h: target,
                        window,
                        lineage,
                        edge,
                    },
                    probe,
                );
            }
        }
        probe.enter(Phase::Management);
    }

    /// Passes a window that has reached a half-edge to the policy; returns whether any part of it
    /// is left.
    #[inline(always)]
    fn arrive<P: Probe>(&mut self, arrival: &Arrival<W::Lineage>, probe: &mut P) -> bool {
        probe.enter(Phase::Pruning);
        let mut push = |h: HalfEdgeId, label: f64, id: u32, probe: &mut P| {
            probe.enter(Phase::Management);
            self.queue.push(label, Event::window(h, id), probe);
            probe.enter(Phase::Pruning);
        };
        let kept = self.policy.arrive(arrival, &self.surface, &mut push, probe);
        probe.enter(Phase::Propagation);
        kept
    }

    /// Passes on the child of a window at an exit, if there is one.
    #[inline(always)]
    fn send<P: Probe>(
        &mut self,
        child: Option<Window>,
        exit: &Exit,
        lineage: W::Lineage,
        probe: &mut P,
    ) {
        let (Some(h), Some(window)) = (exit.half_edge, child) else {
            return;
        };
        probe.add(Counter::Children, 1);
        if window.b1 - window.b0 < self.threshold {
            probe.add(Counter::Filtered, 1);
            return;
        }
        let distances = exit.corners.map(|v| self.surface.distance(v));
        let arrival = Arrival {
            h,
            window,
            lineage,
            edge: EdgeView::behind(exit, distances),
        };
        let kept = self.arrive(&arrival, probe);
        probe.add(Counter::Kept, u64::from(kept));
    }

    /// The lane of window `id` on `h`, which has left the queue, if it was crossed early.
    #[inline(always)]
    fn foresee<P: Probe>(&mut self, h: HalfEdgeId, id: u32, probe: &mut P) -> Option<usize> {
        if W::FORESEES {
            (self.lookahead).lane(h, id, &self.queue, &self.policy, &self.surface, probe)
        } else {
            None
        }
    }

    /// Prefetches the memory of coming windows, for a policy that does not foresee them.
    #[inline(always)]
    fn read_ahead(&self) {
        if let Some(EventKind::Window(h, id)) = self.queue.upcoming(AHEAD).map(Event::kind) {
            self.policy.announce(h, id);
            self.surface.announce(h);
        }
    }

    /// Counts a window that enters the face of `h`.
    #[inline(always)]
    fn begin<P: Probe>(&self, probe: &mut P) {
        probe.enter(Phase::Propagation);
        probe.add(Counter::Parents, 1);
        if probe.wants_sample(1) {
            probe.sample(self.waiting().map(|(_, window)| window.min_distance()));
            if probe.wants_windows() {
                let ends = |h| self.surface.faces().ends(h);
                probe.take_windows(self.waiting().map(|(h, window)| (ends(h), window)));
            }
        }
    }

    /// Counts the children tried on the face of `h`, once its window has been propagated.
    #[inline(always)]
    fn end<P: Probe>(&mut self, h: HalfEdgeId, tried: [bool; 2], probe: &mut P) {
        if P::COUNTS {
            let exits = self.surface.faces().exits(h);
            let tries = (0..2).filter(|&side| tried[side] && exits[side].is_some());
            let tries = tries.count() as u64;
            probe.add(Counter::Propagated, tries);
            self.queue.crossed(h, tries, probe);
        }
        probe.enter(Phase::Management);
    }

    /// Propagates a window across the face of `h`.
    #[inline(always)]
    fn cross<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        window: Window,
        lineage: W::Lineage,
        probe: &mut P,
    ) {
        self.begin(probe);
        let faces = self.surface.faces();
        let FaceView {
            frame,
            corners: [.., apex],
            ..
        } = faces.face_view(h);
        let crossing = Crossing::new(&frame, &window);
        let tried = if crossing.covers_apex() {
            self.split(h, window, lineage, probe)
        } else {
            // Nearly all windows pass the apex on one side.
            let exit = faces.exit(h, &frame, crossing.side());
            let d = self.value(crossing.bent_distance(&exit), window.sigma);
            if d < self.surface.distance(apex) {
                let d = self.length_past_end(h, d, |_| window);
                self.offer_apex(h, apex, d, |_| window, probe);
            }
            if let Some(inherited) = self.policy.descend(&lineage) {
                self.send(crossing.only_child(&exit), &exit, inherited, probe);
                W::tries(&crossing)
            } else {
                [false; 2]
            }
        };
        self.end(h, tried, probe);
    }

    /// Propagates a window that covers the apex across the face of `h`, as far as the policy
    /// allows. Returns which children were tried.
    #[inline(never)]
    fn split<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        window: Window,
        lineage: W::Lineage,
        probe: &mut P,
    ) -> [bool; 2] {
        let FaceView {
            frame,
            corners: [.., apex],
            ..
        } = self.surface.faces().face_view(h);
        let crossing = Crossing::new(&frame, &window);
        let d = self.value(crossing.straight_distance(), window.sigma);
        if d < self.surface.distance(apex) {
            self.offer_apex(h, apex, d, |_| window, probe);
        }
        let Some(inherited) = self.policy.descend(&lineage) else {
            return [false; 2];
        };
        let [left, right] = self.policy.split(h, &crossing, inherited, &self.surface);
        if let Some(inherited) = left {
            let exit = self.surface.faces().exit(h, &frame, Side::Left);
            self.send(crossing.left_child(&exit), &exit, inherited, probe);
        }
        if let Some(inherited) = right {
            let exit = self.surface.faces().exit(h, &frame, Side::Right);
            self.send(crossing.right_child(&exit), &exit, inherited, probe);
        }
        [left.is_some(), right.is_some()]
    }

    /// As [`cross`](Self::cross), for a window that was crossed early.
    #[inline(always)]
    fn cross_ahead<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        lane: usize,
        lineage: W::Lineage,
        probe: &mut P,
    ) {
        self.begin(probe);
        let crossings = self.lookahead.crossings();
        let covers_apex = crossings.covers_apex(lane);
        let (apex, d) = (crossings.apex(lane), crossings.apex_distance(lane));
        let value = if RELAYS {
            self.value(d, crossings.window(lane).sigma)
        } else {
            d
        };
        if value < self.surface.distance(apex) {
            let window = |run: &Self| run.lookahead.crossings().window(lane);
            let value = self.length_past_end(h, value, window);
            self.offer_apex(h, apex, value, window, probe);
        }
        let tried = if covers_apex {
            self.split_ahead(h, lane, d, lineage, probe)
        } else if let Some(inherited) = self.policy.descend(&lineage) {
            self.send_ahead(&self.lookahead.crossings().child(lane), inherited, probe);
            [true; 2]
        } else {
            [false; 2]
        };
        self.end(h, tried, probe);
    }

    /// As [`split`](Self::split), for a window that was crossed early; `d` is the length of its
    /// straight path to the apex.
    #[inline(never)]
    fn split_ahead<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        lane: usize,
        d: f64,
        lineage: W::Lineage,
        probe: &mut P,
    ) -> [bool; 2] {
        let Some(inherited) = self.policy.descend(&lineage) else {
            return [false; 2];
        };
        let faces = self.surface.faces();
        let entry = self.lookahead.crossings().entry(lane, faces);
        let [left, right] = self.policy.split_at(h, entry, d, inherited);
        if let Some(inherited) = left {
            self.send_ahead(&self.lookahead.crossings().child(lane), inherited, probe);
        }
        if let Some(inherited) = right {
            let crossings = self.lookahead.crossings();
            let child = crossings.right_child(lane, self.surface.faces());
            self.send_ahead(&child, inherited, probe);
        }
        [left.is_some(), right.is_some()]
    }

    /// Passes on a child of a window that was crossed early, unless it is empty.
    #[inline(always)]
    fn send_ahead<P: Probe>(&mut self, child: &CrossedChild, lineage: W::Lineage, probe: &mut P) {
        let CrossedChild {
            exit_edge,
            window,
            label,
            ..
        } = *child;
        let (Some(h), true) = (exit_edge.half_edge(), window.b0 < window.b1) else {
            return;
        };
        probe.add(Counter::Children, 1);
        if window.b1 - window.b0 < self.threshold {
            probe.add(Counter::Filtered, 1);
            return;
        }
        probe.enter(Phase::Pruning);
        let distances = exit_edge.corners.map(|v| self.surface.distance(v));
        let child = Child {
            h,
            window,
            lineage,
            label,
            is_beaten: child.is_beaten(distances),
        };
        let mut push = |h: HalfEdgeId, label: f64, id: u32, probe: &mut P| {
            self.queue.push(label, Event::window(h, id), probe);
        };
        let kept = (self.policy).admit(&child, &self.surface, &mut push, probe);
        probe.add(Counter::Kept, u64::from(kept));
        probe.enter(Phase::Propagation);
    }

    /// Starts a run: `sources` send out their windows. Surface and policy must be reset.
    pub(super) fn begin_run<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) {
        self.queue.clear();
        self.lookahead.clear();
        self.end_check.clear();
        probe.add(Counter::WindowBytes, W::WINDOW_BYTES as u64);
        for &s in sources {
            self.surface.offer(s, 0.0);
        }
        for &s in sources {
            self.queue.start(s);
            self.spawn(s, probe);
        }
    }

    /// Processes `event`, which has left the queue under `label`.
    #[inline(always)]
    pub(super) fn turn<P: Probe>(&mut self, label: f64, event: Event, probe: &mut P) {
        if !W::FORESEES {
            self.read_ahead();
        }
        match event.kind() {
            EventKind::Vertex(v) => {
                // A vertex is queued anew whenever it improves; its older entries are void.
                if self.surface.distance(v) == label && (!Q::EVERY_VERTEX || self.turns_at(v)) {
                    self.spawn(v, probe);
                }
            }
            EventKind::Window(h, id) => {
                if let Some(lane) = self.foresee(h, id, probe) {
                    if let Some(lineage) = self.policy.release(h, id, &self.surface, probe) {
                        self.cross_ahead(h, lane, lineage, probe);
                    }
                    return;
                }
                loop {
                    match self.policy.take(h, id, &self.surface, probe) {
                        Dequeued::Propagate(window, lineage) => {
                            self.cross(h, window, lineage, probe);
                        }
                        Dequeued::Stale => {}
                        Dequeued::Requeue(label) if self.queue.is_due(label) => continue,
                        Dequeued::Requeue(label) => self.queue.push(label, event, probe),
                    }
                    break;
                }
            }
        }
    }
}

impl<W: Policy, Q: Discipline, const RELAYS: bool> Propagate for Continuous<W, Q, RELAYS> {
    const JUNCTIONS: bool = W::JUNCTIONS && !RELAYS;

    fn counters() -> Vec<Counter> {
        [COUNTERS, W::COUNTERS, Q::COUNTERS].concat()
    }

    fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    fn splice(&mut self, splice: &Splice) -> Option<Splice> {
        let undo = W::SPLICES.then(|| self.mesh.splice(splice))?;
        self.lookahead.forget();
        self.surface.splice(&self.mesh, splice);
        self.policy.splice(&self.mesh, splice, &self.surface);
        self.queue.splice(&self.mesh, splice);
        Some(undo)
    }

    fn runs(&self) -> CompiledRuns<Self> {
        self.runs
    }

    fn propagate<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) -> Solution {
        self.surface.reset(self.mesh.vertex_count());
        self.policy.reset();
        self.begin_run(sources, probe);
        while let Some((label, event)) = self.queue.pop(probe) {
            if P::STOPS && self.ends(label, probe) {
                break;
            }
            self.turn(label, event, probe);
        }
        self.policy.finish(probe);
        if P::TRACES {
            let (mesh, faces) = (&self.mesh, self.surface.faces());
            probe.renumber(mesh, |v| v, |v, i| faces.number(mesh.outgoing(v)[i]));
        }
        let mut distances = self.surface.take_distances();
        if RELAYS {
            let scale = self.scale();
            for d in &mut distances {
                *d *= scale;
            }
        }
        Solution::new(distances)
    }
}
