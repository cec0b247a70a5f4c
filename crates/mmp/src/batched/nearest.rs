//! A queue of lists, the one with the nearest window first.

use geobench_mesh::{FaceId, Mesh};
use geobench_window::queue::{CalendarQueue, Discipline, Event, EventKind, mean_edge_length};
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
    /// The same for the windows that cross each face; empty if `slack` serves for all faces.
    slack_of_faces: Vec<f64>,
    /// The greatest label of a due window of the list that is being taken.
    due: f64,
}

/// A slack of 1 is at most this many heights of the face that is crossed.
///
/// Windows that are taken too early cross faces before better ones trim them, and divide at the
/// vertices there. Where the slack spans hundreds of faces, as beside a hole with a fine rim in a
/// plate of long triangles, a run did not end.
const HEIGHTS: f64 = 8.0;

/// The largest number of faces that decide whether each has a slack of its own.
const SAMPLE: usize = 10_000;

/// Each face has a slack of its own if heights bound it for more than one face in this many. A few
/// small faces, as scans have them, cost less than the slack gains.
const SMALL: usize = 16;

/// The length of a slack of 1 on each face; empty if `mean`, that of an edge, serves for all.
fn units(mesh: &Mesh, mean: f64) -> Vec<f64> {
    let unit = |face: FaceId| {
        let lengths = mesh.side_lengths(face);
        let longest = lengths[0].max(lengths[1]).max(lengths[2]);
        let height = lengths[0] * mesh.apexes(face)[0][1] / longest;
        mean.min(HEIGHTS * height)
    };
    let step = mesh.face_count().div_ceil(SAMPLE).max(1);
    let sampled = mesh.faces().step_by(step);
    let [all, small] = sampled.fold([0, 0], |[all, small], face| {
        [all + 1, small + usize::from(unit(face) < mean)]
    });
    if small * SMALL <= all {
        return Vec::new();
    }
    mesh.faces().map(unit).collect()
}

impl NearestLists {
    /// Default slack. No paper has one.
    ///
    /// At this slack nearly all waiting windows of a list are due together, so that more gains
    /// little. With less, batches shrink to single windows.
    pub const SLACK: f64 = 1.0;

    /// An empty queue for the lists of `mesh`; O(edges). The slack is in mean edge lengths, or in
    /// eight heights of the face that is crossed where that is less and many faces are so small. A
    /// negative slack and NaN count as 0.
    pub fn new(mesh: &Mesh, slack: f64) -> Self {
        let mean = mean_edge_length(mesh);
        let length = |unit: f64| (slack * unit).max(0.0);
        Self {
            queue: CalendarQueue::new(mesh),
            slack: length(mean),
            slack_of_faces: units(mesh, mean).into_iter().map(length).collect(),
            due: 0.0,
        }
    }

    /// How much further than its nearest window the due windows of a list may be.
    #[inline]
    fn slack_of(&self, event: Event) -> f64 {
        if self.slack_of_faces.is_empty() {
            return self.slack;
        }
        match event.kind() {
            // A face that is added for a point of the surface has none.
            EventKind::Window(h, _) => {
                let face = h.face().index();
                self.slack_of_faces.get(face).copied().unwrap_or(0.0)
            }
            EventKind::Vertex(_) => self.slack,
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
        self.due = label + self.slack_of(event);
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

    /// Needles of a fan, a hundredth wide and five long, as beside a fine rim.
    #[test]
    fn heights_of_many_small_faces_bound_the_slack() {
        let rim = (0..=40).map(|i| [0.01 * f64::from(i), 0.0, 0.0]);
        let positions = rim.chain([[0.2, 5.0, 0.0]]).collect();
        let needles = (0..40).map(|i| [i, i + 1, 41]).collect();
        let mesh = Mesh::from_soup(TriangleSoup::new(positions, needles))
            .expect("a fan is a mesh")
            .0;
        let mean = mean_edge_length(&mesh);
        assert!(mean > 2.0);
        let mut lists = NearestLists::new(&mesh, 1.0);
        lists.push_list(1.0, Event::window(HalfEdgeId::new(0), 0), &mut ());
        lists.pop(&mut ());
        assert!(lists.is_due(1.07) && !lists.is_due(1.09));
        // A mesh of equal faces has one slack.
        let even = Mesh::generate("grid,n=8").expect("a grid is a mesh");
        assert!(units(&even, mean_edge_length(&even)).is_empty());
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
        }
    }
}
