//! `geobench path`.

use std::fmt::Write;
use std::path::{Path as FilePath, PathBuf};

use anyhow::{Context, bail};
use clap::Args;
use geobench_export::FileFormat;
use geobench_export::output::{check_files, prepare_one};
use geobench_export::paths::{FoundPath, PathFormat, PathSet};
use geobench_export::picture::{Scene, View};
use geobench_harness::exec::model::ModelRef;
use geobench_harness::exec::point::PointSpec;
use geobench_harness::measure::number::counted;
use geobench_harness::plan::suite::options::{NotNegative, TargetOption};
use geobench_harness::schema::SourceLabel;
use geobench_mesh::{Mesh, VertexId};
use geobench_paths::{Path, PathPlace, Paths, Point, Through, line};
use geobench_registry::{self as registry, Selection};
use geobench_window::{Goal, Solver, precision};

use crate::args::{AlgorithmOption, MODELS_HELP, QuietOption, ViewOption};
use crate::isolation::ReadingOptions;
use crate::points::{LocatedPoints, SourcesOptions};
use crate::terminal;
use crate::verdict::Verdict;

#[derive(Args, Debug)]
#[command(
    after_help = MODELS_HELP,
    group(
        clap::ArgGroup::new("wanted")
            .required(true)
            .multiple(true)
            .args(["target", "targets", "all_targets", "direction"])
    ),
    group(clap::ArgGroup::new("way").multiple(true).args(["target", "targets"])),
    mut_arg("target", |target| target.help(
        "The targets, in the same forms; the search ends when all are reached"
    )),
)]
#[allow(clippy::struct_excessive_bools)] // Each is an option of its own.
pub(crate) struct PathOptions {
    /// The model
    #[arg(value_name = "MODEL")]
    model: String,

    #[command(flatten)]
    sources: SourcesOptions,

    #[command(flatten)]
    target: TargetOption,

    /// Paths to all vertices
    #[arg(long, conflicts_with_all = ["target", "targets"])]
    all_targets: bool,

    /// One path from the source to the first target, from there to the second, and so on
    #[arg(long, requires = "way", conflicts_with = "direction")]
    through: bool,

    /// Close the path through the targets: back to the source
    #[arg(long, requires = "through")]
    closed: bool,

    /// Move the path through the targets off them where that makes it shorter: the result is
    /// locally shortest, on the same side of holes and handles; an open path keeps its ends, and a
    /// closed one may contract to a point
    #[arg(long, requires = "through")]
    shorten: bool,

    /// In place of shortest paths the straightest line from each source in this direction, a vector
    /// in space; at vertices it goes on with equal angles on both sides
    #[arg(
        long,
        value_name = "X,Y,Z",
        allow_hyphen_values = true,
        value_parser = vector,
        requires = "length",
        conflicts_with_all = ["target", "targets", "all_targets", "algo"],
    )]
    direction: Option<[f64; 3]>,

    /// The length of lines, which end earlier at the border
    #[arg(
        long,
        value_name = "L",
        allow_negative_numbers = true,
        requires = "direction",
        conflicts_with_all = ["target", "targets", "all_targets"],
    )]
    length: Option<NotNegative>,

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

/// Parses a vector.
fn vector(text: &str) -> Result<[f64; 3], String> {
    let numbers = text.split(',').map(|word| word.trim().parse::<f64>());
    let numbers: Result<Vec<f64>, _> = numbers.collect();
    let numbers = numbers
        .ok()
        .and_then(|numbers| <[f64; 3]>::try_from(numbers).ok());
    numbers
        .filter(|vector| vector.iter().all(|x| x.is_finite()))
        .ok_or_else(|| "give three numbers, as in 1,0,-0.5".to_owned())
}

/// The kind of the paths of a command.
#[derive(Clone, Copy)]
enum PathKind {
    /// The shortest path to each target, or to all vertices.
    Shortest,
    /// One path through all targets.
    Through(Through),
    /// The straightest line from each source.
    Straightest { direction: [f64; 3], length: f64 },
}

impl PathKind {
    fn of(options: &PathOptions) -> Self {
        if let Some((direction, NotNegative(length))) = options.direction.zip(options.length) {
            Self::Straightest { direction, length }
        } else if options.through {
            Self::Through(Through {
                closed: options.closed,
                shorten: options.shorten,
            })
        } else {
            Self::Shortest
        }
    }

    /// How paths of this kind are found, for files: shortest ones by `algorithm`.
    fn method<'a>(&self, algorithm: &'a Selection) -> &'a str {
        match self {
            Self::Straightest { .. } => "straightest",
            Self::Through(Through { shorten: true, .. }) => "locally shortest",
            Self::Through(_) | Self::Shortest => algorithm.label(),
        }
    }

    /// The title of a picture.
    const fn title(&self) -> &'static str {
        match self {
            Self::Straightest { .. } => "Straightest lines",
            Self::Through(Through { shorten: true, .. }) => "Locally shortest path",
            Self::Through(_) | Self::Shortest => "Shortest paths",
        }
    }
}

