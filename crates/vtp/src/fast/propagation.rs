//! The main loop: buckets of vertices have their turns, and lists cross faces until all wait.

use geobench_mesh::{Mesh, Numbering, VertexId};
use geobench_window::{Counter, Phase, Probe, Propagate, Solution};

use super::options::Options;
use crate::engine::buckets::Buckets;
use crate::engine::dispatch::{self, Program};
use crate::engine::kernels::{self, BestPath, Cuts, Gate, Measured, Target, Triangle};
use crate::engine::lanes::{Lanes, Scalar};
use crate::engine::levels::Levels;
use crate::engine::prefetch::{line, prefetch};
use crate::engine::reunite::FEW;
use crate::engine::sample::Sample;
use crate::engine::shadow::Origin;
use crate::engine::store::{NO_LIST, WindowStore};
use crate::engine::surface::{NOBODY, Surface, next, parts, prev};

/// Improved distances wait for their consequences until so many have come together.
const IMPROVEMENTS: usize = 4096;

/// A path to the apex of `h` that was the shortest when it was found.
#[derive(Clone, Copy, Debug, Default)]
struct Improvement {
    h: u32,
    vertex: u32,
    /// Where it crosses `h`.
    entry: f64,
    /// Its length.
    distance: f64,
}

/// VTP for speed, on one mesh; see [the page](crate::algorithms::vtp_fast).
#[derive(Clone, Debug)]
pub struct VtpFast<'m> {
    mesh: &'m Mesh,
    pub(super) options: Options,
    /// Lists whose pairs are compared.
    compared: Sample,
    /// Whether windows parted by flat vertices become one again.
    reunites: bool,
    numbering: Numbering,
    pub(super) surface: Surface,
    pub(super) store: WindowStore,
    /// Half-edges whose lists are about to cross.
    ready: Vec<u32>,
    /// The number of this run: faces that joined in it belong to the traversed area.
    pub(super) run: u8,
    pub(super) buckets: Buckets,
    pub(super) distances: Vec<f64>,
    /// Vertices whose turn has come.
    passed: Vec<bool>,
    /// The distance at which each pseudo-source has sent out windows last.
    pub(super) spawned: Vec<f64>,
    /// How the shortest path reached each pseudo-source.
    pub(super) origins: Vec<Origin>,
    improvements: Vec<Improvement>,
    improved: usize,
    keep: Vec<u8>,
    cuts: Cuts,
    pub(super) levels: Levels,
}

impl<'m> VtpFast<'m> {
    /// Sets up for `mesh`, with every improvement; O(faces).
    pub fn new(mesh: &'m Mesh) -> Self {
        Self::with_options(mesh, Options::default())
    }

    /// Sets up for `mesh`; O(faces).
    pub fn with_options(mesh: &'m Mesh, options: Options) -> Self {
        let instructions = options.instructions.or_less();
        let mut numbering = if options.renumber {
            Numbering::breadth_first(mesh)
        } else {
            Numbering::same()
        };
        let surface = Surface::new(mesh, &numbering);
        numbering.keep_new_vertices();
        let vertices = mesh.vertex_count();
        Self {
            mesh,
            options: Options {
                instructions,
                ..options
            },
            buckets: Buckets::new(vertices, options.bucket * surface.mean_length),
            compared: Sample::new(options.pairs),
            reunites: options.reunite && surface.has_many_flat_vertices(),
            numbering,
            surface,
            store: WindowStore::new(),
            ready: Vec::new(),
            run: 0,
            distances: Vec::new(),
            passed: Vec::new(),
            spawned: Vec::new(),
            origins: vec![Origin::default(); vertices],
            improvements: vec![Improvement::default(); IMPROVEMENTS],
            improved: 0,
            keep: Vec::new(),
            cuts: Cuts::default(),
            levels: Levels::default(),
        }
    }

    /// The options in force, with instructions that the processor has.
    pub fn options(&self) -> Options {
        self.options
    }

