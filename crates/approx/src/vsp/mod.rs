//! Virtual source propagation: one unfolded source for each face.

mod face;

use std::collections::HashMap;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use geobench_mesh::threads::{self, Threads};
use geobench_mesh::{FaceId, Mesh, Numbering, Splice, VertexId};
use geobench_window::queue::{Heap, mean_edge_length};
use geobench_window::{
    CompiledRuns, Counter, Phase, Probe, Propagate, Solution, SolveError, prefetch,
};

use face::{BOUNDARY, CORNER, Edge, EnteringSource, Face, MOST_FACES, SADDLE, Source, UNREACHED};

/// Virtual source propagation (Trettner, Bommes and Kobbelt 2021), on one thread or several.
///
/// Every face keeps one *virtual source*: the place, unfolded into its plane, of the point where
/// its path last bent, and the length of the path up to there. A source crosses an edge into the
/// next face, or bends at an end of the edge if the next face does not see it, and stays there if
/// it brings the centroid a shorter distance than the source before. Distances of vertices are the
/// least over their faces. They may be too long or too short, by some 0.2 % in the mean. The number
/// of threads does not change them. On a mesh with [junctions](Mesh::junction) a point in a face
/// needs a new set-up.
///
/// ```
/// use geobench_approx::Vsp;
/// use geobench_mesh::Mesh;
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("sphere,subdiv=4")?;
/// let distances = Vsp::new(&mesh, 1).distances_from(0)?;
/// let p = mesh.positions();
/// for (q, d) in p.iter().zip(&distances) {
///     let angle = (0..3).map(|i| p[0][i] * q[i]).sum::<f64>().clamp(-1.0, 1.0).acos();
///     assert!((d - angle).abs() < 0.01 * angle.max(0.1));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Vsp {
    mesh: Mesh,
    threads: usize,
    /// `None` if the system does not start the threads.
    pool: Option<Threads>,
    numbering: Numbering,
    /// The unit of length inside the faces.
    mean_edge: f64,
    faces: Vec<Face>,
    /// The vertices of each face.
    corners: Vec<[VertexId; 3]>,
    /// The half-edges beyond each half-edge along a junction, and whether they have its direction.
    junctions: Vec<Vec<(Edge, bool)>>,
    has_pinched: bool,
}

/// A distance counts as shorter below this share of another. The rest is left to rounding.
const SHORTER: f32 = 1.0 - 1e-4;

/// Fewer candidates than this are the work of one thread.
const LITTLE: usize = 1024;

impl Vsp {
    /// Sets up for `mesh`; O(faces). Solves run on `threads` threads, at least one.
    ///
    /// # Panics
    ///
    /// If the mesh has 2^29 faces or more.
    pub fn new(mesh: &Mesh, threads: usize) -> Self {
        assert!(mesh.face_count() < MOST_FACES, "2^29 faces or more");
        let mut numbering = Numbering::breadth_first(mesh);
        let mean_edge = mean_edge_length(mesh).max(f64::MIN_POSITIVE);
        let mut junctions = Vec::new();
        let mut exit = |h| {
            let others = mesh.junction(h).iter().filter(|&&other| other != h);
            let beyond = |&other: &_| {
                let same_direction = mesh.tail(other) == mesh.tail(h);
                (face::edge(&numbering, other), same_direction)
            };
            let beyond: Vec<_> = others.map(beyond).collect();
            if beyond.is_empty() {
                return BOUNDARY;
            }
            junctions.push(beyond);
            (junctions.len() as u32 - 1) << 2 | CORNER
        };
        let old = |f| numbering.old_face(FaceId::new(f));
        let count = mesh.face_count() as u32;
        let faces = (0..count).map(|f| {
            let half_edges = old(f).half_edges();
            Face::new(mesh, half_edges, &numbering, 1.0 / mean_edge, &mut exit)
        });
        let faces = faces.collect();
        let corners = (0..count).map(|f| mesh.face_vertices(old(f))).collect();
        numbering.keep_new_faces();
        let threads = threads.max(1);
        Self {
            mesh: mesh.clone(),
            threads,
            pool: Threads::start(threads).ok(),
            numbering,
            mean_edge,
            faces,
            corners,
            junctions,
            has_pinched: mesh.vertices().any(|v| mesh.is_pinched(v)),
        }
    }
}

