//! File formats for isolines.

use std::fmt::Write;

use geobench_isolines::{Isoline, Line};
use geobench_mesh::{Mesh, vector};
use geobench_window::{FrontWindow, WavefrontMoment};
use serde::Serialize;

use crate::polylines::{LineFormat, Polylines};
use crate::vtk_xml::Array;
use crate::{FileFormat, SourceLabel, json_line, no_coordinates};

/// The isolines of a distance field.
#[derive(Clone, Copy, Debug)]
pub struct IsolineSet<'a> {
    /// Name of the model.
    pub model: &'a str,
    /// The sources.
    pub sources: &'a [SourceLabel],
    /// The mesh.
    pub mesh: &'a Mesh,
    /// The isolines.
    pub isolines: &'a [Isoline],
    /// The largest distance of chords from their arcs, in formats that cannot hold arcs.
    pub tolerance: f64,
    /// The wavefront of a run at the distances of the isolines.
    pub wavefront: Option<RunWavefront<'a>>,
}

/// The wavefront of a run of an algorithm.
#[derive(Clone, Copy, Debug)]
pub struct RunWavefront<'a> {
    /// The algorithm.
    pub algorithm: &'a str,
    /// The mesh on which it ran.
    pub mesh: &'a Mesh,
    /// The wavefront at each distance that it came to.
    pub fronts: &'a [WavefrontMoment],
}

impl RunWavefront<'_> {
    /// The intervals of all windows in space, as lines.
    pub fn lines(&self) -> Vec<Vec<[f64; 3]>> {
        let windows = self.windows();
        windows.map(|w| self.interval(w).to_vec()).collect()
    }

    fn document(&self) -> WavefrontDocument<'_> {
        let window = |window: &FrontWindow| {
            let [from, to] = self.interval(window);
            let distance = window.distance;
            WindowRecord { from, to, distance }
        };
        let front = |front: &WavefrontMoment| FrontRecord {
            at: front.at,
            parents: front.record.parents,
            mean: front.record.distance,
            deviation: front.record.deviation,
            windows: front.windows.iter().map(window).collect(),
        };
        WavefrontDocument {
            algorithm: self.algorithm,
            fronts: self.fronts.iter().map(front).collect(),
        }
    }

    fn windows(&self) -> impl Iterator<Item = &FrontWindow> {
        self.fronts.iter().flat_map(|front| &front.windows)
    }

    /// The ends of the interval of `window` in space.
    fn interval(&self, window: &FrontWindow) -> [[f64; 3]; 2] {
        let [tail, head] = window.ends.map(|v| self.mesh.positions()[v.index()]);
        let length = vector::norm(vector::sub(head, tail));
        window
            .interval
            .map(|x| vector::between(tail, head, x / length))
    }
}

/// A file format for isolines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IsolineFormat {
    /// Arcs of circles, in the planes of their faces.
    Json,
    /// Polylines, with the distance of each in formats of VTK.
    Lines(LineFormat),
    /// A picture of the model with the isolines.
    Svg,
    /// The same picture as pixels.
    Png,
}

impl FileFormat for IsolineFormat {
    const CONTENT: &'static str = "isolines";
    const ENDINGS: &'static [(&'static str, Self)] = &[
        ("json", Self::Json),
        ("obj", Self::Lines(LineFormat::Obj)),
        ("ply", Self::Lines(LineFormat::Ply)),
        ("vtp", Self::Lines(LineFormat::Vtp)),
        ("vtk", Self::Lines(LineFormat::Vtk)),
        ("svg", Self::Svg),
        ("png", Self::Png),
    ];
}

impl IsolineFormat {
    /// The contents of a file in this format. For the formats of pictures, which
    /// [`picture`](crate::picture) draws, it is the lines as VTK.
    ///
    /// # Errors
    ///
    /// When the mesh has no coordinates.
    pub fn render(self, set: &IsolineSet<'_>) -> anyhow::Result<Vec<u8>> {
        if set.mesh.positions().len() != set.mesh.vertex_count() {
            return Err(no_coordinates(set.model));
        }
        Ok(match self {
            Self::Json => json(set)?,
            Self::Lines(format) => set.polylines().render(format),
            Self::Svg | Self::Png => set.polylines().render(LineFormat::Vtk),
        })
    }
}

