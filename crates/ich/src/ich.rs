//! The main loop.

use geobench_mesh::{HalfEdgeId, Mesh, VertexId};
use geobench_window::queue::{Discipline, Event, EventKind, Heap};
use geobench_window::{
    Counter, Faces, Phase, Probe, Propagate, Solution, Window, apex_distance, is_beaten_across,
    is_beaten_from_ends, left_child, right_child, separating_abscissa, spawn_window,
};

use crate::angle::{Angles, Split};
use crate::tree::{Guard, Leaves, Node, Side};

/// ICH on one mesh, under the discipline `Q`: a priority queue for ICH itself (ICH2 of the paper).
#[derive(Clone, Debug)]
pub struct Ich<'m, Q = Heap<Event>> {
    mesh: &'m Mesh,
    faces: Faces,
    queue: Q,
    leaves: Leaves,
    angles: Angles,
    distances: Vec<f64>,
    /// How often the distance of each vertex has improved.
    stamps: Vec<u32>,
}

impl<'m, Q: Discipline<Event>> Ich<'m, Q> {
    /// Sets up for `mesh`; O(faces).
    pub fn new(mesh: &'m Mesh) -> Self {
        Self {
            mesh,
            faces: Faces::new(mesh),
            queue: Q::default(),
            leaves: Leaves::default(),
            angles: Angles::new(mesh.half_edge_count()),
            distances: Vec::new(),
            stamps: Vec::new(),
        }
    }

    fn reset(&mut self) {
        self.queue.clear();
        self.leaves.clear();
        self.angles.clear();
        self.distances.clear();
        self.distances
            .resize(self.mesh.vertex_count(), f64::INFINITY);
        self.stamps.clear();
        self.stamps.resize(self.mesh.vertex_count(), 0);
    }

    /// A path of length `d` reaches `v`.
    fn offer<P: Probe>(&mut self, v: VertexId, d: f64, probe: &mut P) {
        let known = &mut self.distances[v.index()];
        if d < *known {
            *known = d;
            self.stamps[v.index()] += 1;
            if self.mesh.is_pseudo_source(v) {
                self.queue.push(d, Event::vertex(v));
                probe.add(Counter::QueuePushes, 1);
            }
        }
    }

    /// Sends out paths along the edges of `v` and windows across its faces.
    fn spawn<P: Probe>(&mut self, v: VertexId, probe: &mut P) {
        probe.add(Counter::PseudoSources, 1);
        let sigma = self.distances[v.index()];
        let root_stamp = self.stamps[v.index()];
        let mesh = self.mesh;
        for (neighbour, length) in mesh.neighbours(v) {
            self.offer(neighbour, sigma + length, probe);
        }
        for &h in mesh.outgoing(v) {
            if let Some((target, window)) = spawn_window(&self.faces, h, sigma) {
                let node = Node {
                    window,
                    root: v,
                    root_stamp,
                    level: 0,
                    guard: None,
                };
                self.arrive(target, node, None, probe);
            }
        }
    }

    /// A window reaches half-edge `h`: it is queued unless a filter drops it. `side` tells which
    /// child of a crossing it is.
    fn arrive<P: Probe>(&mut self, h: HalfEdgeId, node: Node, side: Option<Side>, probe: &mut P) {
        probe.enter(Phase::Pruning);
        probe.add(
            if side.is_some() {
                Counter::Children
            } else {
                Counter::Spawned
            },
            1,
        );
        let w = &node.window;
        let [tail, head, _] = self.faces.corners(h).map(|v| self.distances[v.index()]);
        let beaten = is_beaten_from_ends(w, self.faces.length(h), tail, head)
            || side.is_some_and(|side| self.is_beaten_from_behind(h, w, side));
        probe.enter(Phase::Management);
        if beaten {
            probe.add(Counter::Filtered, 1);
            return;
        }
        let label = w.min_distance();
        probe.add(Counter::Kept, u64::from(side.is_some()));
        probe.add(Counter::QueuePushes, 1);
        probe.raise(Counter::Levels, u64::from(node.level));
        let slot = self.leaves.insert(node);
        self.queue.push(label, Event::window(h, slot));
        probe.raise(Counter::PeakWindows, self.leaves.len() as u64);
        probe.raise(Counter::QueuePeak, self.queue.len() as u64);
    }

