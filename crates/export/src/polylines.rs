//! File formats for polylines in space.

use std::fmt::Write;

/// Polylines with scalars.
#[derive(Clone, Debug, Default)]
pub(crate) struct Polylines {
    /// A description of the contents, which formats write as a comment.
    pub(crate) title: String,
    /// The points of each line.
    pub(crate) lines: Vec<Vec<[f64; 3]>>,
    /// Scalars of the lines.
    pub(crate) scalars: Vec<LineScalars>,
}

/// A named scalar, with a value for each line.
#[derive(Clone, Debug)]
pub(crate) struct LineScalars {
    pub(crate) name: &'static str,
    /// The VTK type.
    pub(crate) kind: &'static str,
    pub(crate) values: Vec<String>,
}

impl LineScalars {
    /// Scalars of the VTK type `kind`, in the order of the lines.
    pub(crate) fn new<T: ToString>(
        name: &'static str,
        kind: &'static str,
        values: impl Iterator<Item = T>,
    ) -> Self {
        Self {
            name,
            kind,
            values: values.map(|value| value.to_string()).collect(),
        }
    }
}

/// A title for the second line of a VTK file: printable ASCII, cut to 200 characters. The format
/// allows 256.
pub(super) fn vtk_title(title: &str) -> String {
    let shown = |c: char| if c.is_ascii_graphic() { c } else { ' ' };
    title.chars().map(shown).take(200).collect()
}

impl Polylines {
    fn title(&self) -> String {
        vtk_title(&self.title)
    }

    /// Number of all points.
    fn points(&self) -> usize {
        self.lines.iter().map(Vec::len).sum()
    }

    /// Wavefront OBJ.
    pub(crate) fn obj(&self) -> String {
        let mut text = match self.title() {
            title if title.is_empty() => title,
            title => format!("# {title}\n"),
        };
        let mut next = 1;
        for line in &self.lines {
            for [x, y, z] in line {
                let _ = writeln!(text, "v {x} {y} {z}"); // A string takes all.
            }
            // An element `l` has two points or more. The path to a source has one.
            if line.len() > 1 {
                text.push('l');
                for number in next..next + line.len() {
                    let _ = write!(text, " {number}");
                }
                text.push('\n');
            }
            next += line.len();
        }
        text
    }

    /// PLY (text): vertices and edges.
    pub(crate) fn ply(&self) -> String {
        let edges: usize = self
            .lines
            .iter()
            .map(|line| line.len().saturating_sub(1))
            .sum();
        let mut text = format!(
            "ply\nformat ascii 1.0\ncomment {}\nelement vertex {}\nproperty double x\n\
             property double y\nproperty double z\nelement edge {edges}\nproperty int vertex1\n\
             property int vertex2\nend_header\n",
            self.title(),
            self.points()
        );
        for [x, y, z] in self.lines.iter().flatten() {
            let _ = writeln!(text, "{x} {y} {z}");
        }
        let mut next = 0;
        for line in &self.lines {
            for a in next..(next + line.len()).saturating_sub(1) {
                let _ = writeln!(text, "{a} {}", a + 1);
            }
            next += line.len();
        }
        text
    }

    /// Legacy VTK (text): lines with their scalars.
    pub(crate) fn vtk(&self) -> String {
        let points = self.points();
        let mut text = format!(
            "# vtk DataFile Version 3.0\n{}\nASCII\nDATASET POLYDATA\nPOINTS {points} double\n",
            self.title()
        );
        for [x, y, z] in self.lines.iter().flatten() {
            let _ = writeln!(text, "{x} {y} {z}");
        }
        let count = self.lines.len();
        let _ = writeln!(text, "LINES {count} {}", count + points);
        let mut next = 0;
        for line in &self.lines {
            let _ = write!(text, "{}", line.len());
            for number in next..next + line.len() {
                let _ = write!(text, " {number}");
            }
            text.push('\n');
            next += line.len();
        }
        let _ = writeln!(text, "CELL_DATA {count}");
        for LineScalars { name, kind, values } in &self.scalars {
            let _ = writeln!(text, "SCALARS {name} {kind} 1\nLOOKUP_TABLE default");
            for value in values {
                let _ = writeln!(text, "{value}");
            }
        }
        text
    }
}
