//! Parts of the command line that several commands share.

use std::path::PathBuf;

use anyhow::ensure;
use clap::builder::RangedI64ValueParser;
use clap::{Args, ValueEnum, value_parser};
use geobench_export::output::{self, OutputFile};
use geobench_export::picture::View;
use geobench_harness::figures;
use geobench_harness::plan::suite;
use geobench_registry::{MOST_THREADS, Selection, UsageError, select};
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

/// A list of algorithms. This is a separate type because clap treats a `Vec` as a repeated option.
#[derive(Clone, Debug)]
pub(crate) struct Algorithms(pub(crate) Vec<Selection>);

/// Parses a list of algorithms.
pub(crate) fn algorithms(list: &str) -> Result<Algorithms, UsageError> {
    select(list).map(Algorithms)
}

/// Parses the largest relative difference that passes.
pub(crate) fn tolerance(text: &str) -> Result<f64, String> {
    suite::tolerance(text.parse().ok())
}

/// Parses the name of a row of tables.
pub(crate) fn row(name: &str) -> Result<String, UsageError> {
    figures::figure(name).map(|figure| figure.key.to_owned())
}

/// The parser of a number of threads.
pub(crate) fn threads() -> RangedI64ValueParser<u32> {
    value_parser!(u32).range(1..=i64::from(MOST_THREADS))
}

/// The message of `error` without the usage that clap appends.
pub(crate) fn in_one_line(error: &clap::Error) -> String {
    let text = error.to_string();
    let text = text.strip_prefix("error: ").unwrap_or(&text);
    let text = text.split("\nUsage:").next().unwrap_or(text);
    let text = text.split("\nFor more information").next().unwrap_or(text);
    let text = text.replace("\n\n  tip: ", "; ");
    let words: Vec<&str> = text.split_whitespace().collect();
    words.join(" ")
}
