//! Runs cells in the current process.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use anyhow::Context;
use geobench_mesh::{Mesh, VertexId};
use geobench_voronoi::Diagram;
use geobench_window::{Counters, Goal, Observer, PhaseSampler, Solution, SolveError, Solver};

use crate::exec::goal::GoalSpec;
use crate::exec::limits::DecompressionLimit;
use crate::exec::model::ModelRef;
use crate::exec::point::{LocatedPoint, Locator};
use crate::exec::source::SourceSpec;
use crate::exec::{Backend, Components, Failure, Observation, Pass, Refusal, Session, Step};
use crate::measure::memory::PeakMemory;
use crate::schema::{ModelRecord, PhaseSeconds, SourceLabel, Status};

/// A profiled run is repeated until it has this many samples of phases. The share of a phase is
/// then within 0.02 of the true share with a probability of 95 %.
const ENOUGH_SAMPLES: u64 = 2400;

/// A profiled run is not repeated after this time, even with fewer samples, unless there are none.
const LONGEST_PROFILE: Duration = Duration::from_secs(1);

/// The profiled runs of a short solve end after this number of times the first of them, and after
/// [`SHORTEST_PROFILE`] at least: longer ones would take most of the time of a small cell.
const MOST_PROFILED: u32 = 100;

/// Profiled runs may take this time.
const SHORTEST_PROFILE: Duration = Duration::from_millis(10);

/// Backend that runs every cell in the current process, sequentially. It cannot enforce limits.
#[derive(Clone, Copy, Debug, Default)]
pub struct ThisProcess;

impl Backend for ThisProcess {
    fn open<'b>(&'b self, model: &'b ModelRef) -> Result<Box<dyn Session + 'b>, Refusal> {
        let session = InProcess::open(model, DecompressionLimit::default())?;
        Ok(Box::new(session))
    }
}

/// A mesh and its solvers, by label. Each solver is set up once and reused for later runs and
/// sources.
///
/// A panic fails only its cell. An endless loop or a memory leak takes the whole program down.
pub(crate) struct InProcess {
    mesh: Mesh,
    record: ModelRecord,
    /// The source of the last run.
    source: Option<PreparedSource>,
    solvers: Vec<ReadySolver>,
}

/// A solver after set-up.
struct ReadySolver {
    label: String,
    solver: Box<dyn Solver>,
    /// The distances of its last run.
    answer: Vec<f64>,
}

/// A source as vertices of a mesh.
#[derive(Clone)]
struct PreparedSource {
    label: SourceLabel,
    /// The mesh, refined if a source or target is not a vertex.
    mesh: Mesh,
    is_refined: bool,
    vertices: Vec<VertexId>,
    /// The goal, and the vertices of its targets.
    goal: GoalSpec,
    targets: Option<Vec<VertexId>>,
    note: Option<String>,
}

impl PreparedSource {
    fn new(mesh: &Mesh, source: &SourceSpec, goal: &GoalSpec) -> anyhow::Result<Self> {
        let mut locator = Locator::new(mesh);
        let points = source.points(mesh.vertex_count())?;
        let sources = points.len();
        let targets = goal.points(mesh.vertex_count())?;
        let points = points.iter().chain(targets.iter().flatten());
        let found = points.map(|&point| locator.locate(point));
        let found = found.collect::<Result<Vec<_>, _>>()?;
        let points: Vec<_> = found.iter().map(|found| found.point).collect();
        let notes: Vec<String> = found.iter().filter_map(LocatedPoint::note).collect();
        let refined = mesh.with_points(&points)?;
        let (from, to) = refined.vertices.split_at(sources);
        Ok(Self {
            label: source.label(),
            goal: goal.clone(),
            targets: targets.map(|_| to.to_vec()),
            vertices: from.to_vec(),
            is_refined: refined.mesh.vertex_count() > mesh.vertex_count(),
            mesh: refined.mesh,
            note: (!notes.is_empty()).then(|| notes.join("; ")),
        })
    }

    /// Solves for the goal.
    fn solve(&self, solver: &mut dyn Solver) -> Result<Solution, SolveError> {
        let goal = self.goal.of_solver(self.targets.as_deref());
        counted_solve(solver, &self.vertices, &goal)
    }

