//! Fields: the distance of every point of a surface, after one solve.

use std::sync::Arc;

use geobench_harness::exec::point::PointSpec;
use geobench_harness::measure::number::counted;
use geodesics::window::precision;
use geodesics::{DistanceField, FieldError, Path, Stop, SurfacePoint};
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

use crate::algorithm::warn;
use crate::errors::solve_error;
use crate::interrupt;
use crate::isolines::{self, PyIsoline, WantedLevels};
use crate::mesh::PyMesh;
use crate::path::{PyPath, tuples};
use crate::points::{Finder, PyPoint, core, several, single, together};

/// The exact distance from the nearest source to every point of a surface, with all windows of a
/// run of MMP. `Mesh.field` and `Solver.field` make it.
///
/// Examples
/// --------
/// >>> import geodesics as gd
/// >>> field = gd.generate("grid,n=4").field(0)
/// >>> field
/// <geodesics.Field from 1 source for 25 vertices, 32 faces>
/// >>> field.distance([0, 4]).round(3)
/// array([0., 4.])
#[pyclass(frozen, weakref, module = "geodesics", name = "Field")]
pub(crate) struct PyField {
    field: Arc<DistanceField>,
    mesh: Py<PyMesh>,
    sources: Vec<PointSpec>,
    /// (n,) float64: the distance of each vertex, in units of the mesh; `inf` if it is unreachable.
    #[pyo3(get)]
    distances: Py<PyArray1<f64>>,
}

/// A pickled field: computed again.
#[pyfunction]
pub(crate) fn _field(mesh: &Bound<'_, PyMesh>, source: &Bound<'_, PyAny>) -> PyResult<PyField> {
    PyField::new(mesh.py(), mesh, source)
}

impl PyField {
    pub(crate) fn new(
        py: Python<'_>,
        mesh: &Bound<'_, PyMesh>,
        source: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let surface = &mesh.get().surface;
        let sources = together(source, "source", surface.mesh.vertex_count())?;
        let points = Finder::new(py, surface).find_all(sources.clone(), "source")?;
        let whole = surface.mesh.clone();
        let work = move || DistanceField::new(&whole, &points);
        let faces = surface.mesh.face_count();
        let field = interrupt::call(py, faces, &Stop::default(), work)?;
        let field = field.map_err(|error| match error {
            FieldError::Solve(error) => solve_error(error),
            other => PyValueError::new_err(format!("source: {other}")),
        })?;
        let doubt = precision::doubt(&surface.mesh, field.distances());
        warn(py, doubt.map(|doubt| doubt.to_string()))?;
        Ok(Self {
            distances: PyArray1::from_slice(py, field.distances()).unbind(),
            field: Arc::new(field),
            mesh: mesh.clone().unbind(),
            sources,
        })
    }

    pub(crate) fn lines(&self, py: Python<'_>, asked: WantedLevels) -> PyResult<Vec<PyIsoline>> {
        isolines::lines(py, &self.field, asked)
    }

    fn points(&self, py: Python<'_>, points: &Bound<'_, PyAny>) -> PyResult<Vec<SurfacePoint>> {
        let surface = &self.mesh.get().surface;
        let specs = several(points, "points", surface.mesh.vertex_count())?;
        Finder::new(py, surface).find_all(specs, "points")
    }

    fn path_of(&self, py: Python<'_>, path: Option<Path>) -> PyResult<Option<PyPath>> {
        let mesh = &self.mesh.get().surface.mesh;
        path.map(|path| PyPath::new(py, mesh, &path)).transpose()
    }
}

#[pymethods]
impl PyField {
    /// Mesh: the mesh.
    #[getter]
    fn mesh(&self, py: Python<'_>) -> Py<PyMesh> {
        self.mesh.clone_ref(py)
    }

    /// list of Point: the sources.
    #[getter]
    fn sources(&self) -> Vec<PyPoint> {
        self.sources.iter().copied().map(PyPoint).collect()
    }

