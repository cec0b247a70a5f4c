//! Tables for the terminal.

use comfy_table::{
    Attribute, Cell as Field, CellAlignment, Color, ContentArrangement, Table as Layout, presets,
};

use super::escape::printable;
use super::model::{Entry, Mark, Part, Table};

/// The style of tables.
#[derive(Clone, Copy, Debug, Default)]
pub struct Look {
    /// Whether colour marks the best; else a star does.
    pub styled: bool,
    /// Columns of the terminal; unlimited if the output is not a terminal.
    pub width: Option<usize>,
}

/// Width of a column without its text: a border, and a space on either side.
const AROUND: usize = 3;

/// Title and caption, followed by an empty line; empty without both.
pub(super) fn heading(title: &str, caption: &str) -> String {
    let lines = [title, caption].into_iter().flat_map(|t| t.trim().lines());
    let lines: Vec<_> = lines.map(printable).collect();
    match lines.join("\n") {
        text if text.is_empty() => text,
        text => text + "\n\n",
    }
}

/// Heading and parts.
pub(super) fn table(table: &Table, look: Look) -> String {
    let parts = table.parts.iter().map(|part| self::part(table, part, look));
    heading(&table.title, &table.caption) + &parts.collect::<String>()
}

/// A part under its title, with its notes, followed by an empty line.
pub(super) fn part(table: &Table, part: &Part, look: Look) -> String {
    let mut lines = vec![format!("{}  ({})", printable(&part.title), part.detail)];
    if !part.refused {
        if !part.sources.is_empty() {
            lines[0] += "  ";
            lines[0] += &part.sources;
        }
        lines.push(grid(table, &part.rows, look));
    }
    let notes = part.notes.iter();
    lines.extend(notes.map(|note| format!("  {}", printable(&note.text))));
    lines.join("\n") + "\n\n"
}

/// Some rows of a table. Columns of numbers without an entry are left out. If the columns are too
/// wide, there are several grids, each with the leading columns of texts.
pub(super) fn grid(table: &Table, rows: &[Vec<Entry>], look: Look) -> String {
    let columns = &table.columns;
    let leading = columns.iter().take_while(|c| !c.numeric).count();
    let used = |place: &usize| rows.iter().any(|row| !row[*place].text.is_empty());
    let figures: Vec<usize> = (leading..columns.len()).filter(used).collect();
    let letters = |text: &str| printable(text).chars().count();
    let width_of = |place: usize| {
        let entries = rows.iter().map(|row| {
            let starred = columns[place].numeric && row.iter().any(Entry::is_best);
            letters(&row[place].text) + usize::from(starred)
        });
        let widest = entries.chain([letters(&columns[place].head)]).max();
        widest.unwrap_or(0) + AROUND
    };
    let left = 1 + (0..leading).map(width_of).sum::<usize>();
    let (mut grids, mut end): (Vec<Vec<usize>>, _) = (vec![(0..leading).collect()], left);
    for place in figures {
        let last = grids.len() - 1;
        end += width_of(place);
        // A grid has one column of figures at least, however narrow the terminal is.
        if look.width.is_some_and(|width| end > width) && grids[last].len() > leading {
            grids.push((0..leading).chain([place]).collect());
            end = left + width_of(place);
        } else {
            grids[last].push(place);
        }
    }
    let grids = grids.iter().map(|places| some(table, rows, places, look));
    grids.collect::<Vec<_>>().join("\n")
}

/// Some columns of some rows.
fn some(table: &Table, rows: &[Vec<Entry>], places: &[usize], look: Look) -> String {
    let mut layout = layout(look);
    layout.load_style(presets::UTF8_FULL_CONDENSED);
    let field = |place: usize, text: &str| {
        let field = Field::new(printable(text));
        if table.columns[place].numeric {
            field.set_alignment(CellAlignment::Right)
        } else {
            field
        }
    };
    let heads = places.iter().map(|&p| field(p, &table.columns[p].head));
    layout.set_header(heads);
    for row in rows {
        let starred = !look.styled && row.iter().any(Entry::is_best);
        layout.add_row(places.iter().map(|&place| {
            let entry = &row[place];
            let star = match (starred && table.columns[place].numeric, entry.mark) {
                (false, _) => "",
                (true, Mark::Best) => "*",
                // Keeps the digits of a column aligned.
                (true, _) => " ",
            };
            let field = field(place, &format!("{}{star}", entry.text));
            match entry.mark {
                Mark::Best if look.styled => field.add_attribute(Attribute::Bold).fg(Color::Green),
                Mark::Failed if look.styled => field.add_attribute(Attribute::Bold).fg(Color::Red),
                _ => field,
            }
        }));
    }
    layout.to_string()
}

/// All rows without rules. Longer texts are wrapped at the width of the terminal.
pub(crate) fn listing(table: &Table, look: Look) -> String {
    let mut layout = layout(look);
    layout.load_style(presets::NOTHING);
    layout.set_content_arrangement(ContentArrangement::Dynamic);
    if let Some(width) = look.width {
        layout.set_width(u16::try_from(width).unwrap_or(u16::MAX));
    }
    let heads = || table.columns.iter().map(|column| &column.head);
    if heads().any(|head| !head.is_empty()) {
        layout.set_header(heads());
    }
    for row in table.rows() {
        layout.add_row(row.iter().map(|entry| &entry.text));
    }
    layout.trim_fmt() + "\n"
}

fn layout(look: Look) -> Layout {
    let mut layout = Layout::new();
    if look.styled {
        layout.enforce_styling();
    } else {
        layout.force_no_tty();
    }
    layout
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::Column;

    #[test]
    fn a_wide_table_is_cut_where_the_terminal_ends() {
        let names = ["", "mmp", "ich", "fwp-mmp{k=200}", "vtp"];
        let row = |label: &str| {
            let figures = (1..5).map(|i| {
                let mark = if i == 4 { Mark::Best } else { Mark::None };
                Entry::marked(format!("{label}{i}"), mark)
            });
            std::iter::once(Entry::new(label)).chain(figures).collect()
        };
        let rows = vec![row("Time"), row("Windows")];
        let mut columns = names.map(Column::number).to_vec();
        columns[0].numeric = false;
        let table = Table::new(columns, rows.clone());
        let grid = |width| {
            let styled = false;
            grid(&table, &rows, Look { styled, width })
        };
        let whole = grid(None);
        let widest = whole
            .lines()
            .map(|line| line.chars().count())
            .max()
            .unwrap();
        assert_eq!(grid(Some(widest)), whole);
        insta::assert_snapshot!(grid(Some(widest - 1)));
        for width in 0..widest {
            let text = grid(Some(width));
            // Nothing is lost, and no line is longer than necessary.
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
