//! What the parent and a child say to each other: one line of JSON each.

use serde::{Deserialize, Serialize};

use crate::exec::{Failure, Observation, Purpose};
use crate::schema::ModelRecord;

/// What the parent asks for.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Order {
    /// Load the model of the command line; always the first. Answered by `Loaded` or `Refused`.
    Load {
        /// What the model is called.
        name: String,
        /// The process that asks; without it, the child has nothing to do.
        parent: u32,
        /// Processors to work on; any if there are none.
        cpus: Vec<usize>,
        /// Most bytes that may be occupied, for the bound that the system keeps.
        memory_limit: Option<u64>,
        /// Bytes that a compressed model may decompress to; the usual number if null.
        max_decompressed: Option<u64>,
    },
    /// Carry out one run. Answered by `Ran`, `RanAgain` or `Failed`.
    Run {
        /// The algorithm, with all that tells it from others.
        algorithm: String,
        /// Number of the source vertex.
        source: u32,
        /// What the run is for.
        purpose: Purpose,
    },
}

/// What a child answers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Reply {
    /// The model is in memory.
    Loaded(Box<ModelRecord>),
    /// The model cannot be used.
    Refused(String),
    /// The run delivered this.
    Ran(Box<Observation>),
    /// The same, with the distances that were sent last: they are not sent again.
    RanAgain(Box<Observation>),
    /// The run delivered nothing.
    Failed(Failure),
}
