//! Windows on half-edges: their geometry, and the parts that all solvers share.
//!
//! A *window* is a cone of straight paths from a source, or from a vertex at which paths turn (a
//! *pseudo-source*), through an interval of a half-edge. All faces that the paths have crossed are
//! unfolded into the plane of the half-edge's frame, where the source has an image below the edge.
//! A [`Window`] stores that image, the interval, and the distance σ from the source to the
//! pseudo-source. Crossing a triangle ([`Crossing`]) turns a window into up to two windows on the
//! other edges, and offers a distance to the vertex between them. All exact algorithms of this
//! suite consist of such crossings. They differ in the windows that they delete, and in the order
//! in which they take the others.
//!
//! * The kernels are small pure functions: [`Crossing`], [`tie_points`], the vertex filter
//!   ([`is_beaten_from_ends`]), [`spawn_window`]. They avoid square roots and angles. All
//!   tolerances are relative, so a model in millimetres gives the same digits as in metres.
//! * [`Faces`] is the layout of a mesh for crossing. It has the [`Frame`] of each half-edge.
//! * [`continuous`] is the frame of the algorithms that take one window at a time: a policy under a
//!   [discipline](queue::Discipline).
//! * [`Solver`] is the interface for callers. An algorithm implements [`Propagate`]: one run,
//!   generic over a [`Probe`]. The probe `()` observes nothing and costs nothing. Others count,
//!   record the origins of paths, or show the current phase to a [`PhaseSampler`].
//! * [`blocks`] is the memory of stored lists, [`trimming`] the comparison of stored windows.

pub mod blocks;
mod connected;
pub mod continuous;
mod counters;
mod crossing;
mod crossings;
mod filter;
mod frame;
mod goal;
mod origins;
mod phases;
mod points;
pub mod precision;
mod prefetch;
mod probe;
pub mod queue;
mod rays;
pub mod simd;
mod solver;
mod spawn;
mod tie;
pub mod trimming;
mod wavefront;
mod window;

pub use connected::{reach_along_edge, reach_over_edges};
pub use counters::{Counter, Counters};
pub use crossing::{Crossing, length_past_end};
pub use crossings::{CrossedChild, Crossings, LANES};
pub use filter::{VertexFilter, is_beaten_from_ends};
pub use frame::{EdgePath, Exit, ExitEdge, FaceView, Faces, Frame, HalfEdgeBeyond, Side};
pub use goal::{EndCheck, Goal, Stop};
pub use origins::{Origin, Origins, Way};
pub use phases::{PhaseProbe, PhaseSampler, Phases};
pub use points::at_points;
pub use prefetch::{prefetch, prefetch_line};
pub use probe::{Count, Phase, Probe};
pub use rays::{Beam, CrossedRays, Rays};
pub use solver::{
    CompiledRuns, Observer, Propagate, Solution, SolveError, Solver, Sources, check_sources,
};
pub use spawn::spawn_window;
pub use tie::{TiePoints, tie_points};
pub use wavefront::{FrontWindow, Fronts, WavefrontMoment, WavefrontRecord};
pub use window::Window;
