//! The passes over a list of windows, written once over [`Lanes`](geobench_window::simd::Lanes).
//!
//! | kernel | what it does | rules |
//! |---|---|---|
//! | [`gather`] | brings the lists of a half-edge together | vertex filter |
//! | [`compare()`] | cuts neighbours that lose to each other, all at once | 2 and 3 |
//! | [`settle()`] | the same until all neighbours stay | 2 and 3 |
//! | [`measure()`] | counts the windows for each exit, finds the shortest path to the apex | vertex filter, if asked |
//! | [`carry()`] | takes the windows across the face | 1 and others, see [`exits`] |

mod carry;
pub(crate) mod chunks;
mod columns;
mod compare;
pub(crate) mod exits;
mod filter;
mod measure;
mod settle;
#[cfg(test)]
mod tests;
mod trim;

pub(crate) use carry::{Carried, Target, Triangle, carry};
pub(crate) use compare::{Cuts, compare};
pub(crate) use exits::{AllowedAngle, BestPath};
pub(crate) use filter::{Gate, LOSES, gather};
pub(crate) use measure::{Measured, measure};
pub(crate) use settle::settle;
