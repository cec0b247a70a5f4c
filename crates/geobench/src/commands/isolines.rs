//! `geobench isolines`.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use clap::Args;
use geobench_export::FileFormat;
use geobench_export::isolines::{IsolineFormat, IsolineSet, RunWavefront};
use geobench_export::output::{check_files, prepare_one};
use geobench_export::picture::Scene;
use geobench_harness::measure::number::{counted, shortest};
use geobench_isolines::{DistanceField, Isoline};
use geobench_registry::Selection;
use geobench_window::{Fronts, Goal, Observer, WavefrontMoment, precision};

use crate::args::{MODELS_HELP, QuietOption, ViewOption, select_inside};
use crate::isolation::ReadingOptions;
use crate::points::{LocatedPoints, SourcesOptions};
use crate::terminal;
use crate::verdict::Verdict;

#[derive(Args, Debug)]
#[command(
    after_help = MODELS_HELP,
    group(clap::ArgGroup::new("wanted").required(true).args(["every", "levels"])),
)]
pub(crate) struct IsolinesOptions {
    /// The model
    #[arg(value_name = "MODEL")]
    model: String,

    #[command(flatten)]
    sources: SourcesOptions,

    /// Isolines at all multiples of this distance
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = positive_distance)]
    every: Option<f64>,

    /// Isolines at these distances, separated by commas
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        allow_negative_numbers = true,
        value_parser = positive_distance
    )]
    levels: Vec<f64>,

    /// How far the chords of lines may be from their arcs, in files other than .json
    /// [default: a ten thousandth of the size of the model]
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = positive_distance)]
    tolerance: Option<f64>,

    /// Also the windows that wait in a run of this algorithm when the mean of their distances comes
    /// to each of the distances
    #[arg(long, value_name = "A", value_parser = select_inside)]
    wavefront: Option<Selection>,

    #[command(flatten)]
    reading: ReadingOptions,

    /// File to write, by its ending: .json has the arcs; .vtp, .vtk, .obj and .ply lines; .svg and
    /// .png a picture of the model
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    #[command(flatten)]
    view: ViewOption,

    #[command(flatten)]
    quiet: QuietOption,
}

/// Parses a distance above 0.
fn positive_distance(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(distance) if distance > 0.0 && distance.is_finite() => Ok(distance),
        _ => Err("give a distance above 0".to_owned()),
    }
}

/// Maximum number of isolines for which the summary has a line each.
const LINES: usize = 20;

/// Gap in an isoline, relative to its distance, above which a warning is printed.
const GAP: f64 = 1e-6;

/// Default of `--tolerance`, relative to the diagonal of the bounding box of the model.
const TOLERANCE: f64 = 1e-4;

pub(crate) fn isolines(options: &IsolinesOptions) -> anyhow::Result<Verdict> {
    let (format, output) = prepare_one::<IsolineFormat>(&options.output)?;
    let view = options.view.of(format.is_picture())?;
    let model = options.reading.model(&options.model)?;
    let read = model.source_file().into_iter();
    check_files([&output], read.chain(options.sources.file()))?;
    let mesh = &options.reading.mesh(&model, options.quiet.is_set)?;
    let points = LocatedPoints::new(mesh, &options.sources.all()?, None, &model.path)?;
    if !options.quiet.is_set {
        points.tell(mesh, false);
    }
    let is_quiet = options.quiet.is_set || options.output == Path::new("-");
    let field = DistanceField::new(mesh, &points.places).with_context(|| model.path.clone())?;
    if let Some(doubt) = precision::doubt(mesh, field.distances()) {
        terminal::warning(&format!("{}: {doubt}", model.name));
    }
    let finite = field.distances().iter().copied().filter(|d| d.is_finite());
    let farthest = finite.fold(0.0, f64::max);
    let levels = match options.every {
        Some(every) => field.levels_every(every).context("--every")?,
        None => distinct(&options.levels),
    };
    let isolines = field.isolines(&levels);
    for isoline in &isolines {
        if isoline.gap > GAP * isoline.distance {
            terminal::warning(&format!(
                "{}: the isoline at {} has a gap of {:.1e}, beside faces with no area",
                model.name,
                shortest(isoline.distance),
                isoline.gap
            ));
        }
    }
    let fronts = match &options.wavefront {
        Some(algorithm) => fronts_of(algorithm, &points, &levels)?,
        None => Vec::new(),
    };
    let wavefront = options.wavefront.as_ref().map(|algorithm| RunWavefront {
        algorithm: algorithm.label(),
        mesh: &points.refined.mesh,
        fronts: &fronts,
    });
    let set = IsolineSet {
        model: &model.name,
        sources: &points.source_labels(),
        mesh,
        isolines: &isolines,
        tolerance: options
            .tolerance
            .unwrap_or_else(|| TOLERANCE * mesh.diagonal()),
        wavefront,
    };
    let contents = if format.is_picture() {
        let lines = isolines.iter().flat_map(|isoline| &isoline.lines);
        let lines: Vec<_> = lines
            .map(|line| line.polyline(mesh, set.tolerance))
            .collect();
        let scene = Scene {
            sources: &points.positions(mesh),
            isolines: &lines,
            paths: &wavefront.map_or_else(Vec::new, |wavefront| wavefront.lines()),
            levels: &levels,
            view,
            ..Scene::new(mesh, field.distances())
        };
        scene.draw(format == IsolineFormat::Png, &model.name, "Isolines")?
    } else {
        format.render(&set)?
    };
    output.write(&contents)?;
    if !is_quiet {
        let mut text = summary(&options.output, &isolines, farthest);
        if let Some(wavefront) = wavefront {
            text += &summary_of_fronts(&wavefront, &levels);
        }
        terminal::print(&text)?;
    }
    Ok(Verdict::Passed)
}

