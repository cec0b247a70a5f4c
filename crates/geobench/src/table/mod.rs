//! Writes results as tables and files.

use std::path::Path;
use std::sync::OnceLock;

use self::group::GroupCells;
use crate::schema::{Cell, GroupRecord, ModelRecord, ResultFile};

mod bars;
mod comparison;
pub(crate) mod csv;
pub mod diagram_formats;
pub mod distance_formats;
pub(crate) mod escape;
mod exports;
pub(crate) mod figures;
pub(crate) mod group;
mod history;
pub(crate) mod html;
pub mod isoline_formats;
pub(crate) mod latex;
pub(crate) mod markdown;
mod model;
pub mod output;
pub mod path_formats;
mod polylines;
pub(crate) mod results;
pub(crate) mod terminal;
#[cfg(test)]
pub(crate) mod tests;

pub use bars::model_bars;
pub use comparison::ComparisonFormat;
pub use csv::header as csv_header;
pub use figures::{Figure, UnknownFigure, figure};
pub use history::{change_points, gate};
pub(crate) use model::{Column, Entry, Mark, Note, Part, Table};
pub use terminal::Look;

/// A form in which results can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// A table per model for the terminal.
    Table,
    /// One table in Markdown.
    Markdown,
    /// One table in LaTeX, for the booktabs package.
    Latex,
    /// One row per cell.
    Csv,
    /// One row per sample, as CSV.
    #[value(skip)]
    Samples,
    /// Everything.
    Json,
    /// For Bencher, in its metric format.
    #[value(skip)]
    Bencher,
    /// For github-action-benchmark.
    #[value(skip)]
    GithubAction,
}

/// The endings of result files.
const ENDINGS: [(&str, Format); 6] = [
    ("json", Format::Json),
    ("csv", Format::Csv),
    ("md", Format::Markdown),
    ("tex", Format::Latex),
    ("bmf.json", Format::Bencher),
    ("gab.json", Format::GithubAction),
];

/// The path that stands for standard input and output.
pub(crate) const STANDARD: &str = "-";

/// The form of what goes to standard output as `-`, named like an ending. Set once, from the
/// command line.
static STANDARD_OUTPUT_FORM: OnceLock<String> = OnceLock::new();

/// Sets the form of what goes to standard output as `-`: an ending without its dot.
pub(crate) fn set_standard_output_form(ending: &str) {
    // The command line is read once.
    let _ = STANDARD_OUTPUT_FORM.set(ending.trim_start_matches('.').to_lowercase());
}

/// The ending of a file, or the form of standard output.
pub(crate) fn ending_of(path: &Path) -> String {
    if path == Path::new(STANDARD) {
        return STANDARD_OUTPUT_FORM.get().cloned().unwrap_or_default();
    }
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    let stem = path.file_stem().map(Path::new);
    match stem.and_then(Path::extension) {
        // Endings of two words.
        Some(before) if before == "bmf" || before == "gab" => {
            format!("{}.{ending}", before.to_string_lossy())
        }
        _ => ending.into_owned(),
    }
}

/// A path with an ending that cannot be written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{path}: {how} says in which form to write {what}; use {endings}")]
pub struct UnknownEnding {
    /// The path.
    pub path: String,
    /// What tells the form: the ending or an option.
    pub how: &'static str,
    /// The content of the file.
    pub what: &'static str,
    /// The supported endings, in words.
    pub endings: String,
}

/// The form for the ending of `path`, in any letter case.
pub(crate) fn of_ending<F: Copy>(
    path: &Path,
    what: &'static str,
    endings: &[(&str, F)],
) -> Result<F, UnknownEnding> {
    let ending = ending_of(path);
    let found = endings
        .iter()
        .find(|(name, _)| ending.eq_ignore_ascii_case(name));
    found.map(|(_, form)| *form).ok_or_else(|| {
        let names: Vec<String> = endings.iter().map(|(name, _)| format!(".{name}")).collect();
        UnknownEnding {
            path: path.display().to_string(),
            how: if path == Path::new(STANDARD) {
                "--output-format"
            } else {
                "the ending"
            },
            what,
            endings: match names.split_last() {
                Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
                _ => names.concat(),
            },
        }
    })
}

/// `document` as one line of JSON.
pub(crate) fn json_line(document: &impl serde::Serialize) -> anyhow::Result<Vec<u8>> {
    let mut bytes = serde_json::to_vec(document)?;
    bytes.push(b'\n');
    Ok(bytes)
}

impl Format {
    /// The form for the ending of `path`, in any letter case.
    ///
    /// # Errors
    ///
    /// When no form has this ending.
    pub fn of_path(path: &Path) -> Result<Self, UnknownEnding> {
        of_ending(path, "results", &ENDINGS)
    }