/// Maximum number of paths for which the summary has a line each.
const LINES: usize = 20;

pub(crate) fn path(options: &PathOptions) -> anyhow::Result<Verdict> {
    let output = options.output.as_deref();
    let output = output.map(prepare_one::<PathFormat>).transpose()?;
    let is_picture = output.iter().any(|(format, _)| format.is_picture());
    let view = options.view.of(is_picture)?;
    let model = options.reading.model(&options.model)?;
    let read = model
        .source_file()
        .into_iter()
        .chain(options.sources.file());
    let read = read.chain(options.target.file());
    check_files(output.iter().map(|(_, file)| file), read)?;
    let mesh = &options.reading.mesh(&model, options.quiet.is_set)?;
    let targets = options.sources.far.targets(&options.target)?;
    let sources = options.sources.all()?;
    let points = LocatedPoints::new(mesh, &sources, targets.as_deref(), &model.path)?;
    if !options.quiet.is_set {
        points.tell(mesh, false);
    }
    let algorithm = options.algorithm.algo.clone();
    let mut command = PathCommand {
        kind: PathKind::of(options),
        model: &model,
        mesh,
        points: &points,
        algorithm: algorithm.unwrap_or_else(|| registry::usual(mesh)),
        solver: None,
    };
    let paths = command.paths(output.is_some())?;
    if let Some((format, output)) = output {
        let contents = if format.is_picture() {
            command.picture(&paths.found, format == PathFormat::Png, view)?
        } else {
            format.render(&PathSet {
                model: &model.name,
                algorithm: command.kind.method(&command.algorithm),
                mesh,
                paths: &paths.found,
            })?
        };
        output.write(&contents)?;
    }
    if !options.quiet.is_set && options.output.as_deref() != Some(FilePath::new("-")) {
        terminal::print(&paths.totals.summary(&paths.found))?;
    }
    Ok(paths.verdict)
}

/// Data shared by the steps of the command.
struct PathCommand<'a> {
    kind: PathKind,
    model: &'a ModelRef,
    /// The mesh of the model.
    mesh: &'a Mesh,
    points: &'a LocatedPoints,
    algorithm: Selection,
    /// On the refined mesh, set up when it is first needed.
    solver: Option<Box<dyn Solver>>,
}

/// The paths of a command.
struct CommandPaths {
    found: Vec<FoundPath>,
    totals: Totals,
    verdict: Verdict,
}

