//! Execution of runs: in this process, in child processes, in external programs, or by a mock in
//! tests.
//!
//! The benchmark code knows no algorithm and no clock. It asks a [`Backend`] for a [`Session`] per
//! model, and the session executes single runs. A [`Listener`] receives progress.

pub mod affinity;
pub mod expected;
pub mod goal;
pub mod in_process;
#[cfg(unix)]
pub mod instructions;
#[cfg(unix)]
pub mod interrupt;
#[cfg(unix)]
pub mod isolate;
pub mod limits;
#[cfg(any(test, feature = "mock"))]
pub mod mock;
pub mod model;
pub mod point;
pub mod point_files;
mod protocol;
pub mod source;

use geobench_registry::Selection;
use geobench_window::Counters;
use serde::{Deserialize, Serialize};

use crate::exec::goal::GoalSpec;
use crate::exec::model::ModelRef;
use crate::exec::source::SourceSpec;
use crate::measure::memory::Peaks;
use crate::schema::{Cell, InstructionCount, ModelRecord, PhaseSeconds, Status, WavefrontSample};

/// The purpose of a run. Journals store the names in snake case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Pass {
    /// An untimed run that warms up caches and memory.
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
    /// The source, or several sources together.
    pub source: &'a SourceSpec,
    /// The goal. The answer holds the distances of its targets in their order, or of all vertices;
    /// those beyond its radius are infinite.
    pub goal: &'a GoalSpec,
    /// Purpose of the run.
    pub pass: Pass,
    /// Number of solves of a timed run, whose mean is its time; 1 in other runs. External programs
    /// solve once.
    pub solves: usize,
}

/// Result of one run. The [`Pass`] determines which figures are set.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Observation {
    /// The distances; not stored in journals.
    #[serde(skip)]
    pub distances: Vec<f64>,
    /// Seconds of the solve; of several solves the mean.
    pub seconds: Option<f64>,
    /// Number of solves; `None` means one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub solves: Option<usize>,
    /// For an external program: seconds from request to answer by the clock of the harness, under
    /// protocol 2 less `ping_seconds`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outside_seconds: Option<f64>,
    /// For an external program under protocol 2: seconds to answer a ping, the median of several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ping_seconds: Option<f64>,
    /// Seconds of the set-up, if the run included one.
    pub setup_seconds: Option<f64>,
    /// Seconds to extract the Voronoi diagram after the solve. `None` if the algorithm does not
    /// keep the windows for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extraction_seconds: Option<f64>,
    /// For each vertex, the index of its nearest source among the sources; not stored in journals.
    #[serde(skip)]
    pub labels: Option<Vec<u32>>,
    /// The counters.
    #[serde(with = "protocol::counters")]
    pub counters: Option<Counters>,
    /// Samples of the wavefront at even intervals of the counting run.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub wavefront: Vec<WavefrontSample>,
    /// Largest violation of the triangle inequality along an edge, from the counting run of an
    /// approximate algorithm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub edge_excess: Option<f64>,
    /// Peak memory.
    pub peaks: Peaks,
    /// Seconds in each phase.
    pub phases: Option<PhaseSeconds>,
    /// Actual position of the source, if it differs from the requested one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

/// Why a run has no result.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Failure {
    /// Status of the cell.
    pub status: Status,
    /// The cause, as a single line.
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

    /// Executes one run.
    ///
    /// # Errors
    ///
    /// If the run fails, with the status of its cell.
    fn execute(&mut self, step: &Step<'_>) -> Result<Observation, Failure>;

    /// The connected components of the model, for the check of a run.
    ///
    /// # Errors
    ///
    /// If the model, a source or a target cannot be used.
    fn components(&mut self, step: &Step<'_>) -> Result<Components, Failure>;
}

/// Numbers of connected components.
#[derive(Clone, Debug)]
pub struct Components {
    /// That of each vertex of the model.
    pub vertices: Vec<u32>,
    /// That of each distance of the answer to a step.
    pub places: Vec<u32>,
}

/// Loads models and opens sessions.
pub trait Backend: Sync {
    /// Loads `model` and opens a session for it.
    ///
    /// # Errors
    ///
    /// When the model cannot be used.
    fn open<'b>(&'b self, model: &'b ModelRef) -> Result<Box<dyn Session + 'b>, Refusal>;

    /// Opens another session for a model whose first session returned this record. Both sessions
    /// may run concurrently.
    ///
    /// # Errors
    ///
    /// If the model is unusable.
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
    /// The status of its cells: refused, unless loading exceeded a limit or crashed.
    pub status: Status,
    /// The cause, as a single line that names the file and the element.
    pub message: String,
}

/// Counts the instructions of the solve of a cell.
pub type InstructionCounter =
    Box<dyn FnOnce(&ModelRecord, &Cell) -> anyhow::Result<InstructionCount>>;

/// Receives progress. No method is called during a timed run, unless several cells run
/// concurrently.
pub trait Listener: Send {
    /// A model is about to be loaded.
    fn loading(&mut self, model: &str) {
        let _ = model;
    }

    /// A run is about to start.
    fn step(&mut self, step: &Step<'_>) {
        let _ = step;
    }

    /// A run has ended. The outcome is the status of a failure, or the seconds of a timed run. Runs
    /// that an earlier process recorded in the journal are reported, too.
    fn ran(&mut self, step: &Step<'_>, outcome: Result<Option<f64>, Status>) {
        let _ = (step, outcome);
    }

    /// Whether to stop. If true, no further run starts and the completed runs are kept. A run that
    /// the interruption ends does not count as failed.
    fn interrupted(&self) -> bool {
        false
    }

    /// The instructions of a cell that ended well are about to be counted. Returns the function
    /// that counts them; `None` to skip it.
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

    /// The number of planned runs grows: the vertices of a model have become known, or a cell needs
    /// more than the minimum of timed runs.
    fn more(&mut self, runs: usize) {
        let _ = runs;
    }

    /// Planned runs were dropped.
    fn skipped(&mut self, runs: usize) {
        let _ = runs;
    }

    /// All cells of a model are complete; `cells` are the last of them.
    ///
    /// # Errors
    ///
    /// An error ends the benchmark with the results so far.
    fn model_done(&mut self, model: &ModelRecord, cells: &[Cell]) -> anyhow::Result<()> {
        let _ = (model, cells);
        Ok(())
    }
}
