//! Whether every exact algorithm of the registry is exact.
//!
//! Each algorithm runs against formulas, against an oracle that shares no code with it, against
//! distances from independent programs, and against itself on surfaces that are the same in
//! disguise. An algorithm that joins the registry is tested without a word here. A failure names
//! the model, the algorithm, the source, the worst vertex and both values.

mod disguises;
mod formulas;
mod goals;
mod invariants;
mod models;
mod points;
mod support;
mod surfaces;
mod zoo;
