//! The loop of `vtp-fast` and of each thread of `pvtp`: the vertices of a bucket have their turns,
//! then lists cross faces until all of them wait.
//!
//! A [`Wavefront`] has the windows and queues of one thread. A [`SurfaceState`] has the faces and
//! distances. The two algorithms differ in the `SurfaceState`, in how a wavefront starts, and in
//! the steps between turns.

// Kernels must be inlined into the functions that enable the instructions.
#![allow(clippy::inline_always)]

mod staying;
mod surface_state;

use geobench_mesh::{HalfEdgeId, VertexId};
use geobench_window::queue::MinHeap;
use geobench_window::simd::{Lanes, Scalar, SimdProgram};
use geobench_window::trimming::KeptWindows;
use geobench_window::{Counter, EndCheck, Phase, Probe, Way};

use self::staying::Staying;
pub(crate) use self::surface_state::SurfaceState;
use crate::engine::buckets::VertexBuckets;
use crate::engine::coalesce::ONE_BY_ONE;
use crate::engine::kernels::{self, BestPath, Cuts, Gate, LOSES, Measured, Target, Triangle};
use crate::engine::layout::{MeshLayout, NO_TWIN, half_edge, next, parts, prev};
use crate::engine::levels::Levels;
use crate::engine::sample::Sample;
use crate::engine::sent::Sent;
use crate::engine::spawn_wedge::{PathOrigin, SpawnWedge};
use crate::engine::store::{NO_LIST, WindowStore, admit};
use crate::fast::FastOptions;
use crate::precision::blur;

/// The largest number of deferred improvements.
const IMPROVEMENTS: usize = 4096;

/// A distance update whose effects are deferred. It is one of: the shortest path that this
/// wavefront saw when it was found; the first path of this wavefront to a vertex that other threads
/// have reached; a path received in a handoff.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Improvement {
    pub(crate) vertex: u32,
    /// The half-edge that the path crossed last.
    pub(crate) h: u32,
    /// The abscissa of that crossing.
    pub(crate) entry: f64,
    /// The length of the path.
    pub(crate) distance: f64,
}

/// The windows of one thread, and its queues of lists and vertices.
#[derive(Clone, Debug)]
pub(crate) struct Wavefront {
    /// The lists whose pairs are compared.
    compared: Sample,
    /// Whether pseudo-sources send windows only into the spawn wedge of the path that reached them.
    spawn_wedge: bool,
    pub(crate) store: WindowStore,
    staying: Staying,
    /// Half-edges whose lists are queued to cross.
    ready: Vec<u32>,
    /// Half-edges beside thin faces and long ones, by the least distance of their windows. They
    /// cross when no others are queued and no vertex is nearer.
    nearest: MinHeap<u32>,
    /// Vertices whose turn comes by distance: those that have improved after the turn of their
    /// bucket, and those of a bucket within which lists of `nearest` wait.
    due: MinHeap<u32>,
    pub(crate) buckets: VertexBuckets,
    /// The vertices of the current bucket.
    turn: Vec<u32>,
    /// Vertices that have had their turn.
    passed: Vec<bool>,
    /// The distance at which each pseudo-source sent windows last.
    spawned: Vec<f64>,
    /// The origin of the path to each pseudo-source that has length
    /// [`reached`](SurfaceState::reached).
    pub(crate) origins: Vec<PathOrigin>,
    improvements: Vec<Improvement>,
    improved: usize,
    keep: Vec<u8>,
    cuts: Cuts,
    levels: Levels,
    pub(crate) kept: KeptWindows,
    end_check: EndCheck,
    /// The faces that have joined, in runs that may end early.
    joined: Vec<u32>,
}

impl Wavefront {
    /// An empty wavefront for `layout`; O(vertices).
    pub(crate) fn new(layout: &MeshLayout, options: &FastOptions) -> Self {
        let vertices = layout.vertices.len();
        Self {
            compared: Sample::new(options.pairs),
            spawn_wedge: options.spawn_wedge,
            store: WindowStore::new(),
            staying: Staying::new(options.stay, layout.typical_length),
            ready: Vec::new(),
            nearest: MinHeap::default(),
            due: MinHeap::default(),
            buckets: VertexBuckets::new(vertices, options.bucket * layout.typical_length),
            turn: Vec::new(),
            passed: Vec::new(),
            spawned: Vec::new(),
            origins: vec![PathOrigin::default(); vertices],
            improvements: vec![Improvement::default(); IMPROVEMENTS],
            improved: 0,
            keep: Vec::new(),
            cuts: Cuts::default(),
            levels: Levels::default(),
            kept: layout.kept.clone(),
            end_check: EndCheck::default(),
            joined: Vec::new(),
        }
    }

