//! The library behind the `geobench` binary.
//!
//! A run goes through these modules in this order: [`cli`] turns the command line into a
//! [`plan`]; the [`benchmark`] carries it out, cell by cell, on models that [`model`] loads and with
//! solvers that come from the [`registry`]; every answer is compared with a reference
//! ([`check`], [`expected`]), repeated times are summarised ([`statistics`]), and the
//! [`record`]s go to the [`export`] formats. `ARCHITECTURE.md` has the whole map.

pub mod affinity;
mod agreement;
pub mod benchmark;
pub mod check;
pub mod cli;
pub mod compare;
pub mod conditions;
mod difference;
pub mod expected;
pub mod export;
pub mod field;
mod group;
pub mod host;
pub mod in_process;
pub mod instructions;
pub mod interrupt;
pub mod isolate;
pub mod journal;
pub mod ledger;
pub mod limits;
pub mod memory;
pub mod merge;
pub mod model;
mod order;
pub mod output;
pub mod outside;
pub mod plan;
pub mod plan_record;
pub mod pool;
pub mod record;
pub mod registry;
#[cfg(test)]
mod rehearsal;
pub mod report;
pub mod result_file;
mod rng;
pub mod runner;
#[cfg(test)]
mod runner_tests;
pub mod shard;
pub mod source;
pub mod statistics;
pub mod suite;
mod wire;
