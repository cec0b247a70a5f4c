//! Where runs happen: in this process, in child processes, in outside programs or, for tests, not
//! at all.
//!
//! A benchmark knows no algorithm and no clock. It asks a [`Backend`] for a [`Session`] per model,
//! and the session carries out single runs. A [`Listener`] receives the progress.

pub mod affinity;
pub mod expected;
pub mod goal;
pub mod in_process;
#[cfg(feature = "command-line")]
pub mod interrupt;
#[cfg(feature = "command-line")]
pub mod isolate;
pub mod limits;
#[cfg(test)]
pub(crate) mod mock;
pub mod model;
mod protocol;
pub mod slurm;
pub mod source;

use std::sync::{Mutex, MutexGuard, PoisonError};

use geobench_window::Counters;
use serde::{Deserialize, Serialize};

use crate::exec::goal::GoalSpec;
use crate::exec::model::ModelRef;
use crate::exec::source::SourceSpec;
use crate::measure::memory::Peaks;
use crate::registry::Selection;
use crate::schema::{Cell, InstructionCount, ModelRecord, Phases, Status, WavefrontRecord};

/// The value in `mutex`. A panic while it was held has ended its run only.
pub(crate) fn lock<T: ?Sized>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The purpose of a run. Journals hold the names in snake case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Pass {
    /// Warms caches and memory up; not timed.
    #[serde(rename = "warm_up")]
    Warmup,
    /// Times the solve.
    Time,
    /// Counts windows and events.
    Count,
    /// Samples the phases and measures memory.
    #[serde(rename = "clock")]
    Profile,
}

/// One run of one algorithm.
#[derive(Clone, Copy, Debug)]
pub struct Step<'a> {
    /// Name of the model.
    pub model: &'a str,
    /// The algorithm.
    pub algorithm: &'a Selection,
    /// The source, or several together.
    pub source: &'a SourceSpec,
    /// What it is to find. The answer holds the distances of its targets in their order, or of all
    /// vertices, infinite beyond its radius.
    pub goal: &'a GoalSpec,
    /// Its purpose.
    pub pass: Pass,
    /// Solves of a timed run, whose mean is its time; 1 in other runs. Outside programs solve once.
    pub solves: usize,
}

/// Result of one run. Which figures are set depends on the [`Pass`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Observation {
    /// The answer; journals do not hold it.
    #[serde(skip)]
    pub distances: Vec<f64>,
    /// Seconds that the solve took; of several the mean.
    pub seconds: Option<f64>,
    /// Number of solves; `None` is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub solves: Option<usize>,
    /// Seconds between request and answer of an outside program, measured from outside.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outside_seconds: Option<f64>,
    /// Seconds that the set-up took, if this run needed one.
    pub setup_seconds: Option<f64>,
    /// Seconds that the Voronoi diagram took after the solve, for algorithms that keep windows for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extraction_seconds: Option<f64>,
    /// The nearest source of each vertex, by its place among the sources; journals do not hold it.
    #[serde(skip)]
    pub labels: Option<Vec<u32>>,
    /// The counters.
    #[serde(with = "protocol::counters")]
    pub counters: Option<Counters>,
    /// The wavefront at even intervals of the run that counted.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub wavefront: Vec<WavefrontRecord>,
    /// Most by which the distances of the ends of an edge differ beyond its length; of the counted
    /// run of an approximate algorithm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub edge_excess: Option<f64>,
    /// Peak memory.
    pub peaks: Peaks,
    /// Seconds in each phase.
    pub phases: Option<Phases>,
    /// Where the source is, if that is not as it was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

/// Why a run has no result.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Failure {
    /// Status of the cell.
    pub status: Status,
    /// The cause, in one line.
    pub message: String,
}

impl Failure {
    pub(crate) fn new(status: Status, message: impl Into<String>) -> Self {
        Self {
            status,
            message: message.into(),
        }
    }
}

/// Runs algorithms on one loaded model.
pub trait Session: Send {
    /// Record of the model.
    fn model(&self) -> &ModelRecord;

    /// Carries out one run.
    ///
    /// # Errors
    ///
    /// When the run fails, with the status of its cell.
    fn execute(&mut self, step: &Step<'_>) -> Result<Observation, Failure>;
}

/// Loads models and opens sessions.
pub trait Backend: Sync {
    /// Loads `model` and opens a session for it.
    ///
    /// # Errors
    ///
    /// When the model cannot be used.
    fn open<'b>(&'b self, model: &'b ModelRef) -> Result<Box<dyn Session + 'b>, Refusal>;

    /// Opens a further session for a model whose first session has this record. The runs of both
    /// may happen at the same time.
    ///
    /// # Errors
    ///
    /// When the model cannot be used.
    fn open_further<'b>(
        &'b self,
        model: &'b ModelRef,
        record: &ModelRecord,
    ) -> Result<Box<dyn Session + 'b>, Refusal> {
        let _ = record;
        self.open(model)
    }
}

/// A model that cannot be used.
#[derive(Clone, Debug)]
pub struct Refusal {
    /// The cause, in one line that names the file and the element.
    pub message: String,
}

/// Counts the instructions of the solve of a cell.
pub type InstructionCounter =
    Box<dyn FnOnce(&ModelRecord, &Cell) -> anyhow::Result<InstructionCount>>;

/// Receives progress. No method is called while a run is timed, unless several cells run at the
/// same time.
pub trait Listener: Send {
    /// A model is about to be loaded.
    fn loading(&mut self, model: &str) {
        let _ = model;
    }

    /// A run is about to start.
    fn step(&mut self, step: &Step<'_>) {
        let _ = step;
    }

    /// A run has ended, now or in an earlier process that wrote the journal: the status of a
    /// failure, or the seconds of a timed run.
    fn ran(&mut self, step: &Step<'_>, outcome: Result<Option<f64>, Status>) {
        let _ = (step, outcome);
    }

    /// Whether to stop. Then no run starts, finished runs are kept, and a run that the interruption
    /// ended does not count as failed.
    fn interrupted(&self) -> bool {
        false
    }

    /// The instructions of the solve of a cell that ended well are about to be counted: by what is
    /// returned, or not at all.
    fn instruction_counter(
        &mut self,
        model: &ModelRecord,
        cell: &Cell,
    ) -> Option<InstructionCounter> {
        let _ = (model, cell);
        None
    }

    /// The instructions of a cell could not be counted.
    fn not_counted(&mut self, cell: &Cell, error: &anyhow::Error) {
        let _ = (cell, error);
    }

    /// Runs that were not planned: of the vertices of a model that has become known, or beyond the
    /// fewest timed runs of a cell.
    fn more(&mut self, runs: usize) {
        let _ = runs;
    }

    /// Planned runs that will not happen.
    fn skipped(&mut self, runs: usize) {
        let _ = runs;
    }

    /// All cells of a model are done; `cells` are the last of them.
    ///
    /// # Errors
    ///
    /// Ends the benchmark with the results so far.
    fn model_done(&mut self, model: &ModelRecord, cells: &[Cell]) -> anyhow::Result<()> {
        let _ = (model, cells);
        Ok(())
    }
}
