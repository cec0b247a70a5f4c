//! A table of texts, and how it looks on a terminal and in Markdown.

use std::ops::Range;

use super::escape::{markdown as escape, printable};
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

/// How tables look.
#[derive(Clone, Copy, Debug, Default)]
pub struct Look {
    /// Whether the best is set off by colour; else it has a star.
    pub styled: bool,
    /// Letters that fit on a line; any number if it is not a terminal that reads.
    pub width: Option<usize>,
}

/// Letters that a column takes beside its text: a border, and a space on either side.
const AROUND: usize = 3;

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
    /// For the terminal: what is set off is coloured if it is to be, else marked with a star. A
    /// table that is too wide is cut into several, each with the texts at its left.
    pub(super) fn terminal(&self, look: Look) -> String {
        let grid = self.printable();
        let parts = grid.parts(look.width);
        let tables: Vec<String> = parts
            .into_iter()
            .map(|figures| grid.table(figures, look.styled))
            .collect();
        tables.join("\n")
    }

    /// The same with texts that a terminal can show.
    fn printable(&self) -> Self {
        let entry = |entry: &Entry| Entry {
            text: printable(&entry.text).into_owned(),
            ..*entry
        };
        let header = self.header.iter();
        let rows = self.rows.iter();
        Self {
            texts: self.texts,
            header: header.map(|text| printable(text).into_owned()).collect(),
            rows: rows.map(|row| row.iter().map(entry).collect()).collect(),
        }
    }

    /// Which columns of figures stand in one table, if no table may be wider than `width`.
    fn parts(&self, width: Option<usize>) -> Vec<Range<usize>> {
        let columns = self.header.len();
        let Some(width) = width else {
            return std::iter::once(self.texts..columns).collect();
        };
        let letters = |text: &str| text.chars().count();
        let width_of = |place: usize| {
            let starred = |row: &[Entry]| usize::from(row.iter().any(|entry| entry.best));
            let rows = self.rows.iter().filter_map(|row| {
                let star = if place < self.texts { 0 } else { starred(row) };
                Some(letters(&row.get(place)?.text) + star)
            });
            rows.chain([letters(&self.header[place])])
                .max()
                .unwrap_or(0)
                + AROUND
        };
        let left = 1 + (0..self.texts).map(width_of).sum::<usize>();
        let (mut parts, mut start, mut used) = (Vec::new(), self.texts, left);
        for place in self.texts..columns {
            let more = width_of(place);
            // One column is always shown, however narrow the terminal is.
            if used + more > width && place > start {
                parts.push(start..place);
                (start, used) = (place, left);
            }
            used += more;
        }
        parts.push(start..columns);
        parts
    }

    /// A table of the texts and some columns of figures.
    fn table(&self, figures: Range<usize>, styled: bool) -> String {
        let mut table = Table::new();
        table.load_style(presets::UTF8_FULL_CONDENSED);
        if styled {
            table.enforce_styling();
        } else {
            table.force_no_tty();
        }
        let shown = |place: &usize| *place < self.texts || figures.contains(place);
        let aligned = |place: usize, text: &str| {
            let cell = TableCell::new(text);
            if place < self.texts {
                cell
            } else {
                cell.set_alignment(CellAlignment::Right)
            }
        };
        let header = self.header.iter().enumerate();
        let header = header.filter(|(place, _)| shown(place));
        table.set_header(header.map(|(place, text)| aligned(place, text)));
        for row in &self.rows {
            let starred = row.iter().any(|entry| entry.best);
            let entries = row.iter().enumerate().filter(|(place, _)| shown(place));
            table.add_row(entries.map(|(place, entry)| {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wide_table_is_cut_where_the_terminal_ends() {
        let names = ["", "mmp", "ich", "fwp-mmp{k=200}", "vtp"];
        let row = |label: &str| {
            let figures = (1..5).map(|i| Entry {
                best: i == 4,
                ..Entry::plain(format!("{label}{i}"))
            });
            std::iter::once(Entry::plain(label))
                .chain(figures)
                .collect()
        };
        let grid = Grid {
            texts: 1,
            header: names.map(str::to_owned).to_vec(),
            rows: vec![row("Time"), row("Windows")],
        };
        let look = |width| Look {
            styled: false,
            width,
        };
        let whole = grid.terminal(look(None));
        let widest = whole
            .lines()
            .map(|line| line.chars().count())
            .max()
            .unwrap();
        assert_eq!(grid.terminal(look(Some(widest))), whole);
        insta::assert_snapshot!(grid.terminal(look(Some(widest - 1))));
        for width in 0..widest {
            let text = grid.terminal(look(Some(width)));
            // Nothing is lost, and nothing is wider than it must be.
            for name in names {
                assert!(text.contains(name), "{text}");
            }
            let fits = text
                .lines()
                .all(|line| line.chars().count() <= width.max(30));
            assert!(fits, "{width}:\n{text}");
        }
    }
}
