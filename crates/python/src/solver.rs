//! Solvers: distances, paths, counters and profiles.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

use geobench_registry::{self as registry, MOST_THREADS, Selection, SimdChoice};
use geodesics::mesh::Insertion;
use geodesics::window::at_points;
use geodesics::window::{Counter, Counters, Observer, PhaseSampler, precision};
use geodesics::{
    Goal, Mesh, Path, PathError, Paths, Refined, SolveError, Solver as Solve, Stop, VertexId,
};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::{PyImportError, PyMemoryError, PyOSError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::{PrecisionWarning, path_error, solve_error};
use crate::field;
use crate::interrupt;
use crate::mesh::PyMesh;
use crate::path::PyPath;
use crate::points::{ResolvedPoints, SharedMesh, core, several, together};

/// An algorithm on one mesh, with a pool of solvers. Each solver is set up once and reused.
pub(crate) struct SolverPool {
    selection: Selection,
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
    fn with<T>(&self, work: impl FnOnce(&mut dyn Solve) -> T) -> T {
        let idle = || lock(&self.idle);
        let ready = idle().pop();
        let mut solver = ready.unwrap_or_else(|| self.selection.build(&self.mesh));
        let result = work(&mut *solver);
        idle().push(solver);
        result
    }

    /// As [`with`](Self::with), where the points of `insertion` are vertices.
    fn at<T>(&self, insertion: Insertion, work: impl FnOnce(&mut dyn Solve, &Refined) -> T) -> T {
        let set_up = |mesh: &Mesh| self.selection.build(mesh);
        self.with(|solver| at_points(solver, insertion, set_up, work))
    }
}

/// The text of a warning if `distances` are imprecise.
fn doubt(mesh: &Mesh, distances: &[f64]) -> Option<String> {
    precision::doubt(mesh, distances).map(|doubt| doubt.to_string())
}

/// The algorithm with this name and parameters, for example `fwp-mmp{kmax=5000}`.
pub(crate) fn selection(
    mesh: &Mesh,
    name: Option<&str>,
    threads: Option<i64>,
    simd: &str,
) -> PyResult<Selection> {
    let named = |error| PyValueError::new_err(format!("algorithm: {error}"));
    let selection = match name {
        Some(name) => registry::select_one(name).map_err(named)?,
        None => registry::usual(mesh),
    };
    if let Some(name) = selection.outside_name() {
        return Err(PyValueError::new_err(format!(
            "algorithm: ext:{name} is an outside program; those take part in the command `geobench \
             run`"
        )));
    }
    let simd: SimdChoice = simd
        .parse()
        .map_err(|error| PyValueError::new_err(format!("simd: {error}")))?;
    let selection = selection.with_simd(simd);
    Ok(match threads {
        Some(threads) => selection.with_threads(check_threads(threads)?),
        None => selection,
    })
}

pub(crate) fn check_threads(threads: i64) -> PyResult<usize> {
    if let Ok(threads) = u32::try_from(threads)
        && (1..=MOST_THREADS).contains(&threads)
    {
        return Ok(threads as usize);
    }
    Err(PyValueError::new_err(format!(
        "threads: {threads}, but it is a number from 1 to {MOST_THREADS}"
    )))
}

/// The goal of a search: distances up to `radius`, of `targets` or of all vertices. Setting `stop`
/// ends the search.
fn goal(radius: Option<f64>, targets: Option<&[VertexId]>, stop: &Stop) -> PyResult<Goal> {
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
type Row = (Vec<f64>, Option<String>);

/// Computes the distances from the nearest of `sources`, of the targets of `goal` or of the first
/// `vertices` vertices. Those that follow were inserted for sources and targets.
fn row(
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
struct Runs {
    pool: Arc<SolverPool>,
    insertion: Insertion,
    workers: usize,
    stop: Stop,
}

impl Runs {
    /// Calls `run` for each task, and `put` with its result in the order in which they end. Once a
    /// run has failed or `stop` is set, no other is begun. Returns the last warning.
    fn each<K: Send, T: Send>(
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
fn matrix(
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
type SparseRows = Vec<(Vec<i64>, Vec<f64>)>;

/// As [`matrix`], without infinite distances.
fn sparse(
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
fn nearest(
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
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Raises a warning about the precision of distances, if there is one.
pub(crate) fn warn(py: Python<'_>, doubt: Option<String>) -> PyResult<()> {
    let Some(doubt) = doubt else { return Ok(()) };
    let message = std::ffi::CString::new(doubt)?;
    PyErr::warn(py, &py.get_type::<PrecisionWarning>(), &message, 1)
}

/// An algorithm on a mesh.
#[derive(Clone)]
pub(crate) struct MeshAlgorithm {
    pub(crate) surface: SharedMesh,
    /// The solvers, which are kept from call to call.
    pub(crate) kept: Arc<SolverPool>,
}

impl MeshAlgorithm {
    pub(crate) fn new(surface: &SharedMesh, selection: &Selection) -> Self {
        Self {
            surface: surface.clone(),
            kept: SolverPool::new(selection, &surface.mesh),
        }
    }

    fn mesh(&self) -> &Mesh {
        &self.surface.mesh
    }

    fn together(&self, source: &Bound<'_, PyAny>) -> PyResult<ResolvedPoints> {
        self.resolve(source, None)
    }

    fn resolve(
        &self,
        source: &Bound<'_, PyAny>,
        targets: Option<(&Bound<'_, PyAny>, &str)>,
    ) -> PyResult<ResolvedPoints> {
        let points = together(source, "source", self.mesh().vertex_count())?;
        ResolvedPoints::new(source.py(), &self.surface, points, "source", targets)
    }

    /// Runs for several tasks in at most `threads` threads; by default as many as the algorithm.
    fn runs(
        &self,
        insertion: Insertion,
        threads: Option<i64>,
        tasks: usize,
        stop: &Stop,
    ) -> PyResult<Runs> {
        let threads = match threads {
            Some(threads) => check_threads(threads)?,
            None => self.kept.selection.threads(),
        };
        let workers = threads.min(tasks).max(1);
        let mut pool = Arc::clone(&self.kept);
        // A parallel algorithm uses the threads that are left for each source.
        let selection = self.kept.selection.clone().with_threads(threads / workers);
        if selection.threads() != self.kept.selection.threads() {
            pool = SolverPool::new(&selection, self.mesh());
        }
        Ok(Runs {
            pool,
            insertion,
            workers,
            stop: stop.clone(),
        })
    }

    pub(crate) fn distance<'py>(
        &self,
        py: Python<'py>,
        source: &Bound<'py, PyAny>,
        radius: Option<f64>,
        targets: Option<&Bound<'py, PyAny>>,
        with_nearest: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let points = self.resolve(source, targets.map(|targets| (targets, "targets")))?;
        let stop = Stop::default();
        let goal = goal(radius, points.targets.as_deref(), &stop)?;
        let pool = Arc::clone(&self.kept);
        let (vertices, faces) = (self.mesh().vertex_count(), self.mesh().face_count());
        let ResolvedPoints {
            insertion, sources, ..
        } = points;
        if with_nearest {
            let work = move || {
                pool.at(insertion, |solver, refined| {
                    nearest(solver, &refined.mesh, &sources, &goal, vertices)
                })
            };
            let (distances, labels, doubt) =
                interrupt::call(py, faces, &stop, work)?.map_err(solve_error)?;
            warn(py, doubt)?;
            let found = (
                PyArray1::from_vec(py, distances),
                PyArray1::from_vec(py, labels),
            );
            return named(py, "Nearest", found);
        }
        let work = move || {
            pool.at(insertion, |solver, refined| {
                row(solver, &refined.mesh, &sources, &goal, vertices)
            })
        };
        let (distances, doubt) = interrupt::call(py, faces, &stop, work)?.map_err(solve_error)?;
        warn(py, doubt)?;
        Ok(PyArray1::from_vec(py, distances).into_any())
    }

    pub(crate) fn distances<'py>(
        &self,
        py: Python<'py>,
        sources: &Bound<'py, PyAny>,
        threads: Option<i64>,
        radius: Option<f64>,
        targets: Option<&Bound<'py, PyAny>>,
        as_sparse: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (vertices, faces) = (self.mesh().vertex_count(), self.mesh().face_count());
        let targets = targets.map(|targets| (targets, "targets"));
        let specs = several(sources, "sources", vertices)?;
        let points = ResolvedPoints::new(py, &self.surface, specs, "sources", targets)?;
        let stop = Stop::default();
        let goal = goal(radius, points.targets.as_deref(), &stop)?;
        let ResolvedPoints {
            insertion,
            sources,
            targets,
        } = points;
        let rows = sources.len();
        let columns = targets.map_or(vertices, |targets| targets.len());
        let runs = self.runs(insertion, threads, rows, &stop)?;
        let work_faces = faces.saturating_mul(rows);
        if as_sparse {
            let work = move || sparse(&runs, &sources, &goal, vertices);
            let (found, doubt) =
                interrupt::call(py, work_faces, &stop, work)?.map_err(solve_error)?;
            warn(py, doubt)?;
            return csr(py, &found, columns);
        }
        let mut all = Vec::new();
        if all.try_reserve_exact(rows.saturating_mul(columns)).is_err() {
            return Err(PyMemoryError::new_err(format!(
                "{rows} x {columns} distances do not fit into memory; ask for fewer sources, name \
                 targets, or give a radius and sparse=True"
            )));
        }
        let work = move || matrix(&runs, &sources, &goal, vertices, all);
        let (all, doubt) = interrupt::call(py, work_faces, &stop, work)?.map_err(solve_error)?;
        warn(py, doubt)?;
        Ok(PyArray1::from_vec(py, all)
            .reshape([rows, columns])?
            .into_any())
    }

    /// The distances between all pairs of points. Each is computed once.
    pub(crate) fn distance_matrix<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
        threads: Option<i64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let specs = several(points, "points", self.mesh().vertex_count())?;
        let points = ResolvedPoints::new(py, &self.surface, specs, "points", None)?;
        let stop = Stop::default();
        let ResolvedPoints {
            insertion, sources, ..
        } = points;
        let n = sources.len();
        let runs = self.runs(insertion, threads, n, &stop)?;
        let faces = self.mesh().face_count().saturating_mul(n);
        let work = {
            let stop = stop.clone();
            move || {
                let run = |solver: &mut dyn Solve, mesh: &Mesh, &i: &usize| {
                    let goal = Goal::targets(sources[i + 1..].iter().copied()).unless(&stop);
                    row(solver, mesh, &[sources[i]], &goal, 0)
                };
                let all = Mutex::new(vec![0.0; n * n]);
                let put = |i: usize, found: Vec<f64>| {
                    let mut all = lock(&all);
                    for (j, d) in (i + 1..).zip(found) {
                        all[i * n + j] = d;
                        all[j * n + i] = d;
                    }
                };
                let doubt = runs.each(0..n.saturating_sub(1), run, put)?;
                Ok((
                    all.into_inner().unwrap_or_else(PoisonError::into_inner),
                    doubt,
                ))
            }
        };
        let (all, doubt) = interrupt::call(py, faces, &stop, work)?.map_err(solve_error)?;
        warn(py, doubt)?;
        PyArray1::from_vec(py, all).reshape([n, n])
    }

    /// The distance from each point of `from` to the one at the same place of `to`.
    pub(crate) fn pairs<'py>(
        &self,
        py: Python<'py>,
        from: &Bound<'py, PyAny>,
        to: &Bound<'py, PyAny>,
        threads: Option<i64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let specs = several(from, "sources", self.mesh().vertex_count())?;
        let points =
            ResolvedPoints::new(py, &self.surface, specs, "sources", Some((to, "targets")))?;
        let ResolvedPoints {
            insertion,
            sources,
            targets,
        } = points;
        let targets = targets.unwrap_or_default();
        if sources.len() != targets.len() {
            return Err(PyValueError::new_err(format!(
                "targets: {} points, but there are {} sources",
                targets.len(),
                sources.len()
            )));
        }
        // One run for all targets of a source.
        let mut of_source: BTreeMap<VertexId, Vec<usize>> = BTreeMap::new();
        for (i, &source) in sources.iter().enumerate() {
            of_source.entry(source).or_default().push(i);
        }
        let stop = Stop::default();
        let runs = self.runs(insertion, threads, of_source.len(), &stop)?;
        let faces = self.mesh().face_count().saturating_mul(of_source.len());
        let work = {
            let stop = stop.clone();
            move || {
                type Task = (VertexId, Vec<usize>);
                let run = |solver: &mut dyn Solve, mesh: &Mesh, (source, places): &Task| {
                    let goal = Goal::targets(places.iter().map(|&i| targets[i])).unless(&stop);
                    row(solver, mesh, &[*source], &goal, 0)
                };
                let all = Mutex::new(vec![f64::INFINITY; targets.len()]);
                let put = |(_, places): Task, found: Vec<f64>| {
                    let mut all = lock(&all);
                    for (i, d) in places.into_iter().zip(found) {
                        all[i] = d;
                    }
                };
                let doubt = runs.each(of_source.into_iter(), run, put)?;
                Ok((
                    all.into_inner().unwrap_or_else(PoisonError::into_inner),
                    doubt,
                ))
            }
        };
        let (all, doubt) = interrupt::call(py, faces, &stop, work)?.map_err(solve_error)?;
        warn(py, doubt)?;
        Ok(PyArray1::from_vec(py, all))
    }

    /// The shortest paths from the nearest source to each target; `None` for unreachable targets.
    pub(crate) fn paths(
        &self,
        py: Python<'_>,
        source: &Bound<'_, PyAny>,
        targets: &Bound<'_, PyAny>,
        targets_name: &str,
    ) -> PyResult<Vec<Option<PyPath>>> {
        let points = self.resolve(source, Some((targets, targets_name)))?;
        let stop = Stop::default();
        let goal = goal(None, points.targets.as_deref(), &stop)?;
        let pool = Arc::clone(&self.kept);
        let ResolvedPoints {
            insertion,
            sources,
            targets,
        } = points;
        let is_refined = !insertion.is_empty();
        let work = move || -> Result<(Vec<Option<Path>>, Option<String>), PathError> {
            pool.at(insertion, |solver, refined| {
                let found = Paths::find(solver, &refined.mesh, &sources, &goal)?;
                let doubt = doubt(&refined.mesh, found.distances());
                let of_original = |path: Path| {
                    if is_refined {
                        path.of_original(refined)
                    } else {
                        path
                    }
                };
                let targets = targets.iter().flatten();
                let paths = targets.map(|&target| Ok(found.to(target)?.map(of_original)));
                Ok((paths.collect::<Result<_, PathError>>()?, doubt))
            })
        };
        let (paths, doubt) =
            interrupt::call(py, self.mesh().face_count(), &stop, work)?.map_err(path_error)?;
        warn(py, doubt)?;
        let paths = paths.into_iter();
        paths
            .map(|path| {
                path.map(|path| PyPath::new(py, self.mesh(), &path))
                    .transpose()
            })
            .collect()
    }
}

/// The named tuple `name` of the package with these values.
pub(crate) fn named<'py>(
    py: Python<'py>,
    name: &str,
    values: impl pyo3::call::PyCallArgs<'py>,
) -> PyResult<Bound<'py, PyAny>> {
    py.import("geodesics._types")?.getattr(name)?.call1(values)
}

/// A sparse matrix of SciPy.
fn csr<'py>(py: Python<'py>, rows: &SparseRows, columns: usize) -> PyResult<Bound<'py, PyAny>> {
    let scipy = py.import("scipy.sparse").map_err(|_| {
        PyImportError::new_err("sparse: scipy is needed for sparse matrices: pip install scipy")
    })?;
    let mut ends = vec![0_i64];
    for (places, _) in rows {
        ends.push(ends[ends.len() - 1] + places.len() as i64);
    }
    let places: Vec<i64> = rows.iter().flat_map(|row| row.0.iter().copied()).collect();
    let values: Vec<f64> = rows.iter().flat_map(|row| row.1.iter().copied()).collect();
    let parts = (
        PyArray1::from_vec(py, values),
        PyArray1::from_vec(py, places),
        PyArray1::from_vec(py, ends),
    );
    let shape = PyDict::new(py);
    shape.set_item("shape", (rows.len(), columns))?;
    scipy.getattr("csr_array")?.call((parts,), Some(&shape))
}

/// An algorithm that is set up once for a mesh and reused for any number of calls. Several threads
/// may use it at the same time.
///
/// Parameters
/// ----------
/// mesh : Mesh
/// algorithm : str, optional
///     A name from `algorithms()`, optionally with parameters: `"fwp-mmp{kmax=5000}"`. The default
///     is `"vtp-fast"`, or `"mmp-fast"` on a mesh with edges of more than two faces or one that
///     cannot be oriented.
/// threads : int, optional
///     The most threads that a call uses: of a parallel algorithm (`"pvtp"`) for one source, and
///     by default of `distances` for several.
/// simd : {"auto", "scalar", "avx2", "avx512"}
///     The widest vector instructions to use. `"auto"` is the widest that the processor has.
///
/// Raises
/// ------
/// ValueError
///     The algorithm does not exist, or a parameter, `threads` or `simd` is out of range.
///
/// Examples
/// --------
/// >>> import geodesics as gd
/// >>> solver = gd.Solver(gd.generate("grid,n=4"))
/// >>> solver
/// <geodesics.Solver vtp-fast for 25 vertices, 32 faces>
/// >>> float(solver.distance(0)[24])
/// 5.656854249492381
#[pyclass(frozen, weakref, module = "geodesics", name = "Solver")]
pub(crate) struct PySolver {
    algorithm: MeshAlgorithm,
    mesh: Py<PyMesh>,
    threads: Option<i64>,
    simd: String,
}

/// A pickled solver.
#[pyfunction]
pub(crate) fn _solver(
    mesh: &Bound<'_, PyAny>,
    algorithm: &str,
    threads: Option<i64>,
    simd: &str,
) -> PyResult<PySolver> {
    PySolver::new(mesh.py(), mesh, Some(algorithm), threads, simd)
}

#[pymethods]
impl PySolver {
    #[new]
    #[pyo3(signature = (mesh, algorithm = None, *, threads = None, simd = "auto"))]
    fn new(
        py: Python<'_>,
        mesh: &Bound<'_, PyAny>,
        algorithm: Option<&str>,
        threads: Option<i64>,
        simd: &str,
    ) -> PyResult<Self> {
        let mesh = mesh_of(mesh)?;
        let surface = &mesh.get().surface;
        let selection = selection(&surface.mesh, algorithm, threads, simd)?;
        let solver = MeshAlgorithm::new(surface, &selection);
        let pool = Arc::clone(&solver.kept);
        // Set up the first solver now and put it into the pool.
        let faces = solver.mesh().face_count();
        interrupt::call(py, faces, &Stop::default(), move || pool.with(|_| ()))?;
        Ok(Self {
            algorithm: solver,
            mesh: mesh.clone().unbind(),
            threads,
            simd: simd.to_owned(),
        })
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, (Py<PyMesh>, String, Option<i64>, String))> {
        let made = core(py)?.getattr("_solver")?;
        let label = self.algorithm().to_owned();
        Ok((
            made,
            (
                self.mesh.clone_ref(py),
                label,
                self.threads,
                self.simd.clone(),
            ),
        ))
    }

    /// Mesh: the mesh of the solver.
    #[getter]
    fn mesh(&self, py: Python<'_>) -> Py<PyMesh> {
        self.mesh.clone_ref(py)
    }

    /// str: the name of the algorithm, with the parameters that differ from the defaults.
    #[getter]
    fn algorithm(&self) -> &str {
        self.algorithm.kept.selection.label()
    }

    /// bool: whether its distances are exact up to rounding.
    #[getter]
    fn exact(&self) -> bool {
        self.algorithm.kept.selection.is_exact()
    }

    /// Distances from the nearest source.
    ///
    /// Parameters
    /// ----------
    /// source : int, Point or sequence of these
    ///     One or several sources: vertices, or points of the surface (`vertex`, `edge`, `face`,
    ///     `at`), also in arrays: vertex numbers, a mask of the vertices, positions of shape
    ///     (k, 3), or a tuple of faces and barycentric coordinates, of shapes (k,) and (k, 3).
    /// radius : float, optional
    ///     The search ends at this distance, in units of the mesh. Greater distances are `inf`.
    /// targets : int, Point or sequence of these, optional
    ///     Compute only the distances of these points. The search ends when all are reached.
    /// nearest : bool
    ///     Whether to return the index of the nearest source as well.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (n,), float64
    ///     The distance of each of the n vertices, or of each target, in units of the mesh; `inf`
    ///     if it is unreachable or beyond the radius. With `nearest` a `Nearest`: `distances`, and
    ///     the `sources` as indices (int64), -1 where the distance is `inf`.
    ///
    /// Raises
    /// ------
    /// IndexError
    ///     A vertex or face does not exist.
    /// ValueError, TypeError
    ///     An argument is out of range or has the wrong type.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> solver = gd.Solver(gd.generate("grid,n=4"))
    /// >>> solver.distance([0, 24], targets=[1, 23], nearest=True)
    /// Nearest(distances=array([1., 1.]), sources=array([0, 1]))
    #[pyo3(signature = (source, *, radius = None, targets = None, nearest = false))]
    fn distance<'py>(
        &self,
        py: Python<'py>,
        source: &Bound<'py, PyAny>,
        radius: Option<f64>,
        targets: Option<&Bound<'py, PyAny>>,
        nearest: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.algorithm
            .distance(py, source, radius, targets, nearest)
    }

    /// Distances from each source separately, one row per source.
    ///
    /// Parameters
    /// ----------
    /// sources : sequence of int or Point
    /// threads : int, optional
    ///     The most threads that the call uses, for several sources at a time. Threads that are left
    ///     serve a parallel algorithm.
    /// radius, targets
    ///     As for `distance`.
    /// sparse : bool
    ///     Whether to return a sparse matrix of SciPy, without the distances that are `inf`. The
    ///     zero of a source is stored.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (k, n), float64, or scipy.sparse.csr_array
    ///     Row i has the distances of the n vertices, or of the targets, from source i, in units of
    ///     the mesh.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> solver = gd.Solver(gd.generate("grid,n=4"))
    /// >>> solver.distances([0, 24], targets=[1, 12]).round(3)
    /// array([[1.   , 2.828],
    ///        [5.   , 2.828]])
    #[pyo3(signature = (sources, *, threads = None, radius = None, targets = None, sparse = false))]
    fn distances<'py>(
        &self,
        py: Python<'py>,
        sources: &Bound<'py, PyAny>,
        threads: Option<i64>,
        radius: Option<f64>,
        targets: Option<&Bound<'py, PyAny>>,
        sparse: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.algorithm
            .distances(py, sources, threads, radius, targets, sparse)
    }

    /// The distances between all pairs of points: each is computed once, so that the matrix is
    /// exactly symmetric.
    ///
    /// Parameters
    /// ----------
    /// points : sequence of int or Point, or array
    /// threads : int, optional
    ///     The most threads that the call uses, for several sources at a time. Threads that are left
    ///     serve a parallel algorithm.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (k, k), float64
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> gd.Solver(gd.generate("grid,n=4")).distance_matrix([0, 4, 24])[0]
    /// array([0.        , 4.        , 5.65685425])
    #[pyo3(signature = (points, *, threads = None))]
    fn distance_matrix<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
        threads: Option<i64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.algorithm.distance_matrix(py, points, threads)
    }

    /// The distance from each source to the target at the same place.
    ///
    /// Parameters
    /// ----------
    /// sources, targets : sequence of int or Point, or array
    ///     As many of one as of the other.
    /// threads : int, optional
    ///     The most threads that the call uses, for several sources at a time. Threads that are left
    ///     serve a parallel algorithm.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (k,), float64
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> gd.Solver(gd.generate("grid,n=4")).pairs([0, 0, 4], [4, 20, 20])
    /// array([4.        , 4.        , 5.65685425])
    #[pyo3(signature = (sources, targets, *, threads = None))]
    fn pairs<'py>(
        &self,
        py: Python<'py>,
        sources: &Bound<'py, PyAny>,
        targets: &Bound<'py, PyAny>,
        threads: Option<i64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.algorithm.pairs(py, sources, targets, threads)
    }

    /// The distance from the nearest source as a field: distances, paths, gradients and isolines at
    /// any point of the surface, without another solve.
    ///
    /// MMP runs, whatever the algorithm of the solver, and all its windows are kept: this takes
    /// several times as long as the distances of vertices, and about a gigabyte for 300,000 faces.
    ///
    /// Parameters
    /// ----------
    /// source : int, Point or sequence of these
    ///
    /// Returns
    /// -------
    /// Field
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> field = gd.Solver(gd.generate("grid,n=4")).field(0)
    /// >>> float(field.distance(gd.at(1, 1, 0))) == float(field.path(gd.at(1, 1, 0)).length)
    /// True
    fn field(&self, py: Python<'_>, source: &Bound<'_, PyAny>) -> PyResult<field::PyField> {
        field::PyField::new(py, self.mesh.bind(py), source)
    }

    /// The shortest path from the nearest source to `target`; `None` if it is unreachable.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> path = gd.Solver(gd.generate("grid,n=4")).path(0, 17)
    /// >>> path.points.shape
    /// (5, 3)
    fn path(
        &self,
        py: Python<'_>,
        source: &Bound<'_, PyAny>,
        target: &Bound<'_, PyAny>,
    ) -> PyResult<Option<PyPath>> {
        one_path(&self.algorithm, py, source, target)
    }

    /// The shortest paths from the nearest source to each target, from one search: a list with a
    /// `Path` for each target, or `None` if it is unreachable.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> solver = gd.Solver(gd.generate("grid,n=4"))
    /// >>> [path.length for path in solver.paths(0, [4, 20])]
    /// [4.0, 4.0]
    fn paths(
        &self,
        py: Python<'_>,
        source: &Bound<'_, PyAny>,
        targets: &Bound<'_, PyAny>,
    ) -> PyResult<Vec<Option<PyPath>>> {
        self.algorithm.paths(py, source, targets, "targets")
    }

    /// Distances from the nearest source, and counts of the operations of the search.
    ///
    /// Parameters
    /// ----------
    /// source : int, Point or sequence of these
    ///
    /// Returns
    /// -------
    /// distances : numpy.ndarray, shape (n,), float64
    /// counters : dict of str to int
    ///     The counters that the algorithm supports, for example `propagated`, the number of
    ///     windows propagated.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> solver = gd.Solver(gd.generate("grid,n=4"), "mmp")
    /// >>> solver.count(0).counters["propagated"] > 0
    /// True
    fn count<'py>(
        &self,
        py: Python<'py>,
        source: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let points = self.algorithm.together(source)?;
        let stop = Stop::default();
        let goal = goal(None, None, &stop)?;
        let pool = Arc::clone(&self.algorithm.kept);
        let work = move || {
            let mut counters = Counters::default();
            let observer = Observer::Counters(&mut counters);
            let solution = pool.at(points.insertion, |solver, _| {
                solver.run(&points.sources, &goal, observer)
            })?;
            Ok((solution, counters))
        };
        let faces = self.algorithm.mesh().face_count();
        let (solution, counters) = interrupt::call(py, faces, &stop, work)?.map_err(solve_error)?;
        let dictionary = PyDict::new(py);
        for &counter in Counter::ALL {
            if let Some(value) = counters.get(counter) {
                dictionary.set_item(counter.key(), value)?;
            }
        }
        let mut distances = solution.distances;
        distances.truncate(self.algorithm.mesh().vertex_count());
        named(
            py,
            "Counted",
            (PyArray1::from_vec(py, distances), dictionary),
        )
    }

    /// Distances from the nearest source, and the time in each phase of the search. A sampler
    /// estimates the times.
    ///
    /// Parameters
    /// ----------
    /// source : int, Point or sequence of these
    ///
    /// Returns
    /// -------
    /// distances : numpy.ndarray, shape (n,), float64
    /// seconds : dict of str to float
    ///     The time spent in `propagation`, `pruning` and `management`, in seconds.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> solver = gd.Solver(gd.generate("grid,n=4"))
    /// >>> sorted(solver.profile(0).seconds)
    /// ['management', 'propagation', 'pruning']
    fn profile<'py>(
        &self,
        py: Python<'py>,
        source: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let points = self.algorithm.together(source)?;
        let pool = Arc::clone(&self.algorithm.kept);
        let work = move || {
            let mut sampler = PhaseSampler::start()?;
            let (goal, observer) = (Goal::everything(), Observer::Phases(&mut sampler));
            let solution = pool.at(points.insertion, |solver, _| {
                solver.run(&points.sources, &goal, observer)
            });
            Ok((solution, sampler.phases()))
        };
        let faces = self.algorithm.mesh().face_count();
        let result: Result<_, std::io::Error> = interrupt::call(py, faces, &Stop::default(), work)?;
        let (solution, phases) = result.map_err(|error| PyOSError::new_err(error.to_string()))?;
        let mut distances = solution.map_err(solve_error)?.distances;
        distances.truncate(self.algorithm.mesh().vertex_count());
        let seconds = PyDict::new(py);
        seconds.set_item("propagation", phases.propagation.as_secs_f64())?;
        seconds.set_item("pruning", phases.pruning.as_secs_f64())?;
        seconds.set_item("management", phases.management.as_secs_f64())?;
        named(py, "Profiled", (PyArray1::from_vec(py, distances), seconds))
    }

    fn __repr__(&self) -> String {
        let mesh = self.algorithm.mesh();
        format!(
            "<geodesics.Solver {} for {} vertices, {} faces>",
            self.algorithm(),
            mesh.vertex_count(),
            mesh.face_count()
        )
    }
}