    /// The distances of the targets, or of the vertices of the unrefined model.
    fn observation(&self, mut distances: Vec<f64>, model: &Mesh) -> Observation {
        match &self.targets {
            Some(targets) => distances = targets.iter().map(|v| distances[v.index()]).collect(),
            None => distances.truncate(model.vertex_count()),
        }
        Observation {
            distances,
            note: self.note.clone(),
            ..Observation::default()
        }
    }
}

impl InProcess {
    /// Loads `model`. `limit` bounds the decompressed size of a compressed file.
    ///
    /// # Errors
    ///
    /// If the model is unusable.
    pub(crate) fn open(model: &ModelRef, limit: DecompressionLimit) -> Result<Self, Refusal> {
        let loaded = model.load(limit).map_err(|error| Refusal {
            status: Status::Refused,
            message: error.to_string(),
        })?;
        Ok(Self {
            mesh: loaded.mesh,
            record: loaded.record,
            source: None,
            solvers: Vec::new(),
        })
    }
}

impl Session for InProcess {
    fn model(&self) -> &ModelRecord {
        &self.record
    }

    fn execute(&mut self, step: &Step<'_>) -> Result<Observation, Failure> {
        // A panic may leave the solver in any state, so the solver is dropped below.
        let result = catch_unwind(AssertUnwindSafe(|| match step.pass {
            Pass::Warmup | Pass::Time => self.solve(step),
            Pass::Profile => self.profile(step),
            Pass::Count => self.count(step),
        }));
        match result {
            Ok(Ok(observation)) => Ok(observation),
            Ok(Err(error)) => {
                let mut message = format!("{error:#}");
                if error.is::<SolveError>() {
                    message.insert_str(0, &format!("{}: ", step.algorithm.label()));
                }
                Err(Failure::new(Status::Refused, message))
            }
            Err(panic) => {
                self.dismiss(step.algorithm.label());
                let message = format!("the algorithm panicked: {}", panic_message(&*panic));
                Err(Failure::new(Status::Crashed, message))
            }
        }
    }

    fn components(&mut self, step: &Step<'_>) -> Result<Components, Failure> {
        let refused = |error: anyhow::Error| Failure::new(Status::Refused, format!("{error:#}"));
        let source = self.source(step).map_err(refused)?;
        let mut vertices = source.mesh.components();
        let of_target = |v: &VertexId| vertices[v.index()];
        let targets = source.targets.as_ref();
        let places: Option<Vec<u32>> = targets.map(|all| all.iter().map(of_target).collect());
        vertices.truncate(self.mesh.vertex_count());
        Ok(Components {
            places: places.unwrap_or_else(|| vertices.clone()),
            vertices,
        })
    }
}

impl InProcess {
    /// Prepares the source of a run. If its mesh differs from the last one, all solvers are
    /// dropped.
    fn source(&mut self, step: &Step<'_>) -> anyhow::Result<PreparedSource> {
        let label = step.source.label();
        let is_known = |known: &&PreparedSource| known.label == label && known.goal == *step.goal;
        if let Some(known) = self.source.as_ref().filter(is_known) {
            return Ok(known.clone());
        }
        let was_refined = self.source.take().is_some_and(|known| known.is_refined);
        let found = PreparedSource::new(&self.mesh, step.source, step.goal);
        if was_refined || found.as_ref().is_ok_and(|found| found.is_refined) {
            self.solvers.clear();
        }
        Ok(self.source.insert(found?).clone())
    }

