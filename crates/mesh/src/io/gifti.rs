//! GIFTI surfaces (`.gii`): point sets with their triangles, as text, as base64, also compressed,
//! or in files beside.
//!
//! The matrices of coordinate systems lead to other spaces and are not applied. Several surfaces of
//! a file become parts.

use std::path::{Path, PathBuf};

use roxmltree::Node;

use super::arrays::{NumberType, from_base64, inflate};
use super::beside;
use super::error::Flaw;
use super::faces::FileMesh;
use super::scene::{Affine, Assembly};
use super::xml::{self, children, flaw, needed};

/// The encodings of arrays, by the names of the format and those of its C library, which are in
/// files, too.
const TEXT: [&str; 2] = ["ASCII", "GIFTI_ENCODING_ASCII"];
const BASE64: [&str; 2] = ["Base64Binary", "GIFTI_ENCODING_B64BIN"];
const COMPRESSED: [&str; 2] = ["GZipBase64Binary", "GIFTI_ENCODING_B64GZ"];
const EXTERNAL: [&str; 2] = ["ExternalFileBinary", "GIFTI_ENCODING_EXTBIN"];

/// The files beside one at `path` with these `bytes` that hold its data.
pub(super) fn data_files(bytes: &[u8], path: &Path) -> Vec<PathBuf> {
    let text = xml::text(bytes);
    let Ok(document) = xml::parse(&text) else {
        return Vec::new();
    };
    let arrays = children(document.root_element(), "DataArray");
    let external = arrays.filter(|array| {
        let encoding = array.attribute("Encoding");
        encoding.is_some_and(|encoding| EXTERNAL.contains(&encoding))
    });
    let names = external.filter_map(|array| array.attribute("ExternalFileName"));
    names
        .filter_map(|name| beside::place(path, name.trim()))
        .collect()
}

/// Reads a GIFTI file at `path` whose arrays decompress to at most `room` bytes each.
pub(super) fn read(bytes: &[u8], path: &Path, room: u64) -> Result<FileMesh, Flaw> {
    let text = xml::text(bytes);
    let document = xml::parse(&text)?;
    let root = document.root_element();
    if root.tag_name().name() != "GIFTI" {
        return Err(flaw(root, "a GIFTI file has the element GIFTI here"));
    }
    let of_kind = |intent| {
        let arrays = children(root, "DataArray");
        arrays.filter(move |array| array.attribute("Intent") == Some(intent))
    };
    let points: Vec<Node<'_, '_>> = of_kind("NIFTI_INTENT_POINTSET").collect();
    let triangles: Vec<Node<'_, '_>> = of_kind("NIFTI_INTENT_TRIANGLE").collect();
    if points.len() != triangles.len() || points.is_empty() {
        return Err(Flaw::file(format!(
            "the number of its point sets is {}, that of its sets of triangles {}; a surface has \
             one of each (.surf.gii), other files hold its data",
            points.len(),
            triangles.len()
        )));
    }
    let mut scene = Assembly::new(u64::MAX);
    for (number, (points, triangles)) in points.into_iter().zip(triangles).enumerate() {
        let mut piece = FileMesh {
            positions: triples(points, path, room, |bytes, kind, is_little| {
                Some(kind.float(bytes, is_little))
            })?,
            ..FileMesh::default()
        };
        let corners = triples(triangles, path, room, |bytes, kind, is_little| {
            u32::try_from(kind.integer(bytes, is_little)?).ok()
        })?;
        for corners in corners {
            piece.faces.push(&corners);
        }
        scene.place(&piece, &Affine::IDENTITY, &format!("surface {number}"))?;
    }
    scene.into_mesh()
}

