//! Child processes: one per cell, so that a crash, an endless loop or a memory leak costs one row.
//!
//! A child is this program with a hidden command, or an outside program (`ext:NAME`), often a small
//! adapter around a library. Both load the model, solve on request and write lines of JSON to
//! standard output (`exec::protocol`); standard error is kept for the message of a crash. The
//! parent loads a mesh only for outside programs and for rare checks, never while a run is timed.
//!
//! **Lifetime.** The runs of one model and source are interleaved between algorithms, so a child
//! loads the model once, makes all runs of its cell and ends with the next source or model. Between
//! runs it sleeps and keeps its mesh and solver. All children together may hold half of the memory
//! available at the start. Beyond that, a child ends after its run; a new one, with one more
//! warm-up, replaces it when its next run is due. The first child of this program reports the
//! record of the model and becomes the child of the first cell. `verify`, which measures nothing,
//! uses one child for all algorithms of the suite, and a new one after a failure.
//!
//! **Limits** ([`crate::exec::limits`]). The parent sleeps in `poll` until a reply, the deadline or
//! a signal, and looks each second whether the child has ended. With a memory limit it wakes every
//! 10 ms to read the resident memory of the child and its descendants: two or three files of
//! `/proc`, without a lock in the child. Between two checks `RLIMIT_DATA` bounds the damage, at
//! twice the limit. It is not set to the limit itself, because it counts reserved memory, and a
//! growing vector reserves more than it touches.
//!
//! **End.** A child leads a process group. The group is killed as a whole, and with it the
//! processes that the child started in other groups (`system`). A child ends with its parent: by
//! `PR_SET_PDEATHSIG` and by the end of its standard input. When the kernel runs out of memory it
//! kills the child at work first (`oom_score_adj`), not the parent with all results.
//!
//! **Clock.** The child reads it around the solve and nothing else (`exec::in_process`).
//! Distances are sent afterwards, and only if they differ from the last ones sent. Outside programs
//! read clocks of their own and write distances to a file, which is checked (`answer`). Under
//! protocol 2 their times are checked, too: by the time from the request `solve` to its answer,
//! less the median time to answer a `ping`.

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::MetadataExt;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::time::{Duration, Instant};

use geobench_export::temporary;
use geobench_mesh::{Mesh, VertexId, Weld, io as mesh_io};
use tempfile::TempDir;

use crate::exec::affinity::CpuList;
use crate::exec::in_process::InProcess;
use crate::exec::limits::{DecompressionLimit, Limits, Timeout};
use crate::exec::model::ModelRef;
use crate::exec::point::Locator;
use crate::exec::protocol::{ChildSettings, PAUSE, PINGS, Reply, Request, SOLVE, no_such_key};
use crate::exec::source::{SourceSpec, TargetSpec};
use crate::exec::{Backend, Components, Failure, Observation, Pass, Refusal, Session, Step};
use crate::measure::memory::Peaks;
use crate::measure::statistics::{CLOCKS, median};
use crate::schema::{ModelRecord, SourceLabel, Status};
use crate::usage::beginning;

mod answer;
mod cell;
mod child;
mod system;

use child::{CHARACTERS, ChildError, ChildProcess};
use geobench_registry::{Call, Program, Protocol};

pub use cell::cell;
pub use system::adopt_orphans;

/// The hidden subcommand of a child that runs this program; the model and its settings follow.
pub const COMMAND: &str = "__cell";

/// What the clean-up of an outside program does, for messages.
const CLEANING_UP: &str = "cleaning up";

/// Backend that runs cells in child processes.
#[derive(Clone, Debug, Default)]
pub struct Isolated {
    /// Limits of every child.
    pub limits: Limits,
    /// Processors to which children are pinned; `None` for no pinning.
    pub cpus: Option<CpuList>,
    /// Whether one child serves all algorithms of this program, until a failure ends it.
    pub shared: bool,
    /// Path of the `geobench` executable, if the caller is another program.
    pub program: Option<PathBuf>,
    /// Maximum number of bytes that all children of a model may hold between runs; `None` for half
    /// of the available memory.
    pub budget: Option<u64>,
    /// Whether this process runs the algorithms of the registry itself. Children then run external
    /// programs only.
    pub here: bool,
}

