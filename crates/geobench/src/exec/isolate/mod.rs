//! One child process per cell, so that a crash, an endless loop or a memory leak costs one row.
//!
//! A child is this program with a hidden command. Parent and child exchange lines of JSON
//! (`exec::protocol`) over the standard input and output of the child; its
//! standard error is kept for the message of a crash. The parent never loads a mesh.
//!
//! **Lifetime.** The runs of one model and source are interleaved between algorithms, so the child
//! of a cell loads the model once, makes all its runs and ends with the next source or model.
//! Between runs it sleeps and keeps its mesh and solver. All children together may hold half of the
//! memory available at the start. Beyond that, a child ends after its run; a new one, with one more
//! warm-up, replaces it when its next run is due. The first child to load a model reports the
//! record of the model and becomes the child of the first cell. `verify`, which measures nothing,
//! uses one child for all algorithms ([`Sharing::All`]), and a new one after a failure.
//!
//! **Limits** ([`crate::exec::limits`]). The parent sleeps in `poll` until a reply, the deadline or
//! a signal. With a memory limit it wakes every 10 ms to read the resident memory of the child and
//! its descendants: two or three files of `/proc`, without a lock of the child. Between two looks
//! `RLIMIT_DATA` bounds the damage, at twice the limit. It is not set to the limit itself, because
//! it counts reserved memory, and a growing vector reserves more than it touches.
//!
//! **End.** A child leads a process group. The group is killed as a whole, and with it the
//! processes that the child started in other groups (`system`). A child ends with its parent: by
//! `PR_SET_PDEATHSIG` and by the end of its standard input. When the kernel runs out of memory it
//! kills the child at work first (`oom_score_adj`), not the parent with all results.
//!
//! **Clock.** The child reads it around the solve and nothing else ([`crate::exec::in_process`]).
//! Distances are sent afterwards, and only if they differ from the last ones sent.

use std::ffi::OsString;
use std::os::unix::process::CommandExt;
use std::path::PathBuf;
use std::process::Command;

use geobench_mesh::VertexId;

use crate::exec::affinity::CpuList;
use crate::exec::limits::Limits;
use crate::exec::model::ModelRef;
use crate::exec::protocol::{Reply, Request};
use crate::exec::{Backend, Failure, Observation, Pass, Refusal, Session, Step};
use crate::measure::host::kibibytes;
use crate::schema::{ModelRecord, Status};

mod cell;
mod child;
mod system;

pub(crate) use cell::cell;
pub(crate) use child::{ChildError, ChildProcess};
pub(crate) use system::adopt_orphans;

/// First argument of a child; the model is the second and last.
const COMMAND: &str = "__cell";

/// A setting of glibc: blocks of this size and more get pages of their own, which return to the
/// system when freed. The value is the default, but unless it is set glibc raises it with every
/// such block freed. Then memory freed by loading and by earlier solvers lies between the blocks of
/// the next run and counts to its peak: 2 to 10 MB on the horse, 0.3 to 1 MB on models of 6,000
/// faces. Times differ by less than 3 %.
const OWN_PAGES: (&str, &str) = ("MALLOC_MMAP_THRESHOLD_", "131072");

/// The model of a child with these arguments, or `None` for other commands. The command-line parser
/// is not used: its code and tables would count to the memory of every cell.
pub(crate) fn wanted(arguments: impl Iterator<Item = OsString>) -> Option<OsString> {
    let mut arguments = arguments.skip(1);
    let model = (arguments.next()? == COMMAND).then(|| arguments.next())?;
    model.filter(|_| arguments.next().is_none())
}

/// Backend with child processes of this program.
#[derive(Clone, Debug)]
pub struct Isolated {
    limits: Limits,
    cpus: Option<CpuList>,
    sharing: Sharing,
    program: Option<PathBuf>,
    /// Bytes that all children of a model may hold between runs; half of the available memory if
    /// `None`.
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

    /// The same with another program, which must be a `geobench`, for callers that are not.
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
            // The standard error of a crash shows the reason, not a backtrace.
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

/// Most bytes of an answer, without distances.
const LONGEST: usize = 1 << 20;

/// The child processes of one model.
struct ChildPool<'w> {
    place: &'w Isolated,
    model: &'w ModelRef,
    /// Record of the model from the first child. The others must find the same hash.
    record: Option<ModelRecord>,
    /// The source under way.
    source: Option<VertexId>,
    children: Vec<Child>,
    /// The first child, before it belongs to a cell.
    spare: Option<Child>,
    /// Cells whose child ended because all together held too much memory.
    evicted: Vec<String>,
    /// Bytes that all may hold between runs.
    budget: u64,
}

/// A child that has loaded the model.
struct Child {
    process: ChildProcess,
    /// Label of the algorithm.
    cell: String,
    /// The last distances received from it.
    distances: Vec<f64>,
}

impl<'w> ChildPool<'w> {
    fn new(place: &'w Isolated, model: &'w ModelRef) -> Self {
        let half_of_memory = || kibibytes("/proc/meminfo", "MemAvailable").map(|bytes| bytes / 2);
        Self {
            place,
            model,
            record: None,
            source: None,
            children: Vec::new(),
            spare: None,
            evicted: Vec::new(),
            budget: place.budget.or_else(half_of_memory).unwrap_or(u64::MAX),
        }
    }

