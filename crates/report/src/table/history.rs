//! Tables of histories: change points, and the comparison of the newest commit with earlier ones.

use geobench_export::escape::markdown_line;
use geobench_harness::measure::number::{counted, decimals};

use crate::history::compare::{exact, percent};
use crate::history::gate::{FEWEST, GateReport};
use crate::history::trend::ChangePoint;
use crate::table::markdown;
use crate::table::model::{Column, Entry, Mark, Table};
use crate::table::terminal::{self, Look};

/// A value of a figure: seconds, or a number with all digits.
fn shown(figure: &str, value: f64) -> String {
    match figure {
        name if name.ends_with("time") => format!("{value:.*}", decimals([value], 9)),
        _ => exact(value),
    }
}

/// The entry of a figure; empty without a value.
fn value(figure: &str, value: Option<f64>) -> Entry {
    Entry::new(value.map_or_else(String::new, |value| shown(figure, value)))
}

/// The table of the change points. `shown` formats a value of a figure.
pub(crate) fn table_of_changes(found: &[ChangePoint], shown: fn(&str, f64) -> String) -> Table {
    let row = |change: &ChangePoint| {
        let [before, after] = [change.before, change.after].map(|x| shown(change.figure, x));
        let cell = change.cell.to_string();
        let (commit, figure) = (change.commit.clone(), change.figure.to_owned());
        let texts = [commit, cell, figure, before, after, percent(change.ratio)];
        texts.map(Entry::new).into()
    };
    let columns = Column::of(["Commit", "Cell", "Figure"], ["Before", "After", "Change"]);
    Table::new(columns, found.iter().map(row).collect())
}

/// The table of the change points for the terminal; a sentence if there are none.
pub fn change_points(found: &[ChangePoint], look: Look) -> String {
    if found.is_empty() {
        return "no figure has changed its level\n".to_owned();
    }
    let table = table_of_changes(found, shown);
    terminal::grid(&table, &table.parts[0].rows, look) + "\n"
}

/// The comparison of the newest commit with the base: its table, and lines before and after it.
fn gate_parts(gate: &GateReport) -> (String, Table, Vec<String>) {
    let rows = gate.lines.iter().map(|line| {
        let mark = match line.broken {
            Some(_) => Mark::Failed,
            None => Mark::None,
        };
        let change = match &line.broken {
            Some(rule) => format!("{} ! [{rule}]", line.in_words())
                .trim_start()
                .to_owned(),
            None => match &line.improved {
                Some(rule) => format!("{} better [{rule}]", line.in_words()),
                None => line.in_words(),
            },
        };
        vec![
            Entry::new(line.cell.to_string()),
            Entry::new(line.figure),
            value(line.figure, line.base),
            value(line.figure, line.new),
            Entry::marked(change, mark),
        ]
    });
    let rows: Vec<Vec<Entry>> = rows.collect();
    let base = match &gate.base[..] {
        [] => "no commit".to_owned(),
        base => format!("{}, {}", counted(base.len(), "commit"), base.join(", ")),
    };
    let head = format!("new: {}; base: {base}", gate.commit);
    let columns = Column::of(["Cell", "Figure"], ["Base", "New", "Change"]);
    let worse = gate.lines.iter().filter(|l| l.broken.is_some()).count();
    let mut notes = gate.notes.clone();
    let better = gate.lines.iter().filter(|l| l.improved.is_some()).count();
    let better = match better {
        0 => String::new(),
        better => format!(", {better} better"),
    };
    notes.push(if let Some(known) = gate.learning {
        format!("learning, {known} of {FEWEST} base commits: nothing is judged yet")
    } else {
        let are = if worse == 1 { "is" } else { "are" };
        format!(
            "{worse} of {} figures {are} worse{better}",
            gate.lines.len()
        )
    });
    (head, Table::new(columns, rows), notes)
}

/// The comparison of the newest commit with the base, for the terminal.
pub fn gate(gate: &GateReport, look: Look) -> String {
    let (head, table, mut notes) = gate_parts(gate);
    let last = notes.pop();
    let mut lines = vec![terminal::line_in(look, "", &head), String::new()];
    if !gate.lines.is_empty() {
        lines.push(terminal::grid(&table, &table.parts[0].rows, look));
    }
    lines.extend(notes.iter().map(|note| terminal::line_in(look, "  ", note)));
    lines.extend(last);
    lines.join("\n") + "\n"
}

/// The comparison of the newest commit with the base, in Markdown.
pub fn gate_in_markdown(gate: &GateReport) -> String {
    let (head, table, mut notes) = gate_parts(gate);
    let last = notes.pop().unwrap_or_default();
    let mut lines = vec![
        format!("### geobench: {last}"),
        String::new(),
        markdown_line(&head),
    ];
    if !gate.lines.is_empty() {
        lines.push(String::new());
        lines.extend(markdown::grid(&table));
    }
    if !notes.is_empty() {
        lines.push(String::new());
        lines.extend(
            notes
                .iter()
                .map(|note| format!("- {}", markdown_line(note))),
        );
    }
    lines.join("\n") + "\n"
}
