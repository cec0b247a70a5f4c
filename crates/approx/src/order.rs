//! Queues that order vertices.

use geobench_mesh::VertexId;
use geobench_window::queue::{Calendar, Event, EventKind, Heap};

/// A queue of vertices by distance. A vertex is pushed anew when its distance falls.
pub(crate) trait VertexQueue {
    /// Whether vertices come in the order of their distances.
    const IS_SORTED: bool;

    /// Adds a vertex.
    fn push(&mut self, label: f64, v: VertexId);

    /// Takes the next vertex.
    fn pop(&mut self) -> Option<(f64, VertexId)>;

    /// Number of entries.
    fn len(&self) -> usize;

    /// Removes all entries.
    fn clear(&mut self);
}

/// Least distance first.
pub(crate) type Tidy = Heap<VertexId>;

impl VertexQueue for Tidy {
    const IS_SORTED: bool = true;

    #[inline]
    fn push(&mut self, label: f64, v: VertexId) {
        Self::push(self, label, v);
    }

    #[inline]
    fn pop(&mut self) -> Option<(f64, VertexId)> {
        Self::pop(self)
    }

    fn len(&self) -> usize {
        Self::len(self)
    }

    fn clear(&mut self) {
        Self::clear(self);
    }
}

/// Buckets in order; first in, first out within a bucket.
#[derive(Clone, Debug)]
pub(crate) struct Untidy {
    later: Calendar,
    /// The current bucket, the next entry last.
    current: Vec<(f64, Event)>,
    /// A lower bound of the labels in the current bucket.
    least: f64,
}

impl Untidy {
    /// An empty queue with buckets of this width.
    pub(crate) fn new(width: f64) -> Self {
        Self {
            later: Calendar::new(width),
            current: Vec::new(),
            least: 0.0,
        }
    }

    /// A lower bound of all labels, if no label was pushed that is less than the one taken last.
    pub(crate) const fn bound(&self) -> f64 {
        self.least
    }

    /// The next entry, if it is in the current bucket.
    pub(crate) fn next(&self) -> Option<VertexId> {
        match self.current.last()?.1.kind() {
            EventKind::Vertex(v) => Some(v),
            EventKind::Window(..) => None,
        }
    }
}

impl VertexQueue for Untidy {
    const IS_SORTED: bool = false;

    #[inline]
    fn push(&mut self, label: f64, v: VertexId) {
        let bucket = self.later.bucket(label).max(self.later.first());
        self.later.put(bucket, label, Event::vertex(v));
    }

    #[inline]
    fn pop(&mut self) -> Option<(f64, VertexId)> {
        loop {
            if let Some((label, event)) = self.current.pop() {
                match event.kind() {
                    EventKind::Vertex(v) => return Some((label, v)),
                    EventKind::Window(..) => continue,
                }
            }
            let bucket = self.later.advance()?;
            self.later.drain(bucket, &mut self.current);
            self.current.reverse();
            let labels = self.current.iter().map(|(label, _)| *label);
            self.least = labels.fold(f64::INFINITY, f64::min);
        }
    }

    fn len(&self) -> usize {
        self.later.len() + self.current.len()
    }

    fn clear(&mut self) {
        self.later.clear();
        self.current.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_untidy_queue_sorts_buckets_only() {
        let mut queue = Untidy::new(1.0);
        for (label, v) in [(2.5, 0), (0.9, 1), (0.1, 2), (2.1, 3)] {
            queue.push(label, VertexId::new(v));
        }
        assert_eq!(queue.len(), 4);
        let order: Vec<u32> = std::iter::from_fn(|| queue.pop())
            .map(|(_, v)| v.raw())
            .collect();
        assert_eq!(order, [1, 2, 0, 3]);
        // An entry for a bucket that has passed comes next.
        queue.push(0.5, VertexId::new(4));
        queue.push(2.2, VertexId::new(5));
        assert_eq!(queue.bound(), 2.1);
        assert_eq!(queue.pop(), Some((0.5, VertexId::new(4))));
        assert_eq!((queue.bound(), queue.next()), (0.5, Some(VertexId::new(5))));
    }
}