    /// Whether no window and no vertex waits, as after a complete run.
    pub(crate) fn is_empty(&self) -> bool {
        self.store.waiting() == 0 && self.buckets.len() == 0
    }

    /// The vertices of the last turn.
    pub(crate) fn last_turn(&self) -> &[u32] {
        &self.turn
    }

    /// Whether everything that `probe` wants is final before the turn of `bucket`. No list may be
    /// queued, and no effects may be deferred. `number` gives the number here of a vertex of the
    /// mesh.
    pub(crate) fn ends<P: Probe>(
        &mut self,
        state: &impl SurfaceState,
        bucket: u32,
        number: impl Fn(VertexId) -> u32,
        probe: &mut P,
    ) -> bool {
        let distance = |v| state.distance(number(v));
        let waiting = || {
            let due = self.due.iter().map(|&(_, v)| v);
            let vertices = self.buckets.vertices().chain(due);
            let vertices = vertices.map(|v| state.distance(v));
            let windows = self.store.windows().map(|w| w.min_distance());
            let staying = self.staying.windows(state.layout());
            let staying = staying.map(|w| w.min_distance());
            vertices.chain(windows).chain(staying)
        };
        let nearest = self.buckets.end_of(bucket);
        self.end_check.ends(probe, nearest, distance, waiting)
    }

    /// Removes all windows, which wait on the border of the traversed area.
    pub(crate) fn abandon(&mut self, state: &mut impl SurfaceState) {
        for f in std::mem::take(&mut self.joined) {
            let twins = state.layout().faces[f as usize].twin;
            let own = (0..3).map(|corner| half_edge(f, corner));
            for h in own.chain(twins).filter(|&h| h != NO_TWIN) {
                let (f, corner) = parts(h);
                let list = state.take_list(f, corner);
                if list != NO_LIST {
                    self.staying.abandon(list);
                    self.store.set_len(list, 0);
                }
            }
        }
    }

    /// Follows a change of the mesh, of which `layout` is the layout now. Every list must be empty.
    pub(crate) fn splice(&mut self, layout: &MeshLayout) {
        let vertices = layout.vertices.len();
        self.buckets.reset();
        self.buckets.resize(vertices);
        self.origins.resize(vertices, PathOrigin::default());
        self.kept.clone_from(&layout.kept);
    }

    /// Clears the state of the last run. Every list must be empty, as after a complete run or
    /// [`abandon`](Self::abandon).
    pub(crate) fn reset(&mut self) {
        let vertices = self.origins.len();
        self.buckets.reset();
        self.nearest.clear();
        self.due.clear();
        self.end_check.clear();
        self.joined.clear();
        self.turn.clear();
        self.levels.clear();
        self.staying.reset();
        self.kept.clear();
        self.spawned.clear();
        self.spawned.resize(vertices, f64::INFINITY);
        self.passed.clear();
        self.passed.resize(vertices, false);
    }
}

/// The length of the shortest path to `v`. Another thread may have written a longer one since.
fn nearest_path(state: &impl SurfaceState, v: u32) -> f64 {
    state.distance(v).min(state.reached(v))
}

/// Turns of vertices, and effects of paths that reach them.
impl Wavefront {
    /// Processes the vertices of `bucket`, or lets them wait by distance if a list does so within
    /// the bucket. No vertex may wait in an earlier bucket.
    pub(crate) fn take_turn<P: Probe>(
        &mut self,
        state: &mut impl SurfaceState,
        bucket: u32,
        probe: &mut P,
    ) {
        let mut turn = std::mem::take(&mut self.turn);
        self.buckets.take(bucket, &mut turn);
        probe.add(Counter::Iterations, 1);
        self.staying.decide();
        if self.nearest_list() < self.buckets.end_of(bucket) {
            for &v in &turn {
                self.due.push(nearest_path(state, v), v);
            }
            self.turn = turn;
            return;
        }
        for (i, &v) in turn.iter().enumerate() {
            if let Some(&v) = turn.get(i + 6) {
                for &h in state.layout().ring(v) {
                    state.prefetch_lists(parts(h).0);
                }
            }
            self.pass(state, v, probe);
        }
        self.turn = turn;
    }

