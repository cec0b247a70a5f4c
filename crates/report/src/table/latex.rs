//! Tables in LaTeX, for the booktabs package, with the layout of the papers' tables.

use geobench_export::escape::printable;

use crate::table::model::{Entry, Mark, Table};

/// The first line of every file with tables.
pub(crate) const NEEDS: &str = "% Needs \\usepackage{booktabs}.\n";

/// A `tabular`. The title, the caption and the notes are comments.
pub(crate) fn table(table: &Table) -> String {
    let mut tex = String::new();
    for line in [&table.title, &table.caption]
        .into_iter()
        .flat_map(|t| t.lines())
    {
        tex.extend(["% ", &printable(line), "\n"]);
    }
    tex + &tabular(table)
}

/// The `tabular` without title and caption.
pub(crate) fn tabular(table: &Table) -> String {
    let columns = &table.columns;
    let kinds = columns.iter().map(|c| if c.numeric { 'r' } else { 'l' });
    let kinds: String = table.titles.map(|_| 'l').into_iter().chain(kinds).collect();
    let mut tex = format!("\\begin{{tabular}}{{{kinds}}}\n\\toprule\n");
    let second_heads = table.second_heads();
    if !second_heads.is_empty() {
        tex += &row(second_heads.into_iter().map(|(text, width)| match text {
            "" => vec![""; width].join(" & "),
            text => format!("\\multicolumn{{{width}}}{{c}}{{{}}}", escape(text)),
        }));
    }
    let heads = columns.iter().map(|column| column.head.as_str());
    tex += &row(table.titles.into_iter().chain(heads).map(escape));
    for part in &table.parts {
        tex += "\\midrule\n";
        if table.titles.is_some() {
            for remark in part.remarks() {
                tex.extend([
                    "% ",
                    &printable(&part.title),
                    ": ",
                    &printable(remark),
                    "\n",
                ]);
            }
        } else if !part.title.is_empty() {
            let mut title = escape(&part.title);
            let details = part.details();
            if !details.is_empty() {
                title.extend([" (", &escape(&details), ")"]);
            }
            let width = columns.len();
            let title = format!("\\multicolumn{{{width}}}{{l}}{{{title}}}");
            tex += &row(std::iter::once(title));
        }
        for (i, entries) in part.rows.iter().enumerate() {
            // Name and size share the first column, so that it stays narrow.
            let title = table.titles.map(|_| match i {
                0 if part.rows.len() == 1 => escape(&format!("{} ({})", part.title, part.detail)),
                0 => escape(&part.title),
                1 => escape(&format!("({})", part.detail)),
                _ => String::new(),
            });
            tex += &row(title.into_iter().chain(entries.iter().map(entry)));
        }
    }
    tex + "\\bottomrule\n\\end{tabular}\n"
}

fn row(fields: impl Iterator<Item = String>) -> String {
    fields.collect::<Vec<_>>().join(" & ") + " \\\\\n"
}

fn entry(entry: &Entry) -> String {
    let text = escape(&entry.text);
    match entry.mark {
        Mark::Best => format!("\\textbf{{{text}}}"),
        Mark::Failed => format!("\\emph{{{text}}}"),
        Mark::None => text,
    }
}

/// Text with the special characters of LaTeX escaped.
pub(crate) fn escape(text: &str) -> String {
    let text = printable(text);
    let mut escaped = String::with_capacity(text.len());
    for (place, c) in text.char_indices() {
        match c {
            // LaTeX would take them for options of the `\\` before.
            '[' | '*' if place == 0 => escaped.extend(['{', c, '}']),
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => {
                escaped.push('\\');
                escaped.push(c);
            }
            '\\' => escaped.push_str("\\textbackslash{}"),
            '~' => escaped.push_str("\\textasciitilde{}"),
            '^' => escaped.push_str("\\textasciicircum{}"),
            '\u{b1}' => escaped.push_str("$\\pm$"),
            '\u{b5}' => escaped.push_str("$\\mu$"),
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
