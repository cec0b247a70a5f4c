//! A distance field on its mesh as a legacy VTK file.
//!
//! The binary form (big-endian), because the text form has no way to write infinity that every
//! reader takes.

use geobench_mesh::VertexId;

use super::DistanceField;
use super::append;

/// The mesh with the fields `distance` and `reached`.
pub(super) fn render(field: &DistanceField<'_>) -> Vec<u8> {
    let (vertices, faces) = (field.distances.len(), field.mesh.face_count());
    // The second line is the title: at most 256 characters.
    let title: String = format!(
        "geodesic distance by {}, model {}",
        field.algorithm, field.model
    )
    .chars()
    .map(|c| if c.is_ascii_graphic() { c } else { ' ' })
    .take(200)
    .collect();
    let mut bytes = format!(
        "# vtk DataFile Version 3.0\n{title}\nBINARY\nDATASET POLYDATA\nPOINTS {vertices} double\n"
    )
    .into_bytes();
    let coordinates = field.mesh.positions().as_flattened().iter().copied();
    append(&mut bytes, coordinates, f64::to_be_bytes);
    bytes.extend_from_slice(format!("\nPOLYGONS {faces} {}\n", 4 * faces).as_bytes());
    for face in field.mesh.faces() {
        let [a, b, c] = field.mesh.face_vertices(face).map(VertexId::raw);
        append(&mut bytes, [3, a, b, c], u32::to_be_bytes);
    }
    bytes.extend_from_slice(
        format!("\nPOINT_DATA {vertices}\nSCALARS distance double 1\nLOOKUP_TABLE default\n")
            .as_bytes(),
    );
    append(
        &mut bytes,
        field.distances.iter().copied(),
        f64::to_be_bytes,
    );
    bytes.extend_from_slice(b"\nSCALARS reached unsigned_char 1\nLOOKUP_TABLE default\n");
    bytes.extend(field.distances.iter().map(|d| u8::from(d.is_finite())));
    bytes.push(b'\n');
    bytes
}
