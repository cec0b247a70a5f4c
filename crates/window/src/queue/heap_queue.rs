//! Priority queues in heaps, with an order that their shape does not affect.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::{Discipline, Event, QuaternaryHeap};
use crate::counters::Counter;
use crate::probe::Probe;

/// The shape of a [`Heap`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HeapShape {
    /// The binary heap of the standard library.
    #[default]
    Binary,
    /// A 4-ary heap, which is half as deep and takes less time.
    Quaternary,
}

/// A priority queue of labelled items. The least label comes first, and of equal labels the least
/// item, so that the order does not depend on the shape.
///
/// ```
/// use geobench_window::queue::{Heap, HeapShape};
///
/// for shape in [HeapShape::Binary, HeapShape::Quaternary] {
///     let mut heap = Heap::new(shape);
///     for (label, item) in [(2.0, 'c'), (1.0, 'b'), (1.0, 'a')] {
///         heap.push(label, item);
///     }
///     assert_eq!(heap.pop(), Some((1.0, 'a')));
///     assert_eq!(heap.peek(), Some((1.0, 'b')));
/// }
/// ```
#[derive(Clone, Debug)]
pub struct Heap<T>(Shaped<T>);

#[derive(Clone, Debug)]
enum Shaped<T> {
    Binary(BinaryHeap<HeapItem<T>>),
    Quaternary(QuaternaryHeap<T, true>),
}

/// A labelled item. The greatest entry is the one that comes first.
#[derive(Clone, Copy, Debug)]
struct HeapItem<T>(f64, T);

impl<T: Ord> Ord for HeapItem<T> {
    #[inline]
    fn cmp(&self, other: &Self) -> Ordering {
        // Labels are not NaN.
        let by_label = other.0.partial_cmp(&self.0).unwrap_or(Ordering::Equal);
        by_label.then_with(|| other.1.cmp(&self.1))
    }
}

impl<T: Ord> PartialOrd for HeapItem<T> {
    #[inline]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<T: Ord> PartialEq for HeapItem<T> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<T: Ord> Eq for HeapItem<T> {}

impl<T: Copy + Ord> Default for Heap<T> {
    /// An empty binary heap.
    fn default() -> Self {
        Self::new(HeapShape::default())
    }
}

impl<T: Copy + Ord> Heap<T> {
    /// An empty heap of this shape.
    pub fn new(shape: HeapShape) -> Self {
        Self(match shape {
            HeapShape::Binary => Shaped::Binary(BinaryHeap::new()),
            HeapShape::Quaternary => Shaped::Quaternary(QuaternaryHeap::default()),
        })
    }

    /// Adds `item` with its label, which must not be NaN.
    #[inline]
    pub fn push(&mut self, label: f64, item: T) {
        match &mut self.0 {
            Shaped::Binary(heap) => heap.push(HeapItem(label, item)),
            Shaped::Quaternary(heap) => heap.push(label, item),
        }
    }

    /// Takes the first item, with its label.
    #[inline]
    pub fn pop(&mut self) -> Option<(f64, T)> {
        match &mut self.0 {
            Shaped::Binary(heap) => heap.pop().map(|HeapItem(label, item)| (label, item)),
            Shaped::Quaternary(heap) => heap.pop(),
        }
    }

    /// The item that [`pop`](Self::pop) would take.
    #[inline]
    pub fn peek(&self) -> Option<(f64, T)> {
        match &self.0 {
            Shaped::Binary(heap) => heap.peek().map(|&HeapItem(label, item)| (label, item)),
            Shaped::Quaternary(heap) => heap.peek(),
        }
    }

    /// Number of items.
    #[inline]
    pub fn len(&self) -> usize {
        match &self.0 {
            Shaped::Binary(heap) => heap.len(),
            Shaped::Quaternary(heap) => heap.len(),
        }
    }

    /// Whether no item is left.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// All items with their labels, in no order.
    pub fn iter(&self) -> impl Iterator<Item = (f64, T)> {
        let (binary, quaternary) = match &self.0 {
            Shaped::Binary(heap) => (Some(heap), None),
            Shaped::Quaternary(heap) => (None, Some(heap)),
        };
        let binary = binary.into_iter().flatten();
        let quaternary = quaternary
            .into_iter()
            .flat_map(QuaternaryHeap::iter)
            .copied();
        binary
            .map(|&HeapItem(label, item)| (label, item))
            .chain(quaternary)
    }

    /// Drops all items, keeping the memory.
    pub fn clear(&mut self) {
        match &mut self.0 {
            Shaped::Binary(heap) => heap.clear(),
            Shaped::Quaternary(heap) => heap.clear(),
        }
    }
}

/// The priority queue of the papers, which makes an algorithm a continuous Dijkstra: a [`Heap`] of
/// all waiting events.
///
/// # Cost
///
/// O(log n) for each event; 16 bytes.
///
/// ```
/// use geobench_mesh::VertexId;
/// use geobench_window::queue::{Discipline, Event, HeapQueue};
///
/// let [far, near] = [7, 2].map(|v| Event::vertex(VertexId::new(v)));
/// let mut queue = HeapQueue::default();
/// queue.push(3.0, far, &mut ());
/// queue.push(1.0, near, &mut ());
/// assert_eq!(queue.pop(&mut ()), Some((1.0, near)));
/// ```
#[derive(Clone, Debug, Default)]
pub struct HeapQueue {
    heap: Heap<Event>,
}

impl HeapQueue {
    /// An empty queue whose heap has this shape.
    pub fn new(shape: HeapShape) -> Self {
        Self {
            heap: Heap::new(shape),
        }
    }
}

impl Discipline for HeapQueue {
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

    #[inline]
    fn bound(&self, label: f64) -> Option<f64> {
        Some(label)
    }

    #[inline]
    fn is_due(&self, label: f64) -> bool {
        self.heap.peek().is_none_or(|(next, _)| label <= next)
    }

    fn events(&self) -> impl Iterator<Item = (f64, Event)> {
        self.heap.iter()
    }

    fn clear(&mut self) {
        self.heap.clear();
    }
}
