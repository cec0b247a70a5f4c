//! Tables for the terminal.

use comfy_table::{
    Attribute, Cell as Field, CellAlignment, Color, ColumnConstraint, ContentArrangement,
    Table as Layout, Width, presets,
};
use geobench_export::escape::printable;

use crate::table::model::{Entry, Mark, Part, Table};

/// The style of tables.
#[derive(Clone, Copy, Debug, Default)]
pub struct Look {
    /// Whether colour marks the best entries; otherwise a star does.
    pub styled: bool,
    /// The width of the terminal in characters; `None` if there is no limit.
    pub width: Option<usize>,
}

/// The width of a column in addition to its text: a border, and a space on either side.
const AROUND: usize = 3;

/// Title and caption, followed by an empty line; empty without both.
pub(super) fn heading(title: &str, caption: &str, look: Look) -> String {
    let lines = [title, caption].into_iter().flat_map(|t| t.trim().lines());
    let lines: Vec<_> = lines
        .map(|line| line_in(look, "", &printable(line)))
        .collect();
    match lines.join("\n") {
        text if text.is_empty() => text,
        text => text + "\n\n",
    }
}

/// Heading and parts; parts without titles are one grid.
pub(super) fn table(table: &Table, look: Look) -> String {
    if table.titles.is_none() {
        let rows: Vec<Vec<Entry>> = table.rows().cloned().collect();
        return heading(&table.title, &table.caption, look) + &grid(table, &rows, look) + "\n\n";
    }
    let parts = table.parts.iter().map(|part| self::part(table, part, look));
    heading(&table.title, &table.caption, look) + &parts.collect::<String>()
}

/// A part under its title, with its notes, followed by an empty line.
pub(super) fn part(table: &Table, part: &Part, look: Look) -> String {
    let mut lines = vec![format!("{}  ({})", printable(&part.title), part.detail)];
    if !part.refused && !part.sources.is_empty() {
        lines[0] += "  ";
        lines[0] += &part.sources;
    }
    lines[0] = line_in(look, "", &lines[0]);
    if !part.refused {
        lines.push(grid(table, &part.rows, look));
    }
    let notes = part.notes.iter();
    lines.extend(notes.map(|note| line_in(look, "  ", &printable(&note.text))));
    lines.join("\n") + "\n\n"
}

/// `text` after `indent`, wrapped between words if it is too long for the terminal. Lines after the
/// first are indented by two more columns.
pub(super) fn line_in(look: Look, indent: &str, text: &str) -> String {
    let letters = |text: &str| text.chars().count();
    let Some(width) = look.width.filter(|w| letters(indent) + letters(text) > *w) else {
        return format!("{indent}{text}");
    };
    let lines = wrapped(text, width.saturating_sub(letters(indent) + 2));
    format!("{indent}{}", lines.join(&format!("\n{indent}  ")))
}

/// `text` in lines of at most `width` characters. A longer word is a line of its own.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// The number of characters of the longest word.
fn longest_word(text: &str) -> usize {
    let words = text.split_whitespace().map(|word| word.chars().count());
    words.max().unwrap_or(0)
}

