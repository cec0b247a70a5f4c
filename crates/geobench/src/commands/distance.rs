//! `geobench distance`.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use anyhow::{Context, bail};
use clap::Args;
use geobench_export::FileFormat;
use geobench_export::distances::{DistanceFile, FieldFormat, FieldTargets, MatrixFormat};
use geobench_export::output::{OutputFile, check_files};
use geobench_harness::exec::expected::file_word;
use geobench_harness::exec::point_files::Pair;
use geobench_harness::exec::source::{SourceSpec, TargetSpec};
use geobench_harness::measure::number::{counted, shortest};
use geobench_harness::plan::suite::options::{
    GoalOptions, SimdOption, ThreadsOption, WIDEST_SIMD_HELP, Wanted,
};
use geobench_harness::schema::SourceLabel;
use geobench_mesh::threads::Threads;
use geobench_mesh::{Curve, Mesh, VertexId};
use geobench_registry::{self as registry, OF_CURVES, Selection};
use geobench_window::{Solver, Stop, precision};
use geodesics::distances_from_curves;
use rayon::iter::{IndexedParallelIterator, IntoParallelRefMutIterator, ParallelIterator};

use crate::args::{AlgorithmOption, MODELS_HELP, QuietOption};
use crate::isolation::ReadingOptions;
use crate::points::{CurvesOption, LocatedPoints, PairsOption, SourcesOptions};
use crate::progress::TaskBar;
use crate::terminal;
use crate::verdict::Verdict;

#[derive(Args, Debug)]
#[command(
    after_help = MODELS_HELP,
    mut_arg("algo", |algo| algo.help(ALGORITHM_HELP)),
    mut_group("from", |from| from.args(["pairs", "curve", "borders"])),
    mut_arg("threads", |threads| threads.help(THREADS_HELP)),
    mut_arg("simd", |simd| simd.help(WIDEST_SIMD_HELP)),
)]
pub(crate) struct DistanceOptions {
    /// The model
    #[arg(value_name = "MODEL")]
    model: String,

    #[command(flatten)]
    sources: SourcesOptions,

    #[command(flatten)]
    goal: GoalOptions,

    #[command(flatten)]
    pairs: PairsOption,

    #[command(flatten)]
    curves: CurvesOption,

    #[command(flatten)]
    algorithm: AlgorithmOption,

    /// One field for each source, in a file of its own, which is called FILE with the source before
    /// the ending, as in d.s17.csv
    #[arg(long, conflicts_with = "pairs")]
    each: bool,

    /// One matrix of all distances in FILE (.npy or .csv): a row for each source, a column for each
    /// vertex or target
    // clap does not require `each` where another option conflicts with it.
    #[arg(long, requires = "each", conflicts_with_all = ["pairs", "curve", "borders"])]
    matrix: bool,

    #[command(flatten)]
    threads: ThreadsOption,

    #[command(flatten)]
    simd: SimdOption,

    #[command(flatten)]
    reading: ReadingOptions,

    /// File to write, by its ending: .csv, .json, .npy, .vtp, .vtk or .ply
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    #[command(flatten)]
    quiet: QuietOption,
}

const ALGORITHM_HELP: &str = "The algorithm [default: vtp-fast; mmp-fast on a model with edges of more \
    than two faces, or one that cannot be oriented; mmp from curves and borders]";

const THREADS_HELP: &str = "Threads that read the model, set up the solver and write the distances; \
    also of a parallel algorithm (pvtp, vsp, pch), or with --each so many sources at a time \
    [default: 1]";

pub(crate) fn distance(options: &DistanceOptions) -> anyhow::Result<Verdict> {
    let form = DistanceOutput::of(options)?;
    let output = OutputFile::prepare(&options.output)?;
    let model = options.reading.model(&options.model)?;
    let read: Vec<&Path> = model
        .source_file()
        .into_iter()
        .chain(options.files())
        .collect();
    // With `--each` the output only names the files of the sources.
    if options.matrix || !options.each {
        check_files([&output], &read)?;
    }
    let given = GivenPoints::of(options)?;
    let threads = Threads::start(options.threads.number())?;
    let mesh = threads.run(|| options.reading.mesh(&model, options.quiet.is_set))?;
    let curves = (options.curves).on(&mesh, options.sources.far, options.quiet.is_set)?;
    let points = given.on(&mesh, &model.path)?;
    options.tell(&mesh, &points, &curves);
    let algorithm = options.algorithm_on(&mesh, !curves.is_empty())?;
    let bar = options.bar(&model.name, &algorithm, &points);
    let command = DistanceCommand {
        options,
        read: &read,
        bar: &bar,
        algorithm,
        model: &model.name,
        mesh: &mesh,
        points: &points,
        threads: &threads,
    };
    let summaries = command.write(form, output, &curves)?;
    drop(bar);
    if !options.is_quiet() {
        for summary in summaries {
            terminal::print(&summary)?;
        }
    }
    Ok(Verdict::Passed)
}

