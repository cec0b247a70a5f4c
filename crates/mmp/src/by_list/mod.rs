//! A list at a time: the windows of a half-edge cross its face together.
//!
//! No answer depends on the order in which windows are taken. Rounds and vertices leave it open
//! within what they take, and a queue by distance can be given some slack; then the windows of one
//! list are best taken together. They lie in one piece of memory and go through the same triangle,
//! what they leave on each of its exits is nearly in order, and one sweep merges that into the list
//! there. The queue holds lists, and is as many times shorter as there are windows in a turn: two
//! on models of some thousands of faces, six to eight on scans.
//!
//! How windows are trimmed and when they are given up is the same as where they are taken [one by
//! one](crate::Trimming), and is one code. Without the [filter](ByList::filtering), beside vertex
//! order this needs 0.47 of the time on the horse, beside buckets 0.58, beside label correcting
//! 0.47, and 0.5 where a [priority queue](NearLists) gives some slack; without slack, at one window
//! a turn, it takes 1.1 to 1.8 times as long as one by one, since a turn looks at a whole list.

mod merge;
mod near;
mod propagation;
mod sieve;
mod store;

pub use near::NearLists;
pub use propagation::ByList;
