//! Shortest paths.

use geodesics::{Mesh, Path};
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// A shortest path on a surface. Its points are, in order, the source, a point for each edge that
/// the path crosses and each vertex that it passes, and the target. The path is straight between
/// them.
#[pyclass(frozen, module = "geodesics", name = "Path")]
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
            point.face.map_or(weights, |face| mesh.in_file(face, weights).1)
        });
        let barycentric: Vec<[f64; 3]> = in_file.collect();
        Ok(Self {
            length: path.length,
            points: triples(py, &path.polyline(mesh))?,
            faces: PyArray1::from_iter(py, faces).unbind(),
            barycentric: triples(py, &barycentric)?,
            vertices: PyArray1::from_iter(py, vertices).unbind(),
            count: path.points.len(),
        })
    }
}

/// A new `(n, 3)` array with a copy of `rows`.
pub(crate) fn triples<T: numpy::Element + Copy>(
    py: Python<'_>,
    rows: &[[T; 3]],
) -> PyResult<Py<PyArray2<T>>> {
    use numpy::PyArrayMethods;
    let flat = PyArray1::from_slice(py, rows.as_flattened());
    let array = flat.reshape([rows.len(), 3]);
    Ok(array
        .map_err(|error| PyValueError::new_err(error.to_string()))?
        .unbind())
}

#[pymethods]
impl PyPath {
    fn __len__(&self) -> usize {
        self.count
    }

    fn __repr__(&self) -> String {
        format!(
            "<geodesics.Path of length {}, {} points>",
            self.length, self.count
        )
    }
}
