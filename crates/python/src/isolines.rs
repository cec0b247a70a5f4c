//! Isolines of the geodesic distance.

use std::sync::Arc as Shared;

use geobench_harness::measure::number::counted;
use geodesics::{DistanceField, Line, Mesh, Stop};
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyList;

use crate::arrays;
use crate::interrupt;
use crate::path::tuples;

/// Default deviation of chords from arcs, as a fraction of the distance of the isoline.
const TOLERANCE: f64 = 1e-3;

/// The points of a surface at one distance from the nearest source.
///
/// Examples
/// --------
/// >>> import geodesics as gd
/// >>> (isoline,) = gd.generate("grid,n=4").isolines(0, levels=[2.0])
/// >>> isoline.distance, len(isoline)
/// (2.0, 1)
#[pyclass(frozen, weakref, module = "geodesics", name = "Isoline")]
pub(crate) struct PyIsoline {
    /// float: the distance, in units of the mesh.
    #[pyo3(get)]
    distance: f64,
    /// float: the total length of the lines, in units of the mesh.
    #[pyo3(get)]
    length: f64,
    /// float: the largest gap between ends that were joined, in units of the mesh. It is above
    /// rounding only beside faces without area.
    #[pyo3(get)]
    gap: f64,
    /// list of IsolineLine: its connected parts: loops, and lines between points of the boundary.
    #[pyo3(get)]
    lines: Vec<Py<PyLine>>,
}

#[pymethods]
impl PyIsoline {
    fn __len__(&self) -> usize {
        self.lines.len()
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let lines = self.lines.iter().map(|line| line.clone_ref(py));
        Ok(PyList::new(py, lines)?.try_iter()?.into_any())
    }

    fn __repr__(&self) -> String {
        format!(
            "<geodesics.Isoline at {}: {} of length {}>",
            self.distance,
            counted(self.lines.len(), "line"),
            self.length
        )
    }
}

/// A connected part of an isoline. It consists of circular arcs, each inside one face.
///
/// Examples
/// --------
/// >>> import geodesics as gd
/// >>> (isoline,) = gd.generate("grid,n=4").isolines(0, levels=[2.0])
/// >>> [line.closed for line in isoline]
/// [False]
#[pyclass(frozen, weakref, module = "geodesics", name = "IsolineLine")]
pub(crate) struct PyLine {
    mesh: Mesh,
    line: Shared<Line>,
    tolerance: f64,
}

#[pymethods]
impl PyLine {
    /// bool: whether it is a loop.
    #[getter]
    fn closed(&self) -> bool {
        self.line.closed
    }

    /// float: its length, in units of the mesh.
    #[getter]
    fn length(&self) -> f64 {
        self.line.length()
    }

    /// (k,) int64: the face of each arc, in the order of the arcs.
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        let arcs = self.line.arcs.iter();
        let faces = arcs.map(|arc| i64::from(self.mesh.file_triangle(arc.face)));
        PyArray1::from_iter(py, faces)
    }

    /// Positions along the line. A loop ends with its first position. Points of the surface that
    /// are nearer to the source are on the left of the line.
    ///
    /// Parameters
    /// ----------
    /// tolerance : float, optional
    ///     The largest deviation of the chords between positions from the arcs, in units of the
    ///     mesh. By default a thousandth of the distance of the isoline.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (k, 3), float64
    ///     In units of the mesh.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     The tolerance is not positive, or the mesh has no positions.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> (isoline,) = gd.generate("grid,n=4").isolines(0, levels=[2.0])
    /// >>> isoline.lines[0].points(0.1).shape[1]
    /// 3
    #[pyo3(signature = (tolerance = None))]
    fn points(&self, py: Python<'_>, tolerance: Option<f64>) -> PyResult<Py<PyArray2<f64>>> {
        let tolerance = tolerance.unwrap_or(self.tolerance);
        if tolerance.is_nan() || tolerance <= 0.0 {
            return Err(PyValueError::new_err(format!(
                "tolerance: {tolerance}, but it is a distance above 0"
            )));
        }
        if self.mesh.positions().is_empty() {
            return Err(PyValueError::new_err("the mesh has no positions"));
        }
        tuples(py, &self.line.polyline(&self.mesh, tolerance))
    }

    fn __repr__(&self) -> String {
        format!(
            "<geodesics.IsolineLine of {} arcs: {}, length {}>",
            self.line.arcs.len(),
            if self.line.closed { "a loop" } else { "open" },
            self.line.length()
        )
    }
}

/// The requested levels: the multiples of a step, or a list.
pub(crate) enum WantedLevels {
    Every(f64),
    These(Vec<f64>),
}

/// Reads the arguments `every` and `levels`, of which one is given.
pub(crate) fn levels(
    every: Option<f64>,
    levels: Option<&Bound<'_, PyAny>>,
) -> PyResult<WantedLevels> {
    let levels = levels.map(|given| arrays::reals(given, "levels"));
    match (every, levels.transpose()?) {
        (Some(every), None) if every.is_finite() && every > 0.0 => Ok(WantedLevels::Every(every)),
        (Some(every), None) => Err(PyValueError::new_err(format!(
            "every: {every}, but it is a distance above 0, in units of the mesh"
        ))),
        (None, Some(levels)) => match levels.iter().find(|l| !l.is_finite() || **l <= 0.0) {
            Some(level) => Err(PyValueError::new_err(format!(
                "levels: {level}, but a level is a distance above 0, in units of the mesh"
            ))),
            None => Ok(WantedLevels::These(levels)),
        },
        _ => Err(PyValueError::new_err("give one of every and levels")),
    }
}

/// The isolines of `field` at the levels `asked` for.
pub(crate) fn lines(
    py: Python<'_>,
    field: &Shared<DistanceField>,
    asked: WantedLevels,
) -> PyResult<Vec<PyIsoline>> {
    let mesh = field.mesh().clone();
    let field = Shared::clone(field);
    let work = move || {
        let levels = match asked {
            WantedLevels::These(levels) => levels,
            WantedLevels::Every(every) => field.levels_every(every)?,
        };
        Ok::<_, geodesics::TooManyLevels>(field.isolines(&levels))
    };
    let found = interrupt::call(py, mesh.face_count(), &Stop::default(), work)?;
    let found = found.map_err(|refused| PyValueError::new_err(format!("every: {refused}")))?;
    let of_python = |isoline: geodesics::Isoline| {
        let (distance, length, gap) = (isoline.distance, isoline.length(), isoline.gap);
        let lines = isoline.lines.into_iter().map(|line| {
            let line = PyLine {
                mesh: mesh.clone(),
                line: Shared::new(line),
                tolerance: TOLERANCE * distance,
            };
            Py::new(py, line)
        });
        Ok(PyIsoline {
            distance,
            length,
            gap,
            lines: lines.collect::<PyResult<_>>()?,
        })
    };
    found.into_iter().map(of_python).collect()
}
