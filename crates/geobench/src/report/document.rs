//! What a report holds, whatever it is written as.

use super::chart::Chart;

/// A whole report.
#[derive(Clone, Debug)]
pub(crate) struct Document {
    pub(crate) title: String,
    pub(crate) sections: Vec<Section>,
}

/// A part of a report under a heading of its own.
#[derive(Clone, Debug)]
pub(crate) struct Section {
    /// Unique in the report; letters, digits and hyphens.
    pub(crate) id: String,
    pub(crate) heading: String,
    /// Whether it stands on its own in the table of contents, or belongs to the one before.
    pub(crate) top: bool,
    pub(crate) blocks: Vec<Block>,
}

/// What stands in a section.
#[derive(Clone, Debug)]
pub(crate) enum Block {
    /// A paragraph.
    Text(String),
    /// Names and values.
    Facts(Vec<(String, String)>),
    /// A heading within the section.
    Heading(String),
    /// A table.
    Table(Table),
    /// Plots that stand side by side where there is room.
    Plots(Vec<Plot>),
    /// Remarks, one by one.
    Notes(Vec<Note>),
    /// Files to take away.
    Links(Vec<Link>),
}

/// A remark.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Note {
    pub(crate) text: String,
    /// Whether it says that something failed.
    pub(crate) failure: bool,
}

/// A file to take away.
#[derive(Clone, Debug)]
pub(crate) struct Link {
    pub(crate) label: String,
    /// Where it is: an address relative to the page, or the data itself.
    pub(crate) address: String,
    /// The name under which it is stored.
    pub(crate) file: String,
}

/// A table. Its first column names the rows.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    /// Unique in the report; the name of its file.
    pub(crate) id: String,
    pub(crate) caption: String,
    pub(crate) columns: Vec<Column>,
    pub(crate) parts: Vec<TablePart>,
}

/// A column of a table.
#[derive(Clone, Debug)]
pub(crate) struct Column {
    /// What stands above it and its neighbours that say the same; nothing if empty.
    pub(crate) over: String,
    pub(crate) head: String,
    /// Whether it holds numbers, which are set flush right.
    pub(crate) numeric: bool,
}

/// Rows that belong together.
#[derive(Clone, Debug, Default)]
pub(crate) struct TablePart {
    /// What they have in common; nothing if empty.
    pub(crate) title: String,
    /// What else there is to say of that.
    pub(crate) detail: String,
    pub(crate) rows: Vec<Vec<Entry>>,
}

/// What stands in a row and a column.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Entry {
    pub(crate) text: String,
    pub(crate) mark: Mark,
}

/// What is to be seen of an entry at once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Mark {
    #[default]
    None,
    /// It is the best of its row.
    Best,
    /// It says that something failed.
    Failed,
}

/// A chart with what is said about it.
#[derive(Clone, Debug)]
pub(crate) struct Plot {
    /// Unique in the report; the name of its file.
    pub(crate) id: String,
    /// What it shows, in few words.
    pub(crate) title: String,
    /// What a reader must know to read it.
    pub(crate) caption: String,
    pub(crate) chart: Chart,
}

impl Column {
    pub(crate) fn text(head: &str) -> Self {
        Self {
            over: String::new(),
            head: head.to_owned(),
            numeric: false,
        }
    }

    pub(crate) fn number(head: &str) -> Self {
        Self {
            numeric: true,
            ..Self::text(head)
        }
    }
}

impl Entry {
    pub(crate) fn new(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            mark: Mark::None,
        }
    }
}

impl Document {
    /// Every table, in order.
    pub(crate) fn tables(&self) -> impl Iterator<Item = &Table> {
        self.blocks().filter_map(|block| match block {
            Block::Table(table) => Some(table),
            _ => None,
        })
    }

    /// Every plot, in order.
    pub(crate) fn plots(&self) -> impl Iterator<Item = &Plot> {
        self.blocks()
            .filter_map(|block| match block {
                Block::Plots(plots) => Some(plots),
                _ => None,
            })
            .flatten()
    }

    fn blocks(&self) -> impl Iterator<Item = &Block> {
        self.sections.iter().flat_map(|section| &section.blocks)
    }
}

/// `text` as part of an identifier: its letters and digits in lower case, joined by hyphens.
pub(crate) fn slug(text: &str) -> String {
    let words: Vec<String> = text
        .split(|c: char| !c.is_ascii_alphanumeric())
        .filter(|word| !word.is_empty())
        .map(str::to_ascii_lowercase)
        .collect();
    words.join("-")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_hold_nothing_special() {
        assert_eq!(
            slug("Peak memory, <papers'> & more"),
            "peak-memory-papers-more"
        );
        assert_eq!(slug("\u{fc}\""), "");
    }
}