/// The points of the options and of their files, not looked up yet.
struct GivenPoints {
    sources: Vec<Wanted<SourceSpec>>,
    /// `None` for all vertices.
    targets: Option<Vec<Wanted<TargetSpec>>>,
    /// In place of sources and targets.
    pairs: Option<Vec<Pair>>,
}

impl GivenPoints {
    /// Reads them.
    ///
    /// # Errors
    ///
    /// If a file cannot be read, has no points, or has a line that is not a point.
    fn of(options: &DistanceOptions) -> anyhow::Result<Self> {
        let far = options.sources.far;
        Ok(Self {
            sources: options.sources.all()?,
            targets: far.targets(&options.goal.target)?,
            pairs: options.pairs.read(far)?,
        })
    }

    /// Locates them on `mesh`. `model` is the name of the mesh in messages.
    ///
    /// # Errors
    ///
    /// If a point does not exist.
    fn on(&self, mesh: &Mesh, model: &str) -> anyhow::Result<LocatedPoints> {
        match &self.pairs {
            Some(pairs) => LocatedPoints::of_pairs(mesh, pairs),
            None => LocatedPoints::new(mesh, &self.sources, self.targets.as_deref(), model),
        }
    }
}

impl DistanceOptions {
    /// The files that the command reads beside the model.
    fn files(&self) -> impl Iterator<Item = &Path> {
        let files = self.sources.file().into_iter();
        let files = files.chain(self.goal.target.file());
        let files = files.chain(self.curves.files());
        files.chain(self.pairs.pairs.as_deref())
    }

    /// The algorithm on `mesh`.
    ///
    /// # Errors
    ///
    /// If there are curves and it does not take them as sources.
    fn algorithm_on(&self, mesh: &Mesh, has_curves: bool) -> anyhow::Result<Selection> {
        let algorithm = match self.algorithm.algo.clone() {
            Some(algorithm) => algorithm,
            None if has_curves => registry::select_one(OF_CURVES)?,
            None => registry::usual(mesh),
        };
        if has_curves {
            registry::check_curves(&algorithm).with_context(|| self.curves.option())?;
        }
        Ok(algorithm)
    }

    /// Whether the command prints neither summaries nor progress.
    fn is_quiet(&self) -> bool {
        self.quiet.is_set || self.output == Path::new("-")
    }

    /// Tells the notes on `points`, and without curves also how much of the model is connected with
    /// the sources. Says nothing with `--quiet`.
    fn tell(&self, mesh: &Mesh, points: &LocatedPoints, curves: &[(SourceLabel, Curve)]) {
        if self.quiet.is_set {
            return;
        }
        if curves.is_empty() {
            points.tell(mesh, self.each);
        } else {
            terminal::notes(&points.notes);
        }
    }

    /// The progress bar, with one task for each distance field.
    fn bar(&self, model: &str, algorithm: &Selection, points: &LocatedPoints) -> TaskBar {
        let tasks = if self.each { points.sources.len() } else { 1 };
        let row = format!("{model}: distances by {}", algorithm.label());
        TaskBar::new(&row, tasks, !self.is_quiet())
    }
}

/// Maximum size in bytes of the rows of a matrix that are in memory, unless a single row is larger.
const MOST_ROWS_BYTES: usize = 64 << 20;

/// Size in bytes of a number of a matrix, which in a CSV file has up to 17 digits.
const NUMBER_BYTES: usize = 20;

/// The kind and format of the output.
#[derive(Clone, Copy)]
enum DistanceOutput {
    Field(FieldFormat),
    Matrix(MatrixFormat),
}

impl DistanceOutput {
    /// The output that `options` ask for.
    ///
    /// # Errors
    ///
    /// If the file has no known format, is standard output for several files, or a mesh for the
    /// distances of targets.
    fn of(options: &DistanceOptions) -> anyhow::Result<Self> {
        if options.matrix {
            return Ok(Self::Matrix(MatrixFormat::of_path(&options.output)?));
        }
        let format = FieldFormat::of_path(&options.output)?;
        if options.each && options.output == Path::new("-") {
            bail!(
                "--each writes a file for each source: name one, or add --matrix for a single table"
            );
        }
        let goal = &options.goal.target;
        let has_targets = goal.target.is_some() || goal.file().is_some();
        if format.is_mesh() && (has_targets || options.pairs.pairs.is_some()) {
            bail!(
                "{}: a mesh has distances of all vertices; for those of targets use .csv, .json or \
                 .npy",
                options.output.display()
            );
        }
        Ok(Self::Field(format))
    }
}