/// Rows of a table as a grid that fits the terminal. Columns of numbers without any entry are left
/// out.
///
/// If the columns are too wide, the leading columns of text are wrapped, and the columns of numbers
/// are distributed over several grids, each with the leading columns. If not even one column of
/// numbers fits beside them, each column of numbers becomes a block of lines.
pub(super) fn grid(table: &Table, rows: &[Vec<Entry>], look: Look) -> String {
    let columns = &table.columns;
    let leading = columns.iter().take_while(|c| !c.numeric).count();
    let used = |column: &usize| rows.iter().any(|row| !row[*column].text.is_empty());
    let figures: Vec<usize> = (leading..columns.len()).filter(used).collect();
    let letters = |text: &str| printable(text).chars().count();
    let width_of = |column: usize| {
        let entries = rows.iter().map(|row| {
            let starred = columns[column].numeric && row.iter().any(Entry::is_best);
            letters(&row[column].text) + usize::from(starred)
        });
        let widest = entries.chain([letters(&columns[column].head)]).max();
        widest.unwrap_or(0) + AROUND
    };
    let widths: Vec<usize> = (0..columns.len()).map(width_of).collect();
    // The least width of a leading column is that of its longest word.
    let least = |column: usize| {
        let texts = rows.iter().map(|row| row[column].text.as_str());
        let texts = texts.chain([columns[column].head.as_str()]);
        texts
            .map(|text| longest_word(&printable(text)))
            .max()
            .unwrap_or(0)
            + AROUND
    };
    let natural: usize = widths[..leading].iter().sum();
    let narrowest: usize = (0..leading).map(least).sum();
    let grids_with = |texts: usize| {
        let left = 1 + texts;
        let (mut grids, mut end): (Vec<Vec<usize>>, _) = (vec![(0..leading).collect()], left);
        for &column in &figures {
            let last = grids.len() - 1;
            end += widths[column];
            // A grid has at least one column of figures, even in a narrow terminal.
            if look.width.is_some_and(|width| end > width) && grids[last].len() > leading {
                grids.push((0..leading).chain([column]).collect());
                end = left + widths[column];
            } else {
                grids[last].push(column);
            }
        }
        grids
    };
    let widest_figure = figures
        .iter()
        .map(|&column| widths[column])
        .max()
        .unwrap_or(0);
    let fits = |texts: usize| look.width.is_none_or(|w| 1 + texts + widest_figure <= w);
    if !fits(narrowest) {
        return blocks(table, rows, &figures, leading, look);
    }
    // Leading texts are wrapped if this reduces the number of grids. They are as wide as that
    // number allows.
    let (mut texts, mut grids) = (natural, grids_with(natural));
    if grids.len() > 1 || !fits(natural) {
        let fewest = grids_with(narrowest).len();
        let mut sizes = (narrowest..=natural).rev();
        let widest = sizes.find(|&size| fits(size) && grids_with(size).len() == fewest);
        if let Some(widest) = widest.filter(|_| fewest < grids.len() || !fits(natural)) {
            (texts, grids) = (widest, grids_with(widest));
        }
    }
    let mut rows = rows.to_vec();
    let mut surplus = natural - texts;
    for column in (0..leading).rev() {
        let cut = surplus.min(widths[column] - least(column));
        surplus -= cut;
        if cut > 0 {
            let width = widths[column] - cut - AROUND;
            for row in &mut rows {
                row[column].text = wrapped(&printable(&row[column].text), width).join("\n");
            }
        }
    }
    let grids = grids.iter().map(|shown| some(table, &rows, shown, look));
    grids.collect::<Vec<_>>().join("\n")
}

/// A block of lines for each column of figures: its head, and a line for each row.
fn blocks(
    table: &Table,
    rows: &[Vec<Entry>],
    figures: &[usize],
    leading: usize,
    look: Look,
) -> String {
    let block = |&column: &usize| {
        let head = line_in(look, "", &printable(&table.columns[column].head));
        let lines = rows.iter().filter(|row| !row[column].text.is_empty());
        let lines = lines.map(|row| {
            let labels = row[..leading].iter().map(|entry| entry.text.as_str());
            let labels: Vec<&str> = labels.filter(|label| !label.is_empty()).collect();
            let label = match labels.join(", ") {
                label if label.is_empty() => label,
                label => label + ": ",
            };
            let star = if row[column].is_best() { "*" } else { "" };
            let text = format!("{label}{}{star}", row[column].text);
            line_in(look, "  ", &printable(&text))
        });
        std::iter::once(head).chain(lines).collect::<Vec<_>>()
    };
    figures
        .iter()
        .flat_map(block)
        .collect::<Vec<_>>()
        .join("\n")
}

