//! Runs cells in processes of their own, so that one that crashes, never ends or takes all memory
//! costs its own row and nothing else.
//!
//! Each process is this very program, called with a hidden command. Parent and child talk in lines
//! of JSON (`message`) through the child's standard input and output; what the child says on
//! standard error is kept for the row, should it crash. The parent never loads a mesh.
//!
//! **Who lives how long.** The runs of the cells of one model and source are interleaved between
//! algorithms. So the child of a cell loads the model once, lives through all rounds of its group,
//! carries out one run at a time, and ends when another source or model has its turn. Between its
//! runs it sleeps, but it holds its mesh and its solver. All of them together may hold half of the
//! memory that was available at the start; where they would hold more, a child that has just done
//! its run ends, and is started anew, with one more untimed run to warm up, when its next one is
//! due. The first child to load a model tells the parent what result files say about it, and goes
//! on as that of the first cell. `verify`, which measures nothing, has one child for all algorithms
//! ([`Sharing::All`]), and a new one after a failure.
//!
//! **Limits** ([`crate::exec::limits`]). The parent sleeps in `poll` until the answer, the end of
//! the time or a signal. Only where there is a limit of memory does it wake every 10 ms, to look at
//! the resident memory of the child and of what it has started: a read of two or three files of
//! `/proc` that takes no lock of the child. Between two looks the system bounds the damage: a child
//! cannot have more data than twice the limit (`RLIMIT_DATA`). The limit itself is not given to the
//! system, because that counts memory that is asked for, not what is used, and a vector that
//! doubles asks for much that it never uses.
//!
//! **The end.** A child leads a process group of its own, which is killed as a whole, and with it
//! what the child has started in other groups (`orphans`). It ends with its parent, however that
//! ends: by `PR_SET_PDEATHSIG`, and by the end of its standard input. Where the kernel itself runs
//! out of memory, the child at work has volunteered to go first (`oom_score_adj`), so that neither
//! a neighbour nor the parent with all results is taken.
//!
//! **The clock** is read in the child, around the solve and nothing else
//! ([`crate::exec::in_process`]); distances go through the pipe after that, and only if they differ
//! from those sent last.

mod cell;
mod child;
mod error;
mod orphans;
mod pool;
mod system;

use std::ffi::OsString;
use std::os::unix::process::CommandExt;
use std::path::PathBuf;
use std::process::Command;

pub(crate) use cell::cell;
pub(crate) use child::ChildProcess;
pub(crate) use error::ChildError;
pub(crate) use orphans::adopt as adopt_orphans;

use crate::exec::affinity::CpuList;
use crate::exec::limits::Limits;
use crate::exec::model::ModelRef;
use crate::exec::{Backend, Refusal, Session};
use crate::schema::{ModelRecord, Status};
use pool::ChildPool;

/// The first argument of a child; its model is the second and last.
const COMMAND: &str = "__cell";

/// A variable for glibc: from how many bytes on a block has pages of its own, which the system gets
/// back as soon as it is freed. This is the usual value; but left to itself, glibc raises it with
/// every such block that is freed, and what loading and solvers of earlier runs have freed then
/// lies between the blocks of the next run and is part of its peak: 2 to 10 MB on the horse, 0.3 to
/// 1 MB on models of 6,000 faces. Times are the same within 3 % either way.
const OWN_PAGES: (&str, &str) = ("MALLOC_MMAP_THRESHOLD_", "131072");

/// The model that a child with these arguments is to work on; none if the process is no child. The
/// parser of the command line has no part in this: its code and its tables would count to the
/// memory of every cell.
pub(crate) fn wanted(arguments: impl Iterator<Item = OsString>) -> Option<OsString> {
    let mut arguments = arguments.skip(1);
    let model = (arguments.next()? == COMMAND).then(|| arguments.next())?;
    model.filter(|_| arguments.next().is_none())
}

/// Processes of this program as a place to work in.
#[derive(Clone, Debug)]
pub struct Isolated {
    limits: Limits,
    cpus: Option<CpuList>,
    sharing: Sharing,
    program: Option<PathBuf>,
    /// Most bytes that all children of a model hold between runs; found out if `None`.
    budget: Option<u64>,
}

/// Which cells of one model share a process.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sharing {
    /// None.
    #[default]
    None,
    /// All, as long as no failure ends it.
    All,
}

impl Isolated {
    /// Processes with these limits.
    pub const fn new(limits: Limits) -> Self {
        Self {
            limits,
            cpus: None,
            sharing: Sharing::None,
            program: None,
            budget: None,
        }
    }

    /// The same, pinned to these processors.
    #[must_use]
    pub fn on_cpus(self, cpus: Option<CpuList>) -> Self {
        Self { cpus, ..self }
    }

    /// The same, shared like this.
    #[must_use]
    pub fn shared(self, sharing: Sharing) -> Self {
        Self { sharing, ..self }
    }

    /// The same as processes of another program, which must be a `geobench`: for callers that are
    /// none.
    #[must_use]
    pub fn with_program(self, program: PathBuf) -> Self {
        Self {
            program: Some(program),
            ..self
        }
    }

    /// The same with this many bytes for all children of a model between runs.
    #[must_use]
    pub fn with_budget(self, bytes: u64) -> Self {
        Self {
            budget: Some(bytes),
            ..self
        }
    }

    /// The command of a child that is to work on `model`.
    fn command_for(&self, model: &ModelRef) -> Command {
        let mut command = self
            .program
            .as_ref()
            .map_or_else(system::this_program, Command::new);
        command
            .arg0("geobench")
            .arg(COMMAND)
            .arg(model.argument())
            // Its last words are to say why it ended, not where it was.
            .env("RUST_BACKTRACE", "0")
            .env(OWN_PAGES.0, OWN_PAGES.1);
        command
    }
}

impl Backend for Isolated {
    fn with_model(
        &mut self,
        model: &ModelRef,
        work: &mut dyn FnMut(&ModelRecord, &mut dyn Session),
    ) -> Result<(), Refusal> {
        let mut pool = ChildPool::new(self, model);
        let record = pool.load_model().map_err(|failure| Refusal {
            message: match failure.status {
                Status::Refused => failure.message,
                _ => format!("{}: {}", model.path, failure.message),
            },
        })?;
        work(&record, &mut pool);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn model_of(arguments: &[&str]) -> Option<OsString> {
        wanted(arguments.iter().map(OsString::from))
    }

    #[test]
    fn only_the_call_of_a_parent_makes_a_child() {
        for model in ["horse.obj", "-o", "__cell", "gen:cube,n=2"] {
            assert_eq!(model_of(&["geobench", COMMAND, model]), Some(model.into()));
        }
        for arguments in [
            &["geobench"][..],
            &["geobench", COMMAND],
            &["geobench", "run", "horse.obj"],
            &["geobench", COMMAND, "horse.obj", "cow.off"],
        ] {
            assert_eq!(model_of(arguments), None, "{arguments:?}");
        }
    }
}
