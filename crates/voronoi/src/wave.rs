//! The state that all algorithms of this crate share. Windows with sources cross faces and are
//! trimmed on edges.

use geobench_mesh::{HalfEdgeId, Mesh, Splice, VertexId};
use geobench_window::trimming::{ThinFaces, is_near};
use geobench_window::{
    Counter, Crossing, Exit, FaceView, Faces, Frame, Phase, Probe, Side, SolveError, VertexFilter,
    Way, Window, check_sources, is_beaten_from_ends, length_past_end, prefetch, spawn_window,
};

use crate::field::{LabelledField, NO_SOURCE};
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

/// A window that has arrived at a half-edge and waits there to cross.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HeldWindow {
    pub(crate) h: HalfEdgeId,
    /// The ends of its edge.
    pub(crate) ends: [VertexId; 2],
    /// Its least distance; that of all of them if it stands for several windows.
    pub(crate) label: f64,
    /// Its number in the list of its edge; not used if it stands for several windows.
    pub(crate) serial: u32,
}

/// How windows that have arrived are announced to the schedule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ArrivalMode {
    /// Each by an arrival of its own.
    OneByOne,
    /// All windows that came to a half-edge together by one arrival.
    Together,
}

/// The state of the surface during a run. Events that the schedule has to handle are appended to
/// [`arrivals`](Self::arrivals) and [`improved`](Self::improved), from which the schedule takes
/// them.
#[derive(Clone, Debug)]
pub(crate) struct WaveState {
    pub(crate) mesh: Mesh,
    pub(crate) faces: Faces,
    pub(crate) thin: ThinFaces,
    filter: VertexFilter,
    pub(crate) distances: Vec<f64>,
    pub(crate) labels: Vec<u32>,
    /// The distance at which each vertex last spawned windows; infinite if it has not.
    spawned: Vec<f64>,
    pub(crate) store: EdgeWindows,
    /// Scratch: windows that leave a face together, by its left and by its right exit.
    children: [Vec<Stored>; 2],
    /// For each face, a distance within which one of its points is reached; empty if not recorded.
    pub(crate) nearest: Vec<f64>,
    /// Faces reached for the first time since the last call of
    /// [`Remover::step`](crate::removal::Remover) that read them; empty if `nearest` is.
    pub(crate) reached: Vec<u32>,
    pub(crate) arrivals: Vec<HeldWindow>,
    /// Pseudo-sources, the vertices at which paths may turn, whose distance has improved.
    pub(crate) improved: Vec<(f64, VertexId)>,
}

impl WaveState {
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

    /// Makes a change of the mesh in place. Returns the one that undoes it.
    pub(crate) fn splice(&mut self, splice: &Splice) -> Splice {
        let undo = self.mesh.splice(splice);
        let half_edges = self.mesh.half_edge_count();
        self.faces.splice(&self.mesh, splice);
        self.thin
            .splice(&self.mesh, splice, half_edges, HalfEdgeId::index);
        self.store.set_edges(half_edges);
        undo
    }

    /// Prepares for a run: resets the state and gives the sources distance 0. The sources still
    /// have to [spawn](Self::spawn). `watches_faces` tells whether [`nearest`](Self::nearest) is
    /// recorded.
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

    /// The sources of a run, none of them a copy.
    ///
    /// # Errors
    ///
    /// If there is none, or one does not exist, or the mesh has a junction.
    pub(crate) fn sources(&self, sources: &[VertexId]) -> Result<Vec<VertexId>, SolveError> {
        check_sources(self.mesh.vertex_count(), sources)?;
        if let Some(error) = SolveError::diagram_at_junctions(&self.mesh) {
            return Err(error);
        }
        let kept = sources.iter().map(|&v| self.mesh.kept_vertex(v));
        Ok(kept.collect())
    }

