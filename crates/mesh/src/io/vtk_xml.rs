//! XML files of VTK: `PolyData` (`.vtp`) and `UnstructuredGrid` (`.vtu`).
//!
//! Numbers may be text, base64, or appended at the end, raw or base64, and compressed with zlib.
//! The pieces of a file become parts. Arrays of data are ignored.

use std::borrow::Cow;

use roxmltree::Node;

use super::arrays::{NumberType, from_base64, inflate};
use super::error::Flaw;
use super::faces::FileMesh;
use super::scene::{Affine, Assembly};
use super::vtk::{Cells, push_cells};
use super::xml::{self, attribute, child, children, flaw, needed};

/// Reads an XML file of VTK whose arrays take at most `room` bytes.
pub(super) fn read(bytes: &[u8], room: u64) -> Result<FileMesh, Flaw> {
    let (bytes, appended) = split(bytes);
    let text = xml::text(&bytes);
    let document = xml::parse(&text)?;
    let root = document.root_element();
    if root.tag_name().name() != "VTKFile" {
        return Err(flaw(
            root,
            "an XML file of VTK has the element VTKFile here",
        ));
    }
    let kind = root.attribute("type").unwrap_or_default();
    let is_poly = kind == "PolyData";
    if !is_poly && kind != "UnstructuredGrid" {
        let problem = "save the surface as PolyData (.vtp) or UnstructuredGrid (.vtu)";
        return Err(flaw(root, format!("the type is {kind}; {problem}")));
    }
    let mut arrays = Arrays {
        is_little: root.attribute("byte_order") != Some("BigEndian"),
        header: match root.attribute("header_type") {
            None | Some("UInt32") => NumberType::U32,
            Some("UInt64") => NumberType::U64,
            Some(other) => return Err(flaw(root, format!("header_type={other} is unknown"))),
        },
        compressor: root.attribute("compressor"),
        appended,
        room,
    };
    let mut scene = Assembly::new(u64::MAX);
    let grids = root
        .children()
        .filter(|node| node.tag_name().name() == kind);
    let pieces = grids.flat_map(|grid| children(grid, "Piece"));
    for (number, node) in pieces.enumerate() {
        let piece = arrays.piece(node, is_poly)?;
        scene.place(&piece, &Affine::IDENTITY, &format!("piece {number}"))?;
    }
    scene.into_mesh()
}

/// The appended data of a file.
struct Appended<'a> {
    data: &'a [u8],
    is_raw: bool,
}

/// The XML of a file, and the data appended to it, which need not be XML: it starts with an
/// underscore.
fn split(bytes: &[u8]) -> (Cow<'_, [u8]>, Option<Appended<'_>>) {
    let find = |within: &[u8], what: &[u8]| within.windows(what.len()).position(|w| w == what);
    let parts = || {
        let open = find(bytes, b"<AppendedData")?;
        let start = open + find(&bytes[open..], b">")? + 1;
        let underscore = start + find(&bytes[start..], b"_")? + 1;
        let close = b"</AppendedData";
        let end = bytes.windows(close.len()).rposition(|w| w == close)?;
        (end >= underscore).then_some((open, start, underscore, end))
    };
    let Some((open, start, underscore, end)) = parts() else {
        return (Cow::Borrowed(bytes), None);
    };
    let appended = Appended {
        data: &bytes[underscore..end],
        is_raw: find(&bytes[open..start], b"raw").is_some(),
    };
    (
        [&bytes[..start], &bytes[end..]].concat().into(),
        Some(appended),
    )
}

struct Arrays<'a> {
    is_little: bool,
    /// The type of the sizes before an array.
    header: NumberType,
    compressor: Option<&'a str>,
    appended: Option<Appended<'a>>,
    /// How many more bytes arrays may take.
    room: u64,
}

