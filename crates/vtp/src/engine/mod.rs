//! The parts of list propagation: the mesh laid out for crossing, lists as structures of arrays,
//! and vector passes over them.

// Kernels must be inlined into the functions that enable the instructions.
#![allow(clippy::inline_always)]

pub(crate) mod active_list;
pub(crate) mod buckets;
pub(crate) mod chunks;
pub(crate) mod coalesce;
pub(crate) mod face_state;
pub(crate) mod kernels;
pub(crate) mod layout;
pub(crate) mod levels;
pub(crate) mod prefetch;
pub(crate) mod sample;
pub(crate) mod sent;
pub(crate) mod spawn_wedge;
pub(crate) mod store;