impl Backend for Isolated {
    fn open<'b>(&'b self, model: &'b ModelRef) -> Result<Box<dyn Session + 'b>, Refusal> {
        let mut pool = ChildPool::new(self, model, ModelRecord::default());
        if self.here {
            let here = InProcess::open(model, self.limits.decompressed)?;
            pool.record = here.model().clone();
            pool.here = Some(here);
        } else {
            let (child, record) = pool.load().map_err(|failure| Refusal {
                status: failure.status,
                message: match failure.status {
                    Status::Refused => model.named_as_given(&failure.message),
                    _ => format!("{}: {}", model.path, failure.message),
                },
            })?;
            pool.record = ModelRecord {
                path: model.named_as_given(&record.path),
                ..record
            };
            pool.spare = Some(child);
        }
        Ok(Box::new(pool))
    }

    fn open_further<'b>(
        &'b self,
        model: &'b ModelRef,
        record: &ModelRecord,
    ) -> Result<Box<dyn Session + 'b>, Refusal> {
        if self.here {
            return self.open(model);
        }
        // The children load the model.
        Ok(Box::new(ChildPool::new(self, model, record.clone())))
    }
}

impl Isolated {
    /// Starts a process under these limits.
    fn process(&self, command: Command) -> Result<ChildProcess, ChildError> {
        let cpus = self.cpus.as_ref().map_or(&[][..], CpuList::numbers);
        ChildProcess::start(command, self.limits, cpus)
    }
}

/// The child processes of one model.
struct ChildPool<'b> {
    options: &'b Isolated,
    model: &'b ModelRef,
    /// Maximum number of bytes that all children may hold between runs.
    budget: u64,
    /// Record of the model, from the first child. The other children must report the same hash.
    record: ModelRecord,
    /// Runs the algorithms of the registry in this process if [`Isolated::here`] is set.
    here: Option<InProcess>,
    /// The source of the current runs.
    source: Option<SourceLabel>,
    children: Vec<ModelChild>,
    /// The first child, until it is assigned to a cell.
    spare: Option<ModelChild>,
    /// Cells whose child was ended because all children together held too much memory.
    evicted: Vec<String>,
    /// The files that external programs read and write.
    handover: Option<ExchangeFolder>,
    /// Last result of each external program for the current source.
    solved: BTreeMap<String, Observation>,
}

/// A child that has loaded the model, or loads it in its only run.
struct ModelChild {
    process: ChildProcess,
    /// Label of the algorithm; empty if the child serves all algorithms.
    cell: String,
    /// The last distances received from it.
    distances: Vec<f64>,
    /// Set for an external program.
    outside: Option<Outside>,
    /// Start time of its process.
    started: Instant,
}

struct Outside {
    program: Arc<Program>,
    /// The file that it reads.
    model: PathBuf,
    source: u32,
    /// The file to which it writes distances.
    output: PathBuf,
    /// Seconds of its set-up, until a run reports them.
    setup_seconds: Option<f64>,
    /// The mesh that it reads, which is refined at the source.
    mesh: Mesh,
    /// Actual position of the source, if it differs from the requested one.
    note: Option<String>,
}

/// Temporary folder with the model, and with a folder for each program.
struct ExchangeFolder {
    folder: TempDir,
    /// The model as an OBJ file, with unchanged vertex numbers. If the source is not a vertex, the
    /// model has an additional one. The folders of programs have links to it.
    model: PathBuf,
    /// The state of that file after it was written.
    written: Option<FileState>,
    /// The mesh in that file.
    mesh: Mesh,
    source: VertexId,
    /// Actual position of the source, if it differs from the requested one.
    note: Option<String>,
}

