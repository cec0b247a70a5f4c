//! The main loop of the batched form.

use geobench_mesh::{HalfEdgeId, Mesh, Splice, VertexId};
use geobench_window::continuous::Surface;
use geobench_window::queue::{Discipline, Event, EventKind};
use geobench_window::trimming::ThinFaces;
use geobench_window::{
    CompiledRuns, Counter, Crossing, EndCheck, Exit, FaceView, Frame, Phase, Probe, Propagate,
    Side, Solution, VertexFilter, Way, Window, length_past_end, spawn_window,
};

use super::merge::{Batch, Merger};
use super::prefilter::Prefilter;
use super::store::Store;
use crate::eviction::{Evictable, Eviction, Retention, reach};

/// The counters of the algorithm, beside those of its queue.
const COUNTERS: &[Counter] = &[
    Counter::Propagated,
    Counter::Parents,
    Counter::Children,
    Counter::Kept,
    Counter::Spawned,
    Counter::WindowBytes,
    Counter::PseudoSources,
    Counter::Reinserted,
    Counter::Trimmed,
    Counter::Filtered,
    Counter::PeakWindows,
    Counter::PeakWavefront,
    Counter::StoredWindows,
    Counter::Levels,
];

/// How many turns ahead the list of a half-edge and its face are prefetched, and how many turns
/// ahead its windows.
const AHEAD: [usize; 2] = [6, 2];

/// MMP that propagates all due windows of a half-edge together, under discipline `Q`.
///
/// An event of the queue is a half-edge whose list has waiting windows, under the least of their
/// labels. When the event comes out of the queue, the windows that are
/// [due](Discipline::is_due) are propagated. If others wait, the list is queued again.
///
/// It compares all windows and stores them until the end, as the papers do, unless
/// [`filtering`](Self::filtering) and [`retaining`](Self::retaining) say otherwise.
///
/// ```
/// use geobench_mesh::Mesh;
/// use geobench_mmp::Batched;
/// use geobench_window::queue::CalendarQueue;
/// use geobench_window::{Counter, Solver};
///
/// let mesh = Mesh::generate("terrain,n=8,seed=1")?;
/// let mut solver = Batched::new(&mesh, CalendarQueue::new(&mesh));
/// let (solution, counters) = solver.count(&[5.into()])?;
/// assert_eq!(solution.distances[5], 0.0);
/// assert!(counters.get(Counter::StoredWindows) > Some(0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Batched<Q> {
    runs: CompiledRuns<Self>,
    state: RunState<Q>,
    /// The windows that are propagated, and their children on the left and on the right exit.
    taken: Batch,
    children: [Batch; 2],
}

/// The state of a run: lists, queue and distances.
#[derive(Clone, Debug)]
struct RunState<Q> {
    mesh: Mesh,
    surface: Surface,
    queue: Q,
    /// The windows about to enter the face of each half-edge.
    store: Store,
    merger: Merger,
    prefilter: Prefilter,
    thin: ThinFaces,
    eviction: Eviction,
    end_check: EndCheck,
    retention: Retention,
    /// Number of waiting windows. Counted runs only.
    waiting: usize,
}

impl<Q: Discipline> Batched<Q> {
    /// Sets up for `mesh`; O(faces).
    pub fn new(mesh: &Mesh, queue: Q) -> Self {
        let order = Surface::order(mesh);
        Self {
            runs: CompiledRuns::new(),
            state: RunState {
                mesh: mesh.clone(),
                surface: Surface::new(mesh),
                queue,
                store: Store::new(mesh.half_edge_count(), mesh.junction_sides().len()),
                merger: Merger::default(),
                prefilter: Prefilter::default(),
                thin: ThinFaces::of(mesh, mesh.half_edge_count(), |h| {
                    order.new_half_edge(h).index()
                }),
                eviction: Eviction::default(),
                end_check: EndCheck::default(),
                retention: Retention::default(),
                waiting: 0,
            },
            taken: Batch::default(),
            children: Default::default(),
        }
    }

    /// Chooses which windows are stored until the end; all by default.
    #[must_use]
    pub fn retaining(mut self, retention: Retention) -> Self {
        self.state.retention = retention;
        self
    }

    /// Drops child windows whose interval is narrower than `width`, in the units of the mesh.
    /// Distances are then no longer exact.
    #[must_use]
    pub fn with_threshold(mut self, width: f64) -> Self {
        self.state.prefilter.threshold = width;
        self
    }

