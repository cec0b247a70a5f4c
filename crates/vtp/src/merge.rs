//! Merging of arriving windows into a list that waits on the wavefront.

/// How a *secondary* merge is made: windows that crossed a face of the traversed area join a list
/// that has waited since the step in which that face joined. Prime merges, those within that step,
/// need no choice: left children before right children is the order of their rays.
pub trait Merge: Send {
    /// Whether windows are inserted in ascending order of the left ends of their intervals.
    const PRESERVES_ORDER: bool;
}

/// Appends to the windows of the same side (Qin et al. 2016, section 5.1, order-free merger).
#[derive(Clone, Copy, Debug)]
pub struct OrderFree;

impl Merge for OrderFree {
    const PRESERVES_ORDER: bool = false;
}

/// Inserts by the left end of the interval, so that neighbours in the list are neighbours on the
/// edge (Qin et al. 2016, section 5.1, order-preserving merger). The paper finds the position by
/// binary search. Here it is found while the windows behind it are moved.
#[derive(Clone, Copy, Debug)]
pub struct OrderPreserving;

impl Merge for OrderPreserving {
    const PRESERVES_ORDER: bool = true;
}
