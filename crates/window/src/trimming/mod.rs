//! Windows of one half-edge trimmed against each other where they tie, as in MMP.
//!
//! A range that two windows share goes to the one that is shorter there. Where both are equal, the
//! first one keeps it, unless it is an older window of the same source. [`Trimmer`] inserts windows
//! into lists by these rules: those of MMP and of Voronoi diagrams, and the [`KeptWindows`] beside
//! thin faces, for algorithms that store no others.

mod compare;
mod contender;
mod foot;
mod groups;
mod insertion;
mod kept;
mod overlap;
mod overlap_range;
mod thin;

pub use compare::{is_sliver, ties_between};
pub use foot::{closing_gaps, is_near, pieces};
pub use insertion::{PieceOrigin, TrimmedList, Trimmer};
pub use kept::KeptWindows;
pub use overlap::{Overlap, Owner, Segment};
pub use thin::ThinFaces;