    /// Loads the model in a first child.
    fn load_model(&mut self) -> Result<ModelRecord, Failure> {
        let (child, record) = self.load()?;
        self.spare = Some(child);
        self.record = Some(record.clone());
        Ok(record)
    }

    /// A child that has loaded the model, and the record of the model.
    fn load(&self) -> Result<(Child, ModelRecord), Failure> {
        let failure = |error: &ChildError| error.failure(&self.place.limits, "loading the model");
        let mut process = ChildProcess::start(self.place.command_for(self.model))
            .map_err(|error| failure(&ChildError::Start(error)))?;
        let request = Request::Load {
            name: self.model.name.clone(),
            parent: std::process::id(),
            cpus: self
                .place
                .cpus
                .as_ref()
                .map_or_else(Vec::new, |cpus| cpus.numbers().to_vec()),
            memory_limit: self.place.limits.memory.0,
            max_decompressed: self.place.limits.decompressed.0,
        };
        match process.ask(&request, &self.place.limits, LONGEST) {
            Ok(Reply::Loaded(record)) => Ok((
                Child {
                    process,
                    cell: String::new(),
                    distances: Vec::new(),
                },
                *record,
            )),
            Ok(Reply::Refused(message)) => Err(Failure {
                status: Status::Refused,
                message,
            }),
            Ok(other) => Err(failure(&out_of_turn(&other))),
            Err(error) => Err(failure(&error)),
        }
    }

    /// A new child for `cell`.
    fn child_for(&mut self, cell: &str) -> Result<Child, Failure> {
        let child = if let Some(spare) = self.spare.take() {
            spare
        } else {
            let (child, found) = self.load()?;
            let hash = |record: &ModelRecord| record.sha256.clone();
            if self.record.as_ref().map(hash) != Some(hash(&found)) {
                return Err(Failure {
                    status: Status::Refused,
                    message: format!("{} has changed since the run began", self.model.path),
                });
            }
            child
        };
        Ok(Child {
            cell: cell.to_owned(),
            ..child
        })
    }

    /// Ends `child` if all together hold too much, else keeps it for its next run.
    fn keep(&mut self, child: Child) {
        self.children.push(child);
        let children = self.children.iter();
        let held: u64 = children.filter_map(|w| w.process.resident()).sum();
        if held > self.budget && self.children.len() > 1 {
            self.evicted
                .extend(self.children.pop().map(|child| child.cell));
        }
    }
}

impl Session for ChildPool<'_> {
    fn execute(&mut self, step: &Step<'_>) -> Result<Observation, Failure> {
        let cell = match self.place.sharing {
            Sharing::None => {
                if self.source != Some(step.source) {
                    self.children.clear();
                    self.evicted.clear();
                }
                step.algorithm.label()
            }
            Sharing::All => "",
        };
        self.source = Some(step.source);
        let known = self.children.iter().position(|child| child.cell == cell);
        let mut child = match known {
            Some(place) => self.children.swap_remove(place),
            None => self.child_for(cell)?,
        };
        let vertices = self.record.as_ref().and_then(|record| record.vertices);
        // 8 bytes take 11 characters of base64 at most.
        let longest = LONGEST + 11 * vertices.unwrap_or(0) as usize;
        if let Some(place) = self.evicted.iter().position(|evicted| evicted == cell) {
            self.evicted.swap_remove(place);
            if step.pass == Pass::Time {
                let pass = Pass::Warmup;
                child.execute(self.place, longest, &Step { pass, ..*step })?;
            }
        }
        let observation = child.execute(self.place, longest, step)?;
        self.keep(child);
        Ok(observation)
    }
}

impl Child {
    fn execute(
        &mut self,
        place: &Isolated,
        longest: usize,
        step: &Step<'_>,
    ) -> Result<Observation, Failure> {
        let request = Request::Run {
            algorithm: step.algorithm.spelled(),
            source: step.source.raw(),
            pass: step.pass,
        };
        let doing = match step.pass {
            Pass::Warmup => "warming up",
            Pass::Time => "being timed",
            Pass::Count => "being counted",
            Pass::Profile => "having its phases clocked",
        };
        match self.process.ask(&request, &place.limits, longest) {
            Ok(Reply::Ran(observation)) => {
                self.distances.clone_from(&observation.distances);
                Ok(*observation)
            }
            Ok(Reply::RanAgain(observation)) => Ok(Observation {
                distances: self.distances.clone(),
                ..*observation
            }),
            Ok(Reply::Failed(failure)) => Err(failure),
            Ok(other) => Err(out_of_turn(&other).failure(&place.limits, doing)),
            Err(error) => Err(error.failure(&place.limits, doing)),
        }
    }
}

/// The reply belongs to another request.
fn out_of_turn(reply: &Reply) -> ChildError {
    let mut text = format!("{reply:?}");
    text.truncate(text.find(['(', '{']).unwrap_or(text.len()));
    ChildError::Garbage(text)
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