    /// Results in this form, ending in a line break.
    ///
    /// # Errors
    ///
    /// Only if a number or a text cannot be represented, which the records exclude.
    pub fn render(self, result: &ResultFile) -> anyhow::Result<String> {
        Ok(match self {
            Self::Table => {
                let table = |table: &Table| terminal::table(table, Look::default());
                tables(result).iter().map(table).collect::<String>()
                    + &footnote(result, Look::default())
            }
            Self::Markdown => joined(result, markdown::table),
            Self::Latex => latex::NEEDS.to_owned() + &joined(result, latex::table),
            Self::Csv => csv::table(&csv::results(result))?,
            Self::Samples => csv::table(&csv::samples(result))?,
            Self::Json => serde_json::to_string_pretty(result)? + "\n",
            Self::Bencher => serde_json::to_string_pretty(&exports::bencher(result))? + "\n",
            Self::GithubAction => {
                serde_json::to_string_pretty(&exports::github_action(result))? + "\n"
            }
        })
    }
}

/// A number with its noun: `1 loop`, `2 loops`.
pub(crate) fn counted(count: usize, thing: &str) -> String {
    match count {
        1 => format!("1 {thing}"),
        _ => format!("{count} {thing}s"),
    }
}

/// The tables of all groups. Each says if its times are disturbed.
fn tables(result: &ResultFile) -> Vec<Table> {
    let mut tables: Vec<Table> = results::groups(result).iter().map(results::table).collect();
    if let Some(disturbance) = disturbance(result) {
        for table in &mut tables {
            let note = Note {
                text: format!("the times are disturbed: {disturbance}"),
                failure: false,
            };
            table
                .parts
                .iter_mut()
                .for_each(|part| part.notes.push(note.clone()));
        }
    }
    tables
}

/// That several cells ran at the same time, if they did.
pub fn disturbance(result: &ResultFile) -> Option<String> {
    let jobs = result.jobs()?;
    Some(format!("{jobs} cells ran at the same time"))
}

/// The tables of all groups, written by `write`, with an empty line between them.
fn joined(result: &ResultFile, write: fn(&Table) -> String) -> String {
    let tables: Vec<String> = tables(result).iter().map(write).collect();
    tables.join("\n")
}

/// The heading of the tables of a group: its name and its text. Empty if the group has neither.
pub fn group_heading(group: &GroupRecord, look: Look) -> String {
    let [name, shows] = [&group.name, &group.shows].map(|text| text.as_deref().unwrap_or_default());
    terminal::heading(name, shows, look)
}

/// The table of one model of a group, under a line with its name, followed by an empty line.
pub fn model_table(group: &GroupRecord, model: &ModelRecord, cells: &[Cell], look: Look) -> String {
    let group = GroupCells::new(group, std::slice::from_ref(model), cells);
    part(&group, &results::part(&group, model), look)
}

/// The table of the ratios in a group of `result`, if the group has a base for ratios.
pub fn ratio_table(group: &GroupRecord, result: &ResultFile, look: Look) -> String {
    let group = GroupCells::new(group, &result.models, &result.cells);
    let ratios = results::ratios(&group);
    ratios.map_or_else(String::new, |ratios| part(&group, &ratios, look))
}

fn part(group: &GroupCells<'_>, part: &Part, look: Look) -> String {
    let table = Table::new(results::columns(group), Vec::new());
    terminal::part(&table, part, look)
}

/// The meaning of the figures in the tables of `result`, in one line.
pub fn footnote(result: &ResultFile, look: Look) -> String {
    let runs = result.cells.iter().map(|c| c.time.samples.len());
    let runs: Vec<usize> = runs.filter(|runs| *runs > 0).collect();
    let mut times = match (runs.iter().min(), runs.iter().max()) {
        (Some(1), Some(1)) => "time of one run; ".to_owned(),
        (Some(fewest), Some(most)) if fewest == most => format!("time: median of {most} runs; "),
        (Some(fewest), Some(most)) => format!("time: median of {fewest} to {most} runs; "),
        // The tables have no figure.
        _ => return String::new(),
    };
    let batches = result.cells.iter().flat_map(|cell| &cell.time.solves);
    if let Some(solves) = batches.max() {
        times = format!("{times}runs have up to {solves} solves and their mean time; ");
    }
    if let Some(disturbance) = disturbance(result) {
        times = format!("{times}disturbed, since {disturbance}; ");
    }
    let star = if look.styled { "" } else { "; * best" };
    let text = format!(
        "{times}papers' count: 80 bytes per window; measured: heap of the algorithm without the mesh; \
         MB = 10^6 bytes{star}"
    );
    terminal::line_in(look, "", &text) + "\n"
}
