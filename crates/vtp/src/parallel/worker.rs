//! The work of one thread in a run.

use geobench_window::Probe;

use super::clock::Clock;
use super::handoff::Handoff;
use super::load_estimate::{LIST, LoadEstimate};
use super::placement::Candidate;
use super::schedule_fuzz::schedule_fuzz;
use super::shared::Shared;
use super::thread_view::{ThreadState, ThreadView};
use crate::engine::layout::MeshLayout;
use crate::fast::FastOptions;
use crate::wavefront::{SurfaceState, Wavefront};
use geobench_window::simd::Lanes;

/// Buckets between two checks of a thread's load. Values from 1 to 4 make no difference.
const BUCKETS: u32 = 4;

/// The state of a thread, in cache lines of its own, reused from run to run.
#[derive(Debug)]
#[repr(align(128))]
pub(super) struct Worker {
    pub(super) thread: usize,
    wavefront: Wavefront,
    state: ThreadState,
    /// The vertices near the wavefront that may be handed off.
    near: Vec<Candidate>,
    /// The handoff received last.
    handoff: Handoff,
    estimate: LoadEstimate,
    /// The bucket of the next check of the load.
    next_check: u32,
    /// The last bucket that may be processed, as read last. Threads that have moved back since only
    /// let this one run further ahead.
    limit: u32,
    clock: Clock,
    /// Number of windows handed off in this run.
    pub(super) given: usize,
}

impl Worker {
    pub(super) fn new(thread: usize, layout: &MeshLayout, options: &FastOptions) -> Self {
        Self {
            thread,
            wavefront: Wavefront::new(layout, options),
            state: ThreadState::new(layout),
            near: Vec::new(),
            handoff: Handoff::default(),
            estimate: LoadEstimate::default(),
            next_check: 0,
            limit: 0,
            clock: Clock::start(),
            given: 0,
        }
    }

    /// Follows a change of the layout.
    pub(super) fn splice(&mut self, layout: &MeshLayout) {
        self.wavefront.splice(layout);
        self.state.splice(layout);
    }

    /// Runs this thread's part of a run from `sources`. Coalesces windows if `COALESCE`.
    #[inline(always)]
    pub(super) fn run<L: Lanes, P: Probe, const COALESCE: bool>(
        &mut self,
        simd: L::Token,
        shared: &Shared,
        sources: &[u32],
        probe: &mut P,
    ) {
        if !self.start(shared, sources, probe) {
            return;
        }
        loop {
            let view = &mut ThreadView::new(shared, &mut self.state);
            self.wavefront
                .cross_all::<L, ThreadView<'_>, P, COALESCE>(simd, view, probe);
            schedule_fuzz();
            if self.receive(shared, probe) {
                continue;
            }
            let nearest = self.wavefront.buckets.nearest();
            shared.lag.come_to(self.thread, nearest);
            self.publish_estimate(shared);
            match nearest {
                _ if shared.lag.is_broken() => break,
                Some(bucket) if self.may_take(shared, bucket) => {
                    self.give(shared, bucket);
                    let view = &mut ThreadView::new(shared, &mut self.state);
                    self.wavefront.take_turn(view, bucket, probe);
                }
                _ => {
                    if !self.wait(shared, nearest) {
                        break;
                    }
                }
            }
        }
        debug_assert!(
            shared.lag.is_broken() || self.wavefront.is_empty(),
            "a list waits for a turn that no vertex has"
        );
    }

    /// Starts the thread; returns whether it has work. The first thread processes the sources. The
    /// others wait for a handoff, so that no thread waits for one that starts late.
    fn start<P: Probe>(&mut self, shared: &Shared, sources: &[u32], probe: &mut P) -> bool {
        self.wavefront.reset();
        self.state.reset();
        self.estimate = LoadEstimate::default();
        self.next_check = 0;
        self.limit = 0;
        self.given = 0;
        self.clock = Clock::start();
        shared.estimates.publish(self.thread, 0);
        if self.thread > 0 {
            return self.rest(shared);
        }
        let view = &mut ThreadView::new(shared, &mut self.state);
        for &s in sources {
            view.offer(s, 0.0);
        }
        for &s in sources {
            self.wavefront.start_from(view, s, probe);
        }
        true
    }

