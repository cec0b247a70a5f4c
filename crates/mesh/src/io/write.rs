//! Writing OBJ, PLY, OFF and STL.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use flate2::Compression;
use flate2::write::GzEncoder;

use super::error::FileError;
use super::{Format, is_gz};
use crate::soup::TriangleSoup;
use crate::vector::{cross, norm, sub};

/// Writes `soup` in the format of the extension of `path`: `.obj`, `.ply` (binary, little endian),
/// `.off` or `.stl` (binary), each also with `.gz`.
///
/// Every bit of the coordinates is kept, except in STL, which has single precision and repeats the
/// corners of every triangle. The record of which triangles were cut from one polygon is not
/// written.
///
/// # Errors
///
/// If the extension belongs to no such format, or the file cannot be written.
pub fn write(path: &Path, soup: &TriangleSoup) -> Result<(), FileError> {
    let (positions, triangles) = (&soup.positions, &soup.triangles);
    match Format::from_path(path) {
        Some(Format::Obj) => to_file(path, |out| write_obj(out, positions, triangles)),
        Some(Format::Ply) => PlyWriter::new(positions, triangles).write_file(path),
        Some(Format::Off) => to_file(path, |out| write_off(out, positions, triangles)),
        Some(Format::Stl) => to_file(path, |out| write_stl(out, positions, triangles)),
        _ => Err(FileError::UnknownOutput {
            path: path.to_owned(),
        }),
    }
}

/// Writes an OBJ file with the shortest decimals that read back as the same `f64`.
///
/// # Errors
///
/// The errors of `out`.
pub fn write_obj(
    out: &mut (impl Write + ?Sized),
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
) -> io::Result<()> {
    for [x, y, z] in positions {
        // The debug form uses an exponent for very large and small numbers.
        writeln!(out, "v {x:?} {y:?} {z:?}")?;
    }
    for corners in triangles {
        let [a, b, c] = corners.map(|v| u64::from(v) + 1);
        writeln!(out, "f {a} {b} {c}")?;
    }
    Ok(())
}

/// Writes an OFF file with the shortest decimals that read back as the same `f64`.
fn write_off(
    out: &mut (impl Write + ?Sized),
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
) -> io::Result<()> {
    writeln!(out, "OFF\n{} {} 0", positions.len(), triangles.len())?;
    for [x, y, z] in positions {
        writeln!(out, "{x:?} {y:?} {z:?}")?;
    }
    for [a, b, c] in triangles {
        writeln!(out, "3 {a} {b} {c}")?;
    }
    Ok(())
}

/// Writes a binary STL file.
fn write_stl(
    out: &mut (impl Write + ?Sized),
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
) -> io::Result<()> {
    let count = u32::try_from(triangles.len());
    let count = count.map_err(|e| io::Error::new(io::ErrorKind::InvalidInput, e))?;
    // Not `solid`, with which text files begin.
    let mut header = [b' '; 80];
    header[..8].copy_from_slice(b"geobench");
    out.write_all(&header)?;
    out.write_all(&count.to_le_bytes())?;
    for corners in triangles {
        let missing = corners.iter().find(|&&v| v as usize >= positions.len());
        if let Some(v) = missing {
            let message = format!("a triangle has vertex {v}, which does not exist");
            return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
        }
        let corners = corners.map(|v| positions[v as usize]);
        let normal = cross(sub(corners[1], corners[0]), sub(corners[2], corners[0]));
        let length = norm(normal);
        let normal = normal.map(|x| if length > 0.0 { x / length } else { 0.0 });
        for x in [[normal].as_slice(), &corners].concat().as_flattened() {
            #[expect(clippy::cast_possible_truncation, reason = "STL has single precision")]
            let single = *x as f32;
            if single.is_infinite() && x.is_finite() {
                let message = format!("{x:e} is too large for the single precision of STL");
                return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
            }
            out.write_all(&single.to_le_bytes())?;
        }
        out.write_all(&[0, 0])?;
    }
    Ok(())
}

