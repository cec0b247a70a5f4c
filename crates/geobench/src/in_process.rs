//! Runs cells in this very process.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use geobench_mesh::Mesh;
use geobench_window::{SolveError, Solver};

use crate::memory::PeakMemory;
use crate::model::ModelRef;
use crate::record::{ModelRecord, Phases, Status};
use crate::runner::{Executor, Failure, Observation, Purpose, Refusal, Step, Workplace};

/// This process as a place to work in. A cell that panics is lost alone; one that never ends or
/// takes all memory takes the program with it.
#[derive(Clone, Copy, Debug, Default)]
pub struct InProcess;

impl Workplace for InProcess {
    fn with_model(
        &mut self,
        model: &ModelRef,
        work: &mut dyn FnMut(&ModelRecord, &mut dyn Executor),
    ) -> Result<(), Refusal> {
        let loaded = model.load().map_err(|error| Refusal {
            message: error.to_string(),
        })?;
        let mut bench = Bench {
            mesh: &loaded.mesh,
            solvers: Vec::new(),
        };
        work(&loaded.record, &mut bench);
        Ok(())
    }
}

/// The algorithms that are set up for a mesh, by name. They stay set up for the next run, as they
/// would in a program that asks for one source after another.
struct Bench<'m> {
    mesh: &'m Mesh,
    solvers: Vec<(&'static str, Box<dyn Solver + 'm>)>,
}

impl Executor for Bench<'_> {
    fn execute(&mut self, step: &Step<'_>) -> Result<Observation, Failure> {
        // What a panic leaves behind is dropped: see below.
        let result = catch_unwind(AssertUnwindSafe(|| match step.purpose {
            Purpose::Count => self.count(step),
            Purpose::WarmUp | Purpose::Time | Purpose::Clock => self.solve(step),
        }));
        match result {
            Ok(Ok(observation)) => Ok(observation),
            Ok(Err(error)) => Err(Failure {
                status: Status::Refused,
                message: error.to_string(),
            }),
            Err(panic) => {
                self.solvers
                    .retain(|(name, _)| *name != step.algorithm.label());
                Err(Failure {
                    status: Status::Crashed,
                    message: format!("the algorithm panicked: {}", panic_message(&*panic)),
                })
            }
        }
    }
}

impl Bench<'_> {
    /// A run with the solver that is set up, or is set up now.
    fn solve(&mut self, step: &Step<'_>) -> Result<Observation, SolveError> {
        let name = step.algorithm.label();
        let mut setup = None;
        let known = self.solvers.iter().position(|(n, _)| *n == name);
        let place = known.unwrap_or(self.solvers.len());
        if place == self.solvers.len() {
            let start = Instant::now();
            let solver = step.algorithm.build(self.mesh);
            setup = Some(start.elapsed());
            self.solvers.push((name, solver));
        }
        let solver = &mut self.solvers[place].1;
        let sources = [step.source];
        if step.purpose == Purpose::Clock {
            let (solution, phases) = solver.clock(&sources)?;
            return Ok(Observation {
                distances: solution.distances,
                phases: Some(Phases {
                    propagation: Some(phases.propagation.as_secs_f64()),
                    pruning: Some(phases.pruning.as_secs_f64()),
                    management: Some(phases.management.as_secs_f64()),
                }),
                ..Observation::default()
            });
        }
        let start = Instant::now();
        let solution = solver.solve(&sources);
        let elapsed = start.elapsed();
        Ok(Observation {
            distances: solution?.distances,
            seconds: Some(elapsed.as_secs_f64()),
            setup_seconds: setup.as_ref().map(Duration::as_secs_f64),
            ..Observation::default()
        })
    }

    /// A run with a solver of its own, so that its memory is counted from nothing.
    fn count(&self, step: &Step<'_>) -> Result<Observation, SolveError> {
        let measure = PeakMemory::start();
        let result = step.algorithm.build(self.mesh).count(&[step.source]);
        let peaks = measure.stop();
        let (solution, counters) = result?;
        Ok(Observation {
            distances: solution.distances,
            counters: Some(counters),
            peaks,
            ..Observation::default()
        })
    }
}

fn panic_message(panic: &(dyn Any + Send)) -> &str {
    panic
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("no message")
}
