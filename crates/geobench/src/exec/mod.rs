//! What a benchmark needs of the world: places to run algorithms in, and somebody who listens.
//!
//! A benchmark knows no algorithm and no clock. It asks a [`Backend`] for each model and the
//! [`Session`] that it gets there for each single run, so that runs can happen in this process,
//! in another one, or, for tests, nowhere at all.

pub mod affinity;
pub mod expected;
pub mod in_process;
pub mod interrupt;
pub mod isolate;
pub mod limits;
#[cfg(test)]
pub(crate) mod mock;
pub mod model;
pub mod outside;
mod protocol;

use geobench_mesh::VertexId;
use geobench_window::Counters;
use serde::{Deserialize, Serialize};

use crate::exec::model::ModelRef;
use crate::measure::memory::Peaks;
use crate::registry::Selection;
use crate::schema::{Cell, InstructionCount, ModelRecord, Phases, Status, WavefrontSample};

/// What a run is for. Journals hold the names in snake case.
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
    /// Clocks the phases and measures memory.
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
    /// The source.
    pub source: VertexId,
    /// What it is for.
    pub pass: Pass,
}

/// What one run delivers; which figures there are depends on its purpose.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Observation {
    /// The answer.
    #[serde(with = "protocol::distances")]
    pub distances: Vec<f64>,
    /// Seconds that the solve took.
    pub seconds: Option<f64>,
    /// Seconds that the set-up took, if this run needed one.
    pub setup_seconds: Option<f64>,
    /// What was counted.
    #[serde(with = "protocol::counters")]
    pub counters: Option<Counters>,
    /// The wavefront at even intervals of the run that counted.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub wavefront: Vec<WavefrontSample>,
    /// Peak memory.
    pub peaks: Peaks,
    /// Seconds in each phase.
    pub phases: Option<Phases>,
}

/// Why a run delivered nothing.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Failure {
    /// How the cell ends with it.
    pub status: Status,
    /// What happened, in one line.
    pub message: String,
}

/// Runs algorithms on the model that it was set up for.
pub trait Session {
    /// Carries out one run.
    ///
    /// # Errors
    ///
    /// When it does not end well.
    fn execute(&mut self, step: &Step<'_>) -> Result<Observation, Failure>;
}

/// Where models are brought to be worked on.
pub trait Backend {
    /// Loads `model` and hands what is known about it to `work`, with an
    /// session for it.
    ///
    /// # Errors
    ///
    /// When the model cannot be used; `work` is then not called.
    fn with_model(
        &mut self,
        model: &ModelRef,
        work: &mut dyn FnMut(&ModelRecord, &mut dyn Session),
    ) -> Result<(), Refusal>;
}

/// A model that cannot be used.
#[derive(Clone, Debug)]
pub struct Refusal {
    /// Why, in one line that names the file and the element.
    pub message: String,
}

/// Hears of the progress of a run. Nothing here is called while a run is being timed.
pub trait Listener {
    /// A model is about to be loaded.
    fn loading(&mut self, model: &str) {
        let _ = model;
    }

    /// A run is about to start.
    fn step(&mut self, step: &Step<'_>) {
        let _ = step;
    }

    /// A run has ended, now or before the benchmark was interrupted: it failed so, or took so many
    /// seconds if it was timed.
    fn ran(&mut self, step: &Step<'_>, outcome: Result<Option<f64>, Status>) {
        let _ = (step, outcome);
    }

    /// Whether to stop: nothing more is started, what is done is kept, and a run that failed
    /// because of it is not blamed.
    fn interrupted(&self) -> bool {
        false
    }

    /// Counts the instructions of the solve of a cell that ended well, if that is asked for and can
    /// be done.
    fn count_instructions(&mut self, model: &ModelRecord, cell: &Cell) -> Option<InstructionCount> {
        let _ = (model, cell);
        None
    }

    /// Runs that were planned will not happen.
    fn skipped(&mut self, runs: usize) {
        let _ = runs;
    }

    /// Everything about a model is known: its last cells are the `cells`.
    ///
    /// # Errors
    ///
    /// Ends the run, with what it has.
    fn model_done(&mut self, model: &ModelRecord, cells: &[Cell]) -> anyhow::Result<()> {
        let _ = (model, cells);
        Ok(())
    }
}
