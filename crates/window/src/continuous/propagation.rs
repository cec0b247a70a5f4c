//! The main loop.

use geobench_mesh::{HalfEdgeId, Mesh, VertexId};

use super::edge::{Edge, Side};
use super::policy::{Arrival, Policy, Turn};
use super::surface::Surface;
use crate::counters::Counter;
use crate::frame::Entrance;
use crate::passage::Passage;
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

/// How many turns before its own a window is announced, how many before it is prepared, and how many before it is
/// made ready.
const FAR: usize = 5;
const NEAR: usize = 3;
const NEXT: usize = 1;

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

/// A window on its way through a face.
struct Crossing<'a> {
    passage: Passage<'a>,
    exits: [Option<HalfEdgeId>; 2],
    /// Of the face's A, B and C.
    distances: [f64; 3],
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

    /// The same with another setting of its policy.
    #[must_use]
    pub fn map_policy(self, change: impl FnOnce(W) -> W) -> Self {
        Self {
            policy: change(self.policy),
            ..self
        }
    }

    /// The least distances of the windows that wait.
    fn waiting(&self) -> impl Iterator<Item = f64> {
        self.queue
            .events()
            .filter_map(|(label, event)| match event.kind() {
                EventKind::Window(h, id) => self.policy.least_distance(h, id, label),
                EventKind::Vertex(_) => None,
            })
    }

    /// A path of length `d` reaches `v`. Only vertices at which a path may turn have a turn, unless
    /// the discipline goes by vertices.
    #[inline(never)]
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
    }

    /// Hands a window that has reached a half-edge to the policy; returns whether any of it is left.
    #[inline]
    fn arrive<P: Probe>(&mut self, arrival: &Arrival<W::Lineage>, probe: &mut P) -> bool {
        probe.enter(Phase::Pruning);
        let mut push = |h: HalfEdgeId, label: f64, id: u32, probe: &mut P| {
            self.queue.push(label, Event::window(h, id), probe);
        };
        let kept = self.policy.arrive(arrival, &self.surface, &mut push, probe);
        probe.enter(Phase::Management);
        kept
    }

    /// Hands on the child of a crossing on one side, if it is not empty.
    #[inline]
    fn send<P: Probe>(
        &mut self,
        side: Side,
        Crossing {
            exits,
            passage,
            distances,
        }: &Crossing<'_>,
        lineage: W::Lineage,
        probe: &mut P,
    ) {
        let (exit, child, edge) = match side {
            Side::Left => (
                exits[0],
                passage.left_child(),
                Edge::left(passage.frame(), *distances),
            ),
            Side::Right => (
                exits[1],
                passage.right_child(),
                Edge::right(passage.frame(), *distances),
            ),
        };
        let (Some(h), Some(window)) = (exit, child) else {
            return;
        };
        probe.add(Counter::Children, 1);
        if window.b1 - window.b0 < self.threshold {
            probe.add(Counter::Filtered, 1);
            return;
        }
        let arrival = Arrival {
            h,
            window,
            lineage,
            edge,
        };
        let kept = self.arrive(&arrival, probe);
        probe.add(Counter::Kept, u64::from(kept));
        probe.enter(Phase::Propagation);
    }

    /// Takes a window across the face of `h`.
    #[inline]
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
            probe.sample(self.waiting());
        }
        let Entrance {
            frame,
            corners,
            exits,
        } = self.surface.faces().entrance(h);
        let passage = Passage::new(&frame, window);
        let mut distances = corners.map(|v| self.surface.distance(v));
        if let Some(d) = passage.apex_distance_below(distances[2]) {
            distances[2] = d;
            self.offer(corners[2], d, probe);
        }
        let crossing = Crossing {
            passage,
            exits,
            distances,
        };
        if let Some(heir) = self.policy.descend(lineage) {
            let tried = if crossing.passage.covers_apex() {
                self.split(h, &crossing, heir, probe)
            } else {
                // Nearly all windows pass the apex on one side.
                let side = if crossing.passage.goes_left() {
                    Side::Left
                } else {
                    Side::Right
                };
                self.send(side, &crossing, heir, probe);
                W::tries(&crossing.passage)
            };
            let tries = (0..2).filter(|&side| tried[side] && exits[side].is_some());
            let tries = tries.count() as u64;
            probe.add(Counter::Propagated, tries);
            self.queue.crossed(h, tries, probe);
        }
        probe.enter(Phase::Management);
    }

    /// Sends on what the policy leaves of a window that covers the apex; returns which sides.
    #[inline(never)]
    fn split<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        crossing: &Crossing<'_>,
        heir: W::Lineage,
        probe: &mut P,
    ) -> [bool; 2] {
        let heirs = (self.policy).split(h, &crossing.passage, heir, &self.surface);
        for (side, heir) in [Side::Left, Side::Right].into_iter().zip(heirs) {
            if let Some(heir) = heir {
                self.send(side, crossing, heir, probe);
            }
        }
        heirs.map(|heir| heir.is_some())
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
            if let Some(EventKind::Window(h, id)) = self.queue.upcoming(FAR).map(Event::kind) {
                self.policy.announce(h, id);
                self.surface.announce(h);
            }
            if let Some(EventKind::Window(h, id)) = self.queue.upcoming(NEAR).map(Event::kind) {
                self.policy.prepare(h, id, &self.surface);
                self.surface.prepare(h);
            }
            if let Some(EventKind::Window(h, id)) = self.queue.upcoming(NEXT).map(Event::kind) {
                self.policy.make_ready(h, id, &self.surface);
            }
            match event.kind() {
                EventKind::Vertex(v) => {
                    // A vertex is queued anew whenever it improves; older entries are void.
                    if self.surface.distance(v) == label
                        && (!Q::EVERY_VERTEX || self.mesh.is_pseudo_source(v))
                    {
                        self.spawn(v, probe);
                    }
                }
                EventKind::Window(h, id) => loop {
                    match self.policy.take(h, id, &self.surface, probe) {
                        Turn::Now(window, lineage) => self.cross(h, &window, &lineage, probe),
                        Turn::Void => {}
                        Turn::Later(label) if self.queue.is_due(label) => continue,
                        Turn::Later(label) => self.queue.push(label, event, probe),
                    }
                    break;
                },
            }
        }
        self.policy.finish(probe);
        Solution::new(self.surface.take_distances())
    }
}
