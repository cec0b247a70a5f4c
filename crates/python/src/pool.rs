//! Solvers that are set up once and reused, and their runs in several threads.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

use geobench_registry::Selection;
use geodesics::mesh::Insertion;
use geodesics::window::{at_points, precision};
use geodesics::{Goal, Mesh, Paths, Refined, SolveError, Solver as Solve, Stop, VertexId};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// An algorithm on one mesh, with a pool of solvers. Each solver is set up once and reused.
pub(crate) struct SolverPool {
    pub(crate) selection: Selection,
    mesh: Mesh,
    /// The solvers that are set up and not in use.
    idle: Mutex<Vec<Box<dyn Solve>>>,
}

impl SolverPool {
    pub(crate) fn new(selection: &Selection, mesh: &Mesh) -> Arc<Self> {
        Arc::new(Self {
            selection: selection.clone(),
            mesh: mesh.clone(),
            idle: Mutex::default(),
        })
    }

    /// Calls `work` with an idle solver, or with a new one if none is idle. A solver that panics
    /// does not return to the pool.
    pub(crate) fn with<T>(&self, work: impl FnOnce(&mut dyn Solve) -> T) -> T {
        let idle = || lock(&self.idle);
        let ready = idle().pop();
        let mut solver = ready.unwrap_or_else(|| self.selection.build(&self.mesh));
        let result = work(&mut *solver);
        idle().push(solver);
        result
    }

    /// As [`with`](Self::with), where the points of `insertion` are vertices.
    pub(crate) fn at<T>(
        &self,
        insertion: Insertion,
        work: impl FnOnce(&mut dyn Solve, &Refined) -> T,
    ) -> T {
        let set_up = |mesh: &Mesh| self.selection.build(mesh);
        self.with(|solver| at_points(solver, insertion, set_up, work))
    }
}

/// The text of a warning if `distances` are imprecise.
pub(crate) fn doubt(mesh: &Mesh, distances: &[f64]) -> Option<String> {
    precision::doubt(mesh, distances).map(|doubt| doubt.to_string())
}

/// The goal of a search: distances up to `radius`, of `targets` or of all vertices. Setting `stop`
/// ends the search.
pub(crate) fn goal(
    radius: Option<f64>,
    targets: Option<&[VertexId]>,
    stop: &Stop,
) -> PyResult<Goal> {
    let mut goal = match targets {
        Some(targets) => Goal::targets(targets.iter().copied()),
        None => Goal::everything(),
    };
    if let Some(radius) = radius {
        if radius.is_nan() || radius < 0.0 {
            return Err(PyValueError::new_err(format!(
                "radius: {radius} is not a distance; give a number from 0 on, in units of the mesh"
            )));
        }
        goal = goal.within(radius);
    }
    Ok(goal.unless(stop))
}

/// Distances of the targets or of all vertices, and the text of a warning about their precision.
pub(crate) type Row = (Vec<f64>, Option<String>);

/// Computes the distances from the nearest of `sources`, of the targets of `goal` or of the first
/// `vertices` vertices. Those that follow were inserted for sources and targets.
pub(crate) fn row(
    solver: &mut dyn Solve,
    mesh: &Mesh,
    sources: &[VertexId],
    goal: &Goal,
    vertices: usize,
) -> Result<Row, SolveError> {
    let mut distances = solver.solve_until(sources, goal)?.distances;
    let doubt = doubt(mesh, &distances);
    if let Some(targets) = goal.vertices() {
        let of_targets = targets.iter().map(|v| distances[v.index()]).collect();
        return Ok((of_targets, doubt));
    }
    distances.truncate(vertices);
    Ok((distances, doubt))
}

/// Several runs, one after the other in each of `workers` threads.
pub(crate) struct Runs {
    pub(crate) pool: Arc<SolverPool>,
    pub(crate) insertion: Insertion,
    pub(crate) workers: usize,
    pub(crate) stop: Stop,
}

