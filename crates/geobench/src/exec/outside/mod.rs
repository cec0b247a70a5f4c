//! Outside programs as algorithms: `ext:NAME`.
//!
//! A table `[ext.NAME]` in a TOML file describes the command of a program, often a small adapter
//! around a library. The program loads the model itself, solves on request, times each solve with
//! its own clock and writes the distances to a file; `bench-configs/PEERS.md` describes the
//! protocol. Its runs are interleaved with those of other algorithms, and its answers are checked
//! in the same way.
//!
//! An outside program always runs in a process of its own, within the same limits as
//! [`crate::exec::isolate`]. [`WithPrograms`] wraps the backend of the other algorithms.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use geobench_mesh::{VertexId, io as mesh_io};
use tempfile::TempDir;

use self::process::{ProgramProcess, Task};
use crate::exec::affinity::CpuList;
use crate::exec::limits::Limits;
use crate::exec::model::ModelRef;
use crate::exec::{Backend, Failure, Observation, Pass, Refusal, Session, Step};
use crate::measure::host::kibibytes;
use crate::registry::{ProcessLifetime, Program};
use crate::schema::{ModelRecord, Status};

mod process;

/// Wraps a backend and adds processes for outside programs.
pub struct WithPrograms {
    inner: Box<dyn Backend>,
    limits: Limits,
    cpus: Option<CpuList>,
}

impl WithPrograms {
    /// `inner`, and processes with these limits, pinned to these processors.
    pub fn new(inner: Box<dyn Backend>, limits: Limits, cpus: Option<CpuList>) -> Self {
        Self {
            inner,
            limits,
            cpus,
        }
    }
}

impl Backend for WithPrograms {
    fn with_model(
        &mut self,
        model: &ModelRef,
        work: &mut dyn FnMut(&ModelRecord, &mut dyn Session),
    ) -> Result<(), Refusal> {
        let (limits, cpus) = (&self.limits, self.cpus.as_ref());
        self.inner.with_model(model, &mut |record, inner| {
            let mut session = ProgramSession {
                inner,
                model,
                vertices: record.vertices.unwrap_or(0) as usize,
                limits,
                cpus,
                handover: None,
                source: None,
                processes: BTreeMap::new(),
                last: BTreeMap::new(),
            };
            work(record, &mut session);
        })
    }
}

/// Session of `inner`, and the processes of outside programs for the same model.
struct ProgramSession<'b> {
    inner: &'b mut dyn Session,
    model: &'b ModelRef,
    vertices: usize,
    limits: &'b Limits,
    cpus: Option<&'b CpuList>,
    handover: Option<Handover>,
    /// Current source.
    source: Option<VertexId>,
    /// Running programs for this source, by name.
    processes: BTreeMap<String, ProgramProcess>,
    /// Last result of each program for this source.
    last: BTreeMap<String, Observation>,
}

/// Temporary folder for the model and the distances.
struct Handover {
    folder: TempDir,
    /// The model as an OBJ file, with unchanged vertex numbers.
    model: PathBuf,
}

impl Handover {
    fn new(model: &ModelRef, limits: &Limits) -> Result<Self, Failure> {
        let failed = |why: String| Failure {
            status: Status::Crashed,
            message: format!("the model cannot be handed over: {why}"),
        };
        let folder = tempfile::Builder::new()
            .prefix("geobench-")
            .tempdir()
            .map_err(|error| failed(error.to_string()))?;
        let path = folder.path().join("model.obj");
        let soup = model.read(limits.decompressed);
        let soup = soup.map_err(|error| failed(error.to_string()))?;
        mesh_io::write(&path, &soup).map_err(|error| failed(error.to_string()))?;
        Ok(Self {
            folder,
            model: path,
        })
    }
}

impl Session for ProgramSession<'_> {
    fn execute(&mut self, step: &Step<'_>) -> Result<Observation, Failure> {
        if self.source != Some(step.source) {
            self.processes.clear();
            self.last.clear();
        }
        self.source = Some(step.source);
        let Some(program) = step.algorithm.program() else {
            return self.inner.execute(step);
        };
        // Programs report counts with each run, and have no phases.
        let last = match step.pass {
            Pass::Warmup | Pass::Time => None,
            Pass::Count | Pass::Profile => self.last.get(&program.name).cloned(),
        };
        let done = match last {
            Some(last) => last,
            None => self.solve(program, step.source.raw(), step.algorithm.threads())?,
        };
        Ok(match step.pass {
            Pass::Warmup | Pass::Time => done,
            Pass::Count => Observation {
                seconds: None,
                setup_seconds: None,
                ..done
            },
            Pass::Profile => Observation {
                distances: done.distances,
                ..Observation::default()
            },
        })
    }
}

impl ProgramSession<'_> {
    fn solve(
        &mut self,
        program: &Arc<Program>,
        source: u32,
        threads: usize,
    ) -> Result<Observation, Failure> {
        if self.handover.is_none() {
            self.handover = Some(Handover::new(self.model, self.limits)?);
        }
        let Some(handover) = &self.handover else {
            unreachable!("it has just been made");
        };
        let name = &program.name;
        let task = Task {
            model: &handover.model,
            vertices: self.vertices,
            source,
            threads,
            limits: self.limits,
            cpus: self.cpus,
        };
        let mut process = if let Some(process) = self.processes.remove(name) {
            process
        } else {
            let output = handover.folder.path().join(format!("{name}.csv"));
            ProgramProcess::start(program, output, &task)?
        };
        let done = process.solve(&task)?;
        if program.lifetime == ProcessLifetime::Session && self.has_room_for(&process) {
            self.processes.insert(name.clone(), process);
        }
        self.last.insert(name.clone(), done.clone());
        Ok(done)
    }

    /// Whether `process` may wait for its next run: waiting processes together leave half of the
    /// available memory free. Otherwise it ends and loads the model again.
    fn has_room_for(&self, process: &ProgramProcess) -> bool {
        let waiting = self.processes.values().filter_map(ProgramProcess::resident);
        let held: u64 = waiting.chain(process.resident()).sum();
        let free = kibibytes("/proc/meminfo", "MemAvailable");
        free.is_none_or(|free| held <= free)
    }
}
