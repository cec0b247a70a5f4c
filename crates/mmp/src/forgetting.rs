//! Lists that the wave has passed.

use std::collections::VecDeque;

use geobench_mesh::HalfEdgeId;
use geobench_window::Window;
use geobench_window::continuous::Edge;
use geobench_window::precision::MARGIN;

/// Lists that can be given up.
pub(crate) trait Past {
    /// Whether any window of list `i` waits to be propagated.
    fn is_waited_for(&self, i: usize) -> bool;

    /// Whether the windows of list `i` have been [forgotten](Self::forget), and none has come
    /// since.
    fn is_closed(&self, i: usize) -> bool;

    /// Gives up the windows of list `i`, none of which may wait.
    fn forget(&mut self, i: usize);

    /// List `i` is to hold windows again.
    fn reopen(&mut self, i: usize);

    /// Whether `window`, which comes to list `i` on `edge`, is of no use since the wave has passed
    /// it; else the list holds windows again if it has been given up.
    #[inline]
    fn has_passed(&mut self, i: usize, window: &Window, edge: &Edge) -> bool {
        if !self.is_closed(i) {
            return false;
        }
        let passed = window.min_distance() > reach([edge.tail, edge.head], edge.length);
        if !passed {
            self.reopen(i);
        }
        passed
    }
}

/// Which windows are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Keep {
    /// All that merging leaves, until the end of the run, as in the paper: the distance is then
    /// known along every edge, with the filter together with those of its ends.
    All,
    /// Those on edges that the wave has not passed yet. Distances of vertices are the same; the
    /// windows propagated for them are, but for three in ten thousand on the horse.
    #[default]
    Wavefront,
}

/// How often to look for lists that can be given up: every so many windows.
const PERIOD: u32 = 64;

/// Finds the lists that can be given up.
///
/// From the ends of an edge of length l at distances d0 and d1, each of its points is reached
/// within (d0 + d1 + l)/2. A window that offers more everywhere loses every ray to a path along the
/// edge. So once none of the windows of a list waits and the queue has come to that distance, it
/// does not matter any more what is in the list; and a window that comes to such a list is dropped
/// if it offers more, else the list begins anew, which costs at most the propagation of that
/// window.
#[derive(Clone, Debug, Default)]
pub(crate) struct Forgetting {
    /// Lists without a window that waits, when they were found so, in the order of that, with the
    /// distance by which they can be given up.
    done: VecDeque<(HalfEdgeId, f64)>,
    takes: u32,
}

impl Forgetting {
    pub(crate) fn clear(&mut self) {
        self.done.clear();
        self.takes = 0;
    }

    /// None of the windows of the list of `h`, all of whose points are [reached](reach) within this
    /// distance, waits any more.
    #[inline]
    pub(crate) fn note(&mut self, h: HalfEdgeId, within: f64) {
        if within < f64::INFINITY {
            self.done.push_back((h, within));
        }
    }

    /// So many windows have been taken, the last one of least distance `label()`: gives up the
    /// lists that may be. Their windows do not count as removed.
    #[inline]
    pub(crate) fn step(&mut self, lists: &mut impl Past, windows: u32, label: impl Fn() -> f64) {
        self.takes += windows;
        if self.takes >= PERIOD {
            self.takes = 0;
            self.sweep(lists, label());
        }
    }

    #[inline(never)]
    fn sweep(&mut self, lists: &mut impl Past, label: f64) {
        while let Some(&(h, within)) = self.done.front()
            && within < label
        {
            self.done.pop_front();
            let i = h.index();
            if !lists.is_waited_for(i) && !lists.is_closed(i) {
                lists.forget(i);
            }
        }
    }
}

/// The distance within which all points of an edge are known to be reached, given those of its ends
/// and its length.
#[inline]
pub(crate) fn reach([tail, head]: [f64; 2], length: f64) -> f64 {
    0.5 * (tail + head + length) * (1.0 + MARGIN)
}
