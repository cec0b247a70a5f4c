//! Programs of other people as algorithms: `ext:NAME`.
//!
//! A table `[ext.NAME]` in a TOML file (`file`) says how a program, or more often a small adapter
//! around a library, is called. It loads the model itself, is asked for one solve after another,
//! times each by its own clock and writes the distances to a file; `bench-configs/PEERS.md`
//! describes the protocol (`message` and `worker` are our side of it). To the rest of the program it is an
//! algorithm: its runs take their turns with those of the others, its answers are checked like
//! theirs, and what becomes of it stands in the same rows.
//!
//! An outside program always has a process of its own, within the same limits of time and memory as the
//! processes of [`crate::exec::isolate`], wherever the algorithms of the suite run: [`WithPrograms`] is a
//! workplace around theirs.

mod answer;
mod message;
mod place;
mod worker;

pub use place::WithPrograms;
