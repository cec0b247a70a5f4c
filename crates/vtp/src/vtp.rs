//! The main loop.

use std::collections::VecDeque;

use geobench_mesh::{HalfEdgeId, Mesh, VertexId};
use geobench_window::queue::MinHeap;
use geobench_window::{
    Counter, Faces, Frame, Phase, Probe, Propagate, Solution, Window, apex_distance,
    is_beaten_from_ends, left_child, right_child, separating_abscissa, spawn_window,
};

use crate::lists::{Arrival, WindowLists};
use crate::pairs::{Edge, push_checked};
use crate::sides::BestPath;

/// [`BestPath::slack`] as a fraction of the half-edge.
const SLACK: f64 = 1e-12;

/// VTP on one mesh: order-free secondary merges, rules 1, 2 and 3 on every list.
#[derive(Clone, Debug)]
pub struct Vtp<'m> {
    mesh: &'m Mesh,
    faces: Faces,
    /// Vertices by distance. An entry is void once its vertex has improved.
    front: MinHeap<VertexId>,
    lists: WindowLists,
    /// Half-edges whose lists are about to cross a face of the traversed area.
    ready: VecDeque<HalfEdgeId>,
    is_ready: Vec<bool>,
    /// For each face the step in which it joined the traversed area; 0 if it has not.
    joined: Vec<u32>,
    step: u32,
    /// Vertices whose turn has come.
    passed: Vec<bool>,
    distances: Vec<f64>,
    arrived: Vec<Window>,
    checked: Vec<Window>,
    separations: Vec<f64>,
}

impl<'m> Vtp<'m> {
    /// Sets up for `mesh`; O(faces).
    pub fn new(mesh: &'m Mesh) -> Self {
        Self {
            mesh,
            faces: Faces::new(mesh),
            front: MinHeap::default(),
            lists: WindowLists::new(mesh.half_edge_count()),
            ready: VecDeque::new(),
            is_ready: vec![false; mesh.half_edge_count()],
            joined: Vec::new(),
            step: 0,
            passed: Vec::new(),
            distances: Vec::new(),
            arrived: Vec::new(),
            checked: Vec::new(),
            separations: Vec::new(),
        }
    }

    /// Every list and queue is empty after a run, so there is only what the run has learnt.
    fn reset(&mut self) {
        self.joined.clear();
        self.joined.resize(self.mesh.face_count(), 0);
        self.step = 0;
        self.passed.clear();
        self.passed.resize(self.mesh.vertex_count(), false);
        self.distances.clear();
        self.distances
            .resize(self.mesh.vertex_count(), f64::INFINITY);
    }

    /// A path of length `d` reaches `v`. A vertex that has had its turn gets another one only if
    /// windows start from it.
    fn offer<P: Probe>(&mut self, v: VertexId, d: f64, probe: &mut P) {
        let known = &mut self.distances[v.index()];
        if d < *known {
            *known = d;
            if !self.passed[v.index()] || self.mesh.is_pseudo_source(v) {
                self.front.push(d, v);
                probe.add(Counter::QueuePushes, 1);
                probe.raise(Counter::QueuePeak, self.front.len() as u64);
            }
        }
    }

    /// The turn of vertex `v`: the faces around it join the traversed area, and it sends out
    /// windows if it is a source or pseudo-source.
    fn pass<P: Probe>(&mut self, v: VertexId, starts: bool, probe: &mut P) {
        self.step += 1;
        self.passed[v.index()] = true;
        let mesh = self.mesh;
        for &h in mesh.outgoing(v) {
            let face = h.face();
            if self.joined[face.index()] == 0 {
                self.joined[face.index()] = self.step;
                for corner in 0..3 {
                    self.make_ready(face.half_edge(corner));
                }
            }
        }
        if starts {
            probe.add(Counter::PseudoSources, 1);
            let sigma = self.distances[v.index()];
            for (neighbour, length) in mesh.neighbours(v) {
                self.offer(neighbour, sigma + length, probe);
            }
            for &h in mesh.outgoing(v) {
                if let Some((target, window)) = spawn_window(&self.faces, h, sigma) {
                    probe.add(Counter::Spawned, 1);
                    self.lists.push(target, Arrival::AsRightChild, window);
                    self.make_ready(target);
                }
            }
            probe.raise(Counter::PeakWindows, self.lists.waiting() as u64);
        }
    }

    /// Queues the list on `h` if it has windows and its face is in the traversed area.
    #[inline]
    fn make_ready(&mut self, h: HalfEdgeId) {
        if self.joined[h.face().index()] != 0
            && !self.is_ready[h.index()]
            && !self.lists.is_empty(h)
        {
            self.is_ready[h.index()] = true;
            self.ready.push_back(h);
        }
    }

