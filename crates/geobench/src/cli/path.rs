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
use crate::plan::source::SourceSpec;
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
            let found = spec.resolve(mesh.vertex_count());
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
    let mut found: Vec<(VertexId, Option<Path>)> = Vec::with_capacity(targets.len());
    for target in targets {
        match paths.to(target) {
            Ok(path) => found.push((target, path)),
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
        terminal::print(&summary(&found))?;
    }
    Ok(verdict)
}

/// A line for each path, or one for all if they are many.
fn summary(paths: &[(VertexId, Option<Path>)]) -> String {
    let mut text = String::new();
    if paths.len() > LINES {
        let found = || {
            paths
                .iter()
                .filter_map(|(v, path)| Some((v, path.as_ref()?)))
        };
        let crossed: usize = found().map(|(_, path)| path.edges().count()).sum();
        let longest = found().max_by(|(_, a), (_, b)| a.length.total_cmp(&b.length));
        let longest = longest.map_or_else(String::new, |(v, path)| {
            format!(", the longest to vertex {v} of length {}", path.length)
        });
        let (count, none) = (paths.len(), paths.len() - found().count());
        let _ = writeln!(
            text,
            "{count} paths, {none} unreachable, {crossed} edges crossed{longest}"
        );
        return text;
    }
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
