//! `geobench path`.

use clap::Args;
use geobench_harness::plan::suite::options::{TargetOption, WantedTarget};
use geobench_registry as registry;
use std::fmt::Write;
use std::path::Path as FilePath;
use std::path::PathBuf;

use anyhow::Context;
use geobench_export::FileFormat;
use geobench_export::output::{check_files, prepare_one};
use geobench_export::paths::{FoundPath, PathFormat, PathSet};
use geobench_export::picture::Scene;
use geobench_harness::schema::SourceLabel;
use geobench_mesh::{Mesh, VertexId};
use geobench_paths::{Path, PathPlace, Paths, Point};
use geobench_window::precision;

use crate::args::{AlgorithmOption, MODELS_HELP, QuietOption, ViewOption};
use crate::isolation::ReadingOptions;
use crate::points::{LocatedPoints, SourcesOptions};
use crate::terminal;
use crate::verdict::Verdict;

#[derive(Args, Debug)]
#[command(
    after_help = MODELS_HELP,
    mut_arg("target", |target| target.required_unless_present("all_targets").help(
        "The targets, in the same forms; the search ends when all are reached"
    )),
)]
pub(crate) struct PathOptions {
    /// The model
    #[arg(value_name = "MODEL")]
    model: String,

    #[command(flatten)]
    sources: SourcesOptions,

    #[command(flatten)]
    target: TargetOption,

    /// Paths to all vertices
    #[arg(long, conflicts_with = "target")]
    all_targets: bool,

    #[command(flatten)]
    algorithm: AlgorithmOption,

    #[command(flatten)]
    reading: ReadingOptions,

    /// File to write, by its ending: .json, .csv, .vtp, .vtk, .obj, .ply, or a picture of the model
    /// with the paths, .svg or .png
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    #[command(flatten)]
    view: ViewOption,

    #[command(flatten)]
    quiet: QuietOption,
}

/// Maximum number of paths for which the summary has a line each.
const LINES: usize = 20;

pub(crate) fn path(options: &PathOptions) -> anyhow::Result<Verdict> {
    let output = options.output.as_deref();
    let output = output.map(prepare_one::<PathFormat>).transpose()?;
    let is_picture = output.iter().any(|(format, _)| format.is_picture());
    let view = options.view.of(is_picture)?;
    let model = options.reading.model(&options.model)?;
    check_files(output.iter().map(|(_, file)| file), model.source_file())?;
    let mesh = &options.reading.mesh(&model, options.quiet.is_set)?;
    let targets = options.target.target.iter().flatten().cloned();
    let targets = targets.map(|target| (options.sources.far.target(target), None));
    let wanted: Option<Vec<WantedTarget>> = (!options.all_targets).then(|| targets.collect());
    let points = LocatedPoints::new(mesh, &options.sources.all(), wanted.as_deref(), &model.path)?;
    if !options.quiet.is_set {
        points.tell(mesh);
    }
    let sources = points.source_vertices();
    let refined = &points.refined.mesh;
    let targets: Vec<(SourceLabel, VertexId)> = match &points.targets {
        None => {
            let label = |v: VertexId| (SourceLabel::Vertex(v.raw()), v);
            mesh.vertices().map(label).collect()
        }
        Some((labels, vertices)) => {
            let vertices = vertices.iter().copied();
            labels.iter().cloned().zip(vertices).collect()
        }
    };
    let algorithm = options.algorithm.algo.clone();
    let algorithm = algorithm.unwrap_or_else(|| registry::usual(mesh));
    let mut solver = algorithm.build(refined);
    let paths = Paths::find(solver.as_mut(), refined, &sources, &points.goal(None))
        .with_context(|| algorithm.label().to_owned())?;
    if let Some(doubt) = precision::doubt(refined, paths.distances()) {
        terminal::warning(&format!("{}: {doubt}", model.name));
    }
    let mut verdict = Verdict::Passed;
    let mut totals = Totals::default();
    let mut found: Vec<FoundPath> = Vec::new();
    // Paths to all vertices may take gigabytes. They are kept only if they are written or listed.
    let keeps_all = output.is_some() || targets.len() <= LINES;
    for (target, vertex) in targets {
        match paths.to(vertex) {
            Ok(path) => {
                if path.is_none() {
                    verdict = Verdict::Failed;
                }
                let path = path.map(|path| points.told(mesh, path));
                totals.add(&target, path.as_ref());
                if keeps_all {
                    found.push(FoundPath { target, path });
                }
            }
            Err(lost) => {
                terminal::warning(&format!("{}: {lost}", model.name));
                verdict = Verdict::Failed;
            }
        }
    }
    if let Some((format, output)) = output {
        let set = PathSet {
            model: &model.name,
            algorithm: algorithm.label(),
            mesh,
            paths: &found,
        };
        let contents = if format.is_picture() {
            // The colours of the picture need the distances of all vertices.
            let distances = solver.solve(&sources)?.distances;
            let lines = found.iter().filter_map(|found| found.path.as_ref());
            let lines: Vec<_> = lines.map(|(_, path)| path.polyline(mesh)).collect();
            let scene = Scene {
                sources: &points.positions(mesh),
                paths: &lines,
                view,
                ..Scene::new(mesh, &distances)
            };
            scene.draw(format == PathFormat::Png, &model.name, "Shortest paths")?
        } else {
            format.render(&set)?
        };
        output.write(&contents)?;
    }
    if !options.quiet.is_set && options.output.as_deref() != Some(FilePath::new("-")) {
        terminal::print(&totals.summary(&found))?;
    }
    Ok(verdict)
}

