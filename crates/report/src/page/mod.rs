//! Reports of results: tables, plots and a picture.
//!
//! There are three independent steps. [`build`] turns results into a document: sections with
//! tables, charts and remarks. `chart` draws a chart as SVG or lists its numbers. `html`, `files`
//! and `tex` write the document as one self-contained page, or as a file for each table and plot.
//!
//! `table::results` builds the tables, so that a report and the terminal show the same. The SVG is
//! written here, because no plotting crate that was considered has all that the page needs: text
//! drawn as text, lines in the text colour of the page, descriptions for screen readers, and
//! patterns in addition to colours.

// Positions, sizes and counts are never negative here, and writing a page is not a hot loop.
#![allow(clippy::cast_sign_loss, clippy::format_push_string)]

pub(crate) mod chart;
pub(crate) mod document;
mod environment;
mod files;
mod headline;
pub(crate) mod html;
pub(crate) mod papers;
pub(crate) mod picture;
mod plots;
mod prose;
mod scaling;
pub(crate) mod setting;
mod tables;
#[cfg(test)]
mod tests;
mod tradeoff;
mod trend;

use std::collections::HashSet;
use std::path::PathBuf;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use geobench_harness::exec::limits::DecompressionLimit;
use geobench_harness::figures::capitalised;
use geobench_harness::schema::{Cell, GroupRecord, ResultFile, Status};
use geobench_registry::UsageError;

use crate::table::group::{GroupCells, Problem, algorithms};
use crate::table::{Note, ResultFormat, Table, matrix, results};
use chart::Chart;
use document::{Document, Download, Plot, Section, SectionItem, slug};
use setting::Setting;

pub use files::{Form, write_files};
pub use html::page;
pub use papers::Tables;
pub use picture::PictureChoice;
pub use trend::page as trend_page;

/// An input of a report: a result file with its path.
#[derive(Clone, Debug)]
pub struct Input {
    /// The file.
    pub path: PathBuf,
    /// The content.
    pub result: ResultFile,
    /// If several files were joined: their names, and how their runs differ.
    pub joined: Option<JoinedFrom>,
}

/// The files that one table was joined from.
#[derive(Clone, Debug)]
pub struct JoinedFrom {
    /// All files, in order.
    pub files: Vec<PathBuf>,
    /// What differs between their runs, one line each.
    pub differences: Vec<String>,
}

impl Input {
    /// The result file at `path`.
    pub fn new(path: PathBuf, result: ResultFile) -> Self {
        Self {
            path,
            result,
            joined: None,
        }
    }

    /// The names of its files without directory and ending.
    fn name(&self) -> String {
        let alone = std::slice::from_ref(&self.path);
        let files = self.joined.as_ref().map_or(alone, |joined| &joined.files);
        let stems: Vec<String> = files.iter().map(|path| stem(path)).collect();
        stems.join(", ")
    }
}

/// Options of a report.
#[derive(Clone, Debug)]
pub struct Options {
    /// The base of ratios. If `None`, or if a group does not have this algorithm: the algorithm
    /// that the group names, else `vtp`, else the reference of the checks, else the first
    /// algorithm.
    pub ratio_to: Option<String>,
    /// The model that is drawn.
    pub picture: PictureChoice,
    /// Limit on the decompressed size of the model of the picture.
    pub decompressed: DecompressionLimit,
    /// The papers' tables whose ratios are shown beside ours.
    pub tables: Tables,
}

/// A report, ready to be written.
#[derive(Clone, Debug)]
pub struct BuiltReport {
    document: Document,
}

/// The largest file of numbers that is embedded in the page, in bytes.
const MOST_EMBEDDED: usize = 1 << 20;

