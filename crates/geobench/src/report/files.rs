//! A file for each table and plot, to take into a paper.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context;

use super::chart::{Chart, Spoken};
use super::document::{Document, Plot, Table};
use super::{Report, html, tex};
use crate::table::escape::csv_text;
use crate::table::output::OutputFile;

/// A form of the files of a report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Form {
    /// The page.
    Html,
    /// Every plot as SVG.
    Svg,
    /// Every table, and the numbers behind every plot, as CSV.
    Csv,
    /// Every table as LaTeX for the booktabs package, every plot for pgfplots.
    Tex,
}

/// Writes the files of `report` in one form into `directory`, which is made if it does not exist.
/// Returns their paths. Files of the same names are replaced, others left alone.
///
/// # Errors
///
/// When the directory cannot be made or a file cannot be written.
pub fn write_files(report: &Report, form: Form, directory: &Path) -> anyhow::Result<Vec<PathBuf>> {
    fs::create_dir_all(directory)
        .with_context(|| format!("{}: cannot be made", directory.display()))?;
    let mut paths = Vec::new();
    for (name, contents) in files(report, form)? {
        let path = directory.join(name);
        OutputFile::prepare(&path)?.write(&contents)?;
        paths.push(path);
    }
    Ok(paths)
}

/// Names and contents of the files of a report.
pub(super) fn files(report: &Report, form: Form) -> anyhow::Result<Vec<(String, Vec<u8>)>> {
    let document = &report.document;
    Ok(match form {
        Form::Html => vec![("report.html".to_owned(), html::page(report).into_bytes())],
        Form::Svg => document.plots().map(drawing).collect(),
        Form::Csv => csvs(document)?,
        Form::Tex => texs(document),
    })
}

fn drawing(plot: &Plot) -> (String, Vec<u8>) {
    let spoken = Spoken {
        id: &plot.id,
        title: &plot.title,
        description: &plot.caption,
    };
    let svg = plot.chart.draw(spoken, true);
    let text = format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{svg}");
    (format!("{}.svg", plot.id), text.into_bytes())
}

fn csvs(document: &Document) -> anyhow::Result<Vec<(String, Vec<u8>)>> {
    let mut files = Vec::new();
    for table in document.tables() {
        files.push((format!("{}.csv", table.id), table_csv(table)?));
    }
    for plot in document.plots() {
        // Of a picture there are no numbers.
        if !matches!(plot.chart, Chart::Picture(_)) {
            files.push((format!("{}.csv", plot.id), plot_csv(plot)?));
        }
    }
    Ok(files)
}

/// A table, the titles of its parts in a column of their own.
fn table_csv(table: &Table) -> anyhow::Result<Vec<u8>> {
    let parted = table.parts.iter().any(|part| !part.title.is_empty());
    let mut writer = csv::Writer::from_writer(Vec::new());
    let heads = table.columns.iter().map(|column| {
        let parts = [column.over.as_str(), column.head.as_str()];
        let parts: Vec<&str> = parts.into_iter().filter(|p| !p.is_empty()).collect();
        parts.join(", ")
    });
    let first = parted.then(|| "Of".to_owned());
    writer.write_record(
        first
            .into_iter()
            .chain(heads.map(|head| csv_text(&head).into_owned())),
    )?;
    for part in &table.parts {
        for row in &part.rows {
            let title = parted.then_some(part.title.as_str());
            let texts = title.into_iter().chain(row.iter().map(|e| e.text.as_str()));
            writer.write_record(texts.map(|text| csv_text(text).into_owned()))?;
        }
    }
    Ok(writer.into_inner()?)
}

/// The numbers behind a plot, one point in each line.
fn plot_csv(plot: &Plot) -> anyhow::Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(["of", "series", "x", "value", "low", "high", "absent"])?;
    for datum in plot.chart.data() {
        let number = |value: Option<f64>| value.map_or_else(String::new, |v| v.to_string());
        writer.write_record([
            csv_text(&datum.of).into_owned(),
            csv_text(&datum.series).into_owned(),
            number(datum.x),
            number(datum.value),
            number(datum.interval.map(|[low, _]| low)),
            number(datum.interval.map(|[_, high]| high)),
            csv_text(&datum.absent.unwrap_or_default()).into_owned(),
        ])?;
    }
    Ok(writer.into_inner()?)
}

fn texs(document: &Document) -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    for table in document.tables() {
        files.push((format!("{}.tex", table.id), tex::table(table).into_bytes()));
    }
    for plot in document.plots() {
        files.push((format!("{}.tex", plot.id), tex::plot(plot).into_bytes()));
        if let Chart::Picture(picture) = &plot.chart {
            files.push((format!("{}.png", plot.id), picture.png().to_vec()));
        }
    }
    files
}