impl LocatedPoints {
    /// Converts `path` from the refined mesh to points of `mesh`. Returns the label of its source
    /// as well.
    fn told(&self, mesh: &Mesh, path: Path) -> (SourceLabel, Path) {
        let start = path.points.first().and_then(Point::vertex);
        let source = self
            .sources
            .iter()
            .find(|(_, vertex)| Some(*vertex) == start);
        // Every path starts at a source, so the fallback is not used.
        let label = source.map_or(SourceLabel::Other(String::new()), |(label, _)| {
            label.clone()
        });
        if self.refined.mesh.vertex_count() == mesh.vertex_count() {
            return (label, path);
        }
        (label, path.of_original(&self.refined))
    }
}

/// Totals over all paths, for the summary.
#[derive(Default)]
struct Totals {
    paths: usize,
    unreachable: usize,
    edges: usize,
    longest: Option<(SourceLabel, f64)>,
}

impl Totals {
    fn add(&mut self, target: &SourceLabel, path: Option<&(SourceLabel, Path)>) {
        self.paths += 1;
        let Some((_, path)) = path else {
            self.unreachable += 1;
            return;
        };
        self.edges += path.edges().count();
        if self
            .longest
            .as_ref()
            .is_none_or(|(_, length)| path.length > *length)
        {
            self.longest = Some((target.clone(), path.length));
        }
    }

    /// One line for each of `paths`, or a single line with totals for more than [`LINES`] paths.
    fn summary(&self, paths: &[FoundPath]) -> String {
        if self.paths <= LINES {
            return lines(paths);
        }
        let longest = self
            .longest
            .as_ref()
            .map_or_else(String::new, |(target, length)| {
                format!(", the longest to {} of length {length}", target.in_words())
            });
        format!(
            "{} paths, {} unreachable, {} edges crossed{longest}\n",
            self.paths, self.unreachable, self.edges
        )
    }
}

fn lines(paths: &[FoundPath]) -> String {
    let mut text = String::new();
    for found in paths {
        let target = &found.target;
        let _ = match &found.path {
            None => writeln!(text, "{}: unreachable", target.in_words()),
            Some((source, path)) => {
                // The end points are not counted, although they may be vertices.
                let inner = path.points.get(1..path.points.len().saturating_sub(1));
                let inner = inner.unwrap_or_default().iter();
                writeln!(
                    text,
                    "{} to {target}: length {}, {} edges crossed, {} vertices passed",
                    source.in_words(),
                    path.length,
                    inner
                        .clone()
                        .filter(|p| matches!(p.place, PathPlace::Edge { .. }))
                        .count(),
                    inner.filter(|p| p.vertex().is_some()).count(),
                )
            }
        };
    }
    text
}
