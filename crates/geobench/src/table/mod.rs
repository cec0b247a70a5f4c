//! Writes results as tables and files.

use std::path::Path;

use self::group::Group;
use crate::schema::{Cell, GroupRecord, ModelRecord, ResultFile};

mod bars;
mod comparison;
pub(crate) mod csv;
pub mod distance_formats;
pub(crate) mod escape;
pub(crate) mod figures;
pub(crate) mod group;
pub(crate) mod html;
pub(crate) mod latex;
pub(crate) mod markdown;
mod model;
pub mod output;
pub mod path_formats;
pub(crate) mod results;
pub(crate) mod terminal;
#[cfg(test)]
pub(crate) mod tests;

pub use bars::model_bars;
pub use comparison::ComparisonFormat;
pub use csv::header as csv_header;
pub use figures::{Figure, UnknownFigure, figure};
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
    /// Everything.
    Json,
}

/// The endings of result files.
const ENDINGS: [(&str, Format); 4] = [
    ("json", Format::Json),
    ("csv", Format::Csv),
    ("md", Format::Markdown),
    ("tex", Format::Latex),
];

/// A path with an ending that cannot be written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{path}: the ending says in which form to write {what}; use {endings}")]
pub struct UnknownEnding {
    /// The path.
    pub path: String,
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
    let ending = path.extension().unwrap_or_default();
    let found = endings
        .iter()
        .find(|(name, _)| ending.eq_ignore_ascii_case(name));
    found.map(|(_, form)| *form).ok_or_else(|| {
        let names: Vec<String> = endings.iter().map(|(name, _)| format!(".{name}")).collect();
        UnknownEnding {
            path: path.display().to_string(),
            what,
            endings: match names.split_last() {
                Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
                _ => names.concat(),
            },
        }
    })
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
                tables(result).iter().map(table).collect::<String>() + &footnote(result, false)
            }
            Self::Markdown => joined(result, markdown::table),
            Self::Latex => latex::NEEDS.to_owned() + &joined(result, latex::table),
            Self::Csv => csv::table(&csv::results(result))?,
            Self::Json => serde_json::to_string_pretty(result)? + "\n",
        })
    }
}

/// The tables of all groups.
fn tables(result: &ResultFile) -> Vec<Table> {
    results::groups(result).iter().map(results::table).collect()
}

/// The tables of all groups, written by `write`, with an empty line between them.
fn joined(result: &ResultFile, write: fn(&Table) -> String) -> String {
    let tables: Vec<String> = tables(result).iter().map(write).collect();
    tables.join("\n")
}

/// The heading of the tables of a group: its name and its text. Empty if the group has neither.
pub fn group_heading(group: &GroupRecord) -> String {
    let [name, shows] = [&group.name, &group.shows].map(|text| text.as_deref().unwrap_or_default());
    terminal::heading(name, shows)
}

/// The table of one model of a group, under a line with its name, followed by an empty line.
pub fn model_table(group: &GroupRecord, model: &ModelRecord, cells: &[Cell], look: Look) -> String {
    let group = Group::new(group, std::slice::from_ref(model), cells);
    part(&group, &results::part(&group, model), look)
}

/// The table of the ratios in a group of `result`, if the group has a base for ratios.
pub fn ratio_table(group: &GroupRecord, result: &ResultFile, look: Look) -> String {
    let group = Group::new(group, &result.models, &result.cells);
    let ratios = results::ratios(&group);
    ratios.map_or_else(String::new, |ratios| part(&group, &ratios, look))
}

fn part(group: &Group<'_>, part: &Part, look: Look) -> String {
    let table = Table::new(results::columns(group), Vec::new());
    terminal::part(&table, part, look)
}

/// The meaning of the figures in the tables of `result`, in one line.
pub fn footnote(result: &ResultFile, styled: bool) -> String {
    let runs = result.cells.iter().map(|c| c.time.samples.len()).max();
    let times = match runs {
        // The tables have no figure.
        None | Some(0) => return String::new(),
        Some(1) => "time of one run; ".to_owned(),
        Some(runs) => format!("time: median of {runs} runs; "),
    };
    let star = if styled { "" } else { "; * best" };
    format!(
        "{times}papers' count: 80 bytes per window; measured: heap of the algorithm without the mesh; \
         MB = 10^6 bytes{star}\n"
    )
}
