//! Writes each table and plot to a file of its own, for use in papers.

use std::path::{Path, PathBuf};

use geobench_export::escape::printable;
use geobench_export::output::{OutputFile, check_files, make_directory};

use super::chart::{Chart, Datum};
use super::document::{Document, Plot};
use super::{BuiltReport, html};
use crate::table::{Column, Entry, Table, csv, latex};

/// An output format of a report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Form {
    /// The page.
    Html,
    /// Every plot as SVG.
    Svg,
    /// Every table, and the numbers behind every plot, as CSV.
    Csv,
    /// Every table as LaTeX for the booktabs package, every plot as a command that includes it.
    Tex,
}

/// Writes the files of `report` in one format into `directory`, which is created if missing.
/// Returns their paths. Files of the same names are replaced; other files are kept.
///
/// # Errors
///
/// When the directory cannot be created, a file cannot be written, or one of them is among the
/// files `read`. No file is written then.
pub fn write_files(
    report: &BuiltReport,
    form: Form,
    directory: &Path,
    read: &[PathBuf],
) -> anyhow::Result<Vec<PathBuf>> {
    make_directory(directory)?;
    let files = files(report, form)?;
    let paths: Vec<PathBuf> = files.iter().map(|(name, _)| directory.join(name)).collect();
    let outputs = paths.iter().map(|path| OutputFile::prepare(path));
    let outputs = outputs.collect::<anyhow::Result<Vec<_>>>()?;
    check_files(&outputs, read)?;
    for (output, (_, contents)) in outputs.iter().zip(&files) {
        output.write(contents)?;
    }
    Ok(paths)
}

/// Names and contents of the files of a report.
pub(super) fn files(report: &BuiltReport, form: Form) -> anyhow::Result<Vec<(String, Vec<u8>)>> {
    let document = &report.document;
    Ok(match form {
        Form::Html => vec![("report.html".to_owned(), html::page(report).into_bytes())],
        Form::Svg => document.plots().map(drawing).collect(),
        Form::Csv => csvs(document)?,
        Form::Tex => texs(document),
    })
}

fn drawing(plot: &Plot) -> (String, Vec<u8>) {
    let svg = plot.draw(true);
    let text = format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{svg}");
    (format!("{}.svg", plot.id), text.into_bytes())
}

fn csvs(document: &Document) -> anyhow::Result<Vec<(String, Vec<u8>)>> {
    let mut files = Vec::new();
    for table in document.tables() {
        files.push((format!("{}.csv", table.id), csv::table(table)?.into_bytes()));
    }
    for plot in document.plots() {
        // A picture has no numbers.
        if !matches!(plot.chart, Chart::Picture(_)) {
            let text = csv::table(&numbers(plot))?;
            files.push((format!("{}.csv", plot.id), text.into_bytes()));
        }
    }
    Ok(files)
}

/// The data of a plot, one row per point.
fn numbers(plot: &Plot) -> Table {
    let heads = ["of", "series", "x", "value", "low", "high", "absent"];
    let row = |datum: Datum| {
        let number = |value: Option<f64>| value.map_or_else(String::new, |v| v.to_string());
        let [low, high] = datum.interval.map_or([None; 2], |ends| ends.map(Some));
        let numbers = [datum.x, datum.value, low, high].map(number);
        let texts = [datum.of, datum.series].into_iter().chain(numbers);
        texts
            .chain(datum.absent.or(Some(String::new())))
            .map(Entry::new)
            .collect()
    };
    Table::new(
        Column::of(heads, [""; 0]),
        plot.chart.data().into_iter().map(row).collect(),
    )
}

/// Tables as `tabular` under their captions, plots as commands that include their drawings.
fn texs(document: &Document) -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    for table in document.tables() {
        let (needs, tabular) = (latex::NEEDS, latex::tabular(table));
        let text = format!("% {}\n{needs}{tabular}", printable(&table.caption));
        files.push((format!("{}.tex", table.id), text.into_bytes()));
    }
    for plot in document.plots() {
        let id = &plot.id;
        let (drawing, package, command) = match &plot.chart {
            Chart::Picture(picture) => {
                let drawing = (format!("{id}.png"), picture.flat.png());
                (drawing, "graphicx", "includegraphics")
            }
            _ => (drawing(plot), "svg", "includesvg"),
        };
        let text = format!(
            "% {}. {}\n% Needs \\usepackage{{{package}}}.\n\\{command}[width=\\linewidth]{{{id}}}\n",
            printable(&plot.title),
            printable(&plot.caption)
        );
        files.extend([(format!("{id}.tex"), text.into_bytes()), drawing]);
    }
    files
}
