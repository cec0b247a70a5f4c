//! The process of an outside program.

use std::fs::{File, OpenOptions};
use std::io::{self, Read};
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use geobench_window::Counters;
use rustix::fs::OFlags;
use serde::Deserialize;

use crate::exec::affinity::{self, CpuList};
use crate::exec::isolate::{ChildError, ChildProcess};
use crate::exec::limits::Limits;
use crate::exec::{Failure, Observation, expected, protocol};
use crate::measure::memory::Peaks;
use crate::registry::{Call, ProcessLifetime, Program};
use crate::schema::Status;

/// Most bytes of a line.
const LONGEST: usize = 1 << 20;

/// Request to a program with protocol `session`.
const SOLVE: &[u8] = b"solve\n";

/// A process of an outside program. With protocol `session` it has loaded the model.
#[derive(Debug)]
pub(super) struct ProgramProcess {
    child: ChildProcess,
    program: Arc<Program>,
    output: PathBuf,
}

/// One solve.
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

impl ProgramProcess {
    /// Starts `program`; with protocol `session`, waits until it has loaded the model.
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
        let failure = |error: &ChildError| error.failure(task.limits, DOING);
        forget(&output);
        let child = ChildProcess::start(command).map_err(|error| Failure {
            status: Status::Crashed,
            message: format!("{name} cannot be started: {error}"),
        })?;
        if let Some(cpus) = task.cpus {
            affinity::pin_process(child.id(), cpus.numbers())
                .map_err(|error| failure(&ChildError::Start(error)))?;
        }
        let mut process = Self {
            child,
            program: program.clone(),
            output,
        };
        if program.lifetime == ProcessLifetime::Session {
            let line = process.ask(b"", task, DOING)?;
            if !line.ready {
                return Err(failure(&ChildError::Garbage("not \"ready\": true".into())));
            }
        }
        Ok(process)
    }

    /// Solves once.
    pub(super) fn solve(&mut self, task: &Task<'_>) -> Result<Observation, Failure> {
        const DOING: &str = "solving";
        let start = Instant::now();
        let deadline = task
            .limits
            .timeout
            .0
            .and_then(|time| start.checked_add(time));
        let request = match self.program.lifetime {
            ProcessLifetime::Session => {
                forget(&self.output);
                SOLVE
            }
            // With protocol `once`, the program solves from its start.
            ProcessLifetime::Once => b"",
        };
        let mut line = self.ask(request, task, DOING)?;
        if line.ready && self.program.lifetime == ProcessLifetime::Once {
            line = self.ask(b"", task, DOING)?;
        }
        if line.seconds.is_none() {
            let error = ChildError::Garbage("no \"seconds\"".into());
            return Err(error.failure(task.limits, DOING));
        }
        let distances = read_distances(&self.output, task.vertices, task.limits, deadline)?;
        Ok(line.observation(distances))
    }

    /// Resident bytes.
    pub(super) fn resident(&self) -> Option<u64> {
        self.child.resident()
    }

    fn ask(&mut self, request: &[u8], task: &Task<'_>, doing: &str) -> Result<Line, Failure> {
        let failure = |error: ChildError| error.failure(task.limits, doing);
        let answer = self.child.ask_line(request, task.limits, LONGEST);
        let bytes = answer.map_err(failure)?;
        let Some(line) = Line::parse(&bytes) else {
            return Err(failure(ChildError::garbage(&bytes)));
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

/// Removes the distances of an earlier run.
fn forget(output: &Path) {
    let _ = std::fs::remove_file(output);
}

/// A line of an outside program. Every field is optional; unknown fields are errors, so that a typo
/// does not go unnoticed.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Line {
    /// The model is loaded.
    pub(super) ready: bool,
    /// Seconds that the solve took.
    pub(super) seconds: Option<f64>,
    /// Seconds of set-up that depends on the mesh alone, if part of this run.
    pub(super) setup_seconds: Option<f64>,
    /// What it counted, by the names of result files.
    #[serde(with = "protocol::counters")]
    pub(super) counters: Option<Counters>,
    /// Most memory that the process occupied during the solve.
    pub(super) rss_peak_bytes: Option<u64>,
    /// Most bytes on its heap during the solve, without the mesh.
    pub(super) heap_peak_bytes: Option<u64>,
    /// Why the program cannot work on the model or the source.
    pub(super) refused: Option<String>,
}

impl Line {
    /// Parses a line; `None` if malformed.
    pub(super) fn parse(line: &[u8]) -> Option<Self> {
        let line: Self = serde_json::from_slice(line).ok()?;
        let sound = |seconds: Option<f64>| seconds.is_none_or(|s| s.is_finite() && s >= 0.0);
        (sound(line.seconds) && sound(line.setup_seconds)).then_some(line)
    }

    /// The result of the run with these distances.
    pub(super) fn observation(self, distances: Vec<f64>) -> Observation {
        Observation {
            distances,
            seconds: self.seconds,
            setup_seconds: self.setup_seconds,
            counters: self.counters,
            wavefront: Vec::new(),
            peaks: Peaks {
                heap: self.heap_peak_bytes,
                rss: self.rss_peak_bytes,
            },
            phases: None,
        }
    }
}

/// Longest line of a vertex.
const LINE: u64 = 128;

/// Most bytes of everything else.
const REST: u64 = 1 << 16;

/// Bytes read between two checks of the deadline.
const BLOCK: u64 = 1 << 20;

/// Reads the distances of all `vertices` from a file of lines `vertex,distance`, until `deadline`
/// at most. The outside program made the file: links, pipes and devices are refused, neither
/// followed nor waited for, and the size is bounded.
///
/// # Errors
///
/// `crashed` if there is no such regular file, or it is too large or not understood, `timeout`
/// after the deadline, `wrong` if a vertex has no distance or two.
fn read_distances(
    path: &Path,
    vertices: usize,
    limits: &Limits,
    deadline: Option<Instant>,
) -> Result<Vec<f64>, Failure> {
    let unusable = |problem: String| Failure {
        status: Status::Crashed,
        message: format!("its distances cannot be used: {problem}"),
    };
    let is_over = || deadline.is_some_and(|deadline| Instant::now() >= deadline);
    let file = open(path).map_err(|problem| unusable(format!("{}: {problem}", path.display())))?;
    let most = REST + LINE * vertices as u64;
    let mut bytes = Vec::new();
    loop {
        if is_over() {
            return Err(ChildError::Timeout.failure(limits, "having its distances read"));
        }
        let block = (&file).take(BLOCK).read_to_end(&mut bytes);
        let block = block.map_err(|error| unusable(format!("{}: {error}", path.display())))?;
        if bytes.len() as u64 > most {
            return Err(unusable(format!(
                "{}: it has more than {most} bytes, too many for {vertices} vertices; write lines \
                 `vertex,distance` alone",
                path.display()
            )));
        }
        if block == 0 {
            break;
        }
    }
    let text = String::from_utf8(bytes).map_err(|_| {
        unusable(format!(
            "{}: it is no text; write lines `vertex,distance`",
            path.display()
        ))
    })?;
    let field = expected::parse(path, &text, vertices).map_err(|e| unusable(e.to_string()))?;
    let wrong = |message: String| Failure {
        status: Status::Wrong,
        message,
    };
    let mut distances = vec![None; vertices];
    for (vertex, distance) in field.distances {
        if distances[vertex].replace(distance).is_some() {
            return Err(wrong(format!("it wrote two distances of vertex {vertex}")));
        }
    }
    let missing = distances.iter().filter(|d| d.is_none()).count();
    match distances.iter().position(Option::is_none) {
        None => Ok(distances.into_iter().flatten().collect()),
        Some(first) => Err(wrong(format!(
            "it wrote no distance of {missing} of {vertices} vertices, the first of them {first}"
        ))),
    }
}

/// Opens a regular file without following a link and without waiting.
fn open(path: &Path) -> Result<File, String> {
    const OTHER: &str = "it is no regular file; write the distances to a file of this name";
    let flags = (OFlags::NOFOLLOW | OFlags::NONBLOCK | OFlags::NOCTTY).bits();
    let opened = OpenOptions::new()
        .read(true)
        .custom_flags(flags.cast_signed())
        .open(path);
    let file = opened.map_err(|error| match std::fs::symlink_metadata(path) {
        Ok(found) if !found.is_file() => OTHER.to_owned(),
        _ => error.to_string(),
    })?;
    let is_file = |file: &File| -> io::Result<bool> { Ok(file.metadata()?.is_file()) };
    match is_file(&file) {
        Ok(true) => Ok(file),
        Ok(false) => Err(OTHER.to_owned()),
        Err(error) => Err(error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use geobench_window::Counter;

    use super::*;

    #[test]
    fn a_line_is_understood_whole_or_not_at_all() {
        let line = Line::parse(br#"{"seconds": 0.5, "counters": {"propagated": 7}}"#).unwrap();
        assert_eq!(line.seconds, Some(0.5));
        let counters = line.counters.unwrap();
        assert_eq!(counters.get(Counter::Propagated), Some(7));
        assert_eq!(counters.get(Counter::Kept), None);
        assert!(Line::parse(br#"{"ready": true}"#).unwrap().ready);
        for garbage in [
            "mesh has 4 vertices",
            r#"{"second": 0.5}"#,
            r#"{"seconds": -1}"#,
            r#"{"seconds": "fast"}"#,
            "{",
        ] {
            assert_eq!(Line::parse(garbage.as_bytes()), None, "{garbage}");
        }
    }

    fn read_text(text: &str) -> Result<Vec<f64>, (Status, String)> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("d.csv");
        std::fs::write(&path, text).unwrap();
        read_distances(&path, 3, &Limits::USUAL, None)
            .map_err(|failure| (failure.status, failure.message))
    }

    #[test]
    fn every_vertex_has_one_distance() {
        let all = read_text("vertex,distance\n2,inf\n0,0\n1,0.5\n").unwrap();
        assert_eq!(all, [0.0, 0.5, f64::INFINITY]);
        let (status, message) = read_text("0,0\n1,1\n").unwrap_err();
        assert_eq!(status, Status::Wrong);
        assert_eq!(
            message,
            "it wrote no distance of 1 of 3 vertices, the first of them 2"
        );
        let (status, message) = read_text("0,0\n1,1\n1,1\n").unwrap_err();
        assert_eq!(status, Status::Wrong);
        assert_eq!(message, "it wrote two distances of vertex 1");
        assert_eq!(read_text("0,nan\n").unwrap_err().0, Status::Crashed);
        assert_eq!(read_text("").unwrap_err().0, Status::Crashed);
    }

    #[test]
    fn a_file_is_read_within_its_size_and_time() {
        let (status, message) = read_text(&"0,0\n".repeat(30_000)).unwrap_err();
        assert_eq!(status, Status::Crashed);
        assert!(
            message.contains("it has more than 65920 bytes"),
            "{message}"
        );
        let file = tempfile::NamedTempFile::new().unwrap();
        let over = Instant::now().checked_sub(Duration::from_millis(1));
        let failure = read_distances(file.path(), 3, &Limits::USUAL, over).unwrap_err();
        assert_eq!(failure.status, Status::Timeout);
    }
}
