//! The subjects of the claims, for the summary at the top of the page.

use std::path::Path;

use geobench_harness::usage::document::TomlDocument;
use serde::Deserialize;

use super::cases::is_like;

/// What several claims are about.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Topic {
    /// What the papers say, in a few words.
    pub(super) says: String,
    /// Why it matters to who chooses an algorithm.
    pub(super) matters: String,
    /// The ids of its claims; `*` stands for any text. A claim belongs to the first topic that
    /// names it.
    claims: Vec<String>,
}

impl Topic {
    pub(super) fn is_of(&self, id: &str) -> bool {
        self.claims.iter().any(|pattern| is_like(pattern, id))
    }
}

/// The topics, in the order of the page.
pub(super) fn topics() -> Vec<Topic> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct File {
        topic: Vec<Topic>,
    }
    let text = include_str!("../../papers/topics.toml");
    let document = TomlDocument::new(Path::new("bench-configs/papers/topics.toml"), text);
    let file = document
        .parse()
        .and_then(|table| document.read::<File>(table));
    // A test reads the file.
    file.map_or_else(|_| Vec::new(), |file| file.topic)
}
