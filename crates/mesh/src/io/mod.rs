//! Mesh files: reading and writing of OBJ, PLY, OFF and STL, also compressed with gzip, and reading
//! of VTK, glTF, 3MF, COLLADA, GIFTI and `FreeSurfer`.
//!
//! [`read`] takes the format from the file extension. It returns a [`TriangleSoup`] with the
//! vertices in the file's order, counted from 0, at full `f64` precision. Polygons are cut into
//! triangles: into a fan from the first corner where that does not fold, else by ear clipping. The
//! soup records which face of the file each triangle is from, and which faces were left out because
//! they have fewer than three corners. Formats with scenes have their meshes where the nodes place
//! them, as parts of one soup; neither units nor axes are converted.
//!
//! A reader checks the format, not the mesh: a face may name a vertex that does not exist, and a
//! coordinate may be `nan`. [`Mesh::from_soup`](crate::Mesh::from_soup) finds all such defects at
//! once. A value that cannot be stored, such as a negative vertex number, is a [`FileError`] that
//! names the line or the element. Memory is bounded by the size of the file, not by the counts in
//! its header. The decompressed size of a compressed file is limited, by default to
//! [`usual_decompression_limit`], or to the limit of [`ReadOptions`].
//!
//! [`write`](fn@write) keeps every bit of the coordinates, except in STL. Reading a written file
//! returns the same soup, without the record of which triangles were cut from one polygon.

mod arrays;
mod beside;
mod collada;
mod error;
mod faces;
mod freesurfer;
mod gifti;
mod gltf;
mod gzip;
mod obj;
mod off;
mod packing;
mod ply;
mod quick_obj;
mod scene;
mod stl;
mod text;
mod threemf;
mod tobj;
mod triangulate;
mod vtk;
mod vtk_xml;
mod write;
mod xml;

use std::borrow::Cow;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use crate::soup::TriangleSoup;
use crate::weld::Weld;
use error::Flaw;
pub use error::{FileError, FilePosition};
pub use faces::{PolygonError, polygons};
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
    /// Legacy VTK, text or binary; read only, as all that follow.
    Vtk,
    /// XML files of VTK: `PolyData` and `UnstructuredGrid`.
    VtkXml,
    /// glTF 2.0, JSON or binary.
    Gltf,
    /// 3D Manufacturing Format.
    ThreeMf,
    /// COLLADA.
    Collada,
    /// GIFTI surfaces.
    Gifti,
    /// Triangle surfaces of `FreeSurfer`.
    FreeSurfer,
}

/// The endings of files that [`read`](fn@read) accepts, in words.
pub const READABLE: &str = ".obj, .ply, .off, .stl, .vtk, .vtp, .vtu, .gltf, .glb, .3mf, .dae, .gii or \
     .freesurfer, each also with .gz, or a FreeSurfer name such as lh.white";

/// The endings of formats.
const ENDINGS: [(&str, Format); 13] = [
    ("obj", Format::Obj),
    ("ply", Format::Ply),
    ("off", Format::Off),
    ("stl", Format::Stl),
    ("vtk", Format::Vtk),
    ("vtp", Format::VtkXml),
    ("vtu", Format::VtkXml),
    ("gltf", Format::Gltf),
    ("glb", Format::Gltf),
    ("3mf", Format::ThreeMf),
    ("dae", Format::Collada),
    ("gii", Format::Gifti),
    ("freesurfer", Format::FreeSurfer),
];

/// Usual names of the surfaces of a hemisphere, as `FreeSurfer` gives them without an ending:
/// `lh.white`.
const SURFACES: [&str; 8] = [
    "white",
    "pial",
    "inflated",
    "smoothwm",
    "sphere",
    "sphere.reg",
    "orig",
    "graymid",
];

impl Format {
    /// The format of the extension of `path`, in any letter case, with or without `.gz`.
    pub fn from_path(path: &Path) -> Option<Self> {
        let stem = path.file_stem().map(Path::new);
        let path = if is_gz(path) { stem? } else { path };
        if of_hemisphere(path).is_some_and(|name| SURFACES.contains(&name)) {
            return Some(Self::FreeSurfer);
        }
        let ending = path.extension()?.to_str()?;
        let mut known = ENDINGS.iter();
        let known = known.find(|(known, _)| known.eq_ignore_ascii_case(ending));
        known.map(|(_, format)| *format)
    }

