//! The main loop.

use std::marker::PhantomData;

use geobench_mesh::{HalfEdgeId, Mesh, VertexId};
use geobench_window::{
    Counter, Faces, Frame, Phase, Probe, Propagate, Solution, Window, apex_distance,
    is_beaten_from_ends, left_child, right_child, separating_abscissa, spawn_window,
};

use crate::area::Area;
use crate::exits::{Crossing, Exits};
use crate::lists::{Arrival, WindowLists};
use crate::merge::Merge;
use crate::pairs::Edge;
use crate::pruning::Pairs;
use crate::schedule::{Schedule, Turn};
use crate::sides::BestPath;

/// An algorithm that propagates whole lists of windows, on one mesh: in the order of schedule `S`,
/// with lists merged by `M`, their windows compared by `P` and sent on by `E`.
#[derive(Clone, Debug)]
pub struct ListPropagation<'m, S, M, P, E> {
    mesh: &'m Mesh,
    faces: Faces,
    schedule: S,
    area: Area,
    lists: WindowLists,
    exits: E,
    /// Vertices whose turn has come.
    passed: Vec<bool>,
    distances: Vec<f64>,
    arrived: Vec<Window>,
    checked: Vec<Window>,
    separations: Vec<f64>,
    /// Children narrower than this are dropped.
    threshold: f64,
    choices: PhantomData<(M, P)>,
}

/// A half-edge through which a list leaves the face that it crosses.
#[derive(Clone, Copy, Debug)]
struct Exit {
    /// The half-edge of the neighbour.
    target: HalfEdgeId,
    arrival: Arrival,
    /// Whether the windows join a list that has waited since an earlier step.
    secondary: bool,
    /// The neighbour, if the schedule must know of windows that wait for it.
    neighbour: Option<Frame>,
    /// The shortest path through the windows sent to the far vertex of the neighbour.
    offer: f64,
}

impl Exit {
    /// Puts `window` where it waits next.
    #[inline]
    fn send<M: Merge>(&mut self, window: Window, lists: &mut WindowLists) {
        if let Some(frame) = &self.neighbour {
            let sp = separating_abscissa(frame, &window);
            self.offer = self.offer.min(apex_distance(frame, &window, sp));
        }
        if self.secondary {
            M::add(lists, self.target, self.arrival, window);
        } else {
            lists.push(self.target, self.arrival, window);
        }
    }
}

impl<'m, S: Schedule, M: Merge, P: Pairs, E: Exits> ListPropagation<'m, S, M, P, E> {
    /// Sets up for `mesh`; O(faces).
    pub fn new(mesh: &'m Mesh) -> Self {
        Self {
            mesh,
            faces: Faces::new(mesh),
            schedule: S::new(mesh),
            area: Area::new(mesh),
            lists: WindowLists::new(mesh.half_edge_count()),
            exits: E::new(mesh),
            passed: Vec::new(),
            distances: Vec::new(),
            arrived: Vec::new(),
            checked: Vec::new(),
            separations: Vec::new(),
            threshold: 0.0,
            choices: PhantomData,
        }
    }

    /// Drops windows whose interval is narrower than `width`, in the units of the mesh, when they
    /// come out of a triangle. The paper does so at a millionth of the model's size; distances are
    /// then no longer exact.
    #[must_use]
    pub fn with_threshold(self, width: f64) -> Self {
        Self {
            threshold: width,
            ..self
        }
    }

    /// Every list and queue is empty after a run, so there is only what the run has learnt.
    fn reset(&mut self) {
        self.schedule.reset();
        self.area.reset();
        self.exits.reset();
        self.passed.clear();
        self.passed.resize(self.mesh.vertex_count(), false);
        self.distances.clear();
        self.distances
            .resize(self.mesh.vertex_count(), f64::INFINITY);
    }

    /// A path of length `d` reaches `v`. If faces join by vertices every vertex has a turn, and
    /// one from which windows start another one whenever it improves; else only the latter do.
    fn offer<B: Probe>(&mut self, v: VertexId, d: f64, probe: &mut B) {
        let known = &mut self.distances[v.index()];
        if d < *known {
            *known = d;
            if (S::BY_VERTEX && !self.passed[v.index()]) || self.mesh.is_pseudo_source(v) {
                self.schedule.push_vertex(v, d, probe);
            }
        }
    }

    /// The turn of vertex `v`: it sends out windows if it is a source or pseudo-source, and the
    /// faces around it may join the traversed area.
    fn pass<B: Probe>(&mut self, v: VertexId, is_source: bool, probe: &mut B) {
        self.area.advance();
        self.passed[v.index()] = true;
        let mesh = self.mesh;
        if S::BY_VERTEX || is_source {
            for &h in mesh.outgoing(v) {
                self.area.join(h.face(), &self.lists);
            }
        }
        if is_source || mesh.is_pseudo_source(v) {
            self.spawn(v, probe);
        }
    }

    /// Sends out paths along the edges of `v` and windows across its faces.
    fn spawn<B: Probe>(&mut self, v: VertexId, probe: &mut B) {
        probe.add(Counter::PseudoSources, 1);
        let sigma = self.distances[v.index()];
        let mesh = self.mesh;
        for (neighbour, length) in mesh.neighbours(v) {
            self.offer(neighbour, sigma + length, probe);
        }
        for &h in mesh.outgoing(v) {
            if let Some((target, window)) = spawn_window(&self.faces, h, sigma) {
                probe.add(Counter::Spawned, 1);
                let mut exit = self.exit(h, target, Arrival::AsRightChild);
                exit.secondary = false;
                exit.send::<M>(window, &mut self.lists);
                self.close(&exit, probe);
            }
        }
        probe.raise(Counter::PeakWindows, self.lists.waiting() as u64);
        probe.raise(Counter::PeakWavefront, self.lists.waiting() as u64);
    }