/// Builds the report on `inputs`.
///
/// # Errors
///
/// When no result has the algorithm of `options.ratio_to`, or the model of `options.picture` cannot
/// be drawn.
pub fn build(inputs: &[Input], options: &Options) -> Result<BuiltReport, UsageError> {
    if let Some(name) = &options.ratio_to {
        let known = algorithms(inputs.iter().flat_map(|input| &input.result.cells));
        if !known.contains(&name.as_str()) {
            return Err(UsageError(format!(
                "--ratio-to {name}: no group has this algorithm; there are {}",
                known.join(", ")
            )));
        }
    }
    let mut sections = Vec::new();
    let mut pictured = options.picture == PictureChoice::None;
    let mut missing = None;
    for (i, input) in inputs.iter().enumerate() {
        let prefix = if inputs.len() == 1 {
            String::new()
        } else {
            format!("r{}-", i + 1)
        };
        let result = with_base(&input.result, options.ratio_to.as_deref());
        let picture = if pictured {
            None
        } else {
            match picture::picture(&result, &options.picture, options.decompressed) {
                Ok(picture) => picture,
                // A later result may have the model.
                Err(error) => {
                    missing = missing.or(Some(error));
                    None
                }
            }
        };
        pictured |= picture.is_some();
        let picture = picture.map(|picture| Plot {
            id: format!("{prefix}result-picture-{}", slug(&picture.model)),
            title: format!("Distances on {}", picture.model),
            caption: picture.caption.clone(),
            chart: Chart::Picture(Box::new(picture)),
        });
        sections.extend(of_result(input, &result, &prefix, picture, options));
    }
    if let (false, Some(error), PictureChoice::Of { .. }) = (pictured, missing, &options.picture) {
        return Err(error);
    }
    let title = match inputs {
        [one] => format!("Exact geodesic distances: {}", one.name()),
        _ => "Exact geodesic distances".to_owned(),
    };
    Ok(BuiltReport {
        document: Document { title, sections },
    })
}

/// `result` with the base of ratios set in every group of several algorithms. `wanted` is the base
/// in groups that have it.
fn with_base(result: &ResultFile, wanted: Option<&str>) -> ResultFile {
    let mut result = result.clone();
    if result.groups.is_empty() {
        result.groups.push(GroupRecord::default());
    }
    let bases: Vec<Option<String>> = results::groups(&result)
        .iter()
        .map(|group| {
            let base = group.base()?;
            let wanted = wanted.filter(|name| group.algorithms.contains(name));
            Some(wanted.unwrap_or(base).to_owned())
        })
        .collect();
    for (group, base) in result.groups.iter_mut().zip(bases) {
        group.ratios_to = base;
    }
    result
}

fn of_result(
    input: &Input,
    result: &ResultFile,
    prefix: &str,
    picture: Option<Plot>,
    options: &Options,
) -> Vec<Section> {
    let name = input.name();
    let groups = results::groups(result);
    let mut head = Vec::new();
    for (i, group) in groups.iter().enumerate() {
        let name = group.record.name.clone().filter(|_| groups.len() > 1);
        let headline = headline::headline(group);
        head.extend(headline.map(|headline| SectionItem::Headline(name, headline)));
        let matrix = matrix::matrix(group).map(|matrix| Table {
            id: format!("{prefix}g{}-matrix", i + 1),
            ..matrix
        });
        head.extend(matrix.map(SectionItem::Table));
    }
    let mut warnings = headline::warnings(result);
    if let Some(joined) = &input.joined {
        let difference = |text: &String| format!("{}.", capitalised(text));
        warnings.extend(joined.differences.iter().map(difference));
    }
    if !warnings.is_empty() {
        head.push(SectionItem::Warnings(warnings));
    }
    head.push(SectionItem::Text(environment::summary(result)));
    head.push(match raw_numbers(input) {
        links if links.is_empty() => SectionItem::Text(format!(
            "The raw numbers, in {name}, are too large for this page."
        )),
        links => SectionItem::Links(links),
    });
    let mut all = vec![Section {
        id: format!("{prefix}result"),
        heading: name,
        top: true,
        blocks: head,
    }];
    let mut picture = picture;
    let styles = algorithms(&result.cells);
    let claimed = algorithms(result.cells.iter().filter(|cell| cell.time.unconfirmed));
    let tables = options.tables.of(result);
    for (i, group) in groups.iter().enumerate() {
        let record = group.record;
        let id = match record.name.as_deref().map(slug) {
            Some(slug) if !slug.is_empty() => format!("{prefix}g{}-{slug}", i + 1),
            _ => format!("{prefix}g{}", i + 1),
        };
        let setting = Setting {
            prefix: &id,
            styles: &styles,
            claimed: &claimed,
            base: record.ratios_to.as_deref(),
        };
        let mut blocks = of_group(group, setting, picture.take());
        for (k, table) in tables.iter().enumerate() {
            let prefix = format!("{id}-paper-{}", k + 1);
            blocks.extend(papers::compare(group, table, setting, &prefix));
        }
        all.push(Section {
            heading: record
                .name
                .clone()
                .unwrap_or_else(|| "Time, work and memory".to_owned()),
            top: false,
            blocks,
            id,
        });
    }
    let models = tables::models(&format!("{prefix}models-table"), result);
    let environment = vec![
        SectionItem::Facts(environment::facts(result)),
        SectionItem::Text(reading(result)),
    ];
    for (heading, blocks) in [
        ("Models", vec![SectionItem::Table(models)]),
        ("Environment", environment),
    ] {
        all.push(Section {
            id: format!("{prefix}{}", slug(heading)),
            heading: heading.to_owned(),
            top: false,
            blocks,
        });
    }
    all
}

