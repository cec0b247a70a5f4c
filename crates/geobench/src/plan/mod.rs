//! What a run is to do, before any of it is done.

mod record;
pub mod shard;
pub mod source;
pub mod suite;

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use crate::exec::expected::Expected;
use crate::exec::limits::Limits;
use crate::exec::model::ModelRef;
use crate::plan::shard::Share;
use crate::plan::source::SourceSpec;
use crate::registry::{self, Programs, SelectError, Selection, UnknownProgram};
use crate::schema::GroupRecord;

pub use record::record;

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
    /// What the order of the runs is drawn from.
    pub seed: u64,
    /// The part of it that is to be carried out; all of it if none.
    pub share: Option<Share>,
    /// What each run may use.
    pub limits: Limits,
}

/// What answers are compared with.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one in a plan")]
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

    /// Looks up the outside programs that it asks for.
    ///
    /// # Errors
    ///
    /// Names one that there is not.
    pub fn find_programs(&mut self, programs: &Programs) -> Result<(), UnknownProgram> {
        let reference = match &mut self.reference {
            Reference::Algorithm(reference) => Some(reference),
            Reference::None | Reference::Files(_) => None,
        };
        for algorithm in self.algorithms.iter_mut().chain(reference) {
            algorithm.find_program(programs)?;
        }
        Ok(())
    }

    /// Number of units, model x source, of the whole plan.
    pub fn units(&self) -> u128 {
        self.models.len() as u128 * self.sources.count() as u128
    }

    /// Whether a source of a model, both by their places in the plan, is to be worked on.
    pub fn has_unit(&self, model: usize, source: usize) -> bool {
        self.share.is_none_or(|share| {
            let before = model as u128 * self.sources.count() as u128;
            share
                .shard
                .holds(share.first_unit + before + source as u128)
        })
    }

    /// Number of units of a model that are to be worked on.
    pub fn units_of_model(&self, model: usize) -> u128 {
        let sources = self.sources.count() as u128;
        self.share.map_or(sources, |share| {
            let first = share.first_unit + model as u128 * sources;
            share.shard.held(first..first + sources)
        })
    }

    /// Number of runs of all cells together, as far as it can be counted.
    pub fn runs(&self) -> usize {
        (0..self.models.len())
            .map(|model| self.runs_of_model(model))
            .fold(0, usize::saturating_add)
    }

    /// Number of runs of all cells of one model, as far as it can be counted.
    pub fn runs_of_model(&self, model: usize) -> usize {
        let units = usize::try_from(self.units_of_model(model)).unwrap_or(usize::MAX);
        units
            .saturating_mul(self.algorithms.len())
            .saturating_mul(self.runs_per_cell())
    }

    /// Runs that a cell takes: warm-ups, timed ones, a counted one and a clocked one.
    pub const fn runs_per_cell(&self) -> usize {
        self.warmup + self.repeat + 2
    }
}
