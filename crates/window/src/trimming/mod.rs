//! Windows of one half-edge trimmed against each other where they tie, as in MMP.
//!
//! A range that two windows share goes to the one that is shorter there. Where both are equal, the
//! first one keeps it, unless it is an older window of the same source. The MMP crate stores whole
//! lists by these rules. [`KeptWindows`] does so beside thin faces, for algorithms that store no
//! windows.

mod compare;
mod foot;
mod kept;
mod overlap;
mod overlap_range;
mod thin;

pub use compare::{ShorterPart, is_sliver, matters, ties_between};
pub use foot::{foot, pieces};
pub use kept::KeptWindows;
pub use overlap::{Overlap, Owner, Segment};
pub use overlap_range::OverlapRange;
pub use thin::ThinFaces;
