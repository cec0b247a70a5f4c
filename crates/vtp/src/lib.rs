//! The VTP family: lists of windows cross triangles as a whole.
//!
//! Qin, Han, Yu, Yu and Zhang, "Fast and exact discrete geodesic computation based on
//! triangle-oriented wavefront propagation" (2016). These algorithms grow a *traversed area* of
//! faces. The windows that wait to enter a face through one of its half-edges form a list. Once the
//! face is in the area, the list crosses it as a whole, and its windows are compared pair by pair.
//! Windows that leave the area wait on its border, the wavefront. Windows that return into the area
//! cross at once. No other windows are stored.
//!
//! ```
//! use geobench_mesh::Mesh;
//! use geobench_vtp::VtpFast;
//! use geobench_window::Solver;
//!
//! let mesh = Mesh::generate("terrain,n=8,seed=1")?;
//! let mut solver = VtpFast::new(&mesh);
//! let (from_5, from_6) = (solver.distances_from(5)?, solver.distances_from(6)?);
//! assert!((from_5[6] - from_6[5]).abs() <= 1e-12 * from_5[6]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # One frame, four choices
//!
//! [`VtpFast`] is the fastest solver on one thread, and [`Pvtp`] runs it on several. Every other
//! algorithm of the family is a [`ListPropagation`] with four choices. No choice changes a
//! distance:
//!
//! | choice | trait | values |
//! |---|---|---|
//! | which faces join the area next | [`Schedule`] | [`NearestVertex`], [`NearestFace`] |
//! | how windows join a waiting list | [`Merge`] | [`OrderFree`], [`OrderPreserving`] |
//! | which windows of a list are compared | [`Pairs`] | [`Neighbours`] (rules 2 and 3), [`NoPairs`], [`AllPairs`], [`TrimmedNeighbours`] |
//! | through which exits a window may leave | [`Exits`] | [`OneAngleTwoSides`] (rule 1), [`AnyExit`], [`AcrossTheFace`], [`EveryPath`] |
//!
//! All algorithms use the vertex filter, which drops windows that a path through a known vertex
//! beats ([`geobench_window::is_beaten_from_ends`] in scalar form). Without it, windows behind the
//! wavefront, which meet no others, would never end.
//!
//! [`Vtp`] and the other aliases name combinations. Other combinations can be written out:
//! `ListPropagation::<NearestFace, OrderFree, NoPairs, AnyExit>::with_choices(&mesh)`.
//!
//! # Vector instructions
//!
//! Lists are structures of arrays. Each pass over a list works on registers of up to eight windows
//! ([`geobench_window::simd`]).
//!
//! # Exactness
//!
//! A window or a part of it is deleted only if a real path is shorter by more than 1e-12 of its
//! length at their crossing, and only if the crossing does not depend on rounding. Equal windows
//! keep each other. So each rule can be switched off without changing distances. If distances
//! change, the rule is wrong.

mod crossing;
mod engine;
mod exits;
mod fast;
mod front;
mod merge;
mod orient;
mod pairs;
mod parallel;
mod precision;
mod propagation;
mod pruning;
mod schedule;
mod tally;
mod trim;
mod variants;
mod wavefront;

pub use exits::{AcrossTheFace, AnyExit, EveryPath, Exits, OneAngleTwoSides};
pub use fast::{FastOptions, VtpFast};
pub use merge::{Merge, OrderFree, OrderPreserving};
pub use parallel::Pvtp;
pub use propagation::ListPropagation;
pub use pruning::{AllPairs, Neighbours, NoPairs, Pairs, TrimmedNeighbours};
pub use schedule::{NearestFace, NearestVertex, Schedule};
pub use variants::{
    EdgeBased, Ftp, Opftp, Opvtp, Vtp, VtpExhaustive, VtpNoRule1, VtpNoRules23, VtpTrimming,
};
