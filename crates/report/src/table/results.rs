//! Builds tables of results: for each model, the rows of the papers' tables, with a column for each
//! algorithm.

use std::collections::HashSet;
use std::sync::LazyLock;

use geobench_harness::exec::source::SourceSpec;
use geobench_harness::figures::{Figure, Style, figures, time};
use geobench_harness::measure::number::counted;
use geobench_harness::measure::number::{decimals, group, grouped, scientific};
use geobench_harness::measure::statistics::FEWEST_FOR_INTERVAL;
use geobench_harness::schema::{
    Cell, GroupRecord, LargestComponent, ModelRecord, ResultFile, SourceLabel, Status,
};

use crate::table::group::{Estimate, GroupCells, algorithms, distinct, overall};
use crate::table::model::{Column, Entry, Mark, Note, Part, Table};

/// The groups of `result`, in the order of the run.
pub(crate) fn groups(result: &ResultFile) -> Vec<GroupCells<'_>> {
    static ALONE: LazyLock<GroupRecord> = LazyLock::new(GroupRecord::default);
    let groups = if result.groups.is_empty() {
        std::slice::from_ref(&*ALONE)
    } else {
        &result.groups
    };
    let group = |record| GroupCells::new(record, &result.models, &result.cells);
    groups.iter().map(group).collect()
}

/// The figures of a group: a part for each model, and one for ratios if the group has a base.
pub(crate) fn table(group: &GroupCells<'_>) -> Table {
    let text = |text: &Option<String>| text.as_deref().unwrap_or_default().trim().to_owned();
    let models = group.models.iter().map(|model| part(group, model));
    Table {
        title: text(&group.record.name),
        caption: text(&group.record.shows),
        columns: columns(group),
        titles: Some("Model"),
        parts: models.chain(ratios(group)).collect(),
        ..Table::default()
    }
}

/// A column for the labels of rows, and one for each algorithm.
pub(super) fn columns(group: &GroupCells<'_>) -> Vec<Column> {
    let algorithms = group.algorithms.iter();
    Column::of([""], algorithms.map(|name| group.shown(name)))
}

/// A row with `entries` in the columns of the algorithms.
fn row(label: impl Into<String>, entries: impl Iterator<Item = Entry>) -> Vec<Entry> {
    std::iter::once(Entry::new(label)).chain(entries).collect()
}

/// Inserts the figures called `names` behind the figure `after`, or at the end if that is missing.
/// Figures that are already in `into` are not repeated.
fn insert_after(after: &str, names: &[&str], into: &mut Vec<&'static Figure>) {
    let new = figures(names).into_iter();
    let new: Vec<_> = new
        .filter(|name| into.iter().all(|figure| figure.key != name.key))
        .collect();
    let place = into.iter().position(|figure| figure.key == after);
    let place = place.map_or(into.len(), |place| place + 1);
    into.splice(place..place, new);
}

/// The part of a model, with rows and notes.
pub(super) fn part(group: &GroupCells<'_>, model: &ModelRecord) -> Part {
    let names = group.algorithms.iter();
    let columns: Vec<Vec<&Cell>> = names.map(|name| group.of(&model.name, name)).collect();
    let cells = group.on(&model.name);
    let mut figures = figures(&group.record.rows);
    if cells.iter().any(|cell| cell.approximate) {
        insert_after("time", &["setup", "mean_rel", "max_rel"], &mut figures);
    }
    if cells.iter().any(|cell| !cell.time.outside.is_empty()) {
        insert_after("time", &["outside_time", "claimed_time"], &mut figures);
    }
    let makes_diagrams = |cell: &&Cell| {
        let source = cell.source.as_ref().map(ToString::to_string);
        let several =
            source.is_some_and(|text| text.parse::<SourceSpec>().is_ok_and(|s| s.count() > 1));
        several && cell.time.extraction.is_some()
    };
    if group.record.rows.is_empty() && cells.iter().any(makes_diagrams) {
        insert_after("time", &["extraction"], &mut figures);
        insert_after(
            "propagated",
            &["peak_windows", "stored_windows"],
            &mut figures,
        );
    }
    let shows_setup = figures.iter().any(|figure| figure.key == "setup");
    let mut rows: Vec<_> = figures
        .into_iter()
        .map(|figure| figure_row(figure, &columns, model.vertices))
        .collect();
    let mut notes = notes(cells, model.vertices);
    let has_setup = |cell: &&Cell| cell.algorithm.starts_with("ext:") && cell.time.setup.is_some();
    if shows_setup && cells.iter().any(has_setup) {
        notes.push(Note::new(SETUP_OF_OUTSIDE));
    }
    notes.extend(note_on_component(cells, model));
    notes.extend(group.record.note_on_left_out(model).map(Note::new));
    if let Some((row, note)) = ratio_times(group, &model.name, &columns) {
        rows.push(row);
        notes.extend(note);
    }
    let refused = cells.iter().all(|cell| cell.status == Status::Refused);
    if refused {
        // One row without a label shows the failure, instead of the same text in every row.
        rows.truncate(1);
        for row in &mut rows {
            row[0].text.clear();
        }
    }
    Part {
        title: model.name.clone(),
        detail: match (model.vertices, model.faces) {
            (Some(v), Some(f)) => format!("V: {}, F: {}", grouped(v), grouped(f)),
            _ => cells
                .first()
                .map_or_else(String::new, |cell| cell.status.in_words()),
        },
        sources: if have_same_sources(&columns) {
            sources(columns.iter().find(|column| !column.is_empty()))
        } else {
            "different sources".to_owned()
        },
        refused,
        rows,
        notes,
        is_foot: false,
    }
}