    /// The third test of the filter, from the vertex that the window passed on its way to `h`.
    fn is_beaten_from_behind(&self, h: HalfEdgeId, w: &Window, side: Side) -> bool {
        let Some(twin) = self.faces.twin(h) else {
            return false;
        };
        let [_, _, vertex] = self.faces.corners(twin);
        let end = match side {
            Side::Left => w.b0,
            Side::Right => w.b1,
        };
        is_beaten_across(
            w,
            end,
            self.faces.apex_below(twin),
            self.distances[vertex.index()],
        )
    }

    /// Whether the window of `node` cannot matter any more, since its root was reached by a
    /// shorter path or a better window took the angle above it.
    fn is_stale(&self, node: &Node) -> bool {
        self.stamps[node.root.index()] != node.root_stamp
            || node
                .guard
                .is_some_and(|guard| self.angles.cuts_off(&guard, self.faces.length(guard.angle)))
    }

    /// Takes a window across the face of `h`.
    fn cross<P: Probe>(&mut self, h: HalfEdgeId, node: &Node, probe: &mut P) {
        probe.enter(Phase::Propagation);
        probe.add(Counter::Parents, 1);
        let w = &node.window;
        let frame = self.faces.frame(h);
        let [_, _, apex] = self.faces.corners(h);
        let sp = separating_abscissa(&frame, w);
        let d = apex_distance(&frame, w, sp);
        self.offer(apex, d, probe);
        let (mut try_left, mut try_right) = (true, true);
        let mut guards = [node.guard; 2];
        if w.b0 < sp && sp < w.b1 {
            probe.enter(Phase::Pruning);
            match self.angles.split(h, d, sp, frame.l) {
                Split::Occupies { stamp } => {
                    guards = [Side::Left, Side::Right].map(|side| {
                        Some(Guard {
                            angle: h,
                            stamp,
                            entry: sp,
                            side,
                        })
                    });
                }
                Split::Ties => {}
                Split::Only(Side::Left) => try_right = false,
                Split::Only(Side::Right) => try_left = false,
            }
            probe.enter(Phase::Propagation);
        }
        let [to_left, to_right] = self.faces.exits(h);
        let level = node.level + 1;
        if let Some(target) = to_left.filter(|_| try_left) {
            probe.add(Counter::Propagated, 1);
            if let Some(window) = left_child(&frame, w, sp, w.b1.min(sp)) {
                let child = Node {
                    window,
                    level,
                    guard: guards[0],
                    ..*node
                };
                self.arrive(target, child, Some(Side::Left), probe);
            }
            probe.enter(Phase::Propagation);
        }
        if let Some(target) = to_right.filter(|_| try_right) {
            probe.add(Counter::Propagated, 1);
            if let Some(window) = right_child(&frame, w, sp, w.b0.max(sp)) {
                let child = Node {
                    window,
                    level,
                    guard: guards[1],
                    ..*node
                };
                self.arrive(target, child, Some(Side::Right), probe);
            }
        }
        probe.enter(Phase::Management);
    }
}

impl<Q: Discipline<Event>> Propagate for Ich<'_, Q> {
    const COUNTERS: &'static [Counter] = &[
        Counter::Propagated,
        Counter::Parents,
        Counter::Children,
        Counter::Kept,
        Counter::Spawned,
        Counter::Filtered,
        Counter::PeakWindows,
        Counter::WindowBytes,
        Counter::QueuePushes,
        Counter::QueuePeak,
        Counter::Levels,
        Counter::PseudoSources,
    ];

    fn mesh(&self) -> &Mesh {
        self.mesh
    }

    fn propagate<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) -> Solution {
        self.reset();
        probe.add(Counter::WindowBytes, size_of::<Node>() as u64);
        for s in sources {
            self.distances[s.index()] = 0.0;
        }
        for &s in sources {
            self.spawn(s, probe);
        }
        while let Some((label, event)) = self.queue.pop() {
            match event.kind() {
                EventKind::Vertex(v) => {
                    // A vertex is queued anew whenever it improves; older entries are void.
                    if self.distances[v.index()] == label {
                        self.spawn(v, probe);
                    }
                }
                EventKind::Window(h, slot) => {
                    let node = self.leaves.remove(slot);
                    if self.is_stale(&node) {
                        probe.add(Counter::Filtered, 1);
                    } else {
                        self.cross(h, &node, probe);
                    }
                }
            }
        }
        Solution::new(std::mem::take(&mut self.distances))
    }
}
