//! File formats for distance fields and matrices of distances.

use geobench_mesh::io::PlyWriter;
use geobench_mesh::{Mesh, VertexId, threads};
use serde::Serialize;

use crate::vtk_xml::{Array, ArrayValues, PolyData, vtk_title};
use crate::{FileFormat, SourceLabel, json_line, no_coordinates};

/// Distances with their origin.
#[derive(Clone, Copy, Debug)]
pub struct DistanceFile<'a> {
    /// Name of the model.
    pub model: &'a str,
    /// Name of the algorithm.
    pub algorithm: &'a str,
    /// The sources. Distances are measured from the nearest one, but in pairs.
    pub sources: &'a [SourceLabel],
    /// The targets.
    pub targets: FieldTargets<'a>,
    /// Longer distances are infinite.
    pub radius: Option<f64>,
    /// The mesh.
    pub mesh: &'a Mesh,
    /// Distance of each vertex in the file's order, or of each target; infinite where no path
    /// leads, or none within the radius.
    pub distances: &'a [f64],
}

/// The points whose distances a file has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldTargets<'a> {
    /// All vertices.
    Vertices,
    /// These.
    Points(&'a [SourceLabel]),
    /// One for each source, from which its distance is measured.
    Pairs(&'a [SourceLabel]),
}

impl<'a> FieldTargets<'a> {
    /// The targets; `None` for all vertices.
    pub const fn labels(self) -> Option<&'a [SourceLabel]> {
        match self {
            Self::Vertices => None,
            Self::Points(labels) | Self::Pairs(labels) => Some(labels),
        }
    }
}

/// A file format for matrices of distances.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MatrixFormat {
    /// A line with the names of the columns, then a line for each source, which starts with its
    /// name.
    Csv,
    /// A two-dimensional `NumPy` array of f64.
    Npy,
}

impl FileFormat for MatrixFormat {
    const CONTENT: &'static str = "a matrix of distances";
    const ENDINGS: &'static [(&'static str, Self)] = &[("csv", Self::Csv), ("npy", Self::Npy)];
}

impl MatrixFormat {
    /// What precedes the rows of a matrix with this number of rows and these columns, which are
    /// vertices or targets.
    pub fn head(self, rows: usize, columns: &[SourceLabel]) -> Vec<u8> {
        if self == Self::Npy {
            let shape = format!("({rows}, {})", columns.len());
            return npy(&shape, &[]);
        }
        let mut text = "source".to_owned();
        for column in columns {
            text.push(',');
            text += &csv_word(column);
        }
        text.push('\n');
        text.into_bytes()
    }

    /// The row of a source.
    pub fn row(self, source: &SourceLabel, distances: &[f64]) -> Vec<u8> {
        if self == Self::Npy {
            return distances.iter().flat_map(|d| d.to_le_bytes()).collect();
        }
        let mut text = csv_word(source);
        for distance in distances {
            text.push(',');
            text += &distance.to_string();
        }
        text.push('\n');
        text.into_bytes()
    }
}

/// A source or target in a CSV file, in quotes unless it is a vertex.
pub(crate) fn csv_word(label: &SourceLabel) -> String {
    match label {
        SourceLabel::Vertex(vertex) => vertex.to_string(),
        SourceLabel::Other(text) => format!("\"{text}\""),
    }
}

/// A file format for distance fields.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldFormat {
    /// `vertex,distance`, one line for each vertex, or `target,distance`, or
    /// `source,target,distance`; `inf` where no path leads.
    Csv,
    /// The distances with their sources and the number of unreachable vertices, which are `null`.
    Json,
    /// A one-dimensional `NumPy` array of f64; infinity where no path leads.
    Npy,
    /// The mesh (binary), with the distance as the `quality` of a vertex and as its texture
    /// coordinate, infinity where no path leads, and a colour ramp, grey where no path leads.
    Ply,
    /// The mesh (XML `PolyData` of VTK), with the point arrays `distance` and `reached` as in
    /// [`Self::Vtk`].
    Vtp,
    /// The mesh (legacy VTK, binary, an unstructured grid), with the scalar field `distance`,
    /// infinity where no path leads, and the field `reached`, which is 0 there and 1 elsewhere.
    Vtk,
}

