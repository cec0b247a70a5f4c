//! Procedural models: a short spec such as `gen:torus,faces=50000,bump=0.1,seed=7` names a mesh.
//!
//! A spec is `gen:FAMILY[,key=value...]`. [`FAMILIES`] and [`MODIFIER_KEYS`] list all families and
//! keys, with defaults, ranges and descriptions. Parsing, errors and [`help`] use these lists. The
//! text of a [`Spec`] is its canonical form, with every default written out, so it keeps its
//! meaning if a default changes.
//!
//! # Same spec, same bits
//!
//! A spec gives the same coordinates, bit for bit, on every machine. Random numbers come from
//! [`SplitMix64`](crate::SplitMix64), angles from `libm` in pure Rust, and everything else from
//! operations that IEEE 754 defines to the last bit. Tests pin a checksum of every family.
//!
//! Every model is an oriented manifold without isolated vertices. Closed models face outwards.
//! Modifiers act in the order parts, subdivide, noise, scale, on generated models and on files:
//!
//! ```
//! use geobench_mesh::generate::{Spec, generate};
//!
//! let spec: Spec = "gen:sphere,subdiv=1,subdivide=1,noise=0.1,seed=3".parse()?;
//! assert_eq!(spec.to_string(), "gen:sphere,subdiv=1,subdivide=1,noise=0.1,seed=3");
//! assert_eq!(generate(&spec)?.triangles.len(), 320);
//!
//! // The caller reads a file. The spec does the rest.
//! let spec: Spec = "gen:file,path=cow.off,subdivide=2".parse()?;
//! let loaded = generate(&"gen:cube,n=1".parse()?)?; // Stands for reading `spec.path()`.
//! assert!(spec.path().is_some());
//! assert_eq!(spec.modifiers().apply(loaded)?.triangles.len(), 12 * 16);
//! # Ok::<(), geobench_mesh::generate::GenerateError>(())
//! ```

mod anisotropic;
mod block;
mod corridor;
mod error;
mod families;
mod keys;
mod knot;
mod lattice;
mod modifiers;
mod noise;
mod parts;
mod plate;
mod revolve;
mod solid;
mod spec;
mod subdivide;
mod terrain;
mod torus;
mod turn;

pub use error::GenerateError;
pub use families::{FAMILIES, Family, Seeding, help};
pub use keys::{Key, Kind};
pub use modifiers::{MODIFIER_KEYS, Modifiers};
pub use noise::add_noise;
pub use spec::{Spec, generate};
pub use subdivide::midpoint_subdivide;

/// The most triangles of a spec. They take some 2 GB as a mesh, and have 32-bit half-edge numbers.
pub const MAX_FACES: u64 = 50_000_000;
