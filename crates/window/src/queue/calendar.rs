//! A calendar queue: events in buckets of equal label width.

use geobench_mesh::Mesh;

use super::arena::{Arena, Chain};
use super::ring::Ring;
use super::{Event, MinHeap};
use crate::window::less;

/// The most buckets of a ring, 3 MB. Events beyond them wait in a heap.
const MOST_BUCKETS: u64 = 1 << 18;

/// The number of the last bucket, far above the labels of any mesh.
const LAST_BUCKET: f64 = (1u64 << 51) as f64;

/// The least power of two above which `f64` has no fractions. Adding it to a smaller number rounds
/// that to an integer and leaves the integer in the low bits.
pub(super) const INTEGERS: f64 = (1u64 << 52) as f64;

/// Buckets of equal width, each first in, first out. The first bucket only moves upwards.
///
/// # Cost
///
/// O(1) for each event, whatever the number of buckets. The buckets form a ring that starts at the
/// first bucket and spans the labels that wait. A label more than 262,144 buckets above the first
/// waits in a heap, at O(log k); it takes a very small width or an edge of thousands of times the
/// mean length. An event takes 24 bytes and a slot 12.
///
/// ```
/// use geobench_mesh::VertexId;
/// use geobench_window::queue::{Calendar, Event};
///
/// let mut calendar = Calendar::new(0.5);
/// let event = Event::vertex(VertexId::new(3));
/// calendar.put(calendar.bucket(1.2), 1.2, event);
/// let first = calendar.advance().expect("a bucket that holds something");
/// assert_eq!(first, calendar.bucket(1.2));
/// let mut drained = Vec::new();
/// calendar.drain(first, &mut drained);
/// assert_eq!(drained, [(1.2, event)]);
/// ```
#[derive(Clone, Debug)]
pub struct Calendar {
    /// Buckets for each unit of length.
    per_length: f64,
    arena: Arena,
    ring: Ring,
    /// The link to prefetch next; see [`Calendar::walk`].
    walker: u32,
    /// Events that were too far above the first bucket for the ring.
    far: MinHeap<Event>,
}

impl Calendar {
    /// A calendar without events, with buckets of this width. All events share one bucket if the
    /// width is not positive or not finite.
    pub fn new(width: f64) -> Self {
        let per_length = width.recip();
        let usable = width > 0.0 && per_length.is_finite();
        Self {
            per_length: if usable { per_length } else { 0.0 },
            arena: Arena::default(),
            ring: Ring::new(),
            walker: 0,
            far: MinHeap::default(),
        }
    }

    /// The label width of Xu et al. 2015: h/√n, where h is the mean length of the edges and n the
    /// number of vertices. O(edges).
    pub fn usual_width(mesh: &Mesh) -> f64 {
        mean_edge_length(mesh) / (mesh.vertex_count() as f64).sqrt()
    }

    /// The width of a bucket; infinite if there is only one.
    pub fn width(&self) -> f64 {
        self.per_length.recip()
    }

    /// The bucket of `label`. It does not decrease with the label.
    #[inline]
    pub fn bucket(&self, label: f64) -> u64 {
        let place = self.place(label);
        let rounded = place + INTEGERS;
        rounded.to_bits() - INTEGERS.to_bits() - u64::from(rounded - INTEGERS > place)
    }

    /// The position of `label` in widths of a bucket: bucket k holds k ≤ position < k + 1.
    #[inline]
    pub fn place(&self, label: f64) -> f64 {
        less(label * self.per_length, LAST_BUCKET)
    }

    /// The position of `label` within its bucket: from 0 to 1, up to rounding.
    #[inline]
    pub(super) fn place_in(&self, bucket: u64, label: f64) -> f64 {
        label * self.per_length - bucket as f64
    }

    /// Number of events, including detached ones.
    #[inline]
    pub fn len(&self) -> usize {
        self.arena.len() + self.far.len()
    }

