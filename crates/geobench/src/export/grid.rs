//! A table of texts, and how it looks on a terminal and in Markdown.

use comfy_table::{Attribute, Cell as TableCell, CellAlignment, Color, Table, presets};

/// A figure in a table, or what stands in its place.
#[derive(Clone, Debug, Default)]
pub(crate) struct Entry {
    pub(crate) text: String,
    /// Whether it is to be set off as the best of its row.
    pub(crate) best: bool,
    /// Whether it says that something failed.
    pub(crate) failed: bool,
}

impl Entry {
    /// A text with nothing special about it.
    pub(super) fn plain(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            ..Self::default()
        }
    }
}

/// A table.
#[derive(Clone, Debug, Default)]
pub(super) struct Grid {
    /// How many columns are texts, which start at the left; the others are figures.
    pub(super) texts: usize,
    /// What stands above the columns.
    pub(super) header: Vec<String>,
    /// As many entries in each row as in the header.
    pub(super) rows: Vec<Vec<Entry>>,
}

impl Grid {
    /// For the terminal: what is set off is coloured if `styled`, else marked with a star.
    pub(super) fn terminal(&self, styled: bool) -> String {
        let mut table = Table::new();
        table.load_style(presets::UTF8_FULL_CONDENSED);
        if styled {
            table.enforce_styling();
        } else {
            table.force_no_tty();
        }
        let aligned = |place: usize, text: &str| {
            let cell = TableCell::new(text);
            if place < self.texts {
                cell
            } else {
                cell.set_alignment(CellAlignment::Right)
            }
        };
        let header = self.header.iter().enumerate();
        table.set_header(header.map(|(place, text)| aligned(place, text)));
        for row in &self.rows {
            let starred = row.iter().any(|entry| entry.best);
            table.add_row(row.iter().enumerate().map(|(place, entry)| {
                let text = match (styled, entry.best, starred && place >= self.texts) {
                    (false, true, _) => format!("{}*", entry.text),
                    // The digits of a row stay below each other.
                    (false, false, true) => format!("{} ", entry.text),
                    _ => entry.text.clone(),
                };
                let cell = aligned(place, &text);
                match (styled, entry) {
                    (true, Entry { best: true, .. }) => {
                        cell.add_attribute(Attribute::Bold).fg(Color::Green)
                    }
                    (true, Entry { failed: true, .. }) => {
                        cell.add_attribute(Attribute::Bold).fg(Color::Red)
                    }
                    _ => cell,
                }
            }));
        }
        table.to_string()
    }

    /// In Markdown, line by line: what is set off is bold.
    pub(super) fn markdown(&self) -> Vec<String> {
        let texts = self.header.iter().map(|text| escape(text));
        let figures = self.header.len() - self.texts;
        let mut lines = vec![
            line(texts),
            format!("|{}{}", "---|".repeat(self.texts), "--:|".repeat(figures)),
        ];
        lines.extend(self.rows.iter().map(|row| {
            line(row.iter().map(|entry| {
                let text = escape(&entry.text);
                if entry.best {
                    format!("**{text}**")
                } else {
                    text
                }
            }))
        }));
        lines
    }
}

fn line(fields: impl Iterator<Item = String>) -> String {
    let line = fields.fold("|".to_owned(), |line, field| line + " " + &field + " |");
    line.replace("|  |", "| |")
}

/// Keeps text from ending a table cell.
pub(super) fn escape(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}
