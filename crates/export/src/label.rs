//! The names of sources and targets in files.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The name of a source, or of several sources that a run starts from together. In files it is a
/// number if it is one vertex, else a string.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(untagged, expecting = "a vertex number or a text is expected")]
pub enum SourceLabel {
    /// A vertex, numbered from 0 in the order of the file.
    Vertex(u32),
    /// A point that is not a vertex, or several sources, in the notation of the command line.
    Other(String),
}

impl SourceLabel {
    /// The vertex, if the source is one vertex.
    pub const fn vertex(&self) -> Option<u32> {
        match self {
            Self::Vertex(vertex) => Some(*vertex),
            Self::Other(_) => None,
        }
    }

    /// The source as text for messages.
    pub fn in_words(&self) -> String {
        match self {
            Self::Vertex(vertex) => format!("vertex {vertex}"),
            Self::Other(text) => text.clone(),
        }
    }
}

impl From<u32> for SourceLabel {
    fn from(vertex: u32) -> Self {
        Self::Vertex(vertex)
    }
}

impl fmt::Display for SourceLabel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Vertex(vertex) => write!(f, "{vertex}"),
            Self::Other(text) => f.write_str(text),
        }
    }
}
