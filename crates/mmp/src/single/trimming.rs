//! The policy of MMP: every window is stored on the range on which it is the shortest.

use geobench_mesh::{HalfEdgeId, Mesh, Splice, VertexId};
use geobench_window::continuous::{Arrival, Continuous, Dequeued, Policy, Surface};
use geobench_window::queue::Discipline;
use geobench_window::trimming::ThinFaces;
use geobench_window::{Counter, Crossing, Probe, Window, is_beaten_from_ends};

use super::insertion::Inserter;
use super::lists::{Direction, Lists};
use crate::eviction::{Evictable, Eviction, Retention, reach};

/// The windows that are trimmed against each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carrier {
    /// Those of one half-edge: windows that cross an edge in opposite directions are not compared
    /// (Surazhsky et al. 2005).
    HalfEdge,
    /// Those of both half-edges of an edge (Liu, "Exact geodesic metric in 2-manifold triangle
    /// meshes using edge-based data structures", 2013). A window that loses a point of the edge to
    /// one from the other side provides no shortest path beyond it, and is not stored there.
    Edge,
}

/// The policy of MMP: a window is stored on the range on which it is the shortest of those on its
/// half-edge or edge.
///
/// ```
/// use geobench_mesh::Mesh;
/// use geobench_mmp::{Carrier, Trimming};
/// use geobench_window::Solver;
/// use geobench_window::continuous::Continuous;
/// use geobench_window::queue::Fifo;
///
/// let mesh = Mesh::generate("terrain,n=8,seed=1")?;
/// let policy = Trimming::new(&mesh, Carrier::HalfEdge);
/// let mut solver = Continuous::new(&mesh, policy, Fifo::default());
/// assert_eq!(solver.distances_from(5)?[5], 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Trimming {
    carrier: Carrier,
    retention: Retention,
    /// The windows about to enter the face of each half-edge. With [`Carrier::Edge`] those of both
    /// half-edges of an edge are in the list of the half-edge with the lower number, in its frame.
    lists: Lists,
    inserter: Inserter,
    eviction: Eviction,
    thin: ThinFaces,
    /// Windows that are stored or would be without eviction.
    stored: usize,
    /// The level in the sequence tree of each window, by slot. Only the papers' counts need it.
    /// Counted runs only.
    levels: Vec<u32>,
}

impl Trimming {
    /// Empty lists for the half-edges of `mesh`; all windows are stored until the end.
    pub fn new(mesh: &Mesh, carrier: Carrier) -> Self {
        let order = Surface::order(mesh);
        Self {
            carrier,
            retention: Retention::default(),
            lists: Lists::new(mesh.half_edge_count(), mesh.junction_sides().len()),
            inserter: Inserter::default(),
            eviction: Eviction::default(),
            thin: ThinFaces::of(mesh, mesh.half_edge_count(), |h| {
                order.new_half_edge(h).index()
            }),
            stored: 0,
            levels: Vec::new(),
        }
    }

    /// Chooses which windows are stored until the end.
    #[must_use]
    pub fn retaining(self, retention: Retention) -> Self {
        Self { retention, ..self }
    }

    /// The windows stored for the half-edge with number `h`, in the order of their intervals.
    fn stored(&self, h: HalfEdgeId) -> impl Iterator<Item = Window> {
        let slots = self.lists.places(h.index()).iter();
        slots.map(|place| self.lists.windows()[place.slot as usize])
    }

    /// Whether a path through an end of the edge beats the window by more than the
    /// [doubt](geobench_window::trimming::ThinFaces::doubt) beside thin faces: of windows that are
    /// equal within the rounding of a long edge the first one is stored, even if it is longer by
    /// that much.
    #[cold]
    #[inline(never)]
    fn is_beaten(&self, arrival: &Arrival<u32>) -> bool {
        let Arrival { window, edge, .. } = arrival;
        let [tail, head] = [edge.tail, edge.head].map(|d| d + self.thin.doubt());
        is_beaten_from_ends(window, edge.length, tail, head)
    }

