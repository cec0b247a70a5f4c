//! Results as people and programs read them.

mod bars;
mod comparison;
mod csv;
pub mod distance_formats;
pub(crate) mod escape;
pub(crate) mod figures;
mod grid;
mod json;
pub(crate) mod latex;
mod markdown;
pub mod output;
mod ratios;
mod table;
#[cfg(test)]
mod tests;
pub(crate) mod view;

use std::path::Path;

use crate::schema::ResultFile;

pub use bars::{Bar, lines as bar_lines, model_bars};
pub use comparison::ComparisonFormat;
pub use csv::header as csv_header;
pub use figures::{Figure, UnknownFigure, figure};
pub use grid::Look;
pub(crate) use ratios::base;
pub use table::{footnote, group_heading, model_table, ratio_table};

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

/// A path whose ending is not that of a file that can be written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{path}: the ending says in which form to write results; use {endings}")]
pub struct UnknownEnding {
    /// The path.
    pub path: String,
    /// The endings that are understood, in words.
    pub endings: String,
}

/// The form that the ending of `path` stands for, in any letter case.
fn of_ending<F: Copy>(path: &Path, endings: &[(&str, F)]) -> Result<F, UnknownEnding> {
    let ending = path.extension().unwrap_or_default();
    let found = endings
        .iter()
        .find(|(name, _)| ending.eq_ignore_ascii_case(name));
    found.map(|(_, form)| *form).ok_or_else(|| {
        let names: Vec<String> = endings.iter().map(|(name, _)| format!(".{name}")).collect();
        UnknownEnding {
            path: path.display().to_string(),
            endings: match names.split_last() {
                Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
                _ => names.concat(),
            },
        }
    })
}

impl Format {
    /// The form that the ending of `path` asks for, in any letter case.
    ///
    /// # Errors
    ///
    /// When it asks for none.
    pub fn of_path(path: &Path) -> Result<Self, UnknownEnding> {
        of_ending(path, &ENDINGS)
    }

    /// Results in this form, ending in a line break.
    ///
    /// # Errors
    ///
    /// Only if a number or a text cannot be represented, which the records exclude.
    pub fn render(self, result: &ResultFile) -> anyhow::Result<String> {
        Ok(match self {
            Self::Table => table::render(result),
            Self::Markdown => markdown::render(result),
            Self::Latex => latex::render(result),
            Self::Csv => csv::render(result)?,
            Self::Json => json::render(result)?,
        })
    }
}
