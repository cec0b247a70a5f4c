//! Fast wavefront propagation: buckets of labels, taken in rounds.

use geobench_mesh::Mesh;
use geobench_window::queue::{Calendar, Discipline, Event};
use geobench_window::{Counter, Probe};

/// How many events, K, a round of [`Buckets`] takes at least.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BatchSize {
    /// K starts as the number of events that wait. From round to round it grows by the number of
    /// events that came to lie beyond the buckets of the round, a sign that the wavefront is
    /// smooth, and shrinks by those that fell into or before them; it never exceeds `max`.
    Adaptive {
        /// The limit, `K_max` in the paper.
        max: u32,
    },
    /// Always this many. The paper's figure 10 shows why not: the best number differs by a factor
    /// of forty between models.
    Fixed(u32),
}

/// What can be chosen about [`Buckets`]. Answers do not depend on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BucketOptions {
    /// Width of a bucket as a multiple of h/√n, for h the mean length of the edges and n the number
    /// of vertices. One that is not positive, or not finite, puts all events into one bucket.
    pub width: f64,
    /// Events for each round; 0 counts as 1.
    pub batch: BatchSize,
}

impl Default for BucketOptions {
    /// The paper's: width 1, K adaptive and at most 20,000.
    fn default() -> Self {
        Self {
            width: 1.0,
            batch: BatchSize::Adaptive { max: 20_000 },
        }
    }
}

/// The queue of the fast wavefront propagation framework (Xu et al. 2015, section 4).
///
/// Labels are divided into buckets of equal width, first in first out, and events are taken in
/// rounds. A round chooses the buckets from the first non-empty one, `P1`, to the first, `P_end`, by
/// which they hold at least K events, and takes from each of them what was there before the round;
/// what comes during the round has its *birth* in it and waits for the next. How K follows the
/// wavefront is told at [`BatchSize::Adaptive`].
///
/// Where the paper leaves a choice: `P_end` is the last bucket that is counted, and an event is
/// *beyond* it if its bucket is. A label below `P1`, by rounding, counts as being in it. An event whose
/// window has been trimmed, or dropped, since it was queued stays where it is, counts among the K,
/// and is skipped by the policy; a trimmed window waits under its new label too.
///
/// # Cost
///
/// O(1) for each event, 24 bytes for each and 12 for each bucket from `P1` to the furthest; see
/// [`Calendar`].
#[derive(Clone, Debug)]
pub struct Buckets {
    batch: BatchSize,
    calendar: Calendar,
    round: Round,
}

/// The round under way.
#[derive(Clone, Copy, Debug, Default)]
struct Round {
    /// Counts from 1, and on from 0 after 2³² rounds; 0 before the first one.
    number: u32,
    /// K.
    size: i64,
    /// The bucket that is being emptied, `P2` in the paper.
    current: u64,
    /// The last one to be emptied, `P_end`.
    end: u64,
    /// Events that came into a bucket up to `end`.
    near: i64,
    /// Events that came beyond it.
    beyond: i64,
}

impl Buckets {
    /// Empty buckets whose width suits `mesh`; O(edges).
    pub fn new(mesh: &Mesh, options: BucketOptions) -> Self {
        Self {
            batch: options.batch,
            calendar: Calendar::new(options.width * Calendar::usual_width(mesh)),
            round: Round::default(),
        }
    }

    /// Takes an event of the current bucket that is older than the round.
    #[inline]
    fn take(&mut self) -> Option<(f64, Event)> {
        let bucket = self.round.current;
        // Births are in order in a bucket, and none is later than the round.
        if self.calendar.first_birth(bucket)? == self.round.number {
            return None;
        }
        self.calendar.take(bucket)
    }

    /// Begins a round; returns whether there is anything to take.
    fn begin<P: Probe>(&mut self, probe: &mut P) -> bool {
        let last_round = self.round.number;
        let Some(first) = self.calendar.advance(last_round) else {
            return false;
        };
        self.round = Round {
            number: last_round.wrapping_add(1),
            size: self.next_size(),
            current: first,
            end: first,
            near: 0,
            beyond: 0,
        };
        self.round.end = self.last_bucket(first);
        probe.add(Counter::Iterations, 1);
        probe.raise(Counter::KPeak, self.round.size.unsigned_abs());
        true
    }

    /// K of the round to come.
    fn next_size(&self) -> i64 {
        let waiting = i64::try_from(self.calendar.len()).unwrap_or(i64::MAX);
        let (wanted, limit) = match self.batch {
            BatchSize::Fixed(size) => (i64::from(size), i64::MAX),
            BatchSize::Adaptive { max } if self.round.number == 0 => (waiting, i64::from(max)),
            BatchSize::Adaptive { max } => {
                let Round {
                    size, near, beyond, ..
                } = self.round;
                (size + beyond - near, i64::from(max))
            }
        };
        wanted.min(limit).min(waiting).max(1)
    }

    /// The first bucket by which there are K events from `first` on, or the last one in the ring.
    fn last_bucket(&mut self, first: u64) -> u64 {
        let mut end = first;
        let mut held = i64::from(self.calendar.held(end));
        while held < self.round.size
            && let Some(next) = self.calendar.next_occupied(end + 1)
        {
            end = next;
            held += i64::from(self.calendar.held(end));
        }
        end
    }
}

impl Discipline for Buckets {
    const COUNTERS: &'static [Counter] = &[
        Counter::QueuePushes,
        Counter::QueuePeak,
        Counter::Iterations,
        Counter::KPeak,
    ];

    #[inline]
    fn push<P: Probe>(&mut self, label: f64, event: Event, probe: &mut P) {
        let bucket = self.calendar.bucket(label).max(self.calendar.first());
        if bucket > self.round.end {
            self.round.beyond += 1;
        } else {
            self.round.near += 1;
        }
        self.calendar.put(bucket, label, event, self.round.number);
        probe.add(Counter::QueuePushes, 1);
        probe.raise(Counter::QueuePeak, self.calendar.len() as u64);
    }

    #[inline]
    fn pop<P: Probe>(&mut self, probe: &mut P) -> Option<(f64, Event)> {
        loop {
            if let Some(taken) = self.take() {
                return Some(taken);
            }
            match self.calendar.next_occupied(self.round.current + 1) {
                Some(bucket) if bucket <= self.round.end => self.round.current = bucket,
                _ => {
                    if !self.begin(probe) {
                        return None;
                    }
                }
            }
        }
    }

    #[inline]
    fn upcoming(&self) -> Option<Event> {
        self.calendar.first_event(self.round.current)
    }

    fn window_labels(&self) -> impl Iterator<Item = f64> {
        self.calendar.window_labels()
    }

    fn clear(&mut self) {
        self.calendar.clear();
        self.round = Round::default();
    }
}

#[cfg(test)]
#[path = "buckets_tests.rs"]
mod tests;
