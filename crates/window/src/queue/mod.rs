//! Disciplines: in which order events are taken.
//!
//! An algorithm is a policy (what happens to a window that arrives) under a discipline. A
//! discipline sees labels and events only, so that two algorithms with the same policy differ in
//! the order and in nothing else.

mod event;
mod fifo;
mod heap;

pub use event::{Event, EventKind};
pub use fifo::Fifo;
pub use heap::Heap;

/// An order in which items are taken. Results do not depend on it, only costs do.
pub trait Discipline<T>: Default + Send {
    /// Adds `item` with its label, a non-negative distance.
    fn push(&mut self, label: f64, item: T);

    /// Takes the next item, with its label.
    fn pop(&mut self) -> Option<(f64, T)>;

    /// Number of items waiting.
    fn len(&self) -> usize;

    /// Whether nothing waits.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Forgets everything, keeping the memory.
    fn clear(&mut self);
}