    /// Distances of points of the surface.
    ///
    /// Parameters
    /// ----------
    /// points : int, Point, sequence of these, or array
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (k,), float64
    ///     In units of the mesh; `inf` if unreachable. Of a single point a number.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> field = gd.generate("grid,n=4").field(0)
    /// >>> field.distance([gd.edge(0, 1, 0.25), 24])
    /// array([0.25      , 5.65685425])
    fn distance<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let is_one = single(points, "points").is_ok();
        let points = self.points(py, points)?;
        let field = Arc::clone(&self.field);
        let found = py.detach(|| {
            let each = points.iter().map(|point| field.distance(point));
            each.collect::<Result<Vec<f64>, _>>()
        });
        let found = found.map_err(|error| PyValueError::new_err(format!("points: {error}")))?;
        if is_one {
            return py.import("numpy")?.call_method1("float64", (found[0],));
        }
        Ok(PyArray1::from_vec(py, found).into_any())
    }

    /// Gradients of the distance at points of the surface: unit vectors in the tangent plane, away
    /// from the source.
    ///
    /// Parameters
    /// ----------
    /// points : int, Point, sequence of these, or array
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (k, 3), float64
    ///     At an edge that in one of the faces, at a vertex that in a face through which a shortest
    ///     path comes; NaN at sources and where no path leads.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> mesh = gd.generate("grid,n=4")
    /// >>> abs(mesh.field(0).gradient(gd.edge(0, 1, 0.5))).round(12)
    /// array([[1., 0., 0.]])
    fn gradient<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
    ) -> PyResult<Py<PyArray2<f64>>> {
        let points = self.points(py, points)?;
        let field = Arc::clone(&self.field);
        let found = py.detach(|| {
            let each = points.iter().map(|point| {
                let gradient = field.gradient(point)?;
                Ok(gradient.unwrap_or([f64::NAN; 3]))
            });
            each.collect::<Result<Vec<[f64; 3]>, geodesics::PointError>>()
        });
        let found = found.map_err(|error| PyValueError::new_err(format!("points: {error}")))?;
        tuples(py, &found)
    }

    /// The shortest path from the nearest source to a point; `None` if it is unreachable.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> field = gd.generate("grid,n=4").field(0)
    /// >>> round(field.path(4).length, 3)
    /// 4.0
    fn path(&self, py: Python<'_>, point: &Bound<'_, PyAny>) -> PyResult<Option<PyPath>> {
        single(point, "point")?;
        Ok(self.paths(py, point)?.pop().flatten())
    }

    /// The shortest path to each point: a list with a `Path` for each, or `None`.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> field = gd.generate("grid,n=4").field(0)
    /// >>> [round(path.length, 3) for path in field.paths([4, 20])]
    /// [4.0, 4.0]
    fn paths(&self, py: Python<'_>, points: &Bound<'_, PyAny>) -> PyResult<Vec<Option<PyPath>>> {
        let points = self.points(py, points)?;
        let field = Arc::clone(&self.field);
        let found = py.detach(|| {
            let each = points.iter().map(|point| field.path(point));
            each.collect::<Result<Vec<_>, _>>()
        });
        let found = found.map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
        found
            .into_iter()
            .map(|path| self.path_of(py, path))
            .collect()
    }

    /// Isolines, as those of `Mesh.isolines`.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> field = gd.generate("grid,n=4").field(0)
    /// >>> [isoline.distance for isoline in field.isolines(every=2.0)]
    /// [2.0, 4.0]
    #[pyo3(signature = (*, every = None, levels = None))]
    fn isolines(
        &self,
        py: Python<'_>,
        every: Option<f64>,
        levels: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Vec<PyIsoline>> {
        self.lines(py, isolines::levels(every, levels)?)
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, (Py<PyMesh>, Vec<PyPoint>))> {
        let made = core(py)?.getattr("_field")?;
        Ok((made, (self.mesh.clone_ref(py), self.sources())))
    }

    fn __repr__(&self) -> String {
        let mesh = &self.mesh.get().surface.mesh;
        format!(
            "<geodesics.Field from {} for {}, {}>",
            counted(self.sources.len(), "source"),
            counted(mesh.vertex_count(), "vertex"),
            counted(mesh.face_count(), "face")
        )
    }
}
