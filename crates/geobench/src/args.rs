//! Parts of the command line that several commands share.

use std::path::PathBuf;

use anyhow::{bail, ensure};
use clap::{Args, ValueEnum};
use geobench_export::output::{self, OutputFile};
use geobench_export::picture::View;
use geobench_registry::{self as registry, Selection};
use geobench_report::table::ResultFormat;

/// Help text on models, for all commands that take models.
pub(crate) const MODELS_HELP: &str = "MODEL is a file (.obj, .ply, .off, .stl, .vtk, .vtp, .vtu, .gltf, .glb, .3mf, \
    .dae, .gii, each also .gz, or a FreeSurfer surface such as lh.white), a directory (searched recursively) or a generated model such as gen:sphere,subdiv=5 or gen:terrain,n=100,seed=1.";

/// The direction of view of a picture.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct ViewOption {
    /// Direction of view of a picture, AZIMUTH,ELEVATION in degrees. With the axis y up (the
    /// default) azimuth 0 looks from +z and 90 from +x, as in three.js; with ,z (z up) 0 looks
    /// from +x and 90 from +y, as in matplotlib [default: the view that shows most]
    #[arg(long, value_name = "A,E[,y|z]", allow_hyphen_values = true)]
    view: Option<View>,
}

impl ViewOption {
    /// The direction, if one is given.
    ///
    /// # Errors
    ///
    /// When one is given and no picture is drawn.
    pub(crate) fn of(self, is_picture: bool) -> anyhow::Result<Option<View>> {
        ensure!(
            self.view.is_none() || is_picture,
            "--view turns pictures, and no .svg or .png is written"
        );
        Ok(self.view)
    }
}

/// The rows of CSV.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct CsvOptions {
    /// Rows of CSV: one for each cell, or one for each sample of its time
    #[arg(long, value_name = "ROWS", value_enum, default_value_t)]
    csv: CsvRows,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum CsvRows {
    #[default]
    Cells,
    Samples,
}

impl CsvOptions {
    /// `format`, with these kinds of rows if it is CSV.
    pub(crate) fn of(self, format: ResultFormat) -> ResultFormat {
        match (format, self.csv) {
            (ResultFormat::Csv, CsvRows::Samples) => ResultFormat::Samples,
            (format, _) => format,
        }
    }

    /// The output files at `paths` with their formats; CSV files get these kinds of rows.
    pub(crate) fn outputs(
        self,
        paths: &[PathBuf],
    ) -> anyhow::Result<Vec<(ResultFormat, OutputFile)>> {
        let outputs = output::prepare(paths)?.into_iter();
        Ok(outputs
            .map(|(format, file)| (self.of(format), file))
            .collect())
    }
}

/// Form of a list on standard output.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum ListFormat {
    #[default]
    Table,
    Json,
}

/// The algorithm of a command that solves once.
#[derive(Args, Clone, Debug)]
pub(crate) struct AlgorithmOption {
    /// The algorithm [default: vtp-fast; mmp-fast on a model with edges of more than two faces, or
    /// one that cannot be oriented]
    #[arg(long, value_name = "A", value_parser = select_inside)]
    pub(crate) algo: Option<Selection>,
}

/// Parses an algorithm of this program.
pub(crate) fn select_inside(text: &str) -> anyhow::Result<Selection> {
    let selection = registry::select_one(text)?;
    if selection.outside_name().is_some() {
        bail!(
            "{} is an outside program: those take part in `run` and `verify`",
            selection.label()
        );
    }
    Ok(selection)
}

/// What a command does not print.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct QuietOption {
    /// Print no summary, no progress and no warnings; tables of results are printed
    #[arg(id = "quiet", long = "quiet")]
    pub(crate) is_set: bool,
}

/// The form of standard output.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct FormatOption<F: ValueEnum + Default + Copy + Send + Sync + 'static> {
    /// What goes to standard output [default: the first of these]
    // `default_value_t` would store one value for all types `F`.
    #[arg(long, value_name = "FORMAT", value_enum)]
    format: Option<F>,
}

impl<F: ValueEnum + Default + Copy + Send + Sync + 'static> FormatOption<F> {
    /// The form, or the default.
    pub(crate) fn chosen(&self) -> F {
        self.format.unwrap_or_default()
    }
}

/// The message of `error` without the usage that clap appends.
pub(crate) fn in_one_line(error: &clap::Error) -> String {
    let text = error.to_string();
    let text = text.strip_prefix("error: ").unwrap_or(&text);
    let text = text.split("\nUsage:").next().unwrap_or(text);
    let text = text.split("\nFor more information").next().unwrap_or(text);
    // Without the tip of clap to pass an unknown option as a value: no file is meant by it.
    let lines = text
        .lines()
        .filter(|line| !line.contains("as a value, use '--"));
    let text = lines
        .collect::<Vec<_>>()
        .join("\n")
        .replace("\n\n  tip: ", "; ");
    let words: Vec<&str> = text.split_whitespace().collect();
    words.join(" ")
}
