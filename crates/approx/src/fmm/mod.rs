//! Fast marching: a front that is straight within each triangle.

mod stencil;

use geobench_mesh::{Mesh, Splice, VertexId};
use geobench_window::queue::mean_edge_length;
use geobench_window::{CompiledRuns, Counter, Phase, Probe, Propagate, Solution};

use crate::attached::Attached;
use crate::order::{Tidy, Untidy, VertexQueue};
use stencil::{Stencil, Stencils};

/// Fast marching on a triangle mesh (Kimmel and Sethian 1998); O(n log n) for n vertices.
///
/// Vertices are accepted in the order of their distances. A triangle with two accepted vertices
/// gives the third one a distance: the time at which a straight front arrives that fits both
/// distances, if this front comes through the edge between the two vertices; else the shorter way
/// along an edge.
///
/// A front can pass an obtuse corner before the two other vertices are accepted. The faces beyond
/// the opposite edge are then unfolded until a vertex is found that splits the angle into two acute
/// ones.
///
/// The error is about proportional to the length of the edges. Distances may be too long or too
/// short.
///
/// ```
/// use geobench_approx::Fmm;
/// use geobench_mesh::Mesh;
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("sphere,subdiv=3")?; // Of radius 1.
/// let distances = Fmm::new(&mesh, true).distances_from(0)?;
/// let farthest = distances.into_iter().fold(0.0, f64::max);
/// assert!((farthest - std::f64::consts::PI).abs() < 0.05);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Fmm {
    march: March<Tidy>,
}

/// [`Fmm`] with the untidy queue of Yatziv, Bartesaghi and Sapiro (2006): buckets of equal width,
/// first in, first out. A run takes linear time. Vertices may be accepted out of order by at most
/// the width of a bucket.
#[derive(Clone, Debug)]
pub struct FmmUntidy {
    march: March<Untidy>,
}

impl Fmm {
    /// Sets up for `mesh`; O(faces). With `unfold`, obtuse corners are split by unfolding.
    pub fn new(mesh: &Mesh, unfold: bool) -> Self {
        Self {
            march: March::new(mesh, unfold, Tidy::default()),
        }
    }
}

impl FmmUntidy {
    /// Sets up for `mesh`, with buckets of `width` mean edge lengths; O(faces).
    pub fn new(mesh: &Mesh, unfold: bool, width: f64) -> Self {
        let queue = Untidy::new(width * mean_edge_length(mesh));
        Self {
            march: March::new(mesh, unfold, queue),
        }
    }
}

macro_rules! propagate {
    ($solver:ty) => {
        impl Propagate for $solver {
            const TRACES: bool = false;

            fn counters() -> Vec<Counter> {
                vec![Counter::QueuePushes, Counter::QueuePeak]
            }

            fn mesh(&self) -> &Mesh {
                &self.march.mesh
            }

            fn splice(&mut self, splice: &Splice) -> Option<Splice> {
                self.march.splice(splice)
            }

            #[inline(never)]
            fn runs(&self) -> CompiledRuns<Self> {
                CompiledRuns::new()
            }

            fn propagate<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) -> Solution {
                self.march.run(sources, probe)
            }
        }
    };
}

propagate!(Fmm);
propagate!(FmmUntidy);

/// A march of the front, with vertices in the order of a queue.
#[derive(Clone, Debug)]
struct March<Q> {
    mesh: Mesh,
    stencils: Stencils,
    points: Attached,
    /// For each point, the triangles through which a front arrives there: its faces, split at it.
    at_points: Vec<Vec<Stencil>>,
    accepted: Vec<bool>,
    queue: Q,
}

impl<Q: VertexQueue> March<Q> {
    fn new(mesh: &Mesh, unfold: bool, queue: Q) -> Self {
        Self {
            mesh: mesh.clone(),
            stencils: Stencils::new(mesh, unfold),
            points: Attached::new(mesh),
            at_points: Vec::new(),
            accepted: Vec::new(),
            queue,
        }
    }

    fn splice(&mut self, splice: &Splice) -> Option<Splice> {
        let undo = self.points.splice(&mut self.mesh, splice)?;
        let parts = self.points.numbered().map(|(v, point)| {
            let parts = point
                .faces
                .iter()
                .flat_map(|face| Stencil::of_parts(face, v));
            parts.collect()
        });
        self.at_points = parts.collect();
        Some(undo)
    }

    /// The distance of point `i` by the fronts in its faces.
    fn arrival(&self, i: usize, distances: &[f64]) -> f64 {
        let arrivals = self.at_points[i]
            .iter()
            .map(|stencil| stencil.arrival(stencil.base.map(|v| distances[v.index()])));
        arrivals.fold(f64::INFINITY, f64::min)
    }

    /// Whether the front has passed every point, or is still far from it. In between its distance
    /// is not final.
    fn has_passed_points(&self, distances: &[f64]) -> bool {
        let bases = self.at_points.iter().flatten().flat_map(|part| part.base);
        let mut corners = bases.map(VertexId::index);
        corners.all(|v| self.accepted[v] || distances[v].is_infinite())
    }

    fn run<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) -> Solution {
        probe.enter(Phase::Propagation);
        let vertices = self.mesh.vertex_count();
        self.accepted.clear();
        self.accepted.resize(vertices, false);
        self.queue.clear();
        let mut distances = (self.points).begin(sources, |d, v| self.queue.push(d, v));
        while let Some((label, v)) = self.queue.pop() {
            if P::STOPS && Q::IS_SORTED {
                let arrival = |i| self.arrival(i, &distances);
                let distance = |v| self.points.distance(&distances, v, arrival);
                if probe.is_reached(label, distance) && self.has_passed_points(&distances) {
                    probe.end(label);
                    break;
                }
            }
            if std::mem::replace(&mut self.accepted[v.index()], true) {
                continue;
            }
            let here = distances[v.index()];
            for stencil in self.stencils.with_base(v) {
                let apex = stencil.apex.index();
                if self.accepted[apex] {
                    continue;
                }
                let own = usize::from(stencil.base[1] == v);
                let other = stencil.base[1 - own].index();
                let found = if self.accepted[other] {
                    let mut ends = [here; 2];
                    ends[1 - own] = distances[other];
                    stencil.arrival(ends)
                } else {
                    here + stencil.sides[own]
                };
                if found < distances[apex] {
                    distances[apex] = found;
                    self.queue.push(found, stencil.apex);
                    probe.add(Counter::QueuePushes, 1);
                    probe.raise(Counter::QueuePeak, self.queue.len() as u64);
                }
            }
        }
        (self.points).finish(&mut distances, |i, distances| self.arrival(i, distances));
        Solution::new(distances)
    }
}