/// Whether all columns that have cells have them from the same sources. Else they do not compare.
fn have_same_sources(columns: &[Vec<&Cell>]) -> bool {
    let mut filled = columns.iter().filter(|column| !column.is_empty());
    let Some(first) = filled.next() else {
        return true;
    };
    let sources = |cells: &[&Cell]| -> HashSet<Option<SourceLabel>> {
        cells.iter().map(|c| c.source.clone()).collect()
    };
    let of_first = sources(first);
    filled.all(|column| sources(column) == of_first)
}

/// The row of a figure; a column holds one cell for each source.
fn figure_row(figure: &Figure, columns: &[Vec<&Cell>], vertices: Option<u64>) -> Vec<Entry> {
    let found = columns.iter().map(|cells| overall(figure, cells, vertices));
    let values: Vec<Option<f64>> = found.collect();
    let present = || values.iter().copied().flatten();
    // Approximate algorithms are not the best at anything, and no claim is the best time. Outside
    // programs may set up within each solve.
    let is_exact = |cells: &[&Cell]| {
        let is_time = figure.key.ends_with("time");
        let is_setup = figure.key == "setup";
        let is_approximate = cells.iter().any(|cell| cell.approximate);
        let is_outside = cells.iter().any(|cell| cell.algorithm.starts_with("ext:"));
        !(is_approximate || is_time && is_claimed(cells) || is_setup && is_outside)
    };
    let exact = || {
        let both = columns.iter().zip(&values);
        both.filter_map(|(cells, value)| value.filter(|_| is_exact(cells)))
    };
    let best = exact().fold(f64::INFINITY, f64::min);
    let has_best = exact().any(|v| v != best) && have_same_sources(columns);
    let digits = match figure.style {
        Style::Decimals(most) => decimals(present(), most),
        Style::Count | Style::Scientific => 0,
    };
    let entries = columns.iter().zip(&values).map(|(cells, value)| {
        let Some(value) = value else {
            return absent(cells);
        };
        let is_best = figure.less_is_better && *value == best && has_best && is_exact(cells);
        let mut text = match figure.style {
            Style::Count => self::group(&format!("{value:.0}")),
            Style::Decimals(_) => format!("{value:.digits$}"),
            Style::Scientific => scientific(*value),
        };
        if figure.key == "time" && cells.iter().any(|cell| cell.time.is_imprecise()) {
            text.insert_str(0, IMPRECISE);
        }
        if figure.key == "claimed_time" && cells.iter().any(|cell| cell.time.doubted) {
            text.push_str(" !");
        }
        Entry::marked(text, if is_best { Mark::Best } else { Mark::None })
    });
    row(&figure.label, entries)
}

/// Whether one of the times is a claim that nothing confirms.
fn is_claimed(cells: &[&Cell]) -> bool {
    cells.iter().any(|cell| cell.time.unconfirmed)
}

/// The note on the set-up of external programs.
const SETUP_OF_OUTSIDE: &str = "set-up of outside programs: as they claim it, and at most the time \
    of the answer; else the time to load the model";

