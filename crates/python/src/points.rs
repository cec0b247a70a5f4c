//! Sources and targets that are passed from Python.

use geobench_harness::exec::source::{Locator, PointSpec, distinct};
use geodesics::{Mesh, Refined, SurfacePoint, VertexId};
use pyo3::exceptions::{PyIndexError, PyTypeError, PyUserWarning, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyString};

/// A point of a surface, made by `vertex`, `edge`, `face` or `at`. Sources and targets are points
/// or numbers of vertices.
#[pyclass(frozen, eq, module = "geodesics", name = "Point", from_py_object)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PyPoint(pub(crate) PointSpec);

#[pymethods]
impl PyPoint {
    fn __repr__(&self) -> String {
        match self.0 {
            PointSpec::Vertex(v) => format!("vertex({v})"),
            PointSpec::Edge([a, b], t) => format!("edge({a}, {b}, {t:?})"),
            PointSpec::Face(face, [u, v, w]) => format!("face({face}, {u:?}, {v:?}, {w:?})"),
            PointSpec::At([x, y, z]) => format!("at({x:?}, {y:?}, {z:?})"),
            PointSpec::Far([x, y, z]) => format!("at({x:?}, {y:?}, {z:?}, far=True)"),
        }
    }

    fn __str__(&self) -> String {
        self.0.to_string()
    }

    fn __hash__(&self) -> u64 {
        use std::hash::{DefaultHasher, Hash, Hasher};
        let mut hasher = DefaultHasher::new();
        self.0.to_string().hash(&mut hasher);
        hasher.finish()
    }
}

/// Reads the number of a vertex or face. Error messages name the argument.
fn number(value: &Bound<'_, PyAny>, name: &str) -> PyResult<u32> {
    let is_number = value.hasattr("__index__")? && !value.is_instance_of::<PyBool>();
    let number = match value.extract::<i64>() {
        Ok(number) if is_number => number,
        _ => {
            return Err(PyTypeError::new_err(format!(
                "{name}: {} is not the number of an element",
                value.repr()?
            )));
        }
    };
    u32::try_from(number).map_err(|_| {
        PyIndexError::new_err(format!(
            "{name}: there is no number {number}; they start from 0"
        ))
    })
}

/// The point at vertex `v`. Sources and targets can also be given by the number alone.
#[pyfunction]
pub(crate) fn vertex(v: &Bound<'_, PyAny>) -> PyResult<PyPoint> {
    Ok(PyPoint(PointSpec::Vertex(number(v, "v")?)))
}

/// The point on the edge between vertices `a` and `b` at the fraction `t` of its length from `a`,
/// between 0 and 1.
#[pyfunction]
pub(crate) fn edge(a: &Bound<'_, PyAny>, b: &Bound<'_, PyAny>, t: f64) -> PyResult<PyPoint> {
    let ends = [number(a, "a")?, number(b, "b")?];
    if !(0.0..=1.0).contains(&t) {
        return Err(PyValueError::new_err(format!(
            "t: {t} is not a place on an edge; give a number from 0 to 1"
        )));
    }
    // -0 becomes 0: equal points have equal texts, and so equal hashes.
    Ok(PyPoint(PointSpec::Edge(ends, t + 0.0)))
}

/// The point of face `f` with barycentric coordinates `u`, `v`, `w`, in the order of the corners of
/// the face. Their sum must be 1.
#[pyfunction]
pub(crate) fn face(f: &Bound<'_, PyAny>, u: f64, v: f64, w: f64) -> PyResult<PyPoint> {
    for (name, x) in [("u", u), ("v", v), ("w", w)] {
        if !x.is_finite() {
            return Err(PyValueError::new_err(format!(
                "{name}: {x} is not a coordinate"
            )));
        }
    }
    let weights = [u, v, w].map(|x| x + 0.0);
    Ok(PyPoint(PointSpec::Face(number(f, "f")?, weights)))
}

/// The point of the surface nearest to the position `(x, y, z)`, in units of the mesh. A position
/// that is farther from the surface than the diagonal of its bounding box is an error, unless `far`.
#[pyfunction]
#[pyo3(signature = (x, y, z, *, far = false))]
pub(crate) fn at(x: f64, y: f64, z: f64, far: bool) -> PyResult<PyPoint> {
    for (name, x) in [("x", x), ("y", y), ("z", z)] {
        if !x.is_finite() {
            return Err(PyValueError::new_err(format!(
                "{name}: {x} is not a coordinate"
            )));
        }
    }
    let position = [x, y, z].map(|x| x + 0.0);
    Ok(PyPoint(if far {
        PointSpec::Far(position)
    } else {
        PointSpec::At(position)
    }))
}