    /// The turn of vertex `v`: the faces around it join the traversed area.
    pub(crate) fn pass<P: Probe>(&mut self, state: &mut impl SurfaceState, v: u32, probe: &mut P) {
        self.passed[v as usize] = true;
        for place in state.layout().ring_places(v) {
            let (f, _) = parts(state.layout().rings[place]);
            self.join::<P>(state, f);
        }
        self.spawn_if_nearer(state, v, probe);
    }

    /// Face `f` joins the traversed area, and its lists are queued.
    #[inline(always)]
    fn join<P: Probe>(&mut self, state: &mut impl SurfaceState, f: usize) {
        if state.join(f) {
            if P::STOPS {
                self.joined.push(f as u32);
            }
            for corner in 0..3 {
                if state.list(f, corner) != NO_LIST {
                    self.make_ready(state, f, corner);
                }
            }
        }
    }

    /// Queues the list on half-edge `corner` of face `f`, if the face has joined.
    #[inline(always)]
    pub(crate) fn make_ready(&mut self, state: &mut impl SurfaceState, f: usize, corner: usize) {
        if state.layout().is_by_distance(half_edge(f as u32, corner)) {
            self.wait_by_distance(state, f, corner);
        } else if state.enqueue(f, corner) {
            self.ready.push(half_edge(f as u32, corner));
        }
    }

    /// Queues the list on a half-edge beside a thin face, or on a long one, by the least distance
    /// of its windows. When that is due, the face joins if it has not. In first-in, first-out
    /// order, the windows would wind around a needle before those that beat them have arrived.
    #[cold]
    #[inline(never)]
    fn wait_by_distance(&mut self, state: &impl SurfaceState, f: usize, corner: usize) {
        let list = state.list(f, corner);
        let windows = self.store.windows_at(list, 0..self.store.len(list));
        let nearest = windows.fold(f64::INFINITY, |d, w| d.min(w.min_distance()));
        self.nearest.push(nearest, half_edge(f as u32, corner));
    }

    /// Goes on before the next bucket, when no list is queued: gives the nearest vertices that wait
    /// by distance a turn, or queues the list that does so, whichever is nearer. Returns whether
    /// there was one nearer than all vertices in buckets.
    ///
    /// In first-in, first-out order, each path to a late vertex would send windows before a shorter
    /// one arrives, and these would do the same at the next vertex. Where edges are far longer than
    /// others, as on mechanical parts, many vertices are late.
    ///
    /// Between vertices and lists that wait by distance, the order is exact for any width of
    /// buckets. Lists that crossed up to the end of a bucket would wind around a needle before the
    /// vertices of the bucket have sent the windows that beat them. Vertices that had turns before
    /// such lists would send windows at distances that are not final.
    #[cold]
    #[inline(never)]
    fn go_on<P: Probe>(&mut self, state: &mut impl SurfaceState, probe: &mut P) -> bool {
        let due = self.due.peek().map_or(f64::INFINITY, |(d, _)| d);
        let vertex = self.buckets.least();
        if self.make_nearest_ready::<P>(state, due.min(vertex)) {
            return true;
        }
        if due > vertex {
            return false;
        }
        let end = self.nearest_list().min(due + self.buckets.width());
        let mut any = false;
        while self.due.peek().is_some_and(|(d, _)| d <= end)
            && let Some((_, v)) = self.due.pop()
        {
            self.pass(state, v, probe);
            any = true;
        }
        any
    }

    /// The least distance of a list that waits by distance; infinity if there is none.
    #[inline]
    fn nearest_list(&self) -> f64 {
        self.nearest.peek().map_or(f64::INFINITY, |(d, _)| d)
    }

