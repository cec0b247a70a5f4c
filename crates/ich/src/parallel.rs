//! Chen and Han's algorithm in parallel: rounds of windows that are propagated at the same time.

use std::collections::BTreeMap;

use geobench_mesh::{HalfEdgeId, Mesh, Splice, VertexId};
use geobench_window::continuous::{EdgeView, Surface};
use geobench_window::queue::mean_edge_length;
use geobench_window::trimming::KeptWindows;
use geobench_window::{
    CompiledRuns, Counter, Crossing, Exit, Phase, Probe, Propagate, Side, Solution, SolveError,
    Way, Window, length_past_end, spawn_window,
};
use rayon::iter::{IndexedParallelIterator, ParallelIterator};
use rayon::slice::{ParallelSlice, ParallelSliceMut};
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::angle::{Angles, Split};
use crate::route::{Route, Routes};
use crate::splitting::{is_beaten_beside_thin_faces, is_stale};
use crate::tree::Lineage;

/// The largest number of threads.
const MOST_THREADS: usize = 1024;

/// Number of windows of a task. Results depend on it through the order of waiting windows, but not
/// on the number of threads.
const CHUNK: usize = 512;

/// The algorithm of Chen and Han on several threads, with the filter of ICH.
///
/// Ying, Xin and He, "Parallel Chen-Han (PCH) algorithm for discrete geodesics" (2014). Windows are
/// taken in rounds, each with all windows of one bucket of distances. A round has four steps:
///
/// 1. All windows compute their paths to the apices of their faces, in parallel.
/// 2. One thread updates the distances of vertices and the records of one angle, one split.
/// 3. All windows are split, and their children are filtered by the new distances, in parallel.
/// 4. The children are put into the buckets of their distances.
///
/// Distances and counts do not depend on the number of threads. As for ICH1, the time is O(n²), and
/// the wavefront has no bound; hence the filter.
///
/// ```
/// use geobench_ich::{Pch, ich};
/// use geobench_mesh::Mesh;
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("terrain,n=8,seed=1")?;
/// let [parallel, serial] = [Pch::new(&mesh, 2).distances_from(5)?, ich(&mesh).distances_from(5)?];
/// assert!(parallel.iter().zip(&serial).all(|(a, b)| (a - b).abs() <= 1e-12 * b));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Pch {
    mesh: Mesh,
    surface: Surface,
    angles: Angles,
    routes: Routes,
    kept: KeptWindows,
    buckets: DistanceBuckets,
    threads: usize,
    /// `None` for one thread, or if the system did not start the threads.
    pool: Option<ThreadPool>,
}

impl Pch {
    /// Width of a bucket, in mean edge lengths.
    pub const BUCKET: f64 = 0.1;

    /// Sets up for `mesh`; O(faces). `threads` is clamped to 1..=1024. If the system does not start
    /// them, solving returns an error.
    pub fn new(mesh: &Mesh, threads: usize) -> Self {
        Self::with_bucket(mesh, threads, Self::BUCKET)
    }

    /// As [`new`](Self::new), with another bucket width, in mean edge lengths. Wider buckets mean
    /// fewer rounds of more windows, some of which shorter ones would have beaten.
    pub fn with_bucket(mesh: &Mesh, threads: usize, bucket: f64) -> Self {
        let threads = threads.clamp(1, MOST_THREADS);
        let order = Surface::order(mesh);
        let pool = || ThreadPoolBuilder::new().num_threads(threads).build().ok();
        Self {
            mesh: mesh.clone(),
            surface: Surface::new(mesh),
            angles: Angles::new(mesh.half_edge_count()),
            routes: Routes::default(),
            kept: KeptWindows::new(mesh, mesh.half_edge_count(), |h| {
                order.new_half_edge(h).index()
            }),
            buckets: DistanceBuckets {
                width: bucket * mean_edge_length(mesh),
                ..DistanceBuckets::default()
            },
            threads,
            pool: (threads > 1).then(pool).flatten(),
        }
    }

    /// The number of threads.
    pub fn threads(&self) -> usize {
        self.threads
    }

