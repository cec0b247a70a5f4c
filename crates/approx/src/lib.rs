//! Approximate geodesic distances on triangle meshes: what exact algorithms are compared with.
//!
//! None of these algorithms is a reference, and tables mark them as approximate.

mod relayed;
mod svg;

pub use relayed::{Avtp, MmpApprox, avtp, mmp_approx};
pub use svg::{SaddleVertexGraph, SvgBuilder, SvgOptions};
