//! A priority queue that sorts events only when they are due.

use geobench_mesh::Mesh;

use super::bucket_sort::{append_in_order, is_before};
use super::{Calendar, Discipline, Event, QuaternaryHeap};
use crate::counters::Counter;
use crate::probe::Probe;

/// Bucket width as a multiple of the [usual one](Calendar::usual_width): a bucket then holds some
/// ten to a hundred events.
const WIDTH: f64 = 1.0;

/// Least number of next events to keep sorted, if so many wait.
const KNOWN: usize = 16;

/// How many sorted events a late one may be moved past.
const REACH: usize = 16;

/// A priority queue with the order of [`HeapQueue`](super::HeapQueue), in less time. No paper of
/// MMP or ICH has it: it is the idea of FWP, buckets by distance, with an exact order.
///
/// Only the next events are sorted: the buckets of a [`Calendar`] are taken and sorted one after
/// the other, a few events ahead. A later event may belong before the end of the sorted ones; every
/// child does whose window touches the vertex where its parent is nearest. Such a *late* event is
/// inserted if its position is near the front, which is the usual case, and else goes to a heap.
/// Events are taken exactly in the order of a heap of all events.
///
/// # Cost
///
/// O(1) for each event if labels are spread, O(log n) if not.
///
/// ```
/// use geobench_mesh::VertexId;
/// use geobench_window::queue::{Discipline, Event, CalendarQueue};
///
/// let [far, near] = [7, 2].map(|v| Event::vertex(VertexId::new(v)));
/// let mut queue = CalendarQueue::with_width(0.5);
/// queue.push(3.0, far, &mut ());
/// queue.push(1.0, near, &mut ());
/// assert_eq!(queue.pop(&mut ()), Some((1.0, near)));
/// ```
#[derive(Clone, Debug)]
pub struct CalendarQueue {
    /// Events of the buckets up to the current one, the next one last.
    sorted: Vec<(f64, Event)>,
    /// Late events: those of the same or lower buckets that were not inserted into `sorted`.
    late: QuaternaryHeap<Event, true>,
    current: u64,
    later: Calendar,
    /// Buffers of [`refill`](Self::refill).
    fresh: Vec<(f64, Event)>,
    drained: Vec<(f64, Event)>,
}

impl CalendarQueue {
    /// An empty queue with a bucket width for `mesh`; O(edges).
    pub fn new(mesh: &Mesh) -> Self {
        Self::with_width(WIDTH * Calendar::usual_width(mesh))
    }

    /// An empty queue with buckets of this width. They should hold some ten events.
    pub fn with_width(width: f64) -> Self {
        Self {
            sorted: Vec::new(),
            late: QuaternaryHeap::default(),
            current: 0,
            later: Calendar::new(width),
            fresh: Vec::new(),
            drained: Vec::new(),
        }
    }

    /// Number of events.
    fn len(&self) -> usize {
        self.sorted.len() + self.late.len() + self.later.len()
    }

    /// Sorts the next buckets, until [`KNOWN`] events are sorted or no bucket is left.
    #[cold]
    fn refill(&mut self) {
        self.fresh.clear();
        while self.fresh.len() + self.sorted.len() < KNOWN
            && let Some(bucket) = self.later.advance()
        {
            self.current = bucket;
            self.drained.clear();
            self.later.drain(bucket, &mut self.drained);
            let place = |label| self.later.place_in(bucket, label);
            append_in_order(&mut self.fresh, &mut self.drained, place);
        }
        self.later.prepare_walk(self.current);
        self.fresh.reverse();
        self.fresh.append(&mut self.sorted);
        std::mem::swap(&mut self.fresh, &mut self.sorted);
    }

    /// Inserts an event into the sorted ones, or pushes it to the heap if its position is far from
    /// the front.
    #[inline]
    fn insert(&mut self, label: f64, event: Event) {
        let behind = self.sorted.len().checked_sub(REACH + 1);
        if behind.is_some_and(|i| is_before(self.sorted[i], (label, event))) {
            self.late.push(label, event);
            return;
        }
        self.sorted.push((label, event));
        let mut place = self.sorted.len() - 1;
        while place > 0 && is_before(self.sorted[place - 1], (label, event)) {
            self.sorted[place] = self.sorted[place - 1];
            place -= 1;
        }
        self.sorted[place] = (label, event);
    }
}