    /// Drops windows that a path through an end of their edge beats before they are merged, by two
    /// of the three tests of ICH. Off by default, as in the papers of MMP. Distances are the same.
    #[must_use]
    pub fn filtering(mut self, filter: VertexFilter) -> Self {
        self.state.prefilter.filter = filter;
        self
    }

    /// Propagates the due windows of the list of `h`, whose `event` came out of the queue under
    /// `label`.
    #[inline]
    fn take_turn<P: Probe>(&mut self, h: HalfEdgeId, label: f64, event: Event, probe: &mut P) {
        let state = &mut self.state;
        let i = h.index();
        if state.store.queued(i) != label {
            // A stale event: the list was queued again under a smaller label and taken.
            return;
        }
        let taken = &mut self.taken;
        taken.clear();
        state.queue.take_list(state.store.windows(i).len());
        let is_due = |label| state.queue.is_due(label);
        let rest = (state.store).take(i, &mut taken.windows, &mut taken.levels, is_due);
        state.store.set_queued(i, rest);
        if rest < f64::INFINITY {
            state.queue.push_list(rest, event, probe);
        }
        if taken.windows.is_empty() {
            return;
        }
        probe.enter(Phase::Propagation);
        if P::STOPS {
            state.end_check.advance(taken.windows.len());
        }
        if P::COUNTS {
            state.waiting -= taken.windows.len();
            let parents = taken.windows.len() as u64;
            probe.add(Counter::Parents, parents);
            if probe.wants_sample(parents) {
                let waiting = || state.store.waiting();
                probe.sample(waiting().map(|(_, window)| window.min_distance()));
                if probe.wants_windows() {
                    let ends = |i| state.surface.faces().ends(HalfEdgeId::new(i as u32));
                    probe.take_windows(waiting().map(|(i, &window)| (ends(i), window)));
                }
            }
        }
        self.cross(h, label, probe);
    }

    /// Propagates the taken windows across the face of `h`; none of them is nearer than `label`.
    #[inline]
    fn cross<P: Probe>(&mut self, h: HalfEdgeId, label: f64, probe: &mut P) {
        let state = &mut self.state;
        let face = state.surface.faces().face_view(h);
        for target in face.exits.into_iter().flatten() {
            state.store.prepare(target.index());
        }
        if state.retention == Retention::Wavefront {
            probe.enter(Phase::Management);
            state.evict_passed(h, &face, self.taken.windows.len(), label);
            probe.enter(Phase::Propagation);
        }
        let known = face.corners.map(|v| state.surface.distance(v));
        let exits = [Side::Left, Side::Right].map(|side| face.exit(side));
        let frame = &face.frame;
        let (least, best) = cross_all(
            &self.taken,
            frame,
            &exits,
            known,
            &state.prefilter,
            (!state.thin.is_empty()).then_some(&state.thin),
            &mut self.children,
            probe,
        );
        if P::COUNTS {
            let tries = tries(&self.taken, &face);
            probe.add(Counter::Propagated, tries);
            state.queue.crossed(h, tries, probe);
        }
        let [_, _, apex] = face.corners;
        if least < known[2] {
            state.offer(apex, least, probe);
            if P::TRACES
                && let Some(best) = best
            {
                let way = Way::of(&self.taken.windows[best], frame);
                probe.reach(apex, h.prev(), way);
            }
        }
        for (exit, batch) in exits.iter().zip(&self.children) {
            if let Some(target) = exit.half_edge
                && !batch.windows.is_empty()
            {
                let kept = state.arrive(target, batch, probe);
                probe.add(Counter::Kept, kept);
            }
        }
        probe.enter(Phase::Management);
    }
}

impl<Q: Discipline> RunState<Q> {
    /// Prefetches the memory that the next turns need.
    #[inline]
    fn read_ahead(&self) {
        let [far, near] = AHEAD.map(|skipped| self.queue.upcoming(skipped).map(Event::kind));
        if let Some(EventKind::Window(h, _)) = far {
            self.store.announce(h.index());
            self.surface.announce(h);
        }
        if let Some(EventKind::Window(h, _)) = near {
            self.store.prepare(h.index());
            for target in self.surface.faces().exits(h).into_iter().flatten() {
                self.store.announce(target.index());
            }
        }
    }

