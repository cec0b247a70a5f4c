//! `geobench algos`.

use comfy_table::{Table, presets};
use serde::Serialize;

use super::Verdict;
use super::args::{AlgosFormat, AlgosOptions};
use super::terminal::{self, Terminal};
use crate::registry::{Algorithm, algorithms};

/// An algorithm as programs read it.
#[derive(Serialize)]
struct Entry {
    name: &'static str,
    family: &'static str,
    exact: bool,
    paper: &'static str,
    summary: &'static str,
    complexity: &'static str,
}

pub(super) fn algos(options: &AlgosOptions, terminal: Terminal) -> anyhow::Result<Verdict> {
    let text = match options.format {
        AlgosFormat::Table => table(terminal),
        AlgosFormat::Json => {
            let entries: Vec<Entry> = algorithms().iter().map(Entry::from).collect();
            serde_json::to_string_pretty(&entries)? + "\n"
        }
    };
    terminal::print(&text)?;
    Ok(Verdict::Passed)
}

impl From<&Algorithm> for Entry {
    fn from(algorithm: &Algorithm) -> Self {
        Self {
            name: algorithm.name,
            family: algorithm.family,
            exact: algorithm.exact,
            paper: algorithm.paper,
            summary: algorithm.summary,
            complexity: algorithm.complexity,
        }
    }
}

fn table(terminal: Terminal) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING);
    if !terminal.styled {
        table.force_no_tty();
    }
    table.set_header(["name", "family", "exact", "paper"]);
    for algorithm in algorithms() {
        table.add_row([
            algorithm.name,
            algorithm.family,
            if algorithm.exact { "yes" } else { "no" },
            algorithm.paper,
        ]);
        table.add_row(["", "", "", &format!("  {}", algorithm.summary)]);
        table.add_row(["", "", "", &format!("  {}", algorithm.complexity)]);
    }
    table.trim_fmt() + "\n"
}
