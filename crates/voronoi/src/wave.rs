//! What all algorithms of this crate share: windows with sources that cross faces and are trimmed
//! on edges.

use geobench_mesh::{HalfEdgeId, Mesh, VertexId};
use geobench_window::trimming::{ThinFaces, foot};
use geobench_window::{
    Counter, Crossing, Exit, FaceView, Faces, Frame, Phase, Probe, Side, VertexFilter, Way, Window,
    is_beaten_from_ends, length_past_end, prefetch, spawn_window,
};

use crate::field::{Field, NO_SOURCE};
use crate::store::{EdgeWindows, Stored, edge_of};

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
    /// The ends of its edge.
    pub(crate) ends: [VertexId; 2],
    /// Its least distance.
    pub(crate) label: f64,
    pub(crate) serial: u32,
}

/// How windows that have come to wait are announced to the schedule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Announced {
    /// Each by an arrival of its own.
    OneByOne,
    /// All windows that came to a half-edge together by one arrival.
    Together,
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
    /// Windows that leave a face together, by its left and by its right exit.
    children: [Vec<Stored>; 2],
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
            children: Default::default(),
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
        self.store.clear(P::COUNTS);
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
    /// at this distance. The windows are announced [one by one](Self::arrive) or
    /// [together](Self::arrive_all).
    pub(crate) fn spawn<P: Probe>(&mut self, v: VertexId, arrival: Announced, probe: &mut P) {
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
                match arrival {
                    Announced::OneByOne => {
                        self.arrive(target, &window, source, probe);
                    }
                    Announced::Together => {
                        self.arrive_with_filter(target, h.next(), window, source, probe);
                    }
                }
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
        let [head, tail, _] = self.faces.corners(twin);
        for waiting in &self.store.changes.waiting {
            self.arrivals.push(Arrival {
                h: if waiting.is_reversed == is_reversed {
                    h
                } else {
                    twin
                },
                ends: [tail, head],
                label: waiting.label,
                serial: waiting.serial,
            });
        }
        // Of a window with a foot, some pieces may be left.
        let is_kept = self.store.changes.new_parts > 0;
        self.note_changes(h, twin, usize::from(!is_kept), probe);
        is_kept
    }

    /// Windows that arrived at `h` have been inserted, except `dropped` of them.
    #[inline]
    fn note_changes<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        twin: HalfEdgeId,
        dropped: usize,
        probe: &mut P,
    ) {
        let changes = &self.store.changes;
        probe.add(Counter::Reinserted, changes.split as u64);
        probe.add(Counter::Trimmed, changes.trimmed as u64);
        probe.add(Counter::Filtered, (changes.removed + dropped) as u64);
        let least = changes.least;
        if least < f64::INFINITY {
            self.reach(h.face().index(), least);
            self.reach(twin.face().index(), least);
        }
    }

    /// Stores the windows of `batch`, in ascending order, on `h`, which has length `l` and the twin
    /// `twin`. Returns the number of windows of which a part is stored. They are queued as one
    /// arrival, unless windows cross there [one by one](ThinFaces).
    fn arrive_all<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        twin: HalfEdgeId,
        l: f64,
        batch: &mut [Stored],
        probe: &mut P,
    ) -> u64 {
        let (e, is_reversed) = edge_of(h, twin);
        if self.store.is_closed(e) {
            probe.add(Counter::Filtered, batch.len() as u64);
            return 0;
        }
        if self.thin.is_beside(h.index()) || batch.iter().any(|s| foot(&s.window, l).is_some()) {
            return self.arrive_one_by_one(h, batch, probe);
        }
        if is_reversed {
            batch.reverse();
            for stored in batch.iter_mut() {
                stored.window = stored.window.reversed(l);
            }
        }
        self.store.merge(e, batch, l);
        let changes = &self.store.changes;
        let dropped = changes.dropped;
        if changes.least < f64::INFINITY {
            // The face that the windows have left is in the cache.
            let [head, tail, _] = self.faces.corners(twin);
            self.arrivals.push(Arrival {
                h,
                ends: [tail, head],
                label: changes.least,
                serial: 0,
            });
        }
        self.note_changes(h, twin, dropped, probe);
        (batch.len() - dropped) as u64
    }

    /// [`arrive_all`](Self::arrive_all) for one window, which the filter has not seen.
    fn arrive_with_filter<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        twin: HalfEdgeId,
        window: Window,
        source: u32,
        probe: &mut P,
    ) {
        let l = self.faces.length(h);
        if self.filter == VertexFilter::On && self.is_beaten(h, &window, l) {
            probe.add(Counter::Filtered, 1);
            return;
        }
        let (_, is_reversed) = edge_of(h, twin);
        let stored = Stored::waiting(window, is_reversed, source);
        self.arrive_all(h, twin, l, &mut [stored], probe);
    }

    /// [`arrive_all`](Self::arrive_all), window by window.
    #[cold]
    fn arrive_one_by_one<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        batch: &[Stored],
        probe: &mut P,
    ) -> u64 {
        let mut kept = 0;
        for stored in batch {
            kept += u64::from(self.arrive(h, &stored.window, stored.source(), probe));
        }
        kept
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

    /// The half-edges, with their twins, of the face of `h` by which windows leave that enter it
    /// through `h`.
    #[inline]
    fn exits(&self, h: HalfEdgeId) -> impl Iterator<Item = (HalfEdgeId, HalfEdgeId)> {
        let inside = [h.prev(), h.next()].into_iter();
        inside.filter_map(|h| Some((h, self.faces.twin(h)?)))
    }

    /// Prefetches the lists of the exits that [`cross_all`](Self::cross_all) meets, and what it looks
    /// at first.
    #[inline]
    pub(crate) fn prefetch_exits(&self, h: HalfEdgeId) {
        let [.., apex] = self.faces.corners(h);
        prefetch(&self.distances, apex.index());
        prefetch(&self.labels, apex.index());
        prefetch(&self.nearest, h.face().index());
        for (h, twin) in self.exits(h) {
            self.store.prefetch_list(edge_of(h, twin).0);
            prefetch(&self.nearest, twin.face().index());
        }
    }

    /// Prefetches the windows of the same lists.
    #[inline]
    pub(crate) fn prefetch_exit_windows(&self, h: HalfEdgeId) {
        for (h, twin) in self.exits(h) {
            self.store.prefetch_windows(edge_of(h, twin).0);
        }
    }

    /// Takes `windows`, in ascending order in the frame of `h`, across the face of `h`. Returns how
    /// many children were tried.
    pub(crate) fn cross_all<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        windows: &[Stored],
        probe: &mut P,
    ) -> u64 {
        probe.enter(Phase::Propagation);
        probe.add(Counter::Parents, windows.len() as u64);
        let view = self.faces.face_view(h);
        let inside = [h.prev(), h.next()];
        let exit_lengths = [view.frame.la, view.frame.lb];
        let mut children = std::mem::take(&mut self.children);
        children.iter_mut().for_each(Vec::clear);
        let known = view.corners.map(|v| self.distances[v.index()]);
        let filters = self.filter == VertexFilter::On;
        let [.., apex] = view.corners;
        let label = self.labels[apex.index()];
        let (tries, best) = cross_face(
            &view,
            known,
            label,
            windows,
            &mut children,
            inside,
            filters,
            probe,
        );
        if let Some((d, k)) = best
            && self.offer(apex, d, windows[k].source())
            && P::TRACES
        {
            probe.reach(apex, h.prev(), Way::of(&windows[k].window, &view.frame));
        }
        for (side, batch) in children.iter_mut().enumerate() {
            if let Some(target) = view.exits[side]
                && !batch.is_empty()
            {
                probe.enter(Phase::Pruning);
                let kept = self.arrive_all(target, inside[side], exit_lengths[side], batch, probe);
                probe.add(Counter::Kept, kept);
            }
        }
        self.children = children;
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

/// Takes `windows` across the face of `view`, whose corners have the distances `known` and whose
/// apex has the source `label`. Their children go to `children`, those on the left exit first,
/// except those that a path through an end of the exit beats, if `filters`. Returns how many were
/// tried, and the best path to the apex with the number of its window, if it is to be offered.
#[inline]
#[allow(clippy::too_many_arguments)] // Private, and one step of `Wave::cross_all`.
fn cross_face<P: Probe>(
    view: &FaceView,
    known: [f64; 3],
    label: u32,
    windows: &[Stored],
    children: &mut [Vec<Stored>; 2],
    inside: [HalfEdgeId; 2],
    filters: bool,
    probe: &mut P,
) -> (u64, Option<(f64, usize)>) {
    let frame = &view.frame;
    let exits = [Side::Left, Side::Right].map(|side| view.exit(side));
    let [tail, head, mut least] = known;
    let (mut best, mut nearest) = (None, label);
    let mut tries = windows.len() as u64;
    for (k, stored) in windows.iter().enumerate() {
        let (window, source) = (&stored.window, stored.source());
        let crossing = Crossing::new(frame, window);
        let covers = crossing.covers_apex();
        let side = usize::from(!crossing.goes_left());
        // As MMP: all of a window that leaves on the right is tried on the left, too.
        tries += u64::from(covers || side == 1);
        // No bent path is shorter than the straight one. With its sign, the square tells both
        // whether anything is to spare and whether it is enough.
        let spare = least - window.sigma;
        if covers || crossing.squared_straight() <= spare * spare.abs() {
            let d = if covers {
                crossing.straight_distance()
            } else {
                crossing.bent_distance(&exits[side])
            };
            if d < least || d == least && source < nearest {
                (least, nearest) = (d, source);
                best = Some((d, k));
            }
        }
        let mut put = |side: usize, child: Option<Window>| {
            let exit: &Exit = &exits[side];
            if let (Some(window), Some(target)) = (child, exit.half_edge) {
                probe.add(Counter::Children, 1);
                let ends = [[tail, least], [least, head]][side];
                if filters && is_beaten_from_ends(&window, exit.length, ends[0], ends[1]) {
                    probe.add(Counter::Filtered, 1);
                } else {
                    children[side].push(Stored::waiting(window, target > inside[side], source));
                }
            }
        };
        if covers {
            put(0, crossing.left_child(&exits[0]));
            put(1, crossing.right_child(&exits[1]));
        } else {
            put(side, crossing.only_child(&exits[side]));
        }
    }
    (tries, best)
}