impl ExchangeFolder {
    /// An empty folder for a run on `model` from `source`.
    fn new(
        model: &ModelRef,
        vertices: usize,
        limit: DecompressionLimit,
        source: &SourceSpec,
    ) -> Result<Self, Failure> {
        let refused = |message: String| Failure::new(Status::Refused, message);
        let points = source
            .points(vertices)
            .map_err(|e| refused(e.to_string()))?;
        let [point] = points[..] else {
            let message = "outside programs take one source at a time; leave out \
                --sources-together, or the program";
            return Err(refused(message.to_owned()));
        };
        let make = || tempfile::Builder::new().prefix("geobench-").tempdir();
        let folder = temporary::registered(make);
        let folder = folder.map_err(|error| not_handed_over(&error.into()))?;
        let loaded = model.mesh_within(limit);
        let (mesh, _) = loaded.map_err(|error| not_handed_over(&error.into()))?;
        let found = Locator::new(&mesh).locate(point);
        let found = found.map_err(|error| refused(error.to_string()))?;
        let refined = mesh.with_points(&[found.point]);
        let refined = refined.map_err(|error| refused(error.to_string()))?;
        Ok(Self {
            model: folder.path().join("model.obj"),
            folder,
            written: None,
            source: refined.vertices[0],
            mesh: refined.mesh,
            note: found.note(),
        })
    }
}

impl ExchangeFolder {
    /// The values of the placeholders in the commands of a program. Its folder is its own: what it
    /// does to the files there affects no other program.
    fn call(&mut self, program: &Program, step: &Step<'_>) -> Result<Call, Failure> {
        // Parameter values may contain slashes.
        let plain = |c: char| if c.is_alphanumeric() { c } else { '_' };
        let name: String = program.name.chars().map(plain).collect();
        let folder = self.folder.path().join(name);
        let model = folder.join("model.obj");
        let provided = self.provide(&folder, &model);
        provided.map_err(|error| not_handed_over(&error))?;
        Ok(Call {
            model,
            source: self.source.raw(),
            threads: step.algorithm.threads(),
            output: folder.join("distances.csv"),
        })
    }

    /// Links the model to the path `link` in `folder`, unless it is there unchanged.
    fn provide(&mut self, folder: &Path, link: &Path) -> anyhow::Result<()> {
        if self.is_as_written(link) {
            return Ok(());
        }
        fs::create_dir_all(folder)?;
        let _ = fs::remove_file(link);
        if !self.is_as_written(&self.model) {
            // A program may have written to it through its link.
            let _ = fs::remove_file(&self.model);
            mesh_io::write(&self.model, &self.mesh.to_soup())?;
            self.written = file_state(&self.model);
        }
        // Not all file systems have links.
        fs::hard_link(&self.model, link).or_else(|_| fs::copy(&self.model, link).map(drop))?;
        Ok(())
    }

    fn is_as_written(&self, path: &Path) -> bool {
        self.written.is_some() && self.written == file_state(path)
    }
}

/// Inode, length and time of the last change (seconds, nanoseconds) of a file.
type FileState = (u64, u64, i64, i64);

/// The state of a file; `None` if there is none.
fn file_state(path: &Path) -> Option<FileState> {
    let found = fs::symlink_metadata(path).ok()?;
    Some((found.ino(), found.len(), found.mtime(), found.mtime_nsec()))
}

/// The failure of a row whose program cannot be given the model.
fn not_handed_over(error: &anyhow::Error) -> Failure {
    let message = format!("the model cannot be handed over: {error}");
    Failure::new(Status::Crashed, message)
}

impl<'b> ChildPool<'b> {
    /// A pool without children, for a model with this record.
    fn new(options: &'b Isolated, model: &'b ModelRef, record: ModelRecord) -> Self {
        let half_of_memory = || system::available_memory().map(|bytes| bytes / 2);
        Self {
            options,
            model,
            budget: options.budget.or_else(half_of_memory).unwrap_or(u64::MAX),
            record,
            here: None,
            source: None,
            children: Vec::new(),
            spare: None,
            evicted: Vec::new(),
            handover: None,
            solved: BTreeMap::new(),
        }
    }