    /// Queues the nearest list that waits by distance to cross, if it is not beyond `end`. Returns
    /// whether there was one.
    ///
    /// A list goes before a vertex at the same distance, as at the end of its edge. Otherwise the
    /// windows of that vertex would be stored first beside thin faces, and all of them go on.
    fn make_nearest_ready<P: Probe>(&mut self, state: &mut impl SurfaceState, end: f64) -> bool {
        while self.nearest.peek().is_some_and(|(d, _)| d <= end)
            && let Some((_, h)) = self.nearest.pop()
        {
            let (f, corner) = parts(h);
            // Skips lists that have crossed since, as nearer ones.
            if state.list(f, corner) != NO_LIST {
                self.join::<P>(state, f);
                if state.enqueue(f, corner) {
                    self.ready.push(h);
                    return true;
                }
            }
        }
        false
    }

    /// Gives vertex `v`, reached at distance `d`, a turn, unless it needs none.
    #[inline]
    fn give_turn<P: Probe>(&mut self, state: &impl SurfaceState, v: u32, d: f64, probe: &mut P) {
        let news = if self.passed[v as usize] {
            let sends = state.layout().vertices[v as usize].pseudo_source;
            if sends {
                self.due.push(d, v);
            }
            sends
        } else if self.buckets.has_passed(d) {
            self.due.push(d, v);
            true
        } else {
            self.buckets.push(v, d)
        };
        probe.add(Counter::QueuePushes, u64::from(news));
    }

    /// Defers the effects of an improvement if `news`. There must be room for it.
    #[inline(always)]
    fn note(&mut self, improvement: Improvement, news: bool) {
        self.improvements[self.improved] = improvement;
        self.improved += usize::from(news);
    }

    /// Takes over another wavefront's path to a vertex that was handed off to this one.
    pub(crate) fn take_over<P: Probe>(
        &mut self,
        state: &mut impl SurfaceState,
        improvement: Improvement,
        probe: &mut P,
    ) {
        self.note(improvement, true);
        if self.must_settle() {
            self.settle(state, probe);
        }
    }

    /// Whether there is no room for another improvement.
    #[inline(always)]
    fn must_settle(&self) -> bool {
        self.improved == self.improvements.len()
    }

    /// Applies the deferred effects of improvements.
    pub(crate) fn settle<P: Probe>(&mut self, state: &mut impl SurfaceState, probe: &mut P) {
        for i in 0..std::mem::take(&mut self.improved) {
            let Improvement {
                vertex,
                h,
                entry,
                distance,
            } = self.improvements[i];
            let v = vertex as usize;
            // A later path has effects of its own.
            if distance <= state.reached(vertex) && state.layout().vertices[v].pseudo_source {
                self.origins[v] = PathOrigin { h, entry };
            }
            self.give_turn(state, vertex, nearest_path(state, vertex), probe);
        }
        probe.raise(Counter::QueuePeak, self.buckets.len() as u64);
    }
}

/// Windows that vertices send.
impl Wavefront {
    /// The turn of a source, which sends windows in all directions.
    pub(crate) fn start_from<P: Probe>(
        &mut self,
        state: &mut impl SurfaceState,
        source: u32,
        probe: &mut P,
    ) {
        if self.spawned[source as usize] > 0.0 {
            self.spawned[source as usize] = 0.0;
            self.spawn(state, source, true, probe);
            self.pass(state, source, probe);
        }
    }

    /// Sends windows from pseudo-source `v` if its distance has decreased since it last did.
    fn spawn_if_nearer<P: Probe>(&mut self, state: &mut impl SurfaceState, v: u32, probe: &mut P) {
        let (vertex, distance) = (state.layout().vertices[v as usize], state.reached(v));
        if vertex.pseudo_source
            && distance < self.spawned[v as usize]
            // If another thread has found a shorter path, that thread sends the windows.
            && distance <= state.distance(v)
        {
            self.spawned[v as usize] = distance;
            self.spawn(state, v, vertex.all_around || !self.spawn_wedge, probe);
        }
    }

    /// Offers distances along the edges of `v` and sends windows across its faces, in all
    /// directions or into the spawn wedge of the path that reached it.
    fn spawn<P: Probe>(
        &mut self,
        state: &mut impl SurfaceState,
        v: u32,
        all_around: bool,
        probe: &mut P,
    ) {
        probe.add(Counter::PseudoSources, 1);
        let ring = state.layout().ring_places(v);
        let wedge = if all_around {
            SpawnWedge::all(ring.len())
        } else {
            SpawnWedge::of(state.layout(), v, self.origins[v as usize])
        };
        let mut place = ring.start + wedge.first;
        for i in 0..wedge.count {
            let h = state.layout().rings[place];
            place = if place + 1 == ring.end {
                ring.start
            } else {
                place + 1
            };
            // The last edge belongs to the next face of the wedge, if there is one.
            let last = !all_around && i + 1 == wedge.count;
            self.spawn_across(state, v, h, last, probe);
        }
        probe.raise(Counter::PeakWindows, self.store.waiting() as u64);
    }

