//! The library behind the `geobench` binary.

pub mod registry;
mod stand_in;
