//! Least label first.

use geobench_mesh::Mesh;

use super::{Calendar, Discipline, Event, MinHeap};
use crate::counters::Counter;
use crate::probe::Probe;

/// Width of a bucket, as a multiple of the [usual one](Calendar::usual_width): the heap then holds
/// some ten to a hundred events.
const WIDTH: f64 = 1.0;

/// A priority queue, which makes an algorithm a continuous Dijkstra.
///
/// Only the events that are next to come are kept in order: those of the current bucket stand in a
/// heap small enough for the nearest cache, and the others wait in their buckets unsorted. Events
/// come in exactly the order of one heap for all of them, up to those of equal labels, which come
/// in an order that depends on the insertions alone.
///
/// # Cost
///
/// O(log k) for each event, for k in its bucket; O(log n) where labels do not spread.
#[derive(Clone, Debug)]
pub struct Priority {
    /// Events of the current bucket and of lower ones.
    near: MinHeap<Event>,
    current: u64,
    later: Calendar,
}

impl Priority {
    /// An empty queue whose buckets suit `mesh`; O(edges).
    pub fn new(mesh: &Mesh) -> Self {
        Self::with_width(WIDTH * Calendar::usual_width(mesh))
    }

    fn with_width(width: f64) -> Self {
        Self {
            near: MinHeap::default(),
            current: 0,
            later: Calendar::new(width),
        }
    }

    /// Makes the next bucket that is not empty the current one.
    fn turn<P: Probe>(&mut self, _: &mut P) -> Option<()> {
        self.current = self.later.advance(0)?;
        let near = &mut self.near;
        self.later
            .drain(self.current, |label, event| near.push(label, event));
        Some(())
    }
}

impl Discipline for Priority {
    const COUNTERS: &'static [Counter] = &[Counter::QueuePushes, Counter::QueuePeak];

    #[inline]
    fn push<P: Probe>(&mut self, label: f64, event: Event, probe: &mut P) {
        let bucket = self.later.bucket(label);
        if bucket <= self.current {
            self.near.push(label, event);
        } else {
            self.later.put(bucket, label, event, 0);
        }
        probe.add(Counter::QueuePushes, 1);
        probe.raise(
            Counter::QueuePeak,
            (self.near.len() + self.later.len()) as u64,
        );
    }

    #[inline]
    fn pop<P: Probe>(&mut self, probe: &mut P) -> Option<(f64, Event)> {
        if self.near.is_empty() {
            self.turn(probe)?;
        }
        self.near.pop()
    }

    #[inline]
    fn upcoming(&self) -> Option<Event> {
        self.near.peek().map(|(_, event)| event)
    }

    fn window_labels(&self) -> impl Iterator<Item = f64> {
        let near = self.near.iter().filter(|(_, event)| event.is_window());
        self.later
            .window_labels()
            .chain(near.map(|&(label, _)| label))
    }

    fn clear(&mut self) {
        self.near.clear();
        self.current = 0;
        self.later.clear();
    }
}

#[cfg(test)]
mod tests {
    use geobench_mesh::HalfEdgeId;
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Against a sorted list, with labels that come below those already taken as well.
        #[test]
        fn the_least_label_comes_first_at_any_width(
            width in prop_oneof![0.01..100.0f64, Just(0.0), Just(f64::INFINITY), Just(1e-9), Just(f64::NAN)],
            steps in prop::collection::vec((0.0..40.0f64, 0..3u8), 0..300),
        ) {
            let mut queue = Priority::with_width(width);
            let mut waiting: Vec<f64> = Vec::new();
            let ends = std::iter::repeat_n((0.0, 0), steps.len());
            for (id, (label, step)) in (0u32..).zip(steps.iter().copied().chain(ends)) {
                if step > 0 {
                    queue.push(label, Event::window(HalfEdgeId::new(0), id), &mut ());
                    waiting.push(label);
                    waiting.sort_by(|a, b| b.total_cmp(a));
                } else {
                    prop_assert_eq!(queue.pop(&mut ()).map(|(label, _)| label), waiting.pop());
                }
                let mut labels: Vec<f64> = queue.window_labels().collect();
                labels.sort_by(|a, b| b.total_cmp(a));
                prop_assert_eq!(&labels, &waiting);
            }
        }
    }
}