    /// Offers a distance along `h`, which starts at `v`, and sends a window across its face. If
    /// `last`, also offers a distance along the other edge of the face.
    #[inline]
    fn spawn_across<F: SurfaceState, P: Probe>(
        &mut self,
        state: &mut F,
        v: u32,
        h: u32,
        last: bool,
        probe: &mut P,
    ) {
        let d = self.spawned[v as usize];
        let spawn = state.layout().spawn(h, d);
        let ([a, b], [to_a, to_b]) = (spawn.ends, spawn.paths);
        let [_, l, px, py, _] = spawn.window;
        // As seen from the opposite vertices, these paths arrive at the far ends of their
        // half-edges.
        let (f, corner) = parts(h);
        let along_b = PathOrigin {
            h: half_edge(f as u32, prev(corner)),
            entry: state.layout().faces[f].length[prev(corner)],
        };
        self.offer_along(state, a, to_a, along_b, probe);
        if last || state.layout().vertices[v as usize].boundary {
            self.offer_along(state, b, to_b, PathOrigin { h, entry: 0.0 }, probe);
        }
        if spawn.exit == NO_TWIN {
            return;
        }
        let [at_a, at_b] = [a, b].map(|v| state.distance(v));
        probe.add(Counter::Spawned, 1);
        // The vertex filter: a path along the edge from one of its ends beats the farthest ray.
        let blur = blur(state.layout().longest_edge);
        if at_b * LOSES + (l + blur) < to_a || at_a * LOSES + (l + blur) < to_b {
            probe.add(Counter::Filtered, 1);
            return;
        }
        let (target, k) = parts(spawn.exit);
        let mut window = spawn.window;
        if self.kept.holds(spawn.exit as usize) {
            let Some(part) = admit(&mut self.kept, spawn.exit, window) else {
                probe.add(Counter::Filtered, 1);
                return;
            };
            window = part;
        }
        let list = self.reserve(state.list(target, k), 1);
        let len = self.store.len(list);
        debug_assert!(list != NO_LIST);
        self.store.put(list, len, window);
        if P::COUNTS && F::IS_ALONE {
            self.levels.start(spawn.exit, [px, py], d);
        }
        state.set_list(target, k, self.store.set_len(list, len + 1));
        self.make_ready(state, target, k);
    }

    /// Offers `v` a path of length `d` along an edge.
    #[inline]
    fn offer_along<P: Probe>(
        &mut self,
        state: &mut impl SurfaceState,
        v: u32,
        d: f64,
        origin: PathOrigin,
        probe: &mut P,
    ) {
        if state.offer(v, d) {
            if P::TRACES {
                let (f, corner) = parts(origin.h);
                let own = half_edge(f as u32, prev(corner));
                let way = if origin.entry > 0.0 {
                    Way::FromHead
                } else {
                    Way::FromTail
                };
                probe.reach(VertexId::new(v), HalfEdgeId::new(own), way);
            }
            self.origins[v as usize] = origin;
            let nearest = state.distance(v).min(d);
            self.give_turn(state, v, nearest, probe);
        }
    }
}