    /// Offers `v` a path of length `d`; returns whether it is the shortest so far.
    fn offer(&mut self, v: VertexId, d: f64) -> bool {
        let improves = self.surface.offer(v, d);
        if improves && self.mesh.is_pseudo_source(v) {
            self.buckets.at(d).vertices.push((d, v));
        }
        improves
    }

    /// Offers distances along the edges of `v` and sends windows across its faces.
    fn spawn<P: Probe>(&mut self, v: VertexId, probe: &mut P) {
        probe.add(Counter::PseudoSources, 1);
        let sigma = self.surface.distance(v);
        let degree = self.mesh.outgoing(v).len();
        for i in 0..degree {
            let h = self.surface.faces().number(self.mesh.outgoing(v)[i]);
            for path in self.surface.faces().edge_paths(h) {
                if self.offer(path.end, sigma + path.length) && P::TRACES {
                    probe.reach(path.end, path.corner, path.way);
                }
            }
        }
        let lineage = Lineage::new(v);
        for i in 0..degree {
            let h = self.surface.faces().number(self.mesh.outgoing(v)[i]);
            if let Some((h, window)) = spawn_window(self.surface.faces(), h, sigma) {
                probe.add(Counter::Spawned, 1);
                let edge = self.surface.edge(h);
                let waiting = WaitingWindow { h, window, lineage };
                if is_beaten(&waiting, &edge, &self.kept, &self.surface) || !self.wait(waiting) {
                    probe.add(Counter::Filtered, 1);
                }
            }
        }
    }

    /// Lets a window wait, at a gate on all half-edges beyond; returns whether any part of it is
    /// left.
    fn wait(&mut self, waiting: WaitingWindow) -> bool {
        let WaitingWindow { h, window, lineage } = waiting;
        if !self.kept.holds(h.index()) {
            self.put(waiting);
            return true;
        }
        let route = lineage.route();
        let crossed = (self.routes).cross(h, &window, route, &self.surface);
        let Some(crossed) = crossed.map(Iterator::collect::<Vec<_>>) else {
            return self.store(waiting, route);
        };
        let mut kept = false;
        for (h, window, route) in crossed {
            kept |= self.store(WaitingWindow { h, window, lineage }, route);
        }
        kept
    }

    /// Stores the part of a window that is shorter than those stored before, and lets it wait.
    fn store(&mut self, mut waiting: WaitingWindow, route: Route) -> bool {
        let Some(part) = self.kept.admit(waiting.h.index(), &waiting.window) else {
            return false;
        };
        waiting.window = part;
        waiting.lineage.go_on(route);
        self.put(waiting);
        true
    }

    /// Puts a window into its bucket.
    fn put(&mut self, waiting: WaitingWindow) {
        let label = waiting.window.min_distance();
        self.buckets.at(label).windows.push(waiting);
        self.buckets.waiting += 1;
    }

    /// Propagates `windows`: steps 1 to 4 of a round.
    fn cross<P: Probe>(
        &mut self,
        windows: &[WaitingWindow],
        steps: &mut Vec<Examination>,
        probe: &mut P,
    ) {
        probe.enter(Phase::Propagation);
        steps.clear();
        steps.resize(windows.len(), Examination::default());
        let (surface, angles, kept) = (&self.surface, &self.angles, &self.kept);
        let reach = |(windows, steps): (&[WaitingWindow], &mut [Examination])| {
            for (window, step) in windows.iter().zip(steps) {
                *step = Examination::of(window, surface, angles, kept);
            }
        };
        match &self.pool {
            Some(pool) if windows.len() > CHUNK => pool.install(|| {
                let pairs = windows.par_chunks(CHUNK).zip(steps.par_chunks_mut(CHUNK));
                pairs.for_each(reach);
            }),
            _ => reach((windows, steps)),
        }
        probe.enter(Phase::Management);
        for (waiting, step) in windows.iter().zip(&mut *steps) {
            self.settle(waiting, step, probe);
        }
        probe.enter(Phase::Propagation);
        let (surface, kept, width) = (&self.surface, &self.kept, self.buckets.width);
        let part = |windows: &[WaitingWindow], steps: &[Examination]| {
            let mut children = TaskChildren::new(width);
            for (waiting, step) in windows.iter().zip(steps) {
                children.split(waiting, step, surface, kept);
            }
            children
        };
        let parts: Vec<TaskChildren> = match &self.pool {
            Some(pool) if windows.len() > CHUNK => pool.install(|| {
                let pairs = windows.par_chunks(CHUNK).zip(steps.par_chunks(CHUNK));
                pairs.map(|(windows, steps)| part(windows, steps)).collect()
            }),
            _ => {
                let pairs = windows.chunks(CHUNK).zip(steps.chunks(CHUNK));
                pairs.map(|(windows, steps)| part(windows, steps)).collect()
            }
        };
        probe.enter(Phase::Management);
        for part in parts {
            self.gather(part, probe);
        }
    }

