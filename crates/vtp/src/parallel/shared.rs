//! The state that the threads of a run share.

use std::ops::Range;
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering::Relaxed;

use super::handoff::Handoffs;
use super::lag_limit::LagLimit;
use super::load_estimate::LoadEstimates;
use super::placement::Placement;
use crate::engine::layout::MeshLayout;
use crate::fast::FastOptions;

/// The state of a run that all threads share.
///
/// Distances are atomic with relaxed order. A thread that finds a shorter path than it sees stores
/// its length without an atomic minimum. A distance that a thread sees may therefore be too long,
/// which deletes fewer windows. The thread that wrote the shorter distance keeps a copy, or passes
/// it on with a handoff, and repairs the shared distances at the end
/// ([`ThreadState::repair`](super::thread_view::ThreadState::repair)).
#[derive(Debug)]
pub(super) struct Shared {
    pub(super) layout: MeshLayout,
    /// Whether windows are coalesced behind flat vertices.
    pub(super) coalesces: bool,
    pub(super) threads: usize,
    pub(super) distances: Vec<AtomicDistance>,
    pub(super) estimates: LoadEstimates,
    pub(super) handoffs: Handoffs,
    pub(super) lag: LagLimit,
    pub(super) placement: Placement,
}

impl Shared {
    pub(super) fn new(
        layout: MeshLayout,
        options: &FastOptions,
        threads: usize,
        placement: Placement,
    ) -> Self {
        let vertices = layout.vertices.len();
        Self {
            coalesces: options.coalesce && layout.has_many_flat_vertices(),
            threads,
            distances: (0..vertices).map(|_| AtomicDistance::unknown()).collect(),
            estimates: LoadEstimates::new(threads),
            handoffs: Handoffs::new(threads),
            lag: LagLimit::new(threads),
            placement,
            layout,
        }
    }

    /// Follows a change of the layout.
    pub(super) fn splice(&mut self) {
        let vertices = self.layout.vertices.len();
        self.distances
            .resize_with(vertices, AtomicDistance::unknown);
        self.placement.splice(&self.layout);
    }

    /// Removes the handoffs of a run that has panicked.
    pub(super) fn recover(&mut self) {
        self.handoffs = Handoffs::new(self.threads);
    }

    /// Prepares a run with this number of threads. No handoff may be in transit; none is after a
    /// complete run or [`recover`](Self::recover).
    pub(super) fn start(&mut self, threads: usize) {
        self.distances.fill_with(AtomicDistance::unknown);
        self.placement.reset();
        self.estimates.reset();
        self.lag.reset(threads);
    }

    /// The share of `thread` of `count` elements.
    pub(super) fn share(&self, thread: usize, count: usize) -> Range<usize> {
        let size = count.div_ceil(self.threads);
        let start = (thread * size).min(count);
        start..(start + size).min(count)
    }
}

/// A non-negative distance that all threads can read and write.
#[derive(Debug)]
pub(super) struct AtomicDistance(AtomicU64);

impl AtomicDistance {
    pub(super) fn unknown() -> Self {
        Self(AtomicU64::new(f64::INFINITY.to_bits()))
    }

    #[inline(always)]
    pub(super) fn get(&self) -> f64 {
        f64::from_bits(self.0.load(Relaxed))
    }

    #[inline(always)]
    pub(super) fn set(&self, value: f64) {
        self.0.store(value.to_bits(), Relaxed);
    }

    /// Stores `value` if it is less, as an atomic minimum.
    pub(super) fn lower(&self, value: f64) {
        // The bits of non-negative numbers have the same order.
        self.0.fetch_min(value.to_bits(), Relaxed);
    }
}