/// The shortest path to one target; an error if `target` is a sequence.
pub(crate) fn one_path(
    algorithm: &MeshAlgorithm,
    py: Python<'_>,
    source: &Bound<'_, PyAny>,
    target: &Bound<'_, PyAny>,
) -> PyResult<Option<PyPath>> {
    crate::points::single(target, "target")?;
    let mut paths = algorithm.paths(py, source, target, "target")?;
    Ok(paths.pop().flatten())
}

/// Reads an argument that must be a mesh.
pub(crate) fn mesh_of<'a, 'py>(value: &'a Bound<'py, PyAny>) -> PyResult<&'a Bound<'py, PyMesh>> {
    value.cast::<PyMesh>().map_err(|_| {
        PyTypeError::new_err(format!(
            "mesh: a geodesics.Mesh is needed, not {}",
            value
                .get_type()
                .name()
                .map_or_else(|_| "this".to_owned(), |name| name.to_string())
        ))
    })
}

/// The available algorithms: a list of dictionaries with `name`, `family`, `paper`, `exact`,
/// `summary` and `choose` (when to choose the algorithm).
///
/// Examples
/// --------
/// >>> import geodesics as gd
/// >>> "vtp-fast" in [row["name"] for row in gd.algorithms() if row["exact"]]
/// True
#[pyfunction]
pub(crate) fn algorithms(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let rows = registry::algorithms().iter().map(|algorithm| {
        let row = PyDict::new(py);
        row.set_item("name", algorithm.name)?;
        row.set_item("family", algorithm.family)?;
        row.set_item("paper", algorithm.paper)?;
        row.set_item("exact", algorithm.exact)?;
        row.set_item("summary", algorithm.summary)?;
        row.set_item("choose", algorithm.choose)?;
        Ok(row)
    });
    rows.collect()
}
