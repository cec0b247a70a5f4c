//! The payload of a binary PLY file.

use std::io::ErrorKind;

use ply_rs_bw::parser::{ParseError, Parser};
use ply_rs_bw::ply::{ElementDef, Encoding, PropertyAccess, PropertyType, ScalarType};

use super::Contents;
use super::header::Header;
use super::row::{FaceRow, Skipped, VertexRow};
use crate::io::error::{Flaw, Place};

/// Reads the payload `bytes`, which ends a file of `file_size` bytes. Blanks and zero bytes may
/// follow the declared elements, and nothing else: elements that the header does not count would be
/// lost without a word.
pub(super) fn read(header: &Header, bytes: &[u8], file_size: usize) -> Result<Contents, Flaw> {
    let smallest = |name| {
        let element = header.elements.iter().find(|e| e.name == name);
        element.map_or(1, smallest_size).max(1) as usize
    };
    let (vertex, face) = (smallest("vertex"), smallest("face"));
    // A triangle has three corners, so three more bytes at least; polygons grow the list.
    let mut contents = Contents::with_capacity(header, bytes.len(), vertex, face + 3);
    let mut input = Input {
        rest: bytes,
        file_size,
        big_endian: header.encoding == Encoding::BinaryBigEndian,
    };
    let mut corners = Vec::new();
    for element in &header.elements {
        check_count(element, &input)?;
        match element.name.as_str() {
            "vertex" => input.each::<VertexRow>("vertex", element, |row| {
                contents.positions.push(row.position);
                Ok(())
            })?,
            "face" => input.each::<FaceRow>("face", element, |row| {
                corners.clear();
                row.corners(&mut corners)?;
                contents.faces.push(&corners);
                Ok(())
            })?,
            // An element without properties takes no bytes, however many there are.
            _ if element.properties.is_empty() => {}
            _ => input.each::<Skipped>("skipped element", element, |_| Ok(()))?,
        }
    }
    let filling = |byte: &u8| *byte == 0 || byte.is_ascii_whitespace();
    match input.rest.len() {
        more if !input.rest.iter().all(filling) => Err(Flaw::file(format!(
            "{more} bytes come after all the elements that the header declares; correct its \
             counts, or cut them off"
        ))),
        _ => Ok(contents),
    }
}

/// The bytes that an element takes if all its lists are empty.
fn smallest_size(element: &ElementDef) -> u64 {
    let types = element.properties.values().map(|p| &p.data_type);
    types
        .map(|data_type| match data_type {
            PropertyType::Scalar(scalar) | PropertyType::List(scalar, _) => size(scalar),
        })
        .sum()
}

fn size(scalar: &ScalarType) -> u64 {
    match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}

/// Refuses a header that declares more elements than the rest of the file can hold.
fn check_count(element: &ElementDef, input: &Input<'_>) -> Result<(), Flaw> {
    let needed = u128::from(smallest_size(element)) * element.count as u128;
    if needed > input.rest.len() as u128 {
        return Err(Flaw::file(format!(
            "the header declares {} elements {}, which need {needed} bytes or more, but only {} \
             are left; the file is cut off or its header wrong",
            element.count,
            element.name,
            input.rest.len()
        )));
    }
    Ok(())
}

/// The payload that has not been read yet.
struct Input<'a> {
    rest: &'a [u8],
    file_size: usize,
    big_endian: bool,
}

impl Input<'_> {
    /// Reads all of one kind of element and hands each to `take`, whose complaints are about it.
    fn each<E: PropertyAccess>(
        &mut self,
        kind: &'static str,
        element: &ElementDef,
        mut take: impl FnMut(E) -> Result<(), String>,
    ) -> Result<(), Flaw> {
        let parser = Parser::<E>::new();
        for number in 0..element.count as u64 {
            let byte = (self.file_size - self.rest.len()) as u64;
            let row = if self.big_endian {
                parser.read_big_endian_element(&mut self.rest, element)
            } else {
                parser.read_little_endian_element(&mut self.rest, element)
            };
            row.map_err(|error| explain(&error))
                .and_then(&mut take)
                .map_err(|problem| Flaw {
                    place: Place::Element { kind, number, byte },
                    problem,
                })?;
        }
        Ok(())
    }
}

fn explain(error: &ParseError) -> String {
    if error.kind() == ErrorKind::UnexpectedEof {
        "the file ends within it; the file is cut off or its header wrong".to_owned()
    } else {
        format!("{error}; write the file anew")
    }
}
