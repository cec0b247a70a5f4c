//! The header of a PLY file.

use std::collections::HashSet;

use crate::io::arrays::NumberType;
use crate::io::error::Flaw;
use crate::io::text::{NumberedLines, integer, shown, words};

/// A valid header, with vertices and faces.
pub(super) struct Header {
    pub(super) encoding: Encoding,
    /// In the order of the payload.
    pub(super) elements: Vec<Element>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// A kind of element with its count and properties.
pub(super) struct Element {
    pub(super) name: String,
    pub(super) kind: ElementUse,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

/// How an element is used.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum ElementUse {
    Vertex,
    Face,
    /// Triangle strips.
    Strip,
    Skipped,
}

/// A property of an element: a number or a list of numbers.
pub(super) struct Property {
    pub(super) name: String,
    pub(super) role: Role,
    /// Type of the length, for a list.
    pub(super) length: Option<NumberType>,
    /// Type of the number, or of each number in the list.
    pub(super) value: NumberType,
}

/// How a property is used.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// A coordinate of a vertex: 0 for x, 1 for y, 2 for z.
    Axis(usize),
    /// The list of the corners of a face, or of strips, which end with a negative number.
    Corners,
    Skipped,
}

/// The type of numbers with this name.
fn number_type(name: &[u8]) -> Option<NumberType> {
    Some(match name {
        b"char" | b"int8" => NumberType::I8,
        b"uchar" | b"uint8" => NumberType::U8,
        b"short" | b"int16" => NumberType::I16,
        b"ushort" | b"uint16" => NumberType::U16,
        b"int" | b"int32" => NumberType::I32,
        b"uint" | b"uint32" => NumberType::U32,
        b"long" | b"int64" => NumberType::I64,
        b"ulong" | b"uint64" => NumberType::U64,
        b"float" | b"float32" => NumberType::F32,
        b"double" | b"float64" => NumberType::F64,
        _ => return None,
    })
}

impl Element {
    fn new(name: &[u8], count: u64) -> Self {
        Self {
            name: plain(name),
            kind: match name {
                b"vertex" => ElementUse::Vertex,
                b"face" => ElementUse::Face,
                b"tristrips" => ElementUse::Strip,
                _ => ElementUse::Skipped,
            },
            count,
            properties: Vec::new(),
        }
    }

    fn property(&self, name: &[u8], length: Option<NumberType>, value: NumberType) -> Property {
        Property {
            name: plain(name),
            role: match (self.kind, name, length) {
                (ElementUse::Vertex, b"x", None) => Role::Axis(0),
                (ElementUse::Vertex, b"y", None) => Role::Axis(1),
                (ElementUse::Vertex, b"z", None) => Role::Axis(2),
                (
                    ElementUse::Face | ElementUse::Strip,
                    b"vertex_indices" | b"vertex_index",
                    Some(_),
                ) => Role::Corners,
                _ => Role::Skipped,
            },
            length,
            value,
        }
    }

    /// Size in bytes of an element in a binary payload, if all its lists are empty.
    pub(super) fn smallest_size(&self) -> u64 {
        let first = |p: &Property| p.length.unwrap_or(p.value).size() as u64;
        self.properties.iter().map(first).sum()
    }
}

/// A name for use in a message, without quotation marks.
fn plain(name: &[u8]) -> String {
    String::from_utf8_lossy(name).escape_debug().to_string()
}

/// Reads `lines` to the end of the header.
pub(super) fn read(lines: &mut NumberedLines<'_>) -> Result<Header, Flaw> {
    if lines
        .next()
        .is_none_or(|(_, line)| line.trim_ascii() != b"ply")
    {
        return Err(Flaw::line(1, "a PLY file starts with a line \"ply\""));
    }
    let mut declared = Declarations::default();
    for (number, line) in lines.by_ref() {
        let words: Vec<&[u8]> = words(line).collect();
        match words[..] {
            [] | [b"comment" | b"obj_info", ..] => {}
            [b"end_header"] => {
                let encoding = declared.encoding.ok_or_else(|| {
                    Flaw::file("the header needs a line like \"format ascii 1.0\"")
                })?;
                let elements = declared.elements;
                check(&elements)?;
                return Ok(Header { encoding, elements });
            }
            _ => declared.add(&words).map_err(|problem| {
                Flaw::line(number, format!("{} {problem}", shown(line.trim_ascii())))
            })?,
        }
    }
    Err(Flaw::line(
        lines.number(),
        "the file ends before end_header; fetch it again",
    ))
}

