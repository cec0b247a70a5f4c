//! The policy of MMP: every window is kept where it is the shortest.

use geobench_mesh::{HalfEdgeId, Mesh, VertexId};
use geobench_window::continuous::{Arrival, Policy, Surface};
use geobench_window::{Counter, Passage, Probe, Window, prefetch};

use crate::levels::Levels;
use crate::list::{Direction, Inserter, WindowList};

/// Which windows are trimmed against each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carrier {
    /// Those of one half-edge: windows that cross an edge in opposite directions do not meet
    /// (Surazhsky et al. 2005).
    HalfEdge,
    /// Those of both half-edges of an edge (Liu, "Exact geodesic metric in 2-manifold triangle
    /// meshes using edge-based data structures", 2013). A window that loses a point of the edge to
    /// one that comes from the other side is of no use beyond it, and is not stored there.
    Edge,
}

/// Every window is stored where it is the shortest of those on its half-edge or edge.
#[derive(Clone, Debug)]
pub struct Trimming {
    carrier: Carrier,
    /// The windows about to enter the face of each half-edge; with [`Carrier::Edge`] those of both
    /// half-edges of an edge stand with the one of lower number, in its frame.
    lists: Vec<WindowList>,
    inserter: Inserter,
    stored: usize,
    /// Kept in counted runs only.
    levels: Levels,
}

impl Trimming {
    /// Empty lists for the half-edges of `mesh`.
    pub fn new(mesh: &Mesh, carrier: Carrier) -> Self {
        Self {
            carrier,
            lists: vec![WindowList::default(); mesh.half_edge_count()],
            inserter: Inserter::default(),
            stored: 0,
            levels: Levels::default(),
        }
    }

    /// The half-edge whose list holds the windows of `h`, and how they cross there.
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

    const WINDOW_BYTES: usize = WindowList::WINDOW_BYTES;

    fn reset(&mut self) {
        self.lists.iter_mut().for_each(WindowList::clear);
        self.stored = 0;
        self.levels.clear();
    }

    fn root(&self, _: VertexId, _: &Surface) -> u32 {
        0
    }

    fn arrive<P: Probe>(
        &mut self,
        arrival: &Arrival<u32>,
        surface: &Surface,
        queue: &mut impl FnMut(HalfEdgeId, f64, u32, &mut P),
        probe: &mut P,
    ) -> bool {
        let l = arrival.edge.length;
        let (place, direction) = self.place(arrival.h, surface);
        let window = match direction {
            Direction::Forward => arrival.window,
            Direction::Reverse => arrival.window.reversed(l),
        };
        let list = &mut self.lists[place.index()];
        let inserter = &mut self.inserter;
        let before = list.len();
        if P::COUNTS {
            self.levels.before_insertion(list);
        }
        inserter.insert(list, &window, direction, l);
        self.stored = self.stored + list.len() - before;
        for entry in &inserter.to_queue {
            // One of the other direction may have been trimmed and must wait anew.
            let h = if Direction::of(entry.id) == direction {
                arrival.h
            } else {
                surface.faces().twin(arrival.h).unwrap_or(arrival.h)
            };
            queue(h, entry.label, entry.id, probe);
        }
        let kept = inserter.new_pieces > 0;
        probe.add(
            Counter::Reinserted,
            (inserter.to_queue.len() - inserter.new_pieces) as u64,
        );
        probe.add(Counter::Trimmed, inserter.trimmed as u64);
        probe.add(
            Counter::Filtered,
            inserter.removed as u64 + u64::from(!kept),
        );
        probe.raise(Counter::PeakWindows, self.stored as u64);
        if P::COUNTS {
            let entries = &inserter.to_queue;
            self.levels.after_insertion(list, entries, arrival.lineage);
            probe.raise(Counter::PeakWavefront, self.levels.len() as u64);
            if kept {
                probe.raise(Counter::Levels, u64::from(arrival.lineage));
            }
        }
        kept
    }

    fn take<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        id: u32,
        surface: &Surface,
        _: &mut P,
    ) -> Option<(Window, u32)> {
        let (place, direction) = self.place(h, surface);
        let window = self.lists[place.index()].take(id)?;
        let window = match direction {
            Direction::Forward => window,
            Direction::Reverse => window.reversed(surface.faces().length(h)),
        };
        let level = if P::COUNTS { self.levels.take(id) } else { 0 };
        Some((window, level))
    }

    /// Going round the triangle from the left, a window all of whose rays leave there is done.
    #[inline]
    fn tries(passage: &Passage<'_>) -> [bool; 2] {
        [true, passage.goes_right()]
    }

    #[inline]
    fn announce(&self, h: HalfEdgeId, _: u32) {
        // The edge-based variant may have its windows elsewhere, which then come unannounced.
        prefetch(&self.lists, h.index());
    }

    #[inline]
    fn prepare(&self, h: HalfEdgeId, _: u32, _: &Surface) {
        self.lists[h.index()].announce();
    }

    #[inline]
    fn descend(&self, level: &u32) -> Option<u32> {
        Some(level + 1)
    }

    #[inline]
    fn split(
        &mut self,
        _: HalfEdgeId,
        _: &Passage<'_>,
        heir: u32,
        _: &Surface,
    ) -> [Option<u32>; 2] {
        [Some(heir); 2]
    }

    fn finish<P: Probe>(&mut self, probe: &mut P) {
        probe.add(Counter::StoredWindows, self.stored as u64);
    }
}
