//! Windows on half-edges: their geometry, and the parts that all solvers share.
//!
//! A *window* is a cone of straight paths from a source, or from a vertex at which paths turn (a
//! *pseudo-source*), through an interval of a half-edge. Unfolded into the plane of the frame of
//! that half-edge, all faces that the paths have crossed lie flat, and the source has an image
//! below the edge: a [`Window`] is that image, the interval, and the distance σ up to the
//! pseudo-source. Crossing a triangle turns it into up to two windows on the other edges
//! ([`left_child`], [`right_child`]) and offers a distance to the vertex between them
//! ([`apex_distance`]). Every exact algorithm of this suite consists of such crossings; they differ
//! in the windows that they can prove useless, and in the order in which they take the others.
//!
//! * The kernels are small pure functions: [`separating_abscissa`], the two children, the apex
//!   distance, these three together as [`Crossing`], [`tie_points`], the vertex filter
//!   ([`is_beaten_from_ends`]), [`spawn_window`]. They avoid square
//!   roots and angles, and all tolerances are relative, so that a model in millimetres gives the
//!   same digits as in metres.
//! * [`Faces`] lays the mesh out for crossing, and gives the [`Frame`] of a half-edge.
//! * [`continuous`] is the frame of the algorithms that take one window at a time: a policy under a
//!   [discipline](queue::Discipline).
//! * [`Solver`] is the interface for callers. An algorithm implements [`Propagate`]: one run,
//!   generic over a [`Probe`] that observes nothing (and costs nothing), counts, or tells its phase
//!   to a [`PhaseSampler`].

pub mod continuous;
mod counters;
mod cross;
mod crossing;
mod crossings;
mod filter;
mod frame;
mod goal;
mod origins;
mod phases;
pub mod precision;
mod prefetch;
mod probe;
pub mod queue;
pub mod simd;
mod solver;
mod spawn;
mod tie;
pub mod trimming;
mod wavefront;
mod window;

pub use counters::{Counter, Counters};
pub use cross::{apex_distance, left_child, right_child, separating_abscissa};
pub use crossing::{Crossing, length_past_end};
pub use crossings::{CrossedChild, Crossings, LANES};
pub use filter::{VertexFilter, is_beaten_from_ends};
pub use frame::{EdgePath, Exit, ExitEdge, FaceView, Faces, Frame, Side};
pub use goal::{Goal, Lookout, Stop};
pub use origins::{Origin, Origins, Way};
pub use phases::{PhaseProbe, PhaseSampler, Phases};
pub use prefetch::{prefetch, prefetch_line};
pub use probe::{Count, Phase, Probe};
pub use solver::{Propagate, Solution, SolveError, Solver, Sources};
pub use spawn::spawn_window;
pub use tie::{TiePoints, tie_points};
pub use wavefront::WavefrontRecord;
pub use window::Window;
