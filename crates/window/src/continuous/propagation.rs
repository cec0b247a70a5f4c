//! The main loop.

use geobench_mesh::{HalfEdgeId, Mesh, VertexId};

use super::policy::{Arrival, Crossing, Policy};
use super::surface::{Side, Surface};
use crate::counters::Counter;
use crate::cross::{apex_distance, left_child, right_child, separating_abscissa};
use crate::probe::{Phase, Probe};
use crate::queue::{Discipline, Event, EventKind};
use crate::solver::{Propagate, Solution};
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

/// An algorithm that takes one window at a time: `policy` under `queue`, on one mesh.
#[derive(Clone, Debug)]
pub struct Continuous<'m, W, Q> {
    mesh: &'m Mesh,
    surface: Surface,
    policy: W,
    queue: Q,
    /// Children narrower than this are dropped.
    threshold: f64,
}

impl<'m, W: Policy, Q: Discipline> Continuous<'m, W, Q> {
    /// Sets up for `mesh`; O(faces).
    pub fn new(mesh: &'m Mesh, policy: W, queue: Q) -> Self {
        Self {
            mesh,
            surface: Surface::new(mesh),
            policy,
            queue,
            threshold: 0.0,
        }
    }

    /// Drops windows whose interval is narrower than `width`, in the units of the mesh, when they
    /// come out of a triangle. The papers do so at a millionth of the model's size; distances are
    /// then no longer exact.
    #[must_use]
    pub fn with_threshold(self, width: f64) -> Self {
        Self {
            threshold: width,
            ..self
        }
    }

    /// A path of length `d` reaches `v`. Only vertices at which a path may turn have a turn, unless
    /// the discipline goes by vertices.
    fn offer<P: Probe>(&mut self, v: VertexId, d: f64, probe: &mut P) {
        if self.surface.offer(v, d) && (Q::EVERY_VERTEX || self.mesh.is_pseudo_source(v)) {
            self.queue.push(d, Event::vertex(v), probe);
        }
    }

    /// Sends out paths along the edges of `v` and windows across its faces.
    fn spawn<P: Probe>(&mut self, v: VertexId, probe: &mut P) {
        probe.add(Counter::PseudoSources, 1);
        let sigma = self.surface.distance(v);
        let mesh = self.mesh;
        for (neighbour, length) in mesh.neighbours(v) {
            self.offer(neighbour, sigma + length, probe);
        }
        let lineage = self.policy.root(v, &self.surface);
        for &h in mesh.outgoing(v) {
            if let Some((target, window)) = spawn_window(self.surface.faces(), h, sigma) {
                probe.add(Counter::Spawned, 1);
                self.arrive(
                    &Arrival {
                        h: target,
                        window,
                        lineage,
                        side: None,
                    },
                    probe,
                );
            }
        }
    }

    /// Hands a window that has reached a half-edge to the policy; returns whether any of it is left.
    fn arrive<P: Probe>(&mut self, arrival: &Arrival<W::Lineage>, probe: &mut P) -> bool {
        probe.enter(Phase::Pruning);
        let mut push = |h: HalfEdgeId, label: f64, id: u32, probe: &mut P| {
            self.queue.push(label, Event::window(h, id), probe);
        };
        let kept = self.policy.arrive(arrival, &self.surface, &mut push, probe);
        probe.enter(Phase::Management);
        kept
    }

    /// Hands on what came of trying a child.
    fn send<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        child: Option<Window>,
        lineage: W::Lineage,
        side: Side,
        probe: &mut P,
    ) {
        probe.add(Counter::Propagated, 1);
        if let Some(window) = child {
            probe.add(Counter::Children, 1);
            if window.b1 - window.b0 < self.threshold {
                probe.add(Counter::Filtered, 1);
                return;
            }
            let kept = self.arrive(
                &Arrival {
                    h,
                    window,
                    lineage,
                    side: Some(side),
                },
                probe,
            );
            probe.add(Counter::Kept, u64::from(kept));
            probe.enter(Phase::Propagation);
        }
    }

    /// Takes a window across the face of `h`.
    fn cross<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        window: &Window,
        lineage: &W::Lineage,
        probe: &mut P,
    ) {
        probe.enter(Phase::Propagation);
        probe.add(Counter::Parents, 1);
        if probe.wants_sample(1) {
            probe.sample(self.queue.window_labels());
        }
        let frame = self.surface.faces().frame(h);
        let [_, _, apex] = self.surface.faces().corners(h);
        let [to_left, to_right] = self.surface.faces().exits(h);
        let sp = separating_abscissa(&frame, window);
        let d = apex_distance(&frame, window, sp);
        self.offer(apex, d, probe);
        let crossing = Crossing {
            h,
            window: *window,
            separation: sp,
            apex_distance: d,
        };
        let [left, right] = self.policy.split(&crossing, lineage, &self.surface);
        let to_left = to_left.zip(left);
        let to_right = to_right.zip(right);
        let tries = u64::from(to_left.is_some()) + u64::from(to_right.is_some());
        self.queue.crossed(h, tries, probe);
        if let Some((target, lineage)) = to_left {
            let child = left_child(&frame, window, sp, window.b1.min(sp));
            self.send(target, child, lineage, Side::Left, probe);
        }
        if let Some((target, lineage)) = to_right {
            let child = right_child(&frame, window, sp, window.b0.max(sp));
            self.send(target, child, lineage, Side::Right, probe);
        }
        probe.enter(Phase::Management);
    }
}

impl<W: Policy, Q: Discipline> Propagate for Continuous<'_, W, Q> {
    fn counters() -> Vec<Counter> {
        [COUNTERS, W::COUNTERS, Q::COUNTERS].concat()
    }

    fn mesh(&self) -> &Mesh {
        self.mesh
    }

    fn propagate<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) -> Solution {
        self.surface.reset(self.mesh.vertex_count());
        self.policy.reset();
        self.queue.clear();
        probe.add(Counter::WindowBytes, W::WINDOW_BYTES as u64);
        for &s in sources {
            self.surface.offer(s, 0.0);
        }
        for &s in sources {
            self.queue.start(s);
            self.spawn(s, probe);
        }
        while let Some((label, event)) = self.queue.pop(probe) {
            match event.kind() {
                EventKind::Vertex(v) => {
                    // A vertex is queued anew whenever it improves; older entries are void.
                    if self.surface.distance(v) == label
                        && (!Q::EVERY_VERTEX || self.mesh.is_pseudo_source(v))
                    {
                        self.spawn(v, probe);
                    }
                }
                EventKind::Window(h, id) => {
                    if let Some((window, lineage)) = self.policy.take(h, id, &self.surface, probe) {
                        self.cross(h, &window, &lineage, probe);
                    }
                }
            }
        }
        self.policy.finish(probe);
        Solution::new(self.surface.take_distances())
    }
}