impl Runs {
    /// Calls `run` for each task, and `put` with its result in the order in which they end. Once a
    /// run has failed or `stop` is set, no other is begun. Returns the last warning.
    pub(crate) fn each<K: Send, T: Send>(
        &self,
        tasks: impl Iterator<Item = K> + Send,
        run: impl Fn(&mut dyn Solve, &Mesh, &K) -> Result<(T, Option<String>), SolveError> + Sync,
        put: impl Fn(K, T) + Sync,
    ) -> Result<Option<String>, SolveError> {
        let tasks = Mutex::new(tasks);
        let failed = Mutex::new(None);
        let doubts = Mutex::new(None);
        let work = || {
            self.pool.at(self.insertion.clone(), |solver, refined| {
                while !self.stop.is_set() && lock(&failed).is_none() {
                    let Some(task) = lock(&tasks).next() else {
                        break;
                    };
                    match run(solver, &refined.mesh, &task) {
                        Ok((found, doubt)) => {
                            put(task, found);
                            if let Some(doubt) = doubt {
                                *lock(&doubts) = Some(doubt);
                            }
                        }
                        Err(error) => *lock(&failed) = Some(error),
                    }
                }
            });
        };
        thread::scope(|scope| {
            for _ in 1..self.workers {
                scope.spawn(work);
            }
            work();
        });
        match failed.into_inner().unwrap_or_else(PoisonError::into_inner) {
            Some(error) => Err(error),
            None => Ok(doubts.into_inner().unwrap_or_else(PoisonError::into_inner)),
        }
    }
}

/// A row of distances for each source. The rows stand one after the other in `all`, whose memory is
/// reserved by the caller. Rows that are not computed stay infinite.
pub(crate) fn matrix(
    runs: &Runs,
    sources: &[VertexId],
    goal: &Goal,
    vertices: usize,
    mut all: Vec<f64>,
) -> Result<Row, SolveError> {
    let columns = goal.vertices().map_or(vertices, <[_]>::len);
    all.resize(sources.len() * columns, f64::INFINITY);
    let rows = all.chunks_mut(columns.max(1)).zip(sources);
    let run = |solver: &mut dyn Solve, mesh: &Mesh, task: &(&mut [f64], &VertexId)| {
        row(solver, mesh, &[*task.1], goal, vertices)
    };
    let doubt = runs.each(rows, run, |(place, _), found: Vec<f64>| {
        place.copy_from_slice(&found);
    })?;
    Ok((all, doubt))
}

/// The finite distances of each row, with their columns.
pub(crate) type SparseRows = Vec<(Vec<i64>, Vec<f64>)>;

/// As [`matrix`], without infinite distances.
pub(crate) fn sparse(
    runs: &Runs,
    sources: &[VertexId],
    goal: &Goal,
    vertices: usize,
) -> Result<(SparseRows, Option<String>), SolveError> {
    let mut all: SparseRows = vec![Default::default(); sources.len()];
    let run =
        |solver: &mut dyn Solve, mesh: &Mesh, task: &(&mut (Vec<i64>, Vec<f64>), &VertexId)| {
            let (distances, doubt) = row(solver, mesh, &[*task.1], goal, vertices)?;
            let finite = (0_i64..).zip(distances).filter(|(_, d)| d.is_finite());
            Ok((finite.unzip(), doubt))
        };
    let doubt = runs.each(all.iter_mut().zip(sources), run, |(place, _), found| {
        *place = found;
    })?;
    Ok((all, doubt))
}

/// For each vertex or target the distance from the nearest source, and the index of that source, or
/// -1. Algorithms that trace no paths run once for each source.
pub(crate) fn nearest(
    solver: &mut dyn Solve,
    mesh: &Mesh,
    sources: &[VertexId],
    goal: &Goal,
    vertices: usize,
) -> Result<(Vec<f64>, Vec<i64>, Option<String>), SolveError> {
    let (distances, labels) = match Paths::find(solver, mesh, sources, goal) {
        Ok(paths) => {
            let kept: Vec<VertexId> = sources.iter().map(|&v| mesh.kept_vertex(v)).collect();
            let label = |root: Option<VertexId>| {
                root.and_then(|root| kept.iter().position(|&v| v == root))
                    .map_or(-1, |i| i as i64)
            };
            let labels = paths.roots().into_iter().map(label).collect();
            (paths.distances().to_vec(), labels)
        }
        Err(SolveError::NoPaths) => {
            let mut best = vec![f64::INFINITY; mesh.vertex_count()];
            let mut labels = vec![-1; best.len()];
            for (i, &source) in sources.iter().enumerate() {
                let found = solver.solve_until(&[source], goal)?.distances;
                for ((best, label), d) in best.iter_mut().zip(&mut labels).zip(found) {
                    if d < *best {
                        (*best, *label) = (d, i as i64);
                    }
                }
            }
            (best, labels)
        }
        Err(error) => return Err(error),
    };
    let doubt = doubt(mesh, &distances);
    let (mut distances, mut labels): (Vec<f64>, Vec<i64>) = (distances, labels);
    if let Some(targets) = goal.vertices() {
        labels = targets.iter().map(|v| labels[v.index()]).collect();
        distances = targets.iter().map(|v| distances[v.index()]).collect();
    } else {
        distances.truncate(vertices);
        labels.truncate(vertices);
    }
    Ok((distances, labels, doubt))
}

/// The guarded value. A panic in another thread does not make it unusable.
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
