//! `geobench distance`.

use anyhow::{Context, bail};

use super::Verdict;
use super::args::DistanceOptions;
use super::terminal;
use crate::field::{DistanceField, FieldFormat};
use crate::model;
use crate::output::OutputFile;

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
    let loaded = model.load()?;
    let sources = options
        .source
        .resolve(loaded.mesh.vertex_count())
        .with_context(|| model.path.clone())?;
    let algorithm = options.algo.clone().with_threads(options.threads as usize);
    let distances = algorithm.build(&loaded.mesh).solve(&sources)?.distances;
    let field = DistanceField {
        model: &model.name,
        algorithm: options.algo.label(),
        sources: &sources.iter().map(|v| v.raw()).collect::<Vec<_>>(),
        mesh: &loaded.mesh,
        distances: &distances,
    };
    output.write(&format.render(&field)?)?;
    if !options.quiet {
        terminal::print(&summary(&distances, options))?;
    }
    Ok(Verdict::Passed)
}

fn summary(distances: &[f64], options: &DistanceOptions) -> String {
    let reached = || distances.iter().enumerate().filter(|(_, d)| d.is_finite());
    let farthest = reached()
        .max_by(|(_, a), (_, b)| a.total_cmp(b))
        .map_or_else(String::new, |(vertex, d)| {
            format!(", the farthest is vertex {vertex} at {d}")
        });
    format!(
        "{}: {} vertices, {} unreachable{farthest}\n",
        options.output.display(),
        distances.len(),
        distances.len() - reached().count()
    )
}
