//! One window at a time: the frame of the CH family, and of MMP where windows are taken one by one.
//!
//! An algorithm of these families is a [`Policy`] (what happens to a window that arrives at a
//! half-edge, and which children a window that crosses a triangle may have) under a
//! [`Discipline`] (the order in which windows and pseudo-sources are taken). The rest is here:
//! the sources, the vertices' distances, pseudo-sources, the crossing of a triangle. Two
//! algorithms that differ in one choice differ in nothing else.

mod edge;
mod explorer;
mod lookahead;
mod policy;
mod propagation;
mod relaying;
mod surface;

pub use edge::{Behind, EdgeView};
pub use explorer::{Explorer, Neighbour};
pub use policy::{Arrival, Child, Dequeued, Policy};
pub use propagation::Continuous;
pub use relaying::Relaying;
pub use surface::Surface;

#[cfg(doc)]
use crate::queue::Discipline;