impl FileFormat for FieldFormat {
    const CONTENT: &'static str = "distances";
    const ENDINGS: &'static [(&'static str, Self)] = &[
        ("csv", Self::Csv),
        ("json", Self::Json),
        ("npy", Self::Npy),
        ("ply", Self::Ply),
        ("vtp", Self::Vtp),
        ("vtk", Self::Vtk),
    ];
}

impl FieldFormat {
    /// Whether the format holds the mesh and therefore needs the distances of all vertices.
    pub const fn is_mesh(self) -> bool {
        matches!(self, Self::Ply | Self::Vtp | Self::Vtk)
    }

    /// The contents of a file in this format.
    ///
    /// # Errors
    ///
    /// When the format needs coordinates and the mesh has none.
    pub fn render(self, field: &DistanceFile<'_>) -> anyhow::Result<Vec<u8>> {
        if self.is_mesh() && field.mesh.positions().len() != field.distances.len() {
            return Err(no_coordinates(field.model));
        }
        Ok(match self {
            Self::Csv => csv(field),
            Self::Json => json(field)?,
            Self::Npy => npy(&format!("({},)", field.distances.len()), field.distances),
            Self::Ply => ply(field)?,
            Self::Vtp => vtp(field),
            Self::Vtk => vtk(field),
        })
    }
}

/// CSV with as many digits as needed to read the numbers back exactly. Lines are formatted in
/// parallel.
fn csv(field: &DistanceFile<'_>) -> Vec<u8> {
    use std::fmt::Write;
    let Some(targets) = field.targets.labels() else {
        let lines = threads::each(threads::ranges(field.distances.len(), 1), |range| {
            const LINE: usize = 28; // Of at most seven digits and seventeen more.
            let mut text = String::with_capacity(LINE * (range.len() + 1));
            if range.start == 0 {
                text += "vertex,distance\n";
            }
            let mut vertices = itoa::Buffer::new();
            let mut numbers = zmij::Buffer::new();
            for vertex in range {
                text += vertices.format(vertex);
                text.push(',');
                push_number(&mut text, &mut numbers, field.distances[vertex]);
                text.push('\n');
            }
            text.into_bytes()
        });
        return lines
            .into_iter()
            .reduce(|a, b| [a, b].concat())
            .unwrap_or_default();
    };
    let of_pairs = matches!(field.targets, FieldTargets::Pairs(_));
    let mut text = if of_pairs { "source," } else { "" }.to_owned();
    text += "target,distance\n";
    for (i, (target, distance)) in targets.iter().zip(field.distances).enumerate() {
        if let Some(source) = field.sources.get(i).filter(|_| of_pairs) {
            text += &csv_word(source);
            text.push(',');
        }
        let _ = writeln!(text, "{},{distance}", csv_word(target));
    }
    text.into_bytes()
}

/// Appends `number` in the format of `Display`: the shortest digits that read back exactly, without
/// an exponent.
fn push_number(text: &mut String, buffer: &mut zmij::Buffer, number: f64) {
    use std::fmt::Write;
    let shortest = buffer.format(number);
    if shortest.contains('e') {
        let _ = write!(text, "{number}"); // Writing to a string cannot fail.
    } else {
        *text += shortest.strip_suffix(".0").unwrap_or(shortest);
    }
}

/// Appends the bytes of each of `numbers`.
fn append<T, const N: usize>(
    bytes: &mut Vec<u8>,
    numbers: impl IntoIterator<Item = T>,
    to_bytes: fn(T) -> [u8; N],
) {
    for number in numbers {
        bytes.extend_from_slice(&to_bytes(number));
    }
}

