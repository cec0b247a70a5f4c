//! Least label first.

use super::{Discipline, Event, MinHeap};
use crate::counters::Counter;
use crate::probe::Probe;

/// A priority queue, which makes an algorithm a continuous Dijkstra.
#[derive(Clone, Debug, Default)]
pub struct Priority {
    heap: MinHeap<Event>,
}

impl Discipline for Priority {
    const COUNTERS: &'static [Counter] = &[Counter::QueuePushes, Counter::QueuePeak];

    #[inline]
    fn push<P: Probe>(&mut self, label: f64, event: Event, probe: &mut P) {
        self.heap.push(label, event);
        probe.add(Counter::QueuePushes, 1);
        probe.raise(Counter::QueuePeak, self.heap.len() as u64);
    }

    #[inline]
    fn pop<P: Probe>(&mut self, _: &mut P) -> Option<(f64, Event)> {
        self.heap.pop()
    }

    fn window_labels(&self) -> impl Iterator<Item = f64> {
        self.heap
            .iter()
            .filter(|(_, event)| event.is_window())
            .map(|&(label, _)| label)
    }

    fn clear(&mut self) {
        self.heap.clear();
    }
}