impl Arrays<'_> {
    /// A piece of the file.
    fn piece(&mut self, node: Node<'_, '_>, is_poly: bool) -> Result<FileMesh, Flaw> {
        let mut piece = FileMesh::default();
        let arrays = child(node, "Points").map(|points| children(points, "DataArray"));
        let mut arrays = arrays.into_iter().flatten();
        let points = arrays.next();
        if let Some(more) = arrays.next() {
            let problem = "a second array of points, perhaps of another time; save one of them";
            return Err(flaw(more, problem));
        }
        if let Some(points) = points {
            let numbers = self.floats(points)?;
            let (positions, rest) = numbers.as_chunks();
            if !rest.is_empty()
                || attribute(points, "NumberOfComponents")?.is_some_and(|n: u32| n != 3)
            {
                return Err(flaw(points, "points need three coordinates each"));
            }
            piece.positions = positions.to_vec();
        }
        let counted = |name: &str, found: usize| match attribute::<u64>(node, name)? {
            Some(count) if found as u64 != count => Err(flaw(
                node,
                format!("{name} is {count}, and there are {found}; fetch or save it again"),
            )),
            _ => Ok(()),
        };
        counted("NumberOfPoints", piece.positions.len())?;
        if !is_poly {
            if let Some(node) = child(node, "Cells") {
                let cells = self.cells(node)?;
                let types = self.named(node, "types")?;
                counted("NumberOfCells", types.len())?;
                push_cells(&cells, &types, &mut piece.faces).map_err(|e| flaw(node, e.problem))?;
            }
            return Ok(piece);
        }
        if let Some(polys) = child(node, "Polys") {
            let cells = self.cells(polys)?;
            counted("NumberOfPolys", cells.each().count())?;
            for (_, corners) in cells.each() {
                piece.faces.push(corners);
            }
        }
        if let Some(strips) = child(node, "Strips") {
            let cells = self.cells(strips)?;
            counted("NumberOfStrips", cells.each().count())?;
            for (_, corners) in cells.each() {
                piece.faces.push_strip(corners);
            }
        }
        Ok(piece)
    }

    /// The cells of an element.
    fn cells(&mut self, node: Node<'_, '_>) -> Result<Cells, Flaw> {
        if child(node, "DataArray").is_none() {
            return Ok(Cells::default());
        }
        let corners = self.named(node, "connectivity")?;
        let ends = self.named(node, "offsets")?;
        Cells::new(corners, ends).map_err(|error| flaw(node, error.problem))
    }

    /// The whole numbers of the array with this name.
    fn named(&mut self, node: Node<'_, '_>, name: &str) -> Result<Vec<u32>, Flaw> {
        let mut arrays = children(node, "DataArray");
        let array = arrays.find(|array| array.attribute("Name") == Some(name));
        let array = array.ok_or_else(|| flaw(node, format!("the array {name} is missing")))?;
        if is_text(array) {
            return xml::numbers(array);
        }
        let (bytes, kind) = self.binary(array)?;
        let is_little = self.is_little;
        let numbers = bytes.chunks_exact(kind.size()).enumerate();
        numbers
            .map(|(i, bytes)| {
                let number = kind.integer(bytes, is_little);
                let index = number.and_then(|number| u32::try_from(number).ok());
                index.ok_or_else(|| flaw(array, format!("number {i} is not from 0 to 4294967295")))
            })
            .collect()
    }

    fn floats(&mut self, array: Node<'_, '_>) -> Result<Vec<f64>, Flaw> {
        if is_text(array) {
            return xml::numbers(array);
        }
        let (bytes, kind) = self.binary(array)?;
        let numbers = bytes.chunks_exact(kind.size());
        Ok(numbers
            .map(|bytes| kind.float(bytes, self.is_little))
            .collect())
    }

    /// The bytes of a binary array, and the type of its numbers.
    fn binary(&mut self, array: Node<'_, '_>) -> Result<(Vec<u8>, NumberType), Flaw> {
        let kind = match array.attribute("type").unwrap_or_default() {
            "Int8" => NumberType::I8,
            "UInt8" => NumberType::U8,
            "Int16" => NumberType::I16,
            "UInt16" => NumberType::U16,
            "Int32" => NumberType::I32,
            "UInt32" => NumberType::U32,
            "Int64" => NumberType::I64,
            "UInt64" => NumberType::U64,
            "Float32" => NumberType::F32,
            "Float64" => NumberType::F64,
            other => return Err(flaw(array, format!("the type {other:?} is unknown"))),
        };
        let damaged = || {
            flaw(
                array,
                "its data is damaged or cut off; fetch or save it again",
            )
        };
        let content;
        let data = match (array.attribute("format"), &self.appended) {
            (Some("binary"), _) => {
                let text = xml::content(array);
                content = text
                    .bytes()
                    .filter(|b| !b.is_ascii_whitespace())
                    .collect::<Vec<u8>>();
                Encoded::Base64(&content)
            }
            (Some("appended"), Some(appended)) => {
                let offset: usize = needed(array, "offset")?;
                let data = appended.data.get(offset..).ok_or_else(damaged)?;
                if appended.is_raw {
                    Encoded::Raw(data)
                } else {
                    Encoded::Base64(data)
                }
            }
            (Some("appended"), None) => return Err(flaw(array, "no data is appended to the file")),
            (other, _) => {
                return Err(flaw(array, format!("the format {other:?} is unknown")));
            }
        };
        let bytes = match self.compressor {
            None => self.plain(&data),
            Some("vtkZLibDataCompressor") => self.decompressed(&data),
            Some(other) => {
                let problem = "its data is compressed with";
                return Err(flaw(
                    array,
                    format!("{problem} {other}; save it with zlib or without"),
                ));
            }
        };
        let bytes = bytes.ok_or_else(damaged)?;
        // Any number of arrays may name the same appended data.
        let room = self.room.checked_sub(bytes.len() as u64);
        self.room = room.ok_or_else(|| {
            flaw(
                array,
                "the arrays take more than the limit of decompressed sizes",
            )
            .over_limit()
        })?;
        Ok((bytes, kind))
    }

    /// The numbers of a header, in bytes.
    fn sizes(&self, bytes: &[u8]) -> Vec<usize> {
        let sizes = bytes.chunks_exact(self.header.size());
        sizes
            .map(|bytes| {
                let size = self.header.integer(bytes, self.is_little);
                size.and_then(|size| usize::try_from(size).ok())
                    .unwrap_or(usize::MAX)
            })
            .collect()
    }

    /// An array without compression, behind its size.
    fn plain(&self, data: &Encoded<'_>) -> Option<Vec<u8>> {
        let header = self.header.size();
        let size = *self.sizes(&data.bytes(0, header)?).first()?;
        // Usually header and numbers are encoded as one, else each for itself.
        if data.is_padded(header) {
            data.after(header)?.bytes(0, size)
        } else {
            data.bytes(header, size)
        }
    }

    /// A compressed array, behind the number of its blocks, their size, the size of a last part of
    /// a block, and the compressed sizes.
    fn decompressed(&self, data: &Encoded<'_>) -> Option<Vec<u8>> {
        let word = self.header.size();
        let blocks = *self.sizes(&data.bytes(0, word)?).first()?;
        let header = blocks.checked_add(3)?.checked_mul(word)?;
        let sizes = self.sizes(&data.bytes(0, header)?);
        let compressed = sizes[3..]
            .iter()
            .try_fold(0_usize, |sum, &size| sum.checked_add(size))?;
        let compressed = data.after(header)?.bytes(0, compressed)?;
        let mut rest = &compressed[..];
        let mut bytes = Vec::new();
        for &size in &sizes[3..] {
            let (block, after) = rest.split_at_checked(size)?;
            let room = self.room.saturating_sub(bytes.len() as u64);
            if !inflate(block, room, &mut bytes) {
                // What is over the limit is no damage.
                return Some(bytes).filter(|bytes| bytes.len() as u64 > self.room);
            }
            rest = after;
        }
        Some(bytes)
    }
}

