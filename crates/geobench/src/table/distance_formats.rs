//! One distance field, as files for other programs.

use std::path::Path;

use geobench_mesh::Mesh;

mod json;
mod npy;
mod ply;
pub(crate) mod ramp;
mod vtk;

/// Distances and where they come from.
#[derive(Clone, Copy, Debug)]
pub struct DistanceField<'a> {
    /// Name of the model.
    pub model: &'a str,
    /// Name of the algorithm.
    pub algorithm: &'a str,
    /// The sources, from the nearest of which distances are measured.
    pub sources: &'a [u32],
    /// The mesh.
    pub mesh: &'a Mesh,
    /// Distance of each vertex in the file's order; infinite where no path leads.
    pub distances: &'a [f64],
}

/// A form in which a distance field can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldFormat {
    /// `vertex,distance`, one line for each vertex; `inf` where no path leads.
    Csv,
    /// The distances with their sources; `null` where no path leads, and how often that is.
    Json,
    /// A one-dimensional `NumPy` array of f64; infinity where no path leads.
    Npy,
    /// The mesh (binary), with the distance as the `quality` of a vertex, infinity where no path
    /// leads, and a colour ramp, grey where no path leads.
    Ply,
    /// The mesh (legacy VTK, binary), with the scalar field `distance`, infinity where no path
    /// leads, and the field `reached`, which is 0 there and 1 elsewhere.
    Vtk,
}

const ENDINGS: [(&str, FieldFormat); 5] = [
    ("csv", FieldFormat::Csv),
    ("json", FieldFormat::Json),
    ("npy", FieldFormat::Npy),
    ("ply", FieldFormat::Ply),
    ("vtk", FieldFormat::Vtk),
];

/// A path whose ending is not that of a distance field.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{path}: the ending says in which form to write distances; use .csv, .json, .npy, .ply or .vtk"
)]
pub struct UnknownEnding {
    /// The path.
    pub path: String,
}

impl FieldFormat {
    /// The form that the ending of `path` asks for, in any letter case.
    ///
    /// # Errors
    ///
    /// When it asks for none.
    pub fn of_path(path: &Path) -> Result<Self, UnknownEnding> {
        path.extension()
            .and_then(|ending| {
                let (_, format) = ENDINGS
                    .iter()
                    .find(|(name, _)| ending.eq_ignore_ascii_case(name))?;
                Some(*format)
            })
            .ok_or_else(|| UnknownEnding {
                path: path.display().to_string(),
            })
    }

    /// The contents of a file in this form.
    ///
    /// # Errors
    ///
    /// When the form needs coordinates and the mesh has none.
    pub fn render(self, field: &DistanceField<'_>) -> anyhow::Result<Vec<u8>> {
        let needs_positions = matches!(self, Self::Ply | Self::Vtk);
        if needs_positions && field.mesh.positions().len() != field.distances.len() {
            anyhow::bail!("{}: the mesh has no coordinates to write", field.model);
        }
        Ok(match self {
            Self::Csv => csv(field.distances),
            Self::Json => json::render(field)?,
            Self::Npy => npy::render(field.distances),
            Self::Ply => ply::render(field)?,
            Self::Vtk => vtk::render(field),
        })
    }
}

/// Numbers with as many digits as it takes to read them back unchanged.
fn csv(distances: &[f64]) -> Vec<u8> {
    use std::fmt::Write;
    let mut text = "vertex,distance\n".to_owned();
    for (vertex, distance) in distances.iter().enumerate() {
        let _ = writeln!(text, "{vertex},{distance}"); // Writing to a string cannot fail.
    }
    text.into_bytes()
}

/// Appends each of `numbers` as `to_bytes` lays it out.
fn append<T, const N: usize>(
    bytes: &mut Vec<u8>,
    numbers: impl IntoIterator<Item = T>,
    to_bytes: fn(T) -> [u8; N],
) {
    for number in numbers {
        bytes.extend_from_slice(&to_bytes(number));
    }
}

#[cfg(test)]
mod tests {
    use geobench_mesh::TriangleSoup;

    use super::*;

    /// A triangle and an isolated vertex.
    pub(super) fn with_field<T>(test: impl FnOnce(&DistanceField<'_>) -> T) -> T {
        let positions = vec![[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0], [9.0, 9.0, 9.0]];
        let (mesh, _) = Mesh::from_soup(TriangleSoup::new(positions, vec![[0, 1, 2]])).unwrap();
        test(&DistanceField {
            model: "t",
            algorithm: "mmp",
            sources: &[0],
            mesh: &mesh,
            distances: &[0.0, 3.0, 4.0, f64::INFINITY],
        })
    }

    fn render(format: FieldFormat) -> Vec<u8> {
        with_field(|field| format.render(field).unwrap())
    }

    #[test]
    fn endings_in_any_case() {
        let of = |path: &str| FieldFormat::of_path(Path::new(path));
        assert_eq!(of("a.CSV"), Ok(FieldFormat::Csv));
        assert_eq!(of("a.b/c.vtk"), Ok(FieldFormat::Vtk));
        assert!(of("a").is_err() && of("a.obj").is_err());
    }

    #[test]
    fn csv_says_inf() {
        assert_eq!(
            String::from_utf8(render(FieldFormat::Csv)).unwrap(),
            "vertex,distance\n0,0\n1,3\n2,4\n3,inf\n"
        );
    }

    #[test]
    fn json_says_null_and_how_often() {
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
        let vertex = 4 * 8 + 3;
        assert_eq!(bytes[at..].len(), 4 * vertex + 13);
        let last = &bytes[at + 3 * vertex..at + 4 * vertex];
        assert_eq!(last[24..32], f64::INFINITY.to_le_bytes());
        assert_eq!(last[32..], [128, 128, 128], "grey where no path leads");
        assert_eq!(bytes[at + 4 * vertex], 3);
    }

    #[test]
    fn vtk_has_both_fields() {
        let bytes = render(FieldFormat::Vtk);
        let text = String::from_utf8_lossy(&bytes);
        for line in [
            "# vtk DataFile Version 3.0\n",
            "BINARY\nDATASET POLYDATA\nPOINTS 4 double\n",
            "POLYGONS 1 4\n",
            "POINT_DATA 4\nSCALARS distance double 1\nLOOKUP_TABLE default\n",
            "SCALARS reached unsigned_char 1\nLOOKUP_TABLE default\n\x01\x01\x01\x00\n",
        ] {
            assert!(text.contains(line), "{line}");
        }
    }
}
