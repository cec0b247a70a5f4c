//! Dijkstra's algorithm on the edges of a mesh.

use geobench_mesh::{Mesh, RowTable, Splice, VertexId};
use geobench_window::queue::Heap;
use geobench_window::{CompiledRuns, Counter, Probe, Propagate, Solution, reach_along_edge};

/// The algorithm of Dijkstra (1959) on the edges of a mesh; O(n log n) for n vertices.
///
/// Distances are lengths of paths along edges, and never too short. How much too long they are
/// depends on the directions of the edges, not on their lengths, so refining a mesh does not help.
#[derive(Clone, Debug)]
pub struct Dijkstra {
    mesh: Mesh,
    /// The places of the edges of each vertex in `edges`.
    rows: RowTable,
    edges: Vec<(VertexId, f64)>,
    queue: Heap<VertexId>,
}

impl Dijkstra {
    /// Sets up for `mesh`; O(edges).
    pub fn new(mesh: &Mesh) -> Self {
        let mut starts = Vec::with_capacity(mesh.vertex_count() + 1);
        let mut edges = Vec::with_capacity(mesh.half_edge_count());
        for v in mesh.vertices() {
            starts.push(edges.len() as u32);
            edges.extend(mesh.neighbours(v));
        }
        starts.push(edges.len() as u32);
        Self {
            mesh: mesh.clone(),
            rows: RowTable::of_starts(&starts),
            edges,
            queue: Heap::default(),
        }
    }
}

impl Propagate for Dijkstra {
    const JUNCTIONS: bool = true;
    const ALONG_EDGES: bool = true;

    fn counters() -> Vec<Counter> {
        vec![Counter::QueuePushes, Counter::QueuePeak]
    }

    fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    fn splice(&mut self, splice: &Splice) -> Option<Splice> {
        let undo = self.mesh.splice(splice);
        let vertices = self.mesh.vertex_count();
        let before = splice.undoes().then(|| self.rows.put_back(vertices));
        if let Some(edges) = before.flatten() {
            self.edges.truncate(edges);
        } else {
            let first = self.edges.len();
            let mut lengths = Vec::new();
            for v in splice.vertices() {
                let start = self.edges.len();
                self.edges.extend(self.mesh.neighbours(v));
                lengths.push((v.index(), self.edges.len() - start));
            }
            self.rows.replace(vertices, first, lengths.into_iter());
        }
        Some(undo)
    }

    #[inline(never)]
    fn runs(&self) -> CompiledRuns<Self> {
        CompiledRuns::new()
    }

    fn propagate<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) -> Solution {
        let mut distances = vec![f64::INFINITY; self.mesh.vertex_count()];
        self.queue.clear();
        for &source in sources {
            distances[source.index()] = 0.0;
            self.queue.push(0.0, source);
        }
        while let Some((d, v)) = self.queue.pop() {
            if P::STOPS && probe.is_reached(d, |v| distances[v.index()]) {
                probe.end(d);
                break;
            }
            if d > distances[v.index()] {
                continue;
            }
            for &(neighbour, length) in &self.edges[self.rows.range(v.index())] {
                let known = &mut distances[neighbour.index()];
                if d + length < *known {
                    *known = d + length;
                    self.queue.push(d + length, neighbour);
                    probe.add(Counter::QueuePushes, 1);
                    probe.raise(Counter::QueuePeak, self.queue.len() as u64);
                    if P::TRACES {
                        reach_along_edge(&self.mesh, v, neighbour, probe);
                    }
                }
            }
        }
        Solution::new(distances)
    }
}
