//! Policies: what happens to the windows of an algorithm.

use geobench_mesh::{HalfEdgeId, Mesh, Splice, VertexId};

use super::edge::EdgeView;
use super::surface::Surface;
use crate::counters::Counter;
use crate::crossing::Crossing;
use crate::probe::Probe;
use crate::window::Window;

/// A window that has reached a half-edge.
#[derive(Clone, Copy, Debug)]
pub struct Arrival<L> {
    /// The half-edge, in whose frame the window is.
    pub h: HalfEdgeId,
    /// The window.
    pub window: Window,
    /// The lineage inherited from its parent.
    pub lineage: L,
    /// The half-edge's length and the distances around it.
    pub edge: EdgeView,
}

/// A window that has reached a half-edge, with the values that a policy with
/// [`FORESEES`](Policy::FORESEES) needs.
#[derive(Clone, Copy, Debug)]
pub struct Child<L> {
    /// The half-edge, in whose frame the window is.
    pub h: HalfEdgeId,
    /// The window.
    pub window: Window,
    /// The lineage inherited from its parent.
    pub lineage: L,
    /// Its [least distance](Window::min_distance).
    pub label: f64,
    /// Whether a path through one of the vertices around is shorter than every ray of the window.
    pub is_beaten: bool,
}

/// What to do with a window that comes out of the queue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Dequeued<L> {
    /// The window is propagated; its children inherit the lineage.
    Propagate(Window, L),
    /// The window was removed or propagated before.
    Stale,
    /// The window goes back into the queue with this label, or is taken again at once if no other
    /// event comes first.
    Requeue(f64),
}

