//! What all threads see of a run.

use std::ops::Range;
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering::Relaxed;

use super::gift::Gifts;
use super::load::Loads;
use super::pace::Pace;
use super::region::Regions;
use crate::engine::surface::Surface;
use crate::fast::Options;

/// The state of a run that threads share.
///
/// Distances are atomic, but in no order of their own, and whoever finds a shorter path than the
/// one that it sees writes its length without regard for what others write meanwhile. So a distance
/// that a thread sees may be too long, which prunes less. Whoever writes one keeps it for itself
/// too, or hands it over with a gift, and brings it in at the end
/// ([`Own::repair`](super::part::Own::repair)).
#[derive(Debug)]
pub(super) struct Shared {
    pub(super) surface: Surface,
    /// Whether windows parted by flat vertices become one again.
    pub(super) reunites: bool,
    pub(super) threads: usize,
    pub(super) distances: Vec<Distance>,
    pub(super) loads: Loads,
    pub(super) gifts: Gifts,
    pub(super) pace: Pace,
    pub(super) regions: Regions,
}

impl Shared {
    pub(super) fn new(
        surface: Surface,
        options: &Options,
        threads: usize,
        regions: Regions,
    ) -> Self {
        let vertices = surface.vertices.len();
        Self {
            reunites: options.reunite && surface.has_many_flat_vertices(),
            threads,
            distances: (0..vertices).map(|_| Distance::unknown()).collect(),
            loads: Loads::new(threads),
            gifts: Gifts::new(threads),
            pace: Pace::new(threads),
            regions,
            surface,
        }
    }

    /// Forgets what a run has left behind that was broken off.
    pub(super) fn recover(&mut self) {
        self.gifts = Gifts::new(self.threads);
    }

    /// Starts another run, in which so many threads take part. Nothing may be on its way, as after
    /// a run or when it has [recovered](Self::recover).
    pub(super) fn start(&mut self, threads: usize) {
        self.distances.fill_with(Distance::unknown);
        self.regions.reset();
        self.loads.reset();
        self.pace.reset(threads);
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
