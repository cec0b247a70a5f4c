//! What all algorithms of this crate share: windows with sources that cross faces and are trimmed
//! on edges.

use geobench_mesh::{HalfEdgeId, Mesh, VertexId};
use geobench_window::trimming::ThinFaces;
use geobench_window::{
    Counter, Crossing, Faces, Frame, Phase, Probe, Side, VertexFilter, Way, Window,
    is_beaten_from_ends, length_past_end, spawn_window,
};

use crate::field::{Field, NO_SOURCE};
use crate::store::{EdgeWindows, edge_of};

/// The counters of every algorithm of this crate.
pub(crate) const COUNTERS: &[Counter] = &[
    Counter::Propagated,
    Counter::Parents,
    Counter::Children,
    Counter::Kept,
    Counter::Spawned,
    Counter::Reinserted,
    Counter::Trimmed,
    Counter::Filtered,
    Counter::PeakWindows,
    Counter::PeakWavefront,
    Counter::StoredWindows,
    Counter::WindowBytes,
    Counter::PseudoSources,
];

/// A window that has come to wait.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arrival {
    pub(crate) h: HalfEdgeId,
    /// Its least distance.
    pub(crate) label: f64,
    pub(crate) serial: u32,
}

/// The surface during a run, with all that is known of it. What a schedule has to know is left in
/// [`arrivals`](Self::arrivals) and [`improved`](Self::improved) for it to take.
#[derive(Clone, Debug)]
pub(crate) struct Wave {
    pub(crate) mesh: Mesh,
    pub(crate) faces: Faces,
    pub(crate) thin: ThinFaces,
    filter: VertexFilter,
    pub(crate) distances: Vec<f64>,
    pub(crate) labels: Vec<u32>,
    /// The distance at which each vertex last sent out windows; infinite if it has not.
    spawned: Vec<f64>,
    pub(crate) store: EdgeWindows,
    /// For each face a length within which one of its points is reached; empty if not asked for.
    pub(crate) nearest: Vec<f64>,
    /// Faces that have been reached for the first time.
    pub(crate) reached: Vec<u32>,
    pub(crate) arrivals: Vec<Arrival>,
    /// Vertices at which paths may turn and whose distance has improved.
    pub(crate) improved: Vec<(f64, VertexId)>,
}

impl Wave {
    pub(crate) fn new(mesh: &Mesh, filter: VertexFilter) -> Self {
        let half_edges = mesh.half_edge_count();
        Self {
            mesh: mesh.clone(),
            faces: Faces::new(mesh),
            thin: ThinFaces::of(mesh, half_edges, HalfEdgeId::index),
            filter,
            distances: Vec::new(),
            labels: Vec::new(),
            spawned: Vec::new(),
            store: EdgeWindows::new(half_edges),
            nearest: Vec::new(),
            reached: Vec::new(),
            arrivals: Vec::new(),
            improved: Vec::new(),
        }
    }

    /// Forgets the last run and starts one: the sources are reached, and still have to
    /// [spawn](Self::spawn).
    pub(crate) fn start<P: Probe>(
        &mut self,
        sources: &[VertexId],
        watches_faces: bool,
        probe: &mut P,
    ) {
        let vertices = self.mesh.vertex_count();
        for list in [&mut self.distances, &mut self.spawned] {
            list.clear();
            list.resize(vertices, f64::INFINITY);
        }
        self.labels.clear();
        self.labels.resize(vertices, NO_SOURCE);
        self.nearest.clear();
        if watches_faces {
            self.nearest.resize(self.mesh.face_count(), f64::INFINITY);
        }
        self.reached.clear();
        self.arrivals.clear();
        self.improved.clear();
        self.store.clear();
        probe.add(Counter::WindowBytes, EdgeWindows::WINDOW_BYTES as u64);
        for (source, &v) in (0..).zip(sources) {
            self.offer(v, 0.0, source);
        }
    }

