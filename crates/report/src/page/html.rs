//! Writes a report as one self-contained HTML page that needs no network. The page shows everything
//! without scripts. The scripts in `assets` add filters, sorting and values on hover.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use geobench_export::escape::xml as escape;
use geobench_export::svg;
use sha2::{Digest, Sha256};

use super::document::{Document, Headline, Plot, Section, SectionItem};
use super::tables::by_algorithm;
use super::{BuiltReport, prose};
use crate::table;

pub(super) const STYLE: &str = include_str!("assets/page.css");

/// The scripts, in the order in which they run.
const SCRIPTS: &str = concat!(
    include_str!("assets/charts.js"),
    include_str!("assets/tables.js"),
    include_str!("assets/explore.js"),
);

/// The content security policy. It allows the page's own script (by its hash), inline styles and
/// embedded images. Nothing is loaded, and no other script can run, even if a name were not
/// escaped.
fn policy() -> String {
    let hash = STANDARD.encode(Sha256::digest(SCRIPTS));
    format!(
        "default-src 'none'; style-src 'unsafe-inline'; img-src data:; script-src 'sha256-{hash}'"
    )
}

/// The start of a page: its head with `meta` and `styles`, and its heading.
pub(super) fn head(title: &str, meta: &str, styles: [&str; 2]) -> String {
    let (title, styles) = (escape(title), styles.concat());
    // The empty icon keeps browsers from requesting one.
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         <link rel=\"icon\" href=\"data:,\">\n{meta}<title>{title}</title>\n\
         <style>\n{styles}</style>\n</head>\n<body>\n<header>\n<h1>{title}</h1>\n</header>\n"
    )
}

/// The report as an HTML page.
pub fn page(report: &BuiltReport) -> String {
    whole(&report.document, "", "report")
}

/// A document as a page, with `links` to other pages above its contents, made by `command`.
pub(crate) fn whole(document: &Document, links: &str, command: &str) -> String {
    let policy = format!(
        "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n",
        policy()
    );
    let mut html = head(&document.title, &policy, [svg::STYLE, STYLE]);
    html += links;
    if document.sections.len() > 1 {
        contents(&mut html, document);
    }
    html += "<main>\n";
    for part in &document.sections {
        section(&mut html, part);
    }
    html += &format!(
        "</main>\n<footer><p>Made by <code>geobench {command}</code> {}.</p></footer>\n",
        env!("CARGO_PKG_VERSION")
    );
    html += &format!("<script>{SCRIPTS}</script>\n");
    html += "</body>\n</html>\n";
    html
}

fn contents(html: &mut String, document: &Document) {
    html.push_str("<nav aria-label=\"Contents\"><ul>\n");
    for section in &document.sections {
        let class = if section.top { " class=\"top\"" } else { "" };
        *html += &format!(
            "<li{class}><a href=\"#{}\">{}</a></li>\n",
            section.id,
            escape(&section.heading)
        );
    }
    html.push_str("</ul></nav>\n");
}

fn section(html: &mut String, section: &Section) {
    let (id, heading) = (&section.id, escape(&section.heading));
    let tag = if section.top { "h2" } else { "h3" };
    *html += &format!("<section id=\"{id}\">\n<{tag}>{heading}</{tag}>\n");
    for block in &section.blocks {
        write_block(html, block);
    }
    html.push_str("</section>\n");
}

fn write_block(html: &mut String, block: &SectionItem) {
    match block {
        SectionItem::Headline(name, headline) => write_headline(html, name.as_deref(), headline),
        SectionItem::Warnings(texts) => {
            html.push_str("<ul class=\"warnings\" aria-label=\"Warnings\">\n");
            for text in texts {
                *html += &format!("<li>{}</li>\n", escape(text));
            }
            html.push_str("</ul>\n");
        }
        SectionItem::Prose(text) => *html += &prose::html(text),
        SectionItem::Text(text) => *html += &format!("<p>{}</p>\n", escape(text)),
        SectionItem::Heading(text) => *html += &format!("<h4>{}</h4>\n", escape(text)),
        SectionItem::Facts(facts) => {
            html.push_str("<dl>\n");
            for (name, value) in facts {
                *html += &format!("<dt>{}</dt><dd>{}</dd>\n", escape(name), escape(value));
            }
            html.push_str("</dl>\n");
        }
        SectionItem::Table(table) => table::html::table(html, table),
        SectionItem::Figures(table) => table::html::table(html, &by_algorithm(table)),
        SectionItem::Plots(plots) => write_plots(html, plots),
        SectionItem::More(summary, items) => {
            let summary = escape(summary);
            *html += &format!("<details class=\"more\"><summary>{summary}</summary>\n");
            for item in items {
                write_block(html, item);
            }
            html.push_str("</details>\n");
        }
        SectionItem::Notes(notes) => {
            html.push_str("<ul class=\"notes\">\n");
            for note in notes {
                let class = if note.failure {
                    " class=\"failed\""
                } else {
                    ""
                };
                *html += &format!("<li{class}>{}</li>\n", escape(&note.text));
            }
            html.push_str("</ul>\n");
        }
        SectionItem::Links(links) => {
            html.push_str("<p class=\"links\">\n");
            for link in links {
                *html += &format!(
                    "<a href=\"{}\" download=\"{}\">{}</a>\n",
                    escape(&link.address),
                    escape(&link.file),
                    escape(&link.label)
                );
            }
            html.push_str("</p>\n");
        }
    }
}

/// The sentences of a headline. Those that are hidden are for the scripts, which show them when the
/// algorithms of the others are hidden.
fn write_headline(html: &mut String, name: Option<&str>, headline: &Headline) {
    let ranking = serde_json::to_string(&headline.ranking).unwrap_or_default();
    let base = headline.base.as_deref().unwrap_or_default();
    *html += &format!(
        "<div class=\"headlines\" data-ranking=\"{}\" data-base=\"{}\">\n",
        escape(&ranking),
        escape(base)
    );
    if let Some(name) = name {
        *html += &format!("<p class=\"group\">{}</p>\n", escape(name));
    }
    let shown = headline.shown.iter().map(|sentence| (sentence, ""));
    let others = headline.others.iter().map(|sentence| (sentence, " hidden"));
    for (sentence, hidden) in shown.chain(others) {
        *html += &format!(
            "<p class=\"headline\" data-faster=\"{}\" data-slower=\"{}\" data-next=\"{}\"{hidden}>{}</p>\n",
            escape(&sentence.faster),
            escape(&sentence.slower),
            sentence.of_next,
            escape(&sentence.text)
        );
    }
    html.push_str("</div>\n");
}

fn write_plots(html: &mut String, plots: &[Plot]) {
    html.push_str("<div class=\"plots\">\n");
    for plot in plots {
        write_plot(html, plot);
    }
    html.push_str("</div>\n");
}

fn write_plot(html: &mut String, plot: &Plot) {
    *html += &format!(
        "<figure id=\"{}\">\n<figcaption><b>{}</b> {}</figcaption>\n{}</figure>\n",
        plot.id,
        escape(&plot.title),
        escape(&plot.caption),
        plot.draw(false)
    );
}
