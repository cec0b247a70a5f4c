//! Sources and targets that are passed from Python.

use std::sync::{Arc, OnceLock};

use geobench_harness::exec::point::{Locator, PointSpec};
use geobench_harness::exec::source::distinct;
use geodesics::mesh::Insertion;
use geodesics::{Mesh, NearestPoint, PointError, Refined, SurfacePoint, VertexId};
use numpy::{PyArrayDescrMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::{PyIndexError, PyTypeError, PyUserWarning, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyByteArray, PyBytes, PyMapping, PyMemoryView, PyString, PyTuple};

use crate::arrays;
use crate::curve::PyCurve;

/// A mesh, and the tree that finds the points of it nearest to positions, built on first use.
#[derive(Clone)]
pub(crate) struct SharedMesh {
    pub(crate) mesh: Mesh,
    tree: Arc<OnceLock<Arc<NearestPoint>>>,
}

impl SharedMesh {
    pub(crate) fn new(mesh: Mesh) -> Self {
        Self {
            mesh,
            tree: Arc::default(),
        }
    }

    /// The tree; built without the lock of the interpreter.
    pub(crate) fn tree(&self, py: Python<'_>) -> Result<Arc<NearestPoint>, PointError> {
        if let Some(tree) = self.tree.get() {
            return Ok(Arc::clone(tree));
        }
        let made = py.detach(|| NearestPoint::new(&self.mesh))?;
        Ok(Arc::clone(self.tree.get_or_init(|| Arc::new(made))))
    }
}

/// A point of a surface, made by `vertex`, `edge`, `face` or `at`. Sources and targets are points
/// or numbers of vertices.
///
/// Examples
/// --------
/// >>> import geodesics as gd
/// >>> gd.edge(4, 9, 0.25)
/// edge(4, 9, 0.25)
/// >>> gd.edge(4, 9, 0.25) == gd.edge(4, 9, 0.25)
/// True
#[pyclass(
    frozen,
    eq,
    weakref,
    module = "geodesics",
    name = "Point",
    from_py_object
)]
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

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, (u8, Vec<u32>, Vec<f64>))> {
        let state = match self.0 {
            PointSpec::Vertex(v) => (0, vec![v], vec![]),
            PointSpec::Edge(ends, t) => (1, ends.to_vec(), vec![t]),
            PointSpec::Face(face, weights) => (2, vec![face], weights.to_vec()),
            PointSpec::At(position) => (3, vec![], position.to_vec()),
            PointSpec::Far(position) => (4, vec![], position.to_vec()),
        };
        Ok((core(py)?.getattr("_point")?, state))
    }

    fn __hash__(&self) -> u64 {
        use std::hash::{DefaultHasher, Hash, Hasher};
        let mut hasher = DefaultHasher::new();
        self.0.to_string().hash(&mut hasher);
        hasher.finish()
    }
}

