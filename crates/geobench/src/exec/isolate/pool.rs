//! The children that work on one model.

use geobench_mesh::VertexId;

use super::child::Child;
use super::error::Trouble;
use super::{Isolated, Sharing};
use crate::exec::model::ModelRef;
use crate::exec::protocol::{Order, Reply};
use crate::exec::{Executor, Failure, Observation, Purpose, Step};
use crate::measure::host::kibibytes;
use crate::schema::{ModelRecord, Status};

/// Most bytes of an answer, without distances.
const LONGEST: usize = 1 << 20;

/// The children that work on one model.
pub(super) struct Crew<'w> {
    place: &'w Isolated,
    model: &'w ModelRef,
    /// What the first child found; the others must find the same.
    record: Option<ModelRecord>,
    /// The source under way.
    source: Option<VertexId>,
    workers: Vec<Worker>,
    /// The first child until it has a cell.
    spare: Option<Worker>,
    /// Cells whose child had to end because all held too much memory.
    evicted: Vec<String>,
    /// Most bytes that all hold between runs.
    budget: u64,
}

/// A child that has loaded the model.
struct Worker {
    child: Child,
    /// Label of the algorithm of its cell.
    cell: String,
    /// The distances that it has sent last.
    distances: Vec<f64>,
}

impl<'w> Crew<'w> {
    pub(super) fn new(place: &'w Isolated, model: &'w ModelRef) -> Self {
        let half_of_memory = || kibibytes("/proc/meminfo", "MemAvailable").map(|bytes| bytes / 2);
        Self {
            place,
            model,
            record: None,
            source: None,
            workers: Vec::new(),
            spare: None,
            evicted: Vec::new(),
            budget: place.budget.or_else(half_of_memory).unwrap_or(u64::MAX),
        }
    }

    /// Lets a first child load the model.
    pub(super) fn survey(&mut self) -> Result<ModelRecord, Failure> {
        let (worker, record) = self.load()?;
        self.spare = Some(worker);
        self.record = Some(record.clone());
        Ok(record)
    }

    /// A child that has loaded the model, and what it found.
    fn load(&self) -> Result<(Worker, ModelRecord), Failure> {
        let trouble = |trouble: &Trouble| trouble.failure(&self.place.limits, "loading the model");
        let mut child = Child::start(self.place.command_for(self.model))
            .map_err(|error| trouble(&Trouble::Start(error)))?;
        let order = Order::Load {
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
        match child.ask(&order, &self.place.limits, LONGEST) {
            Ok(Reply::Loaded(record)) => Ok((
                Worker {
                    child,
                    cell: String::new(),
                    distances: Vec::new(),
                },
                *record,
            )),
            Ok(Reply::Refused(message)) => Err(Failure {
                status: Status::Refused,
                message,
            }),
            Ok(other) => Err(trouble(&out_of_turn(&other))),
            Err(error) => Err(trouble(&error)),
        }
    }

    /// A new child for `cell`.
    fn hire(&mut self, cell: &str) -> Result<Worker, Failure> {
        let worker = if let Some(spare) = self.spare.take() {
            spare
        } else {
            let (worker, found) = self.load()?;
            let hash = |record: &ModelRecord| record.sha256.clone();
            if self.record.as_ref().map(hash) != Some(hash(&found)) {
                return Err(Failure {
                    status: Status::Refused,
                    message: format!("{} has changed since the run began", self.model.path),
                });
            }
            worker
        };
        Ok(Worker {
            cell: cell.to_owned(),
            ..worker
        })
    }

    /// Ends `worker` if all together hold too much, else keeps it for its next run.
    fn keep(&mut self, worker: Worker) {
        self.workers.push(worker);
        let workers = self.workers.iter();
        let held: u64 = workers.filter_map(|w| w.child.resident()).sum();
        if held > self.budget && self.workers.len() > 1 {
            self.evicted
                .extend(self.workers.pop().map(|worker| worker.cell));
        }
    }
}

impl Executor for Crew<'_> {
    fn execute(&mut self, step: &Step<'_>) -> Result<Observation, Failure> {
        let cell = match self.place.sharing {
            Sharing::None => {
                if self.source != Some(step.source) {
                    self.workers.clear();
                    self.evicted.clear();
                }
                step.algorithm.label()
            }
            Sharing::All => "",
        };
        self.source = Some(step.source);
        let known = self.workers.iter().position(|worker| worker.cell == cell);
        let mut worker = match known {
            Some(place) => self.workers.swap_remove(place),
            None => self.hire(cell)?,
        };
        let vertices = self.record.as_ref().and_then(|record| record.vertices);
        // 8 bytes take 11 characters of base64 at most.
        let longest = LONGEST + 11 * vertices.unwrap_or(0) as usize;
        if let Some(place) = self.evicted.iter().position(|evicted| evicted == cell) {
            self.evicted.swap_remove(place);
            if step.purpose == Purpose::Time {
                let purpose = Purpose::WarmUp;
                worker.execute(self.place, longest, &Step { purpose, ..*step })?;
            }
        }
        let observation = worker.execute(self.place, longest, step)?;
        self.keep(worker);
        Ok(observation)
    }
}

impl Worker {
    fn execute(
        &mut self,
        place: &Isolated,
        longest: usize,
        step: &Step<'_>,
    ) -> Result<Observation, Failure> {
        let order = Order::Run {
            algorithm: step.algorithm.spelled(),
            source: step.source.raw(),
            purpose: step.purpose,
        };
        let doing = match step.purpose {
            Purpose::WarmUp => "warming up",
            Purpose::Time => "being timed",
            Purpose::Count => "being counted",
            Purpose::Clock => "having its phases clocked",
        };
        match self.child.ask(&order, &place.limits, longest) {
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
            Err(trouble) => Err(trouble.failure(&place.limits, doing)),
        }
    }
}

/// An answer to another question than was asked.
fn out_of_turn(reply: &Reply) -> Trouble {
    let mut text = format!("{reply:?}");
    text.truncate(text.find(['(', '{']).unwrap_or(text.len()));
    Trouble::Garbage(text)
}
