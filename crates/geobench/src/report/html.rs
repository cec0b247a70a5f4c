//! A report as one page that needs nothing else: no network, no script.

use std::fmt::Write;

use super::Report;
use super::chart::{self, Spoken};
use super::document::{Block, Document, Entry, Mark, Plot, Section, Table, TablePart};
use super::svg::escape;

const STYLE: &str = include_str!("page.css");

/// The page.
pub fn page(report: &Report) -> String {
    let document = &report.document;
    let mut html = String::new();
    html += "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
    html += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
    html += "<meta name=\"color-scheme\" content=\"light dark\">\n";
    // Browsers ask for an icon unless the page has one.
    html += "<link rel=\"icon\" href=\"data:,\">\n";
    html += &format!("<title>{}</title>\n", escape(&document.title));
    html += &format!(
        "<style>\n{}{STYLE}</style>\n</head>\n<body>\n",
        chart::STYLE
    );
    html += &format!(
        "<header>\n<h1>{}</h1>\n</header>\n",
        escape(&document.title)
    );
    contents(&mut html, document);
    html += "<main>\n";
    for part in &document.sections {
        section(&mut html, part);
    }
    html += "</main>\n<footer><p>Made by <code>geobench report</code> ";
    html += env!("CARGO_PKG_VERSION");
    html += ".</p></footer>\n</body>\n</html>\n";
    html
}

fn contents(html: &mut String, document: &Document) {
    html.push_str("<nav aria-label=\"Contents\"><ul>\n");
    for section in &document.sections {
        let class = if section.top { " class=\"top\"" } else { "" };
        line(
            html,
            format_args!(
                "<li{class}><a href=\"#{}\">{}</a></li>",
                section.id,
                escape(&section.heading)
            ),
        );
    }
    html.push_str("</ul></nav>\n");
}

fn section(html: &mut String, section: &Section) {
    let level = if section.top { 'h' } else { 's' };
    let (id, heading) = (&section.id, escape(&section.heading));
    let tag = if level == 'h' { "h2" } else { "h3" };
    line(
        html,
        format_args!("<section id=\"{id}\">\n<{tag}>{heading}</{tag}>"),
    );
    for block in &section.blocks {
        write_block(html, block);
    }
    html.push_str("</section>\n");
}

fn write_block(html: &mut String, block: &Block) {
    match block {
        Block::Text(text) => line(html, format_args!("<p>{}</p>", escape(text))),
        Block::Heading(text) => line(html, format_args!("<h4>{}</h4>", escape(text))),
        Block::Facts(facts) => {
            html.push_str("<dl>\n");
            for (name, value) in facts {
                line(
                    html,
                    format_args!("<dt>{}</dt><dd>{}</dd>", escape(name), escape(value)),
                );
            }
            html.push_str("</dl>\n");
        }
        Block::Table(table) => write_table(html, table),
        Block::Plots(plots) => {
            html.push_str("<div class=\"plots\">\n");
            for plot in plots {
                write_plot(html, plot);
            }
            html.push_str("</div>\n");
        }
        Block::Notes(notes) => {
            html.push_str("<ul class=\"notes\">\n");
            for note in notes {
                let class = if note.failure {
                    " class=\"failed\""
                } else {
                    ""
                };
                line(html, format_args!("<li{class}>{}</li>", escape(&note.text)));
            }
            html.push_str("</ul>\n");
        }
        Block::Links(links) => {
            html.push_str("<p class=\"links\">\n");
            for link in links {
                line(
                    html,
                    format_args!(
                        "<a href=\"{}\" download=\"{}\">{}</a>",
                        escape(&link.address),
                        escape(&link.file),
                        escape(&link.label)
                    ),
                );
            }
            html.push_str("</p>\n");
        }
    }
}

fn write_table(html: &mut String, table: &Table) {
    // The caption stands outside, where it does not scroll with the table; what scrolls can be
    // reached by keyboard.
    line(
        html,
        format_args!(
            "<p class=\"caption\" id=\"{0}-caption\">{1}</p>\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-labelledby=\"{0}-caption\">\n<table id=\"{0}\" aria-labelledby=\"{0}-caption\">",
            table.id,
            escape(&table.caption)
        ),
    );
    html.push_str("<thead>\n");
    if table.columns.iter().any(|column| !column.over.is_empty()) {
        html.push_str("<tr>");
        for (text, width) in overs(table) {
            if text.is_empty() {
                let _ = write!(html, "<td colspan=\"{width}\"></td>");
            } else {
                let _ = write!(
                    html,
                    "<th scope=\"colgroup\" colspan=\"{width}\" class=\"over\">{}</th>",
                    escape(text)
                );
            }
        }
        html.push_str("</tr>\n");
    }
    html.push_str("<tr>");
    for column in &table.columns {
        let class = if column.numeric { " class=\"n\"" } else { "" };
        let _ = write!(
            html,
            "<th scope=\"col\"{class}>{}</th>",
            escape(&column.head)
        );
    }
    html.push_str("</tr>\n</thead>\n");
    for part in &table.parts {
        write_part(html, table, part);
    }
    html.push_str("</table>\n</div>\n");
}

/// What stands above the columns, with the number of columns that it spans.
pub(super) fn overs(table: &Table) -> Vec<(&str, usize)> {
    let mut overs: Vec<(&str, usize)> = Vec::new();
    for column in &table.columns {
        match overs.last_mut().filter(|(text, _)| *text == column.over) {
            Some((_, width)) => *width += 1,
            None => overs.push((&column.over, 1)),
        }
    }
    overs
}

fn write_part(html: &mut String, table: &Table, part: &TablePart) {
    html.push_str("<tbody>\n");
    if !part.title.is_empty() {
        let _ = write!(
            html,
            "<tr class=\"part\"><th scope=\"rowgroup\" colspan=\"{}\"><span>{}",
            table.columns.len(),
            escape(&part.title)
        );
        if !part.detail.is_empty() {
            let _ = write!(html, " <small>{}</small>", escape(&part.detail));
        }
        html.push_str("</span></th></tr>\n");
    }
    for row in &part.rows {
        html.push_str("<tr>");
        for (i, (entry, column)) in row.iter().zip(&table.columns).enumerate() {
            if i == 0 {
                let _ = write!(html, "<th scope=\"row\">{}</th>", escape(&entry.text));
            } else {
                write_entry(html, entry, column.numeric);
            }
        }
        html.push_str("</tr>\n");
    }
    html.push_str("</tbody>\n");
}

fn write_entry(html: &mut String, entry: &Entry, numeric: bool) {
    let class = match (entry.mark, numeric) {
        (Mark::Failed, _) => " class=\"n failed\"",
        (_, true) => " class=\"n\"",
        _ => "",
    };
    let text = escape(&entry.text);
    let _ = match entry.mark {
        Mark::Best => write!(html, "<td{class}><b>{text}</b></td>"),
        _ => write!(html, "<td{class}>{text}</td>"),
    };
}

fn write_plot(html: &mut String, plot: &Plot) {
    let spoken = Spoken {
        id: &plot.id,
        title: &plot.title,
        description: &plot.caption,
    };
    line(
        html,
        format_args!(
            "<figure id=\"{}\">\n<figcaption><b>{}</b> {}</figcaption>\n{}</figure>",
            plot.id,
            escape(&plot.title),
            escape(&plot.caption),
            plot.chart.draw(spoken, false)
        ),
    );
}

fn line(html: &mut String, text: std::fmt::Arguments<'_>) {
    let _ = writeln!(html, "{text}"); // Writing to a string cannot fail.
}