/// The mark of a time whose interval is wider than the wanted precision.
const IMPRECISE: &str = "~";

/// The entry for a figure that `cells` do not have; empty if there are no cells.
fn absent(cells: &[&Cell]) -> Entry {
    match cells.iter().find(|cell| cell.status != Status::Ok) {
        Some(failed) => Entry::marked(failed.status.in_words(), Mark::Failed),
        None if cells.is_empty() => Entry::default(),
        None => Entry::new("-"),
    }
}

/// The goal of the runs of a cell, to follow its source; empty for the distances of all vertices.
fn goal(cell: &Cell) -> String {
    let goal = cell.goal.as_ref();
    goal.map_or_else(String::new, |goal| format!(" {goal}"))
}

/// The sources of an algorithm's cells, in words.
fn sources(cells: Option<&Vec<&Cell>>) -> String {
    match cells.map_or(&[][..], Vec::as_slice) {
        [cell] => {
            let source = match &cell.source {
                Some(source) => format!("source {source}"),
                None => "one source".to_owned(),
            };
            source + &goal(cell)
        }
        cells => {
            let goal = cells.first().map_or_else(String::new, |cell| goal(cell));
            format!("median of {} sources{goal}", cells.len())
        }
    }
}

/// A note on the vector instructions of the timed runs; `None` if they are unknown.
fn note_on_simd(cells: &[&Cell]) -> Option<String> {
    let timed = cells.iter().copied();
    let cells: Vec<&Cell> = timed.filter(|c| !c.time.samples.is_empty()).collect();
    let kinds = distinct(cells.iter().filter_map(|cell| cell.simd.as_deref()));
    let of = |kind: &&str| {
        let cells = cells.iter().copied();
        let with = cells.filter(|cell| cell.simd.as_deref() == Some(kind));
        format!("{kind} for {}", algorithms(with).join(", "))
    };
    match kinds[..] {
        [] => None,
        [one] => Some(format!("instructions: {one}")),
        _ => {
            let kinds: Vec<String> = kinds.iter().map(of).collect();
            Some(format!("instructions: {}", kinds.join("; ")))
        }
    }
}

/// A note on the SIMD levels with which instructions were counted, if they differ between cells.
fn note_on_instructions(cells: &[&Cell]) -> Option<String> {
    fn simd(cell: &Cell) -> Option<&str> {
        cell.instructions_simd.as_deref()
    }
    let kinds = distinct(cells.iter().filter_map(|cell| simd(cell)));
    (kinds.len() > 1).then(|| {
        let counted = kinds.iter().map(|kind| {
            let with = cells
                .iter()
                .copied()
                .filter(|cell| simd(cell) == Some(kind));
            format!("with {kind}: {}", algorithms(with).join(", "))
        });
        let counted: Vec<String> = counted.collect();
        format!("instructions are counted {}", counted.join("; "))
    })
}

/// The algorithms whose distances are in doubt, and by how much.
fn note_on_doubt(cells: &[&Cell]) -> Option<String> {
    let in_doubt = || {
        cells
            .iter()
            .copied()
            .filter(|cell| cell.check.doubt.is_some())
    };
    let doubt = in_doubt().filter_map(|cell| cell.check.doubt);
    let doubt = scientific(doubt.max_by(f64::total_cmp)?);
    let answers = cells.iter().filter(|cell| cell.check.unreachable.is_some());
    let whose = if in_doubt().count() == answers.count() {
        String::new()
    } else {
        format!(" of {}", algorithms(in_doubt()).join(", "))
    };
    Some(format!(
        "edges are too long for the distances{whose}, each of which may be off by up to {doubt}; \
         `geobench distance` names the faces"
    ))
}

/// A note on how much of a model with several components is connected with the source, which may be
/// the first vertex of the largest one.
fn note_on_component(cells: &[&Cell], model: &ModelRecord) -> Option<Note> {
    let LargestComponent { first, vertices } = model.largest_component?;
    let components = grouped(model.components.unwrap_or(0));
    let all = model.vertices.unwrap_or(0);
    let is_it = |cell: &&Cell| cell.source.as_ref().and_then(SourceLabel::vertex) == Some(first);
    if !cells.is_empty() && cells.iter().all(is_it) {
        return Some(Note::new(format!(
            "source {first} is in the largest of {components} components, with {} of {} vertices",
            grouped(vertices),
            grouped(all)
        )));
    }
    let counts = || cells.iter().filter_map(|cell| cell.check.unreachable);
    let unreachable = counts().next().filter(|&count| count > 0)?;
    let is_known = cells.iter().all(|cell| cell.goal.is_none());
    let is_alike = counts().all(|count| count == unreachable);
    (is_known && is_alike).then(|| {
        Note::new(format!(
            "connected with the source: {} of {} vertices; {components} components",
            grouped(all.saturating_sub(unreachable)),
            grouped(all)
        ))
    })
}

