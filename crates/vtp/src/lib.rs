//! The VTP family: whole lists of windows cross triangles together.
//!
//! Qin, Han, Yu, Yu and Zhang, "Fast and exact discrete geodesic computation based on
//! triangle-oriented wavefront propagation" (2016). Instead of taking windows one by one, these
//! algorithms grow a *traversed area* of faces. The windows that wait to enter a face through one
//! of its half-edges form a list; once the face is in the area the list crosses it as a whole,
//! which brings windows together that can be compared pair by pair. What leaves the area waits on
//! its border, the wavefront; what comes back into it crosses on. Nothing else is kept.
//!
//! # One frame, four choices
//!
//! Every algorithm of the family is a [`ListPropagation`] with four choices made, none of which
//! changes a distance:
//!
//! | choice | trait | taken |
//! |---|---|---|
//! | which faces join the area next | [`Schedule`] | [`NearestVertex`], [`NearestFace`] |
//! | how windows join a waiting list | [`Merge`] | [`OrderFree`], [`OrderPreserving`] |
//! | which windows of a list are compared | [`Pairs`] | [`Neighbours`] (rules 2 and 3), [`NoPairs`], [`AllPairs`], [`TiePoints`] |
//! | through which exits a window may leave | [`Exits`] | [`OneAngleTwoSides`] (rule 1), [`AnyExit`], [`AcrossTheFace`], [`EveryPath`] |
//!
//! Common to all is the vertex filter, which drops windows that a path through a known vertex beats
//! ([`geobench_window::is_beaten_from_ends`] in plain form): without it windows behind the
//! wavefront, which meet no other ones, would never end.
//!
//! [`algorithms`] has a page for each combination that has a name. Another one is a type:
//! `ListPropagation::<NearestFace, OrderFree, NoPairs, AnyExit>::new(&mesh)`.
//!
//! # For speed
//!
//! All of this stands on one `engine`: lists are structures of arrays, and what is done with a list
//! is a pass over registers of up to eight windows ([`geobench_window::simd`]). [`VtpFast`] is VTP with
//! every further improvement that keeps it exact; see [its page](algorithms::vtp_fast). [`Pvtp`] is
//! the same on several threads; see [its page](algorithms::pvtp).
//!
//! # Every deletion is beyond doubt
//!
//! A window or a part of one goes only if a real path is shorter by more than 1e-12 of its length
//! where the two cross, and only if that they cross does not hang on rounding. Equal windows keep
//! each other. So the rules can be switched on and off one by one, and the distances stay the same;
//! where they do not, the rule is wrong.

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
mod trim;
mod wavefront;

pub mod algorithms;

pub use algorithms::{
    EdgeBased, Ftp, Opftp, Opvtp, Vtp, VtpExhaustive, VtpNoRule1, VtpNoRules23, VtpTrimming,
};
#[doc(hidden)]
pub use engine::bench_support;
pub use exits::{AcrossTheFace, AnyExit, EveryPath, Exits, OneAngleTwoSides};
pub use fast::{Options as FastOptions, VtpFast};
pub use merge::{Merge, OrderFree, OrderPreserving};
pub use parallel::Pvtp;
pub use propagation::ListPropagation;
pub use pruning::{AllPairs, Neighbours, NoPairs, Pairs, TiePoints};
pub use schedule::{NearestFace, NearestVertex, Schedule};
