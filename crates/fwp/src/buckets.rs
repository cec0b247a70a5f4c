//! Fast wavefront propagation: buckets of labels, taken in rounds.

use geobench_mesh::Mesh;
use geobench_window::queue::{Calendar, Chain, Discipline, Event};
use geobench_window::{Counter, Probe};

use crate::weights::Weights;

/// Number of next events to keep in order, if so many are left in a round.
const KNOWN: usize = 16;

/// Capacity for these and for some that have been taken.
const ROOM: usize = 256;

/// The least number of events, K, that a round of [`Buckets`] takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BatchSize {
    /// K starts as the number of waiting events. From round to round it grows by the number of
    /// events that arrived beyond the buckets of the round, a sign of a smooth wavefront, and
    /// shrinks by the number of those that arrived in or before them. It never exceeds `max`.
    Adaptive {
        /// The limit, `K_max` in the paper.
        max: u32,
    },
    /// Always this many. The best number differs between models by a factor of forty (Xu et al.
    /// 2015, figure 10).
    Fixed(u32),
}

/// Options of [`Buckets`]. Distances do not depend on them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BucketOptions {
    /// Width of a bucket as a multiple of h/√n, where h is the mean length of the edges and n the
    /// number of vertices. All events share one bucket if it is not positive or not finite.
    pub width: f64,
    /// The number of events of a round; 0 counts as 1.
    pub batch: BatchSize,
}

impl Default for BucketOptions {
    /// The paper's options: width 1, and K adaptive with at most 20,000.
    fn default() -> Self {
        Self {
            width: 1.0,
            batch: BatchSize::Adaptive { max: 20_000 },
        }
    }
}

/// The queue of the fast wavefront propagation framework (Xu et al. 2015, section 4).
///
/// Labels are divided into buckets of equal width, each first in, first out. Events are taken in
/// rounds. A round counts buckets from the first non-empty one, `P1`, until they hold at least K
/// events. `P_end` is the bucket behind the last one counted; as algorithm 1 prints it, its events
/// are taken as well. The round takes the events that were in the buckets `P1` to `P_end` before it
/// began. Events that arrive during the round wait for the next one. Each is *beyond* or *near*,
/// depending on whether its bucket is behind `P_end`. [`BatchSize::Adaptive`] defines how K follows
/// from these counts.
///
/// The paper marks every window with its birth, the round in which it was made. Here a round
/// removes the events from its buckets when it begins, so all events found there later were born in
/// the round. The rule is the same.
///
/// Algorithm 1 never resets the counts of near and beyond. The text does (section 4.2: they are
/// counts of the children of one round), and so does this queue. A label that rounding puts below
/// `P1` counts as in `P1`. The paper does not say what becomes of an event whose window has been
/// trimmed or dropped. Here it stays, counts towards K, and is skipped by the policy; a trimmed
/// window is queued under its new label as well.
///
/// # Cost
///
/// O(1) for each event, 24 bytes for each, and 12 for each bucket from `P1` to the furthest; see
/// [`Calendar`].
///
/// ```
/// use geobench_fwp::{BucketOptions, Buckets};
/// use geobench_ich::Splitting;
/// use geobench_mesh::Mesh;
/// use geobench_window::continuous::Continuous;
/// use geobench_window::{Solver, VertexFilter};
///
/// let mesh = Mesh::generate("terrain,n=8,seed=1")?;
/// let policy = Splitting::new(&mesh, VertexFilter::On);
/// let mut solver = Continuous::new(&mesh, policy, Buckets::new(&mesh, BucketOptions::default()));
/// assert_eq!(solver.distances_from(5)?[5], 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Buckets {
    batch: BatchSize,
    calendar: Calendar,
    round: Round,
    /// Events of the round that are still in the linked list.
    linked: Chain,
    /// The events before them. Those from `next` on have not been taken.
    events: Vec<(f64, Event)>,
    next: usize,
    /// The numbers of windows, if the events are lists.
    weights: Option<Weights>,
}

/// The current round.
#[derive(Clone, Copy, Debug, Default)]
struct Round {
    /// K; 0 before the first round.
    size: i64,
    /// The last bucket whose events are taken, `P_end` in the paper.
    end: u64,
    /// The [place](Calendar::place) at which that bucket ends.
    limit: f64,
    /// Events that arrived in buckets up to `end`.
    near: i64,
    /// Events that arrived beyond `end`.
    beyond: i64,
}

impl Buckets {
    /// An empty queue whose bucket width suits `mesh`; O(edges).
    pub fn new(mesh: &Mesh, options: BucketOptions) -> Self {
        Self {
            batch: options.batch,
            calendar: Calendar::new(options.width * Calendar::usual_width(mesh)),
            round: Round::default(),
            linked: Chain::EMPTY,
            events: Vec::with_capacity(ROOM),
            next: 0,
            weights: None,
        }
    }

    /// The same queue for events that are lists of windows; K is still a number of windows. A round
    /// takes from the lists in its buckets the windows that are due at their turn. A window that
    /// arrives at such a list during the round and belongs in the round does not wait for the next
    /// one, although it counts for it. This makes a fourth more rounds than with single windows.
    #[must_use]
    pub(crate) fn of_lists(self) -> Self {
        Self {
            weights: Some(Weights::default()),
            ..self
        }
    }

    /// Number of events.
    fn len(&self) -> usize {
        self.calendar.len() + self.events.len() - self.next
    }

    /// The bucket of `label`, at least the first.
    #[inline]
    fn bucket(&self, label: f64) -> u64 {
        self.calendar.bucket(label).max(self.calendar.first())
    }

