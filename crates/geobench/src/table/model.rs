//! The one model of a table. What tables show is decided where they are built; every form is
//! written from here.

/// Rows of entries under columns, in parts.
#[derive(Clone, Debug, Default)]
pub(crate) struct Table {
    /// Unique in a report, where it names the file of the table.
    pub(crate) id: String,
    /// Its heading; nothing if empty.
    pub(crate) title: String,
    /// What it shows, in one or several lines; nothing if empty.
    pub(crate) caption: String,
    pub(crate) columns: Vec<Column>,
    /// The head of a column for the titles of parts, in forms that set all parts under one head;
    /// without it they stand in rows of their own.
    pub(crate) titles: Option<&'static str>,
    pub(crate) parts: Vec<Part>,
}

/// A column of a table.
#[derive(Clone, Debug, Default)]
pub(crate) struct Column {
    /// What stands above it and its neighbours that say the same; nothing if empty.
    pub(crate) over: String,
    /// With the unit, if all its entries have the same.
    pub(crate) head: String,
    /// Whether it holds numbers, which are set flush right.
    pub(crate) numeric: bool,
}

/// Rows that belong together.
#[derive(Clone, Debug, Default)]
pub(crate) struct Part {
    /// What they have in common; nothing if empty.
    pub(crate) title: String,
    /// How large that is, or what else belongs to the title; nothing if empty.
    pub(crate) detail: String,
    /// Which sources the figures are of; nothing if empty.
    pub(crate) sources: String,
    /// Whether there is no figure because all failed for the same reason.
    pub(crate) refused: bool,
    /// As many entries in each row as there are columns.
    pub(crate) rows: Vec<Vec<Entry>>,
    /// What else a reader must know.
    pub(crate) notes: Vec<Note>,
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

/// A remark.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Note {
    pub(crate) text: String,
    /// Whether it says that something failed.
    pub(crate) failure: bool,
}

impl Table {
    /// A table of one part without a title.
    pub(crate) fn new(columns: Vec<Column>, rows: Vec<Vec<Entry>>) -> Self {
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

    /// What stands above the columns, with the number of columns that it spans; nothing if nothing
    /// stands there.
    pub(super) fn overs(&self) -> Vec<(&str, usize)> {
        let groups = self.columns.chunk_by(|a, b| a.over == b.over);
        let overs: Vec<_> = groups.map(|c| (c[0].over.as_str(), c.len())).collect();
        match overs[..] {
            [("", _)] => Vec::new(),
            _ => overs,
        }
    }
}

impl Column {
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
    /// What belongs to the title.
    pub(super) fn details(&self) -> String {
        // Of what was refused the sources say nothing.
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
    pub(crate) fn new(text: impl Into<String>) -> Self {
        Self::marked(text, Mark::None)
    }

    pub(crate) fn marked(text: impl Into<String>, mark: Mark) -> Self {
        Self {
            text: text.into(),
            mark,
        }
    }

    pub(super) fn is_best(&self) -> bool {
        self.mark == Mark::Best
    }
}

impl Note {
    /// A remark that says nothing of a failure.
    pub(crate) fn new(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            failure: false,
        }
    }
}
