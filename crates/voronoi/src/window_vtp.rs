//! window-VTP: the traversed area grows vertex by vertex, windows are kept and trimmed on edges,
//! redundant windows are removed.

use std::collections::VecDeque;

use geobench_mesh::{HalfEdgeId, Mesh, Splice, VertexId};
use geobench_window::queue::{Heap, MinHeap};
use geobench_window::{
    CompiledRuns, Counter, Probe, Propagate, Solution, SolveError, VertexFilter, prefetch,
};

use crate::field::{FieldSolver, LabelledField};
use crate::removal::{Removal, Remover};
use crate::store::{Stored, edge_of};
use crate::wave::{ArrivalMode, COUNTERS, WaveState};

/// Options of [`WindowVtp`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowVtpOptions {
    /// Which windows are removed during a run.
    pub removal: Removal,
    /// Whether the vertex filter drops windows that a path through an end of their edge beats,
    /// before they are compared with other windows. The paper has no filter.
    pub filter: VertexFilter,
}

impl Default for WindowVtpOptions {
    fn default() -> Self {
        Self {
            removal: Removal::default(),
            filter: VertexFilter::Off,
        }
    }
}

/// An event of the queue.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum VertexEvent {
    /// The faces around this vertex join the traversed area.
    Join(VertexId),
    /// The same, and the vertex spawns windows.
    Spawn(VertexId),
}

/// window-VTP (Qin, Yu, Zhang 2017): the schedule of VTP, the trimming of MMP over both directions
/// of an edge, and a source for every window.
///
/// The *traversed area* grows by the faces around the vertex at which the nearest window waits.
/// Windows cross the faces of the area, first in, first out, until they reach its border or lose
/// their whole interval to windows that they meet. The windows that wait on one half-edge cross
/// together, and their children enter a list in one pass.
///
/// Time O(n² log n), space O(n²) for n faces.
///
/// ```
/// use geobench_mesh::{Mesh, VertexId};
/// use geobench_voronoi::{FieldSolver, WindowVtp};
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let mut solver = WindowVtp::new(&mesh);
/// let field = solver.field(&[0, 24].map(VertexId::new))?;
/// // Vertices 0 and 24 are opposite corners; vertex 1 is beside the first one.
/// assert_eq!((field.labels()[1], field.labels()[23]), (0, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct WindowVtp {
    wave: WaveState,
    pub(crate) remover: Remover,
    queue: Heap<VertexEvent>,
    /// For each vertex, the least distance of the windows that wait for it; infinite without any.
    keys: Vec<f64>,
    /// Whether each face belongs to the traversed area.
    joined: Vec<bool>,
    /// Half-edges whose windows can cross, first in, first out, and whether each half-edge is among
    /// them.
    ready: VecDeque<HalfEdgeId>,
    is_ready: Vec<bool>,
    batch: Vec<Stored>,
    /// Windows in the area beside thin faces, as half-edge and serial number, by their least
    /// distances. In first-in, first-out order, they would wind around a needle before the windows
    /// that beat them have arrived.
    thin: MinHeap<(HalfEdgeId, u32)>,
}

impl WindowVtp {
    /// Sets up for `mesh` with the default options; O(faces).
    pub fn new(mesh: &Mesh) -> Self {
        Self::with_options(mesh, WindowVtpOptions::default())
    }

    /// Sets up for `mesh` with `options`; O(faces).
    pub fn with_options(mesh: &Mesh, options: WindowVtpOptions) -> Self {
        Self {
            wave: WaveState::new(mesh, options.filter),
            remover: Remover::new(options.removal),
            queue: Heap::default(),
            keys: Vec::new(),
            joined: Vec::new(),
            ready: VecDeque::new(),
            is_ready: vec![false; mesh.half_edge_count()],
            batch: Vec::new(),
            thin: MinHeap::default(),
        }
    }

