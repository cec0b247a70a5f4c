//! What every table shows: per model the rows of the papers' tables, a column per algorithm.

use super::number::{decimals, group, grouped, scientific};
use crate::record::{Cell, ModelRecord, ResultFile, Status};
use crate::statistics::median;

/// The part of a table that belongs to one model.
pub(super) struct ModelView<'r> {
    pub(super) model: &'r ModelRecord,
    /// What the sources are, in words.
    pub(super) sources: String,
    /// Names of the algorithms.
    pub(super) algorithms: Vec<&'r str>,
    pub(super) rows: Vec<Row>,
    /// Whether there is no figure because the model or its sources cannot be used.
    pub(super) refused: bool,
    /// What else a reader must know about these figures.
    pub(super) notes: Vec<String>,
}

/// A row of a table.
pub(super) struct Row {
    pub(super) label: &'static str,
    /// One entry for each algorithm.
    pub(super) entries: Vec<Entry>,
}

/// A figure in a table, or what stands in its place.
pub(super) struct Entry {
    pub(super) text: String,
    /// Whether it is the smallest of its row.
    pub(super) best: bool,
    /// Whether it says that something failed.
    pub(super) failed: bool,
}

/// A figure of a cell.
struct Figure {
    label: &'static str,
    of: fn(&Cell) -> Option<f64>,
    /// Most decimals with which it is shown; none if it counts something.
    decimals: Option<u8>,
}

const MEGABYTE: f64 = 1e6;

/// The rows of every table.
const FIGURES: [Figure; 4] = [
    Figure {
        label: "Time (s)",
        of: |cell| cell.time.median,
        decimals: Some(6),
    },
    Figure {
        label: "Window propagations",
        of: |cell| {
            cell.counters
                .get(geobench_window::Counter::Propagated)
                .map(|n| n as f64)
        },
        decimals: None,
    },
    Figure {
        label: "Peak memory, papers' count (MB)",
        of: |cell| cell.memory.papers_bytes.map(|n| n as f64 / MEGABYTE),
        decimals: Some(3),
    },
    Figure {
        label: "Peak memory, measured (MB)",
        of: |cell| cell.memory.heap_peak_bytes.map(|n| n as f64 / MEGABYTE),
        decimals: Some(3),
    },
];

/// The names of all algorithms in `result`, in the order in which they first appear.
pub(super) fn algorithms<'r>(cells: impl IntoIterator<Item = &'r Cell>) -> Vec<&'r str> {
    let mut names: Vec<&str> = Vec::new();
    for cell in cells {
        if !names.contains(&cell.algorithm.as_str()) {
            names.push(&cell.algorithm);
        }
    }
    names
}

/// The parts of all models.
pub(super) fn views(result: &ResultFile) -> Vec<ModelView<'_>> {
    result
        .models
        .iter()
        .map(|model| ModelView::new(model, &result.cells))
        .collect()
}

impl<'r> ModelView<'r> {
    /// The part of `model`, to which some of `cells` belong.
    pub(super) fn new(model: &'r ModelRecord, cells: &'r [Cell]) -> Self {
        let cells: Vec<&Cell> = cells.iter().filter(|c| c.model == model.name).collect();
        let algorithms = algorithms(cells.iter().copied());
        let columns: Vec<Vec<&Cell>> = algorithms
            .iter()
            .map(|name| {
                cells
                    .iter()
                    .copied()
                    .filter(|c| c.algorithm == *name)
                    .collect()
            })
            .collect();
        let mut rows: Vec<Row> = FIGURES.iter().map(|figure| figure.row(&columns)).collect();
        let refused = cells.iter().all(|cell| cell.status == Status::Refused);
        if refused {
            // Four times the same word says no more than once.
            rows.truncate(1);
            rows[0].label = "";
        }
        Self {
            model,
            sources: sources(columns.first().map_or(&[], Vec::as_slice)),
            rows,
            notes: notes(&cells),
            algorithms,
            refused,
        }
    }