    /// The format of a file: that of its extension, or of a surface of `FreeSurfer` with any name
    /// of a hemisphere, which its first bytes tell from other data.
    pub fn of_file(path: &Path) -> Option<Self> {
        Self::from_path(path).or_else(|| {
            of_hemisphere(path)?;
            let start = beside::part(path, 0, 3)?;
            (start == freesurfer::TRIANGLES).then_some(Self::FreeSurfer)
        })
    }

    /// The format whose keyword is the first word of `bytes`, for formats that have one.
    fn from_content(bytes: &[u8]) -> Option<Self> {
        let word = text::words(bytes.get(..80).unwrap_or(bytes)).next()?;
        match word {
            b"ply" => Some(Self::Ply),
            b"OFF" | b"COFF" | b"NOFF" | b"CNOFF" => Some(Self::Off),
            b"solid" => Some(Self::Stl),
            _ => None,
        }
        .or_else(|| {
            let starts: [(&[u8], _); 4] = [
                (b"glTF", Self::Gltf),
                (b"PK\x03\x04", Self::ThreeMf),
                (b"# vtk", Self::Vtk),
                (b"\xff\xff\xfe", Self::FreeSurfer),
            ];
            let mut starts = starts.into_iter();
            starts
                .find(|(start, _)| bytes.starts_with(start))
                .map(|(_, format)| format)
        })
    }

    /// Whether files are XML documents, which may be in UTF-16.
    fn is_xml(self) -> bool {
        matches!(self, Self::VtkXml | Self::Collada | Self::Gifti)
    }

    /// The usual name of the format.
    pub fn name(self) -> &'static str {
        match self {
            Self::Obj => "OBJ",
            Self::Ply => "PLY",
            Self::Off => "OFF",
            Self::Stl => "STL",
            Self::Vtk => "VTK",
            Self::VtkXml => "XML of VTK",
            Self::Gltf => "glTF",
            Self::ThreeMf => "3MF",
            Self::Collada => "COLLADA",
            Self::Gifti => "GIFTI",
            Self::FreeSurfer => "FreeSurfer",
        }
    }
}

/// Whether `path` has an extension that [`read`] accepts, or is a surface of `FreeSurfer`.
pub fn is_mesh_file(path: &Path) -> bool {
    Format::of_file(path).is_some()
}

/// Whether the name of `path` is that of a mesh file in a form of compression that is not read,
/// such as `horse.obj.xz`.
pub fn is_packed(path: &Path) -> bool {
    packing::problem_of_name(path).is_some()
}

/// Why a file with this name is not read, in words: its ending belongs to no format.
pub fn problem_of_ending(path: &Path) -> String {
    packing::problem_of_name(path)
        .unwrap_or_else(|| format!("the ending does not tell a mesh format; use {READABLE}"))
}

/// The files that [`read`] reads beside that at `path`: the buffers that a glTF file names, and the
/// data of GIFTI files. None for other formats, and where the file cannot be read.
pub fn files_beside(path: &Path) -> Vec<PathBuf> {
    let list = match Format::from_path(path) {
        Some(Format::Gltf) => gltf::buffer_files,
        Some(Format::Gifti) => gifti::data_files,
        _ => return Vec::new(),
    };
    let Some(bytes) = beside::part(path, 0, u64::MAX) else {
        return Vec::new();
    };
    if !gzip::is_gzip(&bytes) {
        return list(&bytes, path);
    }
    let inflated = gzip::inflate(&bytes, None, path).unwrap_or_default();
    list(&inflated, path)
}

/// Reads a mesh file. The format follows from the file extension; gzip is recognised by its
/// content.
///
/// ```
/// use geobench_mesh::{Mesh, io};
///
/// # let dir = tempfile::tempdir()?;
/// # let path = dir.path().join("square.off");
/// std::fs::write(&path, "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n")?;
/// let soup = io::read(&path)?;
/// assert_eq!(soup.positions[2], [1.0, 1.0, 0.0]);
/// assert_eq!(soup.triangles, [[0, 1, 2], [0, 2, 3]]);
/// assert_eq!(soup.file_faces, [0, 0]);
/// let (mesh, _report) = Mesh::from_soup(soup)?;
/// # assert_eq!(mesh.face_count(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// If the file cannot be opened or decompressed, its extension is unknown, or its content is
/// invalid or has no face.
pub fn read(path: &Path) -> Result<TriangleSoup, FileError> {
    ReadOptions::default().read(path)
}