/// The declarations of a header so far.
#[derive(Default)]
struct Declarations<'a> {
    encoding: Option<Encoding>,
    elements: Vec<Element>,
    /// Names of elements, with 0, and of properties, with the number of elements declared before
    /// them.
    names: HashSet<(usize, &'a [u8])>,
}

impl<'a> Declarations<'a> {
    /// Adds the declaration in `words`, or returns what is wrong with it.
    fn add(&mut self, words: &[&'a [u8]]) -> Result<(), &'static str> {
        let invalid = "is no valid line of a PLY header";
        let scalar = |name| number_type(name).ok_or(invalid);
        let name = match *words {
            [b"format", name, _version] if self.encoding.is_none() => {
                self.encoding = Some(match name {
                    b"ascii" => Encoding::Text,
                    b"binary_little_endian" => Encoding::LittleEndian,
                    b"binary_big_endian" => Encoding::BigEndian,
                    _ => return Err(invalid),
                });
                return Ok(());
            }
            [b"element", name, count] => {
                let count = integer(count).and_then(|count| count.try_into().ok());
                self.elements
                    .push(Element::new(name, count.ok_or(invalid)?));
                (0, name)
            }
            [b"property", ref types @ .., name] => {
                let (length, value) = match *types {
                    [value] => (None, value),
                    [b"list", length, value] => (Some(scalar(length)?), value),
                    _ => return Err(invalid),
                };
                let element = self.elements.last_mut().ok_or(invalid)?;
                let property = element.property(name, length, scalar(value)?);
                element.properties.push(property);
                (self.elements.len(), name)
            }
            _ => return Err(invalid),
        };
        if self.names.insert(name) {
            Ok(())
        } else {
            Err("declares a name a second time; remove one")
        }
    }
}

/// Checks that there are vertices with coordinates and faces with corners, and that list lengths
/// are integers.
fn check(elements: &[Element]) -> Result<(), Flaw> {
    for property in elements.iter().flat_map(|e| &e.properties) {
        if let Some(NumberType::F32 | NumberType::F64) = property.length {
            return Err(Flaw::file(format!(
                "the header counts the list {} with a type that is not an integer",
                property.name
            )));
        }
    }
    let find = |name| elements.iter().find(|e| e.name == name);
    let vertices = find("vertex")
        .ok_or_else(|| Flaw::file("the header declares no element vertex, so there is no mesh"))?;
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        if vertices
            .properties
            .iter()
            .all(|p| p.role != Role::Axis(axis))
        {
            return Err(Flaw::file(format!(
                "the header declares no coordinate {name} for the element vertex"
            )));
        }
    }
    let surfaces = elements
        .iter()
        .filter(|e| matches!(e.kind, ElementUse::Face | ElementUse::Strip));
    if surfaces.clone().next().is_none() {
        return Err(Flaw::file(if find("range_grid").is_some() {
            "its points form a range_grid, which is not read; convert the grid to faces"
        } else {
            "the header declares no element face; a surface is needed, not a point cloud"
        }));
    }
    for element in surfaces {
        let lists = element
            .properties
            .iter()
            .filter(|p| p.role == Role::Corners);
        let problem = match lists.count() {
            1 => continue,
            0 => format!(
                "the header declares no list vertex_indices for the element {}",
                element.name
            ),
            _ => format!(
                "the element {} has both vertex_index and vertex_indices; remove one",
                element.name
            ),
        };
        return Err(Flaw::file(problem));
    }
    Ok(())
}
