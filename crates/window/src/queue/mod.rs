//! Disciplines: in which order events are taken.

mod event;
mod fifo;
mod heap;
mod priority;

pub use event::{Event, EventKind};
pub use fifo::Fifo;
pub use heap::MinHeap;
pub use priority::Priority;

use crate::counters::Counter;
use crate::probe::Probe;

/// An order in which events are taken. It sees their labels and places only; results do not
/// depend on it, costs do.
pub trait Discipline: Send {
    /// The counters that this discipline keeps.
    const COUNTERS: &'static [Counter];

    /// Adds `event` with its label, a non-negative distance.
    fn push<P: Probe>(&mut self, label: f64, event: Event, probe: &mut P);

    /// Takes the next event, with its label.
    fn pop<P: Probe>(&mut self, probe: &mut P) -> Option<(f64, Event)>;

    /// The labels of all windows that wait, those of outdated entries included.
    fn window_labels(&self) -> impl Iterator<Item = f64>;

    /// Forgets everything, keeping the memory.
    fn clear(&mut self);
}