/// The encoding of the payload of a PLY file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PlyEncoding {
    /// Binary, low byte first.
    #[default]
    LittleEndian,
    /// Binary, high byte first.
    BigEndian,
    /// Text, one line for each element.
    Ascii,
}

/// Writes PLY files, with further vertex properties in addition to the coordinates.
///
/// ```
/// use geobench_mesh::io::{PlyEncoding, PlyWriter};
///
/// let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mut file = Vec::new();
/// PlyWriter::new(&positions, &[[0, 1, 2]])
///     .encoding(PlyEncoding::Ascii)
///     .scalars("quality", &[0.0, 1.0, 1.0])
///     .colors(&[[0, 0, 255], [255, 0, 0], [255, 0, 0]])
///     .write(&mut file)?;
/// assert!(file.ends_with(b"0.0 1.0 0.0 1.0 255 0 0\n3 0 1 2\n"));
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct PlyWriter<'a> {
    positions: &'a [[f64; 3]],
    triangles: &'a [[u32; 3]],
    encoding: PlyEncoding,
    comments: Vec<&'a str>,
    columns: Vec<VertexProperty<'a>>,
}

/// A further property, or group of properties, of all vertices.
#[derive(Clone, Copy, Debug)]
enum VertexProperty<'a> {
    Scalars(&'a str, &'a [f64]),
    Colors(&'a [[u8; 3]]),
}

impl VertexProperty<'_> {
    fn len(&self) -> usize {
        match self {
            Self::Scalars(_, values) => values.len(),
            Self::Colors(values) => values.len(),
        }
    }
}

impl<'a> PlyWriter<'a> {
    /// A writer of a mesh: binary, little endian, without further properties.
    pub fn new(positions: &'a [[f64; 3]], triangles: &'a [[u32; 3]]) -> Self {
        Self {
            positions,
            triangles,
            encoding: PlyEncoding::default(),
            comments: Vec::new(),
            columns: Vec::new(),
        }
    }

    /// Sets the encoding of the payload.
    #[must_use]
    pub fn encoding(mut self, encoding: PlyEncoding) -> Self {
        self.encoding = encoding;
        self
    }

    /// Adds a comment to the header. Line breaks in it become blanks.
    #[must_use]
    pub fn comment(mut self, comment: &'a str) -> Self {
        self.comments.push(comment);
        self
    }

    /// Adds the property `name` of type `double`, with a value for each vertex. Viewers colour by a
    /// scalar named `quality`.
    ///
    /// `name` must be one word. In text, values that are not finite are written as `inf` and `NaN`.
    #[must_use]
    pub fn scalars(mut self, name: &'a str, values: &'a [f64]) -> Self {
        self.columns.push(VertexProperty::Scalars(name, values));
        self
    }

    /// Adds the properties `red`, `green` and `blue` of type `uchar`, with values for each vertex.
    #[must_use]
    pub fn colors(mut self, colors: &'a [[u8; 3]]) -> Self {
        self.columns.push(VertexProperty::Colors(colors));
        self
    }

    /// Writes the file `path`, compressed if its name ends in `.gz`.
    ///
    /// # Errors
    ///
    /// If the file cannot be written, and those of [`write`](Self::write).
    fn write_file(&self, path: &Path) -> Result<(), FileError> {
        to_file(path, |out| self.write(out))
    }

    /// Writes the mesh to `out` in many small pieces; `out` should be buffered.
    ///
    /// # Errors
    ///
    /// The errors of `out`, and [`InvalidInput`](io::ErrorKind::InvalidInput) if a further property
    /// does not have exactly one value for each vertex.
    pub fn write(&self, out: &mut (impl Write + ?Sized)) -> io::Result<()> {
        let vertex_count = self.positions.len();
        if let Some(column) = self.columns.iter().find(|c| c.len() != vertex_count) {
            return Err(io::Error::new(
                io::ErrorKind::InvalidInput,
                format!(
                    "a vertex property has {} values for {vertex_count} vertices",
                    column.len()
                ),
            ));
        }
        self.write_header(out)?;
        let mut row = Row {
            encoding: self.encoding,
            bytes: Vec::new(),
        };
        for (v, position) in self.positions.iter().enumerate() {
            for &x in position {
                row.double(x);
            }
            for column in &self.columns {
                match column {
                    VertexProperty::Scalars(_, values) => row.double(values[v]),
                    VertexProperty::Colors(values) => values[v].iter().for_each(|&c| row.uchar(c)),
                }
            }
            row.write(out)?;
        }
        for corners in self.triangles {
            row.uchar(3);
            for &v in corners {
                row.uint(v);
            }
            row.write(out)?;
        }
        Ok(())
    }

