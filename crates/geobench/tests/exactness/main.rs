//! Tests that every exact algorithm of the registry is exact.
//!
//! Each algorithm is compared with formulas, with an oracle that shares no code with it, with
//! distances from independent programs, and with itself on different meshes of the same surface.
//! New algorithms of the registry are included automatically. A failure names the model, the
//! algorithm, the source, the worst vertex and both values.

mod chains;
mod disguises;
mod formulas;
mod goals;
mod invariants;
mod models;
mod points;
mod support;
mod surfaces;
mod zoo;