    /// Step 2 of a round, for one window.
    fn settle<P: Probe>(&mut self, waiting: &WaitingWindow, step: &mut Examination, probe: &mut P) {
        if step.kind == CrossingKind::Stale {
            probe.add(Counter::Filtered, 1);
            return;
        }
        probe.add(Counter::Parents, 1);
        let h = waiting.h;
        let [tail, head, apex] = self.surface.faces().corners(h);
        if step.d < self.surface.distance(apex) && !step.covers {
            let frame = self.surface.faces().frame(h);
            let ends = [tail, head].map(|v| self.surface.distance(v));
            let (entry, sides) = (waiting.window.entry(&frame), [frame.la, frame.lb]);
            step.d = length_past_end(step.d, entry, frame.l, ends, sides);
        }
        if self.offer(apex, step.d) && P::TRACES {
            let way = Way::of(&waiting.window, &self.surface.faces().frame(h));
            probe.reach(apex, h.prev(), way);
        }
        if step.kind == CrossingKind::Covers {
            step.angle = self.angles.number(h, waiting.lineage.route());
            step.kind = match self.angles.split(step.angle, step.d, step.entry) {
                Split::Occupies => CrossingKind::Occupies,
                Split::Ties => CrossingKind::Covers,
                Split::Only(side) => CrossingKind::OneSide(side),
            };
        }
    }

    /// Step 4 of a round, for one task.
    fn gather<P: Probe>(&mut self, part: TaskChildren, probe: &mut P) {
        probe.add(Counter::Propagated, part.tried);
        probe.add(Counter::Children, part.made);
        probe.raise(Counter::Levels, u64::from(part.level));
        let mut kept = 0;
        for (bucket, mut windows) in part.buckets {
            if self.kept.is_empty() {
                kept += windows.len();
                self.buckets.waiting += windows.len();
                self.buckets.number(bucket).windows.append(&mut windows);
            } else {
                kept += windows.into_iter().filter(|&w| self.wait(w)).count();
            }
        }
        probe.add(Counter::Kept, kept as u64);
        probe.add(Counter::Filtered, part.made - kept as u64);
    }
}

/// A window that waits to be propagated.
#[derive(Clone, Copy, Debug)]
struct WaitingWindow {
    h: HalfEdgeId,
    window: Window,
    lineage: Lineage,
}

/// Whether a path through one of the vertices around beats all rays of a window, by more than the
/// doubt beside thin faces.
fn is_beaten(
    waiting: &WaitingWindow,
    edge: &EdgeView,
    kept: &KeptWindows,
    surface: &Surface,
) -> bool {
    let WaitingWindow { h, window, .. } = *waiting;
    edge.beats(&window)
        && (window.min_distance() >= kept.reach()
            || is_beaten_beside_thin_faces(h, window, kept, surface))
}

/// How a window crosses a face.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum CrossingKind {
    /// Not at all: the window is stale.
    #[default]
    Stale,
    /// On one side of the apex only.
    OneSide(Side),
    /// On both sides.
    Covers,
    /// On both sides, as the new occupant of the angle.
    Occupies,
}

