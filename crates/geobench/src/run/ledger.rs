//! What is known of runs that are done: the seam between the runner and the journal.

use serde::{Deserialize, Serialize};

use crate::exec::{Failure, Observation, Purpose};
use crate::schema::{Check, InstructionCount, ModelRecord};

/// A run of a cell: what makes it a different one from all others of a plan.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct RunId {
    /// Name of the group; none if that has none.
    pub group: Option<String>,
    /// Name of the model.
    pub model: String,
    /// The source vertex.
    pub source: u32,
    /// Label of the algorithm.
    pub algorithm: String,
    /// What it is for.
    pub purpose: Purpose,
    /// Which of the runs for that purpose, from 0.
    pub round: usize,
}

/// What came of a run, once its answer has been compared: everything that the cell needs of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// The figures, without the distances.
    pub observation: Observation,
    /// How the distances compared with the reference.
    pub check: Check,
    /// Why there was nothing to compare them with, although there should have been.
    pub unchecked: Option<String>,
    /// Why the cell fails by this run, if it does.
    pub failure: Option<Failure>,
}

/// Remembers what came of runs, so that an interrupted benchmark can go on where it ended.
pub trait Ledger {
    /// What is known about a model.
    fn model(&self, name: &str) -> Option<&ModelRecord>;

    /// What came of a run, if it has been made.
    fn finding(&self, run: &RunId) -> Option<&Finding>;

    /// How many instructions the solve of a cell took, named by the run that counts it, if that is
    /// known.
    fn instructions(&self, run: &RunId) -> Option<&InstructionCount>;

    /// Keeps what is known about a model.
    ///
    /// # Errors
    ///
    /// When it cannot be kept, which ends the benchmark.
    fn keep_model(&mut self, model: &ModelRecord) -> anyhow::Result<()>;

    /// Keeps what came of a run, before the next one starts.
    ///
    /// # Errors
    ///
    /// When it cannot be kept, which ends the benchmark.
    fn keep(&mut self, run: RunId, finding: &Finding) -> anyhow::Result<()>;

    /// Keeps how many instructions the solve of a cell took.
    ///
    /// # Errors
    ///
    /// When it cannot be kept, which ends the benchmark.
    fn keep_instructions(&mut self, run: RunId, found: &InstructionCount) -> anyhow::Result<()>;
}

/// Remembers nothing: every run is made.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoLedger;

impl Ledger for NoLedger {
    fn model(&self, _: &str) -> Option<&ModelRecord> {
        None
    }

    fn finding(&self, _: &RunId) -> Option<&Finding> {
        None
    }

    fn instructions(&self, _: &RunId) -> Option<&InstructionCount> {
        None
    }

    fn keep_model(&mut self, _: &ModelRecord) -> anyhow::Result<()> {
        Ok(())
    }

    fn keep_instructions(&mut self, _: RunId, _: &InstructionCount) -> anyhow::Result<()> {
        Ok(())
    }

    fn keep(&mut self, _: RunId, _: &Finding) -> anyhow::Result<()> {
        Ok(())
    }
}
