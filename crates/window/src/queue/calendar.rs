//! A calendar queue: events in buckets of labels.

use geobench_mesh::Mesh;

use super::arena::{Arena, Chain};
use super::ring::Ring;
use super::{Event, MinHeap};
use crate::window::less;

/// The most buckets that a ring can have, 3 MB. Events beyond them wait in a heap.
const MOST_BUCKETS: u64 = 1 << 18;

/// The number of the last bucket; no label of a mesh comes near it.
const LAST_BUCKET: f64 = (1u64 << 51) as f64;

/// Where the integers are the only numbers: what is added to it is rounded to one, which then
/// stands in the last bits.
pub(super) const INTEGERS: f64 = (1u64 << 52) as f64;

/// Buckets of equal width that hold events first in, first out, from a first bucket on that only
/// moves upwards.
///
/// # Cost
///
/// O(1) for each event, whatever the number of buckets. They form a ring from the first bucket on,
/// of as many slots as the labels that wait are apart; a label more than 262,144 buckets further
/// up, which only a very small width or an edge of thousands of times the mean length can bring,
/// waits in a heap, at O(log k). An event takes 24 bytes and a slot 12.
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
    /// The place of an event, see [`Calendar::walk`].
    walker: u32,
    /// Events whose buckets the ring may not reach; all beyond it.
    far: MinHeap<Event>,
}

impl Calendar {
    /// Empty buckets of this width. One that is not positive, or not finite, puts all events into
    /// one bucket.
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

    /// The width by which Xu et al. 2015 divide labels, h/√n for h the mean length of the edges and
    /// n the number of vertices; O(edges).
    pub fn usual_width(mesh: &Mesh) -> f64 {
        mean_edge_length(mesh) / (mesh.vertex_count() as f64).sqrt()
    }

    /// The width of a bucket; infinite if there is one only.
    pub fn width(&self) -> f64 {
        self.per_length.recip()
    }

    /// The bucket that holds `label`. Labels in order have buckets in order.
    #[inline]
    pub fn bucket(&self, label: f64) -> u64 {
        let place = self.place(label);
        let rounded = place + INTEGERS;
        rounded.to_bits() - INTEGERS.to_bits() - u64::from(rounded - INTEGERS > place)
    }

    /// Where `label` lies, in widths of a bucket: bucket k holds what is at k or above and below k
    /// + 1.
    #[inline]
    pub fn place(&self, label: f64) -> f64 {
        less(label * self.per_length, LAST_BUCKET)
    }

    /// How far `label` lies within its bucket: from 0 to 1, up to rounding.
    #[inline]
    pub(super) fn place_in(&self, bucket: u64, label: f64) -> f64 {
        label * self.per_length - bucket as f64
    }

    /// Number of events, those detached included.
    #[inline]
    pub fn len(&self) -> usize {
        self.arena.len() + self.far.len()
    }

    /// Whether there is no event.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The lowest bucket that it can hold.
    #[inline]
    pub fn first(&self) -> u64 {
        self.ring.first()
    }

    /// Puts an event into a bucket that is not below the first.
    #[inline(always)]
    #[allow(clippy::inline_always)] // Its events are not to pass through memory on their way.
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

    /// The lowest bucket that is not empty from `from` on, of those that are not far away.
    #[inline]
    pub fn next_occupied(&self, from: u64) -> Option<u64> {
        self.ring.next_occupied(from)
    }

    /// Takes all events of a bucket, first in, first out, and puts them behind those in `to`.
    #[inline]
    pub fn drain(&mut self, bucket: u64, to: &mut Vec<(f64, Event)>) {
        let chain = self.ring.vacate(bucket);
        self.arena.drain(chain, to);
    }

    /// Finds the bucket that comes after `bucket`, for [`walk`](Self::walk).
    #[inline]
    pub(super) fn look_behind(&mut self, bucket: u64) {
        if let Some(next) = self.ring.next_occupied(bucket + 1) {
            self.walker = self.ring.chain(next).head;
        }
    }

    /// Asks for the memory of one more event of the bucket that was looked for. An event tells
    /// where the next one lies, so that a bucket whose events are far apart would take long to
    /// [drain](Self::drain) otherwise.
    #[inline]
    pub(super) fn walk(&mut self) {
        self.arena.walk(&mut self.walker);
    }

    /// Takes all events of a bucket, first in, first out, and puts them behind those of `to`, in
    /// constant time.
    #[inline]
    pub fn detach(&mut self, bucket: u64, to: &mut Chain) {
        self.arena.join(to, self.ring.vacate(bucket));
    }

    /// Takes the first of the events that were [detached](Self::detach), with its label, and asks
    /// for the memory of the next.
    #[inline]
    pub fn take(&mut self, detached: &mut Chain) -> Option<(f64, Event)> {
        let taken = self.arena.take(detached);
        self.arena.announce(*detached);
        taken
    }

    /// All events that wait with their labels, those detached included, in no order.
    pub fn events(&self) -> impl Iterator<Item = (f64, Event)> {
        self.arena.events().chain(self.far.iter().copied())
    }

    /// Forgets all events, keeping the memory; the first bucket is number 0 again.
    pub fn clear(&mut self) {
        self.arena.clear();
        self.ring.clear();
        self.far.clear();
    }
}

/// Mean length of the edges, each once; 0 without any. O(edges).
pub fn mean_edge_length(mesh: &Mesh) -> f64 {
    let once = |&h: &_| mesh.twin(h).is_none_or(|twin| h < twin);
    let (mut sum, mut edges) = (0.0, 0.0);
    for h in mesh.half_edges().filter(once) {
        sum += mesh.length(h);
        edges += 1.0;
    }
    sum / f64::max(edges, 1.0)
}