    /// Every list and queue is empty after a run, so there is only what the run has learnt.
    fn reset(&mut self) {
        if self.run == u8::MAX {
            self.run = 0;
            for face in &mut self.surface.faces {
                face.joined = 0;
            }
        }
        self.run += 1;
        self.buckets.reset();
        self.levels.clear();
        let vertices = self.mesh.vertex_count();
        for distances in [&mut self.distances, &mut self.spawned] {
            distances.clear();
            distances.resize(vertices, f64::INFINITY);
        }
        self.passed.clear();
        self.passed.resize(vertices, false);
    }

    /// Queues the list on half-edge `corner` of `face` if that has joined.
    #[inline(always)]
    pub(super) fn make_ready(&mut self, face: usize, corner: usize) {
        let record = &mut self.surface.faces[face];
        if record.joined == self.run && !record.queued[corner] {
            record.queued[corner] = true;
            self.ready
                .push(crate::engine::surface::half_edge(face as u32, corner));
        }
    }

    /// The turn of vertex `v`: the faces around it join the traversed area.
    fn pass<P: Probe>(&mut self, v: u32, probe: &mut P) {
        self.passed[v as usize] = true;
        for place in self.surface.ring_places(v) {
            let (face, _) = parts(self.surface.rings[place]);
            let record = &mut self.surface.faces[face];
            if record.joined != self.run {
                record.joined = self.run;
                for corner in 0..3 {
                    if self.surface.faces[face].list[corner] != NO_LIST {
                        self.make_ready(face, corner);
                    }
                }
            }
        }
        self.spawn_if_nearer(v, probe);
    }

    /// The consequences of distances that have improved.
    fn settle<P: Probe>(&mut self, probe: &mut P) {
        for i in 0..std::mem::take(&mut self.improved) {
            let Improvement {
                h,
                vertex,
                entry,
                distance,
            } = self.improvements[i];
            let v = vertex as usize;
            if distance > self.distances[v] {
                // What came later has its own consequences.
                continue;
            }
            if self.surface.vertices[v].pseudo_source {
                self.origins[v] = Origin { h, entry };
                if self.passed[v] {
                    self.spawn_if_nearer(vertex, probe);
                    continue;
                }
            }
            if !self.passed[v] {
                let news = self.buckets.push(vertex, self.distances[v]);
                probe.add(Counter::QueuePushes, u64::from(news));
            }
        }
        probe.raise(Counter::QueuePeak, self.buckets.len() as u64);
    }

    /// All turns and crossings; windows are reunited if `REUNITE`, of which nothing is left otherwise in the code that runs.
    ///
    /// # Safety
    ///
    /// The processor must know the instructions of `L`.
    #[allow(unsafe_code)] // For a processor with the instructions of `L`, which only the caller knows.
    #[inline(always)]
    unsafe fn run<L: Lanes, P: Probe, const REUNITE: bool>(&mut self, probe: &mut P) {
        let mut turn = Vec::new();
        loop {
            let mut place = 0;
            loop {
                if place == self.ready.len() || self.improved == IMPROVEMENTS {
                    self.settle(probe);
                }
                let Some(&h) = self.ready.get(place) else {
                    break;
                };
                self.prefetch_face(place + 6);
                self.prefetch_beyond(place + 3);
                place += 1;
                if REUNITE && L::COUNT > 1 && self.waiting_at(h) <= FEW {
                    // SAFETY: every processor can count to one.
                    unsafe { self.cross::<Scalar, P, REUNITE>(h, probe) };
                } else {
                    // SAFETY: promised by the caller.
                    unsafe { self.cross::<L, P, REUNITE>(h, probe) };
                }
            }
            self.ready.clear();
            if !self.buckets.pop(&mut turn) {
                break;
            }
            probe.add(Counter::Iterations, 1);
            for (i, &v) in turn.iter().enumerate() {
                if let Some(&v) = turn.get(i + 6) {
                    self.prefetch_ring(v);
                }
                self.pass(v, probe);
            }
        }
    }

    /// How many windows wait on `h`.
    #[inline(always)]
    fn waiting_at(&self, h: u32) -> usize {
        let (f, corner) = parts(h);
        self.store.len(self.surface.faces[f].list[corner])
    }