    /// Starts a child that runs this program and loads the model; returns it with the record.
    fn load(&self) -> Result<(ModelChild, ModelRecord), Failure> {
        let settings = serde_json::json!(ChildSettings {
            name: self.model.name.clone(),
            parent: std::process::id(),
            memory_limit: self.options.limits.memory.0,
            max_decompressed: self.options.limits.decompressed.0,
            weld: self.model.weld().map(Weld::tolerance),
            reader: self.model.reader().name().to_owned(),
        });
        let program = self.options.program.as_ref();
        let mut command = program.map_or_else(system::this_program, Command::new);
        command
            .arg0("geobench")
            .args([COMMAND.as_ref(), self.model.argument()])
            .arg(settings.to_string())
            // Standard error then ends with the reason of a crash instead of a backtrace.
            .env("RUST_BACKTRACE", "0");
        let (child, record) = self.start(command, None)?;
        Ok((
            child,
            record.map_or_else(ModelRecord::default, |record| *record),
        ))
    }

    /// Starts a child. Unless it solves only once, waits until it has loaded the model.
    fn start(
        &self,
        command: Command,
        outside: Option<Outside>,
    ) -> Result<(ModelChild, Option<Box<ModelRecord>>), Failure> {
        const DOING: &str = "loading the model";
        let started = Instant::now();
        let process = self.options.process(command);
        let mut child = ModelChild {
            process: process.map_err(|error| error.failure(DOING))?,
            cell: String::new(),
            distances: Vec::new(),
            outside,
            started,
        };
        if child.solves_once() {
            child.process.watch();
            return Ok((child, None));
        }
        if let Some(outside) = child.speaks_version_2() {
            let request = format!("load {}", outside.model.display());
            // The start of the process is no part of the set-up.
            child.ask("ping", Reply::longest(0), "starting")?;
            let (reply, time) = child.ask(&request, Reply::longest(0), DOING)?;
            if let Some(outside) = &mut child.outside {
                let seconds = reply.setup_seconds.unwrap_or(time.as_secs_f64());
                outside.setup_seconds = Some(seconds);
            }
            return Ok((child, None));
        }
        let (reply, _) = child.ask("", Reply::longest(0), DOING)?;
        if !reply.ready {
            let problem = "its first answer is not {\"ready\": true}";
            return Err(ChildError::Protocol(problem.into()).failure(DOING));
        }
        Ok((child, reply.model))
    }

    /// A new child for an algorithm of the registry; the spare one if there is one.
    fn own_child(&mut self) -> Result<ModelChild, Failure> {
        if let Some(spare) = self.spare.take() {
            return Ok(spare);
        }
        let (child, found) = self.load()?;
        if found.sha256 != self.record.sha256 {
            let message = format!("{} has changed since the run began", self.model.path);
            return Err(Failure::new(Status::Refused, message));
        }
        Ok(child)
    }

    /// The files for external programs, made on first use.
    fn handover(&mut self, step: &Step<'_>) -> Result<&mut ExchangeFolder, Failure> {
        Ok(match &mut self.handover {
            Some(handover) => handover,
            none => {
                let limit = self.options.limits.decompressed;
                let vertices = self.record.vertex_count();
                none.insert(ExchangeFolder::new(
                    self.model,
                    vertices,
                    limit,
                    step.source,
                )?)
            }
        })
    }

    /// A new child for an external program.
    fn outside_child(
        &mut self,
        program: &Arc<Program>,
        step: &Step<'_>,
    ) -> Result<ModelChild, Failure> {
        let handover = self.handover(step)?;
        let call = handover.call(program, step)?;
        let command = program.command(&program.command, &call);
        let outside = Outside {
            program: program.clone(),
            model: call.model,
            source: call.source,
            output: call.output,
            setup_seconds: None,
            mesh: handover.mesh.clone(),
            note: handover.note.clone(),
        };
        outside.forget();
        Ok(self.start(command, Some(outside))?.0)
    }

    /// Runs an untimed command of an external program, such as its preparation, to its end.
    fn aside(
        &mut self,
        program: &Program,
        words: &[String],
        step: &Step<'_>,
        doing: &str,
    ) -> Result<(), Failure> {
        if words.is_empty() {
            return Ok(());
        }
        let call = self.handover(step)?.call(program, step)?;
        let command = program.command(words, &call);
        let process = self.options.process(command);
        let done = process.and_then(|mut process| {
            if doing == CLEANING_UP {
                process.outlast_interrupts();
            }
            process.finish()
        });
        done.map_err(|error| error.failure(doing))
    }

