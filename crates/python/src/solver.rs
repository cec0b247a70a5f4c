//! Solvers: distances, paths, counters and profiles.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

use geobench_registry::{self as registry, MOST_THREADS, Selection, SimdChoice};
use geodesics::window::{Counter, Counters, Observer, PhaseSampler, precision};
use geodesics::{Goal, Mesh, Path, PathError, Paths, SolveError, Solver as Solve, Stop, VertexId};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::{PyMemoryError, PyOSError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::{PrecisionWarning, path_error, solve_error};
use crate::interrupt;
use crate::mesh::PyMesh;
use crate::path::PyPath;
use crate::points::{ResolvedPoints, several, together};

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

    /// The text of a warning if `distances` are imprecise.
    fn doubt(&self, distances: &[f64]) -> Option<String> {
        precision::doubt(&self.mesh, distances).map(|doubt| doubt.to_string())
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
}

/// The algorithm with this name and parameters, for example `fwp-mmp{kmax=5000}`.
pub(crate) fn selection(
    mesh: &Mesh,
    name: Option<&str>,
    threads: Option<u32>,
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

pub(crate) fn check_threads(threads: u32) -> PyResult<usize> {
    if (1..=MOST_THREADS).contains(&threads) {
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
    pool: &SolverPool,
    sources: &[VertexId],
    goal: &Goal,
    vertices: usize,
) -> Result<Row, SolveError> {
    let mut distances = pool
        .with(|solver| solver.solve_until(sources, goal))?
        .distances;
    let doubt = pool.doubt(&distances);
    if let Some(targets) = goal.vertices() {
        let of_targets = targets.iter().map(|v| distances[v.index()]).collect();
        return Ok((of_targets, doubt));
    }
    distances.truncate(vertices);
    Ok((distances, doubt))
}

/// Computes a row of distances for each source in `workers` threads. The rows stand one after the
/// other in `all`, whose memory is reserved by the caller. Once `stop` is set, the remaining rows
/// stay infinite. Once a row has failed, no other is begun.
fn matrix(
    pool: &SolverPool,
    sources: &[VertexId],
    goal: &Goal,
    vertices: usize,
    workers: usize,
    stop: &Stop,
    mut all: Vec<f64>,
) -> Result<Row, SolveError> {
    let columns = goal.vertices().map_or(vertices, <[_]>::len);
    all.resize(sources.len() * columns, f64::INFINITY);
    let rows = Mutex::new(all.chunks_mut(columns.max(1)).zip(sources));
    let failed = Mutex::new(None);
    let doubts = Mutex::new(None);
    let work = || {
        loop {
            if stop.is_set() || lock(&failed).is_some() {
                break;
            }
            let Some((place, &source)) = lock(&rows).next() else {
                break;
            };
            match row(pool, &[source], goal, vertices) {
                Ok((distances, doubt)) => {
                    place.copy_from_slice(&distances);
                    if let Some(doubt) = doubt {
                        *lock(&doubts) = Some(doubt);
                    }
                }
                Err(error) => *lock(&failed) = Some(error),
            }
        }
    };
    thread::scope(|scope| {
        for _ in 1..workers {
            scope.spawn(work);
        }
        work();
    });
    if let Some(error) = failed.into_inner().unwrap_or_else(PoisonError::into_inner) {
        return Err(error);
    }
    let doubt = doubts.into_inner().unwrap_or_else(PoisonError::into_inner);
    Ok((all, doubt))
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

/// An algorithm on a mesh. Sources and targets that are not vertices need solvers on a refined
/// mesh.
#[derive(Clone)]
pub(crate) struct MeshAlgorithm {
    pub(crate) mesh: Mesh,
    /// The solvers on `mesh`, which are kept from call to call.
    pub(crate) kept: Arc<SolverPool>,
}

impl MeshAlgorithm {
    pub(crate) fn new(mesh: &Mesh, selection: &Selection) -> Self {
        Self {
            mesh: mesh.clone(),
            kept: SolverPool::new(selection, mesh),
        }
    }

    /// The solvers for the refined mesh of a call: the kept ones if no vertex was inserted, else a
    /// new pool.
    fn pool(&self, points: &ResolvedPoints) -> Arc<SolverPool> {
        if points.refined.mesh.vertex_count() == self.mesh.vertex_count() {
            return Arc::clone(&self.kept);
        }
        SolverPool::new(&self.kept.selection, &points.refined.mesh)
    }

    pub(crate) fn distance<'py>(
        &self,
        py: Python<'py>,
        source: &Bound<'py, PyAny>,
        radius: Option<f64>,
        targets: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let targets = targets.map(|targets| (targets, "targets"));
        let points =
            ResolvedPoints::new(&self.mesh, together(source, "source")?, "source", targets)?;
        let stop = Stop::default();
        let goal = goal(radius, points.targets.as_deref(), &stop)?;
        let pool = self.pool(&points);
        let (vertices, faces) = (self.mesh.vertex_count(), self.mesh.face_count());
        let work = move || row(&pool, &points.sources, &goal, vertices);
        let (distances, doubt) = interrupt::call(py, faces, &stop, work)?.map_err(solve_error)?;
        warn(py, doubt)?;
        Ok(PyArray1::from_vec(py, distances))
    }

    pub(crate) fn distances<'py>(
        &self,
        py: Python<'py>,
        sources: &Bound<'py, PyAny>,
        threads: u32,
        radius: Option<f64>,
        targets: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let threads = check_threads(threads)?;
        let targets = targets.map(|targets| (targets, "targets"));
        let points =
            ResolvedPoints::new(&self.mesh, several(sources, "sources")?, "sources", targets)?;
        let stop = Stop::default();
        let goal = goal(radius, points.targets.as_deref(), &stop)?;
        let workers = threads.min(points.sources.len());
        let mut pool = self.pool(&points);
        if threads / workers > 1 {
            // A parallel algorithm uses several threads for each source.
            let selection = self.kept.selection.clone().with_threads(threads / workers);
            if selection.threads() > 1 && selection.threads() != self.kept.selection.threads() {
                pool = SolverPool::new(&selection, &pool.mesh);
            }
        }
        let (vertices, faces) = (self.mesh.vertex_count(), self.mesh.face_count());
        let rows = points.sources.len();
        let columns = points.targets.as_ref().map_or(vertices, Vec::len);
        let mut all = Vec::new();
        if all.try_reserve_exact(rows.saturating_mul(columns)).is_err() {
            return Err(PyMemoryError::new_err(format!(
                "{rows} x {columns} distances do not fit into memory; ask for fewer sources or \
                 name targets"
            )));
        }
        let work = {
            let stop = stop.clone();
            move || matrix(&pool, &points.sources, &goal, vertices, workers, &stop, all)
        };
        let work_faces = faces.saturating_mul(rows);
        let (all, doubt) = interrupt::call(py, work_faces, &stop, work)?.map_err(solve_error)?;
        warn(py, doubt)?;
        PyArray1::from_vec(py, all).reshape([rows, columns])
    }

    /// The shortest paths from the nearest source to each target; `None` for unreachable targets.
    pub(crate) fn paths(
        &self,
        py: Python<'_>,
        source: &Bound<'_, PyAny>,
        targets: &Bound<'_, PyAny>,
        targets_name: &str,
    ) -> PyResult<Vec<Option<PyPath>>> {
        let targets = Some((targets, targets_name));
        let points =
            ResolvedPoints::new(&self.mesh, together(source, "source")?, "source", targets)?;
        let stop = Stop::default();
        let goal = goal(None, points.targets.as_deref(), &stop)?;
        let pool = self.pool(&points);
        let mesh = self.mesh.clone();
        let work = move || -> Result<(Vec<Option<Path>>, Option<String>), PathError> {
            let found =
                pool.with(|solver| Paths::find(solver, &pool.mesh, &points.sources, &goal))?;
            let doubt = pool.doubt(found.distances());
            let is_refined = pool.mesh.vertex_count() > mesh.vertex_count();
            let of_original = |path: Path| {
                if is_refined {
                    path.of_original(&points.refined)
                } else {
                    path
                }
            };
            let targets = points.targets.iter().flatten();
            let paths = targets.map(|&target| Ok(found.to(target)?.map(of_original)));
            Ok((paths.collect::<Result<_, PathError>>()?, doubt))
        };
        let (paths, doubt) =
            interrupt::call(py, self.mesh.face_count(), &stop, work)?.map_err(path_error)?;
        warn(py, doubt)?;
        let paths = paths.into_iter();
        paths
            .map(|path| {
                path.map(|path| PyPath::new(py, &self.mesh, &path))
                    .transpose()
            })
            .collect()
    }
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
///     Number of threads of a parallel algorithm (`"pvtp"`).
/// simd : {"auto", "scalar", "avx2", "avx512"}
///     The widest vector instructions to use. `"auto"` is the widest that the processor has.
///
/// Raises
/// ------
/// ValueError
///     The algorithm does not exist, or a parameter, `threads` or `simd` is out of range.
#[pyclass(frozen, module = "geodesics", name = "Solver")]
pub(crate) struct PySolver {
    algorithm: MeshAlgorithm,
    mesh: Py<PyMesh>,
}

#[pymethods]
impl PySolver {
    #[new]
    #[pyo3(signature = (mesh, algorithm = None, *, threads = None, simd = "auto"))]
    fn new(
        py: Python<'_>,
        mesh: &Bound<'_, PyAny>,
        algorithm: Option<&str>,
        threads: Option<u32>,
        simd: &str,
    ) -> PyResult<Self> {
        let mesh = mesh_of(mesh)?;
        let selection = selection(&mesh.get().mesh, algorithm, threads, simd)?;
        let solver = MeshAlgorithm::new(&mesh.get().mesh, &selection);
        let pool = Arc::clone(&solver.kept);
        // Set up the first solver now and put it into the pool.
        let faces = solver.mesh.face_count();
        interrupt::call(py, faces, &Stop::default(), move || pool.with(|_| ()))?;
        Ok(Self {
            algorithm: solver,
            mesh: mesh.clone().unbind(),
        })
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
    ///     `at`). If a source or target is not a vertex, the algorithm is set up again for this
    ///     call.
    /// radius : float, optional
    ///     The search ends at this distance, in units of the mesh. Greater distances are `inf`.
    /// targets : int, Point or sequence of these, optional
    ///     Compute only the distances of these points. The search ends when all are reached.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (n,), float64
    ///     The distance of each of the n vertices, or of each target, in units of the mesh; `inf`
    ///     if it is unreachable or beyond the radius.
    ///
    /// Raises
    /// ------
    /// IndexError
    ///     A vertex or face does not exist.
    /// ValueError, TypeError
    ///     An argument is out of range or has the wrong type.
    #[pyo3(signature = (source, *, radius = None, targets = None))]
    fn distance<'py>(
        &self,
        py: Python<'py>,
        source: &Bound<'py, PyAny>,
        radius: Option<f64>,
        targets: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.algorithm.distance(py, source, radius, targets)
    }

    /// Distances from each source separately, one row per source.
    ///
    /// Parameters
    /// ----------
    /// sources : sequence of int or Point
    /// threads : int
    ///     The number of sources that are solved at the same time. If it is at least twice the
    ///     number of sources, a parallel algorithm uses several threads per source.
    /// radius, targets
    ///     As for `distance`.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (k, n), float64
    ///     Row i has the distances of the n vertices, or of the targets, from source i, in units of
    ///     the mesh.
    #[pyo3(signature = (sources, *, threads = 1, radius = None, targets = None))]
    fn distances<'py>(
        &self,
        py: Python<'py>,
        sources: &Bound<'py, PyAny>,
        threads: u32,
        radius: Option<f64>,
        targets: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.algorithm
            .distances(py, sources, threads, radius, targets)
    }

    /// The shortest path from the nearest source to `target`; `None` if it is unreachable.
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
    fn count<'py>(
        &self,
        py: Python<'py>,
        source: &Bound<'py, PyAny>,
    ) -> PyResult<(Bound<'py, PyArray1<f64>>, Bound<'py, PyDict>)> {
        let points = ResolvedPoints::new(
            &self.algorithm.mesh,
            together(source, "source")?,
            "source",
            None,
        )?;
        let stop = Stop::default();
        let goal = goal(None, None, &stop)?;
        let pool = self.algorithm.pool(&points);
        let work = move || {
            let mut counters = Counters::default();
            let observer = Observer::Counters(&mut counters);
            let solution = pool.with(|solver| solver.run(&points.sources, &goal, observer))?;
            Ok((solution, counters))
        };
        let faces = self.algorithm.mesh.face_count();
        let (solution, counters) = interrupt::call(py, faces, &stop, work)?.map_err(solve_error)?;
        let dictionary = PyDict::new(py);
        for &counter in Counter::ALL {
            if let Some(value) = counters.get(counter) {
                dictionary.set_item(counter.key(), value)?;
            }
        }
        let mut distances = solution.distances;
        distances.truncate(self.algorithm.mesh.vertex_count());
        Ok((PyArray1::from_vec(py, distances), dictionary))
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
    fn profile<'py>(
        &self,
        py: Python<'py>,
        source: &Bound<'py, PyAny>,
    ) -> PyResult<(Bound<'py, PyArray1<f64>>, Bound<'py, PyDict>)> {
        let points = ResolvedPoints::new(
            &self.algorithm.mesh,
            together(source, "source")?,
            "source",
            None,
        )?;
        let pool = self.algorithm.pool(&points);
        let work = move || {
            let mut sampler = PhaseSampler::start()?;
            let (goal, observer) = (Goal::everything(), Observer::Phases(&mut sampler));
            let solution = pool.with(|solver| solver.run(&points.sources, &goal, observer));
            Ok((solution, sampler.phases()))
        };
        let faces = self.algorithm.mesh.face_count();
        let result: Result<_, std::io::Error> = interrupt::call(py, faces, &Stop::default(), work)?;
        let (solution, phases) = result.map_err(|error| PyOSError::new_err(error.to_string()))?;
        let mut distances = solution.map_err(solve_error)?.distances;
        distances.truncate(self.algorithm.mesh.vertex_count());
        let seconds = PyDict::new(py);
        seconds.set_item("propagation", phases.propagation.as_secs_f64())?;
        seconds.set_item("pruning", phases.pruning.as_secs_f64())?;
        seconds.set_item("management", phases.management.as_secs_f64())?;
        Ok((PyArray1::from_vec(py, distances), seconds))
    }

    fn __repr__(&self) -> String {
        let mesh = &self.algorithm.mesh;
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
