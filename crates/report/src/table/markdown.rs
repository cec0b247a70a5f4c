//! Tables in Markdown.

use geobench_export::escape::{markdown as escape, markdown_line};

use crate::table::model::{Entry, Mark, Table};

/// A table under its heading, with a list of notes.
pub(crate) fn table(table: &Table) -> String {
    let mut lines = Vec::new();
    if !table.title.is_empty() {
        lines.extend([format!("## {}", escape(&table.title)), String::new()]);
    }
    if !table.caption.is_empty() {
        lines.extend(table.caption.lines().map(markdown_line));
        lines.push(String::new());
    }
    lines.extend(grid(table));
    lines.push(String::new());
    for part in &table.parts {
        let remarks: Vec<&str> = part.remarks().collect();
        if !remarks.is_empty() {
            let remarks = format!("{}: {}", part.title, remarks.join("; "));
            lines.push(format!("- {}", markdown_line(&remarks)));
        }
    }
    lines.join("\n") + "\n"
}

/// The lines of the table without heading and notes. The best entries are bold.
pub(super) fn grid(table: &Table) -> Vec<String> {
    let heads = table.columns.iter().map(|column| column.head.as_str());
    let rules = table.columns.iter();
    let rules = rules.map(|column| if column.numeric { "--:|" } else { "---|" });
    let titled = table.titles.is_some();
    let mut lines = vec![
        line(table.titles.into_iter().chain(heads).map(escape)),
        format!(
            "|{}{}",
            if titled { "---|" } else { "" },
            rules.collect::<String>()
        ),
    ];
    for part in &table.parts {
        for (i, row) in part.rows.iter().enumerate() {
            let title = titled.then(|| match i {
                0 => escape(&format!("{} ({})", part.title, part.detail)),
                _ => String::new(),
            });
            lines.push(line(title.into_iter().chain(row.iter().map(entry))));
        }
    }
    lines
}

fn entry(entry: &Entry) -> String {
    let text = escape(&entry.text);
    match entry.mark {
        Mark::Best => format!("**{text}**"),
        _ => text,
    }
}

fn line(fields: impl Iterator<Item = String>) -> String {
    let line = fields.fold("|".to_owned(), |line, field| line + " " + &field + " |");
    line.replace("|  |", "| |")
}
