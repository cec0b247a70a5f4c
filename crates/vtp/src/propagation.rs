//! The main loop of list propagation.

use std::marker::PhantomData;

use geobench_mesh::{HalfEdgeId, Mesh, Numbering, Splice, VertexId};
use geobench_window::trimming::KeptWindows;
use geobench_window::{
    CompiledRuns, Counter, EndCheck, Phase, Probe, Propagate, Solution, Way, Window,
};

use crate::crossing::{Carry, Inspect, Least};
use crate::engine::active_list::ActiveList;
use crate::engine::kernels::{BestPath, Gate, Target};
use crate::engine::layout::{FaceLayout, MeshLayout, NO_TWIN, half_edge, next, parts, prev};
use crate::engine::levels::Levels;
use crate::engine::prefetch::prefetch;
use crate::engine::sent::Sent;
use crate::engine::store::{Columns, NO_LIST, admit};
use crate::exits::{Exits, ListCrossing};
use crate::front::{ChildSide, Front};
use crate::merge::Merge;
use crate::pruning::Pairs;
use crate::schedule::{Schedule, Scheduled};
use crate::tally::PairTally;
use geobench_window::simd::{Instructions, Simd};

/// An algorithm that propagates whole lists of windows, on one mesh. Faces join in the order of
/// schedule `S`; lists are merged by `M`; windows are compared by `P`; `E` decides through which
/// exits they leave.
///
/// The solver renumbers vertices and faces breadth first.
///
/// ```
/// use geobench_mesh::Mesh;
/// use geobench_vtp::{AnyExit, ListPropagation, NearestFace, NoPairs, OrderFree};
/// use geobench_window::Solver;
///
/// // FTP without its rules.
/// type Plain = ListPropagation<NearestFace, OrderFree, NoPairs, AnyExit>;
/// let mesh = Mesh::generate("terrain,n=8,seed=1")?;
/// assert_eq!(Plain::with_choices(&mesh).distances_from(5)?[5], 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ListPropagation<S, M, P, E> {
    runs: CompiledRuns<Self>,
    mesh: Mesh,
    simd: Simd,
    numbering: Numbering,
    layout: MeshLayout,
    schedule: S,
    front: Front,
    active: ActiveList,
    exits: E,
    /// Vertices that have had their turn.
    passed: Vec<bool>,
    distances: Vec<f64>,
    end_check: EndCheck,
    levels: Levels,
    kept: KeptWindows,
    /// Children narrower than this are dropped.
    threshold: f64,
    choices: PhantomData<(M, P)>,
}

/// Whether the face on either side is thin, by half-edge; empty if no face is thin.
fn thin(layout: &MeshLayout) -> Vec<bool> {
    let kept = &layout.kept;
    let half_edges = if kept.is_empty() {
        0
    } else {
        4 * layout.faces.len()
    };
    (0..half_edges).map(|h| kept.is_beside(h)).collect()
}

impl<S: Schedule, M: Merge, P: Pairs, E: Exits> ListPropagation<S, M, P, E> {
    /// Sets up any combination of choices for `mesh`; O(faces).
    pub fn with_choices(mesh: &Mesh) -> Self {
        let mut numbering = Numbering::breadth_first(mesh);
        let layout = MeshLayout::new(mesh, &numbering);
        numbering.keep_new_vertices();
        let faces = mesh.face_count();
        let kept = layout.kept.clone();
        let thin = thin(&layout);
        Self {
            runs: CompiledRuns::new(),
            mesh: mesh.clone(),
            simd: Simd::new(Instructions::detect()),
            numbering,
            layout,
            schedule: S::new(faces),
            front: Front::new(faces, thin),
            active: ActiveList::new(),
            exits: E::new(faces),
            passed: Vec::new(),
            distances: Vec::new(),
            end_check: EndCheck::default(),
            levels: Levels::default(),
            kept,
            threshold: 0.0,
            choices: PhantomData,
        }
    }

    /// Drops children whose interval is narrower than `width`, in the units of the mesh. The paper
    /// uses a millionth of the model's size. Distances are then no longer exact.
    #[must_use]
    pub fn with_threshold(self, width: f64) -> Self {
        Self {
            threshold: width,
            ..self
        }
    }

