//! One table in Markdown, laid out like those of the papers.

use super::view::{algorithms, views};
use crate::record::ResultFile;

/// The table, and a list of what else is to be known.
pub(super) fn render(result: &ResultFile) -> String {
    let views = views(result);
    let algorithms = algorithms(&result.cells);
    let mut text = "| Model | |".to_owned();
    for name in &algorithms {
        text += &format!(" {} |", escape(name));
    }
    text += "\n|---|---|";
    text += &"--:|".repeat(algorithms.len());
    text.push('\n');
    for view in &views {
        for (i, row) in view.rows.iter().enumerate() {
            if view.is_refused() && i > 0 {
                break;
            }
            let label = if view.is_refused() { "" } else { row.label };
            let model = match i {
                0 => format!("{} ({})", escape(&view.model.name), view.size()),
                _ => String::new(),
            };
            text += &format!("| {model} | {label} |");
            for entry in &row.entries {
                text += &match entry.best {
                    true => format!(" **{}** |", entry.text),
                    false => format!(" {} |", entry.text),
                };
            }
            text.push('\n');
        }
    }
    text.push('\n');
    for view in &views {
        let mut notes = view.notes.clone();
        if !view.is_refused() {
            notes.insert(0, view.sources.clone());
        }
        text += &format!(
            "- {}: {}\n",
            escape(&view.model.name),
            escape(&notes.join("; "))
        );
    }
    text
}

/// Keeps text from ending a table cell.
fn escape(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}
