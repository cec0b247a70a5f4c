//! Approximation: vertices replace windows, within a bound of the error.

use geobench_mesh::{HalfEdgeId, Mesh, Splice, VertexId};

use super::policy::{Arrival, Child, Dequeued, Policy};
use super::surface::Surface;
use crate::counters::Counter;
use crate::crossing::Crossing;
use crate::probe::Probe;
use crate::window::Window;

/// A policy under which every vertex relays paths and is preferred to the windows that passed it.
/// Distances are approximate, and fewer windows are needed.
///
/// [`Continuous::with_error`](super::Continuous::with_error) defines the preference and proves the
/// bound of the error. The wrapped policy compares windows as it does without relaying.
#[derive(Clone, Debug)]
pub struct Relaying<W>(pub W);

impl<W: Policy> Policy for Relaying<W> {
    type Lineage = W::Lineage;

    const COUNTERS: &'static [Counter] = W::COUNTERS;
    const WINDOW_BYTES: usize = W::WINDOW_BYTES;
    const FORESEES: bool = W::FORESEES;
    const RELAYS: bool = true;
    const SPLICES: bool = W::SPLICES;

    fn splice(&mut self, mesh: &Mesh, splice: &Splice, surface: &Surface) {
        self.0.splice(mesh, splice, surface);
    }

    fn reset(&mut self) {
        self.0.reset();
    }

    fn reset_at(&mut self, half_edges: impl Iterator<Item = HalfEdgeId>) {
        self.0.reset_at(half_edges);
    }

    fn waiting(&self, h: HalfEdgeId, id: u32, surface: &Surface) -> Option<Window> {
        self.0.waiting(h, id, surface)
    }

    fn root(&self, v: VertexId, surface: &Surface) -> Self::Lineage {
        self.0.root(v, surface)
    }

    #[inline]
    fn arrive<P: Probe>(
        &mut self,
        arrival: &Arrival<Self::Lineage>,
        surface: &Surface,
        queue: &mut impl FnMut(HalfEdgeId, f64, u32, &mut P),
        probe: &mut P,
    ) -> bool {
        self.0.arrive(arrival, surface, queue, probe)
    }

    #[inline]
    fn take<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        id: u32,
        surface: &Surface,
        probe: &mut P,
    ) -> Dequeued<Self::Lineage> {
        self.0.take(h, id, surface, probe)
    }

    #[inline]
    fn foresee(&self, id: u32) -> Option<&Window> {
        self.0.foresee(id)
    }

    #[inline]
    fn release<P: Probe>(
        &mut self,
        h: HalfEdgeId,
        id: u32,
        surface: &Surface,
        probe: &mut P,
    ) -> Option<Self::Lineage> {
        self.0.release(h, id, surface, probe)
    }

    #[inline]
    fn split_at(
        &mut self,
        angle: HalfEdgeId,
        entry: f64,
        d: f64,
        inherited: Self::Lineage,
    ) -> [Option<Self::Lineage>; 2] {
        self.0.split_at(angle, entry, d, inherited)
    }

    #[inline]
    fn admit<P: Probe>(
        &mut self,
        child: &Child<Self::Lineage>,
        surface: &Surface,
        queue: &mut impl FnMut(HalfEdgeId, f64, u32, &mut P),
        probe: &mut P,
    ) -> bool {
        self.0.admit(child, surface, queue, probe)
    }

    #[inline]
    fn announce(&self, h: HalfEdgeId, id: u32) {
        self.0.announce(h, id);
    }

    #[inline]
    fn prepare(&self, h: HalfEdgeId, id: u32, surface: &Surface) {
        self.0.prepare(h, id, surface);
    }

    #[inline]
    fn tries(crossing: &Crossing<'_>) -> [bool; 2] {
        W::tries(crossing)
    }

    #[inline]
    fn descend(&self, lineage: &Self::Lineage) -> Option<Self::Lineage> {
        self.0.descend(lineage)
    }

    #[inline]
    fn split(
        &mut self,
        h: HalfEdgeId,
        crossing: &Crossing<'_>,
        inherited: Self::Lineage,
        surface: &Surface,
    ) -> [Option<Self::Lineage>; 2] {
        self.0.split(h, crossing, inherited, surface)
    }

    fn finish<P: Probe>(&mut self, probe: &mut P) {
        self.0.finish(probe);
    }
}
