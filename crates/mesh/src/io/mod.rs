//! Mesh files: OBJ, PLY, OFF and STL in, OBJ and PLY out, each also compressed with gzip.
//!
//! [`read`] takes the format from the ending of the name and delivers a [`TriangleSoup`] with the
//! vertices in the file's own order, counted from 0, at full `f64` precision. Polygons are cut
//! into triangles: a fan from the first corner where that does not fold, else ears; the soup then
//! knows which face of the file each triangle is from. Faces with fewer than three corners are
//! left out, and the soup knows which.
//!
//! A reader checks what the format says, not what the mesh is: a face may name a vertex that does
//! not exist, and a coordinate may be `nan`. [`Mesh::from_soup`](crate::Mesh::from_soup) finds all
//! such defects at once. What cannot be stored at all, such as a negative vertex number, is a
//! [`ReadError`] that names the line or the element. Memory follows the size of the file, never
//! the counts in its header. A compressed file may not decompress to more than a limit: the usual
//! one ([`usual_decompression_limit`]), or the one given to [`read_with_limit`].
//!
//! [`write`](fn@write) keeps every bit: reading a written file gives back the same soup, apart
//! from which triangles were cut from one polygon.

mod error;
mod faces;
mod gzip;
mod obj;
mod off;
mod ply;
mod stl;
mod text;
mod triangulate;
mod write;

use std::borrow::Cow;
use std::fs;
use std::io;
use std::path::Path;

use crate::soup::TriangleSoup;
use error::Flaw;
pub use error::{Place, ReadError, WriteError};
pub use gzip::usual_decompression_limit;
pub use write::{PlyEncoding, PlyWriter, write, write_obj};

/// A mesh file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// Wavefront OBJ.
    Obj,
    /// Polygon file format of Stanford, text or binary.
    Ply,
    /// Object file format of Geomview, text.
    Off,
    /// Stereolithography, text or binary.
    Stl,
}

impl Format {
    /// The format that the ending of `path` tells, in any letter case and with or without `.gz`.
    pub fn from_path(path: &Path) -> Option<Self> {
        let stem = path.file_stem().map(Path::new);
        let path = if is_gz(path) { stem? } else { path };
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        match ending.as_str() {
            "obj" => Some(Self::Obj),
            "ply" => Some(Self::Ply),
            "off" => Some(Self::Off),
            "stl" => Some(Self::Stl),
            _ => None,
        }
    }

    /// The format whose keyword `bytes` start with, for those that have one.
    fn from_content(bytes: &[u8]) -> Option<Self> {
        let word = text::words(bytes.get(..80).unwrap_or(bytes)).next()?;
        match word {
            b"ply" => Some(Self::Ply),
            b"OFF" | b"COFF" | b"NOFF" | b"CNOFF" => Some(Self::Off),
            b"solid" => Some(Self::Stl),
            _ => None,
        }
    }

    /// What people call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Obj => "OBJ",
            Self::Ply => "PLY",
            Self::Off => "OFF",
            Self::Stl => "STL",
        }
    }
}

/// Whether [`read`] would try to read `path`, going by its ending alone.
pub fn is_mesh_file(path: &Path) -> bool {
    Format::from_path(path).is_some()
}

/// Reads a mesh file in the format its ending tells; gzip is recognised by its content.
///
/// # Errors
///
/// When the file cannot be opened or decompressed, its ending is unknown, or its content breaks
/// the rules of the format or holds no face.
pub fn read(path: &Path) -> Result<TriangleSoup, ReadError> {
    read_with_limit(path, None)
}

/// As [`read`], but a compressed file may decompress to `limit` bytes, or to the usual number
/// ([`usual_decompression_limit`]) if that is `None`.
///
/// # Errors
///
/// As [`read`].
pub fn read_with_limit(path: &Path, limit: Option<u64>) -> Result<TriangleSoup, ReadError> {
    let owned = || path.to_owned();
    let failed = |source: io::Error| match source.kind() {
        io::ErrorKind::NotFound => ReadError::NotFound { path: owned() },
        io::ErrorKind::IsADirectory => ReadError::Directory { path: owned() },
        _ => ReadError::Io {
            path: owned(),
            source,
        },
    };
    if fs::metadata(path).map_err(failed)?.is_dir() {
        return Err(ReadError::Directory { path: owned() });
    }
    let format =
        Format::from_path(path).ok_or_else(|| ReadError::UnknownFormat { path: owned() })?;
    let bytes = fs::read(path).map_err(failed)?;
    read_bytes_with_limit(&bytes, format, path, limit)
}

/// Reads a mesh from the `bytes` of a file, compressed or not; `path` is for messages only.
///
/// # Errors
///
/// As [`read`], but for opening the file.
pub fn read_bytes(bytes: &[u8], format: Format, path: &Path) -> Result<TriangleSoup, ReadError> {
    read_bytes_with_limit(bytes, format, path, None)
}

/// As [`read_bytes`], with the limit of [`read_with_limit`].
///
/// # Errors
///
/// As [`read_bytes`].
pub fn read_bytes_with_limit(
    bytes: &[u8],
    format: Format,
    path: &Path,
    limit: Option<u64>,
) -> Result<TriangleSoup, ReadError> {
    let owned = || path.to_owned();
    let bytes = if gzip::is_gzip(bytes) {
        Cow::Owned(gzip::inflate(bytes, limit, path)?)
    } else {
        Cow::Borrowed(bytes)
    };
    let bytes = &*bytes;
    if bytes.is_empty() {
        return Err(ReadError::Empty { path: owned() });
    }
    let soup = match format {
        Format::Obj => obj::read(bytes),
        Format::Ply => ply::read(bytes),
        Format::Off => off::read(bytes),
        Format::Stl => stl::read(bytes),
    };
    soup.map_err(|Flaw { place, mut problem }| {
        if let Some(other) = Format::from_content(bytes).filter(|&other| other != format) {
            problem.push_str(" (it starts like a file in ");
            problem.push_str(other.name());
            problem.push_str(" format: correct its ending)");
        }
        ReadError::Malformed {
            path: owned(),
            place,
            problem,
        }
    })
}

/// Whether the name of `path` ends in `.gz`.
fn is_gz(path: &Path) -> bool {
    path.extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("gz"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endings_tell_the_format() {
        let of = |name: &str| Format::from_path(Path::new(name));
        assert_eq!(of("a.obj"), Some(Format::Obj));
        assert_eq!(of("dir.x/A.B.PLY"), Some(Format::Ply));
        assert_eq!(of("a.Off.GZ"), Some(Format::Off));
        assert_eq!(of("a.stl.gz"), Some(Format::Stl));
        for name in ["obj", ".obj", "a.gz", "a.ply.zip", "a.gz.gz", "a.", ""] {
            assert_eq!(of(name), None, "{name}");
        }
    }
}