    /// Uses `instructions`, or narrower ones if the processor lacks them. The default is the widest
    /// set of the processor. Distances are the same bit for bit.
    #[must_use]
    pub fn with_instructions(self, instructions: Instructions) -> Self {
        Self {
            simd: Simd::new(instructions),
            ..self
        }
    }

    /// Clears the state of the last run, and the windows that still waited at its end.
    fn reset(&mut self) {
        self.end_check.clear();
        self.schedule.reset();
        self.front.reset();
        self.exits.reset();
        self.levels.clear();
        self.kept.clear();
        self.passed.clear();
        self.passed.resize(self.mesh.vertex_count(), false);
        self.distances.clear();
        self.distances
            .resize(self.mesh.vertex_count(), f64::INFINITY);
    }

    /// Whether everything that `probe` wants is final before the turn at distance `d`. No list may
    /// be queued.
    fn ends<B: Probe>(&mut self, d: f64, probe: &mut B) -> bool {
        let distance = |v| self.distances[self.numbering.new_vertex(v).index()];
        let windows = || self.front.windows().map(|w| w.min_distance());
        self.end_check
            .ends(probe, d, distance, || windows().chain([d]))
    }

    /// Offers vertex `v` a path of length `d`; `way` describes it by a half-edge that starts there.
    /// If faces join by vertices, every vertex has a turn, and a pseudo-source has another one
    /// whenever it improves. Else only pseudo-sources have turns.
    #[inline]
    fn offer<B: Probe>(&mut self, v: u32, d: f64, way: impl FnOnce() -> (u32, Way), probe: &mut B) {
        let i = v as usize;
        if d < self.distances[i] {
            if B::TRACES {
                let (corner, way) = way();
                probe.reach(VertexId::new(v), HalfEdgeId::new(corner), way);
            }
            self.distances[i] = d;
            if (S::BY_VERTEX && !self.passed[i]) || self.layout.vertices[i].pseudo_source {
                probe.enter(Phase::Management);
                self.schedule.push_vertex(v, d, probe);
                probe.enter(Phase::Propagation);
            }
        }
    }

    /// The turn of vertex `v`. It sends windows if it is a source or pseudo-source, and the faces
    /// around it may join the traversed area.
    fn pass<B: Probe>(&mut self, v: u32, is_source: bool, probe: &mut B) {
        self.front.advance();
        self.passed[v as usize] = true;
        if S::BY_VERTEX || is_source {
            for &h in self.layout.ring(v) {
                self.front.join(parts(h).0);
            }
        }
        if is_source || self.layout.vertices[v as usize].pseudo_source {
            probe.enter(Phase::Propagation);
            self.spawn(v, probe);
            probe.enter(Phase::Management);
        }
    }

    /// Offers distances along the edges of `v` and sends windows across its faces.
    fn spawn<B: Probe>(&mut self, v: u32, probe: &mut B) {
        probe.add(Counter::PseudoSources, 1);
        let sigma = self.distances[v as usize];
        let has_border = self.layout.vertices[v as usize].boundary;
        for place in self.layout.ring_places(v) {
            let h = self.layout.rings[place];
            let spawn = self.layout.spawn(h, sigma);
            let (f, corner) = parts(h);
            let along = |corner, way| move || (half_edge(f as u32, corner), way);
            let ways = [
                along(next(corner), Way::FromHead),
                along(prev(corner), Way::FromTail),
            ];
            let [to_a, to_b] = ways;
            self.offer(spawn.ends[0], spawn.paths[0], to_a, probe);
            if has_border {
                self.offer(spawn.ends[1], spawn.paths[1], to_b, probe);
            }
            if spawn.exit == NO_TWIN {
                continue;
            }
            probe.add(Counter::Spawned, 1);
            let mut window = spawn.window;
            if B::COUNTS {
                let [_, _, px, py, _] = window;
                self.levels.start(spawn.exit, [px, py], sigma);
            }
            if self.kept.holds(spawn.exit as usize) {
                let Some(part) = admit(&mut self.kept, spawn.exit, window) else {
                    probe.add(Counter::Filtered, 1);
                    continue;
                };
                window = part;
            }
            let (list, len) = self.front.push(spawn.exit, ChildSide::AsRightChild, window);
            self.close(spawn.exit, list, len, probe);
        }
        probe.raise(Counter::PeakWindows, self.front.waiting() as u64);
        probe.raise(Counter::PeakWavefront, self.front.waiting() as u64);
    }

