//! Disciplines: the order in which a solver takes its events.

mod arena;
mod bucket_sort;
mod calendar;
mod calendar_queue;
mod event;
mod fifo;
mod heap;
mod heap_queue;
mod ring;

pub use arena::{Arena, Chain};
pub use calendar::{Calendar, mean_edge_length};
pub use calendar_queue::CalendarQueue;
pub use event::{Event, EventKind};
pub use fifo::Fifo;
pub use heap::{MinHeap, QuaternaryHeap};
pub use heap_queue::{Heap, HeapQueue, HeapShape};

use geobench_mesh::{HalfEdgeId, Mesh, Splice, VertexId};

use crate::counters::Counter;
use crate::goal::EndCheck;
use crate::probe::Probe;

/// An order in which events are taken. A discipline sees only the labels and places of events.
/// Distances do not depend on it; counts and time do.
///
/// ```
/// use geobench_mesh::VertexId;
/// use geobench_window::queue::{Discipline, Event, Fifo};
///
/// let [a, b] = [3, 5].map(|v| Event::vertex(VertexId::new(v)));
/// let mut queue = Fifo::default();
/// queue.push(2.0, a, &mut ());
/// queue.push(1.0, b, &mut ());
/// assert_eq!(queue.pop(&mut ()), Some((2.0, a)));
/// ```
pub trait Discipline: Send {
    /// The counters that this discipline keeps.
    const COUNTERS: &'static [Counter];

    /// Whether every vertex whose distance improves is pushed, not only those at which a path may
    /// turn.
    const EVERY_VERTEX: bool = false;

    /// Tells that `source` sends out its windows now, without having waited.
    fn start(&mut self, source: VertexId) {
        let _ = source;
    }

    /// Adds `event` with its label, a non-negative distance.
    fn push<P: Probe>(&mut self, label: f64, event: Event, probe: &mut P);

    /// Adds the event of a half-edge whose windows are taken together, with the least of their
    /// labels. Each of these windows has been passed to [`weigh`](Self::weigh).
    #[inline]
    fn push_list<P: Probe>(&mut self, label: f64, event: Event, probe: &mut P) {
        self.push(label, event, probe);
    }

    /// Tells that a window with this label now waits on a half-edge whose windows are taken
    /// together.
    #[inline]
    fn weigh(&mut self, label: f64) {
        let _ = label;
    }

    /// Takes the next event, with its label.
    fn pop<P: Probe>(&mut self, probe: &mut P) -> Option<(f64, Event)>;

    /// A lower bound of the labels of all waiting events and of `label`, the label of an event that
    /// has just left the queue; `None` if the order of this queue gives no bound.
    #[inline]
    fn bound(&self, label: f64) -> Option<f64> {
        let _ = label;
        None
    }

    /// Whether an event that has just left the queue may still be processed if its label has grown
    /// to `label`. For a list: whether a window with this label is propagated with it.
    #[inline]
    fn is_due(&self, label: f64) -> bool {
        let _ = label;
        true
    }

    /// Tells that the list whose event has just left the queue stores `windows` windows. May change
    /// which of them are [due](Self::is_due).
    #[inline]
    fn take_list(&mut self, windows: usize) {
        let _ = windows;
    }

    /// The event that is likely to come after `skipped` others, if that is cheap to find. Its
    /// memory is prefetched.
    #[inline]
    fn upcoming(&self, skipped: usize) -> Option<Event> {
        let _ = skipped;
        None
    }

    /// The events that are likely to come next, in that order, as far as they are cheap to find.
    #[inline]
    fn coming(&self) -> impl Iterator<Item = Event> {
        (0..).map_while(|skipped| self.upcoming(skipped))
    }

    /// Tells that a window has crossed the face of `h`, where `tries` children of it were tried.
    #[inline]
    fn crossed<P: Probe>(&mut self, h: HalfEdgeId, tries: u64, probe: &mut P) {
        let _ = (h, tries, probe);
    }

    /// All waiting events with their labels, including outdated ones, in no order.
    fn events(&self) -> impl Iterator<Item = (f64, Event)>;

    /// Removes all events, keeping the memory.
    fn clear(&mut self);

    /// Follows a change of the mesh, which is `mesh` now, between two runs. Queues that hold
    /// nothing for each face or vertex need not.
    fn splice(&mut self, mesh: &Mesh, splice: &Splice) {
        let _ = (mesh, splice);
    }

    /// Whether a run ends now that an event under `label` has left the queue: everything that
    /// `probe` wants is final, given the known distances.
    fn ends<P: Probe>(
        &self,
        label: f64,
        end_check: &mut EndCheck,
        distance: impl Fn(VertexId) -> f64,
        probe: &mut P,
    ) -> bool {
        let Some(bound) = self.bound(label) else {
            let waiting = || self.events().map(|(label, _)| label).chain([label]);
            return end_check.ends(probe, label, distance, waiting);
        };
        let ends = probe.is_reached(bound, distance);
        if ends {
            probe.end(bound);
        }
        ends
    }
}