/// The rows of an array with three columns. `number` converts the bytes of a number.
fn triples<T: Copy + std::str::FromStr>(
    array: Node<'_, '_>,
    path: &Path,
    room: u64,
    number: impl Fn(&[u8], NumberType, bool) -> Option<T>,
) -> Result<Vec<[T; 3]>, Flaw> {
    let rows: usize = needed(array, "Dim0")?;
    let columns: usize = needed(array, "Dim1")?;
    if columns != 3 {
        return Err(flaw(array, format!("has {columns} columns, not 3")));
    }
    let data = || xml::child(array, "Data").ok_or_else(|| flaw(array, "has no data"));
    let encoding = array.attribute("Encoding").unwrap_or(TEXT[0]);
    let numbers: Vec<T> = if TEXT.contains(&encoding) {
        xml::numbers(data()?)?
    } else {
        let kind = match array.attribute("DataType").unwrap_or_default() {
            "NIFTI_TYPE_INT8" => NumberType::I8,
            "NIFTI_TYPE_UINT8" => NumberType::U8,
            "NIFTI_TYPE_INT16" => NumberType::I16,
            "NIFTI_TYPE_UINT16" => NumberType::U16,
            "NIFTI_TYPE_INT32" => NumberType::I32,
            "NIFTI_TYPE_UINT32" => NumberType::U32,
            "NIFTI_TYPE_INT64" => NumberType::I64,
            "NIFTI_TYPE_UINT64" => NumberType::U64,
            "NIFTI_TYPE_FLOAT32" => NumberType::F32,
            "NIFTI_TYPE_FLOAT64" => NumberType::F64,
            other => return Err(flaw(array, format!("the type {other:?} is unknown"))),
        };
        let damaged = || {
            flaw(
                array,
                "its data is damaged or cut off; fetch or save it again",
            )
        };
        let coded = || from_base64(xml::content(data()?).as_bytes()).ok_or_else(damaged);
        let bytes = if BASE64.contains(&encoding) {
            coded()?
        } else if EXTERNAL.contains(&encoding) {
            let length = rows.saturating_mul(3 * kind.size());
            external(array, path, length as u64)?
        } else if COMPRESSED.contains(&encoding) {
            let mut bytes = Vec::new();
            if !inflate(&coded()?[..], room, &mut bytes) {
                let is_over = bytes.len() as u64 > room;
                let problem = "decompresses to more than the limit";
                return Err(if is_over {
                    flaw(array, problem).over_limit()
                } else {
                    damaged()
                });
            }
            bytes
        } else {
            let problem = "save it with the data in base64";
            return Err(flaw(
                array,
                format!("the encoding {encoding:?} is not read; {problem}"),
            ));
        };
        let is_little = !is_second(
            array,
            "Endian",
            ["LittleEndian", "GIFTI_ENDIAN_LITTLE"],
            ["BigEndian", "GIFTI_ENDIAN_BIG"],
        )?;
        let numbers = bytes.chunks_exact(kind.size()).enumerate();
        let numbers = numbers.map(|(i, bytes)| {
            number(bytes, kind, is_little)
                .ok_or_else(|| flaw(array, format!("number {i} is not from 0 to 4294967295")))
        });
        numbers.collect::<Result<_, _>>()?
    };
    if rows.checked_mul(3) != Some(numbers.len()) {
        let count = numbers.len();
        return Err(flaw(
            array,
            format!("has {count} numbers for {rows} rows of 3"),
        ));
    }
    let is_by_columns = is_second(
        array,
        "ArrayIndexingOrder",
        ["RowMajorOrder", "GIFTI_IND_ORD_ROW_MAJOR"],
        ["ColumnMajorOrder", "GIFTI_IND_ORD_COL_MAJOR"],
    )?;
    if is_by_columns {
        let at = |row, column| numbers[column * rows + row];
        return Ok((0..rows).map(|row| [0, 1, 2].map(|k| at(row, k))).collect());
    }
    Ok(numbers.as_chunks().0.to_vec())
}

/// Whether an attribute has the second of two values, each of which has two names. The first is the
/// default.
fn is_second(
    array: Node<'_, '_>,
    name: &str,
    first: [&str; 2],
    second: [&str; 2],
) -> Result<bool, Flaw> {
    match array.attribute(name).unwrap_or_default().trim() {
        value if value.is_empty() || first.contains(&value) => Ok(false),
        value if second.contains(&value) => Ok(true),
        value => Err(flaw(array, format!("{name}={value:?} is unknown"))),
    }
}

/// The data of an array in a file beside, of `length` bytes or less.
fn external(array: Node<'_, '_>, path: &Path, length: u64) -> Result<Vec<u8>, Flaw> {
    let name = array.attribute("ExternalFileName").unwrap_or_default();
    let name = name.trim();
    // Programs write an empty offset for 0.
    let offset = match array.attribute("ExternalFileOffset").map(str::trim) {
        None | Some("") => 0,
        Some(_) => needed(array, "ExternalFileOffset")?,
    };
    let place = beside::place(path, name).filter(|_| !name.is_empty());
    let bytes = place.and_then(|place| beside::part(&place, offset, length));
    bytes.ok_or_else(|| {
        flaw(
            array,
            format!(
                "its data in the file {name:?} cannot be read: that must lie beside this one, and beside \
                 standard input there is none; or save it with the data in base64"
            ),
        )
    })
}
