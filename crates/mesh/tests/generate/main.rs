//! Generated models: every family's surface, the language of specs, modifiers, pinned bits.

mod modifiers;
mod pinned;
mod shapes;
mod spec;
mod surface;

use geobench_mesh::TriangleSoup;
use geobench_mesh::generate::{Spec, generate};

/// The model of a spec that must be right.
fn model(spec: &str) -> TriangleSoup {
    let spec: Spec = spec.parse().unwrap_or_else(|e| panic!("{spec}: {e}"));
    generate(&spec).unwrap_or_else(|e| panic!("{spec}: {e}"))
}
