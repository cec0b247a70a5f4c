//! The lines of a journal after the first.

use serde::{Deserialize, Serialize};

use crate::run::ledger::{Finding, RunId};
use crate::schema::{InstructionCount, ModelRecord, Session};

/// A line of a journal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[expect(clippy::large_enum_variant, reason = "there is but one at a time")]
pub(super) enum Line {
    /// A process began to work.
    Session(Session),
    /// A model was loaded for the first time.
    Model(ModelRecord),
    /// The instructions of a cell were counted.
    Instructions {
        /// The run that counts in that cell.
        id: RunId,
        /// How many, and of what kind.
        #[serde(flatten)]
        found: InstructionCount,
    },
    /// A run ended.
    Run {
        /// Which.
        id: RunId,
        /// What came of it.
        found: Finding,
    },
}