    /// The result of the run.
    pub(crate) fn field(&mut self) -> LabelledField<'_> {
        self.mesh.fill_copies(&mut self.distances);
        self.mesh.fill_copies(&mut self.labels);
        LabelledField {
            mesh: &self.mesh,
            distances: &self.distances,
            labels: &self.labels,
            store: &self.store,
        }
    }

    /// Updates `v` by a path of length `d` from `source`. Returns whether it is the shortest so
    /// far.
    ///
    /// Of two equally near sources, the one with the lesser number is taken, unless `v` has spawned
    /// windows at this distance. So all windows behind a saddle that is equidistant to both have
    /// the source of the saddle.
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

    /// Records that a point of face `f` is reached within distance `d`.
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

    /// Sends paths along the edges of `v` and windows across its faces, unless `v` has done so at
    /// its present distance. The windows are announced [one by one](Self::arrive) or
    /// [together](Self::arrive_all).
    pub(crate) fn spawn<P: Probe>(&mut self, v: VertexId, arrival: ArrivalMode, probe: &mut P) {
        let sigma = self.distances[v.index()];
        if self.spawned[v.index()] == sigma {
            return;
        }
        self.spawned[v.index()] = sigma;
        let source = self.labels[v.index()];
        probe.enter(Phase::Propagation);
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
                probe.enter(Phase::Pruning);
                match arrival {
                    ArrivalMode::OneByOne => {
                        self.arrive(target, &window, source, probe);
                    }
                    ArrivalMode::Together => {
                        self.arrive_with_filter(target, h.next(), window, source, probe);
                    }
                }
                probe.enter(Phase::Propagation);
            }
        }
        probe.enter(Phase::Management);
    }

    /// Stores `window` of `source`, in the frame of `h`, at which it arrives. Returns whether a
    /// part of it is stored.
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
        // The papers of this family have no vertex filter. But without it, windows wind around
        // needles in any order except nearest first.
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
            self.arrivals.push(HeldWindow {
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
        // A window with a foot is inserted in pieces, some of which may be dropped.
        let is_kept = self.store.changes.new_parts > 0;
        self.note_changes(h, twin, usize::from(!is_kept), probe);
        is_kept
    }

    /// Counts the changes after windows that arrived at `h` have been inserted, except `dropped` of
    /// them. Records the distance at which they reach the faces on both sides.
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

    /// Stores the windows of `batch`, which are in ascending order, on `h`. `h` has length `l` and
    /// twin `twin`. Returns the number of windows of which a part is stored. They are announced as
    /// one arrival. Beside [thin faces](ThinFaces), and if a source [`is_near`], they are
    /// announced one by one.
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
        if self.thin.is_beside(h.index()) || batch.iter().any(|s| is_near(&s.window, l)) {
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
            // `twin` belongs to the face that the windows have left, which is in the cache.
            let [head, tail, _] = self.faces.corners(twin);
            self.arrivals.push(HeldWindow {
                h,
                ends: [tail, head],
                label: changes.least,
                serial: 0,
            });
        }
        self.note_changes(h, twin, dropped, probe);
        (batch.len() - dropped) as u64
    }

    /// [`arrive_all`](Self::arrive_all) for one window, to which the filter has not been applied.
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

    /// Whether paths along the edge from its ends beat all of `window`.
    #[inline]
    fn is_beaten(&self, h: HalfEdgeId, window: &Window, l: f64) -> bool {
        let [tail, head, _] = self.faces.corners(h);
        let [d0, d1] = [tail, head].map(|v| self.distances[v.index()]);
        is_beaten_from_ends(window, l, d0, d1)
    }

    /// Propagates a window of `source`, in the frame of `h`, across the face of `h`. Returns the
    /// number of children tried.
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
        // Counted as in MMP, which tries a window that leaves on the right on the left, too.
        tries += u64::from(!covers && crossing.side() == Side::Right);
        probe.add(Counter::Propagated, tries);
        probe.enter(Phase::Management);
        probe.raise(Counter::PeakWindows, self.store.stored() as u64);
        probe.raise(Counter::PeakWavefront, self.store.waiting() as u64);
        tries
    }

    /// The half-edges by which windows leave the face of `h` after they have entered it through
    /// `h`, each with its twin.
    #[inline]
    fn exits(&self, h: HalfEdgeId) -> impl Iterator<Item = (HalfEdgeId, HalfEdgeId)> {
        let inside = [h.prev(), h.next()].into_iter();
        inside.filter_map(|h| Some((h, self.faces.twin(h)?)))
    }

    /// Prefetches the lists of the exits and the other data that [`cross_all`](Self::cross_all)
    /// reads first.
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

    /// Prefetches the windows on the exits.
    #[inline]
    pub(crate) fn prefetch_exit_windows(&self, h: HalfEdgeId) {
        for (h, twin) in self.exits(h) {
            self.store.prefetch_windows(edge_of(h, twin).0);
        }
    }

    /// Propagates `windows`, in ascending order in the frame of `h`, across the face of `h`.
    /// Returns the number of children tried.
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
            if probe.wants_windows() {
                probe.take_windows(self.mesh.half_edges().flat_map(|h| {
                    let waiting = self.store.list(h.index()).iter().filter(|s| s.waits());
                    waiting.map(move |s| (self.faces.ends(h), s.window))
                }));
            }
        }
    }

    /// Reports the last counts of a run, and the numbering of its origins.
    pub(crate) fn finish<P: Probe>(&self, probe: &mut P) {
        probe.add(Counter::StoredWindows, self.store.stored() as u64);
        if P::TRACES {
            probe.renumber(&self.mesh, |v| v, |v, i| self.mesh.outgoing(v)[i]);
        }
    }
}

/// Propagates `windows` across the face of `view`. `known` are the distances of its corners,
/// `label` is the source of its apex. Appends the children to `children`, those on the left exit to
/// the first list; if `filters`, without those that a path through an end of the exit beats.
/// Returns the number of children tried and, if the apex is improved, the length of the best path
/// to it with the index of its window.
#[inline]
#[allow(clippy::too_many_arguments)] // Private, and one step of `WaveState::cross_all`.
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
        // Counted as in MMP, which tries a window that leaves on the right on the left, too.
        tries += u64::from(covers || side == 1);
        // No bent path is shorter than the straight one, so it is computed only if the straight one
        // is at most `spare`. The square keeps the sign of `spare`: nothing is at most a negative
        // one.
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
