//! Vertices by distance: the schedule of VTP for single windows or lists.

use geobench_mesh::{HalfEdgeId, Mesh, Numbering, Splice, VertexId};
use geobench_window::continuous::Surface;
use geobench_window::queue::{Arena, Chain, Discipline, Event, EventKind, Heap, MinHeap};
use geobench_window::trimming::ThinFaces;
use geobench_window::{Counter, Probe};

/// The vertex-sorted queue of VTP (Qin et al. 2016, sections 5.2 and 6.2), for single windows or
/// lists.
///
/// Vertices are taken by distance. At its turn a vertex adds the faces around it to the *traversed
/// area*. A window waits on its half-edge until the face that it enters belongs to the area; then
/// it is *released*. Released windows are taken first in, first out, before the next vertex.
///
/// Windows beside [thin faces](ThinFaces) are released into a queue by distance, shared with the
/// vertices. In first-in, first-out order they would wind around a needle before the windows that
/// beat them have arrived. Few meshes have such faces.
///
/// Only vertices have to be kept in order. The heap has about as many entries as the wavefront has
/// vertices: a fiftieth of its windows or less.
///
/// # Cost
///
/// O(1) for each window, O(log n) for each improvement of a vertex. A window takes 24 bytes, a
/// half-edge 12, a face 4.
///
/// ```
/// use geobench_fwp::{VertexOrder};
/// use geobench_ich::Splitting;
/// use geobench_mesh::Mesh;
/// use geobench_window::continuous::Continuous;
/// use geobench_window::{Solver, VertexFilter};
///
/// let mesh = Mesh::generate("terrain,n=8,seed=1")?;
/// let policy = Splitting::new(&mesh, VertexFilter::On);
/// let mut solver = Continuous::new(&mesh, policy, VertexOrder::new(&mesh));
/// assert_eq!(solver.distances_from(5)?[5], 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct VertexOrder {
    mesh: Mesh,
    /// The numbering of faces in events.
    numbering: Numbering,
    /// All vertices whose distances have improved. An outdated entry comes after the turn of its
    /// vertex and has no effect.
    vertices: Heap<VertexId>,
    arena: Arena,
    /// For each half-edge, the windows that wait on it for its face.
    waiting: Vec<Chain>,
    released: Chain,
    thin: ThinFaces,
    /// Released windows beside thin faces.
    nearest: MinHeap<Event>,
    /// For each face the step in which it joined the traversed area; 0 if it has not.
    joined: Vec<u32>,
    /// Number of turns of vertices so far.
    step: u32,
}

impl VertexOrder {
    /// An empty queue for the windows of `mesh`; O(faces).
    pub fn new(mesh: &Mesh) -> Self {
        let mut numbering = Surface::order(mesh);
        let thin = ThinFaces::of(mesh, mesh.half_edge_count(), |h| {
            numbering.new_half_edge(h).index()
        });
        numbering.keep_new_faces();
        Self {
            mesh: mesh.clone(),
            thin,
            nearest: MinHeap::default(),
            numbering,
            vertices: Heap::default(),
            arena: Arena::default(),
            waiting: vec![Chain::EMPTY; mesh.half_edge_count()],
            released: Chain::EMPTY,
            joined: vec![0; mesh.face_count()],
            step: 0,
        }
    }

    /// Adds the faces around `v` to the traversed area.
    fn pass(&mut self, v: VertexId) {
        self.step = self.step.saturating_add(1);
        for h in self.mesh.outgoing(v) {
            let face = self.numbering.new_face(h.face());
            let joined = &mut self.joined[face.index()];
            if *joined == 0 {
                *joined = self.step;
                for h in face.half_edges().map(HalfEdgeId::index) {
                    let waiting = &mut self.waiting[h];
                    if self.thin.is_beside(h) {
                        while let Some((label, event)) = self.arena.take(waiting) {
                            self.nearest.push(label, event);
                        }
                    } else {
                        self.arena.join(&mut self.released, waiting);
                    }
                }
            }
        }
    }
}