    /// Takes the list on `h` across its face.
    ///
    /// # Safety
    ///
    /// The processor must know the instructions of `L`.
    #[allow(unsafe_code)] // For a processor with the instructions of `L`, which only the caller knows.
    #[inline(always)]
    unsafe fn cross<L: Lanes, P: Probe, const REUNITE: bool>(&mut self, h: u32, probe: &mut P) {
        let (f, corner) = parts(h);
        let (after, before) = (next(corner), prev(corner));
        let face = &mut self.surface.faces[f];
        face.queued[corner] = false;
        let list = std::mem::replace(&mut face.list[corner], NO_LIST);
        let [tail, head, apex] = [corner, after, before].map(|k| face.vertex[k]);
        let exits = [face.twin[before], face.twin[after]];
        let triangle = face.triangle(corner);
        let arrived = self.store.len(list);
        let mut len = arrived;
        probe.enter(Phase::Pruning);
        if self.compared.takes(h, len) {
            let block = self.store.block_and_line_behind(list);
            // SAFETY: promised by the caller.
            len = unsafe { kernels::compare::<L>(block, len, &mut self.cuts) };
        }
        let gate = Gate {
            l: triangle.l,
            apex: triangle.apex,
            ends: [self.distances[tail as usize], self.distances[head as usize]],
        };
        let block = self.store.block(list);
        // SAFETY: promised by the caller.
        let found = unsafe { kernels::measure::<L, true>(block, 0, len, &gate, &mut self.keep) };
        probe.enter(Phase::Propagation);
        probe.add(Counter::Filtered, (arrived - found.kept) as u64);
        probe.add(Counter::Parents, found.kept as u64);
        if probe.wants_sample(found.kept as u64) {
            probe.sample(self.store.windows().map(|w| w.min_distance()));
        }
        if found.kept > 0 {
            let best = BestPath::of(self.store.block(list), found.best, gate.apex, gate.l);
            // The consequences wait: whether a path is the shortest is hard to predict.
            let known = &mut self.distances[apex as usize];
            let nearer = found.distance < *known;
            *known = if nearer { found.distance } else { *known };
            self.improvements[self.improved] = Improvement {
                h,
                vertex: apex,
                entry: best.entry,
                distance: found.distance,
            };
            self.improved += usize::from(nearer);
            // SAFETY: promised by the caller.
            unsafe {
                self.send::<L, P, REUNITE>(list, h, exits, &triangle, &found, &best, probe);
            };
        }
        probe.enter(Phase::Management);
        self.store.set_len(list, 0);
        if P::COUNTS {
            self.levels.forget(h);
        }
        probe.raise(Counter::PeakWindows, self.store.waiting() as u64);
    }

