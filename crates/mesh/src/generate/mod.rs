//! Procedural models: a short spec such as `gen:torus,faces=50000,bump=0.1,seed=7` names one mesh.
//!
//! A spec is `gen:FAMILY[,key=value...]`. [`FAMILIES`] and [`MODIFIER_KEYS`] are the one list of
//! what there is, with defaults, ranges and descriptions; parsing, errors and [`help`] read it. The
//! text of a [`Spec`] is its canonical form, with every default written out, so it keeps its
//! meaning even if a default changes.
//!
//! # Same spec, same bits
//!
//! A spec gives the same coordinates, bit for bit, on every machine: chance comes from a generator
//! of our own, angles from `libm` in pure Rust, and everything else from operations that IEEE 754
//! defines to the last bit. Tests pin a checksum of every family.
//!
//! Every model is an oriented manifold, outward where it is closed, without isolated vertices.
//! Modifiers act in the order parts, subdivide, noise, scale, on generated models and on files
//! alike:
//!
//! ```
//! use geobench_mesh::generate::{Spec, generate};
//!
//! let spec: Spec = "gen:sphere,subdiv=1,subdivide=1,noise=0.1,seed=3".parse()?;
//! assert_eq!(spec.to_string(), "gen:sphere,subdiv=1,subdivide=1,noise=0.1,seed=3");
//! assert_eq!(generate(&spec)?.triangles.len(), 320);
//!
//! // For a file the caller reads it and the spec does the rest.
//! let spec: Spec = "gen:file,path=cow.off,subdivide=2".parse()?;
//! let loaded = generate(&"gen:cube,n=1".parse()?)?; // Stands for reading `spec.path()`.
//! assert!(spec.path().is_some());
//! assert_eq!(spec.modifiers().apply(loaded)?.triangles.len(), 12 * 16);
//! # Ok::<(), geobench_mesh::generate::GenerateError>(())
//! ```

mod anisotropic;
mod block;
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

pub use anisotropic::mean_anisotropy;
pub use error::GenerateError;
pub use families::{FAMILIES, Family, Seeding, help};
pub use keys::{Key, Kind};
pub use modifiers::{MODIFIER_KEYS, Modifiers};
pub use noise::add_noise;
pub use spec::{Spec, generate};
pub use subdivide::midpoint_subdivide;

/// The most triangles a spec may ask for: some 2 GB of mesh, and within 32-bit half-edge numbers.
pub const MAX_FACES: u64 = 50_000_000;
