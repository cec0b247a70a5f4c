//! An OBJ reader on the library `tobj`, for comparison with the direct reader.
//!
//! `tobj` numbers vertices in the order of their first use, drops unused ones, starts a model at
//! every group and material, and opens material files. So it is given only `v` and `f` statements
//! without colours. A face that lists all vertices in order precedes them and is dropped
//! afterwards, so that vertices keep the numbers of the file. Faces with a missing vertex are
//! refused here; the direct reader leaves them to validation. Errors do not name a line.

use std::fmt::Write;
use std::io::Read;

use super::error::Flaw;
use super::faces::{FaceList, FileMesh};
use super::obj::Statements;
use super::text::words;

/// Reads an OBJ file.
pub(super) fn read(bytes: &[u8]) -> Result<FileMesh, Flaw> {
    let (mut every_vertex, mut vertices) = (String::from("f"), 0);
    let mut statements = Vec::new();
    let mut code = Statements::new(bytes);
    while let Some((line, statement)) = code.next() {
        let mut words: Vec<&[u8]> = words(&statement).collect();
        match words.first() {
            Some(&b"v") => {
                vertices += 1;
                // Writing to a string cannot fail.
                let _ = write!(every_vertex, " {vertices}");
                // A fifth word is a weight. More words are a colour.
                if words.len() > 5 {
                    words.truncate(4);
                }
            }
            Some(&b"f") => {}
            Some(&b"fo") => words[0] = b"f",
            Some(keyword) => {
                code.check_skipped(line, keyword)?;
                continue;
            }
            None => continue,
        }
        statements.push(b'\n');
        statements.extend_from_slice(&words.join(&b' '));
    }
    let options = tobj::LoadOptions::default();
    let no_materials = |_: &std::path::Path| Err(tobj::LoadError::OpenFileFailed);
    let mut file = every_vertex.as_bytes().chain(&statements[..]);
    let (models, _) = tobj::load_obj_buf(&mut file, &options, no_materials)
        .map_err(|error| Flaw::file(format!("tobj cannot read it: {error}")))?;

    let (mut positions, mut faces) = (Vec::new(), FaceList::default());
    for tobj::Model { mesh, .. } in models {
        positions = mesh.positions.as_chunks().0.to_vec();
        // `tobj` returns no arities if all faces are triangles, including the one of all vertices.
        let all_triangles = vec![3; mesh.indices.len() / 3];
        let arities = match &mesh.face_arities[..] {
            [] => &all_triangles,
            arities => arities,
        };
        let mut rest = &mesh.indices[..];
        for (face, &arity) in arities.iter().enumerate() {
            let (corners, next) = rest.split_at(arity as usize);
            rest = next;
            if face > 0 {
                faces.push(corners);
            }
        }
    }
    Ok(FileMesh { positions, faces })
}
