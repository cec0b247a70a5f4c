//! What a run is to do, before any of it is done.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use crate::expected::Expected;
use crate::model::ModelRef;
use crate::record::GroupRecord;
use crate::registry::{self, SelectError, Selection};
use crate::source::SourceSpec;

/// A benchmark: a cell for every algorithm on every model from every source. How many there are is
/// known before any model is loaded.
#[derive(Clone, Debug)]
pub struct Plan {
    /// How its results are shown.
    pub group: GroupRecord,
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
    Files(Expected),
}

/// Why what answers are to agree with was not understood.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReferenceError {
    /// It asks for several algorithms.
    #[error("{0}")]
    Several(SelectError),
    /// It is no algorithm and nothing else.
    #[error("{0}; also `none`, `file` or a .csv file")]
    Unknown(SelectError),
    /// The file of distances cannot be opened.
    #[error("{}: {error}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
}

impl Reference {
    /// The usual reference: `mmp` if it runs, else the first algorithm.
    pub fn usual(algorithms: &[Selection]) -> Self {
        let usual = algorithms.iter().find(|a| a.label() == "mmp");
        match usual.or(algorithms.first()) {
            Some(selection) => Self::Algorithm(selection.clone()),
            None => Self::None,
        }
    }

    /// What `text` asks for: `none`, `file`, the path of a .csv file, relative to `directory`, or
    /// an algorithm.
    ///
    /// # Errors
    ///
    /// When it is none of these, or the file cannot be opened.
    pub fn parse(text: &str, directory: &Path) -> Result<Self, ReferenceError> {
        if text.eq_ignore_ascii_case("none") {
            return Ok(Self::None);
        }
        if text.eq_ignore_ascii_case("file") {
            return Ok(Self::Files(Expected::BesideModels));
        }
        let ending = Path::new(text).extension();
        if ending.is_some_and(|e| e.eq_ignore_ascii_case("csv")) {
            let path = directory.join(text);
            return match File::open(&path) {
                Ok(_) => Ok(Self::Files(Expected::File(path))),
                Err(error) => Err(ReferenceError::File { path, error }),
            };
        }
        match registry::select_one(text) {
            Ok(one) => Ok(Self::Algorithm(one)),
            Err(error @ SelectError::Several { .. }) => Err(ReferenceError::Several(error)),
            Err(error) => Err(ReferenceError::Unknown(error)),
        }
    }
}

/// A file of distances from one source in one model, where more are asked for.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{}: one file holds the distances from one source in one model, but more are asked for; use `file`",
    path.display()
)]
pub struct OneFileForMore {
    /// The file.
    pub path: PathBuf,
}

impl Plan {
    /// Refuses a single file of distances for more than one model or source.
    ///
    /// # Errors
    ///
    /// When that is what the plan says.
    pub fn check_reference(&self) -> Result<(), OneFileForMore> {
        match &self.reference {
            Reference::Files(Expected::File(path))
                if self.models.len() > 1 || self.sources.count() > 1 =>
            {
                Err(OneFileForMore { path: path.clone() })
            }
            _ => Ok(()),
        }
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
