//! The main loop.

use geobench_mesh::{HalfEdgeId, Mesh, VertexId};
use geobench_window::queue::{Discipline, Event, EventKind, Heap};
use geobench_window::{
    Counter, Faces, Phase, Probe, Propagate, Solution, Window, apex_distance, left_child,
    right_child, separating_abscissa, spawn_window,
};

use crate::list::{Inserter, WindowList};

/// MMP on one mesh, under the discipline `Q`: a priority queue for MMP itself.
#[derive(Clone, Debug)]
pub struct Mmp<'m, Q = Heap<Event>> {
    mesh: &'m Mesh,
    faces: Faces,
    queue: Q,
    /// The windows about to enter the face of each half-edge.
    lists: Vec<WindowList>,
    inserter: Inserter,
    distances: Vec<f64>,
    stored: usize,
}

impl<'m, Q: Discipline<Event>> Mmp<'m, Q> {
    /// Sets up for `mesh`; O(faces).
    pub fn new(mesh: &'m Mesh) -> Self {
        Self {
            mesh,
            faces: Faces::new(mesh),
            queue: Q::default(),
            lists: vec![WindowList::default(); mesh.half_edge_count()],
            inserter: Inserter::default(),
            distances: Vec::new(),
            stored: 0,
        }
    }

    fn reset(&mut self) {
        self.queue.clear();
        self.lists.iter_mut().for_each(WindowList::clear);
        self.distances.clear();
        self.distances
            .resize(self.mesh.vertex_count(), f64::INFINITY);
        self.stored = 0;
    }

    /// A path of length `d` reaches `v`.
    fn offer<P: Probe>(&mut self, v: VertexId, d: f64, probe: &mut P) {
        let known = &mut self.distances[v.index()];
        if d < *known {
            *known = d;
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
        let mesh = self.mesh;
        for (neighbour, length) in mesh.neighbours(v) {
            self.offer(neighbour, sigma + length, probe);
        }
        for &h in mesh.outgoing(v) {
            if let Some((target, window)) = spawn_window(&self.faces, h, sigma) {
                probe.add(Counter::Spawned, 1);
                self.arrive(target, &window, probe);
            }
        }
    }

    /// A window reaches half-edge `h`: it is stored where it is shorter than those before it.
    /// Returns whether anything is left of it.
    fn arrive<P: Probe>(&mut self, h: HalfEdgeId, window: &Window, probe: &mut P) -> bool {
        probe.enter(Phase::Pruning);
        let inserter = &mut self.inserter;
        let list = &mut self.lists[h.index()];
        let before = list.len();
        inserter.insert(list, window, self.faces.length(h));
        probe.enter(Phase::Management);
        self.stored = self.stored + list.len() - before;
        for &(label, id) in &inserter.to_queue {
            self.queue.push(label, Event::window(h, id));
        }
        let kept = inserter.new_pieces > 0;
        let pushes = inserter.to_queue.len();
        probe.add(Counter::QueuePushes, pushes as u64);
        probe.add(Counter::Reinserted, (pushes - inserter.new_pieces) as u64);
        probe.add(Counter::Trimmed, inserter.trimmed as u64);
        probe.add(
            Counter::Filtered,
            inserter.removed as u64 + u64::from(!kept),
        );
        probe.raise(Counter::QueuePeak, self.queue.len() as u64);
        probe.raise(Counter::PeakWindows, self.stored as u64);
        kept
    }

    /// Takes a window across the face of `h`.
    fn cross<P: Probe>(&mut self, h: HalfEdgeId, w: &Window, probe: &mut P) {
        probe.enter(Phase::Propagation);
        probe.add(Counter::Parents, 1);
        let frame = self.faces.frame(h);
        let [_, _, apex] = self.faces.corners(h);
        let sp = separating_abscissa(&frame, w);
        self.offer(apex, apex_distance(&frame, w, sp), probe);
        let [to_left, to_right] = self.faces.exits(h);
        // Going round the triangle from the left, a window that ends on the left exit is done.
        let left = to_left.zip(left_child(&frame, w, sp, w.b1.min(sp)));
        probe.add(Counter::Propagated, u64::from(to_left.is_some()));
        let reaches_right = w.b1 > sp;
        let right = to_right.filter(|_| reaches_right);
        probe.add(Counter::Propagated, u64::from(right.is_some()));
        let right = right.zip(right_child(&frame, w, sp, w.b0.max(sp)));
        for (target, child) in left.into_iter().chain(right) {
            probe.add(Counter::Children, 1);
            let kept = self.arrive(target, &child, probe);
            probe.add(Counter::Kept, u64::from(kept));
        }
    }
}

impl<Q: Discipline<Event>> Propagate for Mmp<'_, Q> {
    const COUNTERS: &'static [Counter] = &[
        Counter::Propagated,
        Counter::Parents,
        Counter::Children,
        Counter::Kept,
        Counter::Spawned,
        Counter::Reinserted,
        Counter::Trimmed,
        Counter::Filtered,
        Counter::PeakWindows,
        Counter::StoredWindows,
        Counter::WindowBytes,
        Counter::QueuePushes,
        Counter::QueuePeak,
        Counter::PseudoSources,
    ];

    fn mesh(&self) -> &Mesh {
        self.mesh
    }

    fn propagate<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) -> Solution {
        self.reset();
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
                EventKind::Window(h, id) => {
                    if let Some(window) = self.lists[h.index()].take(id) {
                        self.cross(h, &window, probe);
                    }
                }
            }
        }
        probe.add(Counter::WindowBytes, WindowList::WINDOW_BYTES as u64);
        probe.add(Counter::StoredWindows, self.stored as u64);
        Solution::new(std::mem::take(&mut self.distances))
    }
}
