//! A distance field on its mesh as binary PLY.

use super::DistanceField;
use super::bytes::append;
use super::ramp::colours;

/// The mesh with `quality`, the name under which mesh programs know a vertex scalar, and colours.
pub(super) fn render(field: &DistanceField<'_>) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\n\
         comment geodesic distance by {}, model {}\n\
         element vertex {}\n\
         property double x\nproperty double y\nproperty double z\n\
         property double quality\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\n\
         element face {}\n\
         property list uchar uint vertex_indices\n\
         end_header\n",
        field.algorithm,
        field.model.replace(['\n', '\r'], " "),
        field.distances.len(),
        field.mesh.face_count(),
    )
    .into_bytes();
    let vertices = field.mesh.positions().iter().zip(field.distances);
    for ((position, &distance), colour) in vertices.zip(colours(field.distances)) {
        append(&mut bytes, position.iter().copied(), f64::to_le_bytes);
        bytes.extend_from_slice(&distance.to_le_bytes());
        bytes.extend_from_slice(&colour);
    }
    for face in field.mesh.faces() {
        bytes.push(3);
        let vertices = field.mesh.face_vertices(face);
        append(&mut bytes, vertices.map(|v| v.raw()), u32::to_le_bytes);
    }
    bytes
}
