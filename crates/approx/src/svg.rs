//! Saddle vertex graphs: direct geodesics are found once, and queries are shortest paths over them.

use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use geobench_fwp::{BucketOptions, Buckets, fwp_mmp};
use geobench_ich::{Splitting, ich};
use geobench_mesh::{Mesh, Splice, VertexId};
use geobench_mmp::Trimming;
use geobench_window::continuous::{Continuous, Explorer, Neighbour, Policy};
use geobench_window::queue::{Calendar, CalendarQueue, Discipline, HeapQueue, mean_edge_length};
use geobench_window::{
    CompiledRuns, Counter, Phase, Probe, Propagate, Solution, VertexFilter, prefetch,
};

use crate::attached::Attached;
use crate::order::{Untidy, VertexQueue};

/// The algorithm that finds the direct geodesics around a vertex. The graph does not depend on it,
/// up to rounding and ties.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SvgBuilder {
    /// ICH with windows from a calendar queue, which cross eight at a time.
    #[default]
    IchFast,
    /// ICH, as in Ying et al. (2013): windows from a heap, one at a time.
    Ich,
    /// FWP-MMP, as in Xu et al. (2015).
    FwpMmp,
}

/// Options of a [`SaddleVertexGraph`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SvgOptions {
    /// The number of nearest vertices of each vertex among which direct geodesics are searched.
    /// `None` means all vertices, which makes distances exact.
    pub k: Option<usize>,
    /// The algorithm that finds the geodesics.
    pub builder: SvgBuilder,
    /// Threads for set-up; 0 counts as 1. The graph does not depend on their number.
    pub threads: usize,
}

impl Default for SvgOptions {
    /// As in the papers k = 50 and one thread; the fast form of ICH.
    fn default() -> Self {
        Self {
            k: Some(50),
            builder: SvgBuilder::default(),
            threads: 1,
        }
    }
}

/// The saddle vertex graph (SVG) of Ying, Wang and He, "Saddle vertex graph (SVG): a novel solution
/// to the discrete geodesic problem" (2013).
///
/// A geodesic is *direct* if it turns at no vertex. A shortest path is a chain of direct geodesics
/// that meet at saddle vertices. So the graph of all direct geodesics gives exact distances, and
/// only saddle vertices relay paths. With a finite k, the graph has direct geodesics to some of the
/// k nearest vertices only, and every vertex relays paths. Distances are lengths of paths on the
/// surface, and never too short.
///
/// Set-up runs a window algorithm around each vertex, whose time depends on the windows that it
/// propagates. The first query from or to a point in a face or on an edge sets this algorithm up
/// once more, and every such query runs it around the point. An exact graph (`k: None`) is built
/// anew for points beside slivers. A query is Dijkstra's algorithm on the graph, with vertices in
/// buckets instead of a heap. The distances are the same bit for bit.
///
/// ```
/// use geobench_approx::{SaddleVertexGraph, SvgOptions};
/// use geobench_mesh::Mesh;
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("terrain,n=8,seed=1")?;
/// let mut graph = SaddleVertexGraph::new(&mesh, SvgOptions { k: Some(20), ..Default::default() });
/// assert!(graph.edges() < 80 * 20);
/// let near = graph.distances_from(0)?;
/// let far = graph.distances_from(80)?; // The same graph.
/// assert!((near[80] - far[0]).abs() < 1e-12 * near[80]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct SaddleVertexGraph {
    mesh: Mesh,
    /// The start of the edges of each vertex, and one past the last edge.
    starts: Vec<usize>,
    /// The other end of each edge, nearest first. Every edge is stored at both of its ends.
    ends: Vec<u32>,
    lengths: Vec<f64>,
    /// Whether paths may turn at a vertex.
    relays: Vec<bool>,
    options: SvgOptions,
    /// Points, whose ways include the direct geodesics around them.
    points: Attached,
    /// Finds these geodesics; set up for the first points.
    explorer: Option<PointExplorer>,
    /// Vertices by distance. A vertex whose distance falls after its turn has another turn.
    queue: Untidy,
}