#[derive(Serialize)]
struct DistanceDocument<'a> {
    model: &'a str,
    algorithm: &'a str,
    sources: &'a [SourceLabel],
    /// Whether each distance is that of a source and the target at the same place.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pairs: bool,
    /// Null for no limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    radius: Option<f64>,
    vertices: usize,
    /// The targets, in the order of the distances; absent if these are of all vertices.
    #[serde(skip_serializing_if = "Option::is_none")]
    targets: Option<&'a [SourceLabel]>,
    /// The number of distances that are null: unreachable, or beyond the radius.
    unreachable: usize,
    distances: Vec<Option<f64>>,
}

impl DistanceFile<'_> {
    fn title(&self) -> String {
        format!(
            "geodesic distance by {}, model {}",
            self.algorithm, self.model
        )
    }

    fn triangles(&self) -> Vec<[u32; 3]> {
        let faces = self.mesh.faces();
        faces
            .map(|face| self.mesh.face_vertices(face).map(VertexId::raw))
            .collect()
    }

    /// For each vertex 1 if a path leads there, else 0.
    fn reached(&self) -> impl Iterator<Item = u8> {
        self.distances.iter().map(|d| u8::from(d.is_finite()))
    }
}

/// One JSON object. Infinite distances are `null`, because JSON has no infinity.
fn json(field: &DistanceFile<'_>) -> anyhow::Result<Vec<u8>> {
    let distances: Vec<Option<f64>> = field
        .distances
        .iter()
        .map(|d| d.is_finite().then_some(*d))
        .collect();
    let document = DistanceDocument {
        model: field.model,
        algorithm: field.algorithm,
        sources: field.sources,
        radius: field.radius,
        vertices: field.mesh.vertex_count(),
        pairs: matches!(field.targets, FieldTargets::Pairs(_)),
        targets: field.targets.labels(),
        unreachable: distances.iter().filter(|d| d.is_none()).count(),
        distances,
    };
    json_line(&document)
}

/// Start of a `NumPy` array, version 1.0 (`numpy.lib.format`): magic and version. The length of the
/// header, the header padded to 64 bytes and the numbers follow.
const NPY_MAGIC: &[u8] = b"\x93NUMPY\x01\x00";

/// A little-endian f64 array of this shape, row after row.
fn npy(shape: &str, distances: &[f64]) -> Vec<u8> {
    let bytes = distances.iter().flat_map(|d| d.to_le_bytes());
    npy_of("<f8", shape, bytes)
}

/// An array of type `descr` and this shape, from the bytes of its numbers.
pub(super) fn npy_of(descr: &str, shape: &str, numbers: impl Iterator<Item = u8>) -> Vec<u8> {
    let mut header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}");
    // Magic, version, length, header and the final line break add up to a multiple of 64.
    let used = NPY_MAGIC.len() + 2 + header.len() + 1;
    header += &" ".repeat(used.next_multiple_of(64) - used);
    header.push('\n');

    let mut bytes = NPY_MAGIC.to_vec();
    bytes.extend_from_slice(&(header.len() as u16).to_le_bytes());
    bytes.extend_from_slice(header.as_bytes());
    bytes.extend(numbers);
    bytes
}

/// The mesh with colours and distances. Mesh programs read the property `quality` as a vertex
/// scalar. VTK reads no scalars from PLY files, but it reads texture coordinates, so the distance
/// is also the first texture coordinate.
fn ply(field: &DistanceFile<'_>) -> anyhow::Result<Vec<u8>> {
    let triangles = field.triangles();
    let colours: Vec<[u8; 3]> = colours(field.distances).collect();
    let nothing = vec![0.0; field.distances.len()];
    let mut bytes = Vec::new();
    PlyWriter::new(field.mesh.positions(), &triangles)
        .comment(&field.title())
        .scalars("quality", field.distances)
        .scalars("texture_u", field.distances)
        .scalars("texture_v", &nothing)
        .colors(&colours)
        .write(&mut bytes)?;
    Ok(bytes)
}

fn vtp(field: &DistanceFile<'_>) -> Vec<u8> {
    let (title, triangles) = (field.title(), field.triangles());
    let mut data = PolyData::triangles(&title, field.mesh.positions(), &triangles);
    data.point_data = vec![
        Array::doubles("distance", field.distances.iter().copied()),
        Array {
            name: "reached",
            values: ArrayValues::Byte(field.reached().collect()),
        },
    ];
    data.render()
}

