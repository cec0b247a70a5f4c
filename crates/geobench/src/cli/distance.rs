//! `geobench distance`.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use geobench_mesh::{Mesh, VertexId};
use geobench_window::{Solver, precision};
use rayon::ThreadPoolBuilder;
use rayon::iter::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};

use super::Verdict;
use super::args::DistanceOptions;
use super::terminal;
use crate::exec::model;
use crate::registry::Selection;
use crate::table::distance_formats::{DistanceField, FieldFormat};
use crate::table::output::OutputFile;

pub(super) fn distance(options: &DistanceOptions) -> anyhow::Result<Verdict> {
    if options.algo.outside_name().is_some() {
        bail!(
            "{} is an outside program: those take part in `run` and `verify`",
            options.algo.label()
        );
    }
    let format = FieldFormat::of_path(&options.output)?;
    let output = OutputFile::prepare(&options.output)?;
    let models = model::collect(std::slice::from_ref(&options.model))?;
    let [model] = &models[..] else {
        bail!(
            "{}: holds {} models; name one of them",
            options.model,
            models.len()
        );
    };
    let loaded = model.load_within(options.reading)?;
    let sources = options
        .source
        .resolve(loaded.mesh.vertex_count())
        .with_context(|| model.path.clone())?;
    let tasks = if options.each {
        one_by_one(sources, &options.output)?
    } else {
        vec![Task {
            sources,
            path: options.output.clone(),
            output,
        }]
    };
    let request = Request {
        options,
        model: &model.name,
        mesh: &loaded.mesh,
        format,
    };
    for summary in request.carry_out(&tasks)? {
        if !options.quiet && options.output != Path::new("-") {
            terminal::print(&summary)?;
        }
    }
    Ok(Verdict::Passed)
}

/// One distance field and its file.
struct Task {
    sources: Vec<VertexId>,
    path: PathBuf,
    output: OutputFile,
}

/// A task for each of the different `sources`, with files named after `path`.
fn one_by_one(sources: Vec<VertexId>, path: &Path) -> anyhow::Result<Vec<Task>> {
    let task = |source: VertexId| {
        let path = path_of_source(path, source);
        Ok(Task {
            output: OutputFile::prepare(&path)?,
            path,
            sources: vec![source],
        })
    };
    sources.into_iter().map(task).collect()
}

/// `path` with the source before its ending: the name by which `verify` looks for stored distances.
fn path_of_source(path: &Path, source: VertexId) -> PathBuf {
    let mut name = path.file_stem().map_or_else(OsString::new, Into::into);
    name.push(format!(".s{}", source.raw()));
    if let Some(ending) = path.extension() {
        name.push(".");
        name.push(ending);
    }
    path.with_file_name(name)
}

/// Data shared by all tasks.
struct Request<'a> {
    options: &'a DistanceOptions,
    model: &'a str,
    mesh: &'a Mesh,
    format: FieldFormat,
}

impl Request<'_> {
    /// Carries out all `tasks`, as many at a time as there are threads, and returns a result for
    /// each.
    ///
    /// Each thread has a solver of its own, which is faster than several threads for one source. A
    /// parallel algorithm gets the remaining threads.
    fn carry_out(&self, tasks: &[Task]) -> anyhow::Result<Vec<String>> {
        let threads = self.options.threads as usize;
        let workers = threads.min(tasks.len()).max(1);
        let algorithm = self.options.algo.clone().with_threads(threads / workers);
        let algorithm = algorithm.with_simd(self.options.simd);
        let build = || algorithm.build(self.mesh);
        if workers == 1 {
            let mut solver = build();
            let solve = |task| self.solve(&algorithm, &mut *solver, task);
            return tasks.iter().map(solve).collect();
        }
        let pool = ThreadPoolBuilder::new().num_threads(workers).build()?;
        pool.install(|| {
            tasks
                .par_iter()
                // A solver is set up for each piece, not for each source.
                .with_min_len(tasks.len() / (4 * workers))
                .map_init(build, |solver, task| {
                    self.solve(&algorithm, &mut **solver, task)
                })
                .collect()
        })
    }

    fn solve(
        &self,
        algorithm: &Selection,
        solver: &mut dyn Solver,
        task: &Task,
    ) -> anyhow::Result<String> {
        let distances = solver.solve(&task.sources)?.distances;
        if let Some(doubt) = precision::doubt(self.mesh, &distances) {
            // Printed even with `--quiet`: distances that may be wrong always come with a warning.
            terminal::warning(&format!("{}: {doubt}", self.model));
        }
        let field = DistanceField {
            model: self.model,
            algorithm: algorithm.label(),
            sources: &task.sources.iter().map(|v| v.raw()).collect::<Vec<_>>(),
            mesh: self.mesh,
            distances: &distances,
        };
        task.output.write(&self.format.render(&field)?)?;
        Ok(summary(&distances, &task.path))
    }
}

fn summary(distances: &[f64], path: &Path) -> String {
    let reached = || distances.iter().enumerate().filter(|(_, d)| d.is_finite());
    let farthest = reached()
        .max_by(|(_, a), (_, b)| a.total_cmp(b))
        .map_or_else(String::new, |(vertex, d)| {
            format!(", the farthest is vertex {vertex} at {d}")
        });
    format!(
        "{}: {} vertices, {} unreachable{farthest}\n",
        path.display(),
        distances.len(),
        distances.len() - reached().count()
    )
}
