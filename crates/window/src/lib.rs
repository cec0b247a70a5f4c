//! Windows on half-edges: their geometry, and what every solver shares.

mod counters;
mod probe;
mod solver;

pub use counters::{Counter, Counters};
pub use probe::{Clock, Count, Phase, Phases, Probe};
pub use solver::{Propagate, Solution, SolveError, Solver};