    /// Takes the list on `h` across its face.
    fn cross<P: Probe>(&mut self, h: HalfEdgeId, probe: &mut P) {
        self.is_ready[h.index()] = false;
        self.arrived.clear();
        self.lists.take(h, &mut self.arrived);
        let frame = self.faces.frame(h);
        let [tail, head, apex] = self.faces.corners(h);
        probe.enter(Phase::Pruning);
        self.prune(h, frame.l, tail, head, probe);
        probe.enter(Phase::Propagation);
        let parents = self.checked.len() as u64;
        probe.add(Counter::Parents, parents);
        if probe.wants_sample(parents) {
            probe.sample(
                self.lists
                    .windows()
                    .chain(&self.checked)
                    .map(Window::min_distance),
            );
        }
        if let Some(best) = self.best_path(&frame) {
            self.offer(apex, best.distance, probe);
            self.send_children(h, &frame, &best, probe);
        }
        probe.enter(Phase::Management);
        probe.raise(Counter::PeakWindows, self.lists.waiting() as u64);
        for target in self.faces.exits(h).into_iter().flatten() {
            self.make_ready(target);
        }
    }

    /// Leaves in `checked` what the vertex filter and rules 2 and 3 leave of the windows that
    /// arrived at `h`.
    fn prune<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        l: f64,
        tail: VertexId,
        head: VertexId,
        probe: &mut P,
    ) {
        self.checked.clear();
        let (d0, d1) = (self.distances[tail.index()], self.distances[head.index()]);
        let behind = self
            .faces
            .twin(h)
            .map_or([0.0, f64::NEG_INFINITY], |g| self.faces.apex_below(g));
        let edge = Edge { l, behind };
        let mut dropped = 0;
        for w in &self.arrived {
            if is_beaten_from_ends(w, l, d0, d1) {
                dropped += 1;
            } else {
                dropped += push_checked(&mut self.checked, *w, &edge);
            }
        }
        probe.add(Counter::Filtered, dropped);
        // Only windows that start from the vertex behind the edge have their source there.
        let children = self.checked.iter().filter(|w| w.source() != behind).count();
        probe.add(Counter::Kept, children as u64);
    }

    /// The shortest path of the checked windows to the apex; notes their separating abscissae.
    fn best_path(&mut self, frame: &Frame) -> Option<BestPath> {
        self.separations.clear();
        let mut best: Option<(f64, usize)> = None;
        for (i, w) in self.checked.iter().enumerate() {
            let sp = separating_abscissa(frame, w);
            self.separations.push(sp);
            let d = apex_distance(frame, w, sp);
            if best.is_none_or(|(least, _)| d < least) {
                best = Some((d, i));
            }
        }
        best.map(|(distance, i)| {
            let w = &self.checked[i];
            let entry = self.separations[i].max(w.b0).min(w.b1);
            BestPath {
                distance,
                entry,
                source: [w.px, w.py],
                slack: SLACK * frame.l,
            }
        })
    }

    /// Sends the checked windows on, each to the sides that rule 1 leaves it.
    fn send_children<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        frame: &Frame,
        best: &BestPath,
        probe: &mut P,
    ) {
        let [to_left, to_right] = self.faces.exits(h);
        let (mut tried, mut children) = (0, 0);
        for (w, &sp) in self.checked.iter().zip(&self.separations) {
            let sides = best.sides(w, sp);
            if let Some((target, limit)) = to_left.zip(sides.left) {
                tried += 1;
                if let Some(child) = left_child(frame, w, sp, limit) {
                    children += 1;
                    self.lists.push(target, Arrival::AsLeftChild, child);
                }
            }
            if let Some((target, limit)) = to_right.zip(sides.right) {
                tried += 1;
                if let Some(child) = right_child(frame, w, sp, limit) {
                    children += 1;
                    self.lists.push(target, Arrival::AsRightChild, child);
                }
            }
        }
        probe.add(Counter::Propagated, tried);
        probe.add(Counter::Children, children);
        let prime = self.joined[h.face().index()] == self.step;
        probe.add(
            if prime {
                Counter::Prime
            } else {
                Counter::Secondary
            },
            tried,
        );
    }
}

impl Propagate for Vtp<'_> {
    fn counters() -> Vec<Counter> {
        vec![
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
            Counter::PseudoSources,
            Counter::Prime,
            Counter::Secondary,
        ]
    }

    fn mesh(&self) -> &Mesh {
        self.mesh
    }

    fn propagate<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) -> Solution {
        self.reset();
        probe.add(Counter::WindowBytes, size_of::<Window>() as u64);
        for s in sources {
            self.distances[s.index()] = 0.0;
        }
        for &s in sources {
            self.pass(s, true, probe);
        }
        loop {
            while let Some(h) = self.ready.pop_front() {
                self.cross(h, probe);
            }
            let Some((d, v)) = self.front.pop() else {
                break;
            };
            if d == self.distances[v.index()] {
                self.pass(v, self.mesh.is_pseudo_source(v), probe);
            }
        }
        Solution::new(std::mem::take(&mut self.distances))
    }
}
