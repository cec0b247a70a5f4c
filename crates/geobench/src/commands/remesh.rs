//! `geobench remesh`.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, bail};
use clap::{Args, value_parser};
use geobench_export::diagrams;
use geobench_export::ending_of;
use geobench_export::output::{OutputFile, check_files};
use geobench_export::picture::{Paint, Scene, View};
use geobench_harness::measure::number::counted;
use geobench_mesh::io as mesh_io;
use geobench_mesh::{Mesh, VertexId};
use geobench_voronoi::{Quality, RemeshOptions as Sites, Remeshed, SurfaceDeviation};

use super::generate;
use crate::args::{MODELS_HELP, QuietOption, ViewOption};
use crate::isolation::ReadingOptions;
use crate::terminal;
use crate::verdict::Verdict;

#[derive(Args, Debug)]
#[command(after_help = MODELS_HELP)]
pub(crate) struct RemeshingOptions {
    /// The model
    #[arg(value_name = "MODEL")]
    model: String,

    /// Number of vertices of the new mesh; more are added where the dual would be no mesh, up to
    /// 4 N + 256
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = value_parser!(u32).range(1..))]
    sites: u32,

    /// Steps of Lloyd's algorithm, each of which moves the sites to the centres of their cells
    #[arg(long, value_name = "K", default_value_t = 5, allow_negative_numbers = true, value_parser = value_parser!(u32).range(..=1000))]
    lloyd: u32,

    /// Draws the first site
    #[arg(
        long,
        value_name = "S",
        default_value_t = 0,
        allow_negative_numbers = true
    )]
    seed: u64,

    #[command(flatten)]
    reading: ReadingOptions,

    /// Mesh to write: .obj, .ply, .off or .stl, each also .gz
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    /// Picture to write as well, .svg or .png: the model with the cells of the sites, and the new
    /// mesh beside it
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,

    #[command(flatten)]
    view: ViewOption,

    #[command(flatten)]
    quiet: QuietOption,
}

/// Number of sample points on each surface for its distance from the other one.
const SAMPLES: usize = 100_000;

/// Colour of the faces of the new mesh in the picture, RGB.
const PLAIN: [u8; 3] = [222, 226, 233];

pub(crate) fn remesh(options: &RemeshingOptions) -> anyhow::Result<Verdict> {
    let ending = generate::ending(&options.output)?;
    let output = OutputFile::prepare(&options.output)?;
    let picture = match &options.picture {
        Some(path) => Some((is_png(path)?, OutputFile::prepare(path)?)),
        None => None,
    };
    let view = options.view.of(picture.is_some())?;
    let mut outputs = vec![&output];
    outputs.extend(picture.as_ref().map(|(_, output)| output));
    let model = options.reading.model(&options.model)?;
    check_files(outputs, model.source_file())?;
    let mesh = &options.reading.mesh(&model, options.quiet.is_set)?;
    let sites = Sites {
        sites: options.sites as usize,
        lloyd: options.lloyd as usize,
        seed: options.seed,
    };
    let start = Instant::now();
    let new = geobench_voronoi::remesh(mesh, &sites).with_context(|| model.path.clone())?;
    let seconds = start.elapsed().as_secs_f64();
    // All outputs are computed before any is written, so that a failure leaves no partial set.
    let soup = new.soup();
    let picture = match picture {
        Some((png, output)) => Some((draw(&new, view, png, &model.name)?, output)),
        None => None,
    };
    let is_quiet = options.quiet.is_set || options.output == Path::new("-");
    let summary = if is_quiet {
        String::new()
    } else {
        summary(options, mesh, &new, seconds)?
    };
    output.write_with(ending, |path| Ok(mesh_io::write(path, &soup)?))?;
    if let Some((contents, output)) = picture {
        output.write(&contents)?;
    }
    terminal::print(&summary)?;
    Ok(Verdict::Passed)
}

/// Whether a picture is a PNG, else an SVG, by the extension of its file.
fn is_png(path: &Path) -> anyhow::Result<bool> {
    match ending_of(path).to_ascii_lowercase().as_str() {
        "png" => Ok(true),
        "svg" => Ok(false),
        _ => bail!("{}: pictures have the ending .svg or .png", path.display()),
    }
}

