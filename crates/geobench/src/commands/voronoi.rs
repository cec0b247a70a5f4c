//! `geobench voronoi`.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, anyhow};
use clap::Args;
use geobench_export::diagrams::{self, DiagramFile, DiagramFormat, LabelFormat};
use geobench_export::output::{OutputFile, check_files, prepare_one};
use geobench_export::picture::{Paint, Scene, View};
use geobench_export::{FileFormat, LineFormat, no_coordinates};
use geobench_harness::measure::number::counted;
use geobench_harness::schema::SourceLabel;
use geobench_mesh::io as mesh_io;
use geobench_mesh::{TriangleSoup, VertexId};
use geobench_registry::{self as registry, Selection};
use geobench_voronoi::Diagram;

use super::generate;
use crate::args::{AlgorithmOption, MODELS_HELP, QuietOption, ViewOption};
use crate::isolation::ReadingOptions;
use crate::points::{LocatedPoints, SourcesOptions};
use crate::terminal;
use crate::verdict::Verdict;

/// Help text of `--source`.
const SOURCES_HELP: &str = "The sources, each of which has a cell: first, largest (the first vertex of \
    the largest component), a vertex number, random:N[,seed=S], all, edge:A-B,T, face:F,U,V,W, at:X,Y,Z \
    or a list of these; may be repeated";

#[derive(Args, Debug)]
#[command(
    after_help = MODELS_HELP,
    mut_arg("algo", |algo| algo.help(ALGORITHM_HELP)),
    mut_arg("source", |source| source.help(SOURCES_HELP)),
)]
pub(crate) struct VoronoiOptions {
    /// The model
    #[arg(value_name = "MODEL")]
    model: String,

    #[command(flatten)]
    sources: SourcesOptions,

    #[command(flatten)]
    algorithm: AlgorithmOption,

    #[command(flatten)]
    reading: ReadingOptions,

    /// File to write, by its ending: .json (cells, vertices, arcs), .vtp or .ply (the model cut
    /// along the borders, with the number of the cell), .obj or .vtk (borders as lines), .svg or
    /// .png (a picture)
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    /// Mesh to write as well, .obj, .ply, .off or .stl: the dual triangulation, whose vertices are
    /// the sources
    #[arg(long, value_name = "FILE")]
    dual: Option<PathBuf>,

    /// File to write as well, .vtp, .vtk, .obj or .ply: the borders between cells as polylines
    #[arg(long, value_name = "FILE")]
    borders: Option<PathBuf>,

    /// File to write as well, .csv or .npy: the place of the nearest source of each vertex in the
    /// list of sources
    #[arg(long, value_name = "FILE")]
    labels: Option<PathBuf>,

    #[command(flatten)]
    view: ViewOption,

    #[command(flatten)]
    quiet: QuietOption,
}

const ALGORITHM_HELP: &str = "The algorithm: window-vtp, lct11 or xls14 [default: window-vtp]";

pub(crate) fn voronoi(options: &VoronoiOptions) -> anyhow::Result<Verdict> {
    let (format, output) = prepare_one::<DiagramFormat>(&options.output)?;
    let view = options.view.of(format.is_picture())?;
    let borders = options.borders.as_deref();
    let borders = borders.map(prepare_one::<LineFormat>).transpose()?;
    let labels = options.labels.as_deref();
    let labels = labels.map(prepare_one::<LabelFormat>).transpose()?;
    let dual_file = match &options.dual {
        Some(path) => Some((path, generate::ending(path)?, OutputFile::prepare(path)?)),
        None => None,
    };
    let mut outputs = vec![&output];
    outputs.extend(borders.as_ref().map(|(_, output)| output));
    outputs.extend(labels.as_ref().map(|(_, output)| output));
    outputs.extend(dual_file.as_ref().map(|(_, _, output)| output));
    let algorithm = options.algorithm.algo.clone();
    let algorithm = algorithm.map_or_else(|| registry::select_one("window-vtp"), Ok)?;
    if algorithm.algorithm().field.is_none() {
        return Err(no_diagram(&algorithm));
    }
    let model = options.reading.model(&options.model)?;
    let read = model.source_file().into_iter();
    check_files(outputs, read.chain(options.sources.file()))?;
    let mesh = &options.reading.mesh(&model, options.quiet.is_set)?;
    let points = LocatedPoints::new(mesh, &options.sources.all()?, Some(&[]), &model.path)?;
    if !options.quiet.is_set {
        points.tell(mesh, false);
    }
    let refined = &points.refined.mesh;
    let sources = points.source_vertices();
    let Some(mut solver) = algorithm.field_solver(refined) else {
        return Err(no_diagram(&algorithm));
    };
    let start = Instant::now();
    let field = solver.field(&sources)?;
    let windows = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let diagram = Diagram::new(&field, sources.len());
    let extraction = start.elapsed().as_secs_f64();
    let file = DiagramFile {
        model: &model.name,
        algorithm: algorithm.label(),
        sources: &points.source_labels(),
        mesh,
        refined: &points.refined,
        distances: field.distances(),
        diagram: &diagram,
        stage_seconds: [windows, extraction],
    };
    // Each output is complete or not written, whatever happens to the others.
    let mut failed = None;
    let mut note = |done: anyhow::Result<()>| {
        if let Err(error) = done {
            failed.get_or_insert(error);
        }
    };
    let contents = if format.is_picture() {
        picture(&file, &sources, view, format == DiagramFormat::Png)
    } else {
        format.render(&file)
    };
    let mut summary = coinciding(&points.sources);
    note(contents.and_then(|contents| {
        output.write(&contents)?;
        summary.push_str(&summary_of(&options.output, &file));
        Ok(())
    }));
    if let Some((format, output)) = borders {
        note(file.borders(format).and_then(|text| output.write(&text)));
    }
    if let Some((format, output)) = labels {
        note(output.write(&format.render(&file)));
    }
    if let Some((path, ending, output)) = dual_file {
        let made = dual(path, &diagram, &sources);
        note(made.and_then(|(soup, line)| {
            summary.push_str(&line);
            output.write_with(ending, |path| Ok(mesh_io::write(path, &soup)?))
        }));
    }
    if !options.quiet.is_set && options.output != Path::new("-") {
        terminal::print(&summary)?;
    }
    failed.map_or(Ok(Verdict::Passed), Err)
}

