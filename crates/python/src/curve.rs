//! The class `Curve`, and distances from curves.

use geobench_harness::exec::point::PointSpec;
use geobench_harness::measure::number::counted;
use geobench_registry::check_curves;
use geodesics::{Curve, Mesh, Stop, distances_from_curves};
use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyIterator, PyList, PyTuple};

use crate::algorithm::{MeshAlgorithm, warn};
use crate::interrupt;
use crate::points::{Finder, PyPoint, in_order, several, single};
use crate::pool::{doubt, goal};

/// A polyline on the surface of a mesh, as a source of `Mesh.distance`: distances are exact from
/// every point of it.
///
/// Parameters
/// ----------
/// points : sequence of int or Point, or array
///     The points in order, as sources are given. Two that follow each other lie in one face, or on
///     one edge.
/// closed : bool
///     Whether a segment leads from the last point to the first.
///
/// Examples
/// --------
/// >>> import geodesics as gd
/// >>> mesh = gd.generate("grid,n=4")
/// >>> side = gd.Curve([0, 1, 2, 3, 4])
/// >>> mesh.distance(side, targets=[7, 24]).round(3)
/// array([1., 4.])
/// >>> mesh.distance(gd.Curve([gd.at(0.3, 0.1, 0), gd.at(0.6, 0.2, 0)]), targets=1).round(3)
/// array([0.447])
#[pyclass(frozen, eq, weakref, module = "geodesics", name = "Curve")]
#[derive(Debug, PartialEq)]
pub(crate) struct PyCurve {
    points: Vec<PointSpec>,
    /// bool: whether a segment leads from the last point to the first.
    #[pyo3(get)]
    closed: bool,
}

#[pymethods]
impl PyCurve {
    #[new]
    #[pyo3(signature = (points, closed = false))]
    fn new(points: &Bound<'_, PyAny>, closed: bool) -> PyResult<Self> {
        let points = in_order(points, "points")?;
        Ok(Self { points, closed })
    }

    /// list of Point: the points, in order.
    #[getter]
    fn points(&self) -> Vec<PyPoint> {
        self.points.iter().map(|&point| PyPoint(point)).collect()
    }

    fn __len__(&self) -> usize {
        self.points.len()
    }

    fn __reduce__(slf: &Bound<'_, Self>) -> (Py<PyAny>, (Vec<PyPoint>, bool)) {
        let made = slf.get_type().into_any().unbind();
        (made, (slf.get().points(), slf.get().closed))
    }

    fn __repr__(&self) -> String {
        let closed = if self.closed { ", closed" } else { "" };
        format!(
            "<geodesics.Curve of {}{closed}>",
            counted(self.points.len(), "point")
        )
    }
}

impl PyCurve {
    /// The borders of `mesh`.
    pub(crate) fn borders(mesh: &Mesh) -> Vec<Self> {
        let borders = mesh.borders().into_iter();
        let curve = |border: Curve| Self {
            points: (border.points().iter())
                .filter_map(|point| Some(PointSpec::Vertex(point.vertex()?.raw())))
                .collect(),
            closed: border.is_closed(),
        };
        borders.map(curve).collect()
    }
}

/// A list of the items of `value` if it is an iterator, which can be read only once.
pub(crate) fn listed<'py>(value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let Ok(items) = value.cast::<PyIterator>() else {
        return Ok(value.clone());
    };
    let items: Vec<Bound<'_, PyAny>> = items.try_iter()?.collect::<PyResult<_>>()?;
    Ok(PyList::new(value.py(), items)?.into_any())
}

/// The points of a curve and whether it is closed.
type CurveSpec = (Vec<PointSpec>, bool);

/// The curves of `value`, a curve or a list of curves and points; `None` if it has no curve.
pub(crate) fn curves(value: &Bound<'_, PyAny>) -> PyResult<Option<Vec<CurveSpec>>> {
    let of_curve = |curve: &PyCurve| (curve.points.clone(), curve.closed);
    if let Ok(curve) = value.cast::<PyCurve>() {
        return Ok(Some(vec![of_curve(curve.get())]));
    }
    if !(value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>()) {
        return Ok(None);
    }
    let items: Vec<Bound<'_, PyAny>> = value.try_iter()?.collect::<PyResult<_>>()?;
    if !items.iter().any(PyAnyMethods::is_instance_of::<PyCurve>) {
        return Ok(None);
    }
    let spec = |item: &Bound<'_, PyAny>| match item.cast::<PyCurve>() {
        Ok(curve) => Ok(of_curve(curve.get())),
        Err(_) => Ok((vec![single(item, "source")?], false)),
    };
    items.iter().map(spec).collect::<PyResult<_>>().map(Some)
}

impl MeshAlgorithm {
    /// Distances from the nearest point of `curves`, of all vertices or of `targets`.
    pub(crate) fn distance_from_curves<'py>(
        &self,
        py: Python<'py>,
        curves: Vec<CurveSpec>,
        radius: Option<f64>,
        targets: Option<&Bound<'py, PyAny>>,
        with_nearest: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        check_curves(&self.kept.selection)
            .map_err(|error| PyValueError::new_err(format!("source: {error}")))?;
        if with_nearest {
            return Err(PyValueError::new_err(
                "nearest: the nearest of several sources is known of points, not of curves",
            ));
        }
        let mut finder = Finder::new(py, &self.surface);
        let sources: Vec<Curve> = curves
            .into_iter()
            .map(|(points, closed)| {
                let points = finder.find_all(points, "source")?;
                Ok(if closed {
                    Curve::closed(points)
                } else {
                    Curve::new(points)
                })
            })
            .collect::<PyResult<_>>()?;
        let targets = targets.map(|targets| {
            let specs = several(targets, "targets", self.mesh().vertex_count())?;
            let target = |spec: PointSpec| {
                let point = finder.find(spec, "targets")?;
                point.vertex().ok_or_else(|| {
                    PyValueError::new_err(format!(
                        "targets: {spec} is no vertex; distances from curves are those of vertices"
                    ))
                })
            };
            specs.into_iter().map(target).collect::<PyResult<Vec<_>>>()
        });
        let targets = targets.transpose()?;
        let stop = Stop::default();
        let radius = goal(radius, None, &stop)?.radius();
        let (mesh, faces) = (self.mesh().clone(), self.mesh().face_count());
        let work = {
            let stop = stop.clone();
            move || {
                let distances = distances_from_curves(&mesh, &sources, radius, &stop)?;
                let doubt = doubt(&mesh, &distances);
                Ok((distances, doubt))
            }
        };
        let found: Result<_, geodesics::CurveSourceError> =
            interrupt::call(py, faces, &stop, work)?;
        let (distances, doubt) =
            found.map_err(|error| PyValueError::new_err(format!("source: {error}")))?;
        warn(py, doubt)?;
        let wanted = match targets {
            Some(targets) => targets.iter().map(|v| distances[v.index()]).collect(),
            None => distances,
        };
        Ok(PyArray1::from_vec(py, wanted).into_any())
    }
}