    /// Evicts the lists that the wavefront has passed, after `windows` windows, none of them nearer
    /// than `label`, were taken from the list of `h`.
    #[inline]
    fn evict_passed(&mut self, h: HalfEdgeId, face: &FaceView, windows: usize, label: f64) {
        if !self.store.is_waited_for(h.index()) && !self.thin.is_beside(h.index()) {
            let [tail, head, _] = face.corners;
            let ends = [tail, head].map(|v| self.surface.distance(v));
            self.eviction.note(h, reach(ends, face.frame.l));
        }
        let windows = u32::try_from(windows).unwrap_or(u32::MAX);
        self.eviction.step(&mut self.store, windows, || label);
    }

    /// Whether everything that `probe` wants is final, now that an event under `label` has left the
    /// queue.
    fn ends<P: Probe>(&mut self, label: f64, probe: &mut P) -> bool {
        let surface = &self.surface;
        let distance = |v| surface.distance(v);
        self.queue.ends(label, &mut self.end_check, distance, probe)
    }

    /// Offers `v` a path of length `d`. Only pseudo-sources are queued, unless the discipline
    /// orders all vertices. Returns whether it is the shortest so far.
    #[inline]
    fn offer<P: Probe>(&mut self, v: VertexId, d: f64, probe: &mut P) -> bool {
        let improves = self.surface.offer(v, d);
        if improves && (Q::EVERY_VERTEX || self.mesh.is_pseudo_source(v)) {
            probe.enter(Phase::Management);
            self.queue.push(d, Event::vertex(v), probe);
            probe.enter(Phase::Propagation);
        }
        improves
    }

    /// Offers paths along the edges of `v` and spawns windows across its faces; `batch` is scratch
    /// space.
    fn spawn<P: Probe>(&mut self, v: VertexId, batch: &mut Batch, probe: &mut P) {
        probe.enter(Phase::Propagation);
        probe.add(Counter::PseudoSources, 1);
        let sigma = self.surface.distance(v);
        // By index, since `self` changes meanwhile.
        let degree = self.mesh.outgoing(v).len();
        for i in 0..degree {
            let h = self.surface.faces().number(self.mesh.outgoing(v)[i]);
            for path in self.surface.faces().edge_paths(h) {
                if self.offer(path.end, sigma + path.length, probe) && P::TRACES {
                    probe.reach(path.end, path.corner, path.way);
                }
            }
        }
        for i in 0..degree {
            let h = self.surface.faces().number(self.mesh.outgoing(v)[i]);
            if let Some((target, window)) = spawn_window(self.surface.faces(), h, sigma) {
                probe.add(Counter::Spawned, 1);
                let edge = self.surface.edge(target);
                if self
                    .prefilter
                    .drops(&window, edge.length, [edge.tail, edge.head])
                {
                    probe.add(Counter::Filtered, 1);
                    continue;
                }
                batch.clear();
                batch.windows.push(window);
                if P::COUNTS {
                    batch.levels.push(0);
                }
                self.arrive(target, batch, probe);
            }
        }
        probe.enter(Phase::Management);
    }

    /// Merges `batch` into the list of `h`. Returns how many of its windows survive, in counted
    /// runs.
    #[inline]
    fn arrive<P: Probe>(&mut self, h: HalfEdgeId, batch: &Batch, probe: &mut P) -> u64 {
        probe.enter(Phase::Pruning);
        let kept = if self.store.is_evicted(h.index()) {
            self.arrive_late(h, batch, probe)
        } else {
            self.merge(h, batch, probe)
        };
        probe.enter(Phase::Propagation);
        kept
    }

    /// [`arrive`](Self::arrive) for an evicted list: windows that come too late are dropped, and
    /// those at a gate passed on.
    #[cold]
    fn arrive_late<P: Probe>(&mut self, h: HalfEdgeId, batch: &Batch, probe: &mut P) -> u64 {
        let before = batch.windows.len();
        let entrances: Option<Vec<_>> = self.surface.faces().beyond(h).map(Iterator::collect);
        if let Some(entrances) = entrances {
            // A path may enter any of the faces, and from which of the others a shorter path has
            // come does not matter. So the lists there are merged separately.
            let edge = self.surface.edge(h);
            // As beside thin faces, the filter is always on. Windows that turn back into another
            // sheet would go all the way back.
            let filter = self.prefilter.beside_thin_face();
            let drops = |w: &Window| filter.drops(w, edge.length, [edge.tail, edge.head]);
            let batch = batch.without(drops);
            let dropped = before - batch.windows.len();
            probe.add(Counter::Filtered, dropped as u64);
            let mirrored = batch.mirrored(edge.length);
            let mut kept = 0;
            for entrance in entrances {
                let own = if entrance.mirrored { &mirrored } else { &batch };
                kept = kept.max(self.arrive(entrance.half_edge, own, probe));
            }
            return kept;
        }
        let edge = self.surface.edge(h);
        let useful = (batch.windows.iter())
            .position(|w| !self.store.rejects_late_arrival(h.index(), w, &edge));
        let passed = useful.unwrap_or(batch.windows.len());
        probe.add(Counter::Filtered, passed as u64);
        if useful.is_none() {
            return 0;
        }
        if passed == 0 {
            return self.merge(h, batch, probe);
        }
        let rest = Batch {
            windows: batch.windows[passed..].to_vec(),
            levels: batch.levels.get(passed..).unwrap_or(&[]).to_vec(),
        };
        self.merge(h, &rest, probe)
    }

