//! The content of a report, independent of the output format.

use sha2::{Digest, Sha256};

use super::chart::Chart;
use crate::table::{Note, Table};

/// A whole report.
#[derive(Clone, Debug)]
pub(crate) struct Document {
    pub(crate) title: String,
    pub(crate) sections: Vec<Section>,
}

/// A section of a report, with its heading.
#[derive(Clone, Debug)]
pub(crate) struct Section {
    /// Unique in the report; letters, digits and hyphens.
    pub(crate) id: String,
    pub(crate) heading: String,
    /// Whether it is a top-level section; else it is a subsection of the last top-level one.
    pub(crate) top: bool,
    pub(crate) blocks: Vec<SectionItem>,
}

/// An item of a section.
#[derive(Clone, Debug)]
pub(crate) enum SectionItem {
    /// The outcome of a group, after its name if there are several groups.
    Headline(Option<String>, Headline),
    /// Reasons to doubt the times.
    Warnings(Vec<String>),
    /// A paragraph.
    Text(String),
    /// Prose in the marks of `prose`.
    Prose(String),
    /// Names and values.
    Facts(Vec<(String, String)>),
    /// A heading within the section.
    Heading(String),
    /// A table.
    Table(Table),
    /// A table with a column for each algorithm. HTML pages show it transposed, with a row for
    /// each.
    Figures(Table),
    /// Plots, side by side if there is room.
    Plots(Vec<Plot>),
    /// Further items, which pages show when a reader opens their summary.
    More(String, Vec<SectionItem>),
    /// Remarks, one by one.
    Notes(Vec<Note>),
    /// Downloads.
    Links(Vec<Download>),
}

/// The comparison of two exact algorithms in one sentence.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sentence {
    /// The label of the algorithm that is faster on average.
    pub(crate) faster: String,
    /// The label of the other one.
    pub(crate) slower: String,
    /// Whether it says that the first is the fastest, and the other the next.
    pub(crate) of_next: bool,
    pub(crate) text: String,
}

/// What a group says about the fastest algorithm.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Headline {
    /// Labels of exact algorithms, the fastest first, one for each name.
    pub(crate) ranking: Vec<String>,
    /// The base of ratios, if it is exact.
    pub(crate) base: Option<String>,
    /// The sentences without any selection. The fastest algorithm is compared with the next, and
    /// with the fastest outside program, or with the base if there is none.
    pub(crate) shown: Vec<Sentence>,
    /// Sentences that pages show when some algorithms are hidden.
    pub(crate) others: Vec<Sentence>,
}

/// A download.
#[derive(Clone, Debug)]
pub(crate) struct Download {
    pub(crate) label: String,
    /// A data URL that holds the file.
    pub(crate) address: String,
    /// The name of the downloaded file.
    pub(crate) file: String,
}

/// A chart with its caption.
#[derive(Clone, Debug)]
pub(crate) struct Plot {
    /// Unique in the report; the name of its file.
    pub(crate) id: String,
    /// The title.
    pub(crate) title: String,
    /// How to read it.
    pub(crate) caption: String,
    pub(crate) chart: Chart,
}

impl Plot {
    /// The drawing as SVG. If `alone`, it is a file of its own and includes its style sheet.
    pub(crate) fn draw(&self, alone: bool) -> String {
        self.chart.draw(&self.id, &self.title, &self.caption, alone)
    }
}

impl Document {
    /// Every table, in order.
    pub(crate) fn tables(&self) -> impl Iterator<Item = &Table> {
        self.blocks().filter_map(|block| match block {
            SectionItem::Table(table) | SectionItem::Figures(table) => Some(table),
            _ => None,
        })
    }

    /// Every plot, in order.
    pub(crate) fn plots(&self) -> impl Iterator<Item = &Plot> {
        self.blocks()
            .filter_map(|block| match block {
                SectionItem::Plots(plots) => Some(plots),
                _ => None,
            })
            .flatten()
    }

    fn blocks(&self) -> impl Iterator<Item = &SectionItem> {
        let blocks = self.sections.iter().flat_map(|section| &section.blocks);
        blocks.flat_map(|block| match block {
            SectionItem::More(_, items) => items.as_slice(),
            item => std::slice::from_ref(item),
        })
    }
}

/// `text` as part of an identifier: its letters and digits in lower case, joined by hyphens.
pub(crate) fn slug(text: &str) -> String {
    let words: Vec<String> = text
        .split(|c: char| !c.is_ascii_alphanumeric())
        .filter(|word| !word.is_empty())
        .map(str::to_ascii_lowercase)
        .collect();
    let whole = words.join("-");
    if whole.len() <= LONGEST_SLUG {
        return whole;
    }
    let digest = Sha256::digest(whole.as_bytes());
    let digits = u32::from_be_bytes([digest[0], digest[1], digest[2], digest[3]]);
    format!("{}-{digits:08x}", &whole[..LONGEST_SLUG])
}

/// The most characters of a text in an identifier. Identifiers become names of files.
const LONGEST_SLUG: usize = 100;

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
