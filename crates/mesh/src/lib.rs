//! Half-edge triangle meshes for geodesic distances: files, validation, generators.

mod build;
mod defect;
mod disjoint_sets;
mod edges;
mod frames;
pub mod generate;
mod ids;
mod inspection;
pub mod io;
mod measure;
mod mesh;
mod orient;
mod report;
mod sanity;
mod soup;
mod validate;

pub use defect::{Defect, DefectKind, LONGEST_EDGE, SHORTEST_EDGE, Severity};
pub use ids::{FaceId, HalfEdgeId, VertexId};
pub use measure::MeshMeasures;
pub use mesh::Mesh;
pub use report::{InvalidMesh, Report, Summary};
pub use sanity::BrokenInvariant;
pub use soup::TriangleSoup;
