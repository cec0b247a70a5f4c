//! The header of a PLY file.

use std::collections::HashSet;

use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Encoding, PropertyType, ScalarType};

use super::row::Skipped;
use crate::io::error::Flaw;
use crate::io::text::{Lines, shown, words};

/// What the header declares, checked to hold vertices and faces.
pub(super) struct Header {
    pub(super) encoding: Encoding,
    /// In the order of the payload.
    pub(super) elements: Vec<ElementDef>,
}

/// Reads the header, and returns it with the lines, or bytes, that follow it.
pub(super) fn read(bytes: &[u8]) -> Result<(Header, Lines<'_>), Flaw> {
    let mut lines = Lines::new(bytes);
    let (text, line_numbers) = tidy(&mut lines)?;
    let parser = Parser::<Skipped>::new();
    let header = parser
        .read_header(&mut Reader::new(&text[..]))
        .map_err(|error| match error.line().and_then(|l| l.checked_sub(1)) {
            Some(at) if at < line_numbers.len() => Flaw::line(
                line_numbers[at],
                format!(
                    "{} is no valid line of a PLY header",
                    shown(Lines::new(&text).nth(at).unwrap_or_default().1)
                ),
            ),
            _ => Flaw::file("the header needs a line like \"format ascii 1.0\""),
        })?;
    let header = Header {
        encoding: header.encoding,
        elements: header.elements.into_values().collect(),
    };
    check(&header.elements)?;
    Ok((header, lines))
}

/// The header without remarks, which may be in any encoding, and without blanks around its lines;
/// and the number of each line in the file.
///
/// Takes `lines` to the end of the header. Refuses names declared twice, because the second
/// declaration would replace the first.
fn tidy(lines: &mut Lines<'_>) -> Result<(Vec<u8>, Vec<u64>), Flaw> {
    let (mut text, mut line_numbers) = (Vec::new(), Vec::new());
    let (mut elements, mut properties) = (HashSet::new(), HashSet::new());
    loop {
        let Some((number, line)) = lines.next() else {
            return Err(Flaw::line(
                lines.number().max(1),
                "the file ends before end_header; fetch it again",
            ));
        };
        let line = line.trim_ascii();
        if number == 1 && line != b"ply" {
            return Err(Flaw::line(1, "a PLY file starts with a line \"ply\""));
        }
        let mut words = words(line);
        let new = match words.next() {
            None | Some(b"comment" | b"obj_info") => continue,
            Some(b"element") => {
                properties.clear();
                elements.insert(words.next())
            }
            Some(b"property") => properties.insert(words.last()),
            _ => true,
        };
        if !new {
            return Err(Flaw::line(
                number,
                format!("{} declares a name a second time; remove one", shown(line)),
            ));
        }
        text.extend_from_slice(line);
        text.push(b'\n');
        line_numbers.push(number);
        if line == b"end_header" {
            return Ok((text, line_numbers));
        }
    }
}

/// Whether this is the list of the corners of a face.
pub(super) fn is_corner_list(name: &str) -> bool {
    matches!(name, "vertex_indices" | "vertex_index")
}

/// Checks that there are vertices with coordinates and faces with corners, and that the lengths
/// of lists are integers.
fn check(elements: &[ElementDef]) -> Result<(), Flaw> {
    for property in elements.iter().flat_map(|e| e.properties.values()) {
        if let PropertyType::List(ScalarType::Float | ScalarType::Double, _) = property.data_type {
            return Err(Flaw::file(format!(
                "the header counts the list {} with a type that is not an integer",
                property.name
            )));
        }
    }
    let find = |name| elements.iter().find(|e| e.name == name);
    let vertices = find("vertex")
        .ok_or_else(|| Flaw::file("the header declares no element vertex, so there is no mesh"))?;
    for axis in ["x", "y", "z"] {
        let property = vertices.properties.get(axis).map(|p| &p.data_type);
        if !matches!(property, Some(PropertyType::Scalar(_))) {
            return Err(Flaw::file(format!(
                "the header declares no coordinate {axis} for the element vertex"
            )));
        }
    }
    let faces = find("face").ok_or_else(|| {
        Flaw::file(if find("tristrips").is_some() {
            "its faces are triangle strips, which are not read; convert them to faces"
        } else {
            "the header declares no element face; a surface is needed, not a point cloud"
        })
    })?;
    let lists = faces
        .properties
        .values()
        .filter(|p| is_corner_list(&p.name))
        .filter(|p| matches!(p.data_type, PropertyType::List(..)));
    match lists.count() {
        1 => Ok(()),
        0 => Err(Flaw::file(
            "the header declares no list vertex_indices for the element face",
        )),
        _ => Err(Flaw::file(
            "the element face has both vertex_index and vertex_indices; remove one",
        )),
    }
}