    fn fill<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) {
        let (vertices, faces) = (self.wave.mesh.vertex_count(), self.wave.mesh.face_count());
        self.remover.reset(faces);
        self.queue.clear();
        self.thin.clear();
        self.keys.clear();
        self.keys.resize(vertices, f64::INFINITY);
        self.joined.clear();
        self.joined.resize(faces, false);
        self.wave
            .start(sources, self.remover.watches_faces(), probe);
        self.wave.improved.clear();
        for &s in sources {
            self.push(0.0, VertexEvent::Spawn(s), probe);
        }
        loop {
            let [next_turn, next_thin] = [self.next_turn(), self.next_thin()];
            let propagated = if next_thin < next_turn {
                self.cross_nearest(probe)
            } else if let Some((d, turn)) = self.queue.pop() {
                self.prefetch_turns();
                match turn {
                    VertexEvent::Join(v) if self.keys[v.index()] == d => {
                        self.keys[v.index()] = f64::INFINITY;
                        self.join(v);
                    }
                    VertexEvent::Spawn(v) if self.wave.distances[v.index()] == d => {
                        self.join(v);
                        self.wave.spawn(v, ArrivalMode::Together, probe);
                        self.receive(probe);
                    }
                    // Outdated: the vertex has had its turn, or its distance has improved since.
                    _ => continue,
                }
                0
            } else {
                break;
            };
            let propagated = propagated + self.cross_ready(probe);
            let next = self.next_turn().min(self.next_thin());
            self.remover.step(&mut self.wave, propagated, next);
        }
        self.remover.step(&mut self.wave, 0, f64::INFINITY);
        self.wave.finish(probe);
    }

    /// Whether the windows of `h` cross in the order of their distances, because `h` is beside a
    /// thin face.
    #[inline]
    fn crosses_by_distance(&self, h: HalfEdgeId) -> bool {
        self.wave.thin.is_beside(h.index())
    }

    /// The distance of the next event of the queue; infinite if the queue is empty.
    fn next_turn(&self) -> f64 {
        self.queue.peek().map_or(f64::INFINITY, |(d, _)| d)
    }

    /// The least distance of the windows beside thin faces that can cross; infinite without any.
    fn next_thin(&self) -> f64 {
        self.thin.peek().map_or(f64::INFINITY, |(d, _)| d)
    }

    fn push<P: Probe>(&mut self, d: f64, turn: VertexEvent, probe: &mut P) {
        self.queue.push(d, turn);
        probe.add(Counter::QueuePushes, 1);
        probe.raise(Counter::QueuePeak, self.queue.len() as u64);
    }

    /// Adds the faces around `v` to the area, and queues the windows that wait for these faces.
    fn join(&mut self, v: VertexId) {
        let mesh = self.wave.mesh.clone();
        for face in mesh.outgoing(v).iter().map(|h| h.face()) {
            if std::mem::replace(&mut self.joined[face.index()], true) {
                continue;
            }
            for h in face.half_edges() {
                if let Some(twin) = self.wave.faces.twin(h) {
                    let (e, is_reversed) = edge_of(h, twin);
                    if self.crosses_by_distance(h) {
                        for stored in self.wave.store.waiting_on(e, is_reversed) {
                            let label = stored.window.min_distance();
                            self.thin.push(label, (h, stored.serial));
                        }
                    } else if self.wave.store.waiting_on(e, is_reversed).next().is_some() {
                        self.make_ready(h);
                    }
                }
            }
        }
    }

    /// Queues the windows of `h` to cross, first in, first out.
    fn make_ready(&mut self, h: HalfEdgeId) {
        if !std::mem::replace(&mut self.is_ready[h.index()], true) {
            self.ready.push_back(h);
            self.wave.faces.announce(h);
        }
    }

    /// Prefetches the data of the next half-edges in `ready`.
    #[inline]
    fn prefetch_ready(&self) {
        if let Some(&h) = self.ready.get(1) {
            self.wave.prefetch_exits(h);
        }
        if let Some(&h) = self.ready.front() {
            self.wave.prefetch_exit_windows(h);
        }
    }

    /// Prefetches the data of the next turns: the faces of the vertices that come soon, and the
    /// lists of the vertex that probably comes next.
    #[inline]
    fn prefetch_turns(&self) {
        let vertex = |(_, turn): (f64, VertexEvent)| match turn {
            VertexEvent::Join(v) | VertexEvent::Spawn(v) => v,
        };
        let mut coming = self.queue.iter().map(vertex);
        let wave = &self.wave;
        if let Some(v) = coming.next() {
            for &h in wave.mesh.outgoing(v) {
                prefetch(&self.joined, h.face().index());
                for h in [h, h.next(), h.prev()] {
                    if let Some(twin) = wave.faces.twin(h) {
                        wave.store.prefetch_list(edge_of(h, twin).0);
                    }
                }
            }
        }
        for v in coming.take(4) {
            for &h in wave.mesh.outgoing(v) {
                wave.faces.announce(h);
            }
        }
    }

    /// Propagates windows across the faces of the area until none can cross. Returns the number of
    /// propagations.
    fn cross_ready<P: Probe>(&mut self, probe: &mut P) -> u64 {
        let mut propagated = 0;
        while let Some(h) = self.ready.pop_front() {
            self.is_ready[h.index()] = false;
            self.prefetch_ready();
            let Some(twin) = self.wave.faces.twin(h) else {
                continue;
            };
            let (e, is_reversed) = edge_of(h, twin);
            let l = self.wave.faces.length(h);
            self.wave.prefetch_exits(h);
            let mut batch = std::mem::take(&mut self.batch);
            batch.clear();
            self.wave.store.take_all(e, is_reversed, l, &mut batch);
            self.wave.prefetch_exit_windows(h);
            propagated += self.wave.cross_all(h, &batch, probe);
            self.wave.sample(batch.len() as u64, probe);
            self.batch = batch;
            self.receive(probe);
        }
        propagated
    }

    /// Propagates the nearest window beside a thin face. Returns the number of propagations.
    #[cold]
    fn cross_nearest<P: Probe>(&mut self, probe: &mut P) -> u64 {
        let Some((label, (h, serial))) = self.thin.pop() else {
            return 0;
        };
        let Some(twin) = self.wave.faces.twin(h) else {
            return 0;
        };
        let (e, is_reversed) = edge_of(h, twin);
        let Some(stored) = self.wave.store.find(e, serial) else {
            return 0;
        };
        let (source, window) = (stored.source(), stored.window);
        let now = window.min_distance();
        if now > label {
            self.thin.push(now, (h, serial));
            return 0;
        }
        self.wave.store.take(e, serial);
        let window = if is_reversed {
            window.reversed(self.wave.faces.length(h))
        } else {
            window
        };
        let propagated = self.wave.cross(h, &window, source, probe);
        self.wave.sample(1, probe);
        self.receive(probe);
        propagated
    }

    /// Queues the windows that have arrived: to cross at once if their face has joined, else to
    /// wait for the vertices of their edge. Queues the vertices whose distance has improved.
    fn receive<P: Probe>(&mut self, probe: &mut P) {
        let mut arrivals = std::mem::take(&mut self.wave.arrivals);
        for arrival in arrivals.drain(..) {
            let h = arrival.h;
            if self.joined[h.face().index()] {
                if self.crosses_by_distance(h) {
                    self.thin.push(arrival.label, (h, arrival.serial));
                } else {
                    self.make_ready(h);
                }
                continue;
            }
            for v in arrival.ends {
                if arrival.label < self.keys[v.index()] {
                    self.keys[v.index()] = arrival.label;
                    self.push(arrival.label, VertexEvent::Join(v), probe);
                }
            }
        }
        self.wave.arrivals = arrivals;
        let mut improved = std::mem::take(&mut self.wave.improved);
        for (d, v) in improved.drain(..) {
            self.push(d, VertexEvent::Spawn(v), probe);
        }
        self.wave.improved = improved;
    }
}

impl FieldSolver for WindowVtp {
    fn field(&mut self, sources: &[VertexId]) -> Result<LabelledField<'_>, SolveError> {
        let sources = self.wave.sources(sources)?;
        self.fill(&sources, &mut ());
        Ok(self.wave.field())
    }
}

impl Propagate for WindowVtp {
    fn counters() -> Vec<Counter> {
        [COUNTERS, &[Counter::QueuePushes, Counter::QueuePeak]].concat()
    }

    fn mesh(&self) -> &Mesh {
        &self.wave.mesh
    }

    fn splice(&mut self, splice: &Splice) -> Option<Splice> {
        let undo = self.wave.splice(splice);
        self.is_ready
            .resize(self.wave.mesh.half_edge_count(), false);
        Some(undo)
    }

    fn refusal(mesh: &Mesh) -> Option<SolveError> {
        SolveError::diagram_at_junctions(mesh)
    }

    #[inline(never)]
    fn runs(&self) -> CompiledRuns<Self> {
        CompiledRuns::new()
    }

    fn propagate<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) -> Solution {
        self.fill(sources, probe);
        Solution::new(self.wave.distances.clone())
    }
}
