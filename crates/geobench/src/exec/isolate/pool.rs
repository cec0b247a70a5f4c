//! The child processes of one model.

use geobench_mesh::VertexId;

use super::child::ChildProcess;
use super::error::ChildError;
use super::{Isolated, Sharing};
use crate::exec::model::ModelRef;
use crate::exec::protocol::{Reply, Request};
use crate::exec::{Failure, Observation, Pass, Session, Step};
use crate::measure::host::kibibytes;
use crate::schema::{ModelRecord, Status};

/// Most bytes of an answer, without distances.
const LONGEST: usize = 1 << 20;

/// The child processes of one model.
pub(super) struct ChildPool<'w> {
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
    pub(super) fn new(place: &'w Isolated, model: &'w ModelRef) -> Self {
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
    pub(super) fn load_model(&mut self) -> Result<ModelRecord, Failure> {
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
