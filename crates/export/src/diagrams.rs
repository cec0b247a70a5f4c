//! File formats for Voronoi diagrams.

use std::collections::HashMap;
use std::fmt::Write;

use geobench_mesh::io::PlyWriter;
use geobench_mesh::{FaceId, Mesh, Refined};
use geobench_voronoi::{BorderArc, Diagram, NO_SOURCE};
use serde::Serialize;

use crate::polylines::{LineFormat, Polylines};
use crate::vtk_xml::{Array, PolyData};
use crate::{FileFormat, SourceLabel, json_line, no_coordinates};

/// A diagram with its origin.
#[derive(Clone, Copy, Debug)]
pub struct DiagramFile<'a> {
    /// Name of the model.
    pub model: &'a str,
    /// Name of the algorithm.
    pub algorithm: &'a str,
    /// The sources.
    pub sources: &'a [SourceLabel],
    /// The mesh of the model.
    pub mesh: &'a Mesh,
    /// The mesh of the model, refined so that there is a vertex at each source.
    pub refined: &'a Refined,
    /// Distance of each vertex of the refined mesh from the nearest source.
    pub distances: &'a [f64],
    /// The diagram, on the refined mesh.
    pub diagram: &'a Diagram,
    /// Seconds of the two stages: propagation of windows, and extraction of the diagram.
    pub stage_seconds: [f64; 2],
}

impl DiagramFile<'_> {
    /// Whether the refined mesh has more faces than the model.
    fn is_refined(&self) -> bool {
        self.refined.mesh.face_count() > self.mesh.face_count()
    }

    /// Converts a point in the plane of a face of the refined mesh to a face of the model and
    /// barycentric coordinates in it.
    fn in_model(&self, face: FaceId, place: [f64; 2]) -> (FaceId, [f64; 3]) {
        let weights = self.diagram.barycentric(face, place);
        if !self.is_refined() {
            return (face, weights);
        }
        let weights = self.refined.in_parent(face, weights);
        (self.refined.parent(face), weights)
    }

    /// The borders between cells as polylines, with the cells on both sides in formats of VTK.
    ///
    /// # Errors
    ///
    /// When the mesh has no coordinates.
    pub fn borders(&self, format: LineFormat) -> anyhow::Result<Vec<u8>> {
        let arcs = || self.diagram.arcs().iter();
        let side =
            |name, side: usize| Array::ints(name, arcs().map(|arc| cell_number(arc.sources[side])));
        let lines = Polylines {
            title: self.title("borders between the cells"),
            lines: polylines(self.diagram).ok_or_else(|| no_coordinates(self.model))?,
            scalars: vec![side("left", 0), side("right", 1)],
        };
        Ok(lines.render(format))
    }
}

/// A file format for diagrams.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DiagramFormat {
    /// Cells, vertices and arcs.
    Json,
    /// The mesh coloured by cell, with faces cut along the borders. The vertex property `quality`
    /// is the number of the cell, -1 where no path leads.
    Ply,
    /// The same surface (XML `PolyData` of VTK), with the number of the cell of each face in the
    /// array `cell`.
    Vtp,
    /// The borders as polylines.
    Borders(LineFormat),
    /// A picture of the model coloured by cell, with borders and sources.
    Svg,
    /// The same picture as pixels.
    Png,
}

impl FileFormat for DiagramFormat {
    const CONTENT: &'static str = "Voronoi diagrams";
    const ENDINGS: &'static [(&'static str, Self)] = &[
        ("json", Self::Json),
        ("obj", Self::Borders(LineFormat::Obj)),
        ("ply", Self::Ply),
        ("vtp", Self::Vtp),
        ("vtk", Self::Borders(LineFormat::Vtk)),
        ("svg", Self::Svg),
        ("png", Self::Png),
    ];
}

/// The number of points between the ends of a curved arc, in polylines and outlines.
pub(crate) const POINTS_PER_ARC: usize = 7;