/// One distance field and its file.
struct Task {
    sources: Vec<(SourceLabel, VertexId)>,
    path: PathBuf,
    output: OutputFile,
}

/// One task for each of `sources`, with a file name made from `path` and the source.
fn one_by_one(sources: &[(SourceLabel, VertexId)], path: &Path) -> anyhow::Result<Vec<Task>> {
    let task = |source: &(SourceLabel, VertexId)| {
        let path = path_of_source(path, &source.0);
        Ok(Task {
            output: OutputFile::prepare(&path)?,
            path,
            sources: vec![source.clone()],
        })
    };
    sources.iter().map(task).collect()
}

/// `path` with `.s` and the source before its extension. `verify` finds stored distances by such
/// names.
fn path_of_source(path: &Path, source: &SourceLabel) -> PathBuf {
    let mut name = path.file_stem().map_or_else(OsString::new, Into::into);
    name.push(format!(".s{}", file_word(source)));
    if let Some(ending) = path.extension() {
        name.push(".");
        name.push(ending);
    }
    path.with_file_name(name)
}

/// Solvers of one algorithm, set up when they get their first task.
struct Workers {
    algorithm: Selection,
    solvers: Vec<Option<Box<dyn Solver>>>,
}

/// Data shared by all tasks.
struct DistanceCommand<'a> {
    options: &'a DistanceOptions,
    /// The files that the command reads.
    read: &'a [&'a Path],
    bar: &'a TaskBar,
    algorithm: Selection,
    model: &'a str,
    /// The mesh of the model.
    mesh: &'a Mesh,
    points: &'a LocatedPoints,
    threads: &'a Threads,
}

