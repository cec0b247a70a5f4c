//! One table in LaTeX, laid out like those of the papers.

use super::escape::printable;
use super::grid::Entry;
use super::view::{Section, sections};
use crate::schema::ResultFile;

/// A `tabular` for each group, for the booktabs package; what else is to be known stands in
/// comments.
pub(super) fn render(result: &ResultFile) -> String {
    let mut lines = vec!["% Needs \\usepackage{booktabs}.".to_owned()];
    for section in sections(result) {
        tabular(&section, &mut lines);
    }
    lines.join("\n")
}

fn tabular(section: &Section<'_>, lines: &mut Vec<String>) {
    if let Some(group) = section.group {
        let texts = [group.name.as_deref(), group.shows.as_deref()];
        let texts = texts.into_iter().flatten().flat_map(|t| t.trim().lines());
        lines.extend(texts.map(|text| format!("% {}", printable(text))));
    }
    let algorithms = &section.algorithms;
    lines.extend([
        format!("\\begin{{tabular}}{{ll{}}}", "r".repeat(algorithms.len())),
        "\\toprule".to_owned(),
    ]);
    let header = algorithms.iter().map(|name| escape(name));
    lines.push(line("Model", "", header));
    for view in &section.views {
        lines.push("\\midrule".to_owned());
        for note in std::iter::once(&view.sources).chain(&view.notes) {
            if !note.is_empty() {
                let (name, note) = (printable(&view.name), printable(note));
                lines.push(format!("% {name}: {note}"));
            }
        }
        for (i, row) in view.rows.iter().enumerate() {
            // Name and size share the first column, so that it stays narrow.
            let model = match i {
                0 => escape(&view.name),
                1 => format!("({})", view.size),
                _ => String::new(),
            };
            let entries = algorithms
                .iter()
                .map(|name| view.entry(row, name).map_or_else(String::new, entry));
            lines.push(line(&model, &row.label, entries));
        }
    }
    lines.extend(["\\bottomrule".to_owned(), "\\end{tabular}\n".to_owned()]);
}

fn line(model: &str, label: &str, entries: impl Iterator<Item = String>) -> String {
    let fields = [model.to_owned(), escape(label)].into_iter().chain(entries);
    fields.collect::<Vec<_>>().join(" & ") + " \\\\"
}

fn entry(entry: &Entry) -> String {
    if entry.best {
        format!("\\textbf{{{}}}", entry.text)
    } else {
        entry.text.clone()
    }
}

/// Text with the characters that mean something to LaTeX made harmless.
pub(crate) fn escape(text: &str) -> String {
    let text = printable(text);
    let mut escaped = String::with_capacity(text.len());
    for (place, c) in text.char_indices() {
        match c {
            // Behind the end of a line they would be its options.
            '[' | '*' if place == 0 => escaped.extend(['{', c, '}']),
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => {
                escaped.push('\\');
                escaped.push(c);
            }
            '\\' => escaped.push_str("\\textbackslash{}"),
            '~' => escaped.push_str("\\textasciitilde{}"),
            '^' => escaped.push_str("\\textasciicircum{}"),
            _ => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn special_characters_are_harmless() {
        assert_eq!(escape("a_b&50%"), "a\\_b\\&50\\%");
        assert_eq!(
            escape("\\~^"),
            "\\textbackslash{}\\textasciitilde{}\\textasciicircum{}"
        );
        assert_eq!(escape("[2cm]\ra"), "{[}2cm] a");
        assert_eq!(escape("*[a]"), "{*}[a]");
    }
}