/// `levels`, each once.
fn distinct(levels: &[f64]) -> Vec<f64> {
    let mut kept: Vec<f64> = Vec::new();
    for &level in levels {
        if !kept.contains(&level) {
            kept.push(level);
        }
    }
    kept
}

/// The wavefront of a run of `algorithm` at these distances.
fn fronts_of(
    algorithm: &Selection,
    points: &LocatedPoints,
    levels: &[f64],
) -> anyhow::Result<Vec<WavefrontMoment>> {
    let mut fronts = Fronts::at(levels.iter().copied());
    let mut solver = algorithm.build(&points.refined.mesh);
    let (sources, goal) = (points.source_vertices(), Goal::everything());
    solver
        .run(&sources, &goal, Observer::Fronts(&mut fronts))
        .with_context(|| algorithm.label().to_owned())?;
    if fronts.found().is_empty() {
        bail!(
            "--wavefront {}: no windows that wait were seen at any of the distances; take distances \
             below that of the farthest vertex, and an algorithm that propagates windows on one thread",
            algorithm.label()
        );
    }
    Ok(fronts.found().to_vec())
}

/// A line for each front, if there are few, and one for the distances that no front comes to.
fn summary_of_fronts(wavefront: &RunWavefront<'_>, levels: &[f64]) -> String {
    let mut text = String::new();
    if levels.len() <= LINES {
        for WavefrontMoment { at, record, .. } in wavefront.fronts {
            let _ = writeln!(
                text,
                "wavefront of {} at {}: {} at {} on average (standard deviation {:.3e}), after {} \
                 were propagated",
                wavefront.algorithm,
                shortest(*at),
                counted(record.windows as usize, "window"),
                shortest(record.distance),
                record.deviation,
                record.parents
            );
        }
    }
    let missing = levels.len() - wavefront.fronts.len();
    if missing > 0 {
        let _ = writeln!(
            text,
            "the wavefront does not come to {missing} of the distances"
        );
    }
    text
}

fn summary(path: &Path, isolines: &[Isoline], farthest: f64) -> String {
    let lines: usize = isolines.iter().map(|isoline| isoline.lines.len()).sum();
    let all = isolines.iter().flat_map(|isoline| &isoline.lines);
    let arcs: usize = all.map(|line| line.arcs.len()).sum();
    let mut text = format!(
        "{}: {}, {}, {}; the farthest vertex is at {}\n",
        path.display(),
        counted(isolines.len(), "isoline"),
        counted(lines, "line"),
        counted(arcs, "arc"),
        shortest(farthest),
    );
    if isolines.len() <= LINES {
        for isoline in isolines {
            let closed = isoline.lines.iter().filter(|line| line.closed).count();
            let _ = writeln!(
                text,
                "distance {}: {}, {}, length {}",
                shortest(isoline.distance),
                counted(closed, "loop"),
                counted(isoline.lines.len() - closed, "open line"),
                shortest(isoline.length())
            );
        }
    }
    text
}