/// A picture of the model, coloured by cell and with the sites, beside the new mesh with its edges.
fn draw(new: &Remeshed, view: Option<View>, png: bool, model: &str) -> anyhow::Result<Vec<u8>> {
    let before = new.diagram.mesh();
    let flat = vec![0.0; before.vertex_count().max(new.mesh.vertex_count())];
    let sites = new.mesh.positions();
    let edges = new.mesh.half_edges().filter(|&h| {
        let twin = new.mesh.twin(h);
        twin.is_none_or(|twin| h < twin)
    });
    let at = |v: VertexId| sites[v.index()];
    let edges = edges.map(|h| vec![at(new.mesh.tail(h)), at(new.mesh.head(h))]);
    let cells = Scene {
        paint: Some(&Paint::cells(&new.diagram)),
        sources: sites,
        isolines: &diagrams::long_lines(&new.diagram).unwrap_or_default(),
        view,
        ..Scene::new(before, &flat)
    };
    let triangles = Scene {
        paint: Some(&Paint::plain(&new.mesh, PLAIN)),
        isolines: &edges.collect::<Vec<_>>(),
        ..Scene::new(&new.mesh, &flat)
    };
    cells.draw_beside(&triangles, png, model, "Cells and dual")
}

fn summary(
    options: &RemeshingOptions,
    mesh: &Mesh,
    new: &Remeshed,
    seconds: f64,
) -> anyhow::Result<String> {
    let mut text = format!(
        "{}: {} vertices, {} faces in {seconds:.3} s\n",
        options.output.display(),
        new.mesh.vertex_count(),
        new.mesh.face_count()
    );
    // Writing to a string cannot fail.
    if new.added > 0 {
        let _ = writeln!(
            text,
            "{} more than asked for, where the dual was no triangulation",
            counted(new.added, "site")
        );
    }
    if new.split > 0 {
        let _ = writeln!(
            text,
            "{} of more than three cells split",
            counted(new.split, "Voronoi vertex")
        );
    }
    let _ = writeln!(text, "{:26}{:>12}{:>12}", "", "before", "after");
    let mut row = |name: &str, [before, after]: [String; 2]| {
        let _ = writeln!(text, "{name:26}{before:>12}{after:>12}");
    };
    let meshes = [mesh, &new.mesh];
    row("vertices", meshes.map(|m| m.vertex_count().to_string()));
    row("faces", meshes.map(|m| m.face_count().to_string()));
    let quality = meshes.map(Quality::of);
    row(
        "least angle",
        quality.map(|q| format!("{:.2}°", q.least_angle)),
    );
    row(
        "mean of the least angles",
        quality.map(|q| format!("{:.2}°", q.mean_least_angle)),
    );
    row(
        "angles below 30°",
        quality.map(|q| format!("{:.2} %", 100.0 * q.below_30)),
    );
    row(
        "mean aspect (1 is best)",
        quality.map(|q| format!("{:.3}", q.mean_aspect)),
    );
    row(
        "worst aspect",
        quality.map(|q| format!("{:.3}", q.worst_aspect)),
    );
    let there = SurfaceDeviation::between(mesh, &new.mesh, SAMPLES)?;
    let back = SurfaceDeviation::between(&new.mesh, mesh, SAMPLES)?;
    let diagonal = mesh.diagonal();
    let shown = |d: f64| {
        let percent = 100.0 * d / diagonal.max(f64::MIN_POSITIVE);
        format!("{d:.3e} ({percent:.3} %)")
    };
    let _ = writeln!(
        text,
        "Hausdorff distance {}, in percent of the diagonal; sampled at vertices and {SAMPLES} points:",
        shown(there.greatest.max(back.greatest))
    );
    for (way, found) in [("before to after", there), ("after to before", back)] {
        let [greatest, mean] = [found.greatest, found.mean].map(shown);
        let _ = writeln!(text, "  {way}: greatest {greatest}, mean {mean}");
    }
    Ok(text)
}