impl SaddleVertexGraph {
    /// Builds the graph of `mesh`.
    pub fn new(mesh: &Mesh, options: SvgOptions) -> Self {
        let found = match options.builder {
            // A run is an error there.
            _ if mesh.has_junctions() => Vec::new(),
            SvgBuilder::IchFast => explore(mesh, options, || ich_fast_explorer(mesh, options)),
            SvgBuilder::Ich => explore(mesh, options, || ich_explorer(mesh)),
            SvgBuilder::FwpMmp => explore(mesh, options, || fwp_explorer(mesh, options)),
        };
        let relays = mesh
            .vertices()
            .map(|v| options.k.is_some() || mesh.is_pseudo_source(v));
        Self::of_edges(mesh, &found, relays.collect(), options)
    }

    fn of_edges(
        mesh: &Mesh,
        found: &[DirectGeodesics],
        relays: Vec<bool>,
        options: SvgOptions,
    ) -> Self {
        let vertices = mesh.vertex_count();
        // Edges may be found from one end or from both. The edges of the mesh keep the graph
        // connected for a small k.
        let edges = || {
            let of_mesh = |v: VertexId| {
                mesh.neighbours(v)
                    .map(move |(end, l)| (v.raw(), end.raw(), l))
            };
            let direct = found.iter().flat_map(|block| {
                let of = |(i, v): (usize, usize)| {
                    let neighbours = &block.neighbours[block.starts[i]..block.starts[i + 1]];
                    neighbours
                        .iter()
                        .map(move |n| (v as u32, n.vertex.raw(), n.distance))
                };
                block.vertices.clone().enumerate().flat_map(of)
            });
            direct.chain(mesh.vertices().flat_map(of_mesh))
        };
        let mut starts = vec![0; vertices + 1];
        for (a, b, _) in edges() {
            starts[a as usize + 1] += 1;
            starts[b as usize + 1] += 1;
        }
        for v in 0..vertices {
            starts[v + 1] += starts[v];
        }
        let mut next = starts.clone();
        let mut both = vec![(0, 0.0); starts[vertices]];
        for (a, b, length) in edges() {
            for (a, b) in [(a, b), (b, a)] {
                both[next[a as usize]] = (b, length);
                next[a as usize] += 1;
            }
        }
        let width = BUCKET * mean_edge_length(mesh);
        let mut graph = Self {
            mesh: mesh.clone(),
            starts: vec![0],
            ends: Vec::new(),
            lengths: Vec::new(),
            relays,
            options,
            points: Attached::new(mesh),
            explorer: None,
            queue: Untidy::new(width),
        };
        let mut own: Vec<(u32, f64)> = Vec::new();
        for v in 0..vertices {
            own.clear();
            own.extend_from_slice(&both[starts[v]..starts[v + 1]]);
            // Keeps the lesser of the two lengths of an edge, which may differ by rounding.
            own.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
            own.dedup_by_key(|&mut (end, _)| end);
            own.sort_unstable_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
            graph.ends.extend(own.iter().map(|&(end, _)| end));
            graph.lengths.extend(own.iter().map(|&(_, length)| length));
            graph.starts.push(graph.ends.len());
        }
        graph.ends.shrink_to_fit();
        graph.lengths.shrink_to_fit();
        graph
    }

    /// Prefetches the first edges of `v`.
    fn announce(&self, v: VertexId) {
        let start = self.starts[v.index()];
        for i in 0..4 {
            prefetch(&self.ends, start + 16 * i);
            prefetch(&self.lengths, start + 8 * i);
        }
    }

    /// Number of edges of the graph.
    pub fn edges(&self) -> usize {
        self.ends.len() / 2
    }

    /// Bytes of the graph.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.starts)
            + size_of_val(&*self.ends)
            + size_of_val(&*self.lengths)
            + size_of_val(&*self.relays)
    }
}