/// The VTK cell type of triangles.
const VTK_TRIANGLE: u32 = 5;

/// Legacy VTK: the mesh with the fields `distance` and `reached`. Binary (big-endian), because the
/// text form cannot write infinity in a way that every reader accepts; an unstructured grid,
/// because some readers know no others.
fn vtk(field: &DistanceFile<'_>) -> Vec<u8> {
    let (vertices, faces) = (field.distances.len(), field.mesh.face_count());
    let title = vtk_title(&field.title());
    let mut bytes = format!(
        "# vtk DataFile Version 3.0\n{title}\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS {vertices} double\n"
    )
    .into_bytes();
    let coordinates = field.mesh.positions().as_flattened().iter().copied();
    append(&mut bytes, coordinates, f64::to_be_bytes);
    bytes.extend_from_slice(format!("\nCELLS {faces} {}\n", 4 * faces).as_bytes());
    for face in field.mesh.faces() {
        let [a, b, c] = field.mesh.face_vertices(face).map(VertexId::raw);
        append(&mut bytes, [3, a, b, c], u32::to_be_bytes);
    }
    bytes.extend_from_slice(format!("\nCELL_TYPES {faces}\n").as_bytes());
    append(
        &mut bytes,
        (0..faces).map(|_| VTK_TRIANGLE),
        u32::to_be_bytes,
    );
    bytes.extend_from_slice(
        format!("\nPOINT_DATA {vertices}\nSCALARS distance double 1\nLOOKUP_TABLE default\n")
            .as_bytes(),
    );
    append(
        &mut bytes,
        field.distances.iter().copied(),
        f64::to_be_bytes,
    );
    bytes.extend_from_slice(b"\nSCALARS reached unsigned_char 1\nLOOKUP_TABLE default\n");
    bytes.extend(field.reached());
    bytes.push(b'\n');
    bytes
}

/// Nine evenly spaced colours of a ramp from dark blue over green to yellow (after "viridis"). Its
/// lightness increases steadily, so it is readable in greyscale and with most kinds of colour
/// blindness.
pub(crate) const RAMP: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 44, 122],
    [59, 81, 139],
    [44, 113, 142],
    [33, 144, 141],
    [39, 173, 129],
    [92, 200, 99],
    [170, 220, 50],
    [253, 231, 37],
];

/// The colour of vertices that no path reaches.
pub const UNREACHED: [u8; 3] = [128, 128, 128];

/// The colour at a place on the ramp, from 0 to 1.
#[allow(clippy::cast_sign_loss)] // Neither places nor parts of colours are negative.
pub fn colour(share: f64) -> [u8; 3] {
    let place = share.clamp(0.0, 1.0) * (RAMP.len() - 1) as f64;
    let (low, between) = (place.floor() as usize, place.fract());
    let (from, to) = (RAMP[low], RAMP[(low + 1).min(RAMP.len() - 1)]);
    std::array::from_fn(|k| {
        let (from, to) = (f64::from(from[k]), f64::from(to[k]));
        (from + between * (to - from)).round() as u8
    })
}

/// A colour for each distance: the ramp from 0 to the largest finite distance.
fn colours(distances: &[f64]) -> impl Iterator<Item = [u8; 3]> {
    let largest = distances
        .iter()
        .copied()
        .filter(|d| d.is_finite())
        .fold(0.0, f64::max);
    distances.iter().map(move |&distance| {
        if !distance.is_finite() {
            UNREACHED
        } else if largest > 0.0 {
            colour(distance / largest)
        } else {
            RAMP[0]
        }
    })
}

#[cfg(test)]
mod tests {
    use geobench_mesh::TriangleSoup;

    use super::*;