    /// Passes a window at a gate on to all half-edges beyond it. The lists there are compared
    /// separately: a path may enter any of the faces, and which ones of the others a shorter path
    /// has come from does not matter. `None` if the window is at no gate.
    #[cold]
    #[inline(never)]
    fn pass_on<P: Probe>(
        &mut self,
        arrival: &Arrival<u32>,
        surface: &Surface,
        queue: &mut impl FnMut(HalfEdgeId, f64, u32, &mut P),
        probe: &mut P,
    ) -> Option<bool> {
        let entrances = surface.faces().beyond(arrival.h)?;
        // Without the filter, windows that turn back into another sheet would go all the way back.
        if self.is_beaten(arrival) {
            probe.add(Counter::Filtered, 1);
            return Some(false);
        }
        let mut kept = false;
        for entrance in entrances {
            let Some(window) = entrance.carry(&arrival.window, arrival.edge.length) else {
                continue;
            };
            let edge = if entrance.mirrored {
                arrival.edge.mirrored()
            } else {
                arrival.edge
            };
            let own = Arrival {
                h: entrance.half_edge,
                window,
                edge,
                ..*arrival
            };
            kept |= self.arrive(&own, surface, queue, probe);
        }
        Some(kept)
    }

    /// The half-edge whose list holds the windows of `h`, and the direction in which they cross its
    /// edge.
    fn place(&self, h: HalfEdgeId, surface: &Surface) -> (HalfEdgeId, Direction) {
        if self.carrier == Carrier::HalfEdge {
            return (h, Direction::Forward);
        }
        match surface.faces().twin(h) {
            Some(twin) if twin < h => (twin, Direction::Reverse),
            _ => (h, Direction::Forward),
        }
    }
}

/// The windows that entered the face of `h` in the last run of `solver`, in ascending order. Each
/// is restricted to the interval on which it is the shortest. They do not overlap.
///
/// The result is complete only for [`Carrier::HalfEdge`] and [`Retention::All`]. With other
/// settings windows are missing.
///
/// ```
/// use geobench_mesh::Mesh;
/// use geobench_mmp::{mmp, windows_of};
/// use geobench_window::Solver;
///
/// // A square cut along a diagonal: the window of vertex 1 covers the diagonal.
/// let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(positions, vec![[0, 1, 2], [0, 2, 3]])?;
/// let mut solver = mmp(&mesh);
/// solver.distances_from(1)?;
/// let windows = mesh.half_edges().flat_map(|h| windows_of(&solver, h));
/// assert_eq!(windows.count(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn windows_of<Q: Discipline>(
    solver: &Continuous<Trimming, Q>,
    h: HalfEdgeId,
) -> impl Iterator<Item = Window> {
    solver.policy().stored(solver.number(h))
}

impl Policy for Trimming {
    /// The level in the sequence tree, in counted runs; else 0.
    type Lineage = u32;

