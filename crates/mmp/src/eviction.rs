//! Eviction of lists that the wavefront has passed.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

use geobench_mesh::HalfEdgeId;
use geobench_window::Window;
use geobench_window::continuous::EdgeView;
use geobench_window::precision::MARGIN;

/// A store of lists that can be evicted one by one.
pub(crate) trait Evictable {
    /// Whether any window of list `i` waits to be propagated.
    fn is_waited_for(&self, i: usize) -> bool;

    /// Whether list `i` has been [evicted](Self::evict) and not reopened since.
    fn is_evicted(&self, i: usize) -> bool;

    /// Drops the windows of list `i`, none of which may wait.
    fn evict(&mut self, i: usize);

    /// Lets list `i` hold windows again.
    fn reopen(&mut self, i: usize);

    /// Whether list `i` on `edge` has been evicted and `window` comes too late to provide any
    /// shortest path. An evicted list that `window` can still improve is reopened.
    #[inline]
    fn rejects_late_arrival(&mut self, i: usize, window: &Window, edge: &EdgeView) -> bool {
        if !self.is_evicted(i) {
            return false;
        }
        let too_late = window.min_distance() > reach([edge.tail, edge.head], edge.length);
        if !too_late {
            self.reopen(i);
        }
        too_late
    }
}

/// Which windows stay in memory until the end of a run.
///
/// ```
/// use geobench_mesh::Mesh;
/// use geobench_mmp::{Retention, mmp_batched};
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("terrain,n=8,seed=1")?;
/// let mut all = mmp_batched(&mesh, 1.0);
/// let mut few = mmp_batched(&mesh, 1.0).retaining(Retention::Wavefront);
/// let (a, b) = (all.distances_from(5)?, few.distances_from(5)?);
/// assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() <= 1e-12 * b));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Retention {
    /// All that trimming leaves, as in the papers. The distance is then known at every point of
    /// every edge; with the filter, together with the distances of the edge's ends.
    #[default]
    All,
    /// Those on edges that the wavefront has not passed. Vertex distances are the same. The
    /// propagated windows are the same up to three in ten thousand on the horse.
    Wavefront,
}

/// Number of windows between two sweeps for lists to evict.
const PERIOD: u32 = 64;

/// Number of sweeps after which a candidate that keeps others from eviction is set aside.
const MOST_WAITS: u32 = 8;

/// Finds the lists that can be evicted.
///
/// From the ends of an edge of length l at distances d0 and d1, every point of the edge is reached
/// within (d0 + d1 + l)/2. A window whose least distance is larger loses every ray to a path along
/// the edge. So once no window of a list waits and the queue has come to that distance, the
/// content of the list has no effect. A window that arrives later is dropped if its least distance
/// is larger; otherwise the list is reopened, which costs at most the propagation of that window.
///
/// Lists beside [thin faces](geobench_window::trimming::ThinFaces) must not be noted: windows that
/// wind around a needle end only where they meet those that came before them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Eviction {
    /// Lists in which no window waited when they were noted, oldest first, with the distance from
    /// which they can be evicted. It mostly grows.
    candidates: VecDeque<(HalfEdgeId, f64)>,
    /// Candidates that were set aside, such as those on very long edges, by the bits of their
    /// distances.
    set_aside: BinaryHeap<Reverse<(u64, HalfEdgeId)>>,
    /// The number of sweeps in which the first candidate had to wait.
    waits: u32,
    taken: u32,
}

impl Eviction {
    pub(crate) fn clear(&mut self) {
        self.candidates.clear();
        self.set_aside.clear();
        self.waits = 0;
        self.taken = 0;
    }

    /// Notes that no window waits in the list of `h`, whose edge is [reached](reach) within
    /// `within`.
    #[inline]
    pub(crate) fn note(&mut self, h: HalfEdgeId, within: f64) {
        if within < f64::INFINITY {
            self.candidates.push_back((h, within));
        }
    }

    /// Counts `windows` more windows taken and evicts lists from time to time; `label()` is the
    /// least distance of the last one. Evicted windows do not count as removed.
    #[inline]
    pub(crate) fn step(
        &mut self,
        lists: &mut impl Evictable,
        windows: u32,
        label: impl Fn() -> f64,
    ) {
        self.taken += windows;
        if self.taken >= PERIOD {
            self.taken = 0;
            self.sweep(lists, label());
        }
    }

    #[inline(never)]
    fn sweep(&mut self, lists: &mut impl Evictable, label: f64) {
        let evict = |lists: &mut _, h: HalfEdgeId| {
            let i = h.index();
            if !Evictable::is_waited_for(lists, i) && !Evictable::is_evicted(lists, i) {
                Evictable::evict(lists, i);
            }
        };
        while let Some(&(h, within)) = self.candidates.front() {
            if within < label {
                evict(lists, h);
            } else if self.waits < MOST_WAITS {
                self.waits += 1;
                break;
            } else {
                // Distances are not negative, so their bits have the same order.
                self.set_aside.push(Reverse((within.to_bits(), h)));
            }
            self.candidates.pop_front();
            self.waits = 0;
        }
        while let Some(&Reverse((within, h))) = self.set_aside.peek()
            && f64::from_bits(within) < label
        {
            self.set_aside.pop();
            evict(lists, h);
        }
    }
}

/// The distance within which every point of an edge is reached, given the distances of its ends
/// and its length.
#[inline]
pub(crate) fn reach([tail, head]: [f64; 2], length: f64) -> f64 {
    0.5 * (tail + head + length) * (1.0 + MARGIN)
}
