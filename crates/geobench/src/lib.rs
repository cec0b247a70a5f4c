//! The library of the `geobench` binary.
//!
//! [`cli`] turns the command line into a [`plan`] of cells, and [`run`] executes it. [`exec`] loads
//! the models and makes each run with a solver from the [`registry`]. [`run`] compares every answer
//! with a reference. [`measure`] summarises the times. [`schema`] defines the result file,
//! [`table`] and [`report`] show it, and [`history`] compares several of them. `ARCHITECTURE.md`
//! has an overview of all modules.

#![cfg_attr(not(feature = "command-line"), allow(dead_code, unused_imports))]

#[cfg(feature = "command-line")]
pub mod cli;
pub mod exec;
#[cfg(feature = "command-line")]
pub mod history;
pub mod measure;
pub mod plan;
#[cfg(feature = "command-line")]
pub mod report;
pub mod run;
pub mod schema;
#[cfg(feature = "command-line")]
pub mod table;
mod usage;

pub use geobench_registry as registry;
pub use usage::{DocumentError, UsageError};
