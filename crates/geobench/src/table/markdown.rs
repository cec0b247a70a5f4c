//! One table in Markdown, laid out like those of the papers.

use super::escape::markdown as escape;
use super::grid::{Entry, Grid};
use super::view::{Section, sections};
use crate::schema::ResultFile;

/// A table for each group, each with a list of what else is to be known.
pub(super) fn render(result: &ResultFile) -> String {
    let parts: Vec<String> = sections(result).iter().map(section).collect();
    parts.join("\n")
}

fn section(section: &Section<'_>) -> String {
    let mut lines = Vec::new();
    if let Some(group) = section.group {
        if let Some(name) = &group.name {
            lines.extend([format!("## {}", escape(name)), String::new()]);
        }
        if let Some(shows) = &group.shows {
            lines.extend(shows.trim().lines().map(escape));
            lines.push(String::new());
        }
    }
    let header = ["Model", ""]
        .into_iter()
        .chain(section.algorithms.iter().copied());
    let mut grid = Grid {
        texts: 2,
        header: header.map(str::to_owned).collect(),
        rows: Vec::new(),
    };
    for view in &section.views {
        for (i, row) in view.rows.iter().enumerate() {
            let model = match i {
                0 => format!("{} ({})", view.name, view.size),
                _ => String::new(),
            };
            let label = [model, row.label.clone()].map(Entry::plain);
            let entries = section.algorithms.iter().map(|name| view.entry(row, name));
            let entries = entries.map(|entry| entry.cloned().unwrap_or_default());
            grid.rows.push(label.into_iter().chain(entries).collect());
        }
    }
    lines.extend(grid.markdown());
    lines.push(String::new());
    for view in &section.views {
        let notes: Vec<&str> = std::iter::once(&view.sources)
            .chain(&view.notes)
            .map(String::as_str)
            .filter(|note| !note.is_empty())
            .collect();
        if !notes.is_empty() {
            lines.push(format!(
                "- {}: {}",
                escape(&view.name),
                escape(&notes.join("; "))
            ));
        }
    }
    lines.join("\n") + "\n"
}
