//! MMP with all due windows of a half-edge propagated together.
//!
//! Distances do not depend on the order in which windows are taken. The rounds of FWP and the
//! vertex order of VTP leave the order within a round open, and a priority queue can accept some
//! slack. The windows of one list can then be propagated together: they lie next to each other in
//! memory, cross the same triangle, and reach each exit nearly in order, so that one sweep merges
//! them into the list there. The queue holds lists instead of windows. A batch has two windows on
//! average on models of some thousands of faces, and six to eight on scans.
//!
//! Trimming and eviction are those of the [single form](crate::Trimming), by the same code.
//! Without the [filter](Batched::filtering) a run on the horse takes 0.47 of the time of the
//! single form under vertex order and label correcting, 0.58 under buckets, and 0.5 under a
//! [priority queue with slack](NearestLists). Without slack a batch is one window, and a run takes
//! 1.1 to 1.8 times as long as in the single form, because every batch scans its list.

mod merge;
mod nearest;
mod prefilter;
mod propagation;
mod store;

pub use nearest::NearestLists;
pub use propagation::Batched;