impl PathCommand<'_> {
    fn solver(&mut self) -> &mut dyn Solver {
        let refined = &self.points.refined.mesh;
        let solver = &mut self.solver;
        &mut **solver.get_or_insert_with(|| self.algorithm.build(refined))
    }

    /// The paths that the options ask for, all of them if `keeps_all`.
    fn paths(&mut self, keeps_all: bool) -> anyhow::Result<CommandPaths> {
        let paths = match self.kind {
            PathKind::Straightest { direction, length } => {
                let lines = straightest(self.mesh, self.points, direction, length);
                return lines.with_context(|| self.model.path.clone());
            }
            PathKind::Through(through) => {
                let [(source, _)] = &self.points.sources[..] else {
                    let count = counted(self.points.sources.len(), "source");
                    bail!("--through: a path starts at one source, not at {count}");
                };
                self.one_through(through, source)
            }
            PathKind::Shortest => self.shortest(keeps_all),
        };
        paths.with_context(|| self.algorithm.label().to_owned())
    }

    /// The model with the paths, in the colours of the distances of all vertices, as PNG or SVG.
    fn picture(
        &mut self,
        paths: &[FoundPath],
        png: bool,
        view: Option<View>,
    ) -> anyhow::Result<Vec<u8>> {
        let (mesh, points) = (self.mesh, self.points);
        let distances = self.solver().solve(&points.source_vertices())?.distances;
        let lines = paths.iter().filter_map(|found| found.path.as_ref());
        let lines: Vec<_> = lines.map(|(_, path)| path.polyline(mesh)).collect();
        let scene = Scene {
            sources: &points.positions(mesh),
            paths: &lines,
            view,
            ..Scene::new(mesh, &distances)
        };
        scene.draw(png, &self.model.name, self.kind.title())
    }

    /// Warns of distances that are in doubt.
    fn warn_of_doubt(&self, paths: &Paths) {
        if let Some(doubt) = precision::doubt(&self.points.refined.mesh, paths.distances()) {
            terminal::warning(&format!("{}: {doubt}", self.model.name));
        }
    }

    /// The shortest paths to all targets. Those that are neither written, which `keeps_all` says,
    /// nor listed are counted only: paths to all vertices may take gigabytes.
    fn shortest(&mut self, keeps_all: bool) -> anyhow::Result<CommandPaths> {
        let (mesh, points) = (self.mesh, self.points);
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
        let goal = match points.target_vertices() {
            Some(targets) => Goal::targets(targets.iter().copied()),
            None => Goal::everything(),
        };
        let (refined, sources) = (&points.refined.mesh, points.source_vertices());
        let paths = Paths::find(self.solver(), refined, &sources, &goal)?;
        self.warn_of_doubt(&paths);
        let mut all = CommandPaths {
            found: Vec::new(),
            totals: Totals::default(),
            verdict: Verdict::Passed,
        };
        let keeps_all = keeps_all || targets.len() <= LINES;
        for (target, vertex) in targets {
            match paths.to(vertex) {
                Ok(path) => {
                    if path.is_none() {
                        all.verdict = Verdict::Failed;
                    }
                    let path = path.map(|path| points.told(mesh, path));
                    all.totals.add(&target, path.as_ref());
                    if keeps_all {
                        all.found.push(FoundPath { target, path });
                    }
                }
                Err(lost) => {
                    terminal::warning(&format!("{}: {lost}", self.model.name));
                    all.verdict = Verdict::Failed;
                }
            }
        }
        Ok(all)
    }

    /// The path from the only source through all targets.
    fn one_through(
        &mut self,
        through: Through,
        source: &SourceLabel,
    ) -> anyhow::Result<CommandPaths> {
        let points = self.points;
        let refined = &points.refined;
        let mut parts = 0;
        let path = through.path(refined, &refined.vertices, |[from, to]| {
            parts += 1;
            let paths = Paths::find(self.solver(), &refined.mesh, from, &Goal::targets([to]))?;
            self.warn_of_doubt(&paths);
            anyhow::Ok(paths.to(to)?)
        })?;
        if through.shorten && path.as_ref().is_some_and(|path| path.length == 0.0) {
            terminal::notes(&["the path contracts to a point".to_owned()]);
        }
        // The end of the path, or of the first part that does not exist.
        let back = through.closed.then_some(source);
        let ends = points.labels().unwrap_or_default().iter().chain(back);
        let target = ends.take(parts).last().unwrap_or(source).clone();
        let path = path.map(|path| (source.clone(), path));
        let mut totals = Totals::default();
        totals.add(&target, path.as_ref());
        let verdict = if path.is_some() {
            Verdict::Passed
        } else {
            Verdict::Failed
        };
        let found = vec![FoundPath { target, path }];
        Ok(CommandPaths {
            found,
            totals,
            verdict,
        })
    }
}

/// The straightest line from each source. The target is its end.
fn straightest(
    mesh: &Mesh,
    points: &LocatedPoints,
    direction: [f64; 3],
    length: f64,
) -> anyhow::Result<CommandPaths> {
    let mut all = CommandPaths {
        found: Vec::new(),
        totals: Totals::default(),
        verdict: Verdict::Passed,
    };
    for ((source, _), start) in points.sources.iter().zip(&points.places) {
        let path = line(mesh, start, direction, length);
        let path = path.with_context(|| source.in_words())?;
        if path.length < length {
            terminal::notes(&[format!(
                "the line from {} ends at the border after {}",
                source.in_words(),
                path.length
            )]);
        }
        let target = path.points.last().map(|end| end_label(mesh, end));
        let target = target.unwrap_or_else(|| source.clone());
        let path = Some((source.clone(), path));
        all.totals.add(&target, path.as_ref());
        all.found.push(FoundPath { target, path });
    }
    Ok(all)
}

/// The end of a line, in the form of a source.
fn end_label(mesh: &Mesh, end: &Point) -> SourceLabel {
    let point = match (end.place, end.face) {
        (PathPlace::Vertex(v), _) => PointSpec::Vertex(v.raw()),
        (PathPlace::Edge { ends, t }, _) => PointSpec::Edge(ends.map(VertexId::raw), t),
        (PathPlace::Face, Some(face)) => {
            let (triangle, weights) = mesh.in_file(face, end.barycentric);
            PointSpec::Face(triangle, weights)
        }
        (PathPlace::Face, None) => return SourceLabel::Other(String::new()),
    };
    point.label()
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
            "{}, {} unreachable, {} crossed{longest}\n",
            counted(self.paths, "path"),
            self.unreachable,
            counted(self.edges, "edge")
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
                let is_crossed = |p: &&Point| matches!(p.place, PathPlace::Edge { .. });
                let crossed = inner.clone().filter(is_crossed).count();
                let passed = inner.filter(|p| p.vertex().is_some()).count();
                writeln!(
                    text,
                    "{} to {target}: length {}, {} crossed, {} passed",
                    source.in_words(),
                    path.length,
                    counted(crossed, "edge"),
                    counted(passed, "vertex"),
                )
            }
        };
    }
    text
}