/// The module with the functions that make pickled objects anew.
pub(crate) fn core(py: Python<'_>) -> PyResult<Bound<'_, PyModule>> {
    py.import("geodesics._core")
}

/// A pickled point.
#[pyfunction]
pub(crate) fn _point(kind: u8, numbers: Vec<u32>, values: Vec<f64>) -> PyResult<PyPoint> {
    Ok(PyPoint(match (kind, &numbers[..], &values[..]) {
        (0, &[v], []) => PointSpec::Vertex(v),
        (1, &[a, b], &[t]) => PointSpec::Edge([a, b], t),
        (2, &[face], &[u, v, w]) => PointSpec::Face(face, [u, v, w]),
        (3, [], &[x, y, z]) => PointSpec::At([x, y, z]),
        (4, [], &[x, y, z]) => PointSpec::Far([x, y, z]),
        _ => return Err(PyValueError::new_err("not a pickled point")),
    }))
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
///
/// Examples
/// --------
/// >>> import geodesics as gd
/// >>> gd.vertex(7)
/// vertex(7)
#[pyfunction]
pub(crate) fn vertex(v: &Bound<'_, PyAny>) -> PyResult<PyPoint> {
    Ok(PyPoint(PointSpec::Vertex(number(v, "v")?)))
}

/// The point on the edge between vertices `a` and `b` at the fraction `t` of its length from `a`,
/// between 0 and 1.
///
/// Examples
/// --------
/// >>> import geodesics as gd
/// >>> mesh = gd.generate("grid,n=4")
/// >>> float(mesh.distance(0, targets=gd.edge(0, 1, 0.5))[0])
/// 0.5
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
/// the face. Their sum must be 1; the rounding of single precision is made up for.
///
/// Examples
/// --------
/// >>> import geodesics as gd
/// >>> mesh = gd.generate("grid,n=4")
/// >>> mesh.path(gd.face(0, 0.2, 0.3, 0.5), 24).faces[0]
/// np.int64(0)
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
/// that is farther from the surface than the diagonal of its bounding box is an error, unless
/// `far`.
///
/// Examples
/// --------
/// >>> import geodesics as gd
/// >>> mesh = gd.generate("grid,n=4")
/// >>> mesh.locate(gd.at(1, 0, 0.5)).distance
/// 0.5
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

/// Reads one point, the number of a vertex or a `PyPoint`; `None` if `value` is neither, and may be
/// a sequence.
fn one(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Option<PointSpec>> {
    if let Ok(point) = value.cast::<PyPoint>() {
        return Ok(Some(point.get().0));
    }
    if value.is_instance_of::<PyBool>() || is_no_list(value) {
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

/// Whether `value` can be iterated and is no list of points: text, bytes, or a mapping, which
/// yields its keys.
fn is_no_list(value: &Bound<'_, PyAny>) -> bool {
    value.is_instance_of::<PyString>()
        || value.is_instance_of::<PyBytes>()
        || value.is_instance_of::<PyByteArray>()
        || value.is_instance_of::<PyMemoryView>()
        || value.cast::<PyMapping>().is_ok()
}

fn not_a_point(value: &Bound<'_, PyAny>, name: &str) -> PyErr {
    if value.is_instance_of::<PyCurve>() {
        let message = format!(
            "{name}: a curve is no point; it is a source of `distance`, by mmp, alone or in a list"
        );
        return PyTypeError::new_err(message);
    }
    let shown = value
        .repr()
        .map_or_else(|_| "this".to_owned(), |text| text.to_string());
    PyTypeError::new_err(format!(
        "{name}: {shown} is no point; give the number of a vertex, or vertex(), edge(), face() or at()"
    ))
}

/// Reads one point or several: a sequence of points, an array of vertex numbers, a mask of the
/// vertices, an `(k, 3)` array of positions, or faces with the `(k, 3)` array of barycentric
/// coordinates in them.
pub(crate) fn several(
    value: &Bound<'_, PyAny>,
    name: &str,
    vertices: usize,
) -> PyResult<Vec<PointSpec>> {
    read(value, name, Some(vertices))
}

/// Reads points whose order counts, as [`several`] does. They cannot be a mask.
pub(crate) fn in_order(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<PointSpec>> {
    read(value, name, None)
}

fn read(value: &Bound<'_, PyAny>, name: &str, vertices: Option<usize>) -> PyResult<Vec<PointSpec>> {
    if let Some(point) = one(value, name)? {
        return Ok(vec![point]);
    }
    let value = &arrays::taken(value, name)?;
    let points = match in_arrays(value, name, vertices)? {
        Some(points) => points,
        None => in_sequence(value, name)?,
    };
    if points.is_empty() {
        return Err(PyValueError::new_err(format!(
            "{name}: empty; give at least one point"
        )));
    }
    Ok(points)
}

fn in_sequence(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<PointSpec>> {
    let Ok(items) = value.try_iter() else {
        return Err(not_a_point(value, name));
    };
    let mut points = Vec::new();
    for item in items {
        let item = item?;
        points.push(one(&item, name)?.ok_or_else(|| not_a_point(&item, name))?);
    }
    Ok(points)
}

/// Points in arrays of positions, of truth values, or of faces and coordinates.
fn in_arrays(
    value: &Bound<'_, PyAny>,
    name: &str,
    vertices: Option<usize>,
) -> PyResult<Option<Vec<PointSpec>>> {
    if let Ok(pair) = value.cast::<PyTuple>()
        && pair.len() == 2
        && let (faces, weights) = (pair.get_item(0)?, pair.get_item(1)?)
        && weights
            .cast::<PyUntypedArray>()
            .is_ok_and(|array| array.ndim() == 2)
    {
        let weights = arrays::positions(&weights, name)?;
        let faces = arrays::numbers(&faces, name, weights.len())?;
        let points = faces.into_iter().zip(weights);
        return Ok(Some(points.map(|(f, w)| PointSpec::Face(f, w)).collect()));
    }
    let Ok(array) = value.cast::<PyUntypedArray>() else {
        return Ok(None);
    };
    match (array.dtype().kind(), array.ndim()) {
        (b'f', 2) => {
            let positions = arrays::positions(value, name)?.into_iter();
            if let Some(x) = positions
                .as_slice()
                .as_flattened()
                .iter()
                .find(|x| !x.is_finite())
            {
                return Err(PyValueError::new_err(format!(
                    "{name}: {x} is not a coordinate"
                )));
            }
            Ok(Some(positions.map(PointSpec::At).collect()))
        }
        (b'f', 1) if array.len() == 3 => Err(PyValueError::new_err(format!(
            "{name}: the shape is (3,), but (k, 3) is needed; at(x, y, z) is one position"
        ))),
        (b'b', _) => {
            let Some(vertices) = vertices else {
                return Err(PyTypeError::new_err(format!(
                    "{name}: a mask has no order; give the points in their order"
                )));
            };
            if array.ndim() != 1 || array.len() != vertices {
                return Err(PyValueError::new_err(format!(
                    "{name}: a mask has a truth value for each of the {vertices} vertices, and not \
                     the shape {}",
                    arrays::shape_of(array)
                )));
            }
            let chosen = value.call_method0("nonzero")?.get_item(0)?;
            in_sequence(&chosen, name).map(Some)
        }
        _ => Ok(None),
    }
}

/// Reads the sources of one run, each once. A `UserWarning` names those given twice.
pub(crate) fn together(
    value: &Bound<'_, PyAny>,
    name: &str,
    vertices: usize,
) -> PyResult<Vec<PointSpec>> {
    let points = several(value, name, vertices)?;
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
pub(crate) struct Finder<'m, 'py> {
    py: Python<'py>,
    surface: &'m SharedMesh,
    locator: Locator<'m>,
    has_tree: bool,
}

impl<'m, 'py> Finder<'m, 'py> {
    pub(crate) const fn new(py: Python<'py>, surface: &'m SharedMesh) -> Self {
        Self {
            py,
            surface,
            locator: Locator::new(&surface.mesh),
            has_tree: false,
        }
    }

    pub(crate) fn find(&mut self, spec: PointSpec, name: &str) -> PyResult<SurfacePoint> {
        Ok(self.find_from(spec, name)?.0)
    }

    /// All these points.
    pub(crate) fn find_all(
        &mut self,
        specs: Vec<PointSpec>,
        name: &str,
    ) -> PyResult<Vec<SurfacePoint>> {
        specs
            .into_iter()
            .map(|spec| self.find(spec, name))
            .collect()
    }

    /// The point, and its distance from the position that was given; 0 for points given otherwise.
    pub(crate) fn find_from(
        &mut self,
        spec: PointSpec,
        name: &str,
    ) -> PyResult<(SurfacePoint, f64)> {
        if let PointSpec::Vertex(v) = spec {
            let vertices = self.surface.mesh.vertex_count();
            if v as usize >= vertices {
                return Err(PyIndexError::new_err(format!(
                    "{name} vertex {v} does not exist: the mesh has {vertices} vertices, numbered \
                     from 0"
                )));
            }
        }
        if let (false, PointSpec::At(_) | PointSpec::Far(_)) = (self.has_tree, spec)
            && let Ok(tree) = self.surface.tree(self.py)
        {
            self.locator.set_tree(tree);
            self.has_tree = true;
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
    /// The change of the mesh that inserts a vertex at each of them.
    pub(crate) insertion: Insertion,
    /// The sources as vertices of the refined mesh.
    pub(crate) sources: Vec<VertexId>,
    /// The targets as vertices of the refined mesh, if targets were given.
    pub(crate) targets: Option<Vec<VertexId>>,
}

impl ResolvedPoints {
    /// The points `sources`, called `source_name` in messages, and the targets.
    pub(crate) fn new(
        py: Python<'_>,
        surface: &SharedMesh,
        sources: Vec<PointSpec>,
        source_name: &str,
        targets: Option<(&Bound<'_, PyAny>, &str)>,
    ) -> PyResult<Self> {
        let mut finder = Finder::new(py, surface);
        let mut points = finder.find_all(sources, source_name)?;
        let count = points.len();
        if let Some((targets, name)) = targets {
            let targets = several(targets, name, surface.mesh.vertex_count())?;
            points.extend(finder.find_all(targets, name)?);
        }
        let insertion = surface
            .mesh
            .insertion(&points)
            .map_err(|error| PyValueError::new_err(error.to_string()))?;
        let (from, to) = insertion.vertices().split_at(count);
        Ok(Self {
            sources: from.to_vec(),
            targets: targets.is_some().then(|| to.to_vec()),
            insertion,
        })
    }

    /// The refined mesh, and the sources.
    pub(crate) fn refine(self) -> (Refined, Vec<VertexId>) {
        let mut mesh = self.insertion.original().clone();
        if !self.insertion.is_empty() {
            mesh.splice(self.insertion.splice());
        }
        (self.insertion.into_refined(mesh), self.sources)
    }
}
