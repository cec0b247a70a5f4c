//! What a run is to do, before any of it is done.

use crate::model::ModelRef;
use crate::registry::Selection;
use crate::source::SourceSpec;

/// A benchmark: a cell for every algorithm on every model from every source. How many there are is
/// known before any model is loaded.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The models, with unique names.
    pub models: Vec<ModelRef>,
    /// The algorithms, each once.
    pub algorithms: Vec<Selection>,
    /// The sources in each model.
    pub sources: SourceSpec,
    /// Timed runs of each cell.
    pub repeat: usize,
    /// Untimed runs of each cell before those.
    pub warmup: usize,
    /// What the answers must agree with.
    pub reference: Reference,
    /// Largest relative difference that passes.
    pub tolerance: f64,
}

/// What answers are compared with.
#[derive(Clone, Debug)]
pub enum Reference {
    /// Nothing.
    None,
    /// The answer of an algorithm, which need not be one of those that are measured.
    Algorithm(Selection),
    /// Stored distances.
    Files(crate::expected::Expected),
}

impl Plan {
    /// Number of runs of all cells together, as far as it can be counted.
    pub fn runs(&self) -> usize {
        self.runs_per_model().saturating_mul(self.models.len())
    }

    /// Number of runs of all cells of one model, as far as it can be counted.
    pub fn runs_per_model(&self) -> usize {
        let cells = self.sources.count().saturating_mul(self.algorithms.len());
        cells.saturating_mul(self.runs_per_cell())
    }

    /// Runs that a cell takes: warm-ups, timed ones, a counted one and a clocked one.
    pub const fn runs_per_cell(&self) -> usize {
        self.warmup + self.repeat + 2
    }
}
