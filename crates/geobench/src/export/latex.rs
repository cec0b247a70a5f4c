//! One table in LaTeX, laid out like those of the papers.

use super::view::{algorithms, views};
use crate::record::ResultFile;

/// A `tabular` for the booktabs package; what else is to be known stands in comments.
pub(super) fn render(result: &ResultFile) -> String {
    let algorithms = algorithms(&result.cells);
    let mut text = "% Needs \\usepackage{booktabs}.\n".to_owned();
    text += &format!(
        "\\begin{{tabular}}{{ll{}}}\n\\toprule\nModel &",
        "r".repeat(algorithms.len())
    );
    for name in &algorithms {
        text += &format!(" & {}", escape(name));
    }
    text += " \\\\\n";
    for view in views(result) {
        text += "\\midrule\n";
        for note in std::iter::once(&view.sources).chain(&view.notes) {
            text += &format!("% {}: {}\n", view.model.name, note.replace('\n', " "));
        }
        for (i, row) in view.rows.iter().enumerate() {
            if view.is_refused() && i > 0 {
                break;
            }
            let label = if view.is_refused() { "" } else { row.label };
            // Name and size share the first column, so that it stays narrow.
            let model = match i {
                0 => escape(&view.model.name),
                1 => format!("({})", view.size()),
                _ => String::new(),
            };
            text += &format!("{model} & {}", escape(label));
            for entry in &row.entries {
                text += &match entry.best {
                    true => format!(" & \\textbf{{{}}}", entry.text),
                    false => format!(" & {}", entry.text),
                };
            }
            text += " \\\\\n";
        }
    }
    text += "\\bottomrule\n\\end{tabular}\n";
    text
}

/// Text with the characters that mean something to LaTeX made harmless.
fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
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
    }
}
