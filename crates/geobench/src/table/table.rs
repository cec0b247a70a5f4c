//! Tables for the terminal.

use super::escape::printable;
use super::grid::{Entry, Grid, Look};
use super::ratios;
use super::view::{ModelView, Row, sections};
use crate::schema::{Cell, GroupRecord, ModelRecord, ResultFile};

/// What stands above the tables of a group: its name and what it is to show. Nothing for a group
/// that has neither.
pub fn group_heading(group: &GroupRecord) -> String {
    let parts = [group.name.as_deref(), group.shows.as_deref()];
    let texts = parts.into_iter().flatten();
    let lines: Vec<_> = texts
        .flat_map(|text| text.trim().lines().map(printable))
        .collect();
    if lines.is_empty() {
        String::new()
    } else {
        lines.join("\n") + "\n\n"
    }
}

/// The table of one model of a group, under a line that says which, followed by an empty line.
pub fn model_table(group: &GroupRecord, model: &ModelRecord, cells: &[Cell], look: Look) -> String {
    show(&ModelView::new(group, model, cells), look)
}

/// The table of the ratios in a group, if it asks for some; `cells` are all of the group.
pub fn ratio_table(group: &GroupRecord, cells: &[Cell], look: Look) -> String {
    let cells: Vec<&Cell> = cells.iter().filter(|c| c.group == group.name).collect();
    ratios::view(group, &cells).map_or_else(String::new, |view| show(&view, look))
}

/// All tables of `result`.
pub(super) fn render(result: &ResultFile) -> String {
    let mut text = String::new();
    for section in sections(result) {
        text.extend(section.group.map(group_heading));
        text.extend(section.views.iter().map(|view| show(view, Look::default())));
    }
    text + &footnote(result, false)
}

fn show(view: &ModelView<'_>, look: Look) -> String {
    let mut lines = vec![format!("{}  ({})", printable(&view.name), view.size)];
    if !view.refused {
        if !view.sources.is_empty() {
            lines[0] += "  ";
            lines[0] += &view.sources;
        }
        lines.push(table(view, look));
    }
    lines.extend(
        view.notes
            .iter()
            .map(|note| format!("  {}", printable(note))),
    );
    lines.join("\n") + "\n\n"
}

fn table(view: &ModelView<'_>, look: Look) -> String {
    let header = std::iter::once("").chain(view.algorithms.iter().copied());
    let row = |row: &Row| {
        let label = Entry::plain(row.label.clone());
        std::iter::once(label)
            .chain(row.entries.iter().cloned())
            .collect()
    };
    let grid = Grid {
        texts: 1,
        header: header.map(str::to_owned).collect(),
        rows: view.rows.iter().map(row).collect(),
    };
    grid.terminal(look)
}

/// What the figures of the tables of `result` mean, in one line.
pub fn footnote(result: &ResultFile, styled: bool) -> String {
    let runs = result.cells.iter().map(|c| c.time.samples.len()).max();
    let times = match runs {
        // There is no figure at all.
        None | Some(0) => return String::new(),
        Some(1) => "time of one run; ".to_owned(),
        Some(runs) => format!("time: median of {runs} runs; "),
    };
    let star = if styled { "" } else { "; * best" };
    format!(
        "{times}papers' count: 80 bytes per window; measured: heap of the algorithm without the mesh; \
         MB = 10^6 bytes{star}\n"
    )
}
