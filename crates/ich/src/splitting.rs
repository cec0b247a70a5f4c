//! The policy of the CH family: windows are filtered, wait, are split once at each angle, and are
//! not stored.

use geobench_mesh::{HalfEdgeId, Mesh, Splice, VertexId};
use geobench_window::continuous::{Arrival, Child, Dequeued, Policy, Surface};
use geobench_window::precision::MARGIN;
use geobench_window::trimming::KeptWindows;
use geobench_window::{
    Counter, Crossing, Phase, Probe, Side, VertexFilter, Window, is_beaten_from_ends,
};

use crate::angle::{Angles, Split};
use crate::route::{Route, Routes};
use crate::tree::{Leaf, Leaves, Lineage};

/// The policy of the CH family: one angle, one split, with or without the vertex filter.
///
/// With `JOINT`, windows cross their triangles eight at a time, before they leave the queue. The
/// papers cross them one by one. Results do not depend on it.
///
/// ```
/// use geobench_ich::Splitting;
/// use geobench_mesh::Mesh;
/// use geobench_window::continuous::Continuous;
/// use geobench_window::queue::Fifo;
/// use geobench_window::{Solver, VertexFilter};
///
/// // ICH1: the filter, and windows first in, first out.
/// let mesh = Mesh::generate("terrain,n=8,seed=1")?;
/// let policy = Splitting::new(&mesh, VertexFilter::On);
/// let mut solver = Continuous::new(&mesh, policy, Fifo::default());
/// assert_eq!(solver.distances_from(5)?[5], 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Splitting<const JOINT: bool = false> {
    filter: VertexFilter,
    level_limit: u32,
    leaves: Leaves,
    angles: Angles,
    routes: Routes,
    kept: KeptWindows,
}

impl Splitting {
    /// Empty records for the angles of `mesh`.
    pub fn new(mesh: &Mesh, filter: VertexFilter) -> Self {
        let order = Surface::order(mesh);
        Self {
            filter,
            level_limit: mesh.face_count() as u32,
            leaves: Leaves::default(),
            angles: Angles::new(mesh.half_edge_count()),
            routes: Routes::default(),
            kept: KeptWindows::new(mesh, mesh.half_edge_count(), |h| {
                order.new_half_edge(h).index()
            }),
        }
    }

    /// The same policy with [joint crossing](Self).
    #[must_use]
    pub fn jointly(self) -> Splitting<true> {
        let Self {
            filter,
            level_limit,
            leaves,
            angles,
            routes,
            kept,
        } = self;
        Splitting {
            filter,
            level_limit,
            leaves,
            angles,
            routes,
            kept,
        }
    }
}

impl<const JOINT: bool> Splitting<JOINT> {
    /// Puts a window into the queue.
    #[inline(always)]
    #[allow(clippy::inline_always)] // Keeps the window in registers.
    fn wait<P: Probe>(
        &mut self,
        child: &Child<Lineage>,
        queue: &mut impl FnMut(HalfEdgeId, f64, u32, &mut P),
        probe: &mut P,
    ) {
        let Child {
            h,
            window,
            lineage,
            label,
            ..
        } = *child;
        probe.enter(Phase::Management);
        let id = self.leaves.insert(Leaf { window, lineage });
        probe.raise(Counter::PeakWindows, self.leaves.len() as u64);
        probe.raise(Counter::PeakWavefront, self.leaves.len() as u64);
        probe.raise(Counter::Levels, u64::from(lineage.level.count()));
        queue(h, label, id, probe);
    }

    /// Admits a window at a gate or at a half-edge where windows are stored.
    #[cold]
    #[inline(never)]
    #[allow(clippy::large_types_passed_by_value)] // Keeps the caller's value in registers.
    fn admit_held<P: Probe>(
        &mut self,
        child: Child<Lineage>,
        surface: &Surface,
        queue: &mut impl FnMut(HalfEdgeId, f64, u32, &mut P),
        probe: &mut P,
    ) -> bool {
        let Child {
            h, window, lineage, ..
        } = child;
        let Some(crossed) = self.routes.cross(h, &window, lineage.route(), surface) else {
            return self.store(&child, lineage.route(), queue, probe);
        };
        // Without the filter, windows that turn back into another sheet would go all the way back.
        if self.filter == VertexFilter::Off
            && is_beaten_beside_thin_faces(h, window, &self.kept, surface)
        {
            probe.add(Counter::Filtered, 1);
            return false;
        }
        let mut kept = false;
        for (h, window, route) in crossed {
            let child = Child { h, window, ..child };
            kept |= self.store(&child, route, queue, probe);
        }
        kept
    }