impl Discipline for VertexOrder {
    const COUNTERS: &'static [Counter] = &[
        Counter::QueuePushes,
        Counter::QueuePeak,
        Counter::Prime,
        Counter::Secondary,
    ];

    const EVERY_VERTEX: bool = true;

    fn start(&mut self, source: VertexId) {
        self.pass(source);
    }

    fn splice(&mut self, mesh: &Mesh, splice: &Splice) {
        self.clear();
        // Its own copy: a clone would keep the algorithm from changing its mesh in place.
        self.mesh.splice(splice);
        self.waiting.resize(mesh.half_edge_count(), Chain::EMPTY);
        self.joined.resize(mesh.face_count(), 0);
        let numbering = &self.numbering;
        let number = |h| numbering.new_half_edge(h).index();
        let half_edges = mesh.half_edge_count();
        self.thin.splice(mesh, splice, half_edges, number);
    }

    #[inline]
    fn push<P: Probe>(&mut self, label: f64, event: Event, probe: &mut P) {
        match event.kind() {
            EventKind::Vertex(v) => {
                self.vertices.push(label, v);
                probe.add(Counter::QueuePushes, 1);
                probe.raise(Counter::QueuePeak, self.vertices.len() as u64);
            }
            EventKind::Window(h, _) => {
                let chain = if self.joined[h.face().index()] == 0 {
                    &mut self.waiting[h.index()]
                } else if self.thin.is_beside(h.index()) {
                    self.nearest.push(label, event);
                    return;
                } else {
                    &mut self.released
                };
                self.arena.append(chain, label, event);
            }
        }
    }

    #[inline]
    fn pop<P: Probe>(&mut self, _: &mut P) -> Option<(f64, Event)> {
        self.arena.take(&mut self.released).or_else(|| {
            if let Some((label, _)) = self.nearest.peek()
                && self.vertices.peek().is_none_or(|(d, _)| label < d)
            {
                return self.nearest.pop();
            }
            let (label, v) = self.vertices.pop()?;
            self.pass(v);
            Some((label, Event::vertex(v)))
        })
    }

    #[inline]
    fn upcoming(&self, skipped: usize) -> Option<Event> {
        let mut coming = self.arena.chained(self.released);
        coming.nth(skipped).map(|(_, event)| event)
    }

    #[inline]
    fn coming(&self) -> impl Iterator<Item = Event> {
        let coming = self.arena.chained(self.released);
        coming.map(|(_, event)| event)
    }

    #[inline]
    fn crossed<P: Probe>(&mut self, h: HalfEdgeId, tries: u64, probe: &mut P) {
        let prime = self.joined[h.face().index()] == self.step;
        let counter = if prime {
            Counter::Prime
        } else {
            Counter::Secondary
        };
        probe.add(counter, tries);
    }

    fn events(&self) -> impl Iterator<Item = (f64, Event)> {
        let vertices = self.vertices.iter();
        let vertices = vertices.map(|(label, v)| (label, Event::vertex(v)));
        let nearest = self.nearest.iter().copied();
        self.arena.events().chain(vertices).chain(nearest)
    }

    fn clear(&mut self) {
        self.vertices.clear();
        self.arena.clear();
        self.waiting.fill(Chain::EMPTY);
        self.released = Chain::EMPTY;
        self.nearest.clear();
        self.joined.fill(0);
        self.step = 0;
    }
}

#[cfg(test)]
mod tests {
    use geobench_window::Count;

    use super::*;
    use crate::test_support::square;

    fn v(vertex: u32) -> VertexId {
        VertexId::new(vertex)
    }

    fn window(h: u32, id: u32) -> Event {
        Event::window(HalfEdgeId::new(h), id)
    }

    /// In the square, half-edges 0 to 2 belong to the face (0, 1, 2) and 3 to 5 to (0, 2, 3).
    #[test]
    fn windows_wait_for_their_faces_and_vertices_for_them() {
        let mesh = square();
        let mut order = VertexOrder::new(&mesh);
        order.push(2.0, Event::vertex(v(3)), &mut ());
        order.push(1.0, Event::vertex(v(1)), &mut ());
        order.push(9.0, window(3, 0), &mut ());
        order.push(8.0, window(2, 1), &mut ());
        order.push(7.0, window(0, 2), &mut ());
        order.push(6.0, window(0, 3), &mut ());
        assert_eq!(order.events().count(), 6);
        assert_eq!(order.pop(&mut ()), Some((1.0, Event::vertex(v(1)))));
        order.push(5.0, window(1, 4), &mut ());
        order.push(4.0, window(5, 5), &mut ());
        let released = [
            (7.0, window(0, 2)),
            (6.0, window(0, 3)),
            (8.0, window(2, 1)),
        ];
        for expected in released {
            assert_eq!(order.pop(&mut ()), Some(expected));
        }
        assert_eq!(order.pop(&mut ()), Some((5.0, window(1, 4))));
        assert_eq!(order.pop(&mut ()), Some((2.0, Event::vertex(v(3)))));
        assert_eq!(order.pop(&mut ()), Some((9.0, window(3, 0))));
        assert_eq!(order.pop(&mut ()), Some((4.0, window(5, 5))));
        assert_eq!(order.pop(&mut ()), None);
    }

    #[test]
    fn sources_release_windows_without_a_turn() {
        let mesh = square();
        let mut order = VertexOrder::new(&mesh);
        order.start(v(1));
        order.push(1.0, window(0, 0), &mut ());
        order.push(1.0, window(3, 1), &mut ());
        assert_eq!(order.pop(&mut ()), Some((1.0, window(0, 0))));
        assert_eq!(order.pop(&mut ()), None);
        order.clear();
        order.push(1.0, window(0, 0), &mut ());
        assert_eq!(order.pop(&mut ()), None, "a cleared area holds no face");
    }

    #[test]
    fn tries_in_a_new_face_are_prime() {
        let mesh = square();
        let mut order = VertexOrder::new(&mesh);
        let mut count = Count::default();
        order.start(v(1));
        order.crossed(HalfEdgeId::new(0), 2, &mut count);
        order.start(v(3));
        order.crossed(HalfEdgeId::new(0), 3, &mut count);
        order.crossed(HalfEdgeId::new(4), 5, &mut count);
        let counters = count.counters(VertexOrder::COUNTERS);
        assert_eq!(counters.get(Counter::Prime), Some(7));
        assert_eq!(counters.get(Counter::Secondary), Some(3));
    }
}