    /// Sends what `found` counted in the `list` on `h` across its face, which is `triangle`, into the lists behind its two
    /// exits.
    ///
    /// # Safety
    ///
    /// The processor must know the instructions of `L`.
    #[allow(unsafe_code)] // For a processor with the instructions of `L`, which only the caller knows.
    #[allow(clippy::too_many_arguments)] // All of what the caller has found out.
    #[inline(always)]
    unsafe fn send<L: Lanes, P: Probe, const REUNITE: bool>(
        &mut self,
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
            if exits[side] != NOBODY && found.bound[side] > 0 {
                let (f, k) = parts(exits[side]);
                lists[side] = self
                    .store
                    .reserve(self.surface.faces[f].list[k], found.bound[side]);
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
        // SAFETY: promised by the caller; `keep` and the bounds are of this list.
        let carried = unsafe {
            kernels::carry::<L, BestPath>(
                block,
                found.len,
                &self.keep,
                triangle,
                best,
                0.0,
                [&mut left, &mut right],
            )
        };
        let mut after = [left.len, right.len];
        let children = after[0] + after[1] - before[0] - before[1];
        probe.enter(Phase::Management);
        if P::COUNTS {
            let departure = self.levels.leave(h, triangle);
            for side in (0..2).filter(|&side| lists[side] != NO_LIST) {
                let children = self
                    .store
                    .windows_at(lists[side], before[side]..after[side]);
                let deepest = self.levels.arrive(exits[side], children, &departure, side);
                probe.raise(Counter::Levels, u64::from(deepest));
            }
        }
        if REUNITE {
            let (f, corner) = parts(h);
            let face = &self.surface.faces[f];
            after = self
                .store
                .reunite_behind(face, corner, lists, before, after);
        }
        for side in 0..2 {
            if lists[side] != NO_LIST {
                let (f, k) = parts(exits[side]);
                let list = self.store.set_len(lists[side], after[side]);
                self.surface.faces[f].list[k] = list;
                if list != NO_LIST {
                    self.make_ready(f, k);
                }
            }
        }
        probe.add(Counter::Propagated, carried.tried as u64);
        probe.add(Counter::Children, children as u64);
    }

    /// Asks for the face that the list at `place` of the queue will cross.
    #[inline(always)]
    fn prefetch_face(&self, place: usize) {
        if let Some(&h) = self.ready.get(place)
            && let Some(face) = self.surface.faces.get(parts(h).0)
        {
            line(face);
            line(&face.apex_x);
        }
    }

    /// Asks for what the list at `place` of the queue touches beyond its face.
    #[inline(always)]
    fn prefetch_beyond(&self, place: usize) {
        if let Some(&h) = self.ready.get(place) {
            let (f, corner) = parts(h);
            let face = &self.surface.faces[f];
            for twin in [face.twin[next(corner)], face.twin[prev(corner)]] {
                prefetch(&self.surface.faces, parts(twin).0);
            }
            prefetch(&self.distances, face.vertex[prev(corner)] as usize);
        }
    }

    /// Asks for the faces around `v`.
    #[inline(always)]
    fn prefetch_ring(&self, v: u32) {
        for &h in self.surface.ring(v) {
            prefetch(&self.surface.faces, parts(h).0);
        }
    }
}

/// A run whose sources have had their turns.
struct Turns<'s, 'm, P, const REUNITE: bool> {
    solver: &'s mut VtpFast<'m>,
    probe: &'s mut P,
}

impl<P: Probe, const REUNITE: bool> Program for Turns<'_, '_, P, REUNITE> {
    type Output = ();

    #[allow(unsafe_code)] // For a processor with the instructions of `L`, which only the caller knows.
    #[inline(always)]
    unsafe fn run<L: Lanes>(self) {
        // SAFETY: promised by the caller.
        unsafe { self.solver.run::<L, P, REUNITE>(self.probe) }
    }
}

impl Propagate for VtpFast<'_> {
    fn counters() -> Vec<Counter> {
        vec![
            Counter::Propagated,
            Counter::Parents,
            Counter::Children,
            Counter::Spawned,
            Counter::Filtered,
            Counter::PeakWindows,
            Counter::WindowBytes,
            Counter::QueuePushes,
            Counter::QueuePeak,
            Counter::Iterations,
            Counter::Levels,
            Counter::PseudoSources,
        ]
    }

    fn mesh(&self) -> &Mesh {
        self.mesh
    }

    fn propagate<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) -> Solution {
        self.reset();
        probe.add(Counter::WindowBytes, 40);
        let sources: Vec<u32> = sources
            .iter()
            .map(|&s| self.numbering.new_vertex(s).raw())
            .collect();
        for &s in &sources {
            self.distances[s as usize] = 0.0;
        }
        for &s in &sources {
            self.start_from(s, probe);
        }
        let instructions = self.options.instructions;
        let solver = &mut *self;
        if solver.reunites {
            dispatch::run(Turns::<P, true> { solver, probe }, instructions);
        } else {
            dispatch::run(Turns::<P, false> { solver, probe }, instructions);
        }
        Solution::new(self.numbering.restore(&self.distances))
    }
}

impl VtpFast<'_> {
    /// The turn of a source, which sends windows all around.
    fn start_from<P: Probe>(&mut self, s: u32, probe: &mut P) {
        if self.spawned[s as usize] > 0.0 {
            self.spawned[s as usize] = 0.0;
            self.spawn(s, true, probe);
            self.pass(s, probe);
        }
    }
}
