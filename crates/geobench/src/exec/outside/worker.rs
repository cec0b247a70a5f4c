//! The process of an outside program.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use super::answer;
use super::message::Line;
use crate::exec::affinity::{self, CpuList};
use crate::exec::isolate::{Child, Trouble};
use crate::exec::limits::Limits;
use crate::exec::{Failure, Observation};
use crate::registry::{Call, Keeping, Program};
use crate::schema::Status;

/// Most bytes of a line.
const LONGEST: usize = 1 << 20;

/// What a program that is kept is told when it is to solve.
const SOLVE: &[u8] = b"solve\n";

/// A process of an outside program, which has loaded the model if it is kept.
#[derive(Debug)]
pub(super) struct Worker {
    child: Child,
    program: Arc<Program>,
    output: PathBuf,
}

/// What an outside program is to work on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task<'t> {
    /// The model, an OBJ file.
    pub(super) model: &'t Path,
    /// Its vertices.
    pub(super) vertices: usize,
    /// The source.
    pub(super) source: u32,
    /// Threads that it may use.
    pub(super) threads: usize,
    /// What the process may use.
    pub(super) limits: &'t Limits,
    /// The processors it may run on.
    pub(super) cpus: Option<&'t CpuList>,
}

impl Worker {
    /// Starts `program`; one that is kept has loaded the model then.
    pub(super) fn start(
        program: &Arc<Program>,
        output: PathBuf,
        task: &Task<'_>,
    ) -> Result<Self, Failure> {
        const DOING: &str = "loading the model";
        let command = program.command(Call {
            model: task.model,
            source: task.source,
            threads: task.threads,
            output: &output,
        });
        let name = command.get_program().display().to_string();
        let failure = |trouble: &Trouble| trouble.failure(task.limits, DOING);
        forget(&output);
        let child = Child::start(command).map_err(|error| Failure {
            status: Status::Crashed,
            message: format!("{name} cannot be started: {error}"),
        })?;
        if let Some(cpus) = task.cpus {
            affinity::pin_process(child.id(), cpus.numbers())
                .map_err(|error| failure(&Trouble::Start(error)))?;
        }
        let mut worker = Self {
            child,
            program: program.clone(),
            output,
        };
        if program.keeping == Keeping::Session {
            let line = worker.ask(b"", task, DOING)?;
            if !line.ready {
                return Err(failure(&Trouble::Garbage("not \"ready\": true".into())));
            }
        }
        Ok(worker)
    }

    /// Has it solve once.
    pub(super) fn solve(&mut self, task: &Task<'_>) -> Result<Observation, Failure> {
        const DOING: &str = "solving";
        let start = Instant::now();
        let deadline = task
            .limits
            .timeout
            .0
            .and_then(|time| start.checked_add(time));
        let order = match self.program.keeping {
            Keeping::Session => {
                forget(&self.output);
                SOLVE
            }
            // It has been at work since its start.
            Keeping::Once => b"",
        };
        let mut line = self.ask(order, task, DOING)?;
        if line.ready && self.program.keeping == Keeping::Once {
            line = self.ask(b"", task, DOING)?;
        }
        if line.seconds.is_none() {
            let trouble = Trouble::Garbage("no \"seconds\"".into());
            return Err(trouble.failure(task.limits, DOING));
        }
        let distances = answer::read(&self.output, task.vertices, task.limits, deadline)?;
        Ok(line.observation(distances))
    }

    /// Bytes that it occupies.
    pub(super) fn resident(&self) -> Option<u64> {
        self.child.resident()
    }

    fn ask(&mut self, order: &[u8], task: &Task<'_>, doing: &str) -> Result<Line, Failure> {
        let failure = |trouble: Trouble| trouble.failure(task.limits, doing);
        let answer = self.child.ask_line(order, task.limits, LONGEST);
        let bytes = answer.map_err(failure)?;
        let Some(line) = Line::parse(&bytes) else {
            return Err(failure(Trouble::garbage(&bytes)));
        };
        match line.refused {
            Some(why) => Err(Failure {
                status: Status::Refused,
                message: format!("ext:{} refused: {why}", self.program.name),
            }),
            None => Ok(line),
        }
    }
}

/// Removes distances that an earlier run wrote: they are not the answer of the next one.
fn forget(output: &Path) {
    let _ = std::fs::remove_file(output);
}
