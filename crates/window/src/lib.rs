//! Windows on half-edges: their geometry, and what every solver shares.

pub mod continuous;
mod counters;
mod cross;
mod filter;
mod frame;
mod probe;
pub mod queue;
mod solver;
mod spawn;
mod tie;
mod wavefront;
mod window;

pub use counters::{Counter, Counters};
pub use cross::{apex_distance, left_child, right_child, separating_abscissa};
pub use filter::{is_beaten_across, is_beaten_from_ends};
pub use frame::{Faces, Frame};
pub use probe::{Clock, Count, Phase, Phases, Probe};
pub use solver::{Propagate, Solution, SolveError, Solver};
pub use spawn::spawn_window;
pub use tie::{TiePoints, tie_points};
pub use window::Window;