    /// [`arrive`](Self::arrive) for a list that is not evicted. Queues the list if a new window is
    /// nearer than those that wait there.
    #[inline]
    fn merge<P: Probe>(&mut self, h: HalfEdgeId, batch: &Batch, probe: &mut P) -> u64 {
        let i = h.index();
        let l = self.surface.faces().length(h);
        let (queue, queued) = (&mut self.queue, self.store.queued(i));
        let before = if P::COUNTS {
            self.store.waiting_in(i)
        } else {
            0
        };
        let merged = (self.merger).merge(
            &mut self.store,
            i,
            batch,
            l,
            &mut |label| queue.weigh(label),
            probe,
        );
        probe.enter(Phase::Management);
        if merged.least < queued {
            self.store.set_queued(i, merged.least);
            self.queue
                .push_list(merged.least, Event::window(h, 0), probe);
        }
        if P::COUNTS {
            self.waiting = self.waiting + self.store.waiting_in(i) - before;
            probe.raise(Counter::PeakWindows, self.store.stored() as u64);
            probe.raise(Counter::PeakWavefront, self.waiting as u64);
            if merged.kept > 0 {
                // Includes the levels of windows that were dropped, which differ by little.
                let deepest = batch.levels.iter().max().copied().unwrap_or(0);
                probe.raise(Counter::Levels, u64::from(deepest));
            }
        }
        merged.kept
    }
}

/// Propagates `taken` across the triangle of `frame`. `known` are the distances of its tail, head
/// and apex. The windows on each exit go to `children`, except those that `prefilter` drops, or
/// drops beside one of the `thin` faces. Returns the least distance of the apex that is known or
/// offered.
#[inline]
#[allow(clippy::too_many_arguments)] // Private, and one step of `cross`.
fn cross_all<P: Probe>(
    taken: &Batch,
    frame: &Frame,
    exits: &[Exit; 2],
    known: [f64; 3],
    prefilter: &Prefilter,
    thin: Option<&ThinFaces>,
    children: &mut [Batch; 2],
    probe: &mut P,
) -> (f64, Option<usize>) {
    let [tail, head, mut least] = known;
    let mut best = None;
    for batch in &mut *children {
        batch.clear();
        batch.windows.reserve(taken.windows.len());
    }
    let mut children = ChildSink {
        taken,
        exits,
        ends: [tail, head],
        prefilter,
        thin,
        batches: children,
        probe,
    };
    for (k, window) in taken.windows.iter().enumerate() {
        let crossing = Crossing::new(frame, window);
        let before = least;
        if crossing.covers_apex() {
            least = least.min(crossing.straight_distance());
            if P::TRACES && least < before {
                best = Some(k);
            }
            children.put(0, crossing.left_child(&exits[0]), least, k);
            children.put(1, crossing.right_child(&exits[1]), least, k);
            continue;
        }
        let side = usize::from(!crossing.goes_left());
        // The bent path is at least as long as the straight one.
        let spare = least - window.sigma;
        let (x, y) = (frame.cx - window.px, frame.cy - window.py);
        // The sign handles a negative `spare` in the same comparison.
        if x * x + y * y < spare * spare.abs() {
            let d = crossing.bent_distance(&exits[side]);
            if d < least {
                let bend = if side == 0 { window.b1 } else { window.b0 };
                let sides = [frame.la, frame.lb];
                least = least.min(length_past_end(d, bend, frame.l, [tail, head], sides));
            }
            if P::TRACES && least < before {
                best = Some(k);
            }
        }
        children.put(side, crossing.only_child(&exits[side]), least, k);
    }
    (least, best)
}

