//! One table in Markdown, laid out like those of the papers.

use super::view::{Entry, ModelView, Row, Section, sections};
use crate::record::ResultFile;

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
            lines.extend([shows.trim().to_owned(), String::new()]);
        }
    }
    let header = section.algorithms.iter().map(|name| escape(name));
    lines.extend([
        line("Model", "", header),
        format!("|---|---|{}", "--:|".repeat(section.algorithms.len())),
    ]);
    for view in &section.views {
        for (i, row) in view.rows.iter().enumerate() {
            let model = match i {
                0 => format!("{} ({})", escape(&view.name), view.size),
                _ => String::new(),
            };
            lines.push(line(&model, &row.label, entries(section, view, row)));
        }
    }
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

/// The entries of a row, below the header of the section.
fn entries<'s>(
    section: &'s Section<'_>,
    view: &'s ModelView<'_>,
    row: &'s Row,
) -> impl Iterator<Item = String> + 's {
    section
        .algorithms
        .iter()
        .map(|name| view.entry(row, name).map_or_else(String::new, entry))
}

fn line(model: &str, label: &str, entries: impl Iterator<Item = String>) -> String {
    let fields = [model.to_owned(), label.to_owned()]
        .into_iter()
        .chain(entries);
    let line = fields.fold("|".to_owned(), |line, field| line + " " + &field + " |");
    line.replace("|  |", "| |")
}

fn entry(entry: &Entry) -> String {
    if entry.best {
        format!("**{}**", entry.text)
    } else {
        entry.text.clone()
    }
}

/// Keeps text from ending a table cell.
fn escape(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}
