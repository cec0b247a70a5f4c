//! Writes results as tables and files, and defines the file formats.

use geobench_export::escape::markdown_line;
use geobench_export::{FileFormat, json_lines};
use geobench_harness::schema::{Cell, GroupRecord, ModelRecord, ResultFile};

use self::group::GroupCells;

mod bars;
mod comparison;
pub(crate) mod csv;
mod exports;
pub(crate) mod group;
mod history;
pub(crate) mod html;
pub(crate) mod latex;
pub(crate) mod markdown;
pub(crate) mod matrix;
mod model;
pub(crate) mod results;
pub mod terminal;
#[cfg(test)]
pub(crate) mod tests;

pub use bars::model_bars;
pub use comparison::ComparisonFormat;
pub(crate) use history::table_of_changes;
pub use history::{change_points, gate, gate_in_markdown};
pub use model::{Column, Entry, Mark, Note, Part, Table};
pub use terminal::Look;

/// An output format of results.
#[derive(Default, Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum ResultFormat {
    /// A table per model for the terminal.
    #[default]
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

impl FileFormat for ResultFormat {
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

impl ResultFormat {
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
            Self::Markdown => joined(result, markdown::table) + &programs(result),
            Self::Latex => latex::NEEDS.to_owned() + &joined(result, latex::table),
            Self::Csv => csv::table(&csv::results(result)?)?,
            Self::Samples => csv::table(&csv::samples(result)?)?,
            Self::Json => json_lines(result)?,
            Self::Bencher => json_lines(&exports::bencher(result))?,
            Self::GithubAction => json_lines(&exports::github_action(result))?,
        })
    }
}

/// The tables of all groups, with a note in every part if times are disturbed. The matrix of a
/// group of several models follows its table.
fn tables(result: &ResultFile) -> Vec<Table> {
    let note = disturbance(result).map(|text| Note {
        text: format!("the times are disturbed: {text}"),
        failure: false,
    });
    let of_group = |group: &GroupCells<'_>| {
        let mut table = results::table(group);
        for part in &mut table.parts {
            part.notes.extend(note.clone());
        }
        let matrix = matrix::matrix(group).filter(|_| group.models.len() > 1);
        std::iter::once(table).chain(matrix)
    };
    let groups = results::groups(result);
    groups.iter().flat_map(of_group).collect()
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

/// A list of the outside programs in Markdown, after an empty line; empty without any.
fn programs(result: &ResultFile) -> String {
    let programs = result.programs().into_iter().map(|program| {
        let line = format!("Program {}: {}", program.name, program.in_words());
        format!("\n- {}", markdown_line(&line))
    });
    let lines: String = programs.collect();
    if lines.is_empty() {
        lines
    } else {
        lines + "\n"
    }
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

/// The matrix of a group of several models, for the terminal; empty if there is none.
pub fn matrix_table(group: &GroupRecord, result: &ResultFile, look: Look) -> String {
    let group = GroupCells::new(group, &result.models, &result.cells);
    let matrix = matrix::matrix(&group).filter(|_| group.models.len() > 1);
    matrix.map_or_else(String::new, |matrix| terminal::table(&matrix, look))
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
