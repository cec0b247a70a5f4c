//! What all threads see of a run.

use std::ops::Range;
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering::Relaxed;

use super::handoff::Handoffs;
use super::lag_limit::LagLimit;
use super::load_estimate::LoadEstimates;
use super::placement::Placement;
use crate::engine::surface::Surface;
use crate::fast::FastOptions;

/// The state of a run that threads share.
///
/// Distances are atomic, but in no order of their own, and whoever finds a shorter path than the
/// one that it sees writes its length without regard for what others write meanwhile. So a distance
/// that a thread sees may be too long, which prunes less. Whoever writes one keeps it for itself
/// too, or hands it over with a handoff, and brings it in at the end
/// ([`ThreadState::repair`](super::part::ThreadState::repair)).
#[derive(Debug)]
pub(super) struct Shared {
    pub(super) surface: Surface,
    /// Whether windows parted by flat vertices become one again.
    pub(super) coalesces: bool,
    pub(super) threads: usize,
    pub(super) distances: Vec<Distance>,
    pub(super) estimates: LoadEstimates,
    pub(super) handoffs: Handoffs,
    pub(super) lag: LagLimit,
    pub(super) placement: Placement,
}

impl Shared {
    pub(super) fn new(
        surface: Surface,
        options: &FastOptions,
        threads: usize,
        placement: Placement,
    ) -> Self {
        let vertices = surface.vertices.len();
        Self {
            coalesces: options.coalesce && surface.has_many_flat_vertices(),
            threads,
            distances: (0..vertices).map(|_| Distance::unknown()).collect(),
            estimates: LoadEstimates::new(threads),
            handoffs: Handoffs::new(threads),
            lag: LagLimit::new(threads),
            placement,
            surface,
        }
    }

    /// Forgets what a run has left behind that was broken off.
    pub(super) fn recover(&mut self) {
        self.handoffs = Handoffs::new(self.threads);
    }

    /// Starts another run, in which so many threads take part. Nothing may be on its way, as after
    /// a run or when it has [recovered](Self::recover).
    pub(super) fn start(&mut self, threads: usize) {
        self.distances.fill_with(Distance::unknown);
        self.placement.reset();
        self.estimates.reset();
        self.lag.reset(threads);
    }

    /// The share of `thread` in `count` things.
    pub(super) fn share(&self, thread: usize, count: usize) -> Range<usize> {
        let size = count.div_ceil(self.threads);
        let start = (thread * size).min(count);
        start..(start + size).min(count)
    }
}

/// A distance that threads can see, not negative.
#[derive(Debug)]
pub(super) struct Distance(AtomicU64);

impl Distance {
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

    /// Takes a lesser value, whatever other threads do.
    pub(super) fn lower(&self, value: f64) {
        // The bits of such numbers are in the same order.
        self.0.fetch_min(value.to_bits(), Relaxed);
    }
}
