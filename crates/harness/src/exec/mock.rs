//! A backend for tests that returns made-up results.

use std::sync::Mutex;

use geobench_window::{Counter, Counters};

use crate::exec::model::ModelRef;
use crate::exec::{Backend, Components, Failure, Observation, Pass, Refusal, Session, Step};
use crate::lock::lock;
use crate::measure::memory::Peaks;
use crate::schema::{ModelRecord, PhaseSeconds, Status};

/// Changes the result of a run, or makes it fail.
pub type Alter = fn(&Step<'_>, &mut Observation) -> Option<Failure>;

/// Returns made-up results and logs the steps.
#[derive(Default)]
pub struct MockBackend {
    /// All runs in order, such as `time mmp 0`.
    pub log: Mutex<Vec<String>>,
    /// Models that are refused.
    pub refuse: Vec<&'static str>,
    /// Changes the result of a run.
    pub alter: Option<Alter>,
    /// Seconds of a solve, from the algorithm and the index of the run in the log; 0 for warm-ups.
    pub time: Option<fn(&str, usize) -> f64>,
}

/// Number of vertices of every made-up model.
pub(crate) const VERTICES: usize = 4;

impl MockBackend {
    /// All runs so far in order, such as `time mmp 0`.
    pub fn log(&self) -> Vec<String> {
        lock(&self.log).clone()
    }

    /// Logs a run and returns the number of runs so far.
    fn note(&self, run: String) -> usize {
        let mut log = lock(&self.log);
        log.push(run);
        log.len()
    }
}

impl Backend for MockBackend {
    fn open<'b>(&'b self, model: &'b ModelRef) -> Result<Box<dyn Session + 'b>, Refusal> {
        if self.refuse.contains(&model.name.as_str()) {
            return Err(Refusal {
                status: Status::Refused,
                message: format!("{}: edge 3-7 has 3 faces", model.path),
            });
        }
        let record = ModelRecord {
            sha256: Some("00ff".into()),
            vertices: Some(VERTICES as u64),
            faces: Some(96_966),
            edges: Some(5),
            boundary_edges: Some(4),
            components: Some(1),
            genus: Some(0),
            saddles: Some(0),
            anisotropy: Some(1.25),
            longest_edge: Some(2.0),
            load_seconds: Some(0.5),
            build_seconds: Some(0.25),
            ..model.record()
        };
        Ok(Box::new(MockSession {
            backend: self,
            record,
        }))
    }
}

struct MockSession<'b> {
    backend: &'b MockBackend,
    record: ModelRecord,
}

impl Session for MockSession<'_> {
    fn model(&self) -> &ModelRecord {
        &self.record
    }

    fn execute(&mut self, step: &Step<'_>) -> Result<Observation, Failure> {
        let name = step.algorithm.label();
        let pass = match step.pass {
            Pass::Warmup => "warm",
            Pass::Time => "time",
            Pass::Count => "count",
            Pass::Profile => "clock",
        };
        let run = format!("{pass} {name} {}", step.source.label());
        let nth = self.backend.note(run);
        let size = name.len() as u64 + u64::from(name == "mmp") * 1_000_000;
        let mut observation = Observation {
            distances: vec![0.0, 1.0, 1.5, f64::INFINITY],
            ..Observation::default()
        };
        match step.pass {
            Pass::Warmup => {
                observation.setup_seconds = Some(0.125);
                observation.seconds = self.backend.time.map(|time| time(name, 0));
            }
            Pass::Time => {
                // Every run has a different time, so that tests detect lost and repeated samples.
                let base = if name == "vtp" { 0.329 } else { 1.204 };
                let time = self.backend.time.map(|time| time(name, nth));
                observation.seconds = Some(time.unwrap_or(base + nth as f64 / 1024.0));
                observation.solves = (step.solves > 1).then_some(step.solves);
            }
            Pass::Count => {
                let mut counters = Counters::default();
                counters.set(Counter::Propagated, 3 * size);
                counters.set(Counter::PeakWindows, 10);
                counters.set(Counter::StoredWindows, size);
                counters.set(Counter::WindowBytes, 64);
                observation.counters = Some(counters);
            }
            Pass::Profile => {
                observation.phases = Some(PhaseSeconds {
                    propagation: Some(0.5),
                    pruning: Some(0.25),
                    management: Some(0.125),
                    samples: Some(1000),
                });
                observation.peaks = Peaks {
                    heap: Some(100_000 * size),
                    rss: Some(1 << 30),
                };
            }
        }
        let failure = self
            .backend
            .alter
            .and_then(|alter| alter(step, &mut observation));
        failure.map_or(Ok(observation), Err)
    }

    fn components(&mut self, _: &Step<'_>) -> Result<Components, Failure> {
        Ok(Components {
            vertices: vec![0; VERTICES],
            places: vec![0; VERTICES],
        })
    }
}

/// Makes the answers of the timed runs of `vtp` wrong at vertex 2.
pub fn spoil_vtp(step: &Step<'_>, observation: &mut Observation) -> Option<Failure> {
    if step.algorithm.label() == "vtp" && step.pass == Pass::Time {
        observation.distances[2] = 1.75;
    }
    None
}

/// Makes the timed runs of `ich` crash.
pub fn crash_ich(step: &Step<'_>, _: &mut Observation) -> Option<Failure> {
    if step.algorithm.label() == "ich" && step.pass == Pass::Time {
        let message = "the algorithm panicked: index out of bounds";
        return Some(Failure::new(Status::Crashed, message));
    }
    None
}