    /// Stores the part of a window that is shorter than those stored before, and puts it into the
    /// queue.
    fn store<P: Probe>(
        &mut self,
        child: &Child<Lineage>,
        route: Route,
        queue: &mut impl FnMut(HalfEdgeId, f64, u32, &mut P),
        probe: &mut P,
    ) -> bool {
        let Some(window) = self.kept.admit(child.h.index(), &child.window) else {
            probe.add(Counter::Filtered, 1);
            return false;
        };
        let mut lineage = child.lineage;
        lineage.go_on(route);
        let part = Child {
            window,
            lineage,
            ..*child
        };
        self.wait(&part, queue, probe);
        true
    }
}

/// Whether `window` on `h` is stale: its root has been reached by a shorter path, or a
/// better window has occupied the angle above it.
///
/// A window that has been stored beside a thin face or at a junction is not, nor are those below
/// it, unless the root has come nearer [by more than rounding](has_come_nearer): windows equal to
/// it have been dropped for it, maybe those of the shorter path to its root, or the one that
/// occupied the angle. It is stale if others have [replaced](KeptWindows::has_replaced) it.
#[inline]
#[allow(clippy::needless_bitwise_bool)] // Neither is likely: one branch for both.
pub(crate) fn is_stale(
    h: HalfEdgeId,
    window: &Window,
    lineage: &Lineage,
    surface: &Surface,
    angles: &Angles,
    kept: &KeptWindows,
) -> bool {
    if lineage.level.goes_on() {
        return kept.has_replaced(h.index(), window)
            || has_come_nearer(lineage.root, window, surface, kept);
    }
    (surface.distance(lineage.root) < window.sigma) | angles.cuts_off(&lineage.guard)
}

/// Whether the root of `window` has come nearer by more than rounding. Then the windows that were
/// dropped as equal to this one are needed no more than it is.
#[cold]
fn has_come_nearer(root: VertexId, window: &Window, surface: &Surface, kept: &KeptWindows) -> bool {
    let farthest = window.distance(window.b0).max(window.distance(window.b1));
    surface.distance(root) + MARGIN * farthest + kept.doubt() < window.sigma
}

/// Whether a beaten window is beaten by more than the doubt beside thin faces and junctions.
///
/// Of windows that are equal within the rounding of a long edge, the first one was stored. Its σ
/// may be greater by that much, which is too much for the margin of the short edges at which it
/// arrives next.
#[cold]
#[inline(never)]
#[allow(clippy::large_types_passed_by_value)] // Keeps the caller's value in registers.
pub(crate) fn is_beaten_beside_thin_faces(
    h: HalfEdgeId,
    w: Window,
    kept: &KeptWindows,
    surface: &Surface,
) -> bool {
    let edge = surface.edge(h);
    let [tail, head] = [edge.tail, edge.head].map(|d| d + kept.doubt());
    is_beaten_from_ends(&w, edge.length, tail, head)
}

impl<const JOINT: bool> Policy for Splitting<JOINT> {
    type Lineage = Lineage;

