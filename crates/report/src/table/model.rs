//! The data model of a table. Builders such as `results` fill it in; every output format is written
//! from it.

/// A table: rows of entries under columns, in parts.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// An identifier that is unique in a report, and the name of the table's file.
    pub(crate) id: String,
    /// The heading.
    pub(crate) title: String,
    /// A description, in one or several lines.
    pub(crate) caption: String,
    pub(crate) columns: Vec<Column>,
    /// The subject of a row, by which pages filter: `algorithm`, `model` or empty.
    pub(crate) rows_are: &'static str,
    /// Whether the columns after the first are algorithms, by which pages filter.
    pub(crate) columns_are_algorithms: bool,
    /// Header of the column of part titles; `None`: one title row per part.
    pub(crate) titles: Option<&'static str>,
    pub(crate) parts: Vec<Part>,
}

/// A column of a table.
#[derive(Clone, Debug, Default)]
pub struct Column {
    /// A second head above the column's own. Neighbouring columns with the same text share it.
    pub(crate) over: String,
    /// The head, with the unit if all entries share one.
    pub(crate) head: String,
    /// Whether the entries are numbers, which are aligned right.
    pub(crate) numeric: bool,
}

/// Rows that belong together.
#[derive(Clone, Debug, Default)]
pub struct Part {
    /// The title, such as the name of a model.
    pub(crate) title: String,
    /// An addition to the title, such as the size of the model.
    pub(crate) detail: String,
    /// The sources of the figures, in words.
    pub(crate) sources: String,
    /// Whether the model was refused, so that there are no figures.
    pub(crate) refused: bool,
    /// Whether the rows summarise those of the parts before.
    pub(crate) is_foot: bool,
    /// The rows, with one entry per column.
    pub(crate) rows: Vec<Vec<Entry>>,
    /// Remarks below the rows.
    pub(crate) notes: Vec<Note>,
}

/// The content of a table cell.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Entry {
    pub(crate) text: String,
    pub(crate) mark: Mark,
    /// The intensity of the background on pages, from 1, the best, to [`Self::HOTTEST`]; 0 for
    /// none.
    pub(crate) heat: u8,
    /// The address that the text links to on pages.
    pub(crate) link: Option<String>,
}

/// The emphasis of an entry.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mark {
    /// No emphasis.
    #[default]
    None,
    /// The best of its row.
    Best,
    /// A failure.
    Failed,
}

/// A remark.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    pub(crate) text: String,
    /// Whether it reports a failure.
    pub(crate) failure: bool,
}

impl Table {
    /// A table of one part without a title.
    pub fn new(columns: Vec<Column>, rows: Vec<Vec<Entry>>) -> Self {
        Self {
            columns,
            parts: vec![Part {
                rows,
                ..Part::default()
            }],
            ..Self::default()
        }
    }

    /// All rows.
    pub(super) fn rows(&self) -> impl Iterator<Item = &Vec<Entry>> {
        self.parts.iter().flat_map(|part| &part.rows)
    }

    /// The second heads, each with the number of columns that it spans. Empty if there are none.
    pub(super) fn second_heads(&self) -> Vec<(&str, usize)> {
        let groups = self.columns.chunk_by(|a, b| a.over == b.over);
        let second_heads: Vec<_> = groups.map(|c| (c[0].over.as_str(), c.len())).collect();
        match second_heads[..] {
            [("", _)] => Vec::new(),
            _ => second_heads,
        }
    }
}

impl Column {
    /// Columns of texts, followed by columns of numbers.
    pub fn of(
        texts: impl IntoIterator<Item: AsRef<str>>,
        numbers: impl IntoIterator<Item: AsRef<str>>,
    ) -> Vec<Self> {
        let texts = texts.into_iter().map(|head| Self::text(head.as_ref()));
        let numbers = numbers.into_iter().map(|head| Self::number(head.as_ref()));
        texts.chain(numbers).collect()
    }

    pub(crate) fn text(head: &str) -> Self {
        Self {
            head: head.to_owned(),
            ..Self::default()
        }
    }

    pub(crate) fn number(head: &str) -> Self {
        Self {
            numeric: true,
            ..Self::text(head)
        }
    }
}

impl Part {
    /// The additions to the title.
    pub(super) fn details(&self) -> String {
        // A refused model has no figures, so the sources are left out.
        let sources = if self.refused { "" } else { &self.sources };
        let details = [self.detail.as_str(), sources].into_iter();
        let details: Vec<&str> = details.filter(|text| !text.is_empty()).collect();
        details.join("; ")
    }

    /// The sources and the notes.
    pub(super) fn remarks(&self) -> impl Iterator<Item = &str> {
        let notes = self.notes.iter().map(|note| note.text.as_str());
        let texts = std::iter::once(self.sources.as_str()).chain(notes);
        texts.filter(|text| !text.is_empty())
    }
}

impl Entry {
    /// An entry without emphasis.
    pub fn new(text: impl Into<String>) -> Self {
        Self::marked(text, Mark::None)
    }

    pub(crate) fn marked(text: impl Into<String>, mark: Mark) -> Self {
        Self {
            text: text.into(),
            mark,
            ..Self::default()
        }
    }

    /// An entry that links to an address on pages.
    pub(crate) fn linked(text: impl Into<String>, address: impl Into<String>) -> Self {
        Self {
            link: Some(address.into()),
            ..Self::new(text)
        }
    }

    /// The greatest [`Self::heat`].
    pub(super) const HOTTEST: u8 = 6;

    pub(super) fn is_best(&self) -> bool {
        self.mark == Mark::Best
    }
}

impl Note {
    /// A remark that reports no failure.
    pub(crate) fn new(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            failure: false,
        }
    }
}
