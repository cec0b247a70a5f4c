//! The algorithm of Liu, Chen and Tang: MMP from all sources at once, with all windows kept.

use geobench_mesh::{Mesh, Splice, VertexId};
use geobench_window::queue::{Discipline, Event, EventKind, HeapQueue};
use geobench_window::{
    CompiledRuns, Counter, Probe, Propagate, Solution, SolveError, VertexFilter,
};

use crate::field::{FieldSolver, LabelledField};
use crate::store::edge_of;
use crate::wave::{ArrivalMode, COUNTERS, WaveState};

/// MMP from several sources (Liu, Chen, Tang 2011). Windows cross one by one, in the order of the
/// discipline `Q`. All windows that trimming leaves stay on their edges until the end.
///
/// Windows of both directions of an edge are trimmed together, as in
/// [`WindowVtp`](crate::WindowVtp). So both algorithms leave the same windows at the borders of
/// cells.
///
/// Time O(n² log n), space O(n²) for n faces.
///
/// ```
/// use geobench_mesh::{Mesh, VertexId};
/// use geobench_voronoi::{FieldSolver, Lct11};
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let mut solver = Lct11::new(&mesh);
/// let field = solver.field(&[0, 24].map(VertexId::new))?;
/// // Vertices 0 and 24 are opposite corners; vertex 1 is beside the first one.
/// assert_eq!((field.labels()[1], field.labels()[23]), (0, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Lct11<Q = HeapQueue> {
    runs: CompiledRuns<Self>,
    wave: WaveState,
    queue: Q,
}

impl Lct11 {
    /// Sets up for `mesh`, with the nearest window first and without the vertex filter; O(faces).
    pub fn new(mesh: &Mesh) -> Self {
        Self::in_order(mesh, HeapQueue::default(), VertexFilter::Off)
    }
}

impl<Q: Discipline> Lct11<Q> {
    /// Sets up for `mesh`, in the order of `queue` and with or without the vertex filter; O(faces).
    pub fn in_order(mesh: &Mesh, queue: Q, filter: VertexFilter) -> Self {
        Self {
            runs: CompiledRuns::new(),
            wave: WaveState::new(mesh, filter),
            queue,
        }
    }

    fn fill<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) {
        self.queue.clear();
        self.wave.start(sources, false, probe);
        self.wave.improved.clear();
        for &s in sources {
            self.queue.start(s);
            self.wave.spawn(s, ArrivalMode::OneByOne, probe);
            self.receive(probe);
        }
        while let Some((label, event)) = self.queue.pop(probe) {
            match event.kind() {
                EventKind::Vertex(v) => {
                    if self.wave.distances[v.index()] == label {
                        self.wave.spawn(v, ArrivalMode::OneByOne, probe);
                    }
                }
                EventKind::Window(h, serial) => {
                    let Some(twin) = self.wave.faces.twin(h) else {
                        continue;
                    };
                    let (e, is_reversed) = edge_of(h, twin);
                    let Some(stored) = self.wave.store.find(e, serial) else {
                        continue;
                    };
                    let (source, window) = (stored.source(), stored.window);
                    let now = window.min_distance();
                    if now > label && !self.queue.is_due(now) {
                        self.queue.push(now, event, probe);
                        continue;
                    }
                    self.wave.store.take(e, serial);
                    let window = if is_reversed {
                        window.reversed(self.wave.faces.length(h))
                    } else {
                        window
                    };
                    let tries = self.wave.cross(h, &window, source, probe);
                    self.queue.crossed(h, tries, probe);
                    self.wave.sample(1, probe);
                }
            }
            self.receive(probe);
        }
        self.wave.finish(probe);
    }

    /// Queues the windows that have arrived and the vertices whose distance has improved.
    fn receive<P: Probe>(&mut self, probe: &mut P) {
        let mut arrivals = std::mem::take(&mut self.wave.arrivals);
        for arrival in arrivals.drain(..) {
            let event = Event::window(arrival.h, arrival.serial);
            self.queue.push(arrival.label, event, probe);
        }
        self.wave.arrivals = arrivals;
        let mut improved = std::mem::take(&mut self.wave.improved);
        for (d, v) in improved.drain(..) {
            self.queue.push(d, Event::vertex(v), probe);
        }
        self.wave.improved = improved;
    }
}

impl<Q: Discipline> FieldSolver for Lct11<Q> {
    fn field(&mut self, sources: &[VertexId]) -> Result<LabelledField<'_>, SolveError> {
        let sources = self.wave.sources(sources)?;
        self.fill(&sources, &mut ());
        Ok(self.wave.field())
    }
}

impl<Q: Discipline> Propagate for Lct11<Q> {
    fn counters() -> Vec<Counter> {
        [COUNTERS, Q::COUNTERS].concat()
    }

    fn mesh(&self) -> &Mesh {
        &self.wave.mesh
    }

    fn splice(&mut self, splice: &Splice) -> Option<Splice> {
        let undo = self.wave.splice(splice);
        self.queue.splice(&self.wave.mesh, splice);
        Some(undo)
    }

    fn refusal(mesh: &Mesh) -> Option<SolveError> {
        SolveError::diagram_at_junctions(mesh)
    }

    fn runs(&self) -> CompiledRuns<Self> {
        self.runs
    }

    fn propagate<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) -> Solution {
        self.fill(sources, probe);
        Solution::new(self.wave.distances.clone())
    }
}
