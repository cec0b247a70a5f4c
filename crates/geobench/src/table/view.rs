//! What every table shows: per model the rows of the papers' tables, a column per algorithm.

use super::figures::{Figure, Style, figures};
use super::grid::Entry;
use super::ratios;
use crate::measure::number::{decimals, group, grouped, scientific};
use crate::measure::statistics::median;
use crate::schema::{Cell, GroupRecord, ModelRecord, ResultFile, Status};

/// The tables of one group.
pub(crate) struct Section<'r> {
    /// The group, if it has a name or a text.
    pub(crate) group: Option<&'r GroupRecord>,
    /// All algorithms of the group, in the order in which they first appear.
    pub(crate) algorithms: Vec<&'r str>,
    /// One for each model, and one for ratios if they are asked for.
    pub(crate) views: Vec<ModelView<'r>>,
}

/// The part of a table that belongs to one model.
pub(crate) struct ModelView<'r> {
    /// The model.
    pub(crate) name: String,
    /// Number of vertices and faces.
    pub(crate) size: String,
    /// What the sources are, in words.
    pub(crate) sources: String,
    /// Names of the algorithms.
    pub(crate) algorithms: Vec<&'r str>,
    pub(crate) rows: Vec<Row>,
    /// Whether there is no figure because the model or its sources cannot be used.
    pub(crate) refused: bool,
    /// What else a reader must know about these figures.
    pub(crate) notes: Vec<String>,
}

/// A row of a table.
pub(crate) struct Row {
    pub(crate) label: String,
    /// One entry for each algorithm.
    pub(crate) entries: Vec<Entry>,
}

/// The names of all algorithms in `result`, in the order in which they first appear.
pub(crate) fn algorithms<'r>(cells: impl IntoIterator<Item = &'r Cell>) -> Vec<&'r str> {
    let mut names: Vec<&str> = Vec::new();
    for cell in cells {
        if !names.contains(&cell.algorithm.as_str()) {
            names.push(&cell.algorithm);
        }
    }
    names
}

/// The sections of all groups, in the order of the run.
pub(crate) fn sections(result: &ResultFile) -> Vec<Section<'_>> {
    static ALONE: GroupRecord = GroupRecord::unnamed();
    let groups = if result.groups.is_empty() {
        std::slice::from_ref(&ALONE)
    } else {
        &result.groups
    };
    groups.iter().map(|g| Section::new(g, result)).collect()
}

impl<'r> Section<'r> {
    fn new(group: &'r GroupRecord, result: &'r ResultFile) -> Self {
        let cells: Vec<&Cell> = result
            .cells
            .iter()
            .filter(|c| c.group == group.name)
            .collect();
        let models = result
            .models
            .iter()
            .filter(|m| cells.iter().any(|c| c.model == m.name));
        let views = models.map(|model| ModelView::new(group, model, cells.iter().copied()));
        Self {
            group: Some(group).filter(|g| g.name.is_some() || g.shows.is_some()),
            views: views.chain(ratios::view(group, &cells)).collect(),
            algorithms: algorithms(cells),
        }
    }
}

impl<'r> ModelView<'r> {
    /// The part of `model` in the table of `group`, to which some of `cells` belong.
    pub(crate) fn new(
        group: &GroupRecord,
        model: &ModelRecord,
        cells: impl IntoIterator<Item = &'r Cell>,
    ) -> Self {
        let cells: Vec<&Cell> = cells
            .into_iter()
            .filter(|c| c.model == model.name)
            .collect();
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
        let mut rows: Vec<Row> = figures(&group.rows)
            .into_iter()
            .map(|figure| Row::new(figure, &columns, model.vertices))
            .collect();
        let mut notes = notes(&cells, model.vertices);
        if let Some((row, note)) = ratios::times(group, &algorithms, &columns) {
            rows.push(row);
            notes.extend(note);
        }
        let refused = cells.iter().all(|cell| cell.status == Status::Refused);
        if refused {
            // Four times the same word says no more than once.
            rows.truncate(1);
            for row in &mut rows {
                row.label.clear();
            }
        }
        Self {
            name: model.name.clone(),
            size: match (model.vertices, model.faces) {
                (Some(v), Some(f)) => format!("V: {}, F: {}", grouped(v), grouped(f)),
                _ => "refused".to_owned(),
            },
            sources: sources(columns.first().map_or(&[], Vec::as_slice)),
            rows,
            notes,
            algorithms,
            refused,
        }
    }
}

impl ModelView<'_> {
    /// The entry of an algorithm in a row, if the view has that algorithm.
    pub(crate) fn entry<'s>(&self, row: &'s Row, algorithm: &str) -> Option<&'s Entry> {
        let place = self.algorithms.iter().position(|name| *name == algorithm)?;
        row.entries.get(place)
    }
}

