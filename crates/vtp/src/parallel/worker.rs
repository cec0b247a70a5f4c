//! What one thread does in a run.

use std::mem;
use std::time::{Duration, Instant};

use geobench_window::Probe;

use super::gift::Gift;
use super::jitter::jitter;
use super::load::{LIST, Load};
use super::part::{Own, Part};
use super::shared::Shared;
use crate::engine::lanes::Lanes;
use crate::engine::surface::Surface;
use crate::fast::Options;
use crate::wave::Wave;

/// Buckets between two times that a thread looks whether it has too much. From 1 to 4 it makes no difference.
const BUCKETS: u32 = 4;

/// How long a thread has worked.
#[derive(Debug)]
struct Clock {
    started: Instant,
    waited: Duration,
}

impl Clock {
    fn start() -> Self {
        Self {
            started: Instant::now(),
            waited: Duration::ZERO,
        }
    }

    /// In nanoseconds, without what it has waited.
    fn busy(&self) -> u64 {
        let busy = self.started.elapsed().saturating_sub(self.waited);
        u64::try_from(busy.as_nanos()).unwrap_or(u64::MAX)
    }
}

/// A thread's own things, kept from run to run; in cache lines of their own.
#[derive(Debug)]
#[repr(align(128))]
pub(super) struct Worker {
    pub(super) thread: usize,
    wave: Wave,
    own: Own,
    /// The vertices near the wavefront that it might give away.
    near: Vec<u32>,
    /// The gift that it got last.
    gift: Gift,
    load: Load,
    /// The bucket from which on it looks again whether it has too much.
    looks: u32,
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
            clock: Clock::start(),
            given: 0,
        }
    }

    /// All that is this thread's in a run from `sources`; windows that flat vertices have parted become one again if `REUNITE`.
    ///
    /// # Safety
    ///
    /// The processor must know the instructions of `L`.
    #[allow(unsafe_code)] // For a processor with the instructions of `L`, which only the caller knows.
    #[inline(always)]
    pub(super) unsafe fn run<L: Lanes, P: Probe, const REUNITE: bool>(
        &mut self,
        shared: &Shared,
        sources: &[u32],
        probe: &mut P,
    ) {
        if !self.start(shared, sources, probe) {
            return;
        }
        loop {
            let part = &mut Part::new(shared, &mut self.own);
            // SAFETY: promised by the caller.
            unsafe { self.wave.cross_all::<L, Part<'_>, P, REUNITE>(part, probe) };
            jitter();
            if self.receive(shared, probe) {
                continue;
            }
            let nearest = self.wave.buckets.nearest();
            shared.pace.come_to(self.thread, nearest);
            self.tell_load(shared);
            match nearest {
                _ if shared.pace.is_broken() => break,
                Some(bucket) if shared.pace.allows(bucket) => {
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

    /// The first thread starts with the turns of the sources, the others wait until they are given something: nobody waits for a thread that
    /// takes its time to wake up. Returns whether there is anything to do.
    fn start<P: Probe>(&mut self, shared: &Shared, sources: &[u32], probe: &mut P) -> bool {
        self.wave.reset();
        self.own.reset();
        self.load = Load::default();
        self.looks = 0;
        self.given = 0;
        self.clock = Clock::start();
        shared.loads.publish(self.thread, 0);
        if self.thread > 0 {
            return self.rest(shared);
        }
        for &s in sources {
            shared.distances[s as usize].set(0.0);
        }
        let part = &mut Part::new(shared, &mut self.own);
        for &s in sources {
            self.wave.start_from(part, s, probe);
        }
        true
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

    /// Gives a part of the wavefront to the thread that has least, if this one has too much and the last time is a while ago. The bucket is
    /// that of the next turn.
    ///
    /// Faces and vertices are numbered along a space-filling curve, so that what is given away from the end of the numbers lies
    /// together; from that end where the parts of the other thread are likely to lie, since it gives from the other one.
    fn give(&mut self, shared: &Shared, bucket: u32) {
        if shared.threads == 1 || bucket < self.looks {
            return;
        }
        self.looks = bucket.saturating_add(BUCKETS);
        let Some((to, share)) = shared.loads.advice(self.thread) else {
            return;
        };
        let mut near = mem::take(&mut self.near);
        shared.gifts.send(bucket, to, &shared.pace, |gift| {
            near.clear();
            near.extend(self.wave.buckets.near());
            near.sort_unstable();
            if to < self.thread {
                near.reverse();
            }
            let part = &mut Part::new(shared, &mut self.own);
            let (wanted, mut given) = (share * self.load.weight(), 0);
            // It keeps one at least.
            while (given as f64) < wanted
                && near.len() > 1
                && let Some(v) = near.pop()
            {
                jitter();
                given += gift.add(&mut self.wave, part, v, LIST);
            }
            self.given += gift.windows();
            let part = self.load.lose(given);
            shared.loads.moved(self.thread, to, part);
        });
        self.near = near;
    }

    /// Takes in what another thread has given it; returns whether there was anything.
    fn receive<P: Probe>(&mut self, shared: &Shared, probe: &mut P) -> bool {
        let part = &mut Part::new(shared, &mut self.own);
        let (gift, wave) = (&mut self.gift, &mut self.wave);
        let gifts = &shared.gifts;
        gifts.receive(self.thread, &shared.pace, gift, wave, part, probe)
    }

    /// Waits for a gift, or until `nearest`, the nearest bucket that has a vertex, may have its turn; returns whether there is
    /// anything left to do, and nobody has panicked.
    fn wait(&mut self, shared: &Shared, nearest: Option<u32>) -> bool {
        let Some(bucket) = nearest else {
            shared.pace.end();
            return self.rest(shared);
        };
        let since = Instant::now();
        let mut patience = shared.pace.patience();
        while !shared.gifts.has(self.thread) && !shared.pace.allows(bucket) {
            if shared.pace.is_broken() {
                return false;
            }
            jitter();
            patience.wait();
        }
        self.clock.waited += since.elapsed();
        true
    }

    /// Waits for a gift, with nothing else to do; returns whether there is one.
    fn rest(&mut self, shared: &Shared) -> bool {
        let since = Instant::now();
        let mut patience = shared.pace.patience();
        while !shared.gifts.has(self.thread) {
            if shared.pace.is_over() || shared.pace.is_broken() {
                return false;
            }
            jitter();
            patience.wait();
        }
        shared.pace.begin();
        self.clock.waited += since.elapsed();
        true
    }
}