    /// Repairs the shared distances where this thread has found shorter paths.
    pub(super) fn repair(&self, shared: &Shared) {
        self.state.repair(&shared.distances);
    }

    /// Whether a bucket may be processed. Reads the buckets of the other threads only if needed,
    /// because each read may miss the cache.
    fn may_take(&mut self, shared: &Shared, bucket: u32) -> bool {
        if bucket > self.limit {
            self.limit = shared.lag.limit();
        }
        bucket <= self.limit
    }

    /// Publishes the estimate of this thread's load.
    fn publish_estimate(&mut self, shared: &Shared) {
        if shared.threads > 1 {
            let store = &self.wavefront.store;
            let (windows, lists) = (store.waiting(), store.lists());
            let expected = self.estimate.note(windows, lists, self.clock.busy());
            shared.estimates.publish(self.thread, expected);
        }
    }

    /// Hands off vertices to the thread with the least load, if this one has too much and the last
    /// check was some buckets ago. `bucket` is the next to be processed.
    ///
    /// A surface with a needle stays with one thread: windows that wind around the needle are
    /// trimmed only by the windows that their own thread keeps, and without the straight ones of
    /// another thread they take thousands of times as many crossings.
    fn give(&mut self, shared: &Shared, bucket: u32) {
        if shared.threads == 1 || bucket < self.next_check || self.wavefront.kept.has_tip() {
            return;
        }
        self.next_check = bucket.saturating_add(BUCKETS);
        shared
            .placement
            .come_to(self.thread, self.wavefront.last_turn());
        let Some((to, share)) = shared.estimates.advice(self.thread) else {
            return;
        };
        shared.handoffs.send(bucket, to, &shared.lag, |handoff| {
            let near = self.wavefront.buckets.near();
            let placement = &shared.placement;
            let candidates = placement.on_the_side_of(to, near, share, &mut self.near);
            let view = &mut ThreadView::new(shared, &mut self.state);
            let (wanted, mut given) = (share * self.estimate.weight(), 0);
            for candidate in candidates {
                if given as f64 >= wanted {
                    break;
                }
                schedule_fuzz();
                given += handoff.add(&mut self.wavefront, view, candidate.vertex, LIST);
            }
            self.given += handoff.windows();
            let moved = self.estimate.lose(given);
            shared.estimates.moved(self.thread, to, moved);
        });
    }

    /// Unpacks a handoff to this thread; returns whether there was one.
    fn receive<P: Probe>(&mut self, shared: &Shared, probe: &mut P) -> bool {
        let view = &mut ThreadView::new(shared, &mut self.state);
        let (handoff, wavefront) = (&mut self.handoff, &mut self.wavefront);
        let handoffs = &shared.handoffs;
        handoffs.receive(self.thread, &shared.lag, handoff, wavefront, view, probe)
    }

    /// Waits for a handoff, or until `nearest`, the nearest bucket with a vertex, may be processed.
    /// Returns whether work is left and no thread has panicked.
    fn wait(&mut self, shared: &Shared, nearest: Option<u32>) -> bool {
        let Some(bucket) = nearest else {
            shared.lag.end();
            return self.rest(shared);
        };
        let mut backoff = shared.lag.backoff();
        self.clock.pause(|| {
            while !shared.handoffs.has(self.thread) && bucket > shared.lag.limit() {
                if shared.lag.is_broken() {
                    return false;
                }
                schedule_fuzz();
                backoff.wait();
            }
            true
        })
    }

    /// Waits for a handoff without other work; returns whether one has arrived.
    fn rest(&mut self, shared: &Shared) -> bool {
        let mut backoff = shared.lag.backoff();
        self.clock.pause(|| {
            while !shared.handoffs.has(self.thread) {
                if shared.lag.is_over() || shared.lag.is_broken() {
                    return false;
                }
                schedule_fuzz();
                backoff.wait();
            }
            shared.lag.begin();
            true
        })
    }
}