/// Reads a mesh from the `bytes` of a file, which may be compressed. `path` is used in messages,
/// and to find files beside one of glTF or GIFTI.
///
/// # Errors
///
/// As [`read`], without those of opening the file.
pub fn read_bytes(bytes: &[u8], format: Format, path: &Path) -> Result<TriangleSoup, FileError> {
    ReadOptions::default().read_bytes(bytes, format, path)
}

/// Options for reading files.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReadOptions {
    /// The most bytes that a compressed file may decompress to, and that the meshes may take that
    /// the nodes of a scene place. `None` means the default limit ([`usual_decompression_limit`]).
    pub max_decompressed: Option<u64>,
    /// The reader of OBJ files.
    pub obj_reader: ObjReader,
    /// Which vertices are [welded](TriangleSoup::weld); `None` for none. STL files have no vertex
    /// numbers, so that their coincident vertices always are.
    pub weld: Option<Weld>,
}

/// A reader of OBJ files. If both readers accept a file, they return the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ObjReader {
    /// The reader of this crate. Its errors name the line.
    #[default]
    Direct,
    /// The library `tobj`, for comparison. It is four times slower and stricter, and its errors
    /// name no line.
    Tobj,
}

impl ObjReader {
    /// Its name: `direct` or `tobj`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Tobj => "tobj",
        }
    }
}

impl FromStr for ObjReader {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let mut all = [Self::Direct, Self::Tobj].into_iter();
        let found = all.find(|reader| reader.name() == name);
        found.ok_or_else(|| "the readers of OBJ files are `direct` and `tobj`".to_owned())
    }
}

impl ReadOptions {
    /// As [`read`](fn@read), with these options.
    ///
    /// # Errors
    ///
    /// As [`read`](fn@read).
    pub fn read(&self, path: &Path) -> Result<TriangleSoup, FileError> {
        let owned = || path.to_owned();
        let failed = |source: io::Error| match source.kind() {
            io::ErrorKind::NotFound => FileError::NotFound { path: owned() },
            io::ErrorKind::IsADirectory => FileError::Directory { path: owned() },
            _ => FileError::NotRead {
                path: owned(),
                source,
            },
        };
        if fs::metadata(path).map_err(failed)?.is_dir() {
            return Err(FileError::Directory { path: owned() });
        }
        let format =
            Format::of_file(path).ok_or_else(|| FileError::UnknownFormat { path: owned() })?;
        let bytes = fs::read(path).map_err(failed)?;
        self.read_bytes(&bytes, format, path)
    }

    /// As [`read_bytes`], with these options.
    ///
    /// # Errors
    ///
    /// As [`read_bytes`].
    pub fn read_bytes(
        &self,
        bytes: &[u8],
        format: Format,
        path: &Path,
    ) -> Result<TriangleSoup, FileError> {
        let owned = || path.to_owned();
        let limit = self.max_decompressed;
        let room = limit.unwrap_or_else(|| usual_decompression_limit(bytes.len() as u64));
        let bytes = if gzip::is_gzip(bytes) {
            Cow::Owned(gzip::inflate(bytes, self.max_decompressed, path)?)
        } else {
            Cow::Borrowed(bytes)
        };
        let bytes = &*bytes;
        if bytes.is_empty() {
            return Err(FileError::Empty { path: owned() });
        }
        let malformed = |place, problem| FileError::Malformed {
            path: owned(),
            place,
            problem,
        };
        // Binary STL may begin with any bytes.
        if format != Format::Stl
            && let Some(problem) = foreign_form(bytes, format)
        {
            return Err(malformed(FilePosition::File, problem));
        }
        let mesh = match (format, self.obj_reader) {
            (Format::Obj, ObjReader::Direct) => obj::read(bytes),
            (Format::Obj, ObjReader::Tobj) => tobj::read(bytes),
            (Format::Ply, _) => ply::read(bytes),
            (Format::Off, _) => off::read(bytes),
            (Format::Stl, _) => stl::read(bytes),
            (Format::Vtk, _) => vtk::read(bytes),
            (Format::VtkXml, _) => vtk_xml::read(bytes, room),
            (Format::Gltf, _) => gltf::read(bytes, path, room),
            (Format::ThreeMf, _) => threemf::read(bytes, room),
            (Format::Collada, _) => collada::read(bytes, room),
            (Format::Gifti, _) => gifti::read(bytes, path, room),
            (Format::FreeSurfer, _) => freesurfer::read(bytes),
        };
        let soup = mesh.and_then(|mesh| mesh.into_soup(self.weld));
        soup.map_err(|flaw| {
            let Flaw {
                place, mut problem, ..
            } = flaw;
            if flaw.is_over_limit {
                return FileError::OverLimit {
                    path: owned(),
                    place,
                    problem: shortened(problem),
                };
            }
            if let Some(problem) = foreign_form(bytes, format) {
                return malformed(FilePosition::File, problem);
            }
            if let Some(other) = Format::from_content(bytes).filter(|&other| other != format) {
                problem.push_str(" (it starts like a file in ");
                problem.push_str(other.name());
                problem.push_str(" format: correct its ending)");
            }
            malformed(place, shortened(problem))
        })
    }
}