    /// A triangle and an isolated vertex.
    pub(super) fn with_field<T>(test: impl FnOnce(&DistanceFile<'_>) -> T) -> T {
        let positions = vec![[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0], [9.0, 9.0, 9.0]];
        let (mesh, _) = Mesh::from_soup(TriangleSoup::new(positions, vec![[0, 1, 2]])).unwrap();
        test(&DistanceFile {
            model: "t",
            algorithm: "mmp",
            sources: &[SourceLabel::Vertex(0)],
            targets: FieldTargets::Vertices,
            radius: None,
            mesh: &mesh,
            distances: &[0.0, 3.0, 4.0, f64::INFINITY],
        })
    }

    fn render(format: FieldFormat) -> Vec<u8> {
        with_field(|field| format.render(field).unwrap())
    }

    #[test]
    fn endings_in_any_case() {
        let of = |path: &str| FieldFormat::of_path(std::path::Path::new(path));
        assert_eq!(of("a.CSV"), Ok(FieldFormat::Csv));
        assert_eq!(of("a.b/c.vtk"), Ok(FieldFormat::Vtk));
        assert!(of("a").is_err() && of("a.obj").is_err());
    }

    #[test]
    fn numbers_are_as_short_as_displayed_and_read_back_to_the_bit() {
        let mut random = geobench_mesh::SplitMix64::new(3);
        let special = [
            0.0,
            -0.0,
            1.0,
            1e15,
            1e16,
            1e17,
            1e21,
            1e300,
            5e-324,
            1e-4,
            1e-5,
            1e-7,
            0.1,
            f64::NAN,
        ];
        let random = std::iter::from_fn(|| Some(f64::from_bits(random.next())));
        let usual: Vec<f64> = (0..2000).map(|i| f64::from(i).sqrt() * 1e-3).collect();
        let mut buffer = zmij::Buffer::new();
        for number in special.into_iter().chain(usual).chain(random.take(2000)) {
            let mut text = String::new();
            push_number(&mut text, &mut buffer, number);
            // If two shortest texts are equally close to the number, either may be written.
            assert_eq!(text.len(), number.to_string().len(), "{text}");
            let read: f64 = text.parse().unwrap();
            assert!(read.to_bits() == number.to_bits() || read.is_nan() && number.is_nan());
        }
    }

    #[test]
    fn csv_has_inf_for_unreachable_vertices() {
        assert_eq!(
            String::from_utf8(render(FieldFormat::Csv)).unwrap(),
            "vertex,distance\n0,0\n1,3\n2,4\n3,inf\n"
        );
    }

    #[test]
    fn targets_are_rows_of_their_own() {
        let targets = ["face:0,0.5,0.25,0.25", "1"].map(|text| match text {
            "1" => SourceLabel::Vertex(1),
            text => SourceLabel::Other(text.to_owned()),
        });
        with_field(|field| {
            let field = DistanceFile {
                targets: FieldTargets::Points(&targets),
                radius: Some(3.5),
                distances: &[2.5, f64::INFINITY],
                ..*field
            };
            let csv = String::from_utf8(FieldFormat::Csv.render(&field).unwrap()).unwrap();
            assert_eq!(
                csv,
                "target,distance\n\"face:0,0.5,0.25,0.25\",2.5\n1,inf\n"
            );
            let json = FieldFormat::Json.render(&field).unwrap();
            let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
            assert_eq!(
                json["targets"],
                serde_json::json!(["face:0,0.5,0.25,0.25", 1])
            );
            assert_eq!(json["distances"], serde_json::json!([2.5, null]));
            assert_eq!(
                (&json["vertices"], &json["radius"]),
                (&4.into(), &3.5.into())
            );

            let sources = [7, 8].map(SourceLabel::Vertex);
            let field = DistanceFile {
                sources: &sources,
                targets: FieldTargets::Pairs(&targets),
                ..field
            };
            let csv = String::from_utf8(FieldFormat::Csv.render(&field).unwrap()).unwrap();
            let lines = "7,\"face:0,0.5,0.25,0.25\",2.5\n8,1,inf\n";
            assert_eq!(csv, format!("source,target,distance\n{lines}"));
            let json = FieldFormat::Json.render(&field).unwrap();
            let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
            assert_eq!(json["pairs"], true);
            assert_eq!(json["sources"], serde_json::json!([7, 8]));
        });
    }

    #[test]
    fn a_matrix_has_a_row_for_each_source() {
        let labels = [0, 7].map(SourceLabel::Vertex);
        let source = SourceLabel::Other("at:1,2,3".to_owned());
        let matrix = |format: MatrixFormat| {
            let row = format.row(&source, &[1.5, f64::INFINITY]);
            [format.head(1, &labels), row].concat()
        };
        let csv = String::from_utf8(matrix(MatrixFormat::Csv)).unwrap();
        assert_eq!(csv, "source,0,7\n\"at:1,2,3\",1.5,inf\n");
        let npy = matrix(MatrixFormat::Npy);
        let header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (1, 2), }";
        assert!(npy[10..].starts_with(header) && npy.ends_with(&f64::INFINITY.to_le_bytes()));
    }