/// A grid of some columns of the rows.
fn some(table: &Table, rows: &[Vec<Entry>], shown: &[usize], look: Look) -> String {
    let mut layout = layout(look);
    layout.load_style(presets::UTF8_FULL_CONDENSED);
    let field = |column: usize, text: &str| {
        // Wrapped texts have several lines.
        let lines: Vec<_> = text.split('\n').map(printable).collect();
        let field = Field::new(lines.join("\n"));
        if table.columns[column].numeric {
            field.set_alignment(CellAlignment::Right)
        } else {
            field
        }
    };
    let heads = shown.iter().map(|&p| field(p, &table.columns[p].head));
    layout.set_header(heads);
    for row in rows {
        let starred = !look.styled && row.iter().any(Entry::is_best);
        layout.add_row(shown.iter().map(|&column| {
            let entry = &row[column];
            let star = match (starred && table.columns[column].numeric, entry.mark) {
                (false, _) => "",
                (true, Mark::Best) => "*",
                // The space keeps the digits of a column aligned.
                (true, _) => " ",
            };
            let field = field(column, &format!("{}{star}", entry.text));
            match entry.mark {
                Mark::Best if look.styled => field.add_attribute(Attribute::Bold).fg(Color::Green),
                Mark::Failed if look.styled => field.add_attribute(Attribute::Bold).fg(Color::Red),
                _ => field,
            }
        }));
    }
    layout.to_string()
}

/// All rows without borders. Texts are wrapped to the width of the terminal.
pub fn listing(table: &Table, look: Look) -> String {
    let mut layout = layout(look);
    layout.load_style(presets::NOTHING);
    layout.set_content_arrangement(ContentArrangement::Dynamic);
    if let Some(width) = look.width {
        layout.set_width(u16::try_from(width).unwrap_or(u16::MAX));
    }
    let least = |column: usize| {
        let texts = table.rows().map(|row| row[column].text.as_str());
        let texts = texts.chain([table.columns[column].head.as_str()]);
        let longest = texts.map(longest_word).max().unwrap_or(0);
        ColumnConstraint::LowerBoundary(Width::Fixed(u16::try_from(longest).unwrap_or(u16::MAX)))
    };
    let heads = || table.columns.iter().map(|column| &column.head);
    if heads().any(|head| !head.is_empty()) {
        layout.set_header(heads());
    }
    for row in table.rows() {
        layout.add_row(row.iter().map(|entry| &entry.text));
    }
    layout.set_constraints((0..table.columns.len()).map(least));
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
                .all(|line| line.chars().count() <= width.max(14));
            assert!(fits, "{width}:\n{text}");
        }
    }

    /// Long labels and names, at every width from 40 columns on: nothing is lost, no word is
    /// broken and no line is too long.
    #[test]
    fn tables_fit_forty_columns_without_a_broken_word() {
        let names = ["", "mmp", "pvtp{threads=2,simd=scalar}", "vtp-fast"];
        let labels = [
            "Peak memory, papers' count (MB)",
            "Time / that of mmp [95 %]",
        ];
        let rows: Vec<Vec<Entry>> = labels
            .iter()
            .map(|label| {
                let figures = ["100000.300", "1.96 [1.90, 2.10]", "0.300"];
                let figures = figures.iter().enumerate().map(|(i, &text)| {
                    Entry::marked(text, if i == 2 { Mark::Best } else { Mark::None })
                });
                std::iter::once(Entry::new(*label)).chain(figures).collect()
            })
            .collect();
        let mut columns = names.map(Column::number).to_vec();
        columns[0].numeric = false;
        let part = Part {
            title: "a model".to_owned(),
            detail: "V: 48,485, F: 96,966".to_owned(),
            rows,
            notes: vec![super::super::model::Note::new(
                "a remark of some words ".repeat(4),
            )],
            ..Part::default()
        };
        let table = Table::new(columns, Vec::new());
        let shown = |width| {
            let styled = false;
            super::part(&table, &part, Look { styled, width })
        };
        for width in 40..100 {
            let text = shown(Some(width));
            let long = text.lines().find(|line| line.chars().count() > width);
            assert_eq!(long, None, "{width}:\n{text}");
            let found: Vec<&str> = text.split_whitespace().collect();
            let words = labels
                .iter()
                .chain(&names)
                .flat_map(|text| text.split_whitespace());
            for word in words.chain(["100000.300", "remark"]) {
                let is_whole = |w: &&str| w.trim_end_matches([':', '*']) == word;
                assert!(found.iter().any(is_whole), "{width}: {word}:\n{text}");
            }
        }
        insta::assert_snapshot!("forty", shown(Some(40)));
        insta::assert_snapshot!("sixty", shown(Some(60)));
    }
}
