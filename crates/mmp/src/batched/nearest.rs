//! A queue of lists, the one with the nearest window first.

use geobench_mesh::Mesh;
use geobench_window::queue::{CalendarQueue, Discipline, Event, mean_edge_length};
use geobench_window::{Counter, Probe};

/// A [`CalendarQueue`] queue of lists. The list with the nearest window is taken; its windows that
/// are at most a slack further are due with it.
///
/// # Cost
///
/// That of [`CalendarQueue`], for each time a list is queued.
///
/// ```
/// use geobench_mesh::Mesh;
/// use geobench_mmp::{Batched, NearestLists};
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("terrain,n=8,seed=1")?;
/// let mut solver = Batched::new(&mesh, NearestLists::new(&mesh, NearestLists::SLACK));
/// assert_eq!(solver.distances_from(5)?[5], 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct NearestLists {
    queue: CalendarQueue,
    /// How much further a due window may be, as a length.
    slack: f64,
    /// The label of the list that is being taken.
    nearest: f64,
    /// The greatest label of a due window of that list.
    due: f64,
}

/// The slack of a list of more windows shrinks in proportion.
///
/// Windows that are taken too early cross faces before better ones trim them, and leave gaps in
/// which windows of other sources go on. In a fan of hundreds of needles, as beside a hole with a
/// fine rim in a plate of long triangles, such fragments doubled at every second edge and a run did
/// not end. Lists on scans are shorter.
const CROWD: f64 = 256.0;

impl NearestLists {
    /// Default slack. No paper has one.
    ///
    /// At this slack nearly all waiting windows of a list are due together, so that more gains
    /// little. With less, batches shrink to single windows.
    pub const SLACK: f64 = 1.0;

    /// An empty queue for the lists of `mesh`; O(edges). The slack is in mean edge lengths, and less
    /// for a list of more than 256 windows. A negative slack and NaN count as 0.
    pub fn new(mesh: &Mesh, slack: f64) -> Self {
        Self {
            queue: CalendarQueue::new(mesh),
            slack: (slack * mean_edge_length(mesh)).max(0.0),
            nearest: 0.0,
            due: 0.0,
        }
    }
}

impl Discipline for NearestLists {
    const COUNTERS: &'static [Counter] = CalendarQueue::COUNTERS;

    #[inline]
    fn push<P: Probe>(&mut self, label: f64, event: Event, probe: &mut P) {
        self.queue.push(label, event, probe);
    }

    #[inline]
    fn pop<P: Probe>(&mut self, probe: &mut P) -> Option<(f64, Event)> {
        let (label, event) = self.queue.pop(probe)?;
        (self.nearest, self.due) = (label, label + self.slack);
        Some((label, event))
    }

    #[inline]
    fn bound(&self, label: f64) -> Option<f64> {
        self.queue.bound(label)
    }

    #[inline]
    fn is_due(&self, label: f64) -> bool {
        label <= self.due
    }

    #[inline]
    fn take_list(&mut self, windows: usize) {
        let share = (CROWD / windows as f64).min(1.0);
        self.due = self.nearest + share * self.slack;
    }

    #[inline]
    fn upcoming(&self, skipped: usize) -> Option<Event> {
        self.queue.upcoming(skipped)
    }

    #[inline]
    fn coming(&self) -> impl Iterator<Item = Event> {
        self.queue.coming()
    }

    fn events(&self) -> impl Iterator<Item = (f64, Event)> {
        self.queue.events()
    }

    fn clear(&mut self) {
        self.queue.clear();
        self.due = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use geobench_mesh::{HalfEdgeId, TriangleSoup};

    use super::*;

    #[test]
    fn windows_within_the_slack_are_due() {
        let positions = vec![[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let soup = TriangleSoup::new(positions, vec![[0, 1, 2]]);
        let mesh = Mesh::from_soup(soup).expect("a triangle is a mesh").0;
        // Its edges have a mean length of 4.
        let mut lists = NearestLists::new(&mesh, 0.5);
        let event = |h| Event::window(HalfEdgeId::new(h), 0);
        for (label, h) in [(5.0, 0), (1.0, 1), (2.5, 2)] {
            lists.push_list(label, event(h), &mut ());
        }
        assert_eq!(lists.pop(&mut ()), Some((1.0, event(1))));
        assert!(lists.is_due(1.0) && lists.is_due(3.0) && !lists.is_due(3.5));
        assert_eq!(lists.pop(&mut ()), Some((2.5, event(2))));
        assert!(lists.is_due(4.5) && !lists.is_due(5.0));
        lists.clear();
        assert_eq!(lists.pop(&mut ()), None);
    }

    #[test]
    fn the_slack_of_a_crowded_list_is_less() {
        let mesh = Mesh::generate("grid,n=8").expect("a grid is a mesh");
        let mean = mean_edge_length(&mesh);
        let mut lists = NearestLists::new(&mesh, 1.0);
        for (windows, share) in [(1, 1.0), (256, 1.0), (1024, 0.25)] {
            lists.push_list(1.0, Event::window(HalfEdgeId::new(0), 0), &mut ());
            lists.pop(&mut ());
            lists.take_list(windows);
            assert!(lists.is_due(1.0 + 0.99 * share * mean), "{windows}");
            assert!(!lists.is_due(1.0 + 1.01 * share * mean), "{windows}");
        }
    }

    /// A list of which nothing is due would have its turn again and again.
    #[test]
    fn the_nearest_window_is_due_for_any_slack() {
        let soup = TriangleSoup::new(
            vec![[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]],
            vec![[0, 1, 2]],
        );
        let mesh = Mesh::from_soup(soup).expect("a triangle is a mesh").0;
        for slack in [-1.0, f64::NAN, f64::NEG_INFINITY, 0.0, f64::INFINITY] {
            let mut lists = NearestLists::new(&mesh, slack);
            lists.push_list(2.0, Event::window(HalfEdgeId::new(0), 0), &mut ());
            lists.pop(&mut ());
            assert!(lists.is_due(2.0), "{slack}");
            lists.take_list(1000);
            assert!(lists.is_due(2.0), "{slack}, many windows");
        }
    }
}
