//! File formats for shortest paths.

use std::fmt::Write;

use geobench_mesh::{Mesh, VertexId};
use geobench_paths::{Path, Point};
use serde::Serialize;

use crate::distances::csv_word;
use crate::polylines::{LineFormat, Polylines};
use crate::vtk_xml::Array;
use crate::{FileFormat, SourceLabel, json_line, no_coordinates};

/// Paths to several targets, with their origin.
#[derive(Clone, Copy, Debug)]
pub struct PathSet<'a> {
    /// Name of the model.
    pub model: &'a str,
    /// Name of the algorithm.
    pub algorithm: &'a str,
    /// The mesh.
    pub mesh: &'a Mesh,
    /// The paths.
    pub paths: &'a [FoundPath],
}

/// The result for a target.
#[derive(Clone, Debug)]
pub struct FoundPath {
    /// The target.
    pub target: SourceLabel,
    /// The source of the path, and the path itself; `None` if the target is unreachable.
    pub path: Option<(SourceLabel, Path)>,
}

/// A file format for paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathFormat {
    /// `path,source,target,x,y,z,vertex,face,u,v,w`, one line for each point.
    Csv,
    /// Points with faces and barycentric coordinates, and the edges crossed.
    Json,
    /// Polylines, with the length of each in formats of VTK.
    Lines(LineFormat),
    /// A picture of the model with the paths.
    Svg,
    /// The same picture as pixels.
    Png,
}

impl FileFormat for PathFormat {
    const CONTENT: &'static str = "paths";
    const ENDINGS: &'static [(&'static str, Self)] = &[
        ("csv", Self::Csv),
        ("json", Self::Json),
        ("obj", Self::Lines(LineFormat::Obj)),
        ("ply", Self::Lines(LineFormat::Ply)),
        ("vtp", Self::Lines(LineFormat::Vtp)),
        ("vtk", Self::Lines(LineFormat::Vtk)),
        ("svg", Self::Svg),
        ("png", Self::Png),
    ];
}

impl PathFormat {
    /// The contents of a file in this format. For the formats of pictures, which
    /// [`picture`](crate::picture) draws, it is the paths as VTK.
    ///
    /// # Errors
    ///
    /// When the mesh has no coordinates.
    pub fn render(self, set: &PathSet<'_>) -> anyhow::Result<Vec<u8>> {
        if set.mesh.positions().len() != set.mesh.vertex_count() {
            return Err(no_coordinates(set.model));
        }
        Ok(match self {
            Self::Csv => csv(set).into_bytes(),
            Self::Json => json(set)?,
            Self::Lines(format) => set.polylines().render(format),
            Self::Svg | Self::Png => set.polylines().render(LineFormat::Vtk),
        })
    }
}

impl PathSet<'_> {
    /// The paths of the reachable targets.
    fn found(&self) -> impl Iterator<Item = &Path> {
        let found = self.paths.iter().filter_map(|found| found.path.as_ref());
        found.map(|(_, path)| path)
    }

    fn polylines(&self) -> Polylines {
        let lengths = self.found().map(|path| path.length);
        Polylines {
            title: format!("shortest paths by {}, model {}", self.algorithm, self.model),
            lines: self.found().map(|path| path.polyline(self.mesh)).collect(),
            scalars: vec![Array::doubles("length", lengths)],
        }
    }
}

/// The triangle of the file on which a point lies, and its barycentric coordinates there.
fn in_file(mesh: &Mesh, point: &Point) -> (Option<u32>, [f64; 3]) {
    let Some(face) = point.face else {
        return (None, point.barycentric);
    };
    let (triangle, weights) = mesh.in_file(face, point.barycentric);
    (Some(triangle), weights)
}

fn csv(set: &PathSet<'_>) -> String {
    let mut text = "path,source,target,x,y,z,vertex,face,u,v,w\n".to_owned();
    let number = |id: Option<u32>| id.map_or_else(String::new, |id| id.to_string());
    for (i, found) in set.paths.iter().enumerate() {
        let Some((source, path)) = &found.path else {
            continue;
        };
        let [source, target] = [source, &found.target].map(csv_word);
        for point in &path.points {
            let [x, y, z] = point.position(set.mesh).unwrap_or_default();
            let (face, [u, v, w]) = in_file(set.mesh, point);
            let vertex = number(point.vertex().map(VertexId::raw));
            let face = number(face);
            let place = format!("{x},{y},{z},{vertex},{face},{u},{v},{w}");
            let _ = writeln!(text, "{i},{source},{target},{place}"); // A string takes all.
        }
    }
    text
}

#[derive(Serialize)]
struct PathDocument<'a> {
    schema: &'static str,
    model: &'a str,
    algorithm: &'a str,
    paths: Vec<PathRecord<'a>>,
}

#[derive(Serialize)]
struct PathRecord<'a> {
    source: Option<&'a SourceLabel>,
    target: &'a SourceLabel,
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
    fn record<'a>(set: &PathSet<'a>, found: &'a FoundPath) -> PathRecord<'a> {
        let path = found.path.as_ref().map(|(_, path)| path);
        let points = path.iter().flat_map(|path| &path.points);
        let edges = path.iter().flat_map(|path| path.edges());
        PathRecord {
            source: found.path.as_ref().map(|(source, _)| source),
            target: &found.target,
            length: path.map(|path| path.length),
            points: points
                .map(|point| {
                    let (face, barycentric) = in_file(set.mesh, point);
                    PointRecord {
                        position: point.position(set.mesh),
                        face,
                        barycentric,
                        vertex: point.vertex().map(VertexId::raw),
                    }
                })
                .collect(),
            edges: edges.map(|([a, b], t)| (a.raw(), b.raw(), t)).collect(),
        }
    }
    let document = PathDocument {
        schema: "geobench-path/1",
        model: set.model,
        algorithm: set.algorithm,
        paths: set.paths.iter().map(|found| record(set, found)).collect(),
    };
    json_line(&document)
}