impl DistanceCommand<'_> {
    /// Writes what the options ask for. Returns a summary of each file.
    fn write(
        &self,
        form: DistanceOutput,
        output: OutputFile,
        curves: &[(SourceLabel, Curve)],
    ) -> anyhow::Result<Vec<String>> {
        let summary = match form {
            DistanceOutput::Matrix(format) => self.matrix(format, &output)?,
            DistanceOutput::Field(format) if !curves.is_empty() => {
                self.of_curves(format, &output, curves)?
            }
            DistanceOutput::Field(format) if self.options.pairs.pairs.is_some() => {
                self.pairs(format, &output)?
            }
            DistanceOutput::Field(format) => return self.fields(format, output),
        };
        Ok(vec![summary])
    }

    /// Writes the distances from the nearest source, or with `--each` one file for each source.
    /// Returns a summary of each file.
    fn fields(&self, format: FieldFormat, output: OutputFile) -> anyhow::Result<Vec<String>> {
        let tasks = if self.options.each {
            let tasks = one_by_one(&self.points.sources, &self.options.output)?;
            check_files(tasks.iter().map(|task| &task.output), self.read)?;
            tasks
        } else {
            vec![Task {
                sources: self.points.sources.clone(),
                path: self.options.output.clone(),
                output,
            }]
        };
        let mut workers = self.workers(tasks.len());
        let algorithm = workers.algorithm.clone();
        self.carry_out(&mut workers, &tasks, |solver, task| {
            let sources: Vec<VertexId> = task.sources.iter().map(|(_, vertex)| *vertex).collect();
            let distances = self.solve(solver, &sources, self.points.target_vertices())?;
            let labels: Vec<SourceLabel> = task.sources.iter().map(|(l, _)| l.clone()).collect();
            let targets = self.points.labels();
            let field = DistanceFile {
                model: self.model,
                algorithm: algorithm.label(),
                sources: &labels,
                targets: targets.map_or(FieldTargets::Vertices, FieldTargets::Points),
                radius: self.options.goal.spec().radius,
                mesh: self.mesh,
                distances: &distances,
            };
            let contents = self.threads.run(|| format.render(&field))?;
            task.output.write(&contents)?;
            let name = |place: usize| match targets {
                Some(labels) => labels[place].in_words(),
                None => format!("vertex {place}"),
            };
            let noun = if targets.is_some() {
                "target"
            } else {
                "vertex"
            };
            Ok(summary(&distances, noun, name, &task.path))
        })
    }

    /// Writes the distances from the nearest point of `curves` and the nearest source. Returns a
    /// summary.
    fn of_curves(
        &self,
        format: FieldFormat,
        output: &OutputFile,
        curves: &[(SourceLabel, Curve)],
    ) -> anyhow::Result<String> {
        let points = self.points.places.iter().map(|point| Curve::new([*point]));
        let all: Vec<Curve> = points
            .chain(curves.iter().map(|(_, curve)| curve.clone()))
            .collect();
        let mut labels = self.points.source_labels();
        labels.extend(curves.iter().map(|(label, _)| label.clone()));
        // All borders have one label.
        labels.dedup();
        let radius = self.options.goal.spec().radius;
        let limit = radius.unwrap_or(f64::INFINITY);
        let distances = distances_from_curves(self.mesh, &all, limit, &Stop::default())?;
        self.bar.done();
        if let Some(doubt) = precision::doubt(self.mesh, &distances) {
            self.warn(&doubt.to_string());
        }
        let field = DistanceFile {
            model: self.model,
            algorithm: self.algorithm.label(),
            sources: &labels,
            targets: FieldTargets::Vertices,
            radius,
            mesh: self.mesh,
            distances: &distances,
        };
        output.write(&self.threads.run(|| format.render(&field))?)?;
        let name = |place: usize| format!("vertex {place}");
        Ok(summary(&distances, "vertex", name, &self.options.output))
    }

    /// Writes the distance of each pair, from one run for each different source. Returns a summary.
    fn pairs(&self, format: FieldFormat, output: &OutputFile) -> anyhow::Result<String> {
        let sources = &self.points.source_labels();
        let (labels, targets) = self.points.targets.clone().unwrap_or_default();
        let mut of_source: BTreeMap<VertexId, Vec<usize>> = BTreeMap::new();
        for (i, (_, source)) in self.points.sources.iter().enumerate() {
            of_source.entry(*source).or_default().push(i);
        }
        let tasks: Vec<(VertexId, Vec<usize>)> = of_source.into_iter().collect();
        let mut workers = self.workers(tasks.len());
        let algorithm = workers.algorithm.clone();
        let found = self.carry_out(&mut workers, &tasks, |solver, (source, places)| {
            let targets: Vec<VertexId> = places.iter().map(|&i| targets[i]).collect();
            self.solve(solver, &[*source], Some(&targets))
        })?;
        let mut distances = vec![f64::INFINITY; labels.len()];
        for ((_, places), found) in tasks.iter().zip(found) {
            for (&i, distance) in places.iter().zip(found) {
                distances[i] = distance;
            }
        }
        let field = DistanceFile {
            model: self.model,
            algorithm: algorithm.label(),
            sources,
            targets: FieldTargets::Pairs(&labels),
            radius: self.options.goal.spec().radius,
            mesh: self.mesh,
            distances: &distances,
        };
        output.write(&format.render(&field)?)?;
        let name = |i: usize| format!("{} to {}", sources[i].in_words(), labels[i]);
        Ok(summary(&distances, "pair", name, &self.options.output))
    }

    /// Writes one matrix with a row for each source and a column for each target or vertex. Returns
    /// a summary.
    fn matrix(&self, format: MatrixFormat, output: &OutputFile) -> anyhow::Result<String> {
        let sources = &self.points.sources;
        let columns = match &self.points.targets {
            Some((labels, _)) => labels.clone(),
            None => (0..self.mesh.vertex_count() as u32)
                .map(SourceLabel::Vertex)
                .collect(),
        };
        // Rows are written as they are found: only so many are in memory.
        let at_once = (MOST_ROWS_BYTES / (NUMBER_BYTES * columns.len()).max(1)).max(1);
        let at_once = at_once.max(self.options.threads.number());
        let mut unreachable = 0;
        let mut workers = self.workers(sources.len());
        output.write_with("", |path| {
            let mut file = BufWriter::new(File::create(path)?);
            file.write_all(&format.head(sources.len(), &columns))?;
            for some in sources.chunks(at_once) {
                let row = |solver: &mut dyn Solver, (label, v): &(SourceLabel, VertexId)| {
                    let row = self.solve(solver, &[*v], self.points.target_vertices())?;
                    let missing = row.iter().filter(|d| !d.is_finite()).count();
                    Ok((missing, format.row(label, &row)))
                };
                for (missing, row) in self.carry_out(&mut workers, some, row)? {
                    unreachable += missing;
                    file.write_all(&row)?;
                }
            }
            Ok(file.flush()?)
        })?;
        Ok(format!(
            "{}: {} x {} distances, {unreachable} unreachable\n",
            self.options.output.display(),
            sources.len(),
            columns.len()
        ))
    }

    /// The workers of `tasks` tasks: one for each thread, which is faster than several threads for
    /// one source. If there are fewer tasks than threads, a parallel algorithm divides the threads
    /// among its solvers. With a single solver, all threads take part in its set-up.
    fn workers(&self, tasks: usize) -> Workers {
        let threads = self.options.threads.number();
        let count = threads.min(tasks).max(1);
        let algorithm = self.algorithm.clone().with_threads(threads / count);
        Workers {
            algorithm: algorithm.with_simd(self.options.simd.simd.unwrap_or_default()),
            solvers: (0..count).map(|_| None).collect(),
        }
    }

    /// Executes all `tasks`, one for each of the `workers` at a time, and returns their results in
    /// order. Solvers stay set up.
    fn carry_out<T: Sync, R: Send>(
        &self,
        workers: &mut Workers,
        tasks: &[T],
        work: impl Fn(&mut dyn Solver, &T) -> anyhow::Result<R> + Sync,
    ) -> anyhow::Result<Vec<R>> {
        let Workers { algorithm, solvers } = workers;
        let build = || algorithm.build(&self.points.refined.mesh);
        if let [solver] = &mut solvers[..] {
            let solver = solver.get_or_insert_with(|| self.threads.run(build));
            let mut work = |task| work(&mut **solver, task).inspect(|_| self.bar.done());
            return tasks.iter().map(&mut work).collect();
        }
        let next = AtomicUsize::new(0);
        let take_tasks = |solver: &mut Option<Box<dyn Solver>>| {
            let mut results = Vec::new();
            loop {
                let number = next.fetch_add(1, Relaxed);
                let Some(task) = tasks.get(number) else {
                    return results;
                };
                let result = work(&mut **solver.get_or_insert_with(build), task);
                self.bar.done();
                if result.is_err() {
                    // The tasks before this one are taken already.
                    next.store(tasks.len(), Relaxed);
                }
                results.push((number, result));
            }
        };
        let mut results: Vec<_> = self.threads.run(|| {
            let each = solvers.par_iter_mut().with_max_len(1);
            each.flat_map_iter(take_tasks).collect()
        });
        results.sort_unstable_by_key(|(number, _)| *number);
        results.into_iter().map(|(_, result)| result).collect()
    }

    /// Warns of distances of the model.
    fn warn(&self, warning: &str) {
        let warning = format!("{}: {warning}", self.model);
        self.bar.suspend(|| terminal::warning(&warning));
    }

    /// The distances of `targets`, or of all vertices of the model without targets. The refined
    /// mesh has further vertices, which are left out.
    fn solve(
        &self,
        solver: &mut dyn Solver,
        sources: &[VertexId],
        targets: Option<&[VertexId]>,
    ) -> anyhow::Result<Vec<f64>> {
        let goal = self.options.goal.limit().of_solver(targets);
        let solution = solver.solve_until(sources, &goal);
        let solution = solution.with_context(|| self.algorithm.label().to_owned())?;
        if solution.negative > 0 {
            self.warn(&format!(
                "{} found {} negative distances, which are written as 0",
                self.algorithm.label(),
                solution.negative
            ));
        }
        let mut distances = solution.distances;
        if let Some(doubt) = precision::doubt(&self.points.refined.mesh, &distances) {
            // Printed even with `--quiet`: a warning accompanies all distances that may be wrong.
            self.warn(&doubt.to_string());
        }
        if let Some(targets) = targets {
            return Ok(targets.iter().map(|v| distances[v.index()]).collect());
        }
        distances.truncate(self.mesh.vertex_count());
        Ok(distances)
    }
}

/// A line about the distances of several points, each of which is a `noun` and has such a name.
fn summary(distances: &[f64], noun: &str, name: impl Fn(usize) -> String, path: &Path) -> String {
    let reached = || distances.iter().enumerate().filter(|(_, d)| d.is_finite());
    // Of several the first.
    let farthest = reached()
        .rev()
        .max_by(|(_, a), (_, b)| a.total_cmp(b))
        .map_or_else(String::new, |(place, d)| {
            format!(", the farthest is {} at {}", name(place), shortest(*d))
        });
    format!(
        "{}: {}, {} unreachable{farthest}\n",
        path.display(),
        counted(distances.len(), noun),
        distances.len() - reached().count()
    )
}