impl IsolineSet<'_> {
    /// The lines with their distances.
    fn lines(&self) -> impl Iterator<Item = (f64, &Line)> {
        let isolines = self.isolines.iter();
        isolines.flat_map(|isoline| isoline.lines.iter().map(|line| (isoline.distance, line)))
    }

    fn polylines(&self) -> Polylines {
        let lines = self.lines();
        let mut distances: Vec<f64> = self.lines().map(|(distance, _)| distance).collect();
        let mut polylines = Polylines {
            title: format!("isolines of the geodesic distance, model {}", self.model),
            lines: lines
                .map(|(_, line)| line.polyline(self.mesh, self.tolerance))
                .collect(),
            scalars: Vec::new(),
        };
        if let Some(wavefront) = &self.wavefront {
            let _ = write!(polylines.title, ", wavefront of {}", wavefront.algorithm);
            let mut is_window = vec![0; polylines.lines.len()];
            polylines.lines.extend(wavefront.lines());
            distances.extend(wavefront.windows().map(|window| window.distance));
            is_window.resize(polylines.lines.len(), 1);
            polylines.scalars.push(Array::ints("is_window", is_window));
        }
        polylines
            .scalars
            .push(Array::doubles("distance", distances));
        polylines
    }
}

#[derive(Serialize)]
struct IsolineDocument<'a> {
    schema: &'static str,
    model: &'a str,
    sources: &'a [SourceLabel],
    levels: Vec<LevelRecord>,
    #[serde(skip_serializing_if = "Option::is_none")]
    wavefront: Option<WavefrontDocument<'a>>,
}

#[derive(Serialize)]
struct WavefrontDocument<'a> {
    algorithm: &'a str,
    fronts: Vec<FrontRecord>,
}

#[derive(Serialize)]
struct FrontRecord {
    /// The distance that was asked for.
    at: f64,
    /// Windows propagated before.
    parents: u64,
    /// Mean and standard deviation of the least distances of the windows.
    mean: f64,
    deviation: f64,
    windows: Vec<WindowRecord>,
}

#[derive(Serialize)]
struct WindowRecord {
    from: [f64; 3],
    to: [f64; 3],
    /// The least distance that the window offers.
    distance: f64,
}

#[derive(Serialize)]
struct LevelRecord {
    distance: f64,
    length: f64,
    loops: Vec<LineRecord>,
}

#[derive(Serialize)]
struct LineRecord {
    closed: bool,
    length: f64,
    arcs: Vec<IsolineArcRecord>,
}

#[derive(Serialize)]
struct IsolineArcRecord {
    face: u32,
    from: Option<[f64; 3]>,
    to: Option<[f64; 3]>,
    /// The centre of the circle, in the plane of the face.
    centre: [f64; 2],
    radius: f64,
    /// Barycentric coordinates of both ends.
    barycentric: [[f64; 3]; 2],
}

fn json(set: &IsolineSet<'_>) -> anyhow::Result<Vec<u8>> {
    let mesh = set.mesh;
    let line = |line: &Line| LineRecord {
        closed: line.closed,
        length: line.length(),
        arcs: line
            .arcs
            .iter()
            .map(|arc| {
                let [from, to] = arc.ends.map(|end| arc.position(mesh, end));
                let weights = |end| mesh.in_file(arc.face, arc.barycentric(mesh, end)).1;
                IsolineArcRecord {
                    face: mesh.file_triangle(arc.face),
                    from,
                    to,
                    centre: mesh.in_plane_of_file(arc.face, arc.centre),
                    radius: arc.radius,
                    barycentric: arc.ends.map(weights),
                }
            })
            .collect(),
    };
    let level = |isoline: &Isoline| LevelRecord {
        distance: isoline.distance,
        length: isoline.length(),
        loops: isoline.lines.iter().map(line).collect(),
    };
    let document = IsolineDocument {
        schema: "geobench-isolines/1",
        model: set.model,
        sources: set.sources,
        levels: set.isolines.iter().map(level).collect(),
        wavefront: set.wavefront.as_ref().map(RunWavefront::document),
    };
    json_line(&document)
}