    #[test]
    fn json_has_null_for_unreachable_vertices_and_counts_them() {
        let value: serde_json::Value = serde_json::from_slice(&render(FieldFormat::Json)).unwrap();
        assert_eq!(value["distances"], serde_json::json!([0.0, 3.0, 4.0, null]));
        assert_eq!(value["unreachable"], 1);
        assert_eq!(value["sources"], serde_json::json!([0]));
    }

    #[test]
    fn npy_is_an_aligned_header_and_the_numbers() {
        let bytes = render(FieldFormat::Npy);
        assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00");
        let header = u16::from_le_bytes([bytes[8], bytes[9]]) as usize;
        let data = 10 + header;
        assert_eq!(data % 64, 0);
        assert!(bytes[10..data].ends_with(b"\n"));
        assert!(
            bytes[10..].starts_with(b"{'descr': '<f8', 'fortran_order': False, 'shape': (4,), }")
        );
        assert_eq!(bytes[data..].len(), 4 * 8);
        assert_eq!(bytes[data + 8..data + 16], 3.0_f64.to_le_bytes());
        assert_eq!(bytes[data + 24..], f64::INFINITY.to_le_bytes());
    }

    #[test]
    fn ply_has_quality_and_colours() {
        let bytes = render(FieldFormat::Ply);
        let end = b"end_header\n";
        let at = bytes.windows(end.len()).position(|w| w == end).unwrap() + end.len();
        let header = String::from_utf8_lossy(&bytes[..at]);
        assert!(
            header.contains("element vertex 4\n") && header.contains("property double quality\n")
        );
        let vertex = 6 * 8 + 3;
        assert_eq!(bytes[at..].len(), 4 * vertex + 13);
        let last = &bytes[at + 3 * vertex..at + 4 * vertex];
        assert_eq!(last[24..32], f64::INFINITY.to_le_bytes());
        assert_eq!(last[32..40], f64::INFINITY.to_le_bytes());
        assert_eq!(last[48..], [128, 128, 128], "grey where no path leads");
        assert_eq!(bytes[at + 4 * vertex], 3);
    }

    #[test]
    fn vtk_has_both_fields() {
        let bytes = render(FieldFormat::Vtk);
        let text = String::from_utf8_lossy(&bytes);
        for line in [
            "# vtk DataFile Version 3.0\n",
            "BINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n",
            "CELLS 1 4\n",
            "CELL_TYPES 1\n\x00\x00\x00\x05\nPOINT_DATA 4\n",
            "POINT_DATA 4\nSCALARS distance double 1\nLOOKUP_TABLE default\n",
            "SCALARS reached unsigned_char 1\nLOOKUP_TABLE default\n\x01\x01\x01\x00\n",
        ] {
            assert!(text.contains(line), "{line}");
        }
    }

    #[test]
    fn the_ends_of_the_ramp_and_the_unreached() {
        let found: Vec<_> = colours(&[0.0, 2.0, 1.0, f64::INFINITY]).collect();
        assert_eq!(found, [RAMP[0], RAMP[8], RAMP[4], UNREACHED]);
        assert_eq!(colours(&[0.0]).next(), Some(RAMP[0]));
    }
}
