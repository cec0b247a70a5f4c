//! The library behind the `geobench` binary.
//!
//! [`cli`] turns the command line into a [`plan`] of cells, and [`run`] carries it out: [`exec`]
//! loads the models and makes each run with a solver from the [`registry`], [`run`] compares every
//! answer with a reference, and [`measure`] summarises the times. The result file is defined in
//! [`schema`]; [`table`] and [`report`] show it, and [`history`] compares several of them.
//! `ARCHITECTURE.md` has the whole map.

pub mod cli;
pub mod exec;
pub mod history;
pub mod measure;
pub mod plan;
pub mod registry;
pub mod report;
pub mod run;
pub mod schema;
pub mod table;
mod usage;

pub use usage::{DocumentError, UsageError};
