//! The policy of MMP: every window is kept on its half-edge, where it is the shortest.

use geobench_mesh::{HalfEdgeId, Mesh, VertexId};
use geobench_window::continuous::{Arrival, Crossing, Policy, Surface};
use geobench_window::{Counter, Probe, Window};

use crate::list::{Inserter, WindowList};

/// Windows stored on half-edges, those of one half-edge trimmed against each other.
///
/// Windows that cross an edge in opposite directions do not meet; [the edge-based variant]
/// (Liu 2013) would store fewer.
///
/// [the edge-based variant]: https://doi.org/10.1016/j.cad.2012.11.005
#[derive(Clone, Debug)]
pub struct Trimming {
    /// The windows about to enter the face of each half-edge.
    lists: Vec<WindowList>,
    inserter: Inserter,
    stored: usize,
}

impl Trimming {
    /// Empty lists for the half-edges of `mesh`.
    pub fn new(mesh: &Mesh) -> Self {
        Self {
            lists: vec![WindowList::default(); mesh.half_edge_count()],
            inserter: Inserter::default(),
            stored: 0,
        }
    }
}

impl Policy for Trimming {
    type Lineage = ();

    const COUNTERS: &'static [Counter] = &[
        Counter::Reinserted,
        Counter::Trimmed,
        Counter::Filtered,
        Counter::PeakWindows,
        Counter::StoredWindows,
    ];

    const WINDOW_BYTES: usize = WindowList::WINDOW_BYTES;

    fn reset(&mut self) {
        self.lists.iter_mut().for_each(WindowList::clear);
        self.stored = 0;
    }

    fn root(&self, _: VertexId, _: &Surface) {}

    fn arrive<P: Probe>(
        &mut self,
        arrival: &Arrival<()>,
        surface: &Surface,
        queue: &mut impl FnMut(f64, u32, &mut P),
        probe: &mut P,
    ) -> bool {
        let h = arrival.h;
        let list = &mut self.lists[h.index()];
        let inserter = &mut self.inserter;
        let before = list.len();
        inserter.insert(list, &arrival.window, surface.faces().length(h));
        self.stored = self.stored + list.len() - before;
        for &(label, id) in &inserter.to_queue {
            queue(label, id, probe);
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
        kept
    }

    fn take<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        id: u32,
        _: &Surface,
        _: &mut P,
    ) -> Option<(Window, ())> {
        self.lists[h.index()].take(id).map(|window| (window, ()))
    }

    /// Going round the triangle from the left, a window all of whose rays leave there is done.
    fn split(&mut self, crossing: &Crossing, (): &(), _: &Surface) -> [Option<()>; 2] {
        [
            Some(()),
            (crossing.window.b1 > crossing.separation).then_some(()),
        ]
    }

    fn finish<P: Probe>(&mut self, probe: &mut P) {
        probe.add(Counter::StoredWindows, self.stored as u64);
    }
}
