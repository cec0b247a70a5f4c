//! What happens to windows.

use geobench_mesh::{HalfEdgeId, VertexId};

use super::surface::{Side, Surface};
use crate::counters::Counter;
use crate::probe::Probe;
use crate::window::Window;

/// A window about to leave the triangle that it crosses.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    /// The half-edge through which the window came in.
    pub h: HalfEdgeId,
    /// The window.
    pub window: Window,
    /// Where the ray to the apex meets the half-edge; the window covers the apex if this lies
    /// inside its interval.
    pub separation: f64,
    /// Length of the window's path to the apex, bent if it does not see it.
    pub apex_distance: f64,
}

impl Crossing {
    /// Whether the window sees the apex and has rays on both sides of it.
    #[inline]
    pub fn covers_apex(&self) -> bool {
        self.window.b0 < self.separation && self.separation < self.window.b1
    }
}

/// A window that has reached a half-edge.
#[derive(Clone, Copy, Debug)]
pub struct Arrival<L> {
    /// The half-edge, in whose frame the window is.
    pub h: HalfEdgeId,
    /// The window.
    pub window: Window,
    /// What it inherited.
    pub lineage: L,
    /// Which child of a crossing it is; `None` if it comes from a (pseudo-)source.
    pub side: Option<Side>,
}

/// Decides what is kept of a window that arrives, where it waits, and what it may have for
/// children.
pub trait Policy: Send {
    /// What is handed on from a window to its children beside their geometry.
    type Lineage: Copy;

    /// The counters that this policy keeps, beside those of every algorithm of the family.
    const COUNTERS: &'static [Counter];

    /// Bytes that a waiting window takes.
    const WINDOW_BYTES: usize;

    /// Forgets the last run, keeping the memory.
    fn reset(&mut self);

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

    /// The turn of window `id` on `h` has come: what there is to propagate, if anything still is.
    fn take<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        id: u32,
        surface: &Surface,
        probe: &mut P,
    ) -> Option<(Window, Self::Lineage)>;

    /// Whether to try the left and the right child of a window, and what each inherits.
    fn split(
        &mut self,
        crossing: &Crossing,
        lineage: &Self::Lineage,
        surface: &Surface,
    ) -> [Option<Self::Lineage>; 2];

    /// The run has ended: last counts.
    fn finish<P: Probe>(&mut self, probe: &mut P) {
        let _ = probe;
    }
}