    /// Called when all windows for half-edge `h` have arrived; those in `list` from `start` on are
    /// new.
    #[inline]
    fn close<B: Probe>(&mut self, h: u32, list: u32, start: usize, probe: &mut B) {
        if !S::BY_VERTEX && !self.front.contains(parts(h).0) {
            let gate = self.layout.gate(h, [f64::INFINITY; 2]);
            let program = Least {
                list: self.front.store.columns(list),
                start,
                gate: &gate,
                keep: &mut self.active.keep,
            };
            let mut offer = self.simd.run(program);
            if self.kept.is_beside(h as usize) {
                // Beside a thin face, windows may wind around a needle at less than the offer.
                offer = self.front.least_distance(h);
            }
            self.schedule.wait(parts(h).0 as u32, offer, probe);
        }
        self.front.make_ready(h);
    }

    /// Propagates the list on `h` across its face.
    fn cross<B: Probe>(&mut self, h: u32, probe: &mut B) {
        let (f, corner) = parts(h);
        let face = self.layout.faces[f];
        let [tail, head, apex] = [corner, next(corner), prev(corner)].map(|k| face.vertex[k]);
        let gate = Gate {
            l: face.length[corner],
            apex: face.apex(corner),
            ends: [tail, head].map(|v| self.distances[v as usize]),
            longest: self.layout.longest_edge,
        };
        probe.enter(Phase::Pruning);
        let arrived: usize = self.front.lists(h).iter().map(Columns::len).sum();
        if self.kept.may_have_replaced(h as usize) {
            self.front.drop_replaced(h, &self.kept);
            self.kept.note_crossing(h as usize);
        }
        let lists = self.front.lists(h);
        let (active, layout) = (&mut self.active, &self.layout);
        let mut tally = PairTally::default();
        let found = if B::COUNTS {
            let program = Inspect::<P, _>::new(lists, active, layout, h, &gate, &mut tally);
            self.simd.run(program)
        } else {
            let mut none = ();
            let program = Inspect::<P, _>::new(lists, active, layout, h, &gate, &mut none);
            self.simd.run(program)
        };
        self.front.clear(h);
        probe.enter(Phase::Propagation);
        // Comparisons may split a window into several.
        probe.add(
            Counter::Filtered,
            arrived.saturating_sub(self.active.len) as u64,
        );
        probe.add(Counter::Parents, self.active.len as u64);
        if B::STOPS {
            self.end_check.advance(self.active.len);
        }
        if self.active.len > arrived {
            let alive = (self.front.waiting() + self.active.len) as u64;
            probe.raise(Counter::PeakWindows, alive);
            probe.raise(Counter::PeakWavefront, alive);
        }
        if B::COUNTS {
            tally.add_to(probe);
            // Only windows that start at the vertex behind the edge have their source there.
            let behind = self.layout.behind(h);
            let children = self.active.iter().filter(|w| w.source() != behind);
            probe.add(Counter::Kept, children.count() as u64);
        }
        if probe.wants_sample(self.active.len as u64) {
            probe.sample(
                self.front
                    .windows()
                    .chain(self.active.iter())
                    .map(|w| Window::min_distance(&w)),
            );
            if probe.wants_windows() {
                let (layout, front) = (&self.layout, &self.front);
                let crossing = self.active.iter().map(|w| (layout.ends(h), w));
                let waiting = layout
                    .half_edges()
                    .flat_map(|h| front.windows_on(h).map(move |w| (layout.ends(h), w)));
                probe.take_windows(crossing.chain(waiting));
            }
        }
        if self.active.len > 0 {
            let (best, distance) = BestPath::shortest(
                self.active.columns(),
                (found.best, found.distance),
                &gate,
                || [prev(corner), next(corner)].map(|k| face.length[k]),
            );
            let way = || {
                let way = Way::through(best.entry, best.source, gate.l);
                (half_edge(f as u32, prev(corner)), way)
            };
            self.offer(apex, distance, way, probe);
            let crossing = tally.crossing;
            self.send_children(h, &face, gate, best, distance, found.bound, crossing, probe);
        }
        if B::COUNTS {
            self.levels.forget(h);
        }
        probe.enter(Phase::Management);
        probe.raise(Counter::PeakWindows, self.front.waiting() as u64);
        probe.raise(Counter::PeakWavefront, self.front.waiting() as u64);
    }

