//! A list at a time: the windows of a half-edge cross its face together.
//!
//! Where the order of windows is free within a round, as it is in the fast wavefront propagation framework, those of one list
//! are best taken together. They lie in one piece of memory and go through the same triangle, what they leave on each of
//! its exits is nearly in order, and one pass merges that into the list there. A queue of lists is as many times shorter
//! as there are windows in a turn: two on models of some thousands of faces, six to eight on scans.
//!
//! Which windows there are, how they are trimmed and when they are given up is the same as where they are taken [one
//! by one](crate::Trimming): what is compared, and how, is one code.

mod merge;
mod near;
mod propagation;
mod store;

pub use near::NearLists;
pub use propagation::ByList;
