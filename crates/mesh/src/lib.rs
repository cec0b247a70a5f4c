//! Half-edge triangle meshes for geodesic distances: files, validation, generators.

mod build;
mod edges;
pub mod generate;
mod ids;
pub mod io;
mod mesh;
mod soup;
mod validate;

pub use ids::{FaceId, HalfEdgeId, VertexId};
pub use mesh::Mesh;
pub use soup::TriangleSoup;
pub use validate::{Defect, InvalidMesh, Report};
