//! PLY, text and binary of both byte orders.
//!
//! The header and the elements of a binary payload are read by `ply-rs-bw`, with a [`row`] type
//! of our own in place of its hash maps. Before it sees the header, remarks are taken out, since
//! it refuses those that are not UTF-8, and repeated names are refused, since it would let a
//! second property replace the first, which shifts the payload. Text payloads are read here: its
//! reader refuses numbers such as `nan`, `.5` and `1.` and rounds to the declared type.
//!
//! Text coordinates are read as `f64` even where the header declares `float`: programs declare
//! that out of habit and then write all the digits they have. Binary coordinates are what they
//! are. Elements other than `vertex` and `face`, and properties other than `x y z` and the list
//! `vertex_indices` (or `vertex_index`), are skipped; the elements may come in any order.

mod binary;
mod header;
mod row;
mod text;

use ply_rs_bw::ply::Encoding;

use super::error::Flaw;
use super::faces::FaceList;
use crate::soup::TriangleSoup;
use header::Header;

/// Reads a whole PLY file.
pub(super) fn read(bytes: &[u8]) -> Result<TriangleSoup, Flaw> {
    let (header, payload) = header::read(bytes)?;
    let contents = match header.encoding {
        Encoding::Ascii => text::read(&header, payload)?,
        Encoding::BinaryLittleEndian | Encoding::BinaryBigEndian => {
            binary::read(&header, payload.rest(), bytes.len())?
        }
    };
    contents.faces.into_soup(contents.positions)
}

/// What a payload holds that is of use.
struct Contents {
    positions: Vec<[f64; 3]>,
    faces: FaceList,
}

impl Contents {
    /// Has room for the declared elements, as far as `size` bytes can hold them when each takes
    /// the given number of bytes or more.
    fn with_capacity(header: &Header, size: usize, vertex_bytes: usize, face_bytes: usize) -> Self {
        let room = |name, bytes| {
            let declared = header.elements.iter().find(|e| e.name == name);
            declared.map_or(0, |e| e.count.min(size / bytes + 1))
        };
        Self {
            positions: Vec::with_capacity(room("vertex", vertex_bytes)),
            faces: FaceList::with_capacity(room("face", face_bytes)),
        }
    }
}