    const COUNTERS: &'static [Counter] = &[
        Counter::Filtered,
        Counter::PeakWindows,
        Counter::PeakWavefront,
        Counter::Levels,
    ];

    const WINDOW_BYTES: usize = size_of::<Leaf>();
    const JUNCTIONS: bool = true;
    const SPLICES: bool = true;

    fn splice(&mut self, mesh: &Mesh, splice: &Splice, surface: &Surface) {
        self.level_limit = mesh.face_count() as u32;
        self.angles.resize(mesh.half_edge_count());
        let number = |h| surface.faces().number(h).index();
        self.kept
            .splice(mesh, splice, mesh.half_edge_count(), number);
    }

    fn reset(&mut self) {
        self.leaves.clear();
        self.angles.clear();
        self.routes.clear();
        self.kept.clear();
    }

    fn reset_at(&mut self, half_edges: impl Iterator<Item = HalfEdgeId>) {
        self.leaves.clear();
        self.angles.clear_beyond_junctions();
        self.routes.clear();
        for h in half_edges {
            self.angles.clear_at(h);
            self.kept.clear_at(h.index());
        }
    }

    fn root(&self, v: VertexId, _: &Surface) -> Lineage {
        Lineage::new(v)
    }

    #[inline(always)]
    #[allow(clippy::inline_always)] // Keeps the window in registers.
    fn arrive<P: Probe>(
        &mut self,
        arrival: &Arrival<Lineage>,
        surface: &Surface,
        queue: &mut impl FnMut(HalfEdgeId, f64, u32, &mut P),
        probe: &mut P,
    ) -> bool {
        let Arrival {
            h,
            window,
            lineage,
            edge,
        } = *arrival;
        let child = Child {
            h,
            window,
            lineage,
            label: window.min_distance(),
            is_beaten: self.filter == VertexFilter::On && edge.beats(&window),
        };
        self.admit(&child, surface, queue, probe)
    }

    const FORESEES: bool = JOINT;

    #[inline]
    fn foresee(&self, id: u32) -> Option<&Window> {
        Some(self.leaves.window(id))
    }

    #[inline(always)]
    #[allow(clippy::inline_always)] // Keeps the window in registers.
    fn admit<P: Probe>(
        &mut self,
        child: &Child<Lineage>,
        surface: &Surface,
        queue: &mut impl FnMut(HalfEdgeId, f64, u32, &mut P),
        probe: &mut P,
    ) -> bool {
        if self.filter == VertexFilter::On
            && child.is_beaten
            && (child.label >= self.kept.reach()
                || is_beaten_beside_thin_faces(child.h, child.window, &self.kept, surface))
        {
            probe.add(Counter::Filtered, 1);
            return false;
        }
        if self.kept.holds(child.h.index()) {
            return self.admit_held(*child, surface, queue, probe);
        }
        self.wait(child, queue, probe);
        true
    }

    #[inline]
    fn take<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        id: u32,
        surface: &Surface,
        probe: &mut P,
    ) -> Dequeued<Lineage> {
        let window = *self.leaves.window(id);
        match self.release(h, id, surface, probe) {
            Some(lineage) => Dequeued::Propagate(window, lineage),
            None => Dequeued::Stale,
        }
    }

    #[inline(always)]
    #[allow(clippy::inline_always)] // Called in one place; keeps its values in registers.
    fn release<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        id: u32,
        surface: &Surface,
        probe: &mut P,
    ) -> Option<Lineage> {
        let Leaf { window, lineage } = self.leaves.remove(id);
        if is_stale(h, &window, &lineage, surface, &self.angles, &self.kept) {
            probe.add(Counter::Filtered, 1);
            return None;
        }
        Some(lineage)
    }

    #[inline]
    fn announce(&self, _: HalfEdgeId, id: u32) {
        self.leaves.announce(id);
    }

    #[inline]
    fn prepare(&self, _: HalfEdgeId, id: u32, surface: &Surface) {
        let lineage = self.leaves.lineage(id);
        surface.announce_vertex(lineage.root);
        self.angles.announce(&lineage.guard);
    }

    #[inline]
    fn descend(&self, lineage: &Lineage) -> Option<Lineage> {
        let too_deep =
            self.filter == VertexFilter::Off && lineage.level.count() >= self.level_limit;
        (!too_deep).then_some(Lineage {
            level: lineage.level.next(),
            ..*lineage
        })
    }

    fn split(
        &mut self,
        angle: HalfEdgeId,
        crossing: &Crossing<'_>,
        inherited: Lineage,
        _: &Surface,
    ) -> [Option<Lineage>; 2] {
        self.split_at(
            angle,
            crossing.entry(),
            crossing.straight_distance(),
            inherited,
        )
    }

    #[inline]
    fn split_at(
        &mut self,
        angle: HalfEdgeId,
        entry: f64,
        d: f64,
        inherited: Lineage,
    ) -> [Option<Lineage>; 2] {
        let angle = self.angles.number(angle, inherited.route());
        match self.angles.split(angle, d, entry) {
            Split::Occupies => {
                [Side::Left, Side::Right].map(|side| Some(inherited.split(angle, entry, side)))
            }
            Split::Ties => [Some(inherited); 2],
            Split::Only(Side::Left) => [Some(inherited), None],
            Split::Only(Side::Right) => [None, Some(inherited)],
        }
    }
}