/// The items of a group. `picture` is shown beside its plots.
fn of_group(
    group: &GroupCells<'_>,
    setting: Setting<'_>,
    picture: Option<Plot>,
) -> Vec<SectionItem> {
    let mut blocks = Vec::new();
    if let Some(shows) = &group.record.shows {
        blocks.push(SectionItem::Text(
            shows.split_whitespace().collect::<Vec<_>>().join(" "),
        ));
    }
    if group.cells.is_empty() {
        let text = "No cell of this group is in the file: the run ended before it.".to_owned();
        blocks.push(SectionItem::Notes(vec![Note {
            text,
            failure: true,
        }]));
        return blocks;
    }
    let table = tables::figures(&format!("{}-table", setting.prefix), group);
    let notes = tables::notes(&table);
    blocks.push(SectionItem::Figures(table));
    if !notes.is_empty() {
        blocks.push(SectionItem::Notes(notes));
    }
    let [mut plots, more] = plots::plots(group, setting);
    plots.extend(picture);
    if !plots.is_empty() {
        blocks.push(SectionItem::Plots(plots));
    }
    let id = format!("{}-sources-table", setting.prefix);
    let crossings = tradeoff::crossings(&id, group).map(SectionItem::Table);
    let titles: Vec<&str> = more.iter().map(|plot| plot.title.as_str()).collect();
    let summary = format!("More plots: {}", titles.join("; "));
    let plots = (!more.is_empty()).then_some(SectionItem::Plots(more));
    let items: Vec<SectionItem> = plots.into_iter().chain(crossings).collect();
    if !items.is_empty() {
        blocks.push(SectionItem::More(summary, items));
    }
    blocks
}

/// An explanation of the figures.
fn reading(result: &ResultFile) -> String {
    let mut text = crate::table::footnote(
        result,
        crate::table::Look {
            styled: true,
            width: None,
        },
    )
    .trim_end()
    .to_owned();
    if !text.is_empty() {
        text += ". ";
    }
    let answers = result.cells.iter().filter(|cell| cell.status == Status::Ok);
    let referred = result.cells.iter().filter_map(|cell| {
        let reference = cell.check.reference.as_deref();
        let reference = reference.filter(|name| *name != cell.algorithm)?;
        Some((reference, Problem::of(cell)))
    });
    let referred: HashSet<(&str, Problem<'_>)> = referred.collect();
    let unchecked = answers.clone();
    let unchecked = unchecked.filter(|cell| !is_compared(cell, &referred));
    let unchecked = unchecked.count();
    text += &match (unchecked, answers.count()) {
        (0, _) => "Every answer was compared with the reference that the remarks name; a wrong one has no time.".to_owned(),
        (n, all) => format!("{n} of {all} answers were not compared with a reference."),
    };
    text + " Intervals are 95 % intervals of medians, from order statistics."
}

/// Whether the answer of `cell` was compared with another. The reference itself was compared if it
/// is the reference of a further cell of the same problem, which are those `referred` to.
fn is_compared(cell: &Cell, referred: &HashSet<(&str, Problem<'_>)>) -> bool {
    match cell.check.reference.as_deref() {
        Some(name) if name == cell.algorithm => referred.contains(&(name, Problem::of(cell))),
        reference => reference.is_some(),
    }
}

/// Downloads of the result as JSON and CSV, embedded as data URLs. What is larger than
/// [`MOST_EMBEDDED`] is left out.
fn raw_numbers(input: &Input) -> Vec<Download> {
    let name = input.name();
    let mut links = Vec::new();
    for (format, ending, kind) in [
        (ResultFormat::Json, "json", "application/json"),
        (ResultFormat::Csv, "csv", "text/csv"),
    ] {
        let Ok(text) = format.render(&input.result) else {
            continue;
        };
        if text.len() <= MOST_EMBEDDED {
            links.push(Download {
                label: format!("All numbers as {}", ending.to_uppercase()),
                address: format!("data:{kind};base64,{}", STANDARD.encode(&text)),
                file: format!("{name}.{ending}"),
            });
        }
    }
    links
}

fn stem(path: &std::path::Path) -> String {
    path.file_stem().map_or_else(
        || path.display().to_string(),
        |stem| stem.to_string_lossy().into_owned(),
    )
}