    /// Number of vertices and faces.
    pub(super) fn size(&self) -> String {
        match (self.model.vertices, self.model.faces) {
            (Some(v), Some(f)) => format!("V: {}, F: {}", grouped(v), grouped(f)),
            _ => "refused".to_owned(),
        }
    }
}

impl Figure {
    /// The row of this figure; a column holds one cell for each source.
    fn row(&self, columns: &[Vec<&Cell>]) -> Row {
        // The figure of several sources is the median, and there is none if one has failed.
        let values: Vec<Option<f64>> = columns
            .iter()
            .map(|cells| {
                let values: Option<Vec<f64>> = cells
                    .iter()
                    .map(|cell| (self.of)(cell).filter(|_| cell.status == Status::Ok))
                    .collect();
                median(&values?)
            })
            .collect();
        let present = || values.iter().copied().flatten();
        let best = present().fold(f64::INFINITY, f64::min);
        let all_equal = present().all(|v| v == best);
        let digits = self.decimals.map(|most| decimals(present(), most));
        let entries = columns
            .iter()
            .zip(&values)
            .map(|(cells, value)| match value {
                Some(value) => Entry {
                    text: match digits {
                        Some(digits) => format!("{value:.digits$}"),
                        None => group(&format!("{value:.0}")),
                    },
                    best: *value == best && !all_equal,
                    failed: false,
                },
                None => Entry::absent(cells),
            })
            .collect();
        Row {
            label: self.label,
            entries,
        }
    }
}

impl Entry {
    /// What stands in the place of a figure that `cells` do not have.
    fn absent(cells: &[&Cell]) -> Self {
        let failed = cells.iter().find(|cell| cell.status != Status::Ok);
        Self {
            text: failed
                .map_or("-", |cell| cell.status.name())
                .replace('_', " "),
            best: false,
            failed: failed.is_some(),
        }
    }
}

fn sources(cells: &[&Cell]) -> String {
    match cells {
        [cell] => match cell.source {
            Some(source) => format!("source {source}"),
            None => "one source".to_owned(),
        },
        cells => format!("median of {} sources", cells.len()),
    }
}

/// What the checks said, and every failure.
fn notes(cells: &[&Cell]) -> Vec<String> {
    let mut notes = Vec::new();
    let mut references: Vec<&str> = Vec::new();
    for cell in cells {
        if let Some(reference) = &cell.check.reference
            && !references.contains(&reference.as_str())
        {
            references.push(reference);
        }
    }
    for reference in references {
        let others: Vec<&&Cell> = cells
            .iter()
            .filter(|c| c.status == Status::Ok && c.check.reference.as_deref() == Some(reference))
            .filter(|c| c.algorithm != reference)
            .collect();
        if others.is_empty() {
            if cells.iter().all(|cell| cell.algorithm == reference) {
                notes.push(format!("not checked: {reference} is its own reference"));
            }
            continue;
        }
        let largest = others
            .iter()
            .filter_map(|c| c.check.max_rel)
            .fold(0.0, f64::max);
        notes.push(format!(
            "checked against {reference}: largest relative difference {}",
            scientific(largest)
        ));
    }
    let unreachable = cells.iter().filter_map(|c| c.check.unreachable).max();
    if let Some(unreachable @ 1..) = unreachable {
        notes.push(format!("unreachable vertices: {}", grouped(unreachable)));
    }
    let mut seen: Vec<&str> = Vec::new();
    for cell in cells {
        let Some(message) = &cell.message else {
            continue;
        };
        if cell.status == Status::Refused {
            // The same for every algorithm.
            if !seen.contains(&message.as_str()) {
                notes.push(format!("refused: {message}"));
                seen.push(message);
            }
        } else {
            let source = cell
                .source
                .map_or_else(String::new, |s| format!(", source {s}"));
            let status = match cell.status {
                Status::Ok => "",
                status => &format!("{}: ", status.name().replace('_', " ")),
            };
            notes.push(format!("{}{source}: {status}{message}", cell.algorithm));
        }
    }
    notes
}
