//! The main loop.

use geobench_mesh::{HalfEdgeId, Mesh, VertexId};
use geobench_window::continuous::Surface;
use geobench_window::queue::{Discipline, Event, EventKind};
use geobench_window::trimming::ThinFaces;
use geobench_window::{
    Counter, Entrance, Exit, Frame, Passage, Phase, Probe, Propagate, Side, Solution, VertexFilter,
    Window, spawn_window,
};

use super::merge::{Merger, Run};
use super::sieve::Sieve;
use super::store::Store;
use crate::forgetting::{Forgetting, Keep, Past, reach};

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

/// How many turns before its own the list of a half-edge and its face are asked for, and how many
/// before it its windows.
const AHEAD: [usize; 2] = [6, 2];

/// MMP that takes the windows of a half-edge together, all that are due by its queue.
///
/// An event of the queue is a half-edge whose list has windows that wait, under the least of their
/// labels. Its turn takes those that are [due](Discipline::is_due), and what waits on is queued
/// again.
///
/// ```
/// use geobench_mesh::Mesh;
/// use geobench_mmp::{ByList, Keep};
/// use geobench_window::queue::Priority;
/// use geobench_window::{Counter, Solver, VertexFilter};
///
/// let mesh = Mesh::generate("terrain,n=8,seed=1")?;
/// // Every window compared and kept, as in the paper.
/// let solver = ByList::new(&mesh, Priority::new(&mesh));
/// let mut solver = solver.filtering(VertexFilter::Off).keeping(Keep::All);
/// let (solution, counters) = solver.count(&[5.into()])?;
/// assert_eq!(solution.distances[5], 0.0);
/// assert!(counters.get(Counter::StoredWindows) > Some(0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ByList<Q> {
    front: Front<Q>,
    /// The windows whose turn it is, and what they leave on the left and on the right exit.
    taken: Run,
    children: [Run; 2],
}

/// All that windows and distances come to.
#[derive(Clone, Debug)]
struct Front<Q> {
    mesh: Mesh,
    surface: Surface,
    queue: Q,
    /// The windows about to enter the face of each half-edge.
    store: Store,
    merger: Merger,
    sieve: Sieve,
    thin: ThinFaces,
    forgetting: Forgetting,
    keep: Keep,
    /// Windows that wait. Counted runs only.
    waiting: usize,
}

impl<Q: Discipline> ByList<Q> {
    /// Sets up for `mesh`; O(faces).
    pub fn new(mesh: &Mesh, queue: Q) -> Self {
        let order = Surface::order(mesh);
        Self {
            front: Front {
                mesh: mesh.clone(),
                surface: Surface::new(mesh),
                queue,
                store: Store::new(mesh.half_edge_count()),
                merger: Merger::default(),
                sieve: Sieve::default(),
                thin: ThinFaces::of(mesh, mesh.half_edge_count(), |h| {
                    order.new_half_edge(h).index()
                }),
                forgetting: Forgetting::default(),
                keep: Keep::default(),
                waiting: 0,
            },
            taken: Run::default(),
            children: Default::default(),
        }
    }

    /// Stores these windows.
    #[must_use]
    pub fn keeping(mut self, keep: Keep) -> Self {
        self.front.keep = keep;
        self
    }

    /// Drops windows whose interval is narrower than `width`, in the units of the mesh, when they
    /// come out of a triangle. Distances are then no longer exact.
    #[must_use]
    pub fn with_threshold(mut self, width: f64) -> Self {
        self.front.sieve.threshold = width;
        self
    }

    /// Drops windows that a path through an end of their edge beats before they are merged, by two
    /// of the three tests of ICH, which is the default, or merges all, as in the paper of MMP.
    /// Distances are the same.
    #[must_use]
    pub fn filtering(mut self, filter: VertexFilter) -> Self {
        self.front.sieve.filter = filter;
        self
    }

    /// The list of `h` has its turn: `event`, under `label`, has come out of the queue.
    #[inline]
    fn turn<P: Probe>(&mut self, h: HalfEdgeId, label: f64, event: Event, probe: &mut P) {
        let front = &mut self.front;
        let i = h.index();
        if front.store.queued(i) != label {
            // It was queued anew under a lesser label, and has had its turn.
            return;
        }
        let taken = &mut self.taken;
        taken.clear();
        let is_due = |label| front.queue.is_due(label);
        let rest = (front.store).take(i, &mut taken.windows, &mut taken.levels, is_due);
        front.store.set_queued(i, rest);
        if rest < f64::INFINITY {
            front.queue.push_list(rest, event, probe);
        }
        if taken.windows.is_empty() {
            return;
        }
        probe.enter(Phase::Propagation);
        if P::COUNTS {
            front.waiting -= taken.windows.len();
            let parents = taken.windows.len() as u64;
            probe.add(Counter::Parents, parents);
            if probe.wants_sample(parents) {
                probe.sample(front.store.waiting().map(Window::min_distance));
            }
        }
        self.cross(h, label, probe);
    }

