//! XML `PolyData` of VTK: points with lines or triangles, and their arrays.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// A title for the second line of a VTK file: printable ASCII, cut to 200 characters. The format
/// allows 256.
pub(crate) fn vtk_title(title: &str) -> String {
    let shown = |c: char| if c.is_ascii_graphic() { c } else { ' ' };
    title.chars().map(shown).take(200).collect()
}

/// A named array with a value for each point or cell.
#[derive(Clone, Debug)]
pub(crate) struct Array {
    pub(crate) name: &'static str,
    pub(crate) values: ArrayValues,
}

/// The values of an array.
#[derive(Clone, Debug)]
pub(crate) enum ArrayValues {
    Double(Vec<f64>),
    Int(Vec<i32>),
    Byte(Vec<u8>),
}

impl Array {
    pub(crate) fn doubles(name: &'static str, values: impl IntoIterator<Item = f64>) -> Self {
        let values = ArrayValues::Double(values.into_iter().collect());
        Self { name, values }
    }

    pub(crate) fn ints(name: &'static str, values: impl IntoIterator<Item = i32>) -> Self {
        let values = ArrayValues::Int(values.into_iter().collect());
        Self { name, values }
    }
}

/// Which kind of cells a file has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CellKind {
    Lines,
    Polys,
}

/// The contents of a file.
#[derive(Debug)]
pub(crate) struct PolyData<'a> {
    /// A description, which is written as a comment.
    pub(crate) title: &'a str,
    pub(crate) points: &'a [[f64; 3]],
    pub(crate) kind: CellKind,
    /// The points of all cells, one cell after the other.
    pub(crate) connectivity: Vec<u32>,
    /// Where the points of each cell end.
    pub(crate) offsets: Vec<u32>,
    pub(crate) point_data: Vec<Array>,
    pub(crate) cell_data: Vec<Array>,
}

impl<'a> PolyData<'a> {
    /// Triangles without arrays.
    pub(crate) fn triangles(
        title: &'a str,
        points: &'a [[f64; 3]],
        triangles: &[[u32; 3]],
    ) -> Self {
        Self {
            title,
            points,
            kind: CellKind::Polys,
            connectivity: triangles.as_flattened().to_vec(),
            offsets: (1..=triangles.len() as u32).map(|i| 3 * i).collect(),
            point_data: Vec::new(),
            cell_data: Vec::new(),
        }
    }

    /// The file. Numbers are binary, in base64: text cannot hold infinity in a way that every
    /// reader accepts.
    pub(crate) fn render(&self) -> Vec<u8> {
        let title = vtk_title(self.title).replace("--", "- -");
        let cells = self.offsets.len();
        let (lines, polys) = match self.kind {
            CellKind::Lines => (cells, 0),
            CellKind::Polys => (0, cells),
        };
        let mut text = format!(
            "<?xml version=\"1.0\"?>\n<!-- {title} -->\n\
             <VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" \
             header_type=\"UInt64\">\n<PolyData>\n<Piece NumberOfPoints=\"{}\" \
             NumberOfVerts=\"0\" NumberOfLines=\"{lines}\" NumberOfStrips=\"0\" \
             NumberOfPolys=\"{polys}\">\n<Points>\n",
            self.points.len()
        );
        let coordinates = self.points.as_flattened().iter().copied();
        push(
            &mut text,
            "Points",
            3,
            "Float64",
            bytes(coordinates, f64::to_le_bytes),
        );
        let element = match self.kind {
            CellKind::Lines => "Lines",
            CellKind::Polys => "Polys",
        };
        let _ = writeln!(text, "</Points>\n<{element}>"); // Writing to a string cannot fail.
        for (name, numbers) in [
            ("connectivity", &self.connectivity),
            ("offsets", &self.offsets),
        ] {
            let numbers = numbers.iter().map(|&n| i64::from(n));
            push(
                &mut text,
                name,
                1,
                "Int64",
                bytes(numbers, i64::to_le_bytes),
            );
        }
        let _ = writeln!(text, "</{element}>");
        for (element, arrays) in [
            ("PointData", &self.point_data),
            ("CellData", &self.cell_data),
        ] {
            let Some(first) = arrays.first() else {
                continue;
            };
            let _ = writeln!(text, "<{element} Scalars=\"{}\">", first.name);
            for Array { name, values } in arrays {
                let (kind, bytes) = match values {
                    ArrayValues::Double(all) => {
                        ("Float64", bytes(all.iter().copied(), f64::to_le_bytes))
                    }
                    ArrayValues::Int(all) => {
                        ("Int32", bytes(all.iter().copied(), i32::to_le_bytes))
                    }
                    ArrayValues::Byte(all) => {
                        ("UInt8", bytes(all.iter().copied(), u8::to_le_bytes))
                    }
                };
                push(&mut text, name, 1, kind, bytes);
            }
            let _ = writeln!(text, "</{element}>");
        }
        text += "</Piece>\n</PolyData>\n</VTKFile>\n";
        text.into_bytes()
    }
}

/// The bytes of an array as VTK wants them: their number, as a header, and the numbers.
fn bytes<T, const N: usize>(
    numbers: impl ExactSizeIterator<Item = T>,
    to_bytes: fn(T) -> [u8; N],
) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(8 + N * numbers.len());
    bytes.extend_from_slice(&((N * numbers.len()) as u64).to_le_bytes());
    numbers.for_each(|number| bytes.extend_from_slice(&to_bytes(number)));
    bytes
}

/// Appends an array. `bytes` has its header.
fn push(text: &mut String, name: &str, components: u32, kind: &str, bytes: Vec<u8>) {
    let _ = writeln!(
        text,
        "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
         format=\"binary\">"
    );
    STANDARD.encode_string(bytes, text);
    text.push_str("\n</DataArray>\n");
}
