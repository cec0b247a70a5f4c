//! Tables in HTML.

use std::fmt::Write;

use geobench_export::escape::xml as escape;

use crate::table::model::{Entry, Mark, Part, Table};

/// A table under its caption.
pub(crate) fn table(html: &mut String, table: &Table) {
    // The caption is outside of the scrolling element, so it does not scroll. The element has a tab
    // index, so that it can be scrolled by keyboard. Writing to a string cannot fail.
    let _ = writeln!(
        html,
        "<p class=\"caption\" id=\"{0}-caption\">{1}</p>\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-labelledby=\"{0}-caption\">\n<table id=\"{0}\" aria-labelledby=\"{0}-caption\"{2}{3}>",
        table.id,
        escape(&table.caption),
        match table.rows_are {
            "" => String::new(),
            rows => format!(" data-rows=\"{rows}\""),
        },
        if table.columns_are_algorithms {
            " data-columns=\"algorithm\""
        } else {
            ""
        }
    );
    html.push_str("<thead>\n");
    let second_heads = table.second_heads();
    if !second_heads.is_empty() {
        row(
            html,
            second_heads.into_iter().map(|(text, width)| match text {
                "" => format!("<td colspan=\"{width}\"></td>"),
                text => format!(
                    "<th scope=\"colgroup\" colspan=\"{width}\" class=\"over\">{}</th>",
                    escape(text)
                ),
            }),
        );
    }
    let heads = table.columns.iter().map(|column| {
        let class = if column.numeric { " class=\"n\"" } else { "" };
        // Non-breaking spaces keep a unit on the line of the word before it.
        let head = column
            .head
            .replace(" (", "\u{a0}(")
            .replace(" %", "\u{a0}%");
        let head = escape(&head);
        if table.columns_are_algorithms {
            // A narrow column breaks a label at its parameters.
            let head = head.replace('{', "{<wbr>").replace(',', ",<wbr>");
            format!(
                "<th scope=\"col\"{class}>{}</th>",
                head.replace('=', "=<wbr>")
            )
        } else {
            format!("<th scope=\"col\"{class}>{head}</th>")
        }
    });
    row(html, heads);
    html.push_str("</thead>\n");
    for part in &table.parts {
        body(html, table, part);
    }
    html.push_str("</table>\n</div>\n");
}

fn body(html: &mut String, table: &Table, part: &Part) {
    let tag = if part.is_foot { "tfoot" } else { "tbody" };
    let _ = writeln!(html, "<{tag}>");
    if !part.title.is_empty() {
        let details = match part.details() {
            details if details.is_empty() => details,
            details => format!(" <small>{}</small>", escape(&details)),
        };
        let _ = writeln!(
            html,
            "<tr class=\"part\"><th scope=\"rowgroup\" colspan=\"{}\"><span><span class=\"of\">{}</span>{details}</span></th></tr>",
            table.columns.len(),
            escape(&part.title)
        );
    }
    for entries in &part.rows {
        let fields = entries.iter().zip(&table.columns).enumerate();
        let fields = fields.map(|(i, (entry, column))| match i {
            // A narrow column breaks a name at a comma, not within a number.
            0 => format!(
                "<th scope=\"row\">{}</th>",
                linked(entry, &escape(&entry.text).replace(',', ",<wbr>"))
            ),
            _ => self::entry(entry, column.numeric),
        });
        row(html, fields);
    }
    let _ = writeln!(html, "</{tag}>");
}

fn row(html: &mut String, fields: impl Iterator<Item = String>) {
    let _ = writeln!(html, "<tr>{}</tr>", fields.collect::<String>());
}

/// The number of letters from which on a text has a wide column on a phone.
const LONG: usize = 60;

/// Whether a text is a day, such as 2026-11-25.
fn is_date(text: &str) -> bool {
    let parts: Vec<&str> = text.split('-').collect();
    let digits = |(part, count): (&&str, usize)| {
        part.len() == count && part.bytes().all(|b| b.is_ascii_digit())
    };
    parts.len() == 3 && parts.iter().zip([4, 2, 2]).all(digits)
}

/// `text`, within a link if the entry has one.
fn linked(entry: &Entry, text: &str) -> String {
    match &entry.link {
        Some(address) => format!("<a href=\"{}\">{text}</a>", escape(address)),
        None => text.to_owned(),
    }
}

fn entry(entry: &Entry, numeric: bool) -> String {
    let class = match (entry.mark, numeric, entry.heat) {
        (Mark::Failed, ..) => " class=\"n failed\"".to_owned(),
        (_, true, 0) => " class=\"n\"".to_owned(),
        (_, true, heat) => format!(" class=\"n heat-{heat}\""),
        _ if is_date(&entry.text) => " class=\"date\"".to_owned(),
        _ if entry.text.chars().count() > LONG => " class=\"long\"".to_owned(),
        _ => String::new(),
    };
    // Non-breaking spaces allow line breaks only before the interval of a value.
    let text = if numeric {
        let kept = entry.text.replace(", ", ",\u{a0}");
        kept.replace(" / ", "\u{a0}/\u{a0}")
    } else {
        entry.text.clone()
    };
    let text = linked(entry, &escape(&text));
    match entry.mark {
        Mark::Best => format!("<td{class}><b>{text}</b></td>"),
        _ => format!("<td{class}>{text}</td>"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::Column;

    #[test]
    fn names_break_at_commas() {
        let row = vec![Entry::new("knot,faces=20000"), Entry::new("1,000")];
        let columns = Column::of(["Model"], ["Faces"]);
        let mut html = String::new();
        table(&mut html, &Table::new(columns, vec![row]));
        assert!(
            html.contains("<th scope=\"row\">knot,<wbr>faces=20000</th>"),
            "{html}"
        );
        assert!(html.contains(">1,000</td>"), "{html}");
        let columns = Column::of(["Model"], ["fwp-mmp{kmax=5000,bucket=2}"]);
        let matrix = Table {
            columns_are_algorithms: true,
            ..Table::new(columns, Vec::new())
        };
        let mut html = String::new();
        table(&mut html, &matrix);
        assert!(
            html.contains(">fwp-mmp{<wbr>kmax=<wbr>5000,<wbr>bucket=<wbr>2}</th>"),
            "{html}"
        );
    }
}