    /// Executes a run of an external program, with its preparation and clean-up.
    fn run_outside(
        &mut self,
        program: &Arc<Program>,
        cell: &str,
        step: &Step<'_>,
    ) -> Result<Observation, Failure> {
        self.aside(program, &program.prepare, step, "preparing")?;
        let done = self.run(cell, step);
        let cleaned = self.aside(program, &program.cleanup, step, CLEANING_UP);
        // The failure of the run itself comes first.
        let observation = done?;
        cleaned.map(|()| observation)
    }

    /// Executes a run in the child of `cell`, which is started if needed.
    fn run(&mut self, cell: &str, step: &Step<'_>) -> Result<Observation, Failure> {
        let known = self.children.iter().position(|child| child.cell == cell);
        let mut child = match (known, step.algorithm.program()) {
            (Some(place), _) => self.children.swap_remove(place),
            (None, Some(program)) => self.outside_child(program, step)?,
            (None, None) => self.own_child()?,
        };
        cell.clone_into(&mut child.cell);
        let vertices = self.record.vertex_count();
        if let Some(place) = self.evicted.iter().position(|evicted| evicted == cell) {
            self.evicted.swap_remove(place);
            if step.pass == Pass::Time {
                let pass = Pass::Warmup;
                child.execute(
                    self.options.limits.timeout,
                    vertices,
                    &Step {
                        pass,
                        solves: 1,
                        ..*step
                    },
                )?;
            }
        }
        let observation = child.execute(self.options.limits.timeout, vertices, step)?;
        self.keep(child);
        Ok(observation)
    }

    /// Keeps `child` for its next run, unless it solves only once or all children hold too much
    /// memory.
    fn keep(&mut self, child: ModelChild) {
        if child.solves_once() {
            return;
        }
        self.children.push(child);
        let children = self.children.iter();
        let held: u64 = children.filter_map(|c| c.process.resident()).sum();
        if held > self.budget && self.children.len() > 1 {
            self.evicted
                .extend(self.children.pop().map(|child| child.cell));
        }
    }
}

impl Session for ChildPool<'_> {
    fn model(&self) -> &ModelRecord {
        &self.record
    }

    fn execute(&mut self, step: &Step<'_>) -> Result<Observation, Failure> {
        let source = Some(step.source.label());
        if self.source != source {
            // The same file serves all sources that are vertices.
            let is_vertex = |label: &Option<SourceLabel>| {
                label.as_ref().is_some_and(|label| label.vertex().is_some())
            };
            if !is_vertex(&source) || !is_vertex(&self.source) {
                self.handover = None;
            }
            if let (Some(handover), Some(vertex)) = (
                &mut self.handover,
                source.as_ref().and_then(SourceLabel::vertex),
            ) {
                handover.source = handover.mesh.kept_vertex(VertexId::new(vertex));
            }
            self.children.retain(|child| child.cell.is_empty());
            self.evicted.clear();
            self.solved.clear();
        }
        self.source = source;
        let label = step.algorithm.label();
        let Some(program) = step.algorithm.program() else {
            return match &mut self.here {
                Some(here) => here.execute(step),
                None if self.options.shared => self.run("", step),
                None => self.run(label, step),
            };
        };
        // External programs report counters with each run, and no phases.
        let counts = matches!(step.pass, Pass::Count | Pass::Profile);
        let solved = match self.solved.get(label) {
            Some(solved) if counts => solved.clone(),
            _ => self.run_outside(program, label, step)?,
        };
        self.solved.insert(label.to_owned(), solved.clone());
        Ok(match step.pass {
            Pass::Warmup | Pass::Time => solved,
            Pass::Count => Observation {
                seconds: None,
                outside_seconds: None,
                ping_seconds: None,
                setup_seconds: None,
                ..solved
            },
            Pass::Profile => Observation {
                distances: solved.distances,
                ..Observation::default()
            },
        })
    }

    /// Loads the model here, which is rare: checks need components only of models with several, of
    /// runs from several sources together, and where an answer differs from the reference.
    fn components(&mut self, step: &Step<'_>) -> Result<Components, Failure> {
        if let Some(here) = &mut self.here {
            return here.components(step);
        }
        let loaded = InProcess::open(self.model, self.options.limits.decompressed);
        let refused = |refusal: Refusal| Failure::new(Status::Refused, refusal.message);
        loaded.map_err(refused)?.components(step)
    }
}