    /// Takes the windows whose turn it is across the face of `h`; none of them is nearer than
    /// `label`.
    #[inline]
    fn cross<P: Probe>(&mut self, h: HalfEdgeId, label: f64, probe: &mut P) {
        let front = &mut self.front;
        let entrance = front.surface.faces().entrance(h);
        for target in entrance.exits.into_iter().flatten() {
            front.store.prepare(target.index());
        }
        if front.keep == Keep::Wavefront {
            front.give_up(h, &entrance, self.taken.windows.len(), label);
        }
        let known = entrance.corners.map(|v| front.surface.distance(v));
        let exits = [Side::Left, Side::Right].map(|side| entrance.exit(side));
        let frame = &entrance.frame;
        let least = cross_all(
            &self.taken,
            frame,
            &exits,
            known,
            &front.sieve,
            (!front.thin.is_empty()).then_some(&front.thin),
            &mut self.children,
            probe,
        );
        if P::COUNTS {
            let tries = tries(&self.taken, &entrance);
            probe.add(Counter::Propagated, tries);
            front.queue.crossed(h, tries, probe);
        }
        let [_, _, apex] = entrance.corners;
        if least < known[2] {
            front.offer(apex, least, probe);
        }
        for (exit, run) in exits.iter().zip(&self.children) {
            if let Some(target) = exit.half_edge
                && !run.windows.is_empty()
            {
                let kept = front.arrive(target, run, probe);
                probe.add(Counter::Kept, kept);
            }
        }
        probe.enter(Phase::Management);
    }
}

impl<Q: Discipline> Front<Q> {
    /// Asks for the memory that turns to come will need.
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

    /// So many windows have been taken through `h`, none of them nearer than `label`: gives up the
    /// lists that the wave has passed.
    #[inline]
    fn give_up(&mut self, h: HalfEdgeId, entrance: &Entrance, windows: usize, label: f64) {
        if !self.store.is_waited_for(h.index()) {
            let [tail, head, _] = entrance.corners;
            let ends = [tail, head].map(|v| self.surface.distance(v));
            self.forgetting.note(h, reach(ends, entrance.frame.l));
        }
        let windows = u32::try_from(windows).unwrap_or(u32::MAX);
        self.forgetting.step(&mut self.store, windows, || label);
    }

    /// A path of length `d` reaches `v`. Only vertices at which a path may turn have a turn, unless
    /// the discipline goes by vertices.
    #[inline]
    fn offer<P: Probe>(&mut self, v: VertexId, d: f64, probe: &mut P) {
        if self.surface.offer(v, d) && (Q::EVERY_VERTEX || self.mesh.is_pseudo_source(v)) {
            self.queue.push(d, Event::vertex(v), probe);
        }
    }

    /// Sends out paths along the edges of `v` and windows across its faces; `run` is room for them.
    fn spawn<P: Probe>(&mut self, v: VertexId, run: &mut Run, probe: &mut P) {
        probe.add(Counter::PseudoSources, 1);
        let sigma = self.surface.distance(v);
        // By index, since `self` changes meanwhile.
        let degree = self.mesh.outgoing(v).len();
        for i in 0..degree {
            let h = self.surface.faces().number(self.mesh.outgoing(v)[i]);
            let edges = self.surface.faces().edges_at_tail(h);
            for (neighbour, length) in edges.into_iter().flatten() {
                self.offer(neighbour, sigma + length, probe);
            }
        }
        for i in 0..degree {
            let h = self.surface.faces().number(self.mesh.outgoing(v)[i]);
            if let Some((target, window)) = spawn_window(self.surface.faces(), h, sigma) {
                probe.add(Counter::Spawned, 1);
                let edge = self.surface.edge(target);
                if self
                    .sieve
                    .drops(&window, edge.length, [edge.tail, edge.head])
                {
                    probe.add(Counter::Filtered, 1);
                    continue;
                }
                run.clear();
                run.windows.push(window);
                if P::COUNTS {
                    run.levels.push(0);
                }
                self.arrive(target, run, probe);
            }
        }
    }

    /// Merges windows that have reached `h` into its list; returns how many of them something is
    /// left of, in counted runs.
    #[inline]
    fn arrive<P: Probe>(&mut self, h: HalfEdgeId, run: &Run, probe: &mut P) -> u64 {
        probe.enter(Phase::Pruning);
        let kept = if self.store.is_closed(h.index()) {
            self.arrive_late(h, run, probe)
        } else {
            self.merge(h, run, probe)
        };
        probe.enter(Phase::Management);
        kept
    }

    /// The same for a list that has been given up: windows that are of no use any more are dropped.
    #[cold]
    fn arrive_late<P: Probe>(&mut self, h: HalfEdgeId, run: &Run, probe: &mut P) -> u64 {
        let edge = self.surface.edge(h);
        let useful = (run.windows.iter()).position(|w| !self.store.has_passed(h.index(), w, &edge));
        let passed = useful.unwrap_or(run.windows.len());
        probe.add(Counter::Filtered, passed as u64);
        if useful.is_none() {
            return 0;
        }
        if passed == 0 {
            return self.merge(h, run, probe);
        }
        let rest = Run {
            windows: run.windows[passed..].to_vec(),
            levels: run.levels.get(passed..).unwrap_or(&[]).to_vec(),
        };
        self.merge(h, &rest, probe)
    }

