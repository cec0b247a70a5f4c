//! What one thread does in a run.

use geobench_window::Probe;

use super::clock::Clock;
use super::handoff::Handoff;
use super::load_estimate::{LIST, LoadEstimate};
use super::placement::Candidate;
use super::schedule_fuzz::schedule_fuzz;
use super::shared::Shared;
use super::thread_view::{ThreadState, ThreadView};
use crate::engine::surface::Surface;
use crate::fast::FastOptions;
use crate::wavefront::{SurfaceState, Wavefront};
use geobench_window::simd::Lanes;

/// Buckets between two times that a thread looks whether it has too much. From 1 to 4 it makes no
/// difference.
const BUCKETS: u32 = 4;

/// A thread's own things, kept from run to run; in cache lines of their own.
#[derive(Debug)]
#[repr(align(128))]
pub(super) struct Worker {
    pub(super) thread: usize,
    wavefront: Wavefront,
    state: ThreadState,
    /// The vertices near the wavefront that it might give away.
    near: Vec<Candidate>,
    /// The handoff that it got last.
    handoff: Handoff,
    estimate: LoadEstimate,
    /// The bucket from which on it looks again whether it has too much.
    looks: u32,
    /// The last bucket whose turn it may take, as far as it has looked. Threads that fall back
    /// since only make this one go further ahead.
    limit: u32,
    clock: Clock,
    /// Windows given to other threads in this run.
    pub(super) given: usize,
}

impl Worker {
    pub(super) fn new(thread: usize, surface: &Surface, options: &FastOptions) -> Self {
        Self {
            thread,
            wavefront: Wavefront::new(surface, options),
            state: ThreadState::new(surface),
            near: Vec::new(),
            handoff: Handoff::default(),
            estimate: LoadEstimate::default(),
            looks: 0,
            limit: 0,
            clock: Clock::start(),
            given: 0,
        }
    }

    /// All that is this thread's in a run from `sources`; windows that flat vertices have parted
    /// become one again if `COALESCE`.
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

    /// The first thread starts with the turns of the sources, the others wait until they are given
    /// something: nobody waits for a thread that takes its time to wake up. Returns whether there
    /// is anything to do.
    fn start<P: Probe>(&mut self, shared: &Shared, sources: &[u32], probe: &mut P) -> bool {
        self.wavefront.reset();
        self.state.reset();
        self.estimate = LoadEstimate::default();
        self.looks = 0;
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

    /// Brings the distances that all threads share in order, as far as this one knows better.
    pub(super) fn repair(&self, shared: &Shared) {
        self.state.repair(&shared.distances);
    }

    /// Whether the turn of a bucket may be taken. The places of the others are looked at only if
    /// they must be, since each look waits for what they have written.
    fn may_take(&mut self, shared: &Shared, bucket: u32) -> bool {
        if bucket > self.limit {
            self.limit = shared.lag.limit();
        }
        bucket <= self.limit
    }

    /// Tells the others how much it has before it.
    fn publish_estimate(&mut self, shared: &Shared) {
        if shared.threads > 1 {
            let store = &self.wavefront.store;
            let (windows, lists) = (store.waiting(), store.lists());
            let expected = self.estimate.note(windows, lists, self.clock.busy());
            shared.estimates.publish(self.thread, expected);
        }
    }

    /// Gives a part of the wavefront to the thread that has least, if this one has too much and the
    /// last time is a while ago: what lies on the side of that thread. The bucket is that of the
    /// next turn.
    fn give(&mut self, shared: &Shared, bucket: u32) {
        if shared.threads == 1 || bucket < self.looks {
            return;
        }
        self.looks = bucket.saturating_add(BUCKETS);
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

    /// Takes in what another thread has given it; returns whether there was anything.
    fn receive<P: Probe>(&mut self, shared: &Shared, probe: &mut P) -> bool {
        let view = &mut ThreadView::new(shared, &mut self.state);
        let (handoff, wavefront) = (&mut self.handoff, &mut self.wavefront);
        let handoffs = &shared.handoffs;
        handoffs.receive(self.thread, &shared.lag, handoff, wavefront, view, probe)
    }

    /// Waits for a handoff, or until `nearest`, the nearest bucket that has a vertex, may have its
    /// turn; returns whether there is anything left to do, and no thread has panicked.
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

    /// Waits for a handoff, with nothing else to do; returns whether there is one.
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
