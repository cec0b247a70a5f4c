//! File formats for polylines in space.

use std::fmt::Write;

use crate::FileFormat;
use crate::vtk_xml::{Array, ArrayValues, CellKind, PolyData, vtk_title};

/// A file format for polylines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineFormat {
    /// Wavefront OBJ: segments.
    Obj,
    /// PLY (text): vertices and edges.
    Ply,
    /// XML `PolyData` of VTK: lines, with their numbers and values.
    Vtp,
    /// Legacy VTK (text): segments, with the numbers and values of their lines.
    Vtk,
}

impl FileFormat for LineFormat {
    const CONTENT: &'static str = "lines";
    const ENDINGS: &'static [(&'static str, Self)] = &[
        ("obj", Self::Obj),
        ("ply", Self::Ply),
        ("vtp", Self::Vtp),
        ("vtk", Self::Vtk),
    ];
}

/// Polylines with scalars.
#[derive(Clone, Debug, Default)]
pub(crate) struct Polylines {
    /// A description of the contents, which formats write as a comment.
    pub(crate) title: String,
    /// The points of each line.
    pub(crate) lines: Vec<Vec<[f64; 3]>>,
    /// Arrays with a value for each line.
    pub(crate) scalars: Vec<Array>,
}

impl Polylines {
    /// The contents of a file in this format.
    pub(crate) fn render(&self, format: LineFormat) -> Vec<u8> {
        match format {
            LineFormat::Obj => self.obj().into_bytes(),
            LineFormat::Ply => self.ply().into_bytes(),
            LineFormat::Vtp => self.vtp(),
            LineFormat::Vtk => self.vtk().into_bytes(),
        }
    }

    fn title(&self) -> String {
        vtk_title(&self.title)
    }

    /// Number of all points.
    fn points(&self) -> usize {
        self.lines.iter().map(Vec::len).sum()
    }

    /// For each piece between two points, the number of its line and of its first point.
    fn segments(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let mut next = 0;
        let lines = self.lines.iter().enumerate();
        lines.flat_map(move |(line, points)| {
            let first = next;
            next += points.len();
            (first..next.saturating_sub(1).max(first)).map(move |point| (line, point))
        })
    }

    /// Wavefront OBJ. Each segment is an element: `MeshLab` reads only the first segment of a
    /// longer one.
    fn obj(&self) -> String {
        let mut text = match self.title() {
            title if title.is_empty() => title,
            title => format!("# {title}\n"),
        };
        for [x, y, z] in self.lines.iter().flatten() {
            let _ = writeln!(text, "v {x} {y} {z}"); // A string takes all.
        }
        for (_, point) in self.segments() {
            let _ = writeln!(text, "l {} {}", point + 1, point + 2);
        }
        text
    }

    /// PLY (text): vertices and edges.
    fn ply(&self) -> String {
        let mut text = format!(
            "ply\nformat ascii 1.0\ncomment {}\nelement vertex {}\nproperty double x\n\
             property double y\nproperty double z\nelement edge {}\nproperty int vertex1\n\
             property int vertex2\nend_header\n",
            self.title(),
            self.points(),
            self.segments().count()
        );
        for [x, y, z] in self.lines.iter().flatten() {
            let _ = writeln!(text, "{x} {y} {z}");
        }
        for (_, point) in self.segments() {
            let _ = writeln!(text, "{point} {}", point + 1);
        }
        text
    }

    /// Legacy VTK (text): an unstructured grid of segments, because some readers know no polylines
    /// and no other kinds of data. Each has the number of its line and the scalars of it.
    fn vtk(&self) -> String {
        let (points, segments) = (self.points(), self.segments().count());
        let mut text = format!(
            "# vtk DataFile Version 3.0\n{}\nASCII\nDATASET UNSTRUCTURED_GRID\n\
             POINTS {points} double\n",
            self.title()
        );
        for [x, y, z] in self.lines.iter().flatten() {
            let _ = writeln!(text, "{x} {y} {z}");
        }
        let _ = writeln!(text, "CELLS {segments} {}", 3 * segments);
        for (_, point) in self.segments() {
            let _ = writeln!(text, "2 {point} {}", point + 1);
        }
        let _ = writeln!(text, "CELL_TYPES {segments}");
        for _ in 0..segments {
            let _ = writeln!(text, "{VTK_LINE}");
        }
        let _ = writeln!(text, "CELL_DATA {segments}");
        for Array { name, values } in [self.numbers()].iter().chain(&self.scalars) {
            let kind = match values {
                ArrayValues::Double(_) => "double",
                ArrayValues::Int(_) => "int",
                ArrayValues::Byte(_) => "unsigned_char",
            };
            let _ = writeln!(text, "SCALARS {name} {kind} 1\nLOOKUP_TABLE default");
            for (line, _) in self.segments() {
                let _ = match values {
                    ArrayValues::Double(all) => writeln!(text, "{}", all[line]),
                    ArrayValues::Int(all) => writeln!(text, "{}", all[line]),
                    ArrayValues::Byte(all) => writeln!(text, "{}", all[line]),
                };
            }
        }
        text
    }

    /// XML `PolyData` of VTK: polylines with their scalars.
    fn vtp(&self) -> Vec<u8> {
        let points = self.lines.concat();
        let lengths = self.lines.iter().map(|line| line.len() as u32);
        let offsets = lengths.scan(0, |end, length| {
            *end += length;
            Some(*end)
        });
        let mut cell_data = self.scalars.clone();
        cell_data.push(self.numbers());
        let data = PolyData {
            title: &self.title,
            connectivity: (0..points.len() as u32).collect(),
            points: &points,
            kind: CellKind::Lines,
            offsets: offsets.collect(),
            point_data: Vec::new(),
            cell_data,
        };
        data.render()
    }

    /// The number of each line.
    fn numbers(&self) -> Array {
        Array::ints("line", (0..).take(self.lines.len()))
    }
}

/// The VTK cell type of segments.
const VTK_LINE: u32 = 3;
