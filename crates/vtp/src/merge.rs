//! How windows join those that wait on the wavefront already.

use geobench_mesh::HalfEdgeId;
use geobench_window::Window;

use crate::lists::{Arrival, WindowLists};

/// How a *secondary* merge is made: windows that crossed a face of the traversed area join a list
/// that has waited since the step in which that face joined. Prime merges, those within that step,
/// need no choice: left children, then right children, is the order of their rays.
pub trait Merge: Send {
    /// Whether it makes a difference which merges are secondary.
    const PRESERVES_ORDER: bool;

    /// Adds `window`, which came to `h` in a secondary merge.
    fn add(lists: &mut WindowLists, h: HalfEdgeId, arrival: Arrival, window: Window);
}

/// Behind those that came the same way (Qin et al. 2016, section 5.1, order-free merger).
#[derive(Clone, Copy, Debug)]
pub struct OrderFree;

impl Merge for OrderFree {
    const PRESERVES_ORDER: bool = false;

    #[inline]
    fn add(lists: &mut WindowLists, h: HalfEdgeId, arrival: Arrival, window: Window) {
        lists.push(h, arrival, window);
    }
}

/// By the left end of the interval, found by binary search (Qin et al. 2016, section 5.1,
/// order-preserving merger), so that neighbours in the list are neighbours on the edge.
#[derive(Clone, Copy, Debug)]
pub struct OrderPreserving;

impl Merge for OrderPreserving {
    const PRESERVES_ORDER: bool = true;

    fn add(lists: &mut WindowLists, h: HalfEdgeId, _: Arrival, window: Window) {
        lists.insert_in_order(h, window);
    }
}