/// Lists that cross faces.
impl Wavefront {
    /// Propagates lists until none is queued. Coalesces windows if `COALESCE`.
    #[inline(always)]
    pub(crate) fn cross_all<L: Lanes, F: SurfaceState, P: Probe, const COALESCE: bool>(
        &mut self,
        simd: L::Token,
        state: &mut F,
        probe: &mut P,
    ) {
        let mut place = 0;
        loop {
            if place == self.ready.len() || self.must_settle() {
                self.settle(state, probe);
            }
            let Some(&h) = self.ready.get(place) else {
                let waits = !(self.due.is_empty() && self.nearest.is_empty());
                if waits && self.go_on(state, probe) {
                    continue;
                }
                break;
            };
            if F::IS_ALONE && self.staying.is_on() {
                self.prefetch_face(state, place + 14);
                self.prefetch_beyond(state, place + 10);
                self.prefetch_chunks(state, place + 6);
            } else {
                self.prefetch_face(state, place + 6);
                self.prefetch_beyond(state, place + 3);
            }
            place += 1;
            if !COALESCE || L::COUNT == 1 {
                self.cross::<L, F, P, COALESCE>(simd, state, h, probe);
            } else if self.waiting_at(state, h) <= ONE_BY_ONE {
                self.cross::<Scalar, F, P, COALESCE>((), state, h, probe);
            } else {
                let list = CrossList::<F, P, COALESCE> {
                    wavefront: self,
                    state,
                    h,
                    probe,
                };
                L::run_apart(simd, list);
            }
        }
        self.ready.clear();
    }

    /// Number of windows that wait on `h`.
    #[inline(always)]
    fn waiting_at(&self, state: &impl SurfaceState, h: u32) -> usize {
        let (f, corner) = parts(h);
        self.store.len(state.list(f, corner))
    }

    /// Propagates the list on `h` across its face.
    #[inline(always)]
    fn cross<L: Lanes, F: SurfaceState, P: Probe, const COALESCE: bool>(
        &mut self,
        simd: L::Token,
        state: &mut F,
        h: u32,
        probe: &mut P,
    ) {
        let (f, corner) = parts(h);
        let (after, before) = (next(corner), prev(corner));
        let mut list = state.take_list(f, corner);
        if F::IS_ALONE && !P::COUNTS && !COALESCE {
            match self.cross_staying::<L, F, P>(simd, state, h, list, probe) {
                Some(usual) => list = usual,
                None => return,
            }
            self.staying.count(self.store.len(list));
        }
        let face = &state.layout().faces[f];
        let [tail, head, apex] = [corner, after, before].map(|k| face.vertex[k]);
        let exits = [face.twin[before], face.twin[after]];
        let triangle = face.triangle(corner);
        let arrived = self.store.len(list);
        let mut len = arrived;
        probe.enter(Phase::Pruning);
        if self.kept.may_have_replaced(h as usize) {
            len = self.store.drop_replaced(&self.kept, h, list);
            self.kept.note_crossing(h as usize);
        }
        if self.compared.takes(h, len) {
            let block = self.store.padded_block(list);
            let blur = blur(state.layout().longest_edge);
            len = kernels::compare::<L>(simd, block, len, blur, &mut self.cuts);
        }
        let gate = Gate {
            l: triangle.l,
            apex: triangle.apex,
            ends: [tail, head].map(|v| state.distance(v)),
            longest: state.layout().longest_edge,
        };
        let waiting = self.store.first(list, len);
        let found = kernels::measure::<L, true>(simd, waiting, 0, &gate, &mut self.keep);
        probe.enter(Phase::Propagation);
        probe.add(Counter::Filtered, (arrived - found.kept) as u64);
        probe.add(Counter::Parents, found.kept as u64);
        if P::STOPS {
            self.end_check.advance(found.kept);
        }
        if probe.wants_sample(found.kept as u64) {
            probe.sample(self.store.windows().map(|w| w.min_distance()));
            if probe.wants_windows() {
                let layout = state.layout();
                let waiting = layout.half_edges().map(|h| {
                    let (f, corner) = parts(h);
                    (h, state.list(f, corner))
                });
                probe.take_windows(waiting.chain([(h, list)]).flat_map(|(h, list)| {
                    let windows = self.store.windows_at(list, 0..self.store.len(list));
                    windows.map(move |w| (layout.ends(h), w))
                }));
            }
        }
        if found.kept > 0 {
            let waiting = self.store.first(list, len);
            let (best, distance) =
                BestPath::shortest(waiting, (found.best, found.distance), &gate, || {
                    let face = &state.layout().faces[f];
                    [before, after].map(|k| face.length[k])
                });
            // Effects are deferred, because whether a path is the shortest is hard to predict.
            let news = state.offer(apex, distance);
            if P::TRACES && news {
                let way = Way::through(best.entry, best.source, triangle.l);
                let own = half_edge(f as u32, before);
                probe.reach(VertexId::new(apex), HalfEdgeId::new(own), way);
            }
            let path = Improvement {
                vertex: apex,
                h,
                entry: best.entry,
                distance,
            };
            self.note(path, news);
            self.send::<L, F, P, COALESCE>(
                simd, state, list, h, exits, &triangle, &found, &best, probe,
            );
        }
        probe.enter(Phase::Management);
        self.store.set_len(list, 0);
        if P::COUNTS && F::IS_ALONE {
            self.levels.forget(h);
        }
        probe.raise(Counter::PeakWindows, self.store.waiting() as u64);
    }

