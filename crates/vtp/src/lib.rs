//! The VTP family: whole lists of windows cross triangles together.

mod area;
mod exits;
mod lists;
mod merge;
mod orient;
mod pairs;
mod propagation;
mod pruning;
mod schedule;
mod sides;
mod trim;

pub use exits::{AcrossTheFace, AnyExit, EveryPath, Exits, OneAngleTwoSides};
pub use merge::{Merge, OrderFree, OrderPreserving};
pub use propagation::ListPropagation;
pub use pruning::{AllPairs, Neighbours, NoPairs, Pairs, TiePoints};
pub use schedule::{NearestFace, NearestVertex, Schedule};

/// VTP.
pub type Vtp<'m> = ListPropagation<'m, NearestVertex, OrderFree, Neighbours, OneAngleTwoSides>;
pub type Opvtp<'m> = ListPropagation<'m, NearestVertex, OrderPreserving, Neighbours, OneAngleTwoSides>;
pub type Ftp<'m> = ListPropagation<'m, NearestFace, OrderFree, Neighbours, OneAngleTwoSides>;
pub type Opftp<'m> = ListPropagation<'m, NearestFace, OrderPreserving, Neighbours, OneAngleTwoSides>;
pub type Exhaustive<'m> = ListPropagation<'m, NearestVertex, OrderFree, AllPairs, EveryPath>;
pub type Trimming<'m> = ListPropagation<'m, NearestVertex, OrderFree, TiePoints, OneAngleTwoSides>;
pub type NoRule1<'m> = ListPropagation<'m, NearestVertex, OrderFree, Neighbours, AnyExit>;
pub type NoRules23<'m> = ListPropagation<'m, NearestVertex, OrderFree, NoPairs, OneAngleTwoSides>;
pub type EdgeBased<'m> = ListPropagation<'m, NearestVertex, OrderFree, Neighbours, AcrossTheFace>;
