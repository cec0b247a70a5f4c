//! What happens to windows.

use geobench_mesh::{HalfEdgeId, VertexId};

use super::edge::Edge;
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
    /// What it inherited.
    pub lineage: L,
    /// What is known around the half-edge.
    pub edge: Edge,
}

/// A window that has reached a half-edge, of which all that a [policy](Policy::FORESEES) asks is
/// known already.
#[derive(Clone, Copy, Debug)]
pub struct Child<L> {
    /// The half-edge, in whose frame the window is.
    pub h: HalfEdgeId,
    /// The window.
    pub window: Window,
    /// What it inherited.
    pub lineage: L,
    /// Its [least distance](Window::min_distance).
    pub label: f64,
    /// Whether a path through one of the vertices around beats every ray of it.
    pub is_beaten: bool,
}

/// What becomes of a window whose turn has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Turn<L> {
    /// It is propagated, and hands this on.
    Now(Window, L),
    /// It does not exist any more, or has had its turn.
    Void,
    /// It should wait until the queue comes to this label, or be taken again if that is now.
    Later(f64),
}

/// Decides which part of an arriving window is kept, where the window waits, and which children
/// it may have.
pub trait Policy: Send {
    /// What is handed on from a window to its children beside their geometry.
    type Lineage: Copy;

    /// The counters that this policy keeps, beside those of every algorithm of the family.
    const COUNTERS: &'static [Counter];

    /// Bytes that a waiting window takes.
    const WINDOW_BYTES: usize;

    /// Whether all vertices relay paths, [approximately](super::Relaying).
    const RELAYS: bool = false;

    /// Forgets the last run, keeping the memory.
    fn reset(&mut self);

    /// As [`reset`](Self::reset), after a run whose windows came to no half-edges but
    /// `half_edges`. A policy that is to [explore](super::Explorer) small parts of a mesh takes
    /// time for these only.
    fn reset_at(&mut self, half_edges: impl Iterator<Item = HalfEdgeId>) {
        let _ = half_edges;
        self.reset();
    }

    /// Window `id` on `h`, which has an event in the queue, if it exists and waits.
    fn waiting(&self, h: HalfEdgeId, id: u32) -> Option<&Window> {
        let _ = h;
        self.foresee(id)
    }

    /// The lineage of windows that start from `v`.
    fn root(&self, v: VertexId, surface: &Surface) -> Self::Lineage;

    /// A window arrives at a half-edge. Stores what is worth keeping of it, and calls `queue` with
    /// the half-edge, a label and a number for everything that must wait for its turn. Returns
    /// whether anything of the window is left.
    fn arrive<P: Probe>(
        &mut self,
        arrival: &Arrival<Self::Lineage>,
        surface: &Surface,
        queue: &mut impl FnMut(HalfEdgeId, f64, u32, &mut P),
        probe: &mut P,
    ) -> bool;

    /// The turn of window `id` on `h` has come: what there is to propagate, if anything is now.
    fn take<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        id: u32,
        surface: &Surface,
        probe: &mut P,
    ) -> Turn<Self::Lineage>;

    /// The least distance of window `id` on `h`, which is in the queue under `label`; `None` if it
    /// does not exist any more, and nothing waits. It serves samples of the wavefront only.
    fn least_distance(&self, h: HalfEdgeId, id: u32, label: f64) -> Option<f64> {
        let _ = (h, id);
        Some(label)
    }

    /// Whether windows stay as they are while they wait, all that is asked when one arrives is said
    /// in [`Child`], and both children are [tried](Self::tries). Windows are then crossed before
    /// their turns, several at a time.
    const FORESEES: bool = false;

    /// Window `id`, which waits, if the policy [foresees](Self::FORESEES).
    #[inline]
    fn foresee(&self, id: u32) -> Option<&Window> {
        let _ = id;
        None
    }

    /// As [`take`](Self::take), if the policy [foresees](Self::FORESEES), without the window;
    /// `None` if there is nothing to propagate.
    #[inline]
    fn release<P: Probe>(
        &mut self,
        id: u32,
        surface: &Surface,
        probe: &mut P,
    ) -> Option<Self::Lineage> {
        let _ = (id, surface, probe);
        None
    }

    /// As [`split`](Self::split), if the policy [foresees](Self::FORESEES): the straight path to
    /// the apex, of length `d`, meets the half-edge `angle` at the fraction `entry` of its length,
    /// which is NaN if rounding blurs it.
    #[inline]
    fn split_at(
        &mut self,
        angle: HalfEdgeId,
        entry: f64,
        d: f64,
        heir: Self::Lineage,
    ) -> [Option<Self::Lineage>; 2] {
        let _ = (angle, entry, d);
        [Some(heir); 2]
    }

    /// As [`arrive`](Self::arrive), if the policy [foresees](Self::FORESEES): returns the number by
    /// which the window waits, if anything of it is left.
    #[inline]
    fn admit<P: Probe>(
        &mut self,
        child: &Child<Self::Lineage>,
        surface: &Surface,
        probe: &mut P,
    ) -> Option<u32> {
        let _ = (child, surface, probe);
        None
    }

    /// Window `id` on `h` is likely to be taken soon: asks for the memory where it lies, without
    /// reading any.
    #[inline]
    fn announce(&self, h: HalfEdgeId, id: u32) {
        let _ = (h, id);
    }

    /// Window `id` on `h`, which was announced a few turns ago, is likely to be taken in a few:
    /// reads it, and asks for what else [`take`](Self::take) will need.
    #[inline]
    fn prepare(&self, h: HalfEdgeId, id: u32, surface: &Surface) {
        let _ = (h, id, surface);
    }

    /// Which children of a window on one side of the apex are tried, the left and the right one:
    /// those that must be computed to find out that they are empty. It serves counters only.
    #[inline]
    fn tries(crossing: &Crossing<'_>) -> [bool; 2] {
        let _ = crossing;
        [true; 2]
    }

    /// What the children of a window inherit from it; `None` if it must not have any.
    fn descend(&self, lineage: &Self::Lineage) -> Option<Self::Lineage>;

    /// Whether to try the left and the right child of a window that has come in through `h` and
    /// covers the apex, and what each inherits; `heir` is what they would without a split.
    fn split(
        &mut self,
        h: HalfEdgeId,
        crossing: &Crossing<'_>,
        heir: Self::Lineage,
        surface: &Surface,
    ) -> [Option<Self::Lineage>; 2];

    /// The run has ended: last counts.
    fn finish<P: Probe>(&mut self, probe: &mut P) {
        let _ = probe;
    }
}