    /// A timed run or a warm-up. The solver is set up on first use. Each solve of a batch is timed
    /// separately. The batch stops at an answer that differs from the previous one, so every
    /// distinct answer reaches the check.
    fn solve(&mut self, step: &Step<'_>) -> anyhow::Result<Observation> {
        let source = self.source(step)?;
        let label = step.algorithm.label();
        let mut setup = None;
        let known = self.solvers.iter().position(|known| known.label == label);
        let place = known.unwrap_or(self.solvers.len());
        if place == self.solvers.len() {
            let start = Instant::now();
            let solver = step.algorithm.build(&source.mesh);
            setup = Some(start.elapsed());
            self.solvers.push(ReadySolver {
                label: label.to_owned(),
                solver,
                answer: Vec::new(),
            });
        }
        let ready = &mut self.solvers[place];
        let (mut elapsed, mut solves) = (Duration::ZERO, 0);
        loop {
            let start = Instant::now();
            let solution = source.solve(&mut *ready.solver);
            elapsed += start.elapsed();
            solves += 1;
            let answer = solution?.distances;
            let is_new = answer != ready.answer;
            ready.answer = answer;
            if is_new || solves >= step.solves {
                break;
            }
        }
        Ok(Observation {
            seconds: Some(elapsed.as_secs_f64() / solves as f64),
            solves: (solves > 1).then_some(solves),
            setup_seconds: setup.as_ref().map(Duration::as_secs_f64),
            ..source.observation(ready.answer.clone(), &self.mesh)
        })
    }

    /// Drops the solver of an algorithm.
    fn dismiss(&mut self, algorithm: &str) {
        self.solvers.retain(|known| known.label != algorithm);
    }

    /// A profiled run, which measures memory as well. It uses a new solver, so its heap is measured
    /// from zero. The counting run does not measure memory, since the storage of counters would be
    /// included. Short runs are repeated until there are enough samples of their phases.
    fn profile(&mut self, step: &Step<'_>) -> anyhow::Result<Observation> {
        let source = self.source(step)?;
        // The heap must not include the solver of the timed runs, nor the sampler.
        self.dismiss(step.algorithm.label());
        let goal = step.goal.of_solver(source.targets.as_deref());
        let mut sampler = PhaseSampler::start().context("no thread for sampling phases")?;
        let start = Instant::now();
        let measure = PeakMemory::start();
        let mut solver = step.algorithm.build(&source.mesh);
        let result = solver.run(&source.vertices, &goal, Observer::Phases(&mut sampler));
        let peaks = measure.stop();
        let solution = result?;
        let longest = (MOST_PROFILED * start.elapsed()).clamp(SHORTEST_PROFILE, LONGEST_PROFILE);
        while sampler.has_missed_all()
            || sampler.samples() < ENOUGH_SAMPLES && start.elapsed() < longest
        {
            solver.run(&source.vertices, &goal, Observer::Phases(&mut sampler))?;
        }
        let phases = sampler.phases();
        Ok(Observation {
            phases: Some(PhaseSeconds {
                propagation: Some(phases.propagation.as_secs_f64()),
                pruning: Some(phases.pruning.as_secs_f64()),
                management: Some(phases.management.as_secs_f64()),
                samples: Some(phases.samples),
            }),
            peaks,
            ..source.observation(solution.distances, &self.mesh)
        })
    }

    /// A counting run. It uses a new solver, which is dropped afterwards.
    fn count(&mut self, step: &Step<'_>) -> anyhow::Result<Observation> {
        let source = self.source(step)?;
        self.dismiss(step.algorithm.label());
        let goal = step.goal.of_solver(source.targets.as_deref());
        let mut solver = step.algorithm.build(&source.mesh);
        let mut counters = Counters::default();
        let observer = Observer::Counters(&mut counters);
        let solution = solver.run(&source.vertices, &goal, observer)?;
        drop(solver);
        let wavefront = std::mem::take(&mut counters.wavefront);
        if !step.goal.is_everything() {
            return Ok(Observation {
                counters: Some(counters),
                wavefront: wavefront.into_iter().map(Into::into).collect(),
                ..source.observation(solution.distances, &self.mesh)
            });
        }
        let is_approximate = step.algorithm.is_approximate();
        let (extraction_seconds, labels) = extract(step, &source, &self.mesh)?.unzip();
        Ok(Observation {
            extraction_seconds,
            labels,
            edge_excess: is_approximate.then(|| edge_excess(&source.mesh, &solution.distances)),
            counters: Some(counters),
            wavefront: wavefront.into_iter().map(Into::into).collect(),
            ..source.observation(solution.distances, &self.mesh)
        })
    }
}