impl ModelChild {
    /// Whether it is an external program that exits after one solve.
    fn solves_once(&self) -> bool {
        let outside = self.outside.as_ref();
        outside.is_some_and(|outside| !outside.program.protocol.keeps_process())
    }

    /// The external program, if its protocol is version 2.
    fn speaks_version_2(&self) -> Option<&Outside> {
        let outside = self.outside.as_ref();
        outside.filter(|outside| outside.program.protocol == Protocol::Two)
    }

    /// Runs a command that knows no protocol, from its start to its exit.
    fn finish(
        &mut self,
        timeout: Timeout,
        vertices: usize,
        output: &Path,
    ) -> Result<Observation, Failure> {
        self.process
            .finish()
            .map_err(|error| error.failure("solving"))?;
        let seconds = self.started.elapsed().as_secs_f64();
        let distances = answer::read_distances(output, vertices, timeout, Instant::now())?;
        Ok(Observation {
            distances,
            seconds: Some(seconds),
            outside_seconds: Some(seconds),
            peaks: Peaks {
                heap: None,
                rss: self.process.peak(),
            },
            ..Observation::default()
        })
    }

    fn execute(
        &mut self,
        timeout: Timeout,
        vertices: usize,
        step: &Step<'_>,
    ) -> Result<Observation, Failure> {
        if let Some(outside) = &self.outside
            && outside.program.protocol == Protocol::Command
        {
            let (output, mesh) = (outside.output.clone(), outside.mesh.clone());
            let mut observation = self.finish(timeout, mesh.vertex_count(), &output)?;
            mesh.fill_copies(&mut observation.distances);
            observation.distances.truncate(vertices);
            return Ok(observation);
        }
        if self.outside.is_some() && !self.solves_once() {
            self.process.reset_peak();
        }
        let doing = match (&self.outside, step.pass) {
            (Some(_), _) => "solving",
            (None, Pass::Warmup) => "warming up",
            (None, Pass::Time) => "being timed",
            (None, Pass::Count) => "being counted",
            (None, Pass::Profile) => "being profiled",
        };
        let targets = step.goal.targets.as_ref().map_or(0, TargetSpec::count);
        let longest = Reply::longest(vertices.saturating_add(targets));
        let pings = match self.speaks_version_2() {
            Some(_) => Some(self.ping()?),
            None => None,
        };
        let (mut reply, mut time) = self.ask(&self.request(step), longest, doing)?;
        if reply.ready && self.solves_once() {
            reply = self.ask("", longest, doing)?.0;
        }
        if self.solves_once() {
            time = self.started.elapsed();
        }
        // The figure of the program itself is used only if the system provides none.
        let measured = self.outside.as_ref().and_then(|_| self.process.peak());
        if let Some(outside) = self.speaks_version_2() {
            let request = format!("write {}", outside.output.display());
            let (written, _) = self.ask(&request, longest, "writing the distances")?;
            reply.counters = reply.counters.or(written.counters);
            reply.rss_peak_bytes = reply.rss_peak_bytes.or(written.rss_peak_bytes);
            reply.heap_peak_bytes = reply.heap_peak_bytes.or(written.heap_peak_bytes);
            if let Some(outside) = &mut self.outside {
                reply.setup_seconds = reply.setup_seconds.or(outside.setup_seconds.take());
                outside.setup_seconds = written.setup_seconds;
            }
        }
        let Some(outside) = &self.outside else {
            if let Some(distances) = reply.distances.take() {
                self.distances = distances;
            }
            return Ok(reply.observation(self.distances.clone()));
        };
        let Some(seconds) = reply.seconds else {
            let problem = "its answer to a solve has no key `seconds`";
            return Err(ChildError::Protocol(problem.into()).failure(doing));
        };
        let outside_seconds = time.as_secs_f64();
        let (outside_seconds, ping_seconds) = match pings {
            Some(ping) if seconds > outside_seconds * (1.0 + CLOCKS) => {
                let problem = format!(
                    "`seconds` is {seconds:e}, but the answer came {outside_seconds:e} s after the \
                     request, and pings took {ping:e} s"
                );
                return Err(ChildError::Protocol(problem).failure(doing));
            }
            Some(ping) => ((outside_seconds - ping).max(0.0), Some(ping)),
            None => (outside_seconds, None),
        };
        reply.rss_peak_bytes = measured.or(reply.rss_peak_bytes);
        let mesh = &outside.mesh;
        let start = Instant::now();
        let mut distances =
            answer::read_distances(&outside.output, mesh.vertex_count(), timeout, start)?;
        mesh.fill_copies(&mut distances);
        distances.truncate(vertices);
        Ok(Observation {
            outside_seconds: Some(outside_seconds),
            ping_seconds,
            note: outside.note.clone(),
            ..reply.observation(distances)
        })
    }