/// The dual triangulation for the file `path`, and a line about it.
fn dual(
    path: &Path,
    diagram: &Diagram,
    sources: &[VertexId],
) -> anyhow::Result<(TriangleSoup, String)> {
    let dual = diagram.dual();
    let positions = diagram.mesh().positions();
    if positions.is_empty() {
        return Err(no_coordinates(path.display()));
    }
    let corners = sources.iter().map(|s| positions[s.index()]).collect();
    let soup = dual.triangulation(corners);
    let soup = soup.with_context(|| path.display().to_string())?;
    let line = format!(
        "{}: {} triangles, {} Voronoi vertices of more than three cells split\n",
        path.display(),
        dual.triangles.len(),
        dual.split.len()
    );
    Ok((soup, line))
}

/// The error that `algorithm` keeps no windows of which a diagram could be made.
fn no_diagram(algorithm: &Selection) -> anyhow::Error {
    anyhow!(
        "{} keeps no windows from which a diagram could be made; use window-vtp, lct11 or xls14",
        algorithm.label()
    )
}

/// A picture of the cells with their borders and the sources, as PNG or SVG.
fn picture(
    file: &DiagramFile<'_>,
    sources: &[VertexId],
    view: Option<View>,
    png: bool,
) -> anyhow::Result<Vec<u8>> {
    let mesh = file.diagram.mesh();
    let positions = mesh.positions();
    let at = sources
        .iter()
        .filter_map(|s| positions.get(s.index()).copied());
    let scene = Scene {
        paint: Some(&Paint::cells(file.diagram)),
        sources: &at.collect::<Vec<_>>(),
        isolines: &diagrams::long_lines(file.diagram).unwrap_or_default(),
        view,
        ..Scene::new(mesh, file.distances)
    };
    scene.draw(png, file.model, "Voronoi diagram")
}

/// One line for each source that coincides with an earlier one. The cell of such a source is empty.
fn coinciding(sources: &[(SourceLabel, VertexId)]) -> String {
    let mut text = String::new();
    let mut first: HashMap<VertexId, &SourceLabel> = HashMap::new();
    for (i, (label, vertex)) in sources.iter().enumerate() {
        match first.entry(*vertex) {
            Entry::Occupied(earlier) => {
                let earlier = earlier.get();
                // Writing to a string cannot fail.
                let _ = writeln!(
                    text,
                    "source {label} is at the same place as {earlier}: cell {i} is empty"
                );
            }
            Entry::Vacant(place) => {
                place.insert(label);
            }
        }
    }
    text
}

fn summary_of(path: &Path, file: &DiagramFile<'_>) -> String {
    let diagram = file.diagram;
    let cells = diagram.cells();
    let discs = cells.iter().filter(|cell| cell.is_disc()).count();
    let distances = &file.distances[..file.mesh.vertex_count()];
    let unreachable = distances.iter().filter(|d| d.is_infinite()).count();
    let [windows, extraction] = file.stage_seconds;
    let mut text = format!(
        "{}: {} ({}), {}, {} in {}; {windows:.3} s for windows, {extraction:.3} s for the diagram\n",
        path.display(),
        counted(cells.len(), "cell"),
        counted(discs, "disc"),
        counted(diagram.vertices().len(), "vertex"),
        counted(diagram.arcs().len(), "arc"),
        counted(diagram.border_faces(), "face")
    );
    if unreachable > 0 {
        let are = if unreachable == 1 { "is" } else { "are" };
        let unreachable = counted(unreachable, "vertex");
        let _ = writeln!(text, "{unreachable} {are} reached from no source");
    }
    text
}