/// The solve of timed runs, and what callgrind counts
/// ([`instructions`](crate::exec::instructions)). Callgrind finds it by its name, so it must not be
/// inlined or recursive.
#[inline(never)]
fn counted_solve(
    solver: &mut dyn Solver,
    sources: &[VertexId],
    goal: &Goal,
) -> Result<Solution, SolveError> {
    std::hint::black_box(solver).solve_until(sources, goal)
}

/// Largest violation of the triangle inequality along an edge, beyond rounding: the difference of
/// the distances of its ends minus its length. Exact distances have none.
fn edge_excess(mesh: &Mesh, distances: &[f64]) -> f64 {
    let excesses = mesh.half_edges().filter_map(|h| {
        let [from, to] = [mesh.tail(h), mesh.head(h)].map(|v| distances[v.index()]);
        let excess = (from - to).abs() - mesh.length(h);
        // The excess is infinite if only one end is reached.
        let is_broken = excess.is_infinite() || excess > f64::EPSILON * from.max(to);
        is_broken.then_some(excess)
    });
    excesses.fold(0.0, f64::max)
}

/// Number of extractions whose median is reported.
const EXTRACTIONS: usize = 3;

/// The time to extract the Voronoi diagram after a solve, and the labels of the vertices of the
/// model. `None` for an algorithm that does not keep the windows for it.
fn extract(
    step: &Step<'_>,
    source: &PreparedSource,
    model: &Mesh,
) -> anyhow::Result<Option<(f64, Vec<u32>)>> {
    let Some(mut solver) = step.algorithm.field_solver(&source.mesh) else {
        return Ok(None);
    };
    let field = solver.field(&source.vertices)?;
    let mut seconds = [0.0; EXTRACTIONS];
    for seconds in &mut seconds {
        let start = Instant::now();
        std::hint::black_box(Diagram::new(&field, source.vertices.len()));
        *seconds = start.elapsed().as_secs_f64();
    }
    seconds.sort_by(f64::total_cmp);
    let labels = field.labels()[..model.vertex_count()].to_vec();
    Ok(Some((seconds[EXTRACTIONS / 2], labels)))
}

fn panic_message(panic: &(dyn Any + Send)) -> &str {
    panic
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("no message")
}

#[cfg(test)]
mod tests {
    use geobench_mesh::TriangleSoup;

    use super::*;
    use crate::measure::memory::Peaks;
    use geobench_registry::{Algorithm, Selection, Values, select_one};

    static EVERYTHING: GoalSpec = GoalSpec {
        targets: None,
        radius: None,
    };

    /// An algorithm that panics when it is set up.
    fn panics() -> Selection {
        let algorithm = Algorithm {
            name: "panics",
            parameters: &[],
            build: |_, _| panic!("no such luck"),
            ..*select_one("mmp").unwrap().algorithm()
        };
        Selection::new(&algorithm, Values::default())
    }