    /// Whether there is no event.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The first bucket, below which no event can be put.
    #[inline]
    pub fn first(&self) -> u64 {
        self.ring.first()
    }

    /// Puts an event into `bucket`, which must not be below the first.
    #[inline(always)]
    #[allow(clippy::inline_always)] // Keeps the event in registers.
    pub fn put(&mut self, bucket: u64, label: f64, event: Event) {
        if bucket - self.ring.first() < MOST_BUCKETS {
            let chain = self.ring.occupy(bucket);
            self.arena.append(chain, label, event);
        } else {
            self.put_far(label, event);
        }
    }

    #[cold]
    #[inline(never)]
    fn put_far(&mut self, label: f64, event: Event) {
        self.far.push(label, event);
    }

    /// Makes the lowest bucket that is not empty the first one, and returns it.
    pub fn advance(&mut self) -> Option<u64> {
        let near = self.ring.next_occupied(self.ring.first());
        let first = near.or_else(|| self.far.peek().map(|(label, _)| self.bucket(label)))?;
        self.ring.advance(first);
        while let Some((label, event)) = self.far.peek() {
            let bucket = self.bucket(label);
            if bucket - first >= MOST_BUCKETS {
                break;
            }
            self.far.pop();
            self.put(bucket, label, event);
        }
        Some(first)
    }

    /// The lowest non-empty bucket of the ring from `from` on. Events in the heap are not
    /// considered.
    #[inline]
    pub fn next_occupied(&self, from: u64) -> Option<u64> {
        self.ring.next_occupied(from)
    }

    /// Moves all events of a bucket behind those in `to`, in the order in which they were put.
    #[inline]
    pub fn drain(&mut self, bucket: u64, to: &mut Vec<(f64, Event)>) {
        let chain = self.ring.vacate(bucket);
        self.arena.drain(chain, to);
    }

    /// Sets [`walk`](Self::walk) to the first event of the bucket that follows `bucket`.
    #[inline]
    pub(super) fn prepare_walk(&mut self, bucket: u64) {
        if let Some(next) = self.ring.next_occupied(bucket + 1) {
            self.walker = self.ring.chain(next).head;
        }
    }

    /// Prefetches one more event of the bucket set by [`prepare_walk`](Self::prepare_walk). The
    /// events of a bucket form a linked list, so [draining](Self::drain) it without prefetching
    /// would wait for each link.
    #[inline]
    pub(super) fn walk(&mut self) {
        self.arena.walk(&mut self.walker);
    }

    /// Moves all events of a bucket behind those of `to`, in constant time.
    #[inline]
    pub fn detach(&mut self, bucket: u64, to: &mut Chain) {
        self.arena.join(to, self.ring.vacate(bucket));
    }

    /// Takes the first of the [detached](Self::detach) events, with its label, and prefetches the
    /// next one.
    #[inline]
    pub fn take(&mut self, detached: &mut Chain) -> Option<(f64, Event)> {
        let taken = self.arena.take(detached);
        self.arena.announce(*detached);
        taken
    }

    /// All waiting events with their labels, including detached ones, in no order.
    pub fn events(&self) -> impl Iterator<Item = (f64, Event)> {
        self.arena.events().chain(self.far.iter().copied())
    }

    /// Removes all events, keeping the memory. The first bucket becomes number 0.
    pub fn clear(&mut self) {
        self.arena.clear();
        self.ring.clear();
        self.far.clear();
    }
}

/// Mean length of the edges, each counted once; 0 without edges. O(edges).
pub fn mean_edge_length(mesh: &Mesh) -> f64 {
    let once = |&h: &_| mesh.twin(h).is_none_or(|twin| h < twin);
    let (mut sum, mut edges) = (0.0, 0.0);
    for h in mesh.half_edges().filter(once) {
        sum += mesh.length(h);
        edges += 1.0;
    }
    sum / f64::max(edges, 1.0)
}
