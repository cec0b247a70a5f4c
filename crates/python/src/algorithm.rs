//! Distances and paths by an algorithm on a mesh, for the classes `Mesh` and `Solver`.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use geobench_harness::measure::number::counted;
use geobench_registry::{self as registry, MOST_THREADS, Selection, SimdChoice};
use geodesics::mesh::Insertion;
use geodesics::paths::Through;
use geodesics::{Goal, Mesh, Path, PathError, Paths, SolveError, Solver as Solve, Stop, VertexId};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::{PyImportError, PyMemoryError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::curve::{curves, listed};
use crate::errors::{PrecisionWarning, path_error, solve_error};
use crate::interrupt;
use crate::path::{PyPath, tuples};
use crate::points::{Finder, ResolvedPoints, SharedMesh, several, single, together};
use crate::pool::{Runs, SolverPool, SparseRows, doubt, goal, lock, matrix, nearest, row, sparse};

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

    pub(crate) fn mesh(&self) -> &Mesh {
        &self.surface.mesh
    }

    pub(crate) fn together(&self, source: &Bound<'_, PyAny>) -> PyResult<ResolvedPoints> {
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
        let source = &listed(source)?;
        if let Some(curves) = curves(source)? {
            return self.distance_from_curves(py, curves, radius, targets, with_nearest);
        }
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
                "targets: {}, but {}",
                counted(targets.len(), "point"),
                counted(sources.len(), "source")
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

    /// The logarithmic map at a point.
    pub(crate) fn log_map(
        &self,
        py: Python<'_>,
        source: &Bound<'_, PyAny>,
    ) -> PyResult<Py<PyArray2<f64>>> {
        let spec = single(source, "source")?;
        let source = Finder::new(py, &self.surface).find(spec, "source")?;
        let insertion = (self.mesh().insertion(&[source]))
            .map_err(|error| PyValueError::new_err(error.to_string()))?;
        let stop = Stop::default();
        let goal = goal(None, None, &stop)?;
        let pool = Arc::clone(&self.kept);
        let work = move || -> Result<(Vec<[f64; 2]>, Option<String>), SolveError> {
            pool.at(insertion, |solver, refined| {
                let paths = Paths::find(solver, &refined.mesh, &refined.vertices, &goal)?;
                let doubt = doubt(&refined.mesh, paths.distances());
                Ok((paths.log_map(&source, refined), doubt))
            })
        };
        let (map, doubt) =
            interrupt::call(py, self.mesh().face_count(), &stop, work)?.map_err(solve_error)?;
        warn(py, doubt)?;
        tuples(py, &map)
    }

    /// The path through all points of `source`.
    fn path_through(
        &self,
        py: Python<'_>,
        points: &Bound<'_, PyAny>,
        through: Through,
    ) -> PyResult<Option<PyPath>> {
        let specs = several(points, "source", self.mesh().vertex_count())?;
        if specs.len() < 2 {
            return Err(PyValueError::new_err(
                "target: it is missing; a path without one needs two or more points to pass",
            ));
        }
        let points = ResolvedPoints::new(py, &self.surface, specs, "source", None)?;
        let stop = Stop::default();
        let pool = Arc::clone(&self.kept);
        let (insertion, ways) = (points.insertion, points.sources);
        let faces = self.mesh().face_count().saturating_mul(ways.len() + 1);
        let work = {
            let stop = stop.clone();
            move || -> Result<Option<Path>, PathError> {
                pool.at(insertion, |solver, refined| {
                    through.path(refined, &ways, |[from, to]| {
                        let goal = Goal::targets([to]).unless(&stop);
                        let found = Paths::find(solver, &refined.mesh, from, &goal)?;
                        found.to(to).map_err(PathError::from)
                    })
                })
            }
        };
        let path = interrupt::call(py, faces, &stop, work)?.map_err(path_error)?;
        path.map(|path| PyPath::new(py, self.mesh(), &path))
            .transpose()
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

/// The shortest path to one target, or without a target through the points of `source`. An error if
/// `target` is a sequence.
pub(crate) fn one_path(
    algorithm: &MeshAlgorithm,
    py: Python<'_>,
    source: &Bound<'_, PyAny>,
    target: Option<&Bound<'_, PyAny>>,
    through: Through,
) -> PyResult<Option<PyPath>> {
    let Some(target) = target else {
        return algorithm.path_through(py, source, through);
    };
    let mistake = match through {
        Through { closed: true, .. } => {
            Some("closed: a path to a target cannot be closed; leave out the target")
        }
        Through { shorten: true, .. } => {
            Some("shorten: a path to a target is a shortest one already; leave out the target")
        }
        _ => None,
    };
    if let Some(mistake) = mistake {
        return Err(PyValueError::new_err(mistake));
    }
    single(target, "target")?;
    let mut paths = algorithm.paths(py, source, target, "target")?;
    Ok(paths.pop().flatten())
}
