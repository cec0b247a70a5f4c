//! Results as people and programs read them.

use std::path::Path;

use self::escape::printable;
use self::grid::{Entry, Grid};
use self::view::{ModelView, Row, sections};
use crate::schema::{Cell, GroupRecord, ModelRecord, ResultFile};

mod bars;
mod comparison;
mod csv;
pub mod distance_formats;
pub(crate) mod escape;
pub(crate) mod figures;
mod grid;
pub(crate) mod latex;
mod markdown;
pub mod output;
#[cfg(test)]
mod tests;
pub(crate) mod view;

pub use bars::model_bars;
pub use comparison::ComparisonFormat;
pub use csv::header as csv_header;
pub use figures::{Figure, UnknownFigure, figure};
pub use grid::Look;
pub(crate) use view::base;

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
            Self::Table => terminal(result),
            Self::Markdown => markdown::render(result),
            Self::Latex => latex::render(result),
            Self::Csv => csv::render(result)?,
            Self::Json => serde_json::to_string_pretty(result)? + "\n",
        })
    }
}

/// What stands above the tables of a group: its name and what it is to show. Nothing for a group
/// that has neither.
pub fn group_heading(group: &GroupRecord) -> String {
    let parts = [group.name.as_deref(), group.shows.as_deref()];
    let texts = parts.into_iter().flatten();
    let lines: Vec<_> = texts
        .flat_map(|text| text.trim().lines().map(printable))
        .collect();
    if lines.is_empty() {
        String::new()
    } else {
        lines.join("\n") + "\n\n"
    }
}

/// The table of one model of a group, under a line that says which, followed by an empty line.
pub fn model_table(group: &GroupRecord, model: &ModelRecord, cells: &[Cell], look: Look) -> String {
    show(&ModelView::new(group, model, cells), look)
}

/// The table of the ratios in a group, if it asks for some; `cells` are all of the group.
pub fn ratio_table(group: &GroupRecord, cells: &[Cell], look: Look) -> String {
    let cells: Vec<&Cell> = cells.iter().filter(|c| c.group == group.name).collect();
    view::ratio_view(group, &cells).map_or_else(String::new, |view| show(&view, look))
}

/// All tables of `result`.
fn terminal(result: &ResultFile) -> String {
    let mut text = String::new();
    for section in sections(result) {
        text.extend(section.group.map(group_heading));
        text.extend(section.views.iter().map(|view| show(view, Look::default())));
    }
    text + &footnote(result, false)
}

fn show(view: &ModelView<'_>, look: Look) -> String {
    let mut lines = vec![format!("{}  ({})", printable(&view.name), view.size)];
    if !view.refused {
        if !view.sources.is_empty() {
            lines[0] += "  ";
            lines[0] += &view.sources;
        }
        lines.push(table(view, look));
    }
    lines.extend(
        view.notes
            .iter()
            .map(|note| format!("  {}", printable(note))),
    );
    lines.join("\n") + "\n\n"
}

fn table(view: &ModelView<'_>, look: Look) -> String {
    let header = std::iter::once("").chain(view.algorithms.iter().copied());
    let row = |row: &Row| {
        let label = Entry::plain(row.label.clone());
        std::iter::once(label)
            .chain(row.entries.iter().cloned())
            .collect()
    };
    let grid = Grid {
        texts: 1,
        header: header.map(str::to_owned).collect(),
        rows: view.rows.iter().map(row).collect(),
    };
    grid.terminal(look)
}

/// What the figures of the tables of `result` mean, in one line.
pub fn footnote(result: &ResultFile, styled: bool) -> String {
    let runs = result.cells.iter().map(|c| c.time.samples.len()).max();
    let times = match runs {
        // There is no figure at all.
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
