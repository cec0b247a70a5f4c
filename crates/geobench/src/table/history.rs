//! Tables of histories: change points, and the newest commit against earlier ones.

use super::model::{Column, Entry, Mark, Table};
use super::terminal::{self, Look};
use crate::history::compare::{exact, percent};
use crate::history::gate::Gate;
use crate::history::trend::ChangePoint;
use crate::measure::number::decimals;

/// A value of a figure: seconds, or a number with all digits.
fn shown(figure: &str, value: f64) -> String {
    match figure {
        "time" => format!("{value:.*}", decimals([value], 6)),
        _ => exact(value),
    }
}

/// The change points, in a sentence if there are none.
pub fn change_points(found: &[ChangePoint], look: Look) -> String {
    if found.is_empty() {
        return "no figure has changed its level\n".to_owned();
    }
    let texts = ["Commit", "Cell", "Figure"].map(Column::text);
    let numbers = ["Before", "After", "Change"].map(Column::number);
    let rows = found.iter().map(|change| {
        let figures = [change.before, change.after].map(|value| shown(change.figure, value));
        let [before, after] = figures;
        let cell = change.cell.to_string();
        let texts = [change.commit.clone(), cell, change.figure.to_owned()];
        let numbers = [before, after, percent(change.ratio)];
        texts.into_iter().chain(numbers).map(Entry::new).collect()
    });
    let table = Table::new(texts.into_iter().chain(numbers).collect(), rows.collect());
    terminal::grid(&table, &table.parts[0].rows, look) + "\n"
}

/// The newest commit against the base.
pub fn gate(gate: &Gate, look: Look) -> String {
    let texts = ["Cell", "Figure"].map(Column::text);
    let numbers = ["Base", "New", "Change"].map(Column::number);
    let rows = gate.lines.iter().map(|line| {
        let mark = match line.broken {
            Some(_) => Mark::Failed,
            None => Mark::None,
        };
        let change = match &line.broken {
            Some(rule) => format!("{} ! [{rule}]", line.in_words()),
            None => line.in_words(),
        };
        vec![
            Entry::new(line.cell.to_string()),
            Entry::new(line.figure),
            Entry::new(shown(line.figure, line.base)),
            Entry::new(shown(line.figure, line.new)),
            Entry::marked(change, mark),
        ]
    });
    let rows: Vec<Vec<Entry>> = rows.collect();
    let worse = gate.lines.iter().filter(|l| l.broken.is_some()).count();
    let head = format!(
        "new: {}; base: {} commits, {}",
        gate.commit,
        gate.base.len(),
        gate.base.join(", ")
    );
    let table = Table::new(texts.into_iter().chain(numbers).collect(), rows);
    let mut lines = vec![terminal::line_in(look, "", &head), String::new()];
    if !gate.lines.is_empty() {
        lines.push(terminal::grid(&table, &table.parts[0].rows, look));
    }
    lines.extend(
        gate.notes
            .iter()
            .map(|note| terminal::line_in(look, "  ", note)),
    );
    lines.push(format!("{worse} of {} figures are worse", gate.lines.len()));
    lines.join("\n") + "\n"
}