impl Propagate for Vsp {
    const TRACES: bool = false;
    const JUNCTIONS: bool = true;

    fn counters() -> Vec<Counter> {
        vec![
            Counter::QueuePushes,
            Counter::QueuePeak,
            Counter::Iterations,
        ]
    }

    fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    fn check(&self) -> Result<(), SolveError> {
        match self.pool {
            Some(_) => Ok(()),
            None => Err(SolveError::NoThreads {
                threads: self.threads,
            }),
        }
    }

    fn splice(&mut self, splice: &Splice) -> Option<Splice> {
        // Exits at junctions name faces that would change as well.
        if self.mesh.has_junctions() || splice.face_count() >= MOST_FACES {
            return None;
        }
        let undo = self.mesh.splice(splice);
        self.faces.truncate(splice.face_count());
        self.corners.truncate(splice.face_count());
        for f in splice.faces() {
            let half_edges = f.half_edges();
            let (numbering, scale) = (&self.numbering, 1.0 / self.mean_edge);
            let face = Face::new(&self.mesh, half_edges, numbering, scale, |_| BOUNDARY);
            let corners = self.mesh.face_vertices(f);
            // Added faces come last, in their order.
            match numbering.new_face(f).index() {
                place if place < self.faces.len() => {
                    (self.faces[place], self.corners[place]) = (face, corners);
                }
                _ => {
                    self.faces.push(face);
                    self.corners.push(corners);
                }
            }
        }
        Some(undo)
    }

    #[inline(never)]
    fn runs(&self) -> CompiledRuns<Self> {
        CompiledRuns::new()
    }

    fn propagate<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) -> Solution {
        probe.enter(Phase::Propagation);
        let run = || {
            let mut run = Run::new(self);
            run.propagate(sources);
            (run.pushes, run.peak, run.rounds, run.distances(sources))
        };
        let (pushes, peak, rounds, distances) = match &self.pool {
            Some(pool) => pool.run(run),
            None => run(),
        };
        probe.add(Counter::QueuePushes, pushes);
        probe.raise(Counter::QueuePeak, peak);
        probe.add(Counter::Iterations, u64::from(rounds));
        Solution::new(distances)
    }
}

/// A run. Sources move in rounds: all candidates enter their faces, then the sources that have won
/// leave them as the candidates of the next round. Those farther than the bound wait until no
/// others are left; then the bound rises by the mean length of an edge.
struct Run<'a> {
    vsp: &'a Vsp,
    shared: bool,
    bound: f32,
    rounds: u32,
    pushes: u64,
    peak: u64,
    candidates: Vec<EnteringSource>,
    /// Faces whose sources wait.
    waiting: Vec<u32>,
    /// The distance at which each pinched vertex has become a source.
    pinched: HashMap<VertexId, f32>,
    parts: Vec<ThreadShare>,
}

/// What one thread finds in a step.
#[derive(Default)]
struct ThreadShare {
    candidates: Vec<EnteringSource>,
    waiting: Vec<u32>,
    /// Pinched vertices with their distances.
    pinched: Vec<(VertexId, f32)>,
}

impl<'a> Run<'a> {
    fn new(vsp: &'a Vsp) -> Self {
        let threads = threads::count();
        let size = vsp.faces.len().div_ceil(threads).max(1);
        threads::each(vsp.faces.chunks(size).collect(), |faces: &[Face]| {
            faces.iter().for_each(Face::clear);
        });
        Self {
            vsp,
            shared: threads > 1,
            bound: 1.0,
            rounds: 0,
            pushes: 0,
            peak: 0,
            candidates: Vec::new(),
            waiting: Vec::new(),
            pinched: HashMap::new(),
            parts: (0..threads).map(|_| ThreadShare::default()).collect(),
        }
    }

    /// Propagates `sources` over the surface.
    fn propagate(&mut self, sources: &[VertexId]) {
        for &source in sources {
            self.start(source, 0.0);
        }
        loop {
            while !self.candidates.is_empty() {
                self.round();
            }
            if self.waiting.is_empty() {
                return;
            }
            self.bound += 1.0;
            self.wake();
        }
    }