/// The children of `taken`.
struct ChildSink<'a, P> {
    taken: &'a Batch,
    exits: &'a [Exit; 2],
    /// The distances of tail and head.
    ends: [f64; 2],
    prefilter: &'a Prefilter,
    thin: Option<&'a ThinFaces>,
    /// One for each exit.
    batches: &'a mut [Batch; 2],
    probe: &'a mut P,
}

impl<P: Probe> ChildSink<'_, P> {
    /// Keeps a child of window `k` on an exit, unless it is dropped; `apex` is the distance of the
    /// apex.
    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "three calls are not inlined otherwise, which takes 4 % of a solve"
    )]
    fn put(&mut self, side: usize, child: Option<Window>, apex: f64, k: usize) {
        let exit = &self.exits[side];
        let (Some(child), Some(target)) = (child, exit.half_edge) else {
            return;
        };
        self.probe.add(Counter::Children, 1);
        let [tail, head] = self.ends;
        let ends = [[tail, apex], [apex, head]][side];
        if self.prefilter.drops_child(&child, exit.length, ends)
            || self.thin.is_some_and(|thin| {
                thin.is_beside(target.index())
                    && self
                        .prefilter
                        .beside_thin_face()
                        .drops(&child, exit.length, ends)
            })
        {
            self.probe.add(Counter::Filtered, 1);
            return;
        }
        self.batches[side].windows.push(child);
        if P::COUNTS {
            self.batches[side].levels.push(self.taken.levels[k] + 1);
        }
    }
}

/// The number of children tried. The left exit is tried first; the right one only if some ray of
/// the window can leave there.
fn tries(taken: &Batch, face: &FaceView) -> u64 {
    let [left, right] = face.exits.map(|exit| u64::from(exit.is_some()));
    let both = taken.windows.iter().map(|window| {
        let crossing = Crossing::new(&face.frame, window);
        left + right * u64::from(crossing.covers_apex() || crossing.goes_right())
    });
    both.sum()
}

impl<Q: Discipline> Propagate for Batched<Q> {
    const JUNCTIONS: bool = true;

    fn counters() -> Vec<Counter> {
        [COUNTERS, Q::COUNTERS].concat()
    }

    fn mesh(&self) -> &Mesh {
        &self.state.mesh
    }

    fn splice(&mut self, splice: &Splice) -> Option<Splice> {
        let state = &mut self.state;
        let undo = state.mesh.splice(splice);
        let mesh = &state.mesh;
        let half_edges = mesh.half_edge_count();
        state.surface.splice(mesh, splice);
        state.queue.splice(mesh, splice);
        state
            .store
            .set_count(half_edges, mesh.junction_sides().len());
        let faces = state.surface.faces();
        let number = |h| faces.number(h).index();
        state.thin.splice(mesh, splice, half_edges, number);
        Some(undo)
    }

    fn runs(&self) -> CompiledRuns<Self> {
        self.runs
    }

    fn propagate<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) -> Solution {
        let state = &mut self.state;
        state.surface.reset(state.mesh.vertex_count());
        state.store.clear(P::COUNTS);
        state.queue.clear();
        state.eviction.clear();
        state.end_check.clear();
        state.waiting = 0;
        probe.add(Counter::WindowBytes, Store::WINDOW_BYTES as u64);
        for &s in sources {
            state.surface.offer(s, 0.0);
        }
        for &s in sources {
            state.queue.start(s);
            state.spawn(s, &mut self.taken, probe);
        }
        while let Some((label, event)) = self.state.queue.pop(probe) {
            if P::STOPS && self.state.ends(label, probe) {
                break;
            }
            self.state.read_ahead();
            match event.kind() {
                EventKind::Vertex(v) => {
                    let state = &mut self.state;
                    // A vertex is queued whenever it improves; older events are stale.
                    if state.surface.distance(v) == label
                        && (!Q::EVERY_VERTEX || state.mesh.is_pseudo_source(v))
                    {
                        state.spawn(v, &mut self.taken, probe);
                    }
                }
                EventKind::Window(h, _) => self.take_turn(h, label, event, probe),
            }
        }
        let state = &mut self.state;
        probe.add(Counter::StoredWindows, state.store.stored_in_all() as u64);
        if P::TRACES {
            let (mesh, faces) = (&state.mesh, state.surface.faces());
            probe.renumber(mesh, |v| v, |v, i| faces.number(mesh.outgoing(v)[i]));
        }
        Solution::new(state.surface.take_distances())
    }
}