/// The result of step 1 for one window.
#[derive(Clone, Copy, Debug, Default)]
struct Examination {
    /// The distance that the window offers to the apex.
    d: f64,
    /// The fraction of the half-edge at which its ray to the apex enters, if it covers the apex.
    entry: f64,
    /// The number of the angle at the apex, if the window occupies it.
    angle: u32,
    kind: CrossingKind,
    covers: bool,
}

impl Examination {
    /// Step 1 of a round.
    fn of(waiting: &WaitingWindow, surface: &Surface, angles: &Angles, kept: &KeptWindows) -> Self {
        let WaitingWindow { h, window, lineage } = waiting;
        if is_stale(*h, window, lineage, surface, angles, kept) {
            return Self::default();
        }
        let view = surface.faces().face_view(*h);
        let crossing = Crossing::new(&view.frame, window);
        if crossing.covers_apex() {
            return Self {
                d: crossing.straight_distance(),
                entry: crossing.entry(),
                kind: CrossingKind::Covers,
                covers: true,
                ..Self::default()
            };
        }
        let side = crossing.side();
        Self {
            d: crossing.bent_distance(&view.exit(side)),
            kind: CrossingKind::OneSide(side),
            ..Self::default()
        }
    }
}

/// The children of the windows of one task.
#[derive(Debug)]
struct TaskChildren {
    width: f64,
    /// The children that pass the filter, by bucket, in no order.
    buckets: Vec<(u64, Vec<WaitingWindow>)>,
    tried: u64,
    made: u64,
    level: u32,
}

impl TaskChildren {
    fn new(width: f64) -> Self {
        Self {
            width,
            buckets: Vec::new(),
            tried: 0,
            made: 0,
            level: 0,
        }
    }

    /// Step 3 of a round, for one window.
    fn split(
        &mut self,
        waiting: &WaitingWindow,
        step: &Examination,
        surface: &Surface,
        kept: &KeptWindows,
    ) {
        let WaitingWindow { h, window, lineage } = waiting;
        if step.kind == CrossingKind::Stale {
            return;
        }
        let view = surface.faces().face_view(*h);
        let crossing = Crossing::new(&view.frame, window);
        let inherited = Lineage {
            level: lineage.level.next(),
            ..*lineage
        };
        for side in [Side::Left, Side::Right] {
            let exit = view.exit(side);
            let takes = match step.kind {
                CrossingKind::OneSide(only) => only == side,
                _ => true,
            };
            // For a window that passes the apex on one side, the other exit counts as tried as
            // well.
            self.tried += u64::from(exit.half_edge.is_some() && (takes || !step.covers));
            if !takes {
                continue;
            }
            let child = match side {
                _ if !step.covers => crossing.only_child(&exit),
                Side::Left => crossing.left_child(&exit),
                Side::Right => crossing.right_child(&exit),
            };
            let lineage = match step.kind {
                CrossingKind::Occupies => inherited.split(step.angle, step.entry, side),
                _ => inherited,
            };
            self.send(child, &exit, lineage, surface, kept);
        }
    }

    fn send(
        &mut self,
        child: Option<Window>,
        exit: &Exit,
        lineage: Lineage,
        surface: &Surface,
        kept: &KeptWindows,
    ) {
        let (Some(h), Some(window)) = (exit.half_edge, child) else {
            return;
        };
        self.made += 1;
        let edge = EdgeView::behind(exit, exit.corners.map(|v| surface.distance(v)));
        let waiting = WaitingWindow { h, window, lineage };
        if is_beaten(&waiting, &edge, kept, surface) {
            return;
        }
        self.level = self.level.max(lineage.level.count());
        let bucket = bucket(window.min_distance(), self.width);
        match self.buckets.iter_mut().find(|(other, _)| *other == bucket) {
            Some((_, windows)) => windows.push(waiting),
            None => self.buckets.push((bucket, vec![waiting])),
        }
    }
}

/// The bucket of a label.
#[expect(clippy::cast_sign_loss, reason = "no label is negative")]
fn bucket(label: f64, width: f64) -> u64 {
    (label / width) as u64
}

/// Waiting windows and pseudo-sources in buckets of distance.
#[derive(Clone, Debug, Default)]
struct DistanceBuckets {
    width: f64,
    by_number: BTreeMap<u64, Bucket>,
    /// Number of windows.
    waiting: usize,
}

