//! The passes over a list of windows, written once over [`Lanes`](super::lanes::Lanes).
//!
//! | kernel | what it does | rules |
//! |---|---|---|
//! | [`compare`] | cuts neighbours that lose to each other | 2 and 3 |
//! | [`measure()`] | filters, counts who goes where, finds the shortest path to the apex | vertex filter |
//! | [`carry()`] | takes the windows across the face | 1 |

#![allow(unsafe_code)]

mod carry;
mod columns;
mod compare;
mod measure;

pub(crate) use carry::{BestPath, Target, Triangle, carry};
pub(crate) use compare::{Cuts, compare};
pub(crate) use measure::{Gate, MARGIN, Measured, measure};
