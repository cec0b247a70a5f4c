//! The class `Mesh`.

use std::path::PathBuf;

use geobench_harness::measure::number::counted;
use geobench_registry::OF_CURVES;
use geodesics::mesh::{MeshMeasures, Report, Severity, Tolerance};
use geodesics::paths::Through;
use geodesics::{Mesh, PointError, RemeshOptions, Stop, TriangleSoup, io, line};
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::algorithm::{MeshAlgorithm, one_path, selection};
use crate::arrays;
use crate::curve::{self, PyCurve};
use crate::errors::{invalid, unreadable};
use crate::field::PyField;
use crate::from_arrays::{from_arrays, warn_of_copies};
use crate::interrupt;
use crate::isolines::{self, PyIsoline};
use crate::location::locate;
use crate::making::MeshState;
use crate::path::{PyPath, tuples};
use crate::points::{Finder, SharedMesh, core, single};
use crate::voronoi::PyVoronoi;

/// An immutable triangle mesh, validated when it is made. Vertices and faces keep their numbers.
/// Faces without three different vertices and second copies are left out of the surface, but not of
/// `faces`.
///
/// Surfaces need not be closed, connected, manifold or orientable. Algorithms that do not cross
/// edges with more than two faces, or surfaces that cannot be oriented, raise `ValueError`.
///
/// Parameters
/// ----------
/// vertices : array_like, shape (n, 3), real
///     Positions. Their unit is the unit of all distances. Or a mesh of PyVista, trimesh or meshio,
///     without `faces`.
/// faces : array_like, shape (m, 3) or (m, k), integer, or sequence of sequences
///     The vertex numbers of the corners of each triangle or polygon, counted from 0. Polygons are
///     cut into triangles, whose numbers count.
/// name : str, optional
///     The name of the mesh in the tables of `run`.
/// weld : bool or float, optional
///     `True` makes vertices at exactly one place one vertex; a number those within this fraction
///     of the diagonal of the bounding box. Vertices keep their numbers, and copies get the
///     distance of the vertex that stands for them. By default a warning says that there are
///     copies.
/// repair : bool
///     Whether to leave out repeated corners of polygons and faces that repeat a corner or another
///     face or have fewer than three corners, and to turn faces over. `False` makes such faces an
///     error, also where welding makes them.
///
/// Raises
/// ------
/// MeshError
///     The mesh cannot be used. The message names the vertices and faces, `defects` has all.
/// ValueError, TypeError
///     An array has another shape or type.
///
/// Examples
/// --------
/// >>> import geodesics as gd
/// >>> mesh = gd.Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
/// >>> mesh
/// <geodesics.Mesh "mesh": 4 vertices, 2 faces>
/// >>> mesh.distance(1).round(3)
/// array([1.   , 0.   , 1.   , 1.414])
#[pyclass(frozen, weakref, module = "geodesics", name = "Mesh")]
pub(crate) struct PyMesh {
    pub(crate) surface: SharedMesh,
    pub(crate) name: String,
    pub(crate) defects: Vec<String>,
}

impl PyMesh {
    /// The mesh of `soup`, which was read from `place`. If it `warns`, there is a warning on
    /// vertices at one place.
    pub(crate) fn new(
        py: Python<'_>,
        soup: TriangleSoup,
        name: String,
        place: &str,
        warns: bool,
    ) -> PyResult<Self> {
        let faces = soup.triangles.len();
        let made = interrupt::call(py, faces, &Stop::default(), move || Mesh::from_soup(soup))?;
        let (mesh, report) = made.map_err(|error| invalid(py, &error, place))?;
        if warns {
            warn_of_copies(py, &report, place)?;
        }
        Ok(Self::of(mesh, &report, name))
    }

    fn of(mesh: Mesh, report: &Report, name: String) -> Self {
        let known = report.summaries().into_iter();
        let defects = known.filter(|summary| summary.kind.severity() != Severity::Fatal);
        Self {
            surface: SharedMesh::new(mesh),
            name,
            defects: defects.map(|summary| summary.text).collect(),
        }
    }

    fn algorithm(&self, name: Option<&str>) -> PyResult<MeshAlgorithm> {
        let selection = selection(self.mesh(), name, None, "auto")?;
        Ok(MeshAlgorithm::new(&self.surface, &selection))
    }

