//! Certified distances.

use geobench_harness::measure::number::counted;
use geodesics::certify::FailurePlace;
use geodesics::mesh::threads::Threads;
use geodesics::{Certificate, CertificateError, Judgement, OriginalFailure, Stop};
use numpy::PyArray1;
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyList;

use crate::algorithm::{check_threads, named};
use crate::arrays;
use crate::errors::solve_error;
use crate::interrupt;
use crate::points::{ResolvedPoints, core, together};
use crate::solver::mesh_of;

/// A proven bound on the errors of distances. It is true if the bound is within the tolerance.
///
/// Examples
/// --------
/// >>> import geodesics as gd
/// >>> mesh = gd.generate("grid,n=4")
/// >>> bool(gd.certify(mesh, 0, mesh.distance(0)))
/// True
#[pyclass(frozen, get_all, weakref, module = "geodesics", name = "Certificate")]
pub(crate) struct PyCertificate {
    /// bool: whether the relative error of every distance is at most the tolerance.
    certified: bool,
    /// float: upper bound of the error of a distance, in units of the mesh.
    absolute: f64,
    /// float: upper bound of the error as a fraction of the distance; less where a distance is far
    /// below the others.
    relative: f64,
    /// float: the relative error that is allowed.
    tolerance: f64,
    /// list of Failure: places where the error may exceed the tolerance: `kind`, "vertex" or
    /// "face", its `number`, and the `amount` in units of the mesh.
    failures: Py<PyList>,
    /// (n,) float64: the distances of the proof, computed by `"mmp"`. Given distances are compared
    /// with these.
    distances: Py<PyArray1<f64>>,
}

#[pymethods]
impl PyCertificate {
    fn __bool__(&self) -> bool {
        self.certified
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let verdict = if self.certified {
            "certified"
        } else {
            "not certified"
        };
        format!(
            "<geodesics.Certificate: {verdict}, {:.1e} of a distance, {}>",
            self.relative,
            counted(self.failures.bind(py).len(), "failure")
        )
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
        (bool, f64, f64, f64, Py<PyList>, Py<PyArray1<f64>>),
    )> {
        let state = (
            self.certified,
            self.absolute,
            self.relative,
            self.tolerance,
            self.failures.clone_ref(py),
            self.distances.clone_ref(py),
        );
        Ok((core(py)?.getattr("_certificate")?, state))
    }
}

/// A pickled certificate.
#[pyfunction]
pub(crate) fn _certificate(
    certified: bool,
    absolute: f64,
    relative: f64,
    tolerance: f64,
    failures: &Bound<'_, PyList>,
    distances: &Bound<'_, PyArray1<f64>>,
) -> PyCertificate {
    PyCertificate {
        certified,
        absolute,
        relative,
        tolerance,
        failures: failures.clone().unbind(),
        distances: distances.clone().unbind(),
    }
}

/// Proves in interval arithmetic how exact distances are, and finds the places of larger errors.
///
/// The distances of `"mmp"` are computed and proven. Given distances are compared with them.
///
/// Parameters
/// ----------
/// mesh : Mesh
/// source : int, Point or sequence of these
///     One or several sources. Distances are from the nearest. A source that is not a vertex splits
///     the faces around it; the proof is for the mesh with the split faces.
/// distances : array_like, shape (n,), optional
///     Distances to check, in units of the mesh. By default the distances of `"mmp"` are checked.
/// tolerance : float
///     The largest relative error that is allowed.
/// threads : int, optional
///     The most threads that the call uses, by default one. The result does not depend on it.
///
/// Returns
/// -------
/// Certificate
///     True if the relative error of every distance is at most the tolerance.
///
/// Raises
/// ------
/// ValueError
///     `distances` has another shape, or holds NaN or a negative number; `threads` is 0 or too
///     large.
///
/// Examples
/// --------
/// >>> import geodesics as gd
/// >>> mesh = gd.generate("grid,n=4")
/// >>> gd.certify(mesh, 0, 1.001 * mesh.distance(0)).certified
/// False
#[pyfunction]
#[pyo3(signature = (mesh, source, distances = None, *, tolerance = 1e-9, threads = None))]
pub(crate) fn certify(
    py: Python<'_>,
    mesh: &Bound<'_, PyAny>,
    source: &Bound<'_, PyAny>,
    distances: Option<&Bound<'_, PyAny>>,
    tolerance: f64,
    threads: Option<i64>,
) -> PyResult<PyCertificate> {
    let surface = mesh_of(mesh)?.get().surface.clone();
    let mesh = surface.mesh.clone();
    if tolerance.is_nan() || tolerance < 0.0 {
        return Err(PyValueError::new_err(format!(
            "tolerance: {tolerance} is no error that could be allowed"
        )));
    }
    let sources = together(source, "source", mesh.vertex_count())?;
    let points = ResolvedPoints::new(py, &surface, sources, "source", None)?;
    let (refined, sources) = points.refine();
    let given = distances
        .map(|given| arrays::distances(given, "distances", mesh.vertex_count()))
        .transpose()?;
    let (surface, faces) = (refined.mesh.clone(), mesh.face_count());
    let threads = Threads::start(threads.map_or(Ok(1), check_threads)?)
        .map_err(|error| PyOSError::new_err(error.to_string()))?;
    let work = move || threads.run(|| Certificate::within(&surface, &sources, tolerance));
    // A proof takes far longer than a run, so it counts as a run on ten times the faces.
    let found = interrupt::call(py, faces.saturating_mul(10), &Stop::default(), work)?;
    let mut proof = found.map_err(|error| match error {
        CertificateError::Solve(error) => solve_error(error),
        other => PyValueError::new_err(other.to_string()),
    })?;
    let given = given.unwrap_or_else(|| proof.distances[..mesh.vertex_count()].to_vec());
    let (mut absolute, mut relative, mut failures) = (0.0_f64, 0.0_f64, Vec::new());
    for (v, &d) in given.iter().enumerate() {
        absolute = absolute.max(proof.error(v, d));
        relative = relative.max(proof.relative_error(v, d));
        if let Judgement::Wrong(by) | Judgement::Unproven(by) = proof.judge(v, d, tolerance) {
            failures.push(("vertex", v as u32, by));
        }
    }
    failures.sort_by(|a, b| b.2.total_cmp(&a.2));
    if proof.relative() > tolerance {
        let places = proof
            .too_long
            .failures
            .iter()
            .chain(&proof.too_short.failures);
        failures.extend(places.map(|failure| {
            let failure = OriginalFailure::new(failure, &refined, &mesh);
            let (kind, number) = match failure.place {
                FailurePlace::Face(face) => ("face", mesh.file_triangle(face)),
                FailurePlace::Vertex(vertex) => ("vertex", vertex.raw()),
            };
            (kind, number, failure.violation)
        }));
    }
    let failures = failures
        .into_iter()
        .map(|failure| named(py, "Failure", failure));
    let failures = PyList::new(py, failures.collect::<PyResult<Vec<_>>>()?)?.unbind();
    // Drop the distances of vertices that were inserted for sources.
    proof.distances.truncate(mesh.vertex_count());
    Ok(PyCertificate {
        certified: relative <= tolerance,
        absolute,
        relative,
        tolerance,
        failures,
        distances: PyArray1::from_vec(py, proof.distances).unbind(),
    })
}