/// A note on the number of infinite distances and their reason.
fn note_on_unreachable(cells: &[&Cell]) -> Option<String> {
    let counts = || cells.iter().filter_map(|c| c.check.unreachable);
    let most = counts().max().filter(|&count| count > 0)?;
    let least = counts().min().filter(|&least| least < most);
    let count = match least {
        // Sources may be in different components.
        Some(least) => format!("{} to {}, by source", grouped(least), grouped(most)),
        None => grouped(most),
    };
    let goal = cells.iter().find_map(|c| c.goal.as_deref());
    let places = match goal {
        Some(goal) if goal.contains("within ") => "beyond the radius or unreachable",
        Some(_) => "unreachable targets",
        None => "unreachable vertices",
    };
    Some(format!("{places}: {count}"))
}

/// Notes on the uncertainty of the median times, on doubted times and on outliers.
fn notes_on_times(cells: &[&Cell]) -> Vec<String> {
    let timed = || cells.iter().filter(|c| !c.time.samples.is_empty());
    let widest = timed().map(|cell| cell.time.half_width());
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
    let wide = || timed().filter(|cell| cell.time.is_imprecise());
    if let Some(wanted) = wide().find_map(|cell| cell.time.precision) {
        let names = distinct(wide().map(|cell| cell.algorithm.as_str())).join(", ");
        notes.push(format!(
            "{IMPRECISE} {names}: the interval is wider than the {} % wanted",
            (1e6 * wanted).round() / 1e4
        ));
    }
    let doubted = timed().filter(|cell| cell.time.doubted);
    for name in distinct(doubted.map(|cell| cell.algorithm.as_str())) {
        notes.push(format!(
            "! {name}: the time that it claims is less than that from outside; the time is that \
             from outside"
        ));
    }
    let claimed = timed().filter(|cell| cell.time.unconfirmed);
    for name in distinct(claimed.map(|cell| cell.algorithm.as_str())) {
        notes.push(format!(
            "{name}: its times are claims that nothing confirms; protocol 2 lets them be checked"
        ));
    }
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

/// All notes on the cells of a model with this number of vertices: checks, times and failures.
fn notes(cells: &[&Cell], vertices: Option<u64>) -> Vec<Note> {
    let mut notes = Vec::new();
    let references = cells.iter().filter_map(|c| c.check.reference.as_deref());
    for reference in distinct(references) {
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
        let exact = others.iter().filter(|cell| !cell.approximate);
        let largest = exact.clone().filter_map(|c| c.check.max_rel);
        let largest = largest.fold(0.0, f64::max);
        let compared = others.iter().filter_map(|c| c.check.compared).min();
        let sample = match (compared, vertices) {
            (Some(some), Some(all)) if some < all => {
                format!(" at {} of {} vertices", grouped(some), grouped(all))
            }
            _ => String::new(),
        };
        notes.push(if exact.count() == 0 {
            format!("checked against {reference}{sample}: the errors are in rows of their own")
        } else {
            format!(
                "checked against {reference}{sample}: largest relative difference {}",
                scientific(largest)
            )
        });
    }
    let is_answer = |cell: &&&Cell| cell.status == Status::Ok;
    let is_unchecked = |cell: &Cell| cell.check.reference.is_none() && cell.message.is_none();
    if cells.iter().any(|cell| is_answer(&cell))
        && cells.iter().filter(is_answer).all(|c| is_unchecked(c))
    {
        notes.push("not checked".to_owned());
    }
    notes.extend(notes_on_times(cells));
    notes.extend(note_on_simd(cells));
    notes.extend(note_on_instructions(cells));
    notes.extend(note_on_unreachable(cells));
    notes.extend(note_on_doubt(cells));
    let mut notes: Vec<Note> = notes.into_iter().map(Note::new).collect();
    for cell in cells {
        let Some(message) = &cell.message else {
            continue;
        };
        let source = cell
            .source
            .as_ref()
            .map_or_else(String::new, |s| format!(", source {s}"));
        let text = match cell.status {
            Status::Ok => format!("{}{source}: {message}", cell.algorithm),
            Status::Refused => format!("refused: {message}"),
            status => format!(
                "{}{source}: {}: {message}",
                cell.algorithm,
                status.in_words()
            ),
        };
        let failure = cell.status != Status::Ok;
        let note = Note { text, failure };
        // All algorithms of a refused model share one note.
        if cell.status != Status::Refused || !notes.contains(&note) {
            notes.push(note);
        }
    }
    notes
}

/// The part of ratios: for each figure for which less is better, the mean and the standard
/// deviation over the models of the ratio to the base. `None` if the group has no base or no ratio.
pub(super) fn ratios(group: &GroupCells<'_>) -> Option<Part> {
    let baseline = group.record.ratios_to.as_deref()?;
    let mut counts = Vec::new();
    let figures = figures(&group.record.rows).into_iter();
    let rows = figures
        .filter(|figure| figure.less_is_better)
        .map(|figure| {
            let entries = group.algorithms.iter().map(|name| {
                if *name == baseline {
                    return Entry::default();
                }
                let models = group.models.iter();
                let ratios = models
                    .filter_map(|model| group.ratio(figure, &model.name, name, baseline))
                    .map(|ratio| ratio.value);
                let ratios: Vec<f64> = ratios.filter(|ratio| ratio.is_finite()).collect();
                counts.extend(Some(ratios.len()).filter(|count| *count > 0));
                Entry::new(match mean_and_deviation(&ratios) {
                    None => "-".to_owned(),
                    Some((mean, None)) => format!("{mean:.2} / -"),
                    Some((mean, Some(deviation))) => format!("{mean:.2} / {deviation:.2}"),
                })
            });
            row(&figure.label, entries)
        });
    let rows: Vec<Vec<Entry>> = rows.collect();
    let entries = || rows.iter().flat_map(|row| &row[1..]);
    let compared = entries().any(|entry| !matches!(&*entry.text, "" | "-"));
    let most = counts.iter().copied().max().unwrap_or(0);
    let up_to = if counts.iter().all(|count| *count == most) {
        ""
    } else {
        "up to "
    };
    compared.then(|| Part {
        title: format!("ratios to {baseline}"),
        detail: format!(
            "mean / standard deviation over {up_to}{}",
            counted(most, "model")
        ),
        rows,
        ..Part::default()
    })
}

/// The mean of `values`, and the standard deviation of two or more. `None` without values.
pub(crate) fn mean_and_deviation(values: &[f64]) -> Option<(f64, Option<f64>)> {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    let deviation = (values.len() > 1).then(|| (squares / (n - 1.0)).sqrt());
    (!values.is_empty()).then_some((mean, deviation))
}

/// The row of a model's table with the ratios of the times to those of the base of the group, and a
/// note on it. A column holds the cells of an algorithm. `None` if the group has no base or no
/// ratio.
fn ratio_times(
    group: &GroupCells<'_>,
    model: &str,
    columns: &[Vec<&Cell>],
) -> Option<(Vec<Entry>, Option<Note>)> {
    let baseline = group.record.ratios_to.as_deref()?;
    let others = group.algorithms.iter();
    let ratios = others.map(|name| {
        let ratio = group.ratio(time(), model, name, baseline);
        ratio.filter(|_| *name != baseline)
    });
    let ratios: Vec<Option<Estimate>> = ratios.collect();
    let known = || ratios.iter().flatten();
    known().next()?;
    let without = known().any(|ratio| ratio.interval.is_none());
    let entries = ratios
        .iter()
        .zip(columns)
        .map(|(ratio, cells)| match ratio {
            Some(Estimate {
                value,
                interval: Some([low, high]),
            }) => Entry::new(format!("{value:.2} [{low:.2}, {high:.2}]")),
            Some(Estimate { value, .. }) => Entry::new(format!("{value:.2}")),
            None if cells.is_empty() => Entry::default(),
            None => Entry::new("-"),
        });
    let interval = if without { "" } else { " [95 %]" };
    let label = format!("Time / that of {baseline}{interval}");
    let note = without.then(|| {
        Note::new(format!(
            "ratios of times: no interval from fewer than {FEWEST_FOR_INTERVAL} pairs"
        ))
    });
    Some((row(label, entries), note))
}