    pub(crate) fn mesh(&self) -> &Mesh {
        &self.surface.mesh
    }
}

#[pymethods]
impl PyMesh {
    #[new]
    #[pyo3(signature = (vertices, faces = None, *, name = "mesh", weld = None, repair = true))]
    fn py_new(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        faces: Option<&Bound<'_, PyAny>>,
        name: &str,
        weld: Option<&Bound<'_, PyAny>>,
        repair: bool,
    ) -> PyResult<Self> {
        let (mesh, report) = from_arrays(py, vertices, faces, weld, repair)?;
        Ok(Self::of(mesh, &report, name.to_owned()))
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, MeshState)> {
        Ok((core(py)?.getattr("_mesh")?, self.state(py)?))
    }

    /// Makes a mesh from edge lengths alone. The surface need not be embeddable in space.
    ///
    /// Parameters
    /// ----------
    /// n : int
    ///     Number of vertices.
    /// faces : array_like, shape (m, 3), integer
    ///     The vertex numbers of the corners of each triangle, counted from 0.
    /// lengths : array_like, shape (m, 3), real
    ///     For each face, the lengths of the edges from the first corner to the second, from the
    ///     second to the third, and from the third to the first.
    /// name : str, optional
    ///     The name of the mesh in the tables of `run`.
    ///
    /// Returns
    /// -------
    /// Mesh
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     The mesh cannot be used. The message names the vertices and faces.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> gd.Mesh.from_lengths(3, [[0, 1, 2]], [[3, 4, 5]]).distance(0)
    /// array([0., 3., 5.])
    #[staticmethod]
    #[pyo3(signature = (n, faces, lengths, *, name = "mesh"))]
    fn from_lengths(
        py: Python<'_>,
        n: i64,
        faces: &Bound<'_, PyAny>,
        lengths: &Bound<'_, PyAny>,
        name: &str,
    ) -> PyResult<Self> {
        let n = arrays::count(n, "n", 0)?;
        let triangles = arrays::triangles(faces, "faces")?;
        let lengths = arrays::positions(lengths, "lengths")?;
        let made = interrupt::call(py, triangles.len(), &Stop::default(), move || {
            Mesh::from_lengths(n, &triangles, &lengths)
        })?;
        let (mesh, report) = made.map_err(|error| invalid(py, &error, ""))?;
        Ok(Self::of(mesh, &report, name.to_owned()))
    }

    /// (n, 3) float64: a copy of the positions of the vertices; shape (0, 3) if the mesh was made
    /// from lengths.
    #[getter]
    fn vertices(&self, py: Python<'_>) -> PyResult<Py<PyArray2<f64>>> {
        tuples(py, self.mesh().positions())
    }

    /// (m, 3) int64: a copy of the corners of the faces, in the order and with the numbers that
    /// `face`, `locate` and `Path.faces` use: those of the arrays or the file. Faces that were
    /// turned over or left out are as they were given.
    #[getter]
    fn faces(&self, py: Python<'_>) -> PyResult<Py<PyArray2<i64>>> {
        let given = self.mesh().file_triangles().into_iter();
        let rows: Vec<[i64; 3]> = given.map(|corners| corners.map(i64::from)).collect();
        tuples(py, &rows)
    }

    /// int: number of vertices, including isolated ones.
    #[getter]
    fn n_vertices(&self) -> usize {
        self.mesh().vertex_count()
    }

    /// int: number of faces of the surface. Those that were left out do not count.
    #[getter]
    fn n_faces(&self) -> usize {
        self.mesh().face_count()
    }

    /// str: the name of the mesh in the tables of `run`.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// list of str: the defects that were repaired or that the mesh still has, one sentence for
    /// each kind.
    #[getter]
    fn defects(&self) -> Vec<String> {
        self.defects.clone()
    }