/// The bucket width of a query, in mean edge lengths of the mesh: so small that few vertices have a
/// second turn.
const BUCKET: f64 = 0.25;

type IchFastExplorer = Explorer<Splitting<true>, CalendarQueue>;
type IchExplorer = Explorer<Splitting, HeapQueue>;
type FwpExplorer = Explorer<Trimming, Buckets>;

/// Finds direct geodesics around points.
#[derive(Clone, Debug)]
enum PointExplorer {
    IchFast(Box<IchFastExplorer>),
    Ich(Box<IchExplorer>),
    FwpMmp(Box<FwpExplorer>),
}

impl PointExplorer {
    fn new(mesh: &Mesh, options: SvgOptions) -> Self {
        match options.builder {
            SvgBuilder::IchFast => Self::IchFast(Box::new(ich_fast_explorer(mesh, options))),
            SvgBuilder::Ich => Self::Ich(Box::new(ich_explorer(mesh))),
            SvgBuilder::FwpMmp => Self::FwpMmp(Box::new(fwp_explorer(mesh, options))),
        }
    }

    fn splice(&mut self, splice: &Splice) -> Option<Splice> {
        match self {
            Self::IchFast(explorer) => explorer.splice(splice),
            Self::Ich(explorer) => explorer.splice(splice),
            Self::FwpMmp(explorer) => explorer.splice(splice),
        }
    }

    fn around(&mut self, v: VertexId, k: Option<usize>) -> &[Neighbour] {
        match self {
            Self::IchFast(explorer) => {
                explorer.around(v, k);
                explorer.neighbours()
            }
            Self::Ich(explorer) => {
                explorer.around(v, k);
                explorer.neighbours()
            }
            Self::FwpMmp(explorer) => {
                explorer.around(v, k);
                explorer.neighbours()
            }
        }
    }
}

fn ich_fast_explorer(mesh: &Mesh, options: SvgOptions) -> IchFastExplorer {
    let queue = CalendarQueue::with_width(width(mesh, options) * Calendar::usual_width(mesh));
    let policy = Splitting::new(mesh, VertexFilter::On).jointly();
    Explorer::new(Continuous::new(mesh, policy, queue))
}

fn ich_explorer(mesh: &Mesh) -> IchExplorer {
    Explorer::new(ich(mesh))
}

fn fwp_explorer(mesh: &Mesh, options: SvgOptions) -> FwpExplorer {
    let options = BucketOptions {
        width: width(mesh, options),
        ..BucketOptions::default()
    };
    Explorer::new(fwp_mmp(mesh, options))
}

/// The bucket width of explorers, in usual widths: it suits the number of vertices that a run
/// reaches, not that of the mesh.
fn width(mesh: &Mesh, options: SvgOptions) -> f64 {
    let vertices = mesh.vertex_count() as f64;
    (vertices / options.k.map_or(vertices, |k| (k as f64).max(1.0))).sqrt()
}

/// The direct geodesics from a range of vertices.
struct DirectGeodesics {
    vertices: Range<usize>,
    /// The start of the geodesics of each vertex, and one past the last.
    starts: Vec<usize>,
    neighbours: Vec<Neighbour>,
}

/// Number of vertices that a thread takes at once. The time for one vertex varies a hundredfold.
const BLOCK: usize = 64;

