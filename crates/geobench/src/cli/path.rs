//! `geobench path`.

use std::fmt::Write;

use anyhow::{Context, bail};
use geobench_mesh::VertexId;
use geobench_paths::{Path, Paths};
use geobench_window::{Goal, precision};

use super::Verdict;
use super::args::PathOptions;
use super::terminal;
use crate::exec::model;
use crate::exec::source::SourceSpec;
use crate::table::output::OutputFile;
use crate::table::path_formats::{PathFormat, PathSet, source_of};

/// The most paths of which the summary has a line each.
const LINES: usize = 20;

pub(super) fn path(options: &PathOptions) -> anyhow::Result<Verdict> {
    if options.algo.outside_name().is_some() {
        bail!(
            "{} is an outside program: those take part in `run` and `verify`",
            options.algo.label()
        );
    }
    let output = match &options.output {
        Some(path) => Some((PathFormat::of_path(path)?, OutputFile::prepare(path)?)),
        None => None,
    };
    let models = model::collect(std::slice::from_ref(&options.model))?;
    let [model] = &models[..] else {
        bail!(
            "{}: holds {} models; name one of them",
            options.model,
            models.len()
        );
    };
    let loaded = model.load_within(options.reading)?;
    let mesh = &loaded.mesh;
    let vertices = |specs: &[SourceSpec], what: &str| -> anyhow::Result<Vec<VertexId>> {
        let mut all = Vec::new();
        for spec in specs {
            let found = spec.vertices(mesh.vertex_count());
            all.extend(found.with_context(|| format!("{}: --{what}", model.path))?);
        }
        Ok(all)
    };
    let sources = vertices(&options.source, "source")?;
    let (targets, goal) = if options.all_targets {
        (mesh.vertices().collect(), Goal::everything())
    } else {
        let targets = vertices(&options.target, "target")?;
        let goal = Goal::targets(targets.iter().copied());
        (targets, goal)
    };
    let mut solver = options.algo.build(mesh);
    let paths = Paths::find(solver.as_mut(), mesh, &sources, &goal)
        .with_context(|| options.algo.label().to_owned())?;
    if let Some(doubt) = precision::doubt(mesh, paths.distances()) {
        terminal::warning(&format!("{}: {doubt}", model.name));
    }
    let mut verdict = Verdict::Passed;
    let mut totals = Totals::default();
    let mut found: Vec<(VertexId, Option<Path>)> = Vec::new();
    // Those of all vertices may take gigabytes.
    let keeps_all = output.is_some() || targets.len() <= LINES;
    for target in targets {
        match paths.to(target) {
            Ok(path) => {
                totals.add(target, path.as_ref());
                if keeps_all {
                    found.push((target, path));
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
            algorithm: options.algo.label(),
            mesh,
            paths: &found,
        };
        output.write(&format.render(&set)?)?;
    }
    if !options.quiet {
        terminal::print(&totals.summary(&found))?;
    }
    Ok(verdict)
}

/// What is told of many paths.
#[derive(Default)]
struct Totals {
    paths: usize,
    unreachable: usize,
    edges: usize,
    longest: Option<(VertexId, f64)>,
}

impl Totals {
    fn add(&mut self, target: VertexId, path: Option<&Path>) {
        self.paths += 1;
        let Some(path) = path else {
            self.unreachable += 1;
            return;
        };
        self.edges += path.edges().count();
        if self.longest.is_none_or(|(_, length)| path.length > length) {
            self.longest = Some((target, path.length));
        }
    }

    /// A line for each of `paths`, or one for all if they are many.
    fn summary(&self, paths: &[(VertexId, Option<Path>)]) -> String {
        if self.paths <= LINES {
            return lines(paths);
        }
        let longest = self.longest.map_or_else(String::new, |(v, length)| {
            format!(", the longest to vertex {v} of length {length}")
        });
        format!(
            "{} paths, {} unreachable, {} edges crossed{longest}\n",
            self.paths, self.unreachable, self.edges
        )
    }
}

fn lines(paths: &[(VertexId, Option<Path>)]) -> String {
    let mut text = String::new();
    for (target, path) in paths {
        let _ = match path {
            None => writeln!(text, "vertex {target}: unreachable"),
            Some(path) => {
                let source = source_of(path).map_or(u32::MAX, VertexId::raw);
                let bends = path.vertices().count().saturating_sub(2);
                writeln!(
                    text,
                    "vertex {source} to {target}: length {}, {} edges crossed, {bends} vertices passed",
                    path.length,
                    path.edges().count(),
                )
            }
        };
    }
    text
}