/// Reads one point, the number of a vertex or a `PyPoint`; `None` if `value` is neither, and may be a
/// sequence.
fn one(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Option<PointSpec>> {
    if let Ok(point) = value.cast::<PyPoint>() {
        return Ok(Some(point.get().0));
    }
    if value.is_instance_of::<PyBool>() || value.is_instance_of::<PyString>() {
        return Err(not_a_point(value, name));
    }
    if value.hasattr("__index__")? {
        // Arrays have `__index__`, too. Those with several numbers cannot be extracted.
        let Ok(vertex) = value.extract::<i64>() else {
            return Ok(None);
        };
        let vertex = u32::try_from(vertex).map_err(|_| {
            PyIndexError::new_err(format!(
                "{name} vertex {vertex} does not exist: vertices are numbered from 0"
            ))
        })?;
        return Ok(Some(PointSpec::Vertex(vertex)));
    }
    Ok(None)
}

fn not_a_point(value: &Bound<'_, PyAny>, name: &str) -> PyErr {
    let shown = value
        .repr()
        .map_or_else(|_| "this".to_owned(), |text| text.to_string());
    PyTypeError::new_err(format!(
        "{name}: {shown} is no point; give the number of a vertex, or vertex(), edge(), face() or at()"
    ))
}

/// Reads one point or a sequence of points.
pub(crate) fn several(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<PointSpec>> {
    if let Some(point) = one(value, name)? {
        return Ok(vec![point]);
    }
    let Ok(items) = value.try_iter() else {
        return Err(not_a_point(value, name));
    };
    let mut points = Vec::new();
    for item in items {
        let item = item?;
        points.push(one(&item, name)?.ok_or_else(|| not_a_point(&item, name))?);
    }
    if points.is_empty() {
        return Err(PyValueError::new_err(format!(
            "{name}: empty; give at least one point"
        )));
    }
    Ok(points)
}

/// Reads the sources of one run, each once. A `UserWarning` names those given twice.
pub(crate) fn together(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<PointSpec>> {
    let points = several(value, name)?;
    let (points, notes) = distinct(points);
    warn_user(value.py(), name, &notes)?;
    Ok(points)
}

/// A `UserWarning` for each note on the argument `name`.
pub(crate) fn warn_user(py: Python<'_>, name: &str, notes: &[String]) -> PyResult<()> {
    for note in notes {
        let message = std::ffi::CString::new(format!("{name}: {note}"))?;
        PyErr::warn(py, &py.get_type::<PyUserWarning>(), &message, 1)?;
    }
    Ok(())
}

/// Reads one point.
pub(crate) fn single(value: &Bound<'_, PyAny>, name: &str) -> PyResult<PointSpec> {
    one(value, name)?.ok_or_else(|| not_a_point(value, name))
}

/// Finds points on a mesh.
pub(crate) struct Finder<'m> {
    mesh: &'m Mesh,
    locator: Locator<'m>,
}

impl<'m> Finder<'m> {
    pub(crate) const fn new(mesh: &'m Mesh) -> Self {
        Self {
            mesh,
            locator: Locator::new(mesh),
        }
    }

    pub(crate) fn find(&mut self, spec: PointSpec, name: &str) -> PyResult<SurfacePoint> {
        Ok(self.find_from(spec, name)?.0)
    }

    /// The point, and its distance from the position that was given; 0 for points given otherwise.
    pub(crate) fn find_from(
        &mut self,
        spec: PointSpec,
        name: &str,
    ) -> PyResult<(SurfacePoint, f64)> {
        if let PointSpec::Vertex(v) = spec {
            let vertices = self.mesh.vertex_count();
            if v as usize >= vertices {
                return Err(PyIndexError::new_err(format!(
                    "{name} vertex {v} does not exist: the mesh has {vertices} vertices, numbered \
                     from 0"
                )));
            }
        }
        match self.locator.locate(spec) {
            Ok(found) => Ok((found.point, found.from_position.unwrap_or(0.0))),
            Err(error) => {
                let message = format!("{name}: {error}");
                Err(if message.contains("does not exist") {
                    PyIndexError::new_err(message)
                } else {
                    PyValueError::new_err(message)
                })
            }
        }
    }
}

/// Sources and targets as vertices of a refined mesh.
pub(crate) struct ResolvedPoints {
    /// The mesh with a vertex inserted at each of them.
    pub(crate) refined: Refined,
    /// The sources as vertices of `refined`.
    pub(crate) sources: Vec<VertexId>,
    /// The targets as vertices of `refined`, if targets were given.
    pub(crate) targets: Option<Vec<VertexId>>,
}

impl ResolvedPoints {
    /// The points `sources`, called `source_name` in messages, and the targets.
    pub(crate) fn new(
        mesh: &Mesh,
        sources: Vec<PointSpec>,
        source_name: &str,
        targets: Option<(&Bound<'_, PyAny>, &str)>,
    ) -> PyResult<Self> {
        let mut finder = Finder::new(mesh);
        let mut points = Vec::new();
        for spec in sources {
            points.push(finder.find(spec, source_name)?);
        }
        let count = points.len();
        if let Some((targets, name)) = targets {
            for spec in several(targets, name)? {
                points.push(finder.find(spec, name)?);
            }
        }
        let refined = mesh
            .with_points(&points)
            .map_err(|error| PyValueError::new_err(error.to_string()))?;
        let (from, to) = refined.vertices.split_at(count);
        Ok(Self {
            sources: from.to_vec(),
            targets: targets.is_some().then(|| to.to_vec()),
            refined,
        })
    }
}