    /// The vertices whose distances are wrong beside those of a reference.
    ///
    /// A distance is right beside a distance d of the reference if it differs by at most
    /// `tolerance` * d + 1e-13 * m. The scale m of a component is the lesser of its greatest
    /// distance and 100 times the median of its finite distances in the reference. Infinite
    /// distances are right where the reference is infinite.
    ///
    /// Parameters
    /// ----------
    /// found : array_like, shape (n,)
    ///     The distances to check, in units of the mesh.
    /// reference : array_like, shape (n,)
    ///     The right distances of all vertices.
    /// tolerance : float
    ///     The largest relative error that is allowed.
    ///
    /// Returns
    /// -------
    /// (k,) int64
    ///     Vertex numbers, in ascending order.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     An array has another shape, or holds NaN or a negative number.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> mesh = gd.generate("grid,n=4")
    /// >>> d = mesh.distance(0)
    /// >>> mesh.wrong_distances(d + (d > 5), d)
    /// array([24])
    #[pyo3(signature = (found, reference, *, tolerance = 1e-9))]
    fn wrong_distances<'py>(
        &self,
        py: Python<'py>,
        found: &Bound<'py, PyAny>,
        reference: &Bound<'py, PyAny>,
        tolerance: f64,
    ) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let vertices = self.mesh().vertex_count();
        let found = arrays::distances(found, "found", vertices)?;
        let reference = arrays::distances(reference, "reference", vertices)?;
        let rule = Tolerance::on(self.mesh(), &reference).with_relative(tolerance);
        let wrong = rule.wrong(&found, &reference).map(|v| v as i64);
        Ok(PyArray1::from_vec(py, wrong.collect()))
    }

    /// Counts and sizes: a dictionary with `vertices`, `faces`, `edges`, `boundary_edges`,
    /// `boundary_loops`, `components`, `genus`, `saddles`, `euler_characteristic`, `area`,
    /// `anisotropy`, `min_edge_length`, `mean_edge_length` and `max_edge_length`. Lengths are in
    /// units of the mesh.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> gd.generate("torus,faces=2000").info()["genus"]
    /// 1
    fn info<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let measures = py.detach(|| MeshMeasures::of(self.mesh()));
        let row = PyDict::new(py);
        row.set_item("vertices", measures.vertices)?;
        row.set_item("faces", measures.faces)?;
        row.set_item("edges", measures.edges)?;
        row.set_item("boundary_edges", measures.boundary_edges)?;
        row.set_item("boundary_loops", measures.boundary_loops)?;
        row.set_item("components", measures.components)?;
        row.set_item("genus", measures.genus)?;
        row.set_item("saddles", measures.saddles)?;
        row.set_item("euler_characteristic", measures.euler_characteristic)?;
        row.set_item("area", measures.area)?;
        row.set_item("anisotropy", measures.anisotropy)?;
        row.set_item("min_edge_length", measures.min_edge_length)?;
        row.set_item("mean_edge_length", measures.mean_edge_length)?;
        row.set_item("max_edge_length", measures.max_edge_length)?;
        Ok(row)
    }

    /// Locates points on the surface. Positions are looked for in a tree, which is built once.
    ///
    /// Parameters
    /// ----------
    /// points : int, Point, sequence of these, or array
    ///     An array of shape (k, 3) has positions.
    ///
    /// Returns
    /// -------
    /// Location
    ///     `face`, a face that contains the point, -1 for an isolated vertex; `barycentric`, its
    ///     coordinates in that face; `position`, `None` if the mesh has none; `distance` from the
    ///     position that was given, otherwise 0. Of several points arrays, of shapes (k,) and
    ///     (k, 3).
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> mesh = gd.generate("grid,n=4")
    /// >>> mesh.locate(gd.edge(0, 1, 0.5)).distance
    /// 0.0
    /// >>> mesh.locate(mesh.vertices + [0, 0, 0.5]).distance.max()
    /// np.float64(0.5)
    fn locate<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        locate(py, &self.surface, points)
    }

    /// The vertices nearest in space to positions, found in a tree that is built once.
    ///
    /// Parameters
    /// ----------
    /// positions : array_like, shape (k, 3)
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (k,), int64
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> gd.generate("grid,n=4").nearest_vertices([[0.1, 0.2, 3], [1.1, 0, 0]]).shape
    /// (2,)
    fn nearest_vertices<'py>(
        &self,
        py: Python<'py>,
        positions: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let wrong = |error| PyValueError::new_err(format!("positions: {error}"));
        let positions = arrays::positions(positions, "positions")?;
        let tree = self.surface.tree(py).map_err(wrong)?;
        let found = py.detach(|| {
            let each = positions.into_iter().map(|at| tree.vertex_to(at));
            each.map(|found| Ok(i64::from(found?.0.raw())))
                .collect::<Result<Vec<i64>, PointError>>()
        });
        Ok(PyArray1::from_vec(py, found.map_err(wrong)?))
    }

    /// The number of the vertex nearest in space to the position `(x, y, z)`.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> gd.generate("grid,n=4").nearest_vertex(0, 0, 0) in range(25)
    /// True
    fn nearest_vertex(&self, py: Python<'_>, x: f64, y: f64, z: f64) -> PyResult<u32> {
        let wrong = |error| PyValueError::new_err(format!("position: {error}"));
        let tree = self.surface.tree(py).map_err(wrong)?;
        let (vertex, _) = tree.vertex_to([x, y, z]).map_err(wrong)?;
        Ok(vertex.raw())
    }

    /// The edges that have one face only, as closed curves from vertex to vertex.
    ///
    /// Returns
    /// -------
    /// list of Curve
    ///     Empty for a closed surface. A border is open where it ends at an edge of several faces.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> mesh = gd.generate("grid,n=4")
    /// >>> mesh.borders()
    /// [<geodesics.Curve of 16 points, closed>]
    /// >>> mesh.distance(mesh.borders(), targets=[6, 12]).round(3)
    /// array([1., 2.])
    fn borders(&self) -> Vec<PyCurve> {
        PyCurve::borders(self.mesh())
    }

    /// Distances from the nearest source. The algorithm is set up for this call; a `Solver` keeps
    /// its set-up for several calls.
    ///
    /// Parameters
    /// ----------
    /// source : int, Point, Curve or sequence of these
    ///     One or several sources: vertices, or points of the surface (`vertex`, `edge`, `face`,
    ///     `at`), also in arrays: vertex numbers, a mask of the vertices, positions of shape
    ///     (k, 3), or a tuple of faces and barycentric coordinates, of shapes (k,) and (k, 3).
    ///     Curves are sources of the algorithm `"mmp"`; targets are then vertices.
    /// radius : float, optional
    ///     The search ends at this distance, in units of the mesh. Greater distances are `inf`.
    /// targets : int, Point or sequence of these, optional
    ///     Compute only the distances of these points. The search ends when all are reached.
    /// nearest : bool
    ///     Whether to return the index of the nearest source as well.
    /// algorithm : str, optional
    ///     A name from `algorithms()`. The default is `"vtp-fast"`, or `"mmp-fast"` on a mesh with
    ///     edges of more than two faces or one that cannot be oriented, or `"mmp"` for curves.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (n,), float64
    ///     The distance of each of the n vertices, or of each target, in units of the mesh; `inf`
    ///     if it is unreachable or beyond the radius. With `nearest` a `Nearest`: `distances`, and
    ///     the `sources` as indices (int64), -1 where the distance is `inf`.
    ///
    /// Raises
    /// ------
    /// IndexError
    ///     A vertex or face does not exist.
    /// ValueError, TypeError
    ///     An argument is out of range or has the wrong type.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> gd.generate("grid,n=4").distance(0, targets=[4, 24]).round(3)
    /// array([4.   , 5.657])
    #[pyo3(signature = (source, *, radius = None, targets = None, nearest = false,
                        algorithm = None))]
    fn distance<'py>(
        &self,
        py: Python<'py>,
        source: &Bound<'py, PyAny>,
        radius: Option<f64>,
        targets: Option<&Bound<'py, PyAny>>,
        nearest: bool,
        algorithm: Option<&str>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let source = &curve::listed(source)?;
        let algorithm = match algorithm {
            None if curve::curves(source)?.is_some() => Some(OF_CURVES),
            given => given,
        };
        self.algorithm(algorithm)?
            .distance(py, source, radius, targets, nearest)
    }

    /// Distances from each source separately, one row per source.
    ///
    /// Parameters
    /// ----------
    /// sources : sequence of int or Point
    /// threads : int, optional
    ///     The most threads that the call uses, for several sources at a time. Threads that are
    ///     left serve a parallel algorithm.
    /// radius, targets, algorithm
    ///     As for `distance`.
    /// sparse : bool
    ///     Whether to return a sparse matrix of SciPy, without the distances that are `inf`. The
    ///     zero of a source is stored.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (k, n), float64, or scipy.sparse.csr_array
    ///     Row i has the distances of the n vertices, or of the targets, from source i, in units of
    ///     the mesh.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> mesh = gd.generate("grid,n=4")
    /// >>> mesh.distances([0, 24], targets=[1, 12]).round(3)
    /// array([[1.   , 2.828],
    ///        [5.   , 2.828]])
    #[pyo3(signature = (sources, *, threads = None, radius = None, targets = None, sparse = false,
                        algorithm = None))]
    #[allow(clippy::too_many_arguments)] // Those of Python, by name.
    fn distances<'py>(
        &self,
        py: Python<'py>,
        sources: &Bound<'py, PyAny>,
        threads: Option<i64>,
        radius: Option<f64>,
        targets: Option<&Bound<'py, PyAny>>,
        sparse: bool,
        algorithm: Option<&str>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let algorithm = self.algorithm(algorithm)?;
        algorithm.distances(py, sources, threads, radius, targets, sparse)
    }

    /// The distances between all pairs of points: each is computed once, so that the matrix is
    /// exactly symmetric.
    ///
    /// Parameters
    /// ----------
    /// points : sequence of int or Point, or array
    /// threads : int, optional
    ///     As for `distances`.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (k, k), float64
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> gd.generate("grid,n=4").distance_matrix([0, 4, 24])[0]
    /// array([0.        , 4.        , 5.65685425])
    #[pyo3(signature = (points, *, threads = None, algorithm = None))]
    fn distance_matrix<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
        threads: Option<i64>,
        algorithm: Option<&str>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.algorithm(algorithm)?
            .distance_matrix(py, points, threads)
    }

    /// The distance from each source to the target at the same place.
    ///
    /// Parameters
    /// ----------
    /// sources, targets : sequence of int or Point, or array
    ///     As many of one as of the other.
    /// threads : int, optional
    ///     As for `distances`.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (k,), float64
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> gd.generate("grid,n=4").pairs([0, 0, 4], [4, 20, 20])
    /// array([4.        , 4.        , 5.65685425])
    #[pyo3(signature = (sources, targets, *, threads = None, algorithm = None))]
    fn pairs<'py>(
        &self,
        py: Python<'py>,
        sources: &Bound<'py, PyAny>,
        targets: &Bound<'py, PyAny>,
        threads: Option<i64>,
        algorithm: Option<&str>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.algorithm(algorithm)?
            .pairs(py, sources, targets, threads)
    }

    /// The distance from the nearest source as a field: distances, paths, gradients and isolines at
    /// any point of the surface, without another solve.
    ///
    /// MMP runs and all its windows are kept: this takes
    /// several times as long as the distances of vertices, and about a gigabyte for 300,000 faces.
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
    /// >>> field = gd.generate("grid,n=4").field(0)
    /// >>> float(field.distance(gd.at(1, 1, 0))) == float(field.path(gd.at(1, 1, 0)).length)
    /// True
    fn field(slf: &Bound<'_, Self>, source: &Bound<'_, PyAny>) -> PyResult<PyField> {
        PyField::new(slf.py(), slf, source)
    }

    /// The shortest path from the nearest source to `target`, or without a target from each point
    /// of `source` to the next.
    ///
    /// Parameters
    /// ----------
    /// source : int, Point or sequence of these
    /// target : int or Point, optional
    /// closed : bool
    ///     Whether a path without a target returns to its first point.
    /// shorten : bool
    ///     Whether a path without a target leaves its points where that makes it shorter. The
    ///     result is locally shortest: no small change makes it shorter, but a path on another side
    ///     of a hole or handle may be. An open path keeps its ends. A closed one becomes a closed
    ///     geodesic, or a single point, of length 0, if it contracts to that.
    /// algorithm : str, optional
    ///     A name from `algorithms()`. The default is `"vtp-fast"`, or `"mmp-fast"` on a mesh with
    ///     edges of more than two faces or one that cannot be oriented.
    ///
    /// Returns
    /// -------
    /// Path or None
    ///     `None` if the target or a point is unreachable.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> mesh = gd.generate("grid,n=4")
    /// >>> mesh.path(0, 4).length
    /// 4.0
    /// >>> mesh.path([0, 4, 24, 20], closed=True).length
    /// 16.0
    /// >>> mesh.path([0, 4, 24], shorten=True).length
    /// 5.656854249492381
    #[pyo3(signature = (source, target = None, *, closed = false, shorten = false,
                        algorithm = None))]
    fn path(
        &self,
        py: Python<'_>,
        source: &Bound<'_, PyAny>,
        target: Option<&Bound<'_, PyAny>>,
        closed: bool,
        shorten: bool,
        algorithm: Option<&str>,
    ) -> PyResult<Option<PyPath>> {
        let through = Through { closed, shorten };
        one_path(&self.algorithm(algorithm)?, py, source, target, through)
    }

    /// The straightest geodesic from a point, as defined by Polthier and Schmies (1998): straight
    /// in faces and across edges; at a vertex it goes on with equal angles on both sides. It ends
    /// earlier at the border and at an edge of more than two faces. It need not be a shortest path.
    ///
    /// Parameters
    /// ----------
    /// point : int or Point
    /// direction : array_like, shape (3,)
    ///     A vector in space, of any length. The line starts in the direction of the surface that
    ///     is closest to it.
    /// length : float
    ///     In units of the mesh.
    ///
    /// Returns
    /// -------
    /// Path
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     The direction is perpendicular to the surface, or the length negative or not finite.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> cube = gd.generate("cube,n=1")
    /// >>> around = cube.trace(gd.at(0.5, 0.3, 1), [1, 0, 0], 4)
    /// >>> (around.points[-1] - around.points[0]).round(9) + 0.0
    /// array([0., 0., 0.])
    fn trace(
        &self,
        py: Python<'_>,
        point: &Bound<'_, PyAny>,
        direction: &Bound<'_, PyAny>,
        length: f64,
    ) -> PyResult<PyPath> {
        let start = Finder::new(py, &self.surface).find(single(point, "point")?, "point")?;
        let direction = arrays::vector(direction, "direction")?;
        let path = py.detach(|| line(self.mesh(), &start, direction, length));
        let path = path.map_err(|error| PyValueError::new_err(error.to_string()))?;
        PyPath::new(py, self.mesh(), &path)
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
    /// >>> places = gd.generate("grid,n=4").log_map(gd.face(5, 0.2, 0.3, 0.5))
    /// >>> np.linalg.norm(places[0] - places[24]).round(6)
    /// np.float64(5.656854)
    #[pyo3(signature = (source, *, algorithm = None))]
    fn log_map(
        &self,
        py: Python<'_>,
        source: &Bound<'_, PyAny>,
        algorithm: Option<&str>,
    ) -> PyResult<Py<PyArray2<f64>>> {
        self.algorithm(algorithm)?.log_map(py, source)
    }

    /// The shortest paths from the nearest source to each target, from one search: a list with a
    /// `Path` for each target, or `None` if it is unreachable.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> [path.length for path in gd.generate("grid,n=4").paths(0, [4, 20])]
    /// [4.0, 4.0]
    #[pyo3(signature = (source, targets, *, algorithm = None))]
    fn paths(
        &self,
        py: Python<'_>,
        source: &Bound<'_, PyAny>,
        targets: &Bound<'_, PyAny>,
        algorithm: Option<&str>,
    ) -> PyResult<Vec<Option<PyPath>>> {
        self.algorithm(algorithm)?
            .paths(py, source, targets, "targets")
    }

    /// The geodesic Voronoi diagram of sources. Its cells are the regions of the surface with the
    /// same nearest source.
    ///
    /// Parameters
    /// ----------
    /// sources : sequence of int or Point
    ///     Distinct points.
    ///
    /// Returns
    /// -------
    /// Voronoi
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     Two sources are at the same place.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> gd.generate("grid,n=4").voronoi([0, 24]).labels[:3]
    /// array([0, 0, 0])
    fn voronoi(slf: &Bound<'_, Self>, sources: &Bound<'_, PyAny>) -> PyResult<PyVoronoi> {
        PyVoronoi::new(slf.py(), slf, sources)
    }

    /// Isolines of the distance from the nearest source, as exact circular arcs.
    ///
    /// MMP runs and keeps all its windows. This takes several times as long as the distances of
    /// vertices, and much more memory: about a gigabyte for 300,000 faces. Exactly one of `every`
    /// and `levels` is required.
    ///
    /// Parameters
    /// ----------
    /// source : int, Point or sequence of these
    /// every : float
    ///     Return the isolines at all multiples of this distance up to the farthest point, in units
    ///     of the mesh.
    /// levels : sequence of float
    ///     Return the isolines at these distances, in units of the mesh.
    ///
    /// Returns
    /// -------
    /// list of Isoline
    ///     One for each distance.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     A distance is not positive, or `every` asks for more than 10,000 isolines.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> isolines = gd.generate("grid,n=4").isolines(0, every=2.0)
    /// >>> [round(isoline.length, 3) for isoline in isolines]
    /// [3.142, 6.283]
    #[pyo3(signature = (source, *, every = None, levels = None))]
    fn isolines(
        slf: &Bound<'_, Self>,
        source: &Bound<'_, PyAny>,
        every: Option<f64>,
        levels: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Vec<PyIsoline>> {
        // Refused before the field is computed.
        let asked = isolines::levels(every, levels)?;
        PyField::new(slf.py(), slf, source)?.lines(slf.py(), asked)
    }

    /// A new mesh of the same surface with evenly distributed vertices. It is the dual of the
    /// geodesic Voronoi diagram of sites that are chosen by farthest point sampling.
    ///
    /// The new mesh has the same components, genus and boundary loops.
    ///
    /// Parameters
    /// ----------
    /// sites : int
    ///     The number of sites, the vertices of the new mesh. More sites are added to components
    ///     and boundary loops that have too few, and where the dual would not be a triangulation.
    /// lloyd : int
    ///     The number of steps of Lloyd's algorithm. Each moves the sites to the centres of their
    ///     cells.
    /// rng : int, numpy.random.Generator or anything that numpy.random.default_rng takes, optional
    ///     Draws the first site of a surface without boundary: a number gives the same as a
    ///     generator that is made from it, `None` another one in each call.
    ///
    /// Returns
    /// -------
    /// Mesh
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     The mesh has fewer vertices than `sites` or no positions, or the dual is not a
    ///     triangulation of the surface.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> even = gd.generate("torus,faces=2000").remesh(100, lloyd=2, rng=1)
    /// >>> even.n_vertices
    /// 100
    #[pyo3(signature = (sites, *, lloyd = 5, rng = None))]
    fn remesh(
        &self,
        py: Python<'_>,
        sites: i64,
        lloyd: i64,
        rng: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let sites = arrays::count(sites, "sites", 1)?;
        let lloyd = arrays::count(lloyd, "lloyd", 0)?;
        let seed = seed_of(py, rng)?;
        let mesh = self.mesh().clone();
        let options = RemeshOptions { sites, lloyd, seed };
        let work = move || geodesics::remesh(&mesh, &options);
        let made = interrupt::long(py, &Stop::default(), work)?;
        let made = made.map_err(|error| PyValueError::new_err(error.to_string()))?;
        Self::new(py, made.soup(), self.name.clone(), "the new mesh", false)
    }

    /// Writes the mesh to a file. Its extension selects the format: `.obj`, `.ply`, `.off` or
    /// `.stl`, each also with `.gz` for compression.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> import tempfile, pathlib
    /// >>> with tempfile.TemporaryDirectory() as folder:
    /// ...     path = pathlib.Path(folder, "grid.ply")
    /// ...     gd.generate("grid,n=4").write(path)
    /// ...     gd.read(path).n_faces
    /// 32
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        if self.mesh().positions().is_empty() {
            return Err(PyValueError::new_err("the mesh has no positions to write"));
        }
        let soup = self.mesh().to_soup();
        py.detach(|| io::write(&path, &soup))
            .map_err(|error| unreadable(py, &error))
    }

    fn __repr__(&self) -> String {
        format!(
            "<geodesics.Mesh {:?}: {}, {}>",
            self.name,
            counted(self.mesh().vertex_count(), "vertex"),
            counted(self.mesh().face_count(), "face")
        )
    }
}

/// Reads the argument `rng` (SPEC 7 of Scientific Python): whatever it is, `default_rng` makes a
/// generator of it, which draws the seed.
fn seed_of(py: Python<'_>, rng: Option<&Bound<'_, PyAny>>) -> PyResult<u64> {
    let generator = py
        .import("numpy.random")?
        .call_method1("default_rng", (rng,));
    let generator =
        generator.map_err(|error| PyTypeError::new_err(format!("rng: {}", error.value(py))))?;
    generator
        .call_method1("integers", (1_u64 << 62,))?
        .extract()
}