    /// Propagates the `list` on `h`, measured as `found`, across its face, which is `triangle`,
    /// into the lists behind both exits.
    #[allow(clippy::too_many_arguments)] // All of what the caller has found out.
    #[inline(always)]
    fn send<L: Lanes, F: SurfaceState, P: Probe, const COALESCE: bool>(
        &mut self,
        simd: L::Token,
        state: &mut F,
        list: u32,
        h: u32,
        exits: [u32; 2],
        triangle: &Triangle,
        found: &Measured,
        best: &BestPath,
        probe: &mut P,
    ) {
        let mut lists = [NO_LIST; 2];
        for side in 0..2 {
            if exits[side] != NO_TWIN && found.bound[side] > 0 {
                let (f, k) = parts(exits[side]);
                lists[side] = self.reserve(state.list(f, k), found.bound[side]);
            }
        }
        let before = lists.map(|list| self.store.len(list));
        let [block, left, right] = self.store.blocks([list, lists[0], lists[1]]);
        let mut left = Target {
            block: left,
            len: before[0],
            open: lists[0] != NO_LIST,
        };
        let mut right = Target {
            block: right,
            len: before[1],
            open: lists[1] != NO_LIST,
        };
        let carried = kernels::carry::<L, BestPath>(
            simd,
            block.columns(found.len),
            &self.keep,
            triangle,
            best,
            0.0,
            [&mut left, &mut right],
        );
        let mut sent = Sent {
            exits,
            lists,
            before,
            after: [left.len, right.len],
        };
        let children = sent.children();
        probe.enter(Phase::Management);
        if P::COUNTS && F::IS_ALONE {
            let deepest = sent.record_levels(&mut self.levels, &self.store, h, triangle);
            probe.raise(Counter::Levels, u64::from(deepest));
        }
        if COALESCE {
            let (f, corner) = parts(h);
            let face = &state.layout().faces[f];
            sent.after = (self.store).coalesce_behind(face, corner, lists, before, sent.after);
        }
        sent.admit(&mut self.kept, &mut self.store);
        for side in sent.sides() {
            let (f, k) = parts(exits[side]);
            let list = self.set_len(lists[side], sent.after[side]);
            state.set_list(f, k, list);
            if list != NO_LIST {
                self.make_ready(state, f, k);
            }
        }
        probe.add(Counter::Propagated, carried.tried as u64);
        probe.add(Counter::Children, children as u64);
    }

    /// Prefetches the face that the list at index `place` of the queue will cross.
    #[inline(always)]
    fn prefetch_face(&self, state: &impl SurfaceState, place: usize) {
        if let Some(&h) = self.ready.get(place) {
            state.prefetch_face(parts(h).0);
        }
    }

    /// Prefetches the lists and the distance that the list at index `place` of the queue will
    /// change.
    #[inline(always)]
    fn prefetch_beyond(&self, state: &impl SurfaceState, place: usize) {
        if let Some(&h) = self.ready.get(place) {
            for exit in state.layout().exits(h) {
                state.prefetch_lists(parts(exit).0);
            }
            let (f, corner) = parts(h);
            state.prefetch_distance(state.layout().faces[f].vertex[prev(corner)]);
        }
    }
}

/// The crossing of a list.
struct CrossList<'a, F, P, const COALESCE: bool> {
    wavefront: &'a mut Wavefront,
    state: &'a mut F,
    h: u32,
    probe: &'a mut P,
}

impl<F: SurfaceState, P: Probe, const COALESCE: bool> SimdProgram
    for CrossList<'_, F, P, COALESCE>
{
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, simd: L::Token) {
        self.wavefront
            .cross::<L, F, P, COALESCE>(simd, self.state, self.h, self.probe);
    }
}