fn explore<W: Policy, Q: Discipline>(
    mesh: &Mesh,
    options: SvgOptions,
    explorer: impl Fn() -> Explorer<W, Q> + Sync,
) -> Vec<DirectGeodesics> {
    let vertices = mesh.vertex_count();
    let next = AtomicUsize::new(0);
    let all = Mutex::new(Vec::new());
    let work = || {
        let mut explorer = explorer();
        let mut own = Vec::new();
        loop {
            let first = next.fetch_add(BLOCK, Ordering::Relaxed);
            if first >= vertices {
                break;
            }
            let mut found = DirectGeodesics {
                vertices: first..vertices.min(first + BLOCK),
                starts: vec![0],
                neighbours: Vec::new(),
            };
            for v in found.vertices.clone() {
                explorer.around(VertexId::new(v as u32), options.k);
                found.neighbours.extend_from_slice(explorer.neighbours());
                found.starts.push(found.neighbours.len());
            }
            own.push(found);
        }
        if let Ok(mut all) = all.lock() {
            all.append(&mut own);
        }
    };
    std::thread::scope(|scope| {
        // If the system does not start a thread, the others do its work.
        for _ in 1..options.threads.min(vertices.div_ceil(BLOCK)) {
            let _ = std::thread::Builder::new().spawn_scoped(scope, work);
        }
        work();
    });
    let mut all = all.into_inner().unwrap_or_default();
    all.sort_unstable_by_key(|found: &DirectGeodesics| found.vertices.start);
    all
}

impl Propagate for SaddleVertexGraph {
    const TRACES: bool = false;

    fn counters() -> Vec<Counter> {
        vec![
            Counter::QueuePushes,
            Counter::QueuePeak,
            Counter::GraphBytes,
        ]
    }

    fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    fn splice(&mut self, splice: &Splice) -> Option<Splice> {
        if self.mesh.has_junctions() {
            return None;
        }
        if self.explorer.is_none() {
            self.explorer = Some(PointExplorer::new(&self.mesh, self.options));
        }
        let explorer = self.explorer.as_mut()?;
        let undo = self.points.splice(&mut self.mesh, splice)?;
        let k = self.options.k;
        // Exact paths may have to turn at a point beside a sliver, which no point does here.
        let is_beside_sliver = |(v, _)| self.mesh.is_pseudo_source(v);
        if k.is_none() && self.points.numbered().any(is_beside_sliver) {
            self.points.splice(&mut self.mesh, &undo);
            return None;
        }
        explorer.splice(splice)?;
        for (v, point) in self.points.numbered_mut() {
            let direct = explorer.around(v, k).iter();
            point.ways.extend(direct.map(|n| (n.vertex, n.distance)));
        }
        // A corner of a new sliver relays paths. No direct geodesic turns there.
        for v in splice.vertices() {
            if let Some(relays) = self.relays.get_mut(v.index()) {
                *relays = k.is_some() || self.mesh.is_pseudo_source(v);
            }
        }
        Some(undo)
    }

    #[inline(never)]
    fn runs(&self) -> CompiledRuns<Self> {
        CompiledRuns::new()
    }

    fn propagate<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) -> Solution {
        probe.enter(Phase::Management);
        probe.add(Counter::GraphBytes, self.bytes() as u64);
        self.queue.clear();
        let mut distances = self.points.begin(sources, |d, v| {
            // Only sources are at 0.
            if d == 0.0 || self.relays[v.index()] {
                self.queue.push(d, v);
            }
        });
        let by_ways_only = |_| f64::INFINITY;
        while let Some((d, v)) = self.queue.pop() {
            let bound = self.queue.bound();
            let distance = |v| self.points.distance(&distances, v, by_ways_only);
            if P::STOPS && probe.is_reached(bound, distance) {
                probe.end(bound);
                break;
            }
            if let Some(next) = self.queue.next() {
                self.announce(next);
            }
            let v = v.index();
            if d > distances[v] {
                continue;
            }
            let edges = self.starts[v]..self.starts[v + 1];
            for (&end, &length) in self.ends[edges.clone()].iter().zip(&self.lengths[edges]) {
                let known = &mut distances[end as usize];
                let through = d + length;
                if through < *known {
                    *known = through;
                    if self.relays[end as usize] {
                        self.queue.push(through, VertexId::new(end));
                        probe.add(Counter::QueuePushes, 1);
                        probe.raise(Counter::QueuePeak, self.queue.len() as u64);
                    }
                }
            }
        }
        (self.points).finish(&mut distances, |_, _| f64::INFINITY);
        Solution::new(distances)
    }
}