fn is_text(array: Node<'_, '_>) -> bool {
    matches!(array.attribute("format"), None | Some("ascii"))
}

/// Bytes as they are, or in base64 without blanks.
enum Encoded<'a> {
    Raw(&'a [u8]),
    Base64(&'a [u8]),
}

impl Encoded<'_> {
    /// The `count` bytes from `start`, a multiple of 4 with base64 or less than 9.
    fn bytes(&self, start: usize, count: usize) -> Option<Vec<u8>> {
        let end = start.checked_add(count)?;
        match self {
            Self::Raw(data) => data.get(start..end).map(<[u8]>::to_vec),
            Self::Base64(text) => {
                let mut bytes = from_base64(text.get(..letters(end)?)?)?;
                bytes.truncate(end);
                bytes.drain(..start.min(bytes.len()));
                (bytes.len() == count).then_some(bytes)
            }
        }
    }

    /// Whether `count` bytes are encoded for themselves.
    fn is_padded(&self, count: usize) -> bool {
        match self {
            Self::Raw(_) => false,
            Self::Base64(text) => {
                letters(count).is_some_and(|end| end > 0 && text.get(end - 1) == Some(&b'='))
            }
        }
    }

    /// What follows `count` bytes that are encoded for themselves.
    fn after(&self, count: usize) -> Option<Self> {
        Some(match self {
            Self::Raw(data) => Self::Raw(data.get(count..)?),
            Self::Base64(text) => Self::Base64(text.get(letters(count)?..)?),
        })
    }
}

/// The number of letters of base64 that `count` bytes take.
fn letters(count: usize) -> Option<usize> {
    count.div_ceil(3).checked_mul(4)
}