    /// The same for a list that holds windows, and has it queued if something comes to wait there
    /// before all else.
    #[inline]
    fn merge<P: Probe>(&mut self, h: HalfEdgeId, run: &Run, probe: &mut P) -> u64 {
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
            run,
            l,
            &mut |label| queue.weigh(label),
            probe,
        );
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
                // Those of windows of which nothing is left count too: they differ by little.
                let deepest = run.levels.iter().max().copied().unwrap_or(0);
                probe.raise(Counter::Levels, u64::from(deepest));
            }
        }
        merged.kept
    }
}

/// Takes `taken` across the triangle of `frame`, the distances of whose tail, head and apex are
/// `known`: puts what they leave on its exits into `children`, except what `sieve` drops, or drops
/// beside one of the `thin` faces, and returns the least of the apex's distance and those that they
/// offer to it.
#[inline]
#[allow(clippy::too_many_arguments)] // Private, and one step of `cross`.
fn cross_all<P: Probe>(
    taken: &Run,
    frame: &Frame,
    exits: &[Exit; 2],
    known: [f64; 3],
    sieve: &Sieve,
    thin: Option<&ThinFaces>,
    children: &mut [Run; 2],
    probe: &mut P,
) -> f64 {
    let [tail, head, mut least] = known;
    for run in &mut *children {
        run.clear();
        run.windows.reserve(taken.windows.len());
    }
    let mut put = |side: usize, child: Option<Window>, apex: f64, k: usize| {
        let (Some(child), Some(target)) = (child, exits[side].half_edge) else {
            return;
        };
        probe.add(Counter::Children, 1);
        let ends = [[tail, apex], [apex, head]][side];
        let l = exits[side].length;
        if sieve.drops_child(&child, l, ends)
            || thin.is_some_and(|thin| {
                thin.is_beside(target.index()) && sieve.beside_thin_face().drops(&child, l, ends)
            })
        {
            probe.add(Counter::Filtered, 1);
            return;
        }
        children[side].windows.push(child);
        if P::COUNTS {
            children[side].levels.push(taken.levels[k] + 1);
        }
    };
    for (k, window) in taken.windows.iter().enumerate() {
        let passage = Passage::new(frame, window);
        if passage.covers_apex() {
            least = least.min(passage.straight_distance());
            put(0, passage.left_child(&exits[0]), least, k);
            put(1, passage.right_child(&exits[1]), least, k);
            continue;
        }
        let side = usize::from(!passage.goes_left());
        // The bent path is at least as long as the straight one.
        let spare = least - window.sigma;
        let (x, y) = (frame.cx - window.px, frame.cy - window.py);
        // Not if nothing is to spare either: with its sign, the square tells both at once.
        if x * x + y * y < spare * spare.abs() {
            least = least.min(passage.bent_distance(&exits[side]));
        }
        put(side, passage.only_child(&exits[side]), least, k);
    }
    least
}

/// How many children were tried: going round the triangle from the left, a window all of whose rays
/// leave there is done.
fn tries(taken: &Run, entrance: &Entrance) -> u64 {
    let [left, right] = entrance.exits.map(|exit| u64::from(exit.is_some()));
    let both = taken.windows.iter().map(|window| {
        let passage = Passage::new(&entrance.frame, window);
        left + right * u64::from(passage.covers_apex() || passage.goes_right())
    });
    both.sum()
}

impl<Q: Discipline> Propagate for ByList<Q> {
    fn counters() -> Vec<Counter> {
        [COUNTERS, Q::COUNTERS].concat()
    }

    fn vertex_count(&self) -> usize {
        self.front.mesh.vertex_count()
    }

    fn propagate<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) -> Solution {
        let front = &mut self.front;
        front.surface.reset(front.mesh.vertex_count());
        front.store.clear(P::COUNTS);
        front.queue.clear();
        front.forgetting.clear();
        front.waiting = 0;
        probe.add(Counter::WindowBytes, Store::WINDOW_BYTES as u64);
        for &s in sources {
            front.surface.offer(s, 0.0);
        }
        for &s in sources {
            front.queue.start(s);
            front.spawn(s, &mut self.taken, probe);
        }
        while let Some((label, event)) = self.front.queue.pop(probe) {
            self.front.read_ahead();
            match event.kind() {
                EventKind::Vertex(v) => {
                    let front = &mut self.front;
                    // A vertex is queued anew whenever it improves; older entries are void.
                    if front.surface.distance(v) == label
                        && (!Q::EVERY_VERTEX || front.mesh.is_pseudo_source(v))
                    {
                        front.spawn(v, &mut self.taken, probe);
                    }
                }
                EventKind::Window(h, _) => self.turn(h, label, event, probe),
            }
        }
        let front = &mut self.front;
        probe.add(Counter::StoredWindows, front.store.stored_in_all() as u64);
        Solution::new(front.surface.take_distances())
    }
}