impl DiagramFormat {
    /// The contents of a file in this format. For the formats of pictures, which
    /// [`picture`](crate::picture) draws, it is the borders as VTK.
    ///
    /// # Errors
    ///
    /// When the format needs coordinates and the mesh has none.
    pub fn render(self, file: &DiagramFile<'_>) -> anyhow::Result<Vec<u8>> {
        Ok(match self {
            Self::Json => json(file)?,
            Self::Ply => CutSurface::of(file)?.ply(&file.title("cells"))?,
            Self::Vtp => CutSurface::of(file)?.vtp(&file.title("cells")),
            Self::Borders(format) => file.borders(format)?,
            Self::Svg | Self::Png => file.borders(LineFormat::Vtk)?,
        })
    }
}

/// The number of a cell in files; -1 where no path leads.
fn cell_number(cell: u32) -> i32 {
    if cell == NO_SOURCE {
        -1
    } else {
        cell.cast_signed()
    }
}

#[derive(Serialize)]
struct DiagramDocument<'a> {
    schema: &'static str,
    model: &'a str,
    algorithm: &'a str,
    sources: &'a [SourceLabel],
    cells: Vec<VoronoiCellRecord<'a>>,
    vertices: Vec<VertexRecord<'a>>,
    arcs: Vec<VoronoiArcRecord>,
    stage_seconds: [f64; 2],
}

#[derive(Serialize)]
struct VoronoiCellRecord<'a> {
    source: u32,
    area: f64,
    perimeter: f64,
    neighbours: &'a [u32],
    disc: bool,
    euler: i64,
}

#[derive(Serialize)]
struct VertexRecord<'a> {
    position: Option<[f64; 3]>,
    face: u32,
    barycentric: [f64; 3],
    sources: &'a [u32],
    distance: f64,
}

#[derive(Serialize)]
struct VoronoiArcRecord {
    face: u32,
    sources: [u32; 2],
    from: Option<[f64; 3]>,
    to: Option<[f64; 3]>,
    kind: &'static str,
    /// The foci of the arc in the plane of the face. `offsets` are the lengths of the paths to
    /// them.
    foci: Option<[[f64; 2]; 2]>,
    offsets: Option<[f64; 2]>,
    nodes: [u32; 2],
}

fn json(file: &DiagramFile<'_>) -> anyhow::Result<Vec<u8>> {
    let diagram = file.diagram;
    let cells = (0..)
        .zip(diagram.cells())
        .map(|(source, cell)| VoronoiCellRecord {
            source,
            area: cell.area,
            perimeter: cell.perimeter,
            neighbours: &cell.neighbours,
            disc: cell.is_disc(),
            euler: cell.euler,
        });
    let vertices = diagram.vertices().iter().map(|vertex| {
        let node = diagram.nodes()[vertex.node as usize];
        let (face, barycentric) = file.in_model(node.face, node.place);
        let (face, barycentric) = file.mesh.in_file(face, barycentric);
        VertexRecord {
            position: diagram.position(node.face, node.place),
            face,
            barycentric,
            sources: &vertex.cells,
            distance: vertex.distance,
        }
    });
    let arcs = diagram.arcs().iter().map(|arc| VoronoiArcRecord {
        face: file.mesh.file_triangle(file.refined.parent(arc.face)),
        sources: arc.sources,
        from: diagram.position(arc.face, arc.ends[0]),
        to: diagram.position(arc.face, arc.ends[1]),
        kind: if arc.is_line() { "line" } else { "hyperbola" },
        foci: arc.bisector.map(|bisector| {
            let motion = file.refined.motion(arc.face);
            let face = file.refined.parent(arc.face);
            let place = |image| file.mesh.in_plane_of_file(face, motion.of(image));
            bisector.images.map(place)
        }),
        offsets: arc.bisector.map(|bisector| bisector.sigmas),
        nodes: arc.nodes,
    });
    let document = DiagramDocument {
        schema: "geobench-voronoi/1",
        model: file.model,
        algorithm: file.algorithm,
        sources: file.sources,
        cells: cells.collect(),
        vertices: vertices.collect(),
        arcs: arcs.collect(),
        stage_seconds: file.stage_seconds,
    };
    json_line(&document)
}

