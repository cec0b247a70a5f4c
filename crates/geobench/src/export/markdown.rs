//! One table in Markdown, laid out like those of the papers.

use super::view::{Entry, algorithms, views};
use crate::record::ResultFile;

/// The table, and a list of what else is to be known.
pub(super) fn render(result: &ResultFile) -> String {
    let views = views(result);
    let algorithms = algorithms(&result.cells);
    let header = algorithms.iter().map(|name| escape(name));
    let mut lines = vec![
        line("Model", "", header),
        format!("|---|---|{}", "--:|".repeat(algorithms.len())),
    ];
    for view in &views {
        for (i, row) in view.rows.iter().enumerate() {
            let model = match i {
                0 => format!("{} ({})", escape(&view.model.name), view.size()),
                _ => String::new(),
            };
            lines.push(line(&model, row.label, row.entries.iter().map(entry)));
        }
    }
    lines.push(String::new());
    for view in &views {
        let notes: Vec<&str> = std::iter::once(&view.sources)
            .chain(&view.notes)
            .map(String::as_str)
            .collect();
        lines.push(format!(
            "- {}: {}",
            escape(&view.model.name),
            escape(&notes.join("; "))
        ));
    }
    lines.join("\n") + "\n"
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