    /// The way out of the face of `h` to the neighbour of `target`.
    #[inline]
    fn exit(&self, h: HalfEdgeId, target: HalfEdgeId, arrival: Arrival) -> Exit {
        let waits = || !self.area.contains(target.face());
        Exit {
            target,
            arrival,
            secondary: M::PRESERVES_ORDER && waits() && !self.area.is_new(h.face()),
            neighbour: (!S::BY_VERTEX && waits()).then(|| self.faces.frame(target)),
            offer: f64::INFINITY,
        }
    }

    /// All windows for `exit` have been sent.
    #[inline]
    fn close<B: Probe>(&mut self, exit: &Exit, probe: &mut B) {
        if exit.offer < f64::INFINITY {
            self.schedule.wait(exit.target.face(), exit.offer, probe);
        }
        self.area.make_ready(exit.target, &self.lists);
    }

    /// Takes the list on `h` across its face.
    fn cross<B: Probe>(&mut self, h: HalfEdgeId, probe: &mut B) {
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
            self.send_children(h, &frame, best, probe);
        }
        probe.enter(Phase::Management);
        probe.raise(Counter::PeakWindows, self.lists.waiting() as u64);
        probe.raise(Counter::PeakWavefront, self.lists.waiting() as u64);
    }

    /// Leaves in `checked` what the vertex filter and the comparisons leave of the windows that
    /// arrived at `h`.
    fn prune<B: Probe>(
        &mut self,
        h: HalfEdgeId,
        l: f64,
        tail: VertexId,
        head: VertexId,
        probe: &mut B,
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
                dropped += P::push(&mut self.checked, *w, &edge);
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
        best.map(|(_, i)| BestPath::of(frame, &self.checked[i], self.separations[i]))
    }

    /// Sends the checked windows on, each through the exits that are open to it.
    fn send_children<B: Probe>(
        &mut self,
        h: HalfEdgeId,
        frame: &Frame,
        best: BestPath,
        probe: &mut B,
    ) {
        let [to_left, to_right] = self.faces.exits(h);
        let mut left_exit = to_left.map(|target| self.exit(h, target, Arrival::AsLeftChild));
        let mut right_exit = to_right.map(|target| self.exit(h, target, Arrival::AsRightChild));
        self.exits.enter(&Crossing {
            h,
            frame,
            windows: &self.checked,
            separations: &self.separations,
            best,
            lists: &self.lists,
            faces: &self.faces,
        });
        let (mut tried, mut children, mut tiny) = (0, 0, 0);
        for (w, &sp) in self.checked.iter().zip(&self.separations) {
            let sides = self.exits.sides(frame, &best, w, sp);
            if let Some((exit, limit)) = left_exit.as_mut().zip(sides.left) {
                tried += 1;
                if let Some(child) = left_child(frame, w, sp, limit) {
                    children += 1;
                    if child.b1 - child.b0 < self.threshold {
                        tiny += 1;
                    } else {
                        exit.send::<M>(child, &mut self.lists);
                    }
                }
            }
            if let Some((exit, limit)) = right_exit.as_mut().zip(sides.right) {
                tried += 1;
                if let Some(child) = right_child(frame, w, sp, limit) {
                    children += 1;
                    if child.b1 - child.b0 < self.threshold {
                        tiny += 1;
                    } else {
                        exit.send::<M>(child, &mut self.lists);
                    }
                }
            }
        }
        probe.enter(Phase::Management);
        for exit in [left_exit, right_exit].into_iter().flatten() {
            self.close(&exit, probe);
        }
        probe.add(Counter::Propagated, tried);
        probe.add(Counter::Children, children);
        probe.add(Counter::Filtered, tiny);
        let prime = self.area.is_new(h.face());
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

impl<S: Schedule, M: Merge, P: Pairs, E: Exits> Propagate for ListPropagation<'_, S, M, P, E> {
    fn counters() -> Vec<Counter> {
        vec![
            Counter::Propagated,
            Counter::Parents,
            Counter::Children,
            Counter::Kept,
            Counter::Spawned,
            Counter::Filtered,
            Counter::PeakWindows,
            Counter::PeakWavefront,
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

    fn propagate<B: Probe>(&mut self, sources: &[VertexId], probe: &mut B) -> Solution {
        self.reset();
        probe.add(Counter::WindowBytes, size_of::<Window>() as u64);
        for s in sources {
            self.distances[s.index()] = 0.0;
        }
        for &s in sources {
            self.pass(s, true, probe);
        }
        loop {
            while let Some(h) = self.area.next_ready() {
                self.cross(h, probe);
            }
            match self.schedule.pop() {
                // An entry is void once its vertex has improved or its face has joined.
                Some((d, Turn::Vertex(v))) if d == self.distances[v.index()] => {
                    self.pass(v, false, probe);
                }
                Some((_, Turn::Face(f))) if !self.area.contains(f) => {
                    self.area.advance();
                    self.area.join(f, &self.lists);
                }
                Some(_) => {}
                None => break,
            }
        }
        Solution::new(std::mem::take(&mut self.distances))
    }
}
