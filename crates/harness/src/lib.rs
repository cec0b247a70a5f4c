//! The harness of `geobench`: plans, runs, checks and measures algorithms for geodesic distances.
//!
//! A [`plan`] has the cells of a benchmark, and [`run`] executes it. [`exec`] loads the models and
//! makes each run with a solver from the registry: in this process, in a child process or in an
//! external program. [`run`] compares every answer with a reference. [`measure`] summarises the
//! times. [`schema`] defines the result file and [`figures`] the figures of a cell.

mod children;
pub mod exec;
pub mod figures;
mod lock;
pub mod measure;
pub mod plan;
pub mod run;
pub mod schema;
pub mod usage;

pub use geobench_registry::UsageError;
pub use usage::DocumentError;
