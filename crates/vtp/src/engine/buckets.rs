//! A queue of vertices in buckets of distance.

use geobench_window::queue::MinHeap;

/// Buckets of the ring.
const RING: u32 = 1024;

/// No bucket.
const NONE: u32 = u32::MAX;

/// A queue that returns all vertices of the nearest bucket together.
///
/// A vertex that improves is pushed again; its entry in another bucket becomes void. Buckets less
/// than [`RING`] ahead have lists of their own. All other vertices wait in a heap until the ring
/// reaches them.
#[derive(Clone, Debug)]
pub(crate) struct VertexBuckets {
    inverse_width: f64,
    ring: Vec<Vec<u32>>,
    /// Entries in the ring, including void ones.
    in_ring: usize,
    /// A lower bound of the distances in each bucket of the ring that is not empty.
    least: Vec<f64>,
    /// Vertices beyond the ring, by bucket.
    far: MinHeap<u32>,
    current: u32,
    /// The bucket of each vertex.
    bucket_of: Vec<u32>,
}

impl VertexBuckets {
    pub(crate) fn new(vertices: usize, width: f64) -> Self {
        Self {
            inverse_width: width.recip(),
            ring: vec![Vec::new(); RING as usize],
            in_ring: 0,
            least: vec![0.0; RING as usize],
            far: MinHeap::default(),
            current: 0,
            bucket_of: vec![NONE; vertices],
        }
    }

    /// Changes the number of vertices, none of which may wait.
    pub(crate) fn resize(&mut self, vertices: usize) {
        self.bucket_of.resize(vertices, NONE);
    }

    /// Removes all vertices and starts again at distance 0.
    pub(crate) fn reset(&mut self) {
        self.current = 0;
        if self.len() > 0 {
            for v in self.ring.iter_mut().flat_map(|entries| entries.drain(..)) {
                self.bucket_of[v as usize] = NONE;
            }
            for &(_, v) in self.far.iter() {
                self.bucket_of[v as usize] = NONE;
            }
            self.far.clear();
            self.in_ring = 0;
        }
    }

    /// The distance at the end of `bucket`.
    pub(crate) fn end_of(&self, bucket: u32) -> f64 {
        f64::from(bucket.saturating_add(1)) / self.inverse_width
    }

    /// The width of a bucket.
    pub(crate) fn width(&self) -> f64 {
        self.inverse_width.recip()
    }

    /// Whether the turn of the bucket of distance `d` is over.
    #[inline]
    #[allow(clippy::cast_sign_loss)] // No distance is negative.
    pub(crate) fn has_passed(&self, d: f64) -> bool {
        ((d * self.inverse_width) as u32) < self.current
    }

    /// The waiting vertices.
    pub(crate) fn vertices(&self) -> impl Iterator<Item = u32> {
        let far = self.far.iter().filter(|&&entry| self.is_valid(entry));
        self.near().chain(far.map(|&(_, v)| v))
    }

    /// Whether the entry of a vertex in `far` is its last one.
    fn is_valid(&self, (bucket, v): (f64, u32)) -> bool {
        f64::from(self.bucket_of[v as usize]) == bucket
    }

    /// Number of entries, including void ones.
    pub(crate) fn len(&self) -> usize {
        self.in_ring + self.far.len()
    }

    /// Gives vertex `v` a turn at distance `d`; returns whether that changes its bucket.
    #[inline]
    #[allow(clippy::cast_sign_loss)] // No distance is negative.
    pub(crate) fn push(&mut self, v: u32, d: f64) -> bool {
        // A distance beyond all buckets goes to the last one.
        let bucket = ((d * self.inverse_width) as u32).clamp(self.current, NONE - 1);
        let known = std::mem::replace(&mut self.bucket_of[v as usize], bucket);
        if bucket - self.current < RING {
            let least = &mut self.least[(bucket % RING) as usize];
            if known == bucket {
                *least = least.min(d);
                return false;
            }
            self.push_near(v, bucket, d);
        } else if known == bucket {
            return false;
        } else {
            self.far.push(f64::from(bucket), v);
        }
        true
    }

    /// Adds vertex `v` at distance `d` to `bucket`, which is in the ring.
    #[inline]
    fn push_near(&mut self, v: u32, bucket: u32, d: f64) {
        let place = (bucket % RING) as usize;
        let (entries, least) = (&mut self.ring[place], &mut self.least[place]);
        *least = if entries.is_empty() { d } else { least.min(d) };
        entries.push(v);
        self.in_ring += 1;
    }