impl Discipline for CalendarQueue {
    const COUNTERS: &'static [Counter] = &[Counter::QueuePushes, Counter::QueuePeak];

    #[inline]
    fn push<P: Probe>(&mut self, label: f64, event: Event, probe: &mut P) {
        let bucket = self.later.bucket(label);
        if bucket <= self.current {
            self.insert(label, event);
        } else {
            self.later.put(bucket, label, event);
        }
        probe.add(Counter::QueuePushes, 1);
        probe.raise(Counter::QueuePeak, self.len() as u64);
    }

    #[inline]
    fn pop<P: Probe>(&mut self, _: &mut P) -> Option<(f64, Event)> {
        if self.sorted.len() < KNOWN && !self.later.is_empty() {
            self.refill();
        }
        self.later.walk();
        if let Some(late) = self.late.peek()
            && self.sorted.last().is_none_or(|&next| is_before(late, next))
        {
            return self.late.pop();
        }
        self.sorted.pop()
    }

    #[inline]
    fn bound(&self, label: f64) -> Option<f64> {
        Some(label)
    }

    #[inline]
    fn is_due(&self, label: f64) -> bool {
        // Without a sorted event, `pop` has found no bucket.
        let next = self.sorted.last();
        next.is_none_or(|&(next, _)| label <= next)
            && self.late.peek().is_none_or(|(late, _)| label <= late)
    }

    #[inline]
    fn upcoming(&self, skipped: usize) -> Option<Event> {
        let place = self.sorted.len().checked_sub(skipped + 1)?;
        Some(self.sorted[place].1)
    }

    #[inline]
    fn coming(&self) -> impl Iterator<Item = Event> {
        self.sorted.iter().rev().map(|&(_, event)| event)
    }

    fn events(&self) -> impl Iterator<Item = (f64, Event)> {
        let near = self.sorted.iter().chain(self.late.iter());
        self.later.events().chain(near.copied())
    }

    fn clear(&mut self) {
        self.sorted.clear();
        self.late.clear();
        self.current = 0;
        self.later.clear();
    }
}

#[cfg(test)]
mod tests {
    use geobench_mesh::HalfEdgeId;
    use proptest::prelude::*;

    use super::super::{HeapQueue, HeapShape};
    use super::*;

    /// The events that leave `queue` in a run of `steps`: 0 takes one, others push a label.
    fn taken(mut queue: impl Discipline, steps: &[(f64, u8)]) -> Vec<Option<(f64, Event)>> {
        let ends = std::iter::repeat_n((0.0, 0), steps.len());
        let mut taken = Vec::new();
        for (id, (label, step)) in (0u32..).zip(steps.iter().copied().chain(ends)) {
            if step == 0 {
                let next = queue.pop(&mut ());
                // Whether an event is due depends on those that wait, not on how they wait.
                let due = next.is_none_or(|(label, _)| queue.is_due(label + 1.0));
                taken.extend([
                    next,
                    due.then_some((0.0, Event::window(HalfEdgeId::new(0), 0))),
                ]);
            } else {
                queue.push(label, Event::window(HalfEdgeId::new(id % 7), id), &mut ());
            }
        }
        assert_eq!(queue.events().count(), 0);
        taken
    }

    proptest! {
        /// Some labels are equal, and some are below those already taken.
        #[test]
        fn the_order_is_that_of_heaps_at_any_width(
            width in prop_oneof![0.01..100.0f64, Just(0.0), Just(f64::INFINITY), Just(1e-9), Just(f64::NAN)],
            steps in prop::collection::vec((prop_oneof![0.0..40.0f64, Just(5.0), Just(20.0)], 0..3u8), 0..300),
        ) {
            let expected = taken(HeapQueue::new(HeapShape::Binary), &steps);
            let labels: Vec<f64> = steps.iter().filter(|(_, step)| *step > 0).map(|s| s.0).collect();
            let mut all: Vec<f64> = expected.iter().step_by(2).flatten().map(|taken| taken.0).collect();
            all.sort_by(f64::total_cmp);
            let mut sorted = labels.clone();
            sorted.sort_by(f64::total_cmp);
            prop_assert_eq!(&all, &sorted);
            prop_assert_eq!(&taken(HeapQueue::new(HeapShape::Quaternary), &steps), &expected);
            prop_assert_eq!(&taken(CalendarQueue::with_width(width), &steps), &expected);
        }
    }
}
