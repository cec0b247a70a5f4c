//! What one thread does in a run.

use geobench_window::Probe;

use super::clock::Clock;
use super::gift::Gift;
use super::jitter::jitter;
use super::load::{LIST, Load};
use super::part::{Own, Part};
use super::region::Candidate;
use super::shared::Shared;
use crate::engine::surface::Surface;
use crate::fast::Options;
use crate::wave::{Field, Wave};
use geobench_window::simd::Lanes;

/// Buckets between two times that a thread looks whether it has too much. From 1 to 4 it makes no
/// difference.
const BUCKETS: u32 = 4;

/// A thread's own things, kept from run to run; in cache lines of their own.
#[derive(Debug)]
#[repr(align(128))]
pub(super) struct Worker {
    pub(super) thread: usize,
    wave: Wave,
    own: Own,
    /// The vertices near the wavefront that it might give away.
    near: Vec<Candidate>,
    /// The gift that it got last.
    gift: Gift,
    load: Load,
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
    pub(super) fn new(thread: usize, surface: &Surface, options: &Options) -> Self {
        Self {
            thread,
            wave: Wave::new(surface, options),
            own: Own::new(surface),
            near: Vec::new(),
            gift: Gift::default(),
            load: Load::default(),
            looks: 0,
            limit: 0,
            clock: Clock::start(),
            given: 0,
        }
    }

    /// All that is this thread's in a run from `sources`; windows that flat vertices have parted
    /// become one again if `REUNITE`.
    #[inline(always)]
    pub(super) fn run<L: Lanes, P: Probe, const REUNITE: bool>(
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
            let part = &mut Part::new(shared, &mut self.own);
            self.wave
                .cross_all::<L, Part<'_>, P, REUNITE>(simd, part, probe);
            jitter();
            if self.receive(shared, probe) {
                continue;
            }
            let nearest = self.wave.buckets.nearest();
            shared.pace.come_to(self.thread, nearest);
            self.tell_load(shared);
            match nearest {
                _ if shared.pace.is_broken() => break,
                Some(bucket) if self.may_take(shared, bucket) => {
                    self.give(shared, bucket);
                    let part = &mut Part::new(shared, &mut self.own);
                    self.wave.take_turn(part, bucket, probe);
                }
                _ => {
                    if !self.wait(shared, nearest) {
                        break;
                    }
                }
            }
        }
        debug_assert!(
            shared.pace.is_broken() || self.wave.is_empty(),
            "a list waits for a turn that no vertex has"
        );
    }

    /// The first thread starts with the turns of the sources, the others wait until they are given
    /// something: nobody waits for a thread that takes its time to wake up. Returns whether there
    /// is anything to do.
    fn start<P: Probe>(&mut self, shared: &Shared, sources: &[u32], probe: &mut P) -> bool {
        self.wave.reset();
        self.own.reset();
        self.load = Load::default();
        self.looks = 0;
        self.limit = 0;
        self.given = 0;
        self.clock = Clock::start();
        shared.loads.publish(self.thread, 0);
        if self.thread > 0 {
            return self.rest(shared);
        }
        let part = &mut Part::new(shared, &mut self.own);
        for &s in sources {
            part.offer(s, 0.0);
        }
        for &s in sources {
            self.wave.start_from(part, s, probe);
        }
        true
    }

    /// Brings the distances that all threads share in order, as far as this one knows better.
    pub(super) fn repair(&self, shared: &Shared) {
        self.own.repair(&shared.distances);
    }

    /// Whether the turn of a bucket may be taken. The places of the others are looked at only if
    /// they must be, since each look waits for what they have written.
    fn may_take(&mut self, shared: &Shared, bucket: u32) -> bool {
        if bucket > self.limit {
            self.limit = shared.pace.limit();
        }
        bucket <= self.limit
    }

    /// Tells the others how much it has before it.
    fn tell_load(&mut self, shared: &Shared) {
        if shared.threads > 1 {
            let store = &self.wave.store;
            let (windows, lists) = (store.waiting(), store.lists());
            let expected = self.load.note(windows, lists, self.clock.busy());
            shared.loads.publish(self.thread, expected);
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
        shared.regions.come_to(self.thread, self.wave.last_turn());
        let Some((to, share)) = shared.loads.advice(self.thread) else {
            return;
        };
        shared.gifts.send(bucket, to, &shared.pace, |gift| {
            let near = self.wave.buckets.near();
            let regions = &shared.regions;
            let candidates = regions.on_the_side_of(to, near, share, &mut self.near);
            let part = &mut Part::new(shared, &mut self.own);
            let (wanted, mut given) = (share * self.load.weight(), 0);
            for candidate in candidates {
                if given as f64 >= wanted {
                    break;
                }
                jitter();
                given += gift.add(&mut self.wave, part, candidate.vertex, LIST);
            }
            self.given += gift.windows();
            let part = self.load.lose(given);
            shared.loads.moved(self.thread, to, part);
        });
    }

    /// Takes in what another thread has given it; returns whether there was anything.
    fn receive<P: Probe>(&mut self, shared: &Shared, probe: &mut P) -> bool {
        let part = &mut Part::new(shared, &mut self.own);
        let (gift, wave) = (&mut self.gift, &mut self.wave);
        let gifts = &shared.gifts;
        gifts.receive(self.thread, &shared.pace, gift, wave, part, probe)
    }

    /// Waits for a gift, or until `nearest`, the nearest bucket that has a vertex, may have its
    /// turn; returns whether there is anything left to do, and no thread has panicked.
    fn wait(&mut self, shared: &Shared, nearest: Option<u32>) -> bool {
        let Some(bucket) = nearest else {
            shared.pace.end();
            return self.rest(shared);
        };
        let mut patience = shared.pace.patience();
        self.clock.pause(|| {
            while !shared.gifts.has(self.thread) && bucket > shared.pace.limit() {
                if shared.pace.is_broken() {
                    return false;
                }
                jitter();
                patience.wait();
            }
            true
        })
    }

    /// Waits for a gift, with nothing else to do; returns whether there is one.
    fn rest(&mut self, shared: &Shared) -> bool {
        let mut patience = shared.pace.patience();
        self.clock.pause(|| {
            while !shared.gifts.has(self.thread) {
                if shared.pace.is_over() || shared.pace.is_broken() {
                    return false;
                }
                jitter();
                patience.wait();
            }
            shared.pace.begin();
            true
        })
    }
}