    const COUNTERS: &'static [Counter] = &[
        Counter::Reinserted,
        Counter::Trimmed,
        Counter::Filtered,
        Counter::PeakWindows,
        Counter::PeakWavefront,
        Counter::StoredWindows,
        Counter::Levels,
    ];

    const WINDOW_BYTES: usize = Lists::WINDOW_BYTES;
    const JUNCTIONS: bool = true;
    const SPLICES: bool = true;

    fn splice(&mut self, mesh: &Mesh, splice: &Splice, surface: &Surface) {
        let half_edges = mesh.half_edge_count();
        self.lists
            .set_count(half_edges, mesh.junction_sides().len());
        let number = |h| surface.faces().number(h).index();
        self.thin.splice(mesh, splice, half_edges, number);
    }

    fn reset(&mut self) {
        self.lists.clear();
        self.eviction.clear();
        self.stored = 0;
        self.levels.clear();
    }

    fn reset_at(&mut self, half_edges: impl Iterator<Item = HalfEdgeId>) {
        // With `Carrier::Edge`, the list of an edge is that of one of its half-edges.
        self.lists.clear_at(half_edges.map(HalfEdgeId::index));
        self.eviction.clear();
        self.stored = 0;
        self.levels.clear();
    }

    fn waiting(&self, h: HalfEdgeId, id: u32, surface: &Surface) -> Option<Window> {
        let window = || self.lists.windows()[id as usize];
        let (_, direction) = self.place(h, surface);
        self.lists
            .waits(id)
            .then(|| direction.turned(&window(), surface.faces().length(h)))
    }

    fn root(&self, _: VertexId, _: &Surface) -> u32 {
        0
    }

    #[inline(always)]
    #[allow(clippy::inline_always)] // Keeps the window in registers.
    fn arrive<P: Probe>(
        &mut self,
        arrival: &Arrival<u32>,
        surface: &Surface,
        queue: &mut impl FnMut(HalfEdgeId, f64, u32, &mut P),
        probe: &mut P,
    ) -> bool {
        let l = arrival.edge.length;
        // The papers have no filter. Beside thin faces it is needed: windows that are not taken
        // nearest first would wind around needles.
        if self.thin.is_beside(arrival.h.index()) && self.is_beaten(arrival) {
            probe.add(Counter::Filtered, 1);
            return false;
        }
        let (place, direction) = self.place(arrival.h, surface);
        let window = direction.turned(&arrival.window, l);
        let place = place.index();
        if self.lists.is_evicted(place) {
            if let Some(kept) = self.pass_on(arrival, surface, queue, probe) {
                return kept;
            }
            if (self.lists).rejects_late_arrival(place, &window, &arrival.edge) {
                probe.add(Counter::Filtered, 1);
                return false;
            }
        }
        let lists = &mut self.lists;
        let before = lists.len(place);
        self.inserter.insert(lists, place, &window, direction, l);
        let effects = &self.inserter.effects;
        self.stored = self.stored + lists.len(place) - before;
        for entry in &effects.to_queue {
            // A window of the other direction may have been split; its second part waits as well.
            let h = if self.lists.direction(entry.slot) == direction {
                arrival.h
            } else {
                surface.faces().twin(arrival.h).unwrap_or(arrival.h)
            };
            queue(h, entry.label, entry.slot, probe);
        }
        let kept = effects.new_pieces > 0;
        probe.add(Counter::Reinserted, effects.outdated as u64);
        probe.add(Counter::Trimmed, effects.trimmed as u64);
        probe.add(Counter::Filtered, effects.removed as u64 + u64::from(!kept));
        probe.raise(Counter::PeakWindows, self.lists.stored() as u64);
        if P::COUNTS {
            let slots = self.lists.windows().len();
            self.levels.resize(slots.max(self.levels.len()), 0);
            for entry in &effects.to_queue {
                let level = entry.part_of.map(|slot| self.levels[slot as usize]);
                self.levels[entry.slot as usize] = level.unwrap_or(arrival.lineage);
            }
            let waiting = self.lists.waiting();
            probe.raise(Counter::PeakWavefront, waiting as u64);
            if kept {
                probe.raise(Counter::Levels, u64::from(arrival.lineage));
            }
        }
        kept
    }

    #[inline(always)] // As `Lists::take`.
    #[allow(clippy::inline_always)] // Called for every window, and small.
    fn take<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        id: u32,
        surface: &Surface,
        _: &mut P,
    ) -> Dequeued<u32> {
        let (place, direction) = self.place(h, surface);
        let window = match self.lists.take(place.index(), id) {
            Dequeued::Propagate(window, ()) => window,
            Dequeued::Requeue(label) => return Dequeued::Requeue(label),
            Dequeued::Stale => return Dequeued::Stale,
        };
        if self.retention == Retention::Wavefront {
            if !self.lists.is_waited_for(place.index()) && !self.thin.is_beside(place.index()) {
                let edge = surface.edge(place);
                let within = reach([edge.tail, edge.head], edge.length);
                self.eviction.note(place, within);
            }
            self.eviction
                .step(&mut self.lists, 1, || window.min_distance());
        }
        let window = direction.turned(&window, surface.faces().length(h));
        let level = if P::COUNTS {
            self.levels[id as usize]
        } else {
            0
        };
        Dequeued::Propagate(window, level)
    }

    /// The left exit is always tried; the right one only if some ray can leave there.
    #[inline]
    fn tries(crossing: &Crossing<'_>) -> [bool; 2] {
        [true, crossing.goes_right()]
    }

    #[inline]
    fn announce(&self, h: HalfEdgeId, id: u32) {
        // With `Carrier::Edge` this may prefetch another list, which does no harm.
        self.lists.announce(h.index(), id);
    }

    #[inline]
    fn descend(&self, level: &u32) -> Option<u32> {
        Some(level + 1)
    }

    #[inline]
    fn split(
        &mut self,
        _: HalfEdgeId,
        _: &Crossing<'_>,
        inherited: u32,
        _: &Surface,
    ) -> [Option<u32>; 2] {
        [Some(inherited); 2]
    }

    fn finish<P: Probe>(&mut self, probe: &mut P) {
        probe.add(Counter::StoredWindows, self.stored as u64);
    }
}