/// The points of each arc; `None` if the mesh has no coordinates.
fn polylines(diagram: &Diagram) -> Option<Vec<Vec<[f64; 3]>>> {
    let points = |arc: &BorderArc| {
        let parts = if arc.is_line() { 1 } else { POINTS_PER_ARC + 1 };
        let places = (0..=parts).map(|i| match i {
            0 => arc.ends[0],
            i if i == parts => arc.ends[1],
            i => arc.point(i as f64 / parts as f64),
        });
        places
            .map(|place| diagram.position(arc.face, place))
            .collect::<Option<Vec<_>>>()
    };
    diagram.arcs().iter().map(points).collect()
}

/// The borders, with the arcs joined into lines. A line runs from one Voronoi vertex or boundary
/// point to the next, or is closed. `None` if the mesh has no coordinates.
pub fn long_lines(diagram: &Diagram) -> Option<Vec<Vec<[f64; 3]>>> {
    let parts = polylines(diagram)?;
    let arcs = diagram.arcs();
    let mut at_node: HashMap<u32, Vec<usize>> = HashMap::new();
    for (i, arc) in arcs.iter().enumerate() {
        for node in arc.nodes {
            at_node.entry(node).or_default().push(i);
        }
    }
    let mut used = vec![false; arcs.len()];
    let mut lines = Vec::new();
    let is_end = |node: u32| at_node.get(&node).is_none_or(|around| around.len() != 2);
    let starts = arcs.iter().flat_map(|arc| arc.nodes);
    // Lines with ends first, then loops.
    let starts = starts.clone().filter(|&node| is_end(node)).chain(starts);
    for start in starts {
        for &first in at_node.get(&start).into_iter().flatten() {
            let (mut node, mut next) = (start, Some(first));
            let mut line: Vec<[f64; 3]> = Vec::new();
            while let Some(i) = next.filter(|&i| !std::mem::replace(&mut used[i], true)) {
                let [from, to] = arcs[i].nodes;
                let is_forward = from == node;
                node = if is_forward { to } else { from };
                if is_forward {
                    line.extend(&parts[i]);
                } else {
                    line.extend(parts[i].iter().rev());
                }
                let around = at_node.get(&node).filter(|_| !is_end(node));
                next = around.and_then(|around| around.iter().copied().find(|&j| !used[j]));
            }
            if !line.is_empty() {
                lines.push(line);
            }
        }
    }
    Some(lines)
}

impl DiagramFile<'_> {
    /// A comment that describes the contents of a file.
    fn title(&self, what: &str) -> String {
        let count = self.sources.len();
        format!(
            "{what} of {count} sources on {} by {}",
            self.model, self.algorithm
        )
    }
}

/// The colour of a cell. The colours of successive cells differ clearly.
pub fn colour(cell: u32) -> [u8; 3] {
    if cell == NO_SOURCE {
        return [128; 3];
    }
    // Multiples of the golden ratio modulo 1 spread the hues evenly for any number of cells.
    let hue = 6.0 * (f64::from(cell) * 0.618_033_988_749_895).fract();
    let light = [0.95, 0.75, 0.85][cell as usize % 3];
    let channel = |n: f64| {
        let k = (n + hue) % 6.0;
        let share = k.min(4.0 - k).clamp(0.0, 1.0);
        #[expect(clippy::cast_sign_loss, reason = "all factors are positive")]
        let byte = (255.0 * light * (1.0 - 0.55 * share)).round() as u8;
        byte
    };
    [5.0, 3.0, 1.0].map(channel)
}

/// The surface of a diagram, with faces cut along the borders. Parts of cut faces have vertices of
/// their own, so that each vertex is in one cell.
struct CutSurface {
    positions: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    /// The cell of each vertex.
    cells: Vec<u32>,
    /// The cell of each triangle. It may differ from that of a corner that is in several.
    triangle_cells: Vec<u32>,
}