    /// Makes `v`, at the end of a path of length `sigma`, a source of all faces around it.
    fn start(&mut self, v: VertexId, sigma: f32) {
        let (mesh, numbering) = (&self.vsp.mesh, &self.vsp.numbering);
        if mesh.is_pinched(v) {
            self.pinched.insert(v, sigma);
        }
        let around = mesh.outgoing(v).iter().map(|&h| EnteringSource {
            edge: face::edge(numbering, h),
            label: UNREACHED,
            source: Source {
                place: [0.0; 2],
                sigma,
            },
        });
        self.candidates.extend(around);
    }

    fn round(&mut self) {
        let (vsp, shared, bound, round) = (self.vsp, self.shared, self.bound, self.rounds);
        self.rounds += 1;
        self.pushes += self.candidates.len() as u64;
        self.peak = (self.candidates.len() + self.waiting.len()).max(self.peak as usize) as u64;
        let mut candidates = std::mem::take(&mut self.candidates);
        let size = self.size_of_parts(candidates.len());
        threads::each(candidates.chunks_mut(size).collect(), |part| {
            vsp.admit(part, round, shared);
        });
        let size = self.size_of_ordered_parts(candidates.len());
        let parts = candidates.chunks(size).zip(&mut self.parts).collect();
        threads::each(parts, |(candidates, part)| {
            for candidate in candidates {
                vsp.settle(candidate, bound, shared, part);
            }
        });
        candidates.clear();
        self.candidates = candidates;
        self.gather();
    }

    /// Lets the sources go that wait.
    fn wake(&mut self) {
        let vsp = self.vsp;
        let mut waiting = std::mem::take(&mut self.waiting);
        let size = self.size_of_ordered_parts(waiting.len());
        let parts = waiting.chunks(size).zip(&mut self.parts).collect();
        threads::each(parts, |(faces, part)| {
            for &f in faces {
                if let Some((corner, source)) = vsp.faces[f as usize].wake() {
                    vsp.leave(f, corner, source, &mut part.candidates);
                }
            }
        });
        waiting.clear();
        self.waiting = waiting;
        self.gather();
    }

    /// How many of `n` items each thread takes.
    fn size_of_parts(&self, n: usize) -> usize {
        let threads = if n < LITTLE { 1 } else { self.parts.len() };
        n.div_ceil(threads).max(1)
    }

    /// How many of `n` items each thread takes where their order matters: one thread takes all if
    /// labels can be equal.
    fn size_of_ordered_parts(&self, n: usize) -> usize {
        if self.vsp.has_ties() {
            n.max(1)
        } else {
            self.size_of_parts(n)
        }
    }

    /// Collects what the threads found, in the order in which one thread would have found it.
    fn gather(&mut self) {
        let mut pinched = Vec::new();
        for part in &mut self.parts {
            if self.candidates.is_empty() {
                std::mem::swap(&mut self.candidates, &mut part.candidates);
            } else {
                self.candidates.append(&mut part.candidates);
            }
            self.waiting.append(&mut part.waiting);
            pinched.append(&mut part.pinched);
        }
        for (v, d) in pinched {
            let known = self.pinched.get(&v);
            if known.is_none_or(|known| d < known * SHORTER) {
                self.start(v, d);
            }
        }
    }

    /// The distances of all vertices of the mesh.
    fn distances(&self, sources: &[VertexId]) -> Vec<f64> {
        let vsp = self.vsp;
        let unreached = || AtomicU32::new(UNREACHED);
        let distances: Vec<_> = vsp.mesh.vertices().map(|_| unreached()).collect();
        let reach = |v: VertexId, d: f32| {
            face::lower(&distances[v.index()], d.to_bits(), self.shared);
        };
        threads::each(threads::ranges(vsp.faces.len(), 1), |part| {
            for (face, corners) in vsp.faces[part.clone()].iter().zip(&vsp.corners[part]) {
                for (corner, d) in face.corners().into_iter().flatten() {
                    reach(corners[corner], d);
                }
            }
        });
        for &source in sources {
            reach(source, 0.0);
        }
        self.relax(&distances);
        let in_units = |d: AtomicU32| f64::from(f32::from_bits(d.into_inner())) * vsp.mean_edge;
        distances.into_iter().map(in_units).collect()
    }

