//! Writes results as tables and files, and defines the file formats.

use std::fmt::Display;
use std::path::Path;
use std::sync::OnceLock;

use self::group::GroupCells;
use self::output::OutputFile;
use crate::UsageError;
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
pub use figures::{Figure, figure};
pub(crate) use history::table_of_changes;
pub use history::{change_points, gate};
pub(crate) use model::{Column, Entry, Mark, Note, Part, Table};
pub use terminal::Look;

/// An output format of results.
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

impl FileFormat for Format {
    const CONTENT: &'static str = "results";
    const ENDINGS: &'static [(&'static str, Self)] = &[
        ("json", Self::Json),
        ("csv", Self::Csv),
        ("md", Self::Markdown),
        ("tex", Self::Latex),
        ("bmf.json", Self::Bencher),
        ("gab.json", Self::GithubAction),
    ];
}

/// The path that stands for standard input and output.
pub(crate) const STANDARD: &str = "-";

/// The format of output to `-`, by its file name extension. Set once, from the command line.
static STANDARD_OUTPUT_FORM: OnceLock<String> = OnceLock::new();

/// Sets the format of output to `-`. `ending` is a file name extension.
pub(crate) fn set_standard_output_form(ending: &str) {
    // The command line is parsed only once, so this cannot fail.
    let _ = STANDARD_OUTPUT_FORM.set(ending.trim_start_matches('.').to_lowercase());
}

/// The extension of a file name, without its dot. For `-`, the extension set for standard output.
pub(crate) fn ending_of(path: &Path) -> String {
    if path == Path::new(STANDARD) {
        return STANDARD_OUTPUT_FORM.get().cloned().unwrap_or_default();
    }
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    let stem = path.file_stem().map(Path::new);
    match stem.and_then(Path::extension) {
        // `bmf.json` and `gab.json` are extensions of two words.
        Some(before)
            if before.eq_ignore_ascii_case("bmf") || before.eq_ignore_ascii_case("gab") =>
        {
            format!("{}.{ending}", before.to_string_lossy())
        }
        _ => ending.into_owned(),
    }
}

/// A file format that is recognised by the extension of the file name.
pub(crate) trait FileFormat: Copy + PartialEq + 'static {
    /// The contents of the files, for messages.
    const CONTENT: &'static str;
    /// At least two extensions, with their formats.
    const ENDINGS: &'static [(&'static str, Self)];

    /// The format for the extension of `path`, in any letter case.
    fn of_path(path: &Path) -> Result<Self, UsageError> {
        let ending = ending_of(path);
        let mut forms = Self::ENDINGS.iter();
        if let Some((_, form)) = forms.find(|(name, _)| ending.eq_ignore_ascii_case(name)) {
            return Ok(*form);
        }
        let how = if path == Path::new(STANDARD) {
            "--output-format"
        } else {
            "the ending"
        };
        let names = Self::ENDINGS.iter().map(|(name, _)| format!(".{name}"));
        let names = names.collect::<Vec<_>>().join(", ");
        let (names, last) = names.rsplit_once(", ").unwrap_or_default();
        Err(UsageError(format!(
            "{}: {how} says in which form to write {}; use {names} or {last}",
            path.display(),
            Self::CONTENT
        )))
    }

    /// The format for `path`, and the file, after a check that it can be written.
    fn output(path: &Path) -> anyhow::Result<(Self, OutputFile)> {
        Ok((Self::of_path(path)?, OutputFile::prepare(path)?))
    }

    /// Whether it is a picture, which `report` draws.
    fn is_picture(self) -> bool {
        let mut forms = Self::ENDINGS.iter();
        forms.any(|(ending, form)| *form == self && matches!(*ending, "svg" | "png"))
    }
}

/// The error for a mesh without positions, called `name`.
pub(crate) fn no_coordinates(name: impl Display) -> anyhow::Error {
    anyhow::anyhow!("{name}: the mesh has no coordinates to write")
}

/// `document` as pretty-printed JSON.
pub(crate) fn json_lines(document: &impl serde::Serialize) -> anyhow::Result<String> {
    Ok(serde_json::to_string_pretty(document)? + "\n")
}

/// `document` as one line of JSON.
pub(crate) fn json_line(document: &impl serde::Serialize) -> anyhow::Result<Vec<u8>> {
    let mut bytes = serde_json::to_vec(document)?;
    bytes.push(b'\n');
    Ok(bytes)
}

impl Format {
    /// Results in this format, ending in a line break.
    ///
    /// # Errors
    ///
    /// Only if a number or a text cannot be represented, which does not occur in results.
    pub fn render(self, result: &ResultFile) -> anyhow::Result<String> {
        Ok(match self {
            Self::Table => {
                let table = |table: &Table| terminal::table(table, Look::default());
                tables(result).iter().map(table).collect::<String>()
                    + &footnote(result, Look::default())
            }
            Self::Markdown => joined(result, markdown::table),
            Self::Latex => latex::NEEDS.to_owned() + &joined(result, latex::table),
            Self::Csv => csv::table(&csv::results(result)?)?,
            Self::Samples => csv::table(&csv::samples(result)?)?,
            Self::Json => json_lines(result)?,
            Self::Bencher => json_lines(&exports::bencher(result))?,
            Self::GithubAction => json_lines(&exports::github_action(result))?,
        })
    }
}

/// `text` with a capital first letter.
pub(crate) fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().into_iter().flat_map(char::to_uppercase);
    first.collect::<String>() + letters.as_str()
}

/// A number with its noun: `1 loop`, `2 loops`.
pub(crate) fn counted(count: usize, thing: &str) -> String {
    match count {
        1 => format!("1 {thing}"),
        _ => format!("{count} {thing}s"),
    }
}

/// The tables of all groups, with a note in every part if times are disturbed.
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

/// The reason why times are disturbed, if several cells ran at the same time.
pub fn disturbance(result: &ResultFile) -> Option<String> {
    let jobs = result.jobs()?;
    Some(format!("{jobs} cells ran at the same time"))
}

/// The tables of all groups, written by `write`, with an empty line between them.
fn joined(result: &ResultFile, write: fn(&Table) -> String) -> String {
    let tables: Vec<String> = tables(result).iter().map(write).collect();
    tables.join("\n")
}

/// The heading of the tables of a group: its name and its description. Empty if the group has
/// neither.
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

/// An explanation of the figures in the tables of `result`; empty if no cell has times.
pub fn footnote(result: &ResultFile, look: Look) -> String {
    let runs = result.cells.iter().map(|c| c.time.samples.len());
    let runs: Vec<usize> = runs.filter(|runs| *runs > 0).collect();
    let mut times = match (runs.iter().min(), runs.iter().max()) {
        (Some(1), Some(1)) => "time of one run; ".to_owned(),
        (Some(fewest), Some(most)) if fewest == most => format!("time: median of {most} runs; "),
        (Some(fewest), Some(most)) => format!("time: median of {fewest} to {most} runs; "),
        // Without times, the tables have no figures to explain.
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
