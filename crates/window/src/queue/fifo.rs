//! The first-in, first-out queue.

use std::collections::VecDeque;

use super::{Discipline, Event};
use crate::counters::Counter;
use crate::probe::Probe;

/// Takes events in the order of arrival, whatever their labels: breadth first in the sequence tree
/// of Chen and Han.
///
/// ```
/// use geobench_mesh::VertexId;
/// use geobench_window::queue::{Discipline, Event, Fifo};
///
/// let [first, second] = [7, 2].map(|v| Event::vertex(VertexId::new(v)));
/// let mut queue = Fifo::default();
/// queue.push(3.0, first, &mut ());
/// queue.push(1.0, second, &mut ());
/// assert_eq!(queue.pop(&mut ()), Some((3.0, first)));
/// ```
#[derive(Clone, Debug, Default)]
pub struct Fifo {
    events: VecDeque<(f64, Event)>,
}

impl Discipline for Fifo {
    const COUNTERS: &'static [Counter] = &[Counter::QueuePushes, Counter::QueuePeak];

    #[inline]
    fn push<P: Probe>(&mut self, label: f64, event: Event, probe: &mut P) {
        self.events.push_back((label, event));
        probe.add(Counter::QueuePushes, 1);
        probe.raise(Counter::QueuePeak, self.events.len() as u64);
    }

    #[inline]
    fn pop<P: Probe>(&mut self, _: &mut P) -> Option<(f64, Event)> {
        self.events.pop_front()
    }

    #[inline]
    fn upcoming(&self, skipped: usize) -> Option<Event> {
        self.events.get(skipped).map(|&(_, event)| event)
    }

    fn events(&self) -> impl Iterator<Item = (f64, Event)> {
        self.events.iter().copied()
    }

    fn clear(&mut self) {
        self.events.clear();
    }
}

#[cfg(test)]
mod tests {
    use geobench_mesh::VertexId;

    use super::*;

    #[test]
    fn order_of_arrival() {
        let [a, b] = [7, 2].map(|v| Event::vertex(VertexId::new(v)));
        let mut fifo = Fifo::default();
        fifo.push(3.0, a, &mut ());
        fifo.push(1.0, b, &mut ());
        assert_eq!(fifo.pop(&mut ()), Some((3.0, a)));
        assert_eq!(fifo.pop(&mut ()), Some((1.0, b)));
        assert_eq!(fifo.pop(&mut ()), None);
    }
}
