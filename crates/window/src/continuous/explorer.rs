//! Searches for direct geodesics from one vertex after another.

use geobench_mesh::{FaceId, Splice, VertexId};

use super::policy::Policy;
use super::propagation::Continuous;
use crate::probe::Probe;
use crate::queue::{Discipline, EventKind};
use crate::solver::Propagate;

/// A vertex that a direct geodesic reaches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbour {
    /// The vertex.
    pub vertex: VertexId,
    /// Length of the geodesic.
    pub distance: f64,
}

/// Finds the vertices near a start vertex that a *direct* geodesic reaches, which is one that turns
/// at no vertex. One explorer serves one start vertex after another: the cost of a run depends on
/// the windows that it propagates, not on the size of the mesh.
///
/// ```
/// use geobench_ich::ich;
/// use geobench_mesh::{Mesh, VertexId};
/// use geobench_window::continuous::Explorer;
///
/// let mesh = Mesh::generate("terrain,n=8,seed=1")?;
/// let mut explorer = Explorer::new(ich(&mesh));
/// for v in [3, 40].map(VertexId::new) {
///     explorer.around(v, Some(20)); // Among the 20 vertices nearest to `v`.
///     let found = explorer.neighbours();
///     assert!(!found.is_empty() && found.len() <= 20);
///     assert!(found.is_sorted_by_key(|neighbour| neighbour.distance));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Explorer<W, Q> {
    run: Continuous<W, Q>,
    found: NeighbourSearch,
    neighbours: Vec<Neighbour>,
}

impl<W: Policy, Q: Discipline> Explorer<W, Q> {
    /// Sets up for the mesh of `solver`; O(faces).
    pub fn new(solver: Continuous<W, Q>) -> Self {
        let mut explorer = Self {
            run: solver,
            found: NeighbourSearch::default(),
            neighbours: Vec::new(),
        };
        explorer.reset();
        explorer
    }

    fn reset(&mut self) {
        let vertices = self.run.mesh.vertex_count();
        self.run.surface.reset(vertices);
        self.run.policy.reset();
        self.found.places.clear();
        self.found.places.resize(vertices, u32::MAX);
    }

    /// Makes a change of the mesh, and returns the one that undoes it; `None` if the algorithm
    /// cannot. See [`Solver::splice`](crate::Solver::splice). Takes time in the size of the change,
    /// except on a mesh with junctions.
    pub fn splice(&mut self, splice: &Splice) -> Option<Splice> {
        let undo = Propagate::splice(&mut self.run, splice)?;
        if self.run.mesh.has_junctions() {
            self.reset();
            return Some(undo);
        }
        // Every run leaves the data as they were before it.
        let vertices = self.run.mesh.vertex_count();
        self.run.surface.resize(vertices);
        self.found.places.resize(vertices, u32::MAX);
        let faces = self.run.surface.faces();
        let corners = splice.faces().flat_map(FaceId::half_edges);
        self.run.policy.reset_at(corners.map(|h| faces.number(h)));
        Some(undo)
    }

    /// Finds the [neighbours](Self::neighbours) of `v` among the `k` vertices nearest to it, or
    /// among all vertices if `k` is `None`.
    pub fn around(&mut self, v: VertexId, k: Option<usize>) {
        let Self { run, found, .. } = self;
        found.begin(k);
        run.begin_run(&[v], found);
        // Turns until the next search of the queue for direct windows. It equals the number of
        // events at the last search, which keeps the cost of all searches linear in the turns.
        let mut turns = 0;
        let mut bound = f64::INFINITY;
        while let Some((label, event)) = run.queue.pop(found) {
            if run.ends(label, found) {
                bound = found.bound;
                break;
            }
            if turns == 0 {
                let (is_direct, waiting) = run.has_direct(event.kind());
                if !is_direct {
                    break;
                }
                turns = waiting;
            }
            turns = turns.saturating_sub(1);
            run.turn(label, event, found);
        }
        self.collect(v, k, bound);
        self.forget(v);
    }

    /// The vertices that the last run found, nearest first, without the start vertex.
    pub fn neighbours(&self) -> &[Neighbour] {
        &self.neighbours
    }

    fn collect(&mut self, v: VertexId, k: Option<usize>, bound: f64) {
        let mut near: Vec<&Reached> = self.found.reached.iter().collect();
        near.retain(|r| r.vertex != v && r.distance <= bound);
        near.sort_unstable_by(|a, b| {
            (a.distance.total_cmp(&b.distance)).then(a.vertex.cmp(&b.vertex))
        });
        near.truncate(k.unwrap_or(usize::MAX));
        self.neighbours.clear();
        let direct = near.into_iter().filter(|r| r.is_direct);
        self.neighbours.extend(direct.map(|r| Neighbour {
            vertex: r.vertex,
            distance: r.distance,
        }));
    }

