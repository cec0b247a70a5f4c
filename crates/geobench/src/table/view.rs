//! What every table shows: per model the rows of the papers' tables, a column per algorithm.

use super::figures::{Figure, Style, figures};
use super::grid::Entry;
use crate::measure::number::{decimals, group, grouped, scientific};
use crate::measure::statistics::{FEWEST_FOR_INTERVAL, Ratio, median, paired_ratio};
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
            views: views.chain(ratio_view(group, &cells)).collect(),
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
        if let Some((row, note)) = ratio_times(group, &algorithms, &columns) {
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

/// The figure of the cells of all sources in a model of so many vertices: the median, and none if
/// one has failed.
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
    let doubt = cells.iter().filter_map(|c| c.check.doubt);
    if let Some(doubt) = doubt.max_by(f64::total_cmp) {
        notes.push(format!(
            "edges are too long for these distances, each of which may be off by up to {}; \
             `geobench distance` names the faces",
            scientific(doubt)
        ));
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

/// For each figure of which less is better, the mean and the standard deviation of the ratio to
/// the algorithm that the group names; none if it names none or nothing can be compared.
pub(super) fn ratio_view<'r>(group: &GroupRecord, cells: &[&'r Cell]) -> Option<ModelView<'r>> {
    let baseline = group.ratios_to.as_deref()?;
    let algorithms: Vec<&str> = algorithms(cells.iter().copied())
        .into_iter()
        .filter(|name| *name != baseline)
        .collect();
    let rows: Vec<Row> = figures(&group.rows)
        .into_iter()
        .filter(|figure| figure.less_is_better)
        .map(|figure| row(figure, baseline, &algorithms, cells))
        .collect();
    let compared = rows.iter().flat_map(|r| &r.entries).any(|e| e.text != "-");
    compared.then(|| ModelView {
        name: format!("ratios to {baseline}"),
        size: format!(
            "mean / standard deviation over {} models",
            models(cells).len()
        ),
        sources: String::new(),
        algorithms,
        rows,
        refused: false,
        notes: Vec::new(),
    })
}

/// The algorithm to which ratios are taken: the one that the group names, else `vtp`, else the
/// reference of the checks of `cells`, else the first. None if there is nothing to compare it with.
pub(crate) fn base<'r>(
    group: &'r GroupRecord,
    algorithms: &[&'r str],
    cells: &[&'r Cell],
) -> Option<&'r str> {
    let ran = |name: &&str| algorithms.contains(name);
    let reference = cells.iter().find_map(|c| c.check.reference.as_deref());
    let base = group
        .ratios_to
        .as_deref()
        .filter(ran)
        .or_else(|| Some("vtp").filter(ran))
        .or_else(|| reference.filter(ran))
        .or_else(|| algorithms.first().copied())?;
    (algorithms.len() > 1).then_some(base)
}

fn models<'r>(cells: &[&'r Cell]) -> Vec<&'r str> {
    let mut models: Vec<&str> = Vec::new();
    for cell in cells {
        if !models.contains(&cell.model.as_str()) {
            models.push(&cell.model);
        }
    }
    models
}

/// The row of a model's table with the ratios of the times to those of the algorithm that the group
/// names, and what a reader must know of it; a column holds the cells of an algorithm. None if the
/// group names none, or nothing can be compared.
pub(super) fn ratio_times(
    group: &GroupRecord,
    algorithms: &[&str],
    columns: &[Vec<&Cell>],
) -> Option<(Row, Option<String>)> {
    let baseline = group.ratios_to.as_deref()?;
    let under = &columns[algorithms.iter().position(|name| *name == baseline)?];
    let ratios: Vec<Option<Ratio>> = columns
        .iter()
        .zip(algorithms)
        .map(|(over, name)| paired(over, under).filter(|_| *name != baseline))
        .collect();
    let known = || ratios.iter().flatten();
    known().next()?;
    let without = known().any(|ratio| ratio.ci95.is_none());
    let entry = |ratio: &Option<Ratio>| {
        Entry::plain(match ratio {
            Some(Ratio {
                ratio,
                ci95: Some([low, high]),
            }) => format!("{ratio:.2} [{low:.2}, {high:.2}]"),
            Some(Ratio { ratio, ci95: None }) => format!("{ratio:.2}"),
            None => "-".to_owned(),
        })
    };
    let interval = if without { "" } else { " [95 %]" };
    let row = Row {
        label: format!("Time / that of {baseline}{interval}"),
        entries: ratios.iter().map(entry).collect(),
    };
    let note = without.then(|| {
        format!("ratios of times: no interval from fewer than {FEWEST_FOR_INTERVAL} pairs")
    });
    Some((row, note))
}

/// The ratio of the times of the cells `over` to those of `under`, pairs of all sources together;
/// none unless both ended well from the same sources.
fn paired(over: &[&Cell], under: &[&Cell]) -> Option<Ratio> {
    let (mut above, mut below) = (Vec::new(), Vec::new());
    if over.len() != under.len() {
        return None;
    }
    for over in over {
        let under = under.iter().find(|c| c.source == over.source)?;
        if over.time.samples.len() != under.time.samples.len() {
            return None;
        }
        above.extend_from_slice(&over.time.samples);
        below.extend_from_slice(&under.time.samples);
    }
    paired_ratio(&above, &below)
}

fn row(figure: &Figure, baseline: &str, algorithms: &[&str], cells: &[&Cell]) -> Row {
    let of = |model: &str, algorithm: &str| -> Vec<&Cell> {
        let cells = cells.iter().copied();
        cells
            .filter(|c| c.model == model && c.algorithm == algorithm)
            .collect()
    };
    let ratio = |model: &str, algorithm: &str| {
        let (over, under) = (of(model, algorithm), of(model, baseline));
        if figure.key == "time" {
            Some(paired(&over, &under)?.ratio)
        } else {
            // A figure that takes the model as well is not one to be compared.
            Some(overall(figure, &over, None)? / overall(figure, &under, None)?)
        }
    };
    let entry = |algorithm: &&str| {
        let ratios: Vec<f64> = models(cells)
            .into_iter()
            .filter_map(|model| ratio(model, algorithm))
            .filter(|ratio| ratio.is_finite())
            .collect();
        let n = ratios.len() as f64;
        let mean = ratios.iter().sum::<f64>() / n;
        let squares: f64 = ratios.iter().map(|r| (r - mean).powi(2)).sum();
        Entry {
            text: match ratios.len() {
                0 => "-".to_owned(),
                1 => format!("{mean:.2} / -"),
                _ => format!("{mean:.2} / {:.2}", (squares / (n - 1.0)).sqrt()),
            },
            best: false,
            failed: false,
        }
    };
    Row {
        label: figure.label.clone(),
        entries: algorithms.iter().map(entry).collect(),
    }
}