    /// A lower bound of the distances of the waiting vertices, in the nearest bucket; infinity if
    /// there are none.
    pub(crate) fn least(&mut self) -> f64 {
        match self.nearest() {
            None => f64::INFINITY,
            Some(bucket) if bucket - self.current < RING => self.least[(bucket % RING) as usize],
            Some(bucket) => self.start_of(bucket),
        }
    }

    /// The distance at the start of `bucket`.
    fn start_of(&self, bucket: u32) -> f64 {
        f64::from(bucket) / self.inverse_width
    }

    /// The nearest non-empty bucket.
    pub(crate) fn nearest(&mut self) -> Option<u32> {
        self.bring_near();
        let mut bucket = self.current;
        while self.in_ring > 0 {
            let entries = &mut self.ring[(bucket % RING) as usize];
            if entries
                .iter()
                .any(|&v| self.bucket_of[v as usize] == bucket)
            {
                return Some(bucket);
            }
            self.in_ring -= entries.len();
            entries.clear();
            bucket += 1;
        }
        // Far vertices move into the ring only when their bucket is the nearest.
        while let Some(entry) = self.far.peek() {
            if self.is_valid(entry) {
                return Some(self.bucket_of[entry.1 as usize]);
            }
            self.far.pop();
        }
        None
    }

    /// Replaces the contents of `turn` by the vertices of `bucket`, which must be the nearest
    /// non-empty one. [`nearest`](Self::nearest) must have been called since the last push.
    pub(crate) fn take(&mut self, bucket: u32, turn: &mut Vec<u32>) {
        turn.clear();
        self.current = bucket;
        self.bring_near();
        self.drop_void(bucket);
        std::mem::swap(turn, &mut self.ring[(bucket % RING) as usize]);
        self.in_ring -= turn.len();
        for &v in &*turn {
            self.bucket_of[v as usize] = NONE;
        }
    }

    /// The vertices in the ring, nearest bucket first.
    pub(crate) fn near(&self) -> impl Iterator<Item = u32> {
        let mut left = self.in_ring;
        let buckets = (self.current..self.current.saturating_add(RING)).map_while(move |bucket| {
            let entries = &self.ring[(bucket % RING) as usize];
            let any = left > 0;
            left -= entries.len();
            any.then_some((bucket, entries))
        });
        buckets.flat_map(move |(bucket, entries)| {
            let entries = entries.iter().copied();
            entries.filter(move |&v| self.bucket_of[v as usize] == bucket)
        })
    }

    /// Removes vertex `v`; returns whether it was waiting.
    pub(crate) fn remove(&mut self, v: u32) -> bool {
        let bucket = std::mem::replace(&mut self.bucket_of[v as usize], NONE);
        if bucket == NONE {
            return false;
        }
        // Its entry would become valid again if the vertex returned to the same bucket.
        if bucket - self.current < RING {
            self.drop_void(bucket);
        }
        if self
            .far
            .peek()
            .is_some_and(|(least, _)| f64::from(bucket) >= least)
        {
            let far = std::mem::take(&mut self.far);
            for &(bucket, other) in far.iter().filter(|&&(_, far)| far != v) {
                self.far.push(bucket, other);
            }
        }
        true
    }

    /// Drops the void entries of a bucket in the ring; returns how many entries are left.
    fn drop_void(&mut self, bucket: u32) -> usize {
        let entries = &mut self.ring[(bucket % RING) as usize];
        let before = entries.len();
        entries.retain(|&v| self.bucket_of[v as usize] == bucket);
        self.in_ring -= before - entries.len();
        entries.len()
    }