    /// Resets the parts of surface and policy that the last run changed.
    fn forget(&mut self, v: VertexId) {
        let Continuous {
            mesh,
            surface,
            policy,
            ..
        } = &mut self.run;
        surface.forget(v);
        for r in &self.found.reached {
            surface.forget(r.vertex);
            self.found.places[r.vertex.index()] = u32::MAX;
        }
        // A window arrives only at edges whose ends have been reached.
        let faces = surface.faces();
        let at = |v: VertexId| mesh.outgoing(v).iter().map(|&h| faces.number(h));
        let reached = self.found.reached.iter().map(|r| r.vertex);
        let corners = reached.chain([v]).flat_map(at);
        policy.reset_at(corners.flat_map(|h| [h, h.next(), h.prev()]));
    }
}

impl<W: Policy, Q: Discipline> Continuous<W, Q> {
    /// Whether a window waits that starts at the source, and the number of waiting events (0 if
    /// none does). `taken`, which has just left the queue, counts as waiting.
    fn has_direct(&self, taken: EventKind) -> (bool, usize) {
        let is_direct = |kind| match kind {
            EventKind::Window(h, id) => {
                let window = self.policy.waiting(h, id, &self.surface);
                window.is_some_and(|w| w.sigma == 0.0)
            }
            EventKind::Vertex(_) => false,
        };
        let mut waiting = self.queue.events().map(|(_, event)| event.kind());
        let found = is_direct(taken) || waiting.any(is_direct);
        (
            found,
            if found {
                self.queue.events().count()
            } else {
                0
            },
        )
    }
}

/// A vertex that a run has reached.
#[derive(Clone, Copy, Debug)]
struct Reached {
    vertex: VertexId,
    distance: f64,
    /// Whether the path turns at no vertex.
    is_direct: bool,
}

/// The probe of an exploration. It ends the run once the nearest `k` distances are final.
#[derive(Clone, Debug, Default)]
struct NeighbourSearch {
    k: Option<usize>,
    reached: Vec<Reached>,
    /// Index into `reached` by vertex; `u32::MAX` if the vertex has not been reached.
    places: Vec<u32>,
    /// An upper bound of the distance of the `k`-th nearest vertex.
    limit: f64,
    /// Improvements since `limit` was computed.
    improvements: usize,
    /// No path that was still open when the run ended is shorter than this.
    bound: f64,
    distances: Vec<f64>,
}

/// Improvements after which `limit` is computed anew.
const IMPROVEMENTS: usize = 16;

impl NeighbourSearch {
    fn begin(&mut self, k: Option<usize>) {
        self.k = k;
        self.reached.clear();
        self.limit = f64::INFINITY;
        self.improvements = IMPROVEMENTS;
        self.bound = f64::INFINITY;
    }

    /// Sets `limit` to the `k`-th smallest distance reached.
    fn update_limit(&mut self, k: usize) {
        self.improvements = 0;
        self.distances.clear();
        let distances = self.reached.iter().map(|r| r.distance);
        self.distances.extend(distances);
        let (_, &mut limit, _) = self.distances.select_nth_unstable_by(k - 1, f64::total_cmp);
        self.limit = limit;
    }
}

impl Probe for NeighbourSearch {
    const STOPS: bool = true;
    const EXPLORES: bool = true;

    #[inline]
    fn improve(&mut self, v: VertexId, d: f64, sigma: f64) {
        let reached = Reached {
            vertex: v,
            distance: d,
            is_direct: sigma == 0.0,
        };
        self.improvements += 1;
        if let Some(known) = self.reached.get_mut(self.places[v.index()] as usize) {
            *known = reached;
        } else {
            self.places[v.index()] = self.reached.len() as u32;
            self.reached.push(reached);
        }
    }

    #[inline]
    fn is_reached(&mut self, bound: f64, _: impl Fn(VertexId) -> f64) -> bool {
        let Some(k) = self.k else {
            return false;
        };
        if k == 0 {
            return true;
        }
        if self.improvements >= IMPROVEMENTS && self.reached.len() >= k {
            self.update_limit(k);
        }
        self.limit < bound
    }

    fn end(&mut self, bound: f64) {
        self.bound = bound;
    }
}