/// What `bytes` are if no file in `format` begins like them: text in wide characters, a pointer to
/// data, or a form of compression that is not read. In words, with a remedy.
fn foreign_form(bytes: &[u8], format: Format) -> Option<String> {
    let in_wide_text =
        |name: &str| format!("its text is in {name}; save it as UTF-8 (iconv -f {name} -t UTF-8)");
    if is_utf32(bytes) {
        Some(in_wide_text("UTF-32"))
    } else if is_utf16(bytes) && !format.is_xml() {
        Some(in_wide_text("UTF-16"))
    } else if bytes.starts_with(b"version https://git-lfs.github.com/spec/v1") {
        let problem = "this is a pointer of Git LFS; its data was not fetched: git lfs pull";
        Some(problem.to_owned())
    } else {
        packing::problem_of_content(bytes, format)
    }
}

/// `problem`, without its middle if it quotes much of a file.
fn shortened(problem: String) -> String {
    const KEPT: usize = 200;
    let mut from_start = problem.char_indices().skip(KEPT);
    let mut from_end = problem.char_indices().rev().skip(KEPT - 1);
    match (from_start.next(), from_end.next()) {
        (Some((head, _)), Some((tail, _))) if head + KEPT < tail => {
            format!("{} … {}", &problem[..head], &problem[tail..])
        }
        _ => problem,
    }
}

/// Whether `bytes` begin as text in UTF-16: with its byte order mark, or with characters of ASCII
/// that are two bytes each.
fn is_utf16(bytes: &[u8]) -> bool {
    let has_mark = bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff");
    let pairs = bytes.as_chunks::<2>().0.iter().take(8);
    let is_ascii = |b: u8| (1..0x80).contains(&b);
    has_mark
        || bytes.len() >= 16 && pairs.clone().all(|&[a, b]| is_ascii(a) && b == 0)
        || bytes.len() >= 16 && pairs.clone().all(|&[a, b]| a == 0 && is_ascii(b))
}

/// Whether `bytes` begin as text in UTF-32, as [`is_utf16`] does.
fn is_utf32(bytes: &[u8]) -> bool {
    let has_mark = bytes.starts_with(b"\xff\xfe\0\0") || bytes.starts_with(b"\0\0\xfe\xff");
    let mut units = bytes.as_chunks::<4>().0.iter().take(4);
    let is_ascii = |b: u8| (1..0x80).contains(&b);
    let is_character = |&[a, b, c, d]: &[u8; 4]| {
        [b, c, d] == [0; 3] && is_ascii(a) || [a, b, c] == [0; 3] && is_ascii(d)
    };
    has_mark || bytes.len() >= 16 && units.all(is_character)
}

/// What follows the name of the hemisphere in the name of `path`.
fn of_hemisphere(path: &Path) -> Option<&str> {
    let name = path.file_name()?.to_str()?;
    name.strip_prefix("lh.")
        .or_else(|| name.strip_prefix("rh."))
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
        assert_eq!(of("a.GLB"), Some(Format::Gltf));
        assert_eq!(of("sub/lh.pial"), Some(Format::FreeSurfer));
        assert_eq!(of("rh.sphere.reg.gz"), Some(Format::FreeSurfer));
        assert_eq!(of("lh.pial.surf.gii"), Some(Format::Gifti));
        for name in [
            "lh.thickness",
            "x.pial",
            "obj",
            ".obj",
            "a.gz",
            "a.ply.zip",
            "a.gz.gz",
            "a.",
            "",
        ] {
            assert_eq!(of(name), None, "{name}");
        }
    }
}