    fn on_a_triangle<T>(test: impl FnOnce(&mut InProcess) -> T) -> T {
        let positions = vec![[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let (mesh, _) = Mesh::from_soup(TriangleSoup::new(positions, vec![[0, 1, 2]])).unwrap();
        test(&mut InProcess {
            mesh,
            record: ModelRecord::default(),
            source: None,
            solvers: Vec::new(),
        })
    }

    fn source(text: &str) -> SourceSpec {
        text.parse().unwrap()
    }

    fn step<'a>(algorithm: &'a Selection, source: &'a SourceSpec, pass: Pass) -> Step<'a> {
        Step {
            model: "triangle",
            algorithm,
            source,
            goal: &EVERYTHING,
            pass,
            solves: 1,
        }
    }

    #[test]
    fn points_are_sources_and_answers_are_those_of_the_vertices() {
        let mmp = select_one("mmp").unwrap();
        on_a_triangle(|session| {
            let mut run = |text: &str, pass| {
                let found = session.execute(&step(&mmp, &source(text), pass));
                found.map(|found| (found.distances, found.note))
            };
            for pass in [Pass::Time, Pass::Profile, Pass::Count] {
                let (distances, note) = run("edge:1-2,0.5", pass).unwrap();
                assert_eq!((distances, note), (vec![2.5; 3], None));
                let (distances, note) = run("far:3,0,7", pass).unwrap();
                assert_eq!(distances, [3.0, 0.0, 5.0]);
                let expected = "far:3,0,7 is 7 from the surface; its nearest point is vertex 1";
                assert_eq!(note.as_deref(), Some(expected));
                let together = run("1,edge:0-2,0.5", pass).unwrap();
                assert_eq!(together, (vec![2.0, 0.0, 2.0], None));
                assert_eq!(run("1", pass).unwrap().0, [3.0, 0.0, 5.0]);
                let refused = run("edge:0-9,0.5", pass).unwrap_err();
                assert_eq!(refused.status, Status::Refused);
                assert_eq!(
                    refused.message,
                    "edge:0-9,0.5: vertex 9 does not exist: the mesh has 3 vertices, numbered from 0"
                );
            }
        });
    }

    #[test]
    fn answers_hold_targets_in_order_or_distances_within_the_radius() {
        let mmp = select_one("mmp").unwrap();
        on_a_triangle(|session| {
            let mut run = |targets: &str, radius, pass| {
                let goal = GoalSpec {
                    targets: (!targets.is_empty()).then(|| targets.parse().unwrap()),
                    radius,
                };
                let source = source("1");
                let step = Step {
                    goal: &goal,
                    ..step(&mmp, &source, pass)
                };
                let observation = session.execute(&step).unwrap();
                assert_eq!(observation.phases.is_some(), pass == Pass::Profile);
                observation.distances
            };
            for pass in [Pass::Warmup, Pass::Time, Pass::Profile, Pass::Count] {
                assert_eq!(run("2,edge:0-1,0.5,2", None, pass), [5.0, 1.5]);
                assert_eq!(run("", Some(3.0), pass), [3.0, 0.0, f64::INFINITY]);
                assert_eq!(run("2,0", Some(4.0), pass), [f64::INFINITY, 3.0]);
            }
        });
    }

    #[test]
    fn each_pass_delivers_its_figures_and_the_same_answer() {
        let algorithm = select_one("mmp").unwrap();
        on_a_triangle(|session| {
            let mut run = |pass| {
                session
                    .execute(&step(&algorithm, &source("1"), pass))
                    .unwrap()
            };
            let warm = run(Pass::Warmup);
            let timed = run(Pass::Time);
            let counted = run(Pass::Count);
            let profiled = run(Pass::Profile);
            for observation in [&warm, &timed, &counted, &profiled] {
                assert_eq!(observation.distances, [3.0, 0.0, 5.0]);
            }
            assert!(warm.setup_seconds.is_some() && timed.setup_seconds.is_none());
            assert!(timed.seconds.is_some() && counted.seconds.is_none());
            assert!(counted.counters.is_some() && timed.counters.is_none());
            assert!(profiled.phases.is_some() && timed.phases.is_none());
            // The storage of the counters is not memory of the algorithm.
            assert_eq!(counted.peaks, Peaks::default());
            assert_eq!(profiled.peaks.rss.is_some(), cfg!(target_os = "linux"));
        });
    }

    #[test]
    fn a_panic_is_a_crash_of_that_cell_alone() {
        let panics = panics();
        let mmp = select_one("mmp").unwrap();
        on_a_triangle(|session| {
            for pass in [Pass::Time, Pass::Count] {
                let failure = session
                    .execute(&step(&panics, &source("0"), pass))
                    .unwrap_err();
                assert_eq!(failure.status, Status::Crashed);
                assert_eq!(failure.message, "the algorithm panicked: no such luck");
            }
            assert!(
                session
                    .execute(&step(&mmp, &source("0"), Pass::Time))
                    .is_ok()
            );
        });
    }

    #[test]
    fn a_source_that_does_not_exist_is_refused() {
        let mmp = select_one("mmp").unwrap();
        on_a_triangle(|session| {
            let failure = session
                .execute(&step(&mmp, &source("3"), Pass::Time))
                .unwrap_err();
            assert_eq!(failure.status, Status::Refused);
        });
    }
}