    /// Moves far vertices into the ring if their buckets are within reach.
    #[inline]
    fn bring_near(&mut self) {
        let end = f64::from(self.current.saturating_add(RING));
        while let Some(entry) = self.far.peek().filter(|&(bucket, _)| bucket < end) {
            self.far.pop();
            if self.is_valid(entry) {
                let bucket = self.bucket_of[entry.1 as usize];
                self.push_near(entry.1, bucket, self.start_of(bucket));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drain(buckets: &mut VertexBuckets) -> Vec<Vec<u32>> {
        let (mut turns, mut turn) = (Vec::new(), Vec::new());
        while let Some(bucket) = buckets.nearest() {
            buckets.take(bucket, &mut turn);
            turn.sort_unstable();
            turns.push(turn.clone());
        }
        turns
    }

    #[test]
    fn a_removed_vertex_has_no_turn_until_pushed_again() {
        let mut buckets = VertexBuckets::new(4, 1.0);
        for distance in [3.5, 5000.5] {
            assert!(!buckets.remove(1));
            buckets.push(0, distance);
            buckets.push(1, distance);
            assert!(buckets.remove(1) && buckets.len() == 1);
            assert_eq!(
                buckets.clone().nearest(),
                Some(if distance < 10.0 { 3 } else { 5000 })
            );
            buckets.push(1, distance);
            assert_eq!(drain(&mut buckets), [[0, 1]]);
        }
        buckets.reset();
        for (v, distance) in [(2, 7.0), (0, 7.5), (1, 8.0)] {
            buckets.push(v, distance);
        }
        buckets.push(0, 6.0);
        buckets.push(3, 1e4);
        assert_eq!(buckets.near().collect::<Vec<_>>(), [0, 2, 1]);
    }

    #[test]
    fn vertices_come_by_buckets_however_far_apart() {
        let mut buckets = VertexBuckets::new(7, 0.5);
        let distances = [1e30, 0.1, 600.0, 1e5, 0.4, 1e30, 1e5 + 1.0];
        for (v, d) in distances.into_iter().enumerate() {
            assert!(buckets.push(v as u32, d));
        }
        assert_eq!(buckets.len(), 7);
        let mut waiting: Vec<u32> = buckets.vertices().collect();
        waiting.sort_unstable();
        assert_eq!(waiting, [0, 1, 2, 3, 4, 5, 6]);
        let turns = drain(&mut buckets);
        assert_eq!(turns, [vec![1, 4], vec![2], vec![3], vec![6], vec![0, 5]]);
        assert_eq!(buckets.len(), 0);
    }

    #[test]
    fn only_the_last_entry_of_a_vertex_counts() {
        let mut buckets = VertexBuckets::new(3, 1.0);
        for d in [1e4, 2e3, 5.0, 2.0, 2.5] {
            buckets.push(0, d);
        }
        assert!(!buckets.push(0, 2.9), "the same bucket is no news");
        buckets.push(1, 3.0);
        assert_eq!(drain(&mut buckets), [[0], [1]]);
        buckets.reset();
        buckets.push(2, 1.0);
        buckets.push(0, 2.0);
        assert_eq!(drain(&mut buckets), [[2], [0]]);
        // Vertices that were not taken are dropped.
        for (v, d) in [(0, 1.0), (1, 9.0), (2, 1e5)] {
            buckets.push(v, d);
        }
        assert_eq!(buckets.end_of(9), 10.0);
        buckets.reset();
        buckets.push(1, 9.0);
        assert_eq!(drain(&mut buckets), [[1]]);
    }

    #[test]
    #[allow(clippy::cast_sign_loss)]
    fn a_search_for_the_nearest_bucket_delays_no_earlier_push() {
        let (mut buckets, mut turn) = (VertexBuckets::new(4, 1.0), Vec::new());
        assert_eq!(buckets.nearest(), None);
        for (v, d) in [(0, 2000.0), (1, 70.0), (1, 50.0)] {
            buckets.push(v, d);
            assert_eq!(buckets.nearest(), Some(d as u32));
        }
        // This queue has nothing in the bucket, but another thread's queue has.
        buckets.take(20, &mut turn);
        assert!(turn.is_empty());
        buckets.push(2, 30.0);
        buckets.push(3, 10.0);
        assert_eq!(drain(&mut buckets), [vec![3], vec![2], vec![1], vec![0]]);
        assert_eq!(buckets.len(), 0);
    }

    #[test]
    fn the_least_distance_is_that_of_the_nearest_bucket() {
        let mut buckets = VertexBuckets::new(3, 1.0);
        assert_eq!(buckets.least(), f64::INFINITY);
        for (v, d, least) in [(0, 2000.5, 2000.0), (1, 70.5, 70.5), (1, 70.25, 70.25)] {
            buckets.push(v, d);
            assert_eq!(buckets.least(), least);
        }
        buckets.take(70, &mut Vec::new());
        assert_eq!(buckets.least(), 2000.0);
        buckets.push(2, 80.5);
        assert_eq!(buckets.least(), 80.5);
    }

    #[test]
    fn a_late_vertex_is_in_the_next_turn() {
        let mut buckets = VertexBuckets::new(2, 1.0);
        let mut turn = Vec::new();
        buckets.push(0, 5.0);
        buckets.take(5, &mut turn);
        buckets.push(1, 1.0);
        buckets.push(0, 5.5);
        assert_eq!(buckets.nearest(), Some(5));
        buckets.take(5, &mut turn);
        assert_eq!(turn, [1, 0]);
    }
}
