//! One window at a time: the frame of the CH family, and of MMP where windows are taken one by one.
//!
//! An algorithm of these families is a [`Policy`] under a [`Discipline`]. The policy decides what
//! happens to a window that arrives at a half-edge, and which children a window may have. The
//! discipline is the order in which windows and pseudo-sources are taken. Everything else is shared
//! and lies here: sources, vertex distances, pseudo-sources and the crossing of a triangle.

mod edge;
mod explorer;
mod lookahead;
mod policy;
mod propagation;
mod surface;

pub use edge::{Behind, EdgeView};
pub use explorer::{Explorer, Neighbour};
pub use policy::{Arrival, Child, Dequeued, Policy};
pub use propagation::Continuous;
pub use surface::Surface;

#[cfg(doc)]
use crate::queue::Discipline;
