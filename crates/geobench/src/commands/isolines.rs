//! `geobench isolines`.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use geobench_export::FileFormat;
use geobench_export::isolines::{IsolineFormat, IsolineSet};
use geobench_export::output::{check_files, prepare_one};
use geobench_export::picture::Scene;
use geobench_harness::measure::number::counted;
use geobench_isolines::{DistanceField, Isoline};
use geobench_window::precision;

use crate::args::{MODELS_HELP, QuietOption, ViewOption};
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
    check_files([&output], model.source_file())?;
    let mesh = &options.reading.mesh(&model, options.quiet.is_set)?;
    let points = LocatedPoints::new(mesh, &options.sources.all(), None, &model.path)?;
    if !options.quiet.is_set {
        points.tell(mesh);
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
        None => options.levels.clone(),
    };
    let isolines = field.isolines(&levels);
    for isoline in &isolines {
        if isoline.gap > GAP * isoline.distance {
            terminal::warning(&format!(
                "{}: the isoline at {} has a gap of {:.1e}, beside faces with no area",
                model.name, isoline.distance, isoline.gap
            ));
        }
    }
    let set = IsolineSet {
        model: &model.name,
        sources: &points.source_labels(),
        mesh,
        isolines: &isolines,
        tolerance: options
            .tolerance
            .unwrap_or_else(|| TOLERANCE * mesh.diagonal()),
    };
    let contents = if format.is_picture() {
        let lines = isolines.iter().flat_map(|isoline| &isoline.lines);
        let lines: Vec<_> = lines
            .map(|line| line.polyline(mesh, set.tolerance))
            .collect();
        let scene = Scene {
            sources: &points.positions(mesh),
            isolines: &lines,
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
        terminal::print(&summary(&options.output, &isolines, farthest))?;
    }
    Ok(Verdict::Passed)
}

fn summary(path: &Path, isolines: &[Isoline], farthest: f64) -> String {
    let lines: usize = isolines.iter().map(|isoline| isoline.lines.len()).sum();
    let all = isolines.iter().flat_map(|isoline| &isoline.lines);
    let arcs: usize = all.map(|line| line.arcs.len()).sum();
    let mut text = format!(
        "{}: {}, {}, {}; the farthest vertex is at {farthest}\n",
        path.display(),
        counted(isolines.len(), "isoline"),
        counted(lines, "line"),
        counted(arcs, "arc"),
    );
    if isolines.len() <= LINES {
        for isoline in isolines {
            let closed = isoline.lines.iter().filter(|line| line.closed).count();
            let _ = writeln!(
                text,
                "distance {}: {}, {}, length {}",
                isoline.distance,
                counted(closed, "loop"),
                counted(isoline.lines.len() - closed, "open line"),
                isoline.length()
            );
        }
    }
    text
}
