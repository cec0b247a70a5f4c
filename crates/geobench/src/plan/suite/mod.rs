//! What a benchmark is made of before it is a plan: settings from the command line, from a suite
//! file, or the usual ones.
//!
//! A suite file (`geobench run --config SUITE.toml`) has one or more groups, each with models,
//! algorithms and a text on what it is to show; settings above the first group hold for all
//! groups. `bench-configs/README.md` describes the format.

mod builtin;
pub(crate) mod document;
mod file;
mod library;
mod plans;
mod programs;
mod setting;

pub use builtin::{ALGORITHMS, MODELS, SMALL_MODELS};
pub use document::SuiteError;
pub use file::{Suite, SuiteGroup};
pub use library::Library;
pub use plans::{PlanError, Plans, Scale, plans};
pub use programs::read_programs;

use crate::exec::limits::{DecompressionLimit, MemoryLimit, Timeout};
use crate::plan::Reference;
use crate::plan::source::SourceSpec;
use crate::registry::Selection;

/// Most runs of one cell that can be asked for.
pub const MOST_RUNS: u32 = 1_000_000;

/// What the order of the runs is drawn from where nothing else is said.
pub const DEFAULT_SEED: u64 = 1;

/// What is known of a benchmark in one place; what is `None` is decided in another.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// The models.
    pub models: Option<Vec<WantedModel>>,
    /// The algorithms.
    pub algorithms: Option<Vec<Selection>>,
    /// The sources in each model.
    pub sources: Option<SourceSpec>,
    /// Timed runs of each cell; at least 1.
    pub repeat: Option<u32>,
    /// Untimed runs of each cell before those.
    pub warmup: Option<u32>,
    /// Largest relative difference that passes.
    pub tolerance: Option<f64>,
    /// What the order of the runs is drawn from.
    pub seed: Option<u64>,
    /// Threads of the parallel algorithms.
    pub threads: Option<u32>,
    /// Time that each run may take.
    pub timeout: Option<Timeout>,
    /// Memory that the process of each cell may occupy.
    pub memory_limit: Option<MemoryLimit>,
    /// Bytes that a compressed model may decompress to.
    pub max_decompressed: Option<DecompressionLimit>,
    /// What answers must agree with.
    pub reference: Option<Reference>,
    /// Names of the rows of tables.
    pub rows: Option<Vec<String>>,
    /// Label of the algorithm to which the others are compared in a table of ratios.
    pub ratios_to: Option<String>,
    /// Whether results hold the wavefronts of the runs.
    pub wavefront: Option<bool>,
}

/// A model or a directory of models, as someone asked for it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WantedModel {
    /// A file, a directory or a generator's spec.
    pub argument: String,
    /// Whether it is left out, with a word about it, where there is no such file.
    pub optional: bool,
    /// Names of the model that it stands for, which takes its place where somebody has it.
    pub real: Vec<String>,
    /// How many times each of its faces is then split into four.
    pub subdivide: u32,
    /// Line of the suite file that names it.
    pub line: Option<usize>,
}

impl WantedModel {
    /// A model that must be there, named on the command line.
    pub fn new(argument: &str) -> Self {
        Self {
            argument: argument.to_owned(),
            optional: false,
            real: Vec::new(),
            subdivide: 0,
            line: None,
        }
    }
}

impl Settings {
    /// These settings, and where they leave something open, those of `other`.
    #[must_use]
    pub fn or(&self, other: &Self) -> Self {
        let (a, b) = (self.clone(), other.clone());
        Self {
            models: a.models.or(b.models),
            algorithms: a.algorithms.or(b.algorithms),
            sources: a.sources.or(b.sources),
            repeat: a.repeat.or(b.repeat),
            warmup: a.warmup.or(b.warmup),
            tolerance: a.tolerance.or(b.tolerance),
            seed: a.seed.or(b.seed),
            threads: a.threads.or(b.threads),
            timeout: a.timeout.or(b.timeout),
            memory_limit: a.memory_limit.or(b.memory_limit),
            max_decompressed: a.max_decompressed.or(b.max_decompressed),
            reference: a.reference.or(b.reference),
            rows: a.rows.or(b.rows),
            ratios_to: a.ratios_to.or(b.ratios_to),
            wavefront: a.wavefront.or(b.wavefront),
        }
    }
}

/// Reads a tolerance.
///
/// # Errors
///
/// When it is not a finite number that is 0 or more.
pub fn tolerance(value: Option<f64>) -> Result<f64, String> {
    value
        .filter(|value| value.is_finite() && *value >= 0.0)
        .ok_or_else(|| "a tolerance is a number, 0 or more, such as 1e-9".to_owned())
}
