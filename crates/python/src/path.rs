//! Paths.

use geobench_harness::measure::number::counted;
use geodesics::{Mesh, Path};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::points::core;

/// A path on a surface. Its points are, in order, the source, a point for each edge that the path
/// crosses and each vertex that it passes, and the target. The path is straight between them.
/// `numpy.asarray(path)` and iteration give the points.
///
/// Examples
/// --------
/// >>> import geodesics as gd
/// >>> path = gd.generate("grid,n=4").path(0, 4)
/// >>> path.length, path.points.shape
/// (4.0, (5, 3))
#[pyclass(frozen, weakref, module = "geodesics", name = "Path")]
pub(crate) struct PyPath {
    /// float: its length, in units of the mesh.
    #[pyo3(get)]
    length: f64,
    /// (k, 3) float64: the positions of its points, in units of the mesh.
    #[pyo3(get)]
    points: Py<PyArray2<f64>>,
    /// (k,) int64: a face that contains each point; -1 for an isolated vertex.
    #[pyo3(get)]
    faces: Py<PyArray1<i64>>,
    /// (k, 3) float64: the barycentric coordinates of each point in that face.
    #[pyo3(get)]
    barycentric: Py<PyArray2<f64>>,
    /// (k,) int64: the number of the vertex at each point; -1 if the point is not a vertex.
    #[pyo3(get)]
    vertices: Py<PyArray1<i64>>,
    count: usize,
}

/// A pickled path.
#[pyfunction]
pub(crate) fn _path(
    length: f64,
    points: &Bound<'_, PyArray2<f64>>,
    faces: &Bound<'_, PyArray1<i64>>,
    barycentric: &Bound<'_, PyArray2<f64>>,
    vertices: &Bound<'_, PyArray1<i64>>,
) -> PyPath {
    PyPath {
        length,
        points: points.clone().unbind(),
        faces: faces.clone().unbind(),
        barycentric: barycentric.clone().unbind(),
        vertices: vertices.clone().unbind(),
        count: faces.len(),
    }
}

impl PyPath {
    pub(crate) fn new(py: Python<'_>, mesh: &Mesh, path: &Path) -> PyResult<Self> {
        let points = path.points.iter();
        let faces = points
            .clone()
            .map(|p| p.face.map_or(-1, |f| i64::from(mesh.file_triangle(f))));
        let vertices = points
            .clone()
            .map(|p| p.vertex().map_or(-1, |v| i64::from(v.raw())));
        let in_file = points.map(|point| {
            let weights = point.barycentric;
            point
                .face
                .map_or(weights, |face| mesh.in_file(face, weights).1)
        });
        let barycentric: Vec<[f64; 3]> = in_file.collect();
        Ok(Self {
            length: path.length,
            points: tuples(py, &path.polyline(mesh))?,
            faces: PyArray1::from_iter(py, faces).unbind(),
            barycentric: tuples(py, &barycentric)?,
            vertices: PyArray1::from_iter(py, vertices).unbind(),
            count: path.points.len(),
        })
    }
}

/// A new `(n, N)` array with a copy of `rows`.
pub(crate) fn tuples<T: numpy::Element + Copy, const N: usize>(
    py: Python<'_>,
    rows: &[[T; N]],
) -> PyResult<Py<PyArray2<T>>> {
    let flat = PyArray1::from_slice(py, rows.as_flattened());
    let array = flat.reshape([rows.len(), N]);
    Ok(array
        .map_err(|error| PyValueError::new_err(error.to_string()))?
        .unbind())
}

#[pymethods]
impl PyPath {
    /// (3,) float64 or None: the direction in which it starts, a vector of length 1; `None` if it
    /// leads nowhere. `Mesh.trace` from there follows a path that passes no vertex.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> gd.generate("grid,n=4").path(0, 4).start_direction
    /// array([1., 0., 0.])
    #[getter]
    fn start_direction<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray1<f64>>>> {
        let points = self.points.bind(py).to_vec()?;
        let mut points = points.chunks_exact(3);
        let start = points.next().unwrap_or_default();
        let direction = points.find_map(|end| {
            let way: Vec<f64> = end.iter().zip(start).map(|(a, b)| a - b).collect();
            let length = way.iter().fold(0.0, |sum: f64, x| sum.hypot(*x));
            (length > 0.0).then(|| way.iter().map(|x| x / length).collect::<Vec<f64>>())
        });
        Ok(direction.map(|direction| PyArray1::from_vec(py, direction)))
    }

    fn __len__(&self) -> usize {
        self.count
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(self.points.bind(py).try_iter()?.into_any())
    }

    #[pyo3(signature = (dtype = None, copy = None))]
    fn __array__<'py>(
        &self,
        py: Python<'py>,
        dtype: Option<&Bound<'py, PyAny>>,
        copy: Option<bool>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let points = self.points.bind(py).as_any();
        if let Some(dtype) = dtype {
            return points.call_method1("astype", (dtype,));
        }
        if copy == Some(false) {
            return Ok(points.clone());
        }
        points.call_method0("copy")
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
    ) -> PyResult<(
        Bound<'py, PyAny>,
        (
            f64,
            Py<PyArray2<f64>>,
            Py<PyArray1<i64>>,
            Py<PyArray2<f64>>,
            Py<PyArray1<i64>>,
        ),
    )> {
        let state = (
            self.length,
            self.points.clone_ref(py),
            self.faces.clone_ref(py),
            self.barycentric.clone_ref(py),
            self.vertices.clone_ref(py),
        );
        Ok((core(py)?.getattr("_path")?, state))
    }

    fn __repr__(&self) -> String {
        format!(
            "<geodesics.Path of length {}, {}>",
            self.length,
            counted(self.count, "point")
        )
    }
}
