//! Shortest paths, as files for other programs.

use std::fmt::Write;
use std::path::Path as FilePath;

use geobench_mesh::{FaceId, Mesh, VertexId};
use geobench_paths::Path;
use serde::Serialize;

use super::{UnknownEnding, of_ending};

/// Paths to some vertices, and where they come from.
#[derive(Clone, Copy, Debug)]
pub struct PathSet<'a> {
    /// Name of the model.
    pub model: &'a str,
    /// Name of the algorithm.
    pub algorithm: &'a str,
    /// The mesh.
    pub mesh: &'a Mesh,
    /// The targets, each with its path; none if no path leads there.
    pub paths: &'a [(VertexId, Option<Path>)],
}

/// A form in which paths can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathFormat {
    /// `path,source,target,x,y,z,vertex,face,u,v,w`, one line for each point.
    Csv,
    /// Points with faces and barycentric coordinates, and the edges crossed.
    Json,
    /// Wavefront OBJ: polylines.
    Obj,
    /// PLY (text): vertices and edges.
    Ply,
    /// Legacy VTK (text): lines, with the length of each.
    Vtk,
}

const ENDINGS: [(&str, PathFormat); 5] = [
    ("csv", PathFormat::Csv),
    ("json", PathFormat::Json),
    ("obj", PathFormat::Obj),
    ("ply", PathFormat::Ply),
    ("vtk", PathFormat::Vtk),
];

impl PathFormat {
    /// The form for the ending of `path`, in any letter case.
    ///
    /// # Errors
    ///
    /// When no form has this ending.
    pub fn of_path(path: &FilePath) -> Result<Self, UnknownEnding> {
        of_ending(path, "paths", &ENDINGS)
    }

    /// The contents of a file in this form.
    ///
    /// # Errors
    ///
    /// When the form needs coordinates and the mesh has none.
    pub fn render(self, set: &PathSet<'_>) -> anyhow::Result<Vec<u8>> {
        if set.mesh.positions().len() != set.mesh.vertex_count() {
            anyhow::bail!("{}: the mesh has no coordinates to write", set.model);
        }
        Ok(match self {
            Self::Csv => csv(set).into_bytes(),
            Self::Json => json(set)?,
            Self::Obj => obj(set).into_bytes(),
            Self::Ply => ply(set).into_bytes(),
            Self::Vtk => vtk(set).into_bytes(),
        })
    }
}

impl PathSet<'_> {
    /// The paths that there are.
    fn found(&self) -> impl Iterator<Item = &Path> {
        self.paths.iter().filter_map(|(_, path)| path.as_ref())
    }

    fn title(&self) -> String {
        let title = format!("shortest paths by {}, model {}", self.algorithm, self.model);
        let shown = |c: char| if c.is_ascii_graphic() { c } else { ' ' };
        title.chars().map(shown).take(200).collect()
    }
}

/// The vertex in which `path` starts.
pub fn source_of(path: &Path) -> Option<VertexId> {
    path.points.first()?.vertex()
}

fn csv(set: &PathSet<'_>) -> String {
    let mut text = "path,source,target,x,y,z,vertex,face,u,v,w\n".to_owned();
    let number = |id: Option<u32>| id.map_or_else(String::new, |id| id.to_string());
    for (i, (target, path)) in set.paths.iter().enumerate() {
        let Some(path) = path else {
            continue;
        };
        let source = number(source_of(path).map(VertexId::raw));
        for point in &path.points {
            let [x, y, z] = point.position(set.mesh).unwrap_or_default();
            let [u, v, w] = point.barycentric;
            let vertex = number(point.vertex().map(VertexId::raw));
            let face = number(point.face.map(FaceId::raw));
            let target = target.raw();
            let place = format!("{x},{y},{z},{vertex},{face},{u},{v},{w}");
            let _ = writeln!(text, "{i},{source},{target},{place}"); // A string takes all.
        }
    }
    text
}

#[derive(Serialize)]
struct Document<'a> {
    schema: &'static str,
    model: &'a str,
    algorithm: &'a str,
    paths: Vec<PathRecord>,
}

