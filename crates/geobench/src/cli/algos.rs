//! `geobench algos`.

use comfy_table::{ContentArrangement, Table, presets};
use geobench_window::{Counter, Counters};
use serde::Serialize;

use super::Verdict;
use super::args::{AlgosFormat, AlgosOptions};
use super::terminal::{self, Terminal};
use crate::registry::{Algorithm, Numbers, Parameter, Value};

pub(super) fn algos(options: &AlgosOptions, terminal: Terminal) -> anyhow::Result<Verdict> {
    // Parameters do not matter here: an algorithm named with several sets of them is shown once.
    let mut chosen: Vec<&Algorithm> = Vec::new();
    for selection in &options.list.0 {
        let algorithm = selection.algorithm();
        if chosen.iter().all(|a| a.name != algorithm.name) {
            chosen.push(algorithm);
        }
    }
    let text = match (options.counters, options.format) {
        (false, AlgosFormat::Table) => facts(&chosen, terminal),
        (false, AlgosFormat::Json) => {
            let entries: Vec<Entry> = chosen.into_iter().map(Entry::from).collect();
            serde_json::to_string_pretty(&entries)? + "\n"
        }
        (true, AlgosFormat::Table) => {
            let mut table = plain_table(terminal);
            for counter in counters() {
                table.add_row([counter.name, counter.definition]);
            }
            table.trim_fmt() + "\n"
        }
        (true, AlgosFormat::Json) => serde_json::to_string_pretty(&counters())? + "\n",
    };
    terminal::print_rendered(&text)?;
    Ok(Verdict::Passed)
}

/// An algorithm in JSON.
#[derive(Serialize)]
struct Entry {
    name: &'static str,
    family: &'static str,
    exact: bool,
    paper: &'static str,
    summary: &'static str,
    complexity: &'static str,
    keeps: &'static str,
    choose: &'static str,
    parameters: Vec<ParameterEntry>,
}

/// A parameter in JSON. The ends of its range are null if it takes words only.
#[derive(Serialize)]
struct ParameterEntry {
    name: &'static str,
    default: serde_json::Value,
    whole: bool,
    min: Option<serde_json::Value>,
    max: Option<serde_json::Value>,
    words: &'static [&'static str],
    meaning: &'static str,
}

/// A counter in JSON.
#[derive(Serialize)]
struct CounterEntry {
    name: &'static str,
    definition: &'static str,
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
            keeps: algorithm.keeps,
            choose: algorithm.choose,
            parameters: algorithm.parameters.iter().map(Into::into).collect(),
        }
    }
}

impl From<&Parameter> for ParameterEntry {
    fn from(parameter: &Parameter) -> Self {
        let (whole, range) = match parameter.allowed.numbers {
            Numbers::None => (false, None),
            Numbers::Integers(least, most) => (true, Some((least.into(), most.into()))),
            Numbers::Reals(least, most) => (false, Some((least.into(), most.into()))),
        };
        let (min, max) = range.unzip();
        Self {
            name: parameter.name,
            default: match parameter.default {
                Value::Integer(n) => n.into(),
                Value::Real(x) => x.into(),
                Value::Word(word) => word.into(),
            },
            whole,
            min,
            max,
            words: parameter.allowed.words,
            meaning: parameter.meaning,
        }
    }
}

/// Every counter of the result file.
fn counters() -> Vec<CounterEntry> {
    let counted = Counter::ALL.iter().map(|c| (c.key(), c.definition()));
    let sampled = (
        Counters::WAVEFRONT_DEVIATION,
        Counters::WAVEFRONT_DEVIATION_DEFINITION,
    );
    counted
        .chain([sampled])
        .map(|(name, definition)| CounterEntry {
            name,
            definition: definition.trim(),
        })
        .collect()
}

/// A block for each algorithm.
fn facts(algorithms: &[&Algorithm], terminal: Terminal) -> String {
    let mut table = plain_table(terminal);
    for (i, algorithm) in algorithms.iter().enumerate() {
        if i > 0 {
            table.add_row(["", ""]);
        }
        let exact = if algorithm.exact {
            "exact"
        } else {
            "approximate"
        };
        table.add_row([algorithm.name, &format!("{exact}, {}", algorithm.family)]);
        for (label, fact) in [
            ("  what", algorithm.summary),
            ("  source", algorithm.paper),
            ("  cost", algorithm.complexity),
            ("  keeps", algorithm.keeps),
            ("  choose it", algorithm.choose),
        ] {
            table.add_row([label, fact]);
        }
        for parameter in algorithm.parameters {
            table.add_row([
                format!("  {{{}}}", parameter.name),
                format!(
                    "{}; {}, default {}",
                    parameter.meaning, parameter.allowed, parameter.default
                ),
            ]);
        }
    }
    table.trim_fmt() + "\n"
}

/// A table without rules, as wide as the terminal.
fn plain_table(terminal: Terminal) -> Table {
    let mut table = Table::new();
    table
        .load_style(presets::NOTHING)
        .set_content_arrangement(ContentArrangement::Dynamic);
    if !terminal.styled {
        table.force_no_tty();
    }
    table
}
