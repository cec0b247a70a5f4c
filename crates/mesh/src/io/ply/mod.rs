//! PLY, text and binary of both byte orders.
//!
//! Text coordinates are read as `f64` even where the header declares `float`: many programs declare
//! `float` and then write all digits. Binary coordinates have the declared type. Elements other
//! than `vertex` and `face` are skipped, as are properties other than `x y z` and the list
//! `vertex_indices` (or `vertex_index`). Elements may come in any order. Triangle strips
//! (`tristrips`) become triangles.

mod header;
mod payload;

use super::error::Flaw;
use super::faces::{FaceList, FileMesh};
use super::text::NumberedLines;
use crate::defect::FileForm;
use header::{Element, ElementUse, Encoding, Role};
use payload::{Binary, Layout, Payload, Text};

/// Reads a PLY file.
pub(super) fn read(bytes: &[u8]) -> Result<FileMesh, Flaw> {
    let mut lines = NumberedLines::before_data(bytes);
    let header = header::read(&mut lines)?;
    let (elements, rest) = (&header.elements, lines.rest());
    match header.encoding {
        // Most files have a line for each element. In others numbers extend over lines or share
        // one, or lines have more numbers than the header declares.
        Encoding::Text => {
            let read = |layout| read_elements(elements, Text::new(lines.clone(), layout));
            read(Layout::Lines).or_else(|flaw| {
                let others = [Layout::Free, Layout::LinesWithMore].map(read);
                let others = others.into_iter().flatten();
                let mut others = others.filter(|mesh: &FileMesh| mesh.faces.has_surface());
                // An ambiguous file is an error.
                match (others.next(), others.next()) {
                    (Some(mesh), None) => Ok(mesh),
                    _ => Err(flaw),
                }
            })
        }
        Encoding::LittleEndian => read_elements(elements, Binary::<false>::new(rest, bytes.len())),
        Encoding::BigEndian => read_elements(elements, Binary::<true>::new(rest, bytes.len())),
    }
}

fn read_elements<P: Payload>(elements: &[Element], mut payload: P) -> Result<FileMesh, Flaw> {
    // Counts reserve memory only as far as the payload can hold so many elements.
    let room = |kind| {
        let element = elements.iter().find(|e| e.kind == kind);
        element.map_or(0, |e| payload.most(e).min(e.count) as usize)
    };
    let mut positions = Vec::with_capacity(room(ElementUse::Vertex));
    let mut faces = FaceList::with_capacity(room(ElementUse::Face));
    let (mut position, mut corners) = ([0.0; 3], Vec::new());
    // An element without properties takes no bytes and no line, whatever its count.
    for element in elements.iter().filter(|e| !e.properties.is_empty()) {
        payload.begin(element)?;
        match element.kind {
            ElementUse::Vertex => {
                if let Some(all) = payload.positions(element) {
                    positions = all;
                    continue;
                }
            }
            ElementUse::Face if faces.is_empty() => {
                if let Some(all) = payload.triangles(element) {
                    faces = FaceList::of(all);
                    continue;
                }
            }
            ElementUse::Face | ElementUse::Strip | ElementUse::Skipped => {}
        }
        for number in 0..element.count {
            payload.next(element, number)?;
            if element.kind == ElementUse::Skipped && payload.is_in_lines() {
                continue;
            }
            for property in &element.properties {
                let length = match property.length {
                    Some(_) => payload.length(property)?,
                    None => 1,
                };
                match property.role {
                    Role::Axis(axis) => position[axis] = payload.coordinate(property)?,
                    Role::Corners => {
                        corners.clear();
                        // Ends with the line or the file, however large `length` is.
                        for _ in 0..length {
                            let in_strip = element.kind == ElementUse::Strip;
                            if let Some(corner) = payload.corner(property, in_strip)? {
                                corners.push(corner);
                            } else {
                                faces.push_strip(&corners);
                                corners.clear();
                            }
                        }
                    }
                    Role::Skipped => payload.skip(property, length)?,
                }
            }
            payload.end(element)?;
            match element.kind {
                ElementUse::Vertex => positions.push(position),
                ElementUse::Face => faces.push(&corners),
                ElementUse::Strip => faces.push_strip(&corners),
                ElementUse::Skipped => {}
            }
        }
    }
    if let Some(line) = payload.finish()? {
        faces.note_form(line, FileForm::MoreNumbers);
    }
    Ok(FileMesh { positions, faces })
}
