//! A distance field on its mesh as binary PLY.

use geobench_mesh::VertexId;
use geobench_mesh::io::PlyWriter;

use super::DistanceField;
use super::ramp::colours;

/// The mesh with `quality`, the name under which mesh programs know a vertex scalar, and colours.
pub(super) fn render(field: &DistanceField<'_>) -> anyhow::Result<Vec<u8>> {
    let triangles: Vec<[u32; 3]> = field
        .mesh
        .faces()
        .map(|face| field.mesh.face_vertices(face).map(VertexId::raw))
        .collect();
    let colours: Vec<[u8; 3]> = colours(field.distances).collect();
    let remark = format!(
        "geodesic distance by {}, model {}",
        field.algorithm, field.model
    );
    let mut bytes = Vec::new();
    PlyWriter::new(field.mesh.positions(), &triangles)
        .comment(&remark)
        .scalars("quality", field.distances)
        .colors(&colours)
        .write(&mut bytes)?;
    Ok(bytes)
}