#[derive(Serialize)]
struct PathRecord {
    source: Option<u32>,
    target: u32,
    length: Option<f64>,
    points: Vec<PointRecord>,
    edges: Vec<(u32, u32, f64)>,
}

#[derive(Serialize)]
struct PointRecord {
    position: Option<[f64; 3]>,
    face: Option<u32>,
    barycentric: [f64; 3],
    vertex: Option<u32>,
}

fn json(set: &PathSet<'_>) -> anyhow::Result<Vec<u8>> {
    let record = |(target, path): &(VertexId, Option<Path>)| {
        let points = path.iter().flat_map(|path| &path.points);
        let edges = path.iter().flat_map(Path::edges);
        PathRecord {
            source: path.as_ref().and_then(source_of).map(VertexId::raw),
            target: target.raw(),
            length: path.as_ref().map(|path| path.length),
            points: points
                .map(|point| PointRecord {
                    position: point.position(set.mesh),
                    face: point.face.map(FaceId::raw),
                    barycentric: point.barycentric,
                    vertex: point.vertex().map(VertexId::raw),
                })
                .collect(),
            edges: edges.map(|([a, b], t)| (a.raw(), b.raw(), t)).collect(),
        }
    };
    let document = Document {
        schema: "geobench-path/1",
        model: set.model,
        algorithm: set.algorithm,
        paths: set.paths.iter().map(record).collect(),
    };
    let mut bytes = serde_json::to_vec(&document)?;
    bytes.push(b'\n');
    Ok(bytes)
}

fn obj(set: &PathSet<'_>) -> String {
    let mut text = format!("# {}\n", set.title());
    let mut next = 1;
    for path in set.found() {
        let line = path.polyline(set.mesh);
        for [x, y, z] in &line {
            let _ = writeln!(text, "v {x} {y} {z}");
        }
        text.push('l');
        for number in next..next + line.len() {
            let _ = write!(text, " {number}");
        }
        text.push('\n');
        next += line.len();
    }
    text
}

fn ply(set: &PathSet<'_>) -> String {
    let lines: Vec<Vec<[f64; 3]>> = set.found().map(|path| path.polyline(set.mesh)).collect();
    let vertices: usize = lines.iter().map(Vec::len).sum();
    let edges: usize = lines.iter().map(|line| line.len() - 1).sum();
    let mut text = format!(
        "ply\nformat ascii 1.0\ncomment {}\nelement vertex {vertices}\nproperty double x\n\
         property double y\nproperty double z\nelement edge {edges}\nproperty int vertex1\n\
         property int vertex2\nend_header\n",
        set.title()
    );
    for [x, y, z] in lines.iter().flatten() {
        let _ = writeln!(text, "{x} {y} {z}");
    }
    let mut next = 0;
    for line in &lines {
        for a in next..next + line.len() - 1 {
            let _ = writeln!(text, "{a} {}", a + 1);
        }
        next += line.len();
    }
    text
}

fn vtk(set: &PathSet<'_>) -> String {
    let lines: Vec<Vec<[f64; 3]>> = set.found().map(|path| path.polyline(set.mesh)).collect();
    let points: usize = lines.iter().map(Vec::len).sum();
    let mut text = format!(
        "# vtk DataFile Version 3.0\n{}\nASCII\nDATASET POLYDATA\nPOINTS {points} double\n",
        set.title()
    );
    for [x, y, z] in lines.iter().flatten() {
        let _ = writeln!(text, "{x} {y} {z}");
    }
    let _ = writeln!(text, "LINES {} {}", lines.len(), lines.len() + points);
    let mut next = 0;
    for line in &lines {
        let _ = write!(text, "{}", line.len());
        for number in next..next + line.len() {
            let _ = write!(text, " {number}");
        }
        text.push('\n');
        next += line.len();
    }
    let _ = writeln!(
        text,
        "CELL_DATA {}\nSCALARS length double 1\nLOOKUP_TABLE default",
        lines.len()
    );
    for path in set.found() {
        let _ = writeln!(text, "{}", path.length);
    }
    text
}