    fn write_header(&self, out: &mut (impl Write + ?Sized)) -> io::Result<()> {
        let encoding = match self.encoding {
            PlyEncoding::LittleEndian => "binary_little_endian",
            PlyEncoding::BigEndian => "binary_big_endian",
            PlyEncoding::Ascii => "ascii",
        };
        writeln!(out, "ply\nformat {encoding} 1.0")?;
        for comment in &self.comments {
            writeln!(out, "comment {}", comment.replace(['\n', '\r'], " "))?;
        }
        writeln!(out, "element vertex {}", self.positions.len())?;
        for axis in ["x", "y", "z"] {
            writeln!(out, "property double {axis}")?;
        }
        for column in &self.columns {
            match column {
                VertexProperty::Scalars(name, _) => writeln!(out, "property double {name}")?,
                VertexProperty::Colors(_) => {
                    for channel in ["red", "green", "blue"] {
                        writeln!(out, "property uchar {channel}")?;
                    }
                }
            }
        }
        writeln!(out, "element face {}", self.triangles.len())?;
        writeln!(
            out,
            "property list uchar {} vertex_indices",
            self.index_type()
        )?;
        writeln!(out, "end_header")
    }

    /// `int`, which every program reads, unless a vertex number does not fit.
    fn index_type(&self) -> &'static str {
        let largest = self.triangles.as_flattened().iter().max();
        if largest.is_some_and(|&v| i32::try_from(v).is_err()) {
            "uint"
        } else {
            "int"
        }
    }
}

/// The properties of one element, collected before they are written.
struct Row {
    encoding: PlyEncoding,
    bytes: Vec<u8>,
}

/// Defines how a number is appended: as bytes, or as a word in its debug form, which is the
/// shortest that parses to the same number.
macro_rules! append {
    ($name:ident, $type:ty) => {
        fn $name(&mut self, value: $type) {
            match self.encoding {
                PlyEncoding::LittleEndian => self.bytes.extend_from_slice(&value.to_le_bytes()),
                PlyEncoding::BigEndian => self.bytes.extend_from_slice(&value.to_be_bytes()),
                PlyEncoding::Ascii => {
                    let blank = if self.bytes.is_empty() { "" } else { " " };
                    self.bytes
                        .extend_from_slice(format!("{blank}{value:?}").as_bytes());
                }
            }
        }
    };
}

impl Row {
    append!(uchar, u8);
    append!(uint, u32);
    append!(double, f64);

    /// Writes the element and starts the next one.
    fn write(&mut self, out: &mut (impl Write + ?Sized)) -> io::Result<()> {
        if self.encoding == PlyEncoding::Ascii {
            self.bytes.push(b'\n');
        }
        out.write_all(&self.bytes)?;
        self.bytes.clear();
        Ok(())
    }
}

/// Creates the file `path` and writes `content` to it, through gzip if its name ends in `.gz`.
fn to_file(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), FileError> {
    let write = || {
        let mut file = BufWriter::new(File::create(path)?);
        if is_gz(path) {
            let mut gz = BufWriter::new(GzEncoder::new(file, Compression::default()));
            content(&mut gz)?;
            file = gz.into_inner().map_err(io::Error::from)?.finish()?;
        } else {
            content(&mut file)?;
        }
        file.flush()
    };
    write().map_err(|source| FileError::NotWritten {
        path: path.to_owned(),
        source,
    })
}
