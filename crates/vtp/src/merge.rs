//! Merging of arriving windows into a list that waits on the wavefront.

/// How a *secondary* merge is made: windows that crossed a face of the traversed area join a list
/// that has waited since the step in which that face joined. Prime merges, those within that step,
/// need no choice: left children, then right children, is the order of their rays.
pub trait Merge: Send {
    /// Whether windows are put in their places by the left ends of their intervals.
    const PRESERVES_ORDER: bool;
}

/// Behind those that came the same way (Qin et al. 2016, section 5.1, order-free merger).
#[derive(Clone, Copy, Debug)]
pub struct OrderFree;

impl Merge for OrderFree {
    const PRESERVES_ORDER: bool = false;
}

/// By the left end of the interval (Qin et al. 2016, section 5.1, order-preserving merger), so that
/// neighbours in the list are neighbours on the edge. The paper finds the place by binary search;
/// here it is found on the way on which the windows behind it make room.
#[derive(Clone, Copy, Debug)]
pub struct OrderPreserving;

impl Merge for OrderPreserving {
    const PRESERVES_ORDER: bool = true;
}