#[derive(Clone, Debug, Default)]
struct Bucket {
    windows: Vec<WaitingWindow>,
    /// Pseudo-sources, with the distances under which they wait.
    vertices: Vec<(f64, VertexId)>,
}

impl DistanceBuckets {
    fn at(&mut self, label: f64) -> &mut Bucket {
        self.number(bucket(label, self.width))
    }

    fn number(&mut self, bucket: u64) -> &mut Bucket {
        self.by_number.entry(bucket).or_default()
    }

    fn clear(&mut self) {
        self.by_number.clear();
        self.waiting = 0;
    }
}

impl Propagate for Pch {
    const JUNCTIONS: bool = true;

    fn counters() -> Vec<Counter> {
        vec![
            Counter::Propagated,
            Counter::Parents,
            Counter::Children,
            Counter::Kept,
            Counter::Spawned,
            Counter::Filtered,
            Counter::PeakWindows,
            Counter::PeakWavefront,
            Counter::WindowBytes,
            Counter::Iterations,
            Counter::KPeak,
            Counter::Levels,
            Counter::PseudoSources,
        ]
    }

    fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    #[inline(never)]
    fn runs(&self) -> CompiledRuns<Self> {
        CompiledRuns::new()
    }

    fn check(&self) -> Result<(), SolveError> {
        let threads = self.threads;
        if threads > 1 && self.pool.is_none() {
            return Err(SolveError::NoThreads { threads });
        }
        Ok(())
    }

    fn splice(&mut self, splice: &Splice) -> Option<Splice> {
        let undo = self.mesh.splice(splice);
        let (mesh, half_edges) = (&self.mesh, self.mesh.half_edge_count());
        self.surface.splice(mesh, splice);
        self.angles.resize(half_edges);
        let faces = self.surface.faces();
        let number = |h| faces.number(h).index();
        self.kept.splice(mesh, splice, half_edges, number);
        Some(undo)
    }

    fn propagate<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) -> Solution {
        self.surface.reset(self.mesh.vertex_count());
        self.angles.clear();
        self.routes.clear();
        self.kept.clear();
        self.buckets.clear();
        probe.add(Counter::WindowBytes, size_of::<WaitingWindow>() as u64);
        for &s in sources {
            self.surface.offer(s, 0.0);
        }
        for &s in sources {
            self.spawn(s, probe);
        }
        let mut steps = Vec::new();
        while let Some((number, bucket)) = self.buckets.by_number.pop_first() {
            let bound = number as f64 * self.buckets.width;
            if P::STOPS && probe.is_reached(bound, |v| self.surface.distance(v)) {
                probe.end(bound);
                break;
            }
            let Bucket { windows, vertices } = bucket;
            probe.add(Counter::Iterations, 1);
            probe.raise(Counter::KPeak, windows.len() as u64);
            probe.raise(Counter::PeakWindows, self.buckets.waiting as u64);
            probe.raise(Counter::PeakWavefront, self.buckets.waiting as u64);
            self.buckets.waiting -= windows.len();
            if probe.wants_sample(windows.len() as u64) {
                let waiting = || {
                    let later = self.buckets.by_number.values().flat_map(|b| &b.windows);
                    windows.iter().chain(later)
                };
                probe.sample(waiting().map(|w| w.window.min_distance()));
                if probe.wants_windows() {
                    let faces = self.surface.faces();
                    probe.take_windows(waiting().map(|w| (faces.ends(w.h), w.window)));
                }
            }
            for (d, v) in vertices {
                // A vertex is queued anew whenever it improves; older entries are void.
                if self.surface.distance(v) == d {
                    self.spawn(v, probe);
                }
            }
            self.cross(&windows, &mut steps, probe);
        }
        if P::TRACES {
            let (mesh, faces) = (&self.mesh, self.surface.faces());
            probe.renumber(mesh, |v| v, |v, i| faces.number(mesh.outgoing(v)[i]));
        }
        Solution::new(self.surface.take_distances())
    }
}
