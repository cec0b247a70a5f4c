//! Meshes of models of the oracle, for tests of the crates that solve on them.

use geobench_mesh::{InvalidMesh, Mesh, TriangleSoup};
use geobench_oracle::{Geometry, Model};

/// The mesh of `model`, as the library builds it.
pub(crate) fn mesh_of(model: &Model) -> Result<Mesh, InvalidMesh> {
    let triangles = model.triangles.clone();
    let built = match &model.geometry {
        Geometry::Positions(positions) => {
            Mesh::from_soup(TriangleSoup::new(positions.clone(), triangles))
        }
        Geometry::Lengths(lengths) => Mesh::from_lengths(model.vertex_count, &triangles, lengths),
    };
    built.map(|(mesh, _)| mesh)
}