/// The figure of the cells of all sources in a model of so many vertices: the median, and none if one
/// has failed.
pub(crate) fn overall(figure: &Figure, cells: &[&Cell], vertices: Option<u64>) -> Option<f64> {
    let values: Option<Vec<f64>> = cells
        .iter()
        .map(|cell| {
            figure
                .of(cell, vertices)
                .filter(|_| cell.status == Status::Ok)
        })
        .collect();
    median(&values?)
}

impl Row {
    /// The row of a figure; a column holds one cell for each source.
    fn new(figure: &Figure, columns: &[Vec<&Cell>], vertices: Option<u64>) -> Self {
        let found = columns.iter().map(|cells| overall(figure, cells, vertices));
        let values: Vec<Option<f64>> = found.collect();
        let present = || values.iter().copied().flatten();
        let best = present().fold(f64::INFINITY, f64::min);
        let all_equal = present().all(|v| v == best);
        let digits = match figure.style {
            Style::Decimals(most) => decimals(present(), most),
            Style::Count | Style::Scientific => 0,
        };
        let entries = columns
            .iter()
            .zip(&values)
            .map(|(cells, value)| match value {
                Some(value) => Entry {
                    text: match figure.style {
                        Style::Count => group(&format!("{value:.0}")),
                        Style::Decimals(_) => format!("{value:.digits$}"),
                        Style::Scientific => scientific(*value),
                    },
                    best: figure.less_is_better && *value == best && !all_equal,
                    failed: false,
                },
                None => Entry::absent(cells),
            })
            .collect();
        Self {
            label: figure.label.clone(),
            entries,
        }
    }
}

impl Entry {
    /// What stands in the place of a figure that `cells` do not have.
    fn absent(cells: &[&Cell]) -> Self {
        let failed = cells.iter().find(|cell| cell.status != Status::Ok);
        Self {
            text: failed.map_or_else(|| "-".to_owned(), |cell| cell.status.in_words()),
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

/// With which vector instructions the instructions were counted, where not all are the same.
fn note_on_instructions(cells: &[&Cell]) -> Option<String> {
    let mut counted: Vec<(&str, Vec<&str>)> = Vec::new();
    for cell in cells {
        let Some(simd) = cell.instructions_simd.as_deref() else {
            continue;
        };
        let place = counted.iter().position(|(known, _)| *known == simd);
        let place = place.unwrap_or_else(|| {
            counted.push((simd, Vec::new()));
            counted.len() - 1
        });
        let names = &mut counted[place].1;
        if !names.contains(&cell.algorithm.as_str()) {
            names.push(&cell.algorithm);
        }
    }
    (counted.len() > 1).then(|| {
        let kinds = counted.iter();
        let kinds: Vec<String> = kinds
            .map(|(simd, names)| format!("with {simd}: {}", names.join(", ")))
            .collect();
        format!("instructions are counted {}", kinds.join("; "))
    })
}

/// How far the medians of the times can be trusted, and which samples lie far from the others.
fn notes_on_times(cells: &[&Cell]) -> Vec<String> {
    let timed = || cells.iter().filter(|c| !c.time.samples.is_empty());
    let widest = timed().map(|cell| {
        let [low, high] = cell.time.ci95?;
        let median = cell.time.median?;
        Some((high - median).max(median - low) / median)
    });
    let widest: Option<Vec<f64>> = widest.collect();
    let mut notes: Vec<String> = match widest.as_deref() {
        Some([]) => Vec::new(),
        Some(widths) => {
            let widest = 100.0 * widths.iter().copied().fold(0.0, f64::max);
            vec![format!(
                "times: 95 % intervals within {widest:.1} % of the medians"
            )]
        }
        None => timed()
            .filter_map(|cell| cell.time.note.as_ref())
            .take(1)
            .map(|note| format!("times: {note}"))
            .collect(),
    };
    for name in algorithms(cells.iter().copied()) {
        let of = || timed().filter(|c| c.algorithm == name);
        let far: usize = of().filter_map(|c| c.time.outliers).sum();
        if far > 0 {
            let all: usize = of().map(|c| c.time.samples.len()).sum();
            notes.push(format!("{name}: {far} of {all} times far from the others"));
        }
    }
    notes
}

/// What the checks said, and every failure, of a model of so many vertices.
fn notes(cells: &[&Cell], vertices: Option<u64>) -> Vec<String> {
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
        let compared = others.iter().filter_map(|c| c.check.compared).min();
        let sample = match (compared, vertices) {
            (Some(some), Some(all)) if some < all => {
                format!(" at {} of {} vertices", grouped(some), grouped(all))
            }
            _ => String::new(),
        };
        notes.push(format!(
            "checked against {reference}{sample}: largest relative difference {}",
            scientific(largest)
        ));
    }
    notes.extend(notes_on_times(cells));
    notes.extend(note_on_instructions(cells));
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
                status => &format!("{}: ", status.in_words()),
            };
            notes.push(format!("{}{source}: {status}{message}", cell.algorithm));
        }
    }
    notes
}
