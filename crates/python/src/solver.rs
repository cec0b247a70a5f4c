//! The class `Solver`: distances, paths, counters and profiles by an algorithm that is set up once.

use std::sync::Arc;

use geobench_harness::measure::number::counted;
use geobench_registry as registry;
use geodesics::paths::Through;
use geodesics::window::{Counter, Counters, Observer, PhaseSampler};
use geodesics::{Goal, Stop};
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::{PyOSError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::algorithm::{MeshAlgorithm, named, one_path, selection};
use crate::errors::solve_error;
use crate::field;
use crate::interrupt;
use crate::mesh::PyMesh;
use crate::path::PyPath;
use crate::points::core;
use crate::pool::goal;

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
    /// source, radius, targets, nearest
    ///     As for `Mesh.distance`.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (n,), float64, or Nearest
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
    /// sources, threads, radius, targets, sparse
    ///     As for `Mesh.distances`.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (k, n), float64, or scipy.sparse.csr_array
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
    /// points, threads
    ///     As for `Mesh.distance_matrix`.
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
    /// sources, targets, threads
    ///     As for `Mesh.pairs`.
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

    /// The distance from the nearest source as a field; see `Mesh.field`. MMP runs, whatever the
    /// algorithm of the solver.
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

    /// The shortest path from the nearest source to `target`; `None` if it is unreachable. Without
    /// a target the path through all points of `source`, as in `Mesh.path`.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> path = gd.Solver(gd.generate("grid,n=4")).path(0, 17)
    /// >>> path.points.shape
    /// (5, 3)
    #[pyo3(signature = (source, target = None, *, closed = false, shorten = false))]
    fn path(
        &self,
        py: Python<'_>,
        source: &Bound<'_, PyAny>,
        target: Option<&Bound<'_, PyAny>>,
        closed: bool,
        shorten: bool,
    ) -> PyResult<Option<PyPath>> {
        let through = Through { closed, shorten };
        one_path(&self.algorithm, py, source, target, through)
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

    /// The logarithmic map at a point: where each vertex is in the plane around `source`, at its
    /// distance and in the direction in which a shortest path to it starts.
    ///
    /// Parameters
    /// ----------
    /// source : int or Point
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (n, 2), float64
    ///     The origin for the source, NaN for unreachable vertices. If several paths are shortest,
    ///     one of them counts. Angles are counter-clockwise, from an edge or side at the source; at
    ///     a vertex inside the surface they are normalised to a full turn (Polthier and Schmies).
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> import numpy as np
    /// >>> places = gd.Solver(gd.generate("grid,n=4")).log_map(12)
    /// >>> np.linalg.norm(places[0] - places[24]).round(6)
    /// np.float64(5.656854)
    fn log_map(&self, py: Python<'_>, source: &Bound<'_, PyAny>) -> PyResult<Py<PyArray2<f64>>> {
        self.algorithm.log_map(py, source)
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
            "<geodesics.Solver {} for {}, {}>",
            self.algorithm(),
            counted(mesh.vertex_count(), "vertex"),
            counted(mesh.face_count(), "face")
        )
    }
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