    /// Propagates the active list through the exits that are open to each window; `bound` limits
    /// the numbers of children. In runs that count, the filter has left `crossing` windows.
    #[allow(clippy::too_many_arguments)] // Private, and one step of `cross`.
    #[inline]
    fn send_children<B: Probe>(
        &mut self,
        h: u32,
        face: &FaceLayout,
        gate: Gate,
        best: BestPath,
        distance: f64,
        bound: [usize; 2],
        crossing: usize,
        probe: &mut B,
    ) {
        let (f, corner) = parts(h);
        let exits = self.layout.exits(h);
        let arrivals = [ChildSide::AsLeftChild, ChildSide::AsRightChild];
        let is_new = (M::PRESERVES_ORDER || B::COUNTS) && self.front.is_new(f);
        let (mut lists, mut alone) = ([NO_LIST; 2], [false; 2]);
        for side in 0..2 {
            let exit = exits[side];
            if exit != NO_TWIN && bound[side] > 0 {
                // A secondary merge.
                alone[side] = M::PRESERVES_ORDER && !is_new && !self.front.contains(parts(exit).0);
                lists[side] = self
                    .front
                    .reserve(exit, arrivals[side], bound[side], alone[side]);
            }
        }
        let before = lists.map(|list| self.front.store.len(list));
        let triangle = face.triangle(corner);
        let (carried, after) = {
            let rule = self.exits.enter(&ListCrossing {
                h,
                active: &self.active,
                gate,
                best,
                distance,
                front: &self.front,
                layout: &self.layout,
                simd: self.simd,
            });
            let blocks = self.front.store.blocks(lists);
            let mut targets = blocks.map(|block| Target {
                block,
                len: 0,
                open: false,
            });
            for side in 0..2 {
                targets[side].len = before[side];
                targets[side].open = exits[side] != NO_TWIN;
            }
            let carried = self.simd.run(Carry {
                active: &self.active,
                triangle: &triangle,
                rule: &rule,
                threshold: self.threshold,
                targets: &mut targets,
            });
            (carried, targets.map(|target| target.len))
        };
        let mut sent = Sent {
            exits,
            lists,
            before,
            after,
        };
        probe.enter(Phase::Management);
        sent.admit(&mut self.kept, &mut self.front.store);
        if B::COUNTS {
            let store = &self.front.store;
            let deepest = sent.record_levels(&mut self.levels, store, h, &triangle);
            probe.raise(Counter::Levels, u64::from(deepest));
        }
        let Sent { before, after, .. } = sent;
        for side in sent.sides() {
            let (exit, list) = (exits[side], lists[side]);
            if alone[side] {
                self.front.insert(exit, list, after[side]);
            } else {
                self.front.arrive(exit, arrivals[side], list, after[side]);
            }
            if after[side] == before[side] {
                continue;
            }
            if alone[side] {
                self.close_late(exit, probe);
            } else {
                self.close(exit, list, before[side], probe);
            }
        }
        let children = sent.children() + carried.tiny;
        let tried = carried.tried as u64;
        probe.add(Counter::Propagated, tried);
        probe.add(Counter::Children, children as u64);
        probe.add(Counter::Filtered, carried.tiny as u64);
        let counter = if is_new {
            Counter::Prime
        } else {
            Counter::Secondary
        };
        probe.add(counter, tried);
        if B::COUNTS {
            if !is_new && self.is_near_the_border(face) {
                probe.add(Counter::SecondaryNear, tried);
            }
            let open = exits.iter().filter(|exit| **exit != NO_TWIN).count();
            let closed = (open * crossing).saturating_sub(carried.tried);
            probe.add(Counter::Rule1, closed as u64);
        }
    }