    /// The median of the times to answer pings.
    fn ping(&mut self) -> Result<f64, Failure> {
        let mut times = Vec::with_capacity(PINGS);
        for _ in 0..PINGS {
            std::thread::sleep(PAUSE);
            let (_, time) = self.ask("ping", Reply::longest(0), "answering a ping")?;
            times.push(time.as_secs_f64());
        }
        Ok(median(&times).unwrap_or(0.0))
    }

    /// The request of a run.
    fn request(&self, step: &Step<'_>) -> String {
        match &self.outside {
            None => serde_json::json!(Request {
                algorithm: step.algorithm.spelled(),
                simd: step.algorithm.instructions().to_string(),
                source: step.source.label(),
                targets: step.goal.targets.as_ref().map(ToString::to_string),
                radius: step.goal.radius,
                pass: step.pass,
                solves: step.solves,
            })
            .to_string(),
            // It solves without a request.
            Some(_) if self.solves_once() => String::new(),
            Some(outside) => {
                outside.forget();
                match outside.program.protocol {
                    Protocol::Two => format!("solve {}", outside.source),
                    _ => SOLVE.to_owned(),
                }
            }
        }
    }

    fn ask(
        &mut self,
        request: &str,
        longest: usize,
        doing: &str,
    ) -> Result<(Reply, Duration), Failure> {
        let reply = self.process.ask(request, longest);
        let reply = reply.and_then(|(reply, time)| {
            let problem = self.outside.as_ref().and_then(|outside| {
                let whole = match outside.program.protocol {
                    Protocol::Two => time,
                    // The set-up came before the request.
                    _ => self.started.elapsed(),
                };
                let own_key = reply.own_key().map(no_such_key);
                own_key.or_else(|| set_up_beyond(&reply, whole))
            });
            match problem {
                Some(problem) => Err(ChildError::Protocol(problem)),
                None => Ok((reply, time)),
            }
        });
        reply.map_err(|error| match (error, &self.outside) {
            (ChildError::Refused(why), Some(Outside { program, .. })) => {
                let why = beginning(&why, CHARACTERS);
                let message = format!("ext:{} refused: {why}", program.name);
                Failure::new(Status::Refused, message)
            }
            (error, _) => error.failure(doing),
        })
    }
}

/// The error of a claimed set-up that is longer than `whole`, the time in which it took place.
fn set_up_beyond(reply: &Reply, whole: Duration) -> Option<String> {
    let (seconds, whole) = (reply.setup_seconds?, whole.as_secs_f64());
    (seconds > whole * (1.0 + CLOCKS))
        .then(|| format!("`setup_seconds` is {seconds:e}, but there were only {whole:e} s for it"))
}

impl Outside {
    /// Removes the file of distances of an earlier run.
    fn forget(&self) {
        let _ = fs::remove_file(&self.output);
    }
}
