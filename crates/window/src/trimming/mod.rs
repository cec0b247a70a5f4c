//! Windows of one half-edge trimmed against each other where they tie, as in MMP.
//!
//! A range that two windows share goes to the one that is shorter there; the one that was first
//! keeps what both offer alike. The MMP crate keeps whole lists by these rules, [`KeptWindows`]
//! those beside thin faces for the algorithms that keep none.

mod division;
mod duel;
mod foot;
mod kept;
mod thin;

pub use division::{Division, Owner, Segment};
pub use duel::{Duel, is_sliver, matters, ties_between};
pub use foot::{foot, pieces};
pub use kept::KeptWindows;
pub use thin::ThinFaces;