    /// Whether a vertex of `face` lies on the border of the traversed area.
    fn is_near_the_border(&self, face: &FaceLayout) -> bool {
        let mut around = face.vertex.iter().flat_map(|&v| self.layout.ring(v));
        around.any(|&h| !self.front.contains(parts(h).0))
    }

    /// Called after windows have been inserted into the list on `h`, which waits.
    fn close_late<B: Probe>(&mut self, h: u32, probe: &mut B) {
        let list = self.front.first(h);
        self.close(h, list, 0, probe);
    }

    /// Prefetches the memory of the next lists.
    #[inline]
    fn prefetch(&self) {
        if let Some(h) = self.front.upcoming(6) {
            let f = parts(h).0;
            self.layout.prefetch(f);
            self.front.prefetch(f);
        }
        if let Some(h) = self.front.upcoming(3) {
            for exit in self.layout.exits(h) {
                self.front.prefetch(parts(exit).0);
            }
            let (f, corner) = parts(h);
            let apex = self.layout.faces[f].vertex[prev(corner)];
            prefetch(&self.distances, apex as usize);
        }
    }
}

impl<S: Schedule, M: Merge, P: Pairs, E: Exits> Propagate for ListPropagation<S, M, P, E> {
    fn counters() -> Vec<Counter> {
        let mut counters = vec![
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
            Counter::Levels,
            Counter::PseudoSources,
            Counter::Prime,
            Counter::Secondary,
            Counter::SecondaryNear,
        ];
        counters.extend(P::COUNTERS);
        counters.extend(E::IS_RULE_1.then_some(Counter::Rule1));
        counters
    }

    fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    fn splice(&mut self, splice: &Splice) -> Option<Splice> {
        let around = self.layout.around(&self.mesh, &self.numbering, splice);
        let undo = self.mesh.splice(splice);
        self.layout
            .splice(&self.mesh, &self.numbering, splice, &around);
        let faces = self.mesh.face_count();
        self.front.splice(faces, thin(&self.layout));
        self.schedule.resize(faces);
        self.exits.resize(faces);
        self.kept.clone_from(&self.layout.kept);
        Some(undo)
    }

    fn runs(&self) -> CompiledRuns<Self> {
        self.runs
    }

    fn propagate<B: Probe>(&mut self, sources: &[VertexId], probe: &mut B) -> Solution {
        self.reset();
        probe.add(Counter::WindowBytes, size_of::<Window>() as u64);
        let sources: Vec<u32> = sources
            .iter()
            .map(|&s| self.numbering.new_vertex(s).raw())
            .collect();
        for &s in &sources {
            self.distances[s as usize] = 0.0;
        }
        for &s in &sources {
            self.pass(s, true, probe);
        }
        loop {
            while let Some(h) = self.front.next_ready() {
                self.prefetch();
                self.cross(h, probe);
            }
            if let Some(h) = self.front.next_thin(self.schedule.next()) {
                self.cross(h, probe);
                continue;
            }
            let turn = self.schedule.pop();
            if let Some((d, _)) = turn
                && B::STOPS
                && self.ends(d, probe)
            {
                break;
            }
            match turn {
                // An entry is void once its vertex has improved or its face has joined.
                Some((d, Scheduled::Vertex(v))) if d == self.distances[v as usize] => {
                    self.pass(v, false, probe);
                }
                Some((_, Scheduled::Face(f))) if !self.front.contains(f as usize) => {
                    self.front.advance();
                    self.front.join(f as usize);
                }
                Some(_) => {}
                None => break,
            }
        }
        self.layout.renumber(&self.mesh, &self.numbering, probe);
        Solution::new(self.numbering.restore(&self.distances))
    }
}
