//! What a run is to do, before any of it is done.

use crate::model::ModelRef;
use crate::registry::Selection;
use crate::source::SourceSpec;

/// A benchmark: every algorithm on every model from every source.
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

/// Place of a cell in a plan. The cells of a plan are known before any model is loaded, so that
/// they can be counted, split between machines and skipped when already done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellKey {
    /// Place in [`Plan::models`].
    pub model: usize,
    /// Place among the sources of that model.
    pub source: usize,
    /// Place in [`Plan::algorithms`].
    pub algorithm: usize,
}

impl Plan {
    /// Every cell, in the order of the run.
    pub fn cells(&self) -> impl Iterator<Item = CellKey> {
        let (sources, algorithms) = (self.sources.count(), self.algorithms.len());
        (0..self.models.len()).flat_map(move |model| {
            (0..sources).flat_map(move |source| {
                (0..algorithms).map(move |algorithm| CellKey {
                    model,
                    source,
                    algorithm,
                })
            })
        })
    }

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