    /// Counts a window or vertex that arrives in `bucket`.
    #[inline]
    fn count_arrival(&mut self, bucket: u64) {
        if bucket > self.round.end {
            self.round.beyond += 1;
        } else {
            self.round.near += 1;
        }
        if let Some(weights) = &mut self.weights {
            weights.add(bucket);
        }
    }

    #[inline]
    fn put<P: Probe>(&mut self, bucket: u64, label: f64, event: Event, probe: &mut P) {
        self.calendar.put(bucket, label, event);
        probe.add(Counter::QueuePushes, 1);
        probe.raise(Counter::QueuePeak, self.len() as u64);
    }

    /// Begins a round when all events of the last one have been taken; `None` if no event is left.
    #[cold]
    fn begin<P: Probe>(&mut self, probe: &mut P) -> Option<()> {
        let first = self.calendar.advance()?;
        if let Some(weights) = &mut self.weights {
            weights.advance(first);
        }
        self.round = Round {
            size: self.next_size(),
            end: first,
            limit: 0.0,
            near: 0,
            beyond: 0,
        };
        self.empty_buckets(first);
        self.round.limit = (self.round.end + 1) as f64;
        self.events.clear();
        self.next = 0;
        for _ in 0..KNOWN {
            self.unlink();
        }
        probe.add(Counter::Iterations, 1);
        probe.raise(Counter::KPeak, self.round.size.unsigned_abs());
        Some(())
    }

    /// The K of the next round.
    fn next_size(&self) -> i64 {
        let waiting = match &self.weights {
            Some(weights) => weights.total(),
            None => self.calendar.len() as u64,
        };
        let waiting = i64::try_from(waiting).unwrap_or(i64::MAX);
        let (wanted, limit) = match self.batch {
            BatchSize::Fixed(size) => (i64::from(size), i64::MAX),
            BatchSize::Adaptive { max } if self.round.size == 0 => (waiting, i64::from(max)),
            BatchSize::Adaptive { max } => {
                let Round {
                    size, near, beyond, ..
                } = self.round;
                (size + beyond - near, i64::from(max))
            }
        };
        wanted.min(limit).min(waiting).max(1)
    }

    /// Removes the events of the buckets from `first` on until they are K, or up to the last bucket
    /// of the ring, and those of the bucket behind.
    fn empty_buckets(&mut self, first: u64) {
        let size = self.round.size.unsigned_abs();
        let mut taken = 0;
        let mut next = Some(first);
        while let Some(bucket) = next {
            self.round.end = bucket + 1;
            taken += self.empty_bucket(bucket);
            next = self.calendar.next_occupied(bucket + 1);
            if taken >= size {
                break;
            }
        }
        if next == Some(self.round.end) {
            self.empty_bucket(self.round.end);
        }
    }

    /// Removes the events of `bucket`; returns the number of windows that they count as.
    fn empty_bucket(&mut self, bucket: u64) -> u64 {
        let before = self.linked.len();
        self.calendar.detach(bucket, &mut self.linked);
        match &mut self.weights {
            Some(weights) => weights.take(bucket),
            None => (self.linked.len() - before) as u64,
        }
    }

    /// Moves one event of the round from the linked list to `events`.
    ///
    /// Each link has to be loaded before the next one is known. One is moved for each event taken,
    /// so that the prefetched memory of the next has time to arrive.
    #[inline]
    fn unlink(&mut self) {
        if let Some(event) = self.calendar.take(&mut self.linked) {
            if self.events.len() == ROOM {
                self.events.drain(..self.next);
                self.next = 0;
            }
            self.events.push(event);
        }
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
        let bucket = self.bucket(label);
        self.count_arrival(bucket);
        self.put(bucket, label, event, probe);
    }

    #[inline]
    fn push_list<P: Probe>(&mut self, label: f64, event: Event, probe: &mut P) {
        self.put(self.bucket(label), label, event, probe);
    }

    #[inline]
    fn weigh(&mut self, label: f64) {
        self.count_arrival(self.bucket(label));
    }

    #[inline]
    fn pop<P: Probe>(&mut self, probe: &mut P) -> Option<(f64, Event)> {
        if self.next == self.events.len() {
            self.begin(probe)?;
        }
        let taken = self.events[self.next];
        self.next += 1;
        self.unlink();
        Some(taken)
    }

    /// The lower end of the round's first bucket. Labels are below it only by rounding.
    #[inline]
    fn bound(&self, _: f64) -> Option<f64> {
        let first = self.calendar.first();
        Some(if first == 0 {
            0.0
        } else {
            first as f64 * self.calendar.width()
        })
    }

    #[inline]
    fn is_due(&self, label: f64) -> bool {
        self.calendar.place(label) < self.round.limit
    }

    #[inline]
    fn upcoming(&self, skipped: usize) -> Option<Event> {
        let upcoming = self.events.get(self.next + skipped);
        upcoming.map(|&(_, event)| event)
    }

    #[inline]
    fn coming(&self) -> impl Iterator<Item = Event> {
        self.events[self.next..].iter().map(|&(_, event)| event)
    }

    fn events(&self) -> impl Iterator<Item = (f64, Event)> {
        let round = self.events[self.next..].iter();
        self.calendar.events().chain(round.copied())
    }

    fn clear(&mut self) {
        self.calendar.clear();
        if let Some(weights) = &mut self.weights {
            weights.clear();
        }
        self.round = Round::default();
        self.linked = Chain::EMPTY;
        self.events.clear();
        self.next = 0;
    }
}

#[cfg(test)]
mod tests;