impl CutSurface {
    fn of(file: &DiagramFile<'_>) -> anyhow::Result<Self> {
        let diagram = file.diagram;
        let mesh: &Mesh = diagram.mesh();
        if mesh.positions().len() != mesh.vertex_count() {
            return Err(no_coordinates(file.model));
        }
        let inner = || mesh.faces().filter(|&face| !diagram.is_border(face));
        let cell = |face| diagram.cell_of_face(face).unwrap_or(NO_SOURCE);
        let mut surface = Self {
            positions: mesh.positions().to_vec(),
            triangles: inner()
                .map(|face| mesh.face_vertices(face).map(geobench_mesh::VertexId::raw))
                .collect(),
            cells: diagram.labels().to_vec(),
            triangle_cells: inner().map(cell).collect(),
        };
        for part in diagram.parts(POINTS_PER_ARC) {
            let first = surface.positions.len();
            for &place in &part.outline {
                let position = diagram.position(part.face, place);
                surface
                    .positions
                    .push(position.ok_or_else(|| no_coordinates(file.model))?);
                surface.cells.push(part.source);
            }
            let corners = part.triangles().into_iter();
            let corners = corners.map(|corners| corners.map(|corner| (first + corner) as u32));
            surface.triangles.extend(corners);
            let triangles = surface.triangles.len();
            surface.triangle_cells.resize(triangles, part.source);
        }
        Ok(surface)
    }

    fn ply(&self, title: &str) -> anyhow::Result<Vec<u8>> {
        let colours: Vec<[u8; 3]> = self.cells.iter().map(|&cell| colour(cell)).collect();
        let numbers = self.cells.iter().map(|&cell| f64::from(cell_number(cell)));
        let numbers: Vec<f64> = numbers.collect();
        let mut bytes = Vec::new();
        PlyWriter::new(&self.positions, &self.triangles)
            .comment(title)
            .scalars("quality", &numbers)
            .colors(&colours)
            .write(&mut bytes)?;
        Ok(bytes)
    }

    fn vtp(&self, title: &str) -> Vec<u8> {
        let mut data = PolyData::triangles(title, &self.positions, &self.triangles);
        let cells = self.triangle_cells.iter().copied();
        data.cell_data = vec![Array::ints("cell", cells.map(cell_number))];
        data.render()
    }
}

/// A file format for the labels of the vertices of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LabelFormat {
    /// `vertex,label,distance`; no label and `inf` where no path leads.
    Csv,
    /// A one-dimensional `NumPy` array of i64; -1 where no path leads.
    Npy,
}

impl FileFormat for LabelFormat {
    const CONTENT: &'static str = "labels";
    const ENDINGS: &'static [(&'static str, Self)] = &[("csv", Self::Csv), ("npy", Self::Npy)];
}

impl LabelFormat {
    /// The contents of a file in this format.
    pub fn render(self, file: &DiagramFile<'_>) -> Vec<u8> {
        let labels = &file.diagram.labels()[..file.mesh.vertex_count()];
        match self {
            Self::Csv => {
                let mut text = "vertex,label,distance\n".to_owned();
                for (vertex, (&label, d)) in labels.iter().zip(file.distances).enumerate() {
                    // Writing to a string cannot fail.
                    let _ = if label == NO_SOURCE {
                        writeln!(text, "{vertex},,{d}")
                    } else {
                        writeln!(text, "{vertex},{label},{d}")
                    };
                }
                text.into_bytes()
            }
            Self::Npy => {
                let number = |label| {
                    if label == NO_SOURCE {
                        -1
                    } else {
                        i64::from(label)
                    }
                };
                let bytes = labels.iter().flat_map(|&label| number(label).to_le_bytes());
                super::distances::npy_of("<i8", &format!("({},)", labels.len()), bytes)
            }
        }
    }
}