/// Decides which part of an arriving window is kept, where it waits, and which children it may
/// have.
///
/// ```
/// use geobench_mesh::{HalfEdgeId, Mesh, VertexId};
/// use geobench_window::continuous::{Arrival, Continuous, Dequeued, Policy, Surface};
/// use geobench_window::queue::Fifo;
/// use geobench_window::{Counter, Crossing, Probe, Solver, Window};
///
/// /// Propagates all windows whole. It ends only on convex plane meshes.
/// #[derive(Default)]
/// struct PropagateAll(Vec<Window>);
///
/// impl Policy for PropagateAll {
///     type Lineage = ();
///     const COUNTERS: &'static [Counter] = &[];
///     const WINDOW_BYTES: usize = size_of::<Window>();
///
///     fn reset(&mut self) {
///         self.0.clear();
///     }
///
///     fn root(&self, _: VertexId, _: &Surface) {}
///
///     fn arrive<P: Probe>(
///         &mut self,
///         arrival: &Arrival<()>,
///         _: &Surface,
///         queue: &mut impl FnMut(HalfEdgeId, f64, u32, &mut P),
///         probe: &mut P,
///     ) -> bool {
///         let (window, id) = (arrival.window, self.0.len() as u32);
///         self.0.push(window);
///         queue(arrival.h, window.min_distance(), id, probe);
///         true
///     }
///
///     fn take<P: Probe>(
///         &mut self,
///         _: HalfEdgeId,
///         id: u32,
///         _: &Surface,
///         _: &mut P,
///     ) -> Dequeued<()> {
///         Dequeued::Propagate(self.0[id as usize], ())
///     }
///
///     fn descend(&self, (): &()) -> Option<()> {
///         Some(())
///     }
///
///     fn split(
///         &mut self,
///         _: HalfEdgeId,
///         _: &Crossing<'_>,
///         (): (),
///         _: &Surface,
///     ) -> [Option<()>; 2] {
///         [Some(()); 2]
///     }
/// }
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let mut solver = Continuous::new(&mesh, PropagateAll::default(), Fifo::default());
/// let distances = solver.distances_from(0)?;
/// assert!((distances[24] - 32.0_f64.sqrt()).abs() < 1e-12); // Across the whole grid.
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Policy: Send {
    /// The data that children inherit from a window, in addition to their geometry.
    type Lineage: Copy;

    /// The counters that this policy keeps, in addition to those of every algorithm of the family.
    const COUNTERS: &'static [Counter];

    /// Bytes that a waiting window takes.
    const WINDOW_BYTES: usize;

    /// Whether it passes windows that arrive at a [gate](crate::Faces::with_gates) on to the
    /// half-edges beyond.
    const JUNCTIONS: bool = false;

    /// Resets the policy for the next run, keeping the memory.
    fn reset(&mut self);

    /// As [`reset`](Self::reset), after a run whose windows arrived at no half-edges but
    /// `half_edges`. A policy used by an [`Explorer`](super::Explorer) should override this with a
    /// reset whose time depends on these half-edges only.
    fn reset_at(&mut self, half_edges: impl Iterator<Item = HalfEdgeId>) {
        let _ = half_edges;
        self.reset();
    }

    /// Window `id` in the frame of `h`, which has an event in the queue; `None` if it no longer
    /// waits.
    fn waiting(&self, h: HalfEdgeId, id: u32, surface: &Surface) -> Option<Window> {
        let _ = (h, surface);
        self.foresee(id).copied()
    }

    /// The lineage of windows that start from `v`.
    fn root(&self, v: VertexId, surface: &Surface) -> Self::Lineage;

    /// A window arrives at a half-edge. Stores the part that may matter. Calls `queue` with a
    /// half-edge, a label and an id for everything that must wait for its turn. Returns whether any
    /// part of the window is left.
    fn arrive<P: Probe>(
        &mut self,
        arrival: &Arrival<Self::Lineage>,
        surface: &Surface,
        queue: &mut impl FnMut(HalfEdgeId, f64, u32, &mut P),
        probe: &mut P,
    ) -> bool;

    /// Decides whether window `id` on `h`, which has left the queue, is propagated now.
    fn take<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        id: u32,
        surface: &Surface,
        probe: &mut P,
    ) -> Dequeued<Self::Lineage>;

    /// Whether windows may be crossed several at a time, before they leave the queue. A policy may
    /// set this if waiting windows do not change, if [`Child`] holds all that it asks about an
    /// arriving window, and if both children are always [tried](Self::tries).
    const FORESEES: bool = false;

    /// Window `id`, which waits, if the policy [foresees](Self::FORESEES).
    #[inline]
    fn foresee(&self, id: u32) -> Option<&Window> {
        let _ = id;
        None
    }

    /// As [`take`](Self::take), without the window, for a policy that [foresees](Self::FORESEES);
    /// `None` if there is nothing to propagate.
    #[inline]
    fn release<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        id: u32,
        surface: &Surface,
        probe: &mut P,
    ) -> Option<Self::Lineage> {
        let _ = (h, id, surface, probe);
        None
    }

    /// As [`split`](Self::split), for a policy that [foresees](Self::FORESEES). The straight path
    /// to the apex has length `d` and meets the half-edge `angle` at the fraction `entry` of its
    /// length, which is NaN if rounding leaves it undetermined.
    #[inline]
    fn split_at(
        &mut self,
        angle: HalfEdgeId,
        entry: f64,
        d: f64,
        inherited: Self::Lineage,
    ) -> [Option<Self::Lineage>; 2] {
        let _ = (angle, entry, d);
        [Some(inherited); 2]
    }

    /// As [`arrive`](Self::arrive), for a policy that [foresees](Self::FORESEES).
    #[inline]
    fn admit<P: Probe>(
        &mut self,
        child: &Child<Self::Lineage>,
        surface: &Surface,
        queue: &mut impl FnMut(HalfEdgeId, f64, u32, &mut P),
        probe: &mut P,
    ) -> bool {
        let _ = (child, surface, queue, probe);
        false
    }

    /// Prefetches the memory of window `id` on `h`, which is likely to be taken soon. Reads
    /// nothing.
    #[inline]
    fn announce(&self, h: HalfEdgeId, id: u32) {
        let _ = (h, id);
    }

    /// Prefetches what [`take`](Self::take) will need for window `id` on `h`, which was announced
    /// some turns ago and is likely to be taken in a few. May read the window.
    #[inline]
    fn prepare(&self, h: HalfEdgeId, id: u32, surface: &Surface) {
        let _ = (h, id, surface);
    }

    /// Which children of a window on one side of the apex are tried, the left and the right one:
    /// those that must be computed to find that they are empty. Used by counters only.
    #[inline]
    fn tries(crossing: &Crossing<'_>) -> [bool; 2] {
        let _ = crossing;
        [true; 2]
    }

    /// What the children of a window inherit; `None` if it may not have any.
    fn descend(&self, lineage: &Self::Lineage) -> Option<Self::Lineage>;

    /// Which children to try, left and right, of a window that has entered through `h` and covers
    /// the apex, and what each inherits. `inherited` is what they inherit without a split.
    fn split(
        &mut self,
        h: HalfEdgeId,
        crossing: &Crossing<'_>,
        inherited: Self::Lineage,
        surface: &Surface,
    ) -> [Option<Self::Lineage>; 2];

    /// Whether it follows changes of the mesh by [`splice`](Self::splice).
    const SPLICES: bool = false;

    /// Follows a change of the mesh, which is `mesh` now, between two runs. `surface` has followed
    /// it.
    fn splice(&mut self, mesh: &Mesh, splice: &Splice, surface: &Surface) {
        let _ = (mesh, splice, surface);
    }

    /// Called at the end of a run, for the last counts.
    fn finish<P: Probe>(&mut self, probe: &mut P) {
        let _ = probe;
    }
}