    /// What the run has found.
    pub(crate) fn field(&self) -> Field<'_> {
        Field {
            mesh: &self.mesh,
            distances: &self.distances,
            labels: &self.labels,
            store: &self.store,
        }
    }

    /// A path of length `d` from `source` reaches `v`. Returns whether it is the shortest so far.
    ///
    /// Of two sources that are equally far the lesser one is taken, as long as `v` has not sent out
    /// windows: behind a saddle that is equidistant to both, all is the one's or the other's.
    #[inline]
    fn offer(&mut self, v: VertexId, d: f64, source: u32) -> bool {
        let i = v.index();
        let improves = d < self.distances[i];
        if improves {
            self.distances[i] = d;
            self.labels[i] = source;
            if self.mesh.is_pseudo_source(v) {
                self.improved.push((d, v));
            }
        } else if d == self.distances[i] && source < self.labels[i] && self.spawned[i] != d {
            self.labels[i] = source;
        }
        improves
    }

    /// One of the points of face `f` is reached within `d`.
    #[inline]
    fn reach(&mut self, f: usize, d: f64) {
        if let Some(nearest) = self.nearest.get_mut(f)
            && d < *nearest
        {
            if *nearest == f64::INFINITY {
                self.reached.push(f as u32);
            }
            *nearest = d;
        }
    }

    /// Sends out paths along the edges of `v` and windows across its faces, unless it has done so
    /// at this distance.
    pub(crate) fn spawn<P: Probe>(&mut self, v: VertexId, probe: &mut P) {
        let sigma = self.distances[v.index()];
        if self.spawned[v.index()] == sigma {
            return;
        }
        self.spawned[v.index()] = sigma;
        let source = self.labels[v.index()];
        probe.add(Counter::PseudoSources, 1);
        let mesh = self.mesh.clone();
        for &h in mesh.outgoing(v) {
            self.reach(h.face().index(), sigma);
            for path in self.faces.edge_paths(h) {
                if self.offer(path.end, sigma + path.length, source) && P::TRACES {
                    probe.reach(path.end, path.corner, path.way);
                }
            }
            if let Some((target, window)) = spawn_window(&self.faces, h, sigma) {
                probe.add(Counter::Spawned, 1);
                self.arrive(target, &window, source, probe);
            }
        }
    }

    /// A window of `source` arrives at `h`. Returns whether anything of it is left.
    #[inline]
    fn arrive<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        window: &Window,
        source: u32,
        probe: &mut P,
    ) -> bool {
        let Some(twin) = self.faces.twin(h) else {
            return false;
        };
        let (e, is_reversed) = edge_of(h, twin);
        let l = self.faces.length(h);
        // No paper of this family has a filter. Without one, windows wind around needles in any
        // order but nearest first.
        let filters = self.filter == VertexFilter::On || self.thin.is_beside(h.index());
        if self.store.is_closed(e) || filters && self.is_beaten(h, window, l) {
            probe.add(Counter::Filtered, 1);
            return false;
        }
        let window = if is_reversed {
            window.reversed(l)
        } else {
            *window
        };
        self.store.insert(e, &window, is_reversed, source, l);
        let mut least = f64::INFINITY;
        for waiting in &self.store.changes.waiting {
            least = if waiting.is_reversed == is_reversed {
                least.min(waiting.label)
            } else {
                least
            };
            self.arrivals.push(Arrival {
                h: if waiting.is_reversed == is_reversed {
                    h
                } else {
                    twin
                },
                label: waiting.label,
                serial: waiting.serial,
            });
        }
        let changes = &self.store.changes;
        let is_kept = changes.new_parts > 0;
        probe.add(
            Counter::Reinserted,
            (changes.waiting.len() - changes.new_parts) as u64,
        );
        probe.add(Counter::Trimmed, changes.trimmed as u64);
        let dropped = changes.removed + usize::from(!is_kept);
        probe.add(Counter::Filtered, dropped as u64);
        if is_kept {
            self.reach(h.face().index(), least);
            self.reach(twin.face().index(), least);
        }
        is_kept
    }

    /// Whether a path along the edge beats all of `window`.
    #[inline]
    fn is_beaten(&self, h: HalfEdgeId, window: &Window, l: f64) -> bool {
        let [tail, head, _] = self.faces.corners(h);
        let [d0, d1] = [tail, head].map(|v| self.distances[v.index()]);
        is_beaten_from_ends(window, l, d0, d1)
    }

    /// Takes a window of `source`, in the frame of `h`, across the face of `h`. Returns how many
    /// children were tried.
    pub(crate) fn cross<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        window: &Window,
        source: u32,
        probe: &mut P,
    ) -> u64 {
        probe.enter(Phase::Propagation);
        probe.add(Counter::Parents, 1);
        let view = self.faces.face_view(h);
        let [tail, head, apex] = view.corners;
        let ends = [tail, head].map(|v| self.distances[v.index()]);
        let crossing = Crossing::new(&view.frame, window);
        let covers = crossing.covers_apex();
        let mut tries = 0;
        for side in [Side::Left, Side::Right] {
            if !covers && side != crossing.side() {
                continue;
            }
            tries += 1;
            let exit = view.exit(side);
            let (d, child) = match (covers, side) {
                (false, _) => {
                    let d = crossing.bent_distance(&exit);
                    let Frame { l, la, lb, .. } = view.frame;
                    let bend = [window.b1, window.b0][side as usize];
                    let d = length_past_end(d, bend, l, ends, [la, lb]);
                    (d, crossing.only_child(&exit))
                }
                (true, Side::Left) => (crossing.straight_distance(), crossing.left_child(&exit)),
                (true, Side::Right) => (crossing.straight_distance(), crossing.right_child(&exit)),
            };
            if self.offer(apex, d, source) && P::TRACES {
                probe.reach(apex, h.prev(), Way::of(window, &view.frame));
            }
            let Some(child) = child else {
                continue;
            };
            if let Some(target) = exit.half_edge {
                probe.add(Counter::Children, 1);
                probe.enter(Phase::Pruning);
                let kept = self.arrive(target, &child, source, probe);
                probe.enter(Phase::Propagation);
                probe.add(Counter::Kept, u64::from(kept));
            }
        }
        // As MMP: all of a window that leaves on the right is tried on the left, too.
        tries += u64::from(!covers && crossing.side() == Side::Right);
        probe.add(Counter::Propagated, tries);
        probe.enter(Phase::Management);
        probe.raise(Counter::PeakWindows, self.store.stored() as u64);
        probe.raise(Counter::PeakWavefront, self.store.waiting() as u64);
        tries
    }

    /// Takes a sample of the wavefront, if one is due.
    pub(crate) fn sample<P: Probe>(&self, parents: u64, probe: &mut P) {
        if probe.wants_sample(parents) {
            let waiting = self.store.all().filter(|s| s.waits());
            probe.sample(waiting.map(|s| s.window.min_distance()));
        }
    }

    /// The run has ended: last counts.
    pub(crate) fn finish<P: Probe>(&self, probe: &mut P) {
        probe.add(Counter::StoredWindows, self.store.stored() as u64);
        if P::TRACES {
            probe.renumber(&self.mesh, |v| v, |v, i| self.mesh.outgoing(v)[i]);
        }
    }
}