    /// Lets no distance exceed that of a neighbour and the edge to it. A face keeps one source
    /// only, which beside short edges may be the wrong one for a corner.
    fn relax(&self, distances: &[AtomicU32]) {
        let vsp = self.vsp;
        let distance = |v: VertexId| f32::from_bits(distances[v.index()].load(Relaxed));
        let ends_of_violations = |part: Range<usize>| {
            let mut ends = Vec::new();
            for (face, corners) in vsp.faces[part.clone()].iter().zip(&vsp.corners[part]) {
                let around = corners.map(distance);
                for k in 0..3 {
                    let ([a, b], length) = ([k, face::next(k)], face.length(k));
                    for (near, far) in [(a, b), (b, a)] {
                        if around[near] + length < around[far] * SHORTER {
                            ends.push(corners[near]);
                        }
                    }
                }
            }
            ends
        };
        let mut queue: Heap<VertexId> = Heap::default();
        let parts = threads::ranges(vsp.faces.len(), 1);
        for v in threads::each(parts, ends_of_violations)
            .into_iter()
            .flatten()
        {
            queue.push(f64::from(distance(v)), v);
        }
        while let Some((d, v)) = queue.pop() {
            if d > f64::from(distance(v)) {
                continue;
            }
            for (neighbour, length) in vsp.mesh.neighbours(v) {
                let by_edge = d as f32 + (length / vsp.mean_edge) as f32;
                if by_edge < distance(neighbour) {
                    distances[neighbour.index()].store(by_edge.to_bits(), Relaxed);
                    queue.push(f64::from(by_edge), neighbour);
                }
            }
        }
    }
}

impl Vsp {
    /// Whether two candidates of a round can enter a face by one half-edge, with equal labels: at
    /// junctions, and around pinched vertices that become sources.
    const fn has_ties(&self) -> bool {
        self.has_pinched || !self.junctions.is_empty()
    }

    /// Lets `candidates` into their faces.
    fn admit(&self, candidates: &mut [EnteringSource], round: u32, shared: bool) {
        const AHEAD: usize = 8;
        for i in 0..candidates.len() {
            if let Some(later) = candidates.get(i + AHEAD) {
                prefetch(&self.faces, (later.edge >> 2) as usize);
            }
            let candidate = &mut candidates[i];
            self.faces[(candidate.edge >> 2) as usize].admit(candidate, round, shared);
        }
    }

    /// Sends the source of `candidate` on, or lets it wait, if its face keeps it.
    fn settle(&self, candidate: &EnteringSource, bound: f32, shared: bool, part: &mut ThreadShare) {
        let f = candidate.edge >> 2;
        let face = &self.faces[f as usize];
        if !face.settle(candidate, bound, shared) {
            return;
        }
        if face::distance_of(candidate.label) < bound {
            let corner = (candidate.edge & CORNER) as usize;
            self.leave(f, corner, candidate.source, &mut part.candidates);
        } else {
            part.waiting.push(f);
        }
        if self.has_pinched {
            for (corner, d) in face.corners().into_iter().flatten() {
                let v = self.corners[f as usize][corner];
                if self.mesh.is_pinched(v) {
                    part.pinched.push((v, d));
                }
            }
        }
    }

    /// Sends the `source` of face `f` through both exits.
    #[inline]
    fn leave(&self, f: u32, corner: usize, source: Source, candidates: &mut Vec<EnteringSource>) {
        for (exit, source) in self.faces[f as usize].leave(corner, source) {
            let edge = exit & !SADDLE;
            if edge & CORNER != CORNER {
                let label = UNREACHED;
                candidates.push(EnteringSource {
                    edge,
                    label,
                    source,
                });
            } else if edge != BOUNDARY {
                self.leave_by_junction(edge >> 2, source, candidates);
            }
        }
    }

    /// Sends `source` into all faces beyond a half-edge along a junction.
    #[cold]
    fn leave_by_junction(&self, place: u32, source: Source, candidates: &mut Vec<EnteringSource>) {
        for &(edge, same_direction) in &self.junctions[place as usize] {
            let mut source = source;
            if same_direction {
                let length = self.faces[(edge >> 2) as usize].length((edge & CORNER) as usize);
                source.place[0] = length - source.place[0];
            }
            candidates.push(EnteringSource {
                edge,
                label: UNREACHED,
                source,
            });
        }
    }
}
