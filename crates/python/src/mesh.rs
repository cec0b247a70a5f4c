//! The mesh.

use std::path::{Path, PathBuf};

use geodesic::mesh::{MeshMeasures, Report, Severity};
use geodesic::{Mesh, Place, RemeshOptions, Stop, TriangleSoup, VertexId, generate, io};
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays;
use crate::errors::{invalid, unreadable};
use crate::interrupt;
use crate::isolines::{PyIsoline, isolines};
use crate::path::{PyPath, triples};
use crate::points::{Finder, single};
use crate::solver::{Algorithm, one_path, selection};
use crate::voronoi::PyVoronoi;

/// A triangle mesh, checked once and never changed. Vertices keep their numbers.
///
/// Surfaces need not be closed, connected or manifold at every vertex. Edges with more than two
/// faces and surfaces that cannot be oriented are refused.
///
/// Parameters
/// ----------
/// vertices : array_like, shape (n, 3), real
///     Positions. Distances have their unit.
/// faces : array_like, shape (m, 3), integer
///     The numbers of the corners of each triangle, from 0.
/// name : str, optional
///     Its name in the tables of `run`.
///
/// Raises
/// ------
/// MeshError
///     The mesh cannot be used. The message names the vertices and faces.
/// ValueError, TypeError
///     An array has another shape or type.
#[pyclass(frozen, module = "geobench", name = "Mesh")]
pub(crate) struct PyMesh {
    pub(crate) mesh: Mesh,
    pub(crate) name: String,
    defects: Vec<String>,
}

impl PyMesh {
    pub(crate) fn new(
        py: Python<'_>,
        soup: TriangleSoup,
        name: String,
        place: &str,
    ) -> PyResult<Self> {
        let made = py.detach(|| Mesh::from_soup(soup));
        let (mesh, report) = made.map_err(|error| invalid(py, &error, place))?;
        Ok(Self::of(mesh, &report, name))
    }

    fn of(mesh: Mesh, report: &Report, name: String) -> Self {
        let known = report.summaries().into_iter();
        let defects = known.filter(|summary| summary.kind.severity() != Severity::Fatal);
        Self {
            mesh,
            name,
            defects: defects.map(|summary| summary.text).collect(),
        }
    }

    fn algorithm(&self, name: &str) -> PyResult<Algorithm> {
        Ok(Algorithm::new(&self.mesh, &selection(name, None, "auto")?))
    }
}

#[pymethods]
impl PyMesh {
    #[new]
    #[pyo3(signature = (vertices, faces, *, name = "mesh"))]
    fn py_new(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        name: &str,
    ) -> PyResult<Self> {
        let positions = arrays::positions(vertices, "vertices")?;
        let triangles = arrays::triangles(faces, "faces")?;
        Self::new(
            py,
            TriangleSoup::new(positions, triangles),
            name.to_owned(),
            "",
        )
    }

    /// A surface that is known by the lengths of its edges alone, which need not fit into space.
    ///
    /// Parameters
    /// ----------
    /// n : int
    ///     Number of vertices.
    /// faces : array_like, shape (m, 3), integer
    /// lengths : array_like, shape (m, 3), real
    ///     Of the edges from the first corner to the second, from there to the third, and back.
    #[staticmethod]
    #[pyo3(signature = (n, faces, lengths, *, name = "mesh"))]
    fn from_lengths(
        py: Python<'_>,
        n: usize,
        faces: &Bound<'_, PyAny>,
        lengths: &Bound<'_, PyAny>,
        name: &str,
    ) -> PyResult<Self> {
        let triangles = arrays::triangles(faces, "faces")?;
        let lengths = arrays::positions(lengths, "lengths")?;
        let made = py.detach(|| Mesh::from_lengths(n, &triangles, &lengths));
        let (mesh, report) = made.map_err(|error| invalid(py, &error, ""))?;
        Ok(Self::of(mesh, &report, name.to_owned()))
    }

    /// (n, 3) float64: the positions of the vertices, a copy; (0, 3) if only lengths are known.
    #[getter]
    fn vertices(&self, py: Python<'_>) -> PyResult<Py<PyArray2<f64>>> {
        triples(py, self.mesh.positions())
    }

    /// (m, 3) uint32: the corners of the faces, a copy. Faces that were turned over are as they
    /// are used.
    #[getter]
    fn faces(&self, py: Python<'_>) -> PyResult<Py<PyArray2<u32>>> {
        let corners = |face| self.mesh.face_vertices(face).map(VertexId::raw);
        let rows: Vec<[u32; 3]> = self.mesh.faces().map(corners).collect();
        triples(py, &rows)
    }

    /// int: number of vertices, those in no face included.
    #[getter]
    fn n_vertices(&self) -> usize {
        self.mesh.vertex_count()
    }

    /// int: number of faces.
    #[getter]
    fn n_faces(&self) -> usize {
        self.mesh.face_count()
    }

    /// str: its name in tables.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// list of str: what was repaired or is worth knowing, a sentence for each kind.
    #[getter]
    fn defects(&self) -> Vec<String> {
        self.defects.clone()
    }

    /// Counts and sizes: a dictionary with `vertices`, `faces`, `edges`, `boundary_edges`,
    /// `boundary_loops`, `components`, `genus`, `saddles`, `euler_characteristic`, `area`,
    /// `anisotropy`, and the `min`, `mean` and `max` of `_edge_length`.
    fn info<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let measures = py.detach(|| MeshMeasures::of(&self.mesh));
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

    /// Where a point is.
    ///
    /// Returns
    /// -------
    /// face : int
    ///     A face that contains it; -1 for an isolated vertex.
    /// barycentric : tuple of three floats
    ///     Its coordinates there.
    /// position : tuple of three floats or None
    ///     Its position in space; `None` if the mesh has none.
    /// distance : float
    ///     How far it is from the position that `at` asks for; 0 for other points.
    fn locate(&self, point: &Bound<'_, PyAny>) -> PyResult<Located> {
        let spec = single(point, "point")?;
        let (found, distance) = Finder::new(&self.mesh).find_from(spec, "point")?;
        let (face, weights) = match self.mesh.face_of(&found) {
            Some((face, weights)) => (i64::from(face.raw()), weights),
            None => (-1, [0.0; 3]),
        };
        let position = self.mesh.position_of(&found);
        Ok((face, weights.into(), position.map(Into::into), distance))
    }

    /// The vertex nearest to a position among the corners of the face in which the nearest point of
    /// the surface is.
    fn nearest_vertex(&self, x: f64, y: f64, z: f64) -> PyResult<u32> {
        let spec = crate::points::at(x, y, z)?.0;
        let found = Finder::new(&self.mesh).find(spec, "position")?;
        if let Place::Vertex(v) = found.place() {
            return Ok(v.raw());
        }
        let positions = self.mesh.positions();
        let squared = |v: &VertexId| -> f64 {
            let corner = positions[v.index()];
            [x, y, z]
                .iter()
                .zip(corner)
                .map(|(a, b)| (a - b).powi(2))
                .sum()
        };
        let corners = self
            .mesh
            .face_of(&found)
            .map(|(face, _)| self.mesh.face_vertices(face));
        corners
            .into_iter()
            .flatten()
            .min_by(|a, b| squared(a).total_cmp(&squared(b)))
            .map(VertexId::raw)
            .ok_or_else(|| PyValueError::new_err("position: no vertex is near it"))
    }

    /// Distances from the nearest of the sources. It sets the algorithm up for this one question;
    /// keep a `Solver` for more.
    ///
    /// Parameters
    /// ----------
    /// source : int, Point or sequence of these
    ///     Vertices, or points of the surface (`vertex`, `edge`, `face`, `at`).
    /// radius : float, optional
    ///     Distances beyond it are infinite. The search ends there. In units of the mesh.
    /// targets : int, Point or sequence of these, optional
    ///     The only points whose distances are wanted. The search ends when all are reached.
    /// algorithm : str
    ///     A name of `algorithms()`.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (n,), float64
    ///     The distance of each of the n vertices, or of each target, in units of the mesh; `inf`
    ///     where no path leads or the radius ends.
    ///
    /// Raises
    /// ------
    /// IndexError
    ///     A vertex or face does not exist.
    /// ValueError, TypeError
    ///     An argument is out of range or of another type.
    #[pyo3(signature = (source, *, radius = None, targets = None, algorithm = "vtp-fast"))]
    fn distance<'py>(
        &self,
        py: Python<'py>,
        source: &Bound<'py, PyAny>,
        radius: Option<f64>,
        targets: Option<&Bound<'py, PyAny>>,
        algorithm: &str,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.algorithm(algorithm)?
            .distance(py, source, radius, targets)
    }

    /// Distances from each of the sources: one row a source.
    ///
    /// Parameters
    /// ----------
    /// sources : sequence of int or Point
    /// threads : int
    ///     Sources that are solved at the same time.
    /// radius, targets, algorithm
    ///     As of `distance`.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (k, n), float64
    ///     Row i has the distances from source i, of the n vertices or of the targets, in units of
    ///     the mesh.
    #[pyo3(signature = (sources, *, threads = 1, radius = None, targets = None,
                        algorithm = "vtp-fast"))]
    fn distances<'py>(
        &self,
        py: Python<'py>,
        sources: &Bound<'py, PyAny>,
        threads: u32,
        radius: Option<f64>,
        targets: Option<&Bound<'py, PyAny>>,
        algorithm: &str,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let algorithm = self.algorithm(algorithm)?;
        algorithm.distances(py, sources, threads, radius, targets)
    }

    /// The shortest path from the nearest of the sources to `target`.
    ///
    /// Parameters
    /// ----------
    /// source : int, Point or sequence of these
    /// target : int or Point
    /// algorithm : str
    ///
    /// Returns
    /// -------
    /// Path or None
    ///     `None` if no path leads there.
    #[pyo3(signature = (source, target, *, algorithm = "vtp-fast"))]
    fn path(
        &self,
        py: Python<'_>,
        source: &Bound<'_, PyAny>,
        target: &Bound<'_, PyAny>,
        algorithm: &str,
    ) -> PyResult<Option<PyPath>> {
        one_path(&self.algorithm(algorithm)?, py, source, target)
    }

    /// The shortest paths from the nearest of the sources to each of the targets, of one search: a
    /// list of `Path`, and `None` where no path leads.
    #[pyo3(signature = (source, targets, *, algorithm = "vtp-fast"))]
    fn paths(
        &self,
        py: Python<'_>,
        source: &Bound<'_, PyAny>,
        targets: &Bound<'_, PyAny>,
        algorithm: &str,
    ) -> PyResult<Vec<Option<PyPath>>> {
        self.algorithm(algorithm)?
            .paths(py, source, targets, "targets")
    }

    /// The geodesic Voronoi diagram of points: which of them is the nearest, everywhere on the
    /// surface.
    ///
    /// Parameters
    /// ----------
    /// sources : sequence of int or Point
    ///     Points at different places.
    fn voronoi(&self, py: Python<'_>, sources: &Bound<'_, PyAny>) -> PyResult<PyVoronoi> {
        PyVoronoi::new(py, &self.mesh, sources)
    }

    /// The points at some distances from the nearest of the sources, as exact arcs.
    ///
    /// It keeps all windows of MMP, which takes several times as long as distances of vertices, and
    /// much more memory: about a gigabyte for 300,000 faces.
    ///
    /// Parameters
    /// ----------
    /// source : int, Point or sequence of these
    /// every : float
    ///     The levels are its multiples, up to the farthest point. In units of the mesh.
    /// levels : sequence of float
    ///     The levels, instead.
    ///
    /// Returns
    /// -------
    /// list of Isoline
    ///     One for each level.
    #[pyo3(signature = (source, *, every = None, levels = None))]
    fn isolines(
        &self,
        py: Python<'_>,
        source: &Bound<'_, PyAny>,
        every: Option<f64>,
        levels: Option<Vec<f64>>,
    ) -> PyResult<Vec<PyIsoline>> {
        isolines(py, &self.mesh, source, every, levels)
    }

    /// A new mesh of the same surface with evenly spread vertices: the dual of the geodesic Voronoi
    /// diagram of points spread by farthest point sampling.
    ///
    /// Its components, genus and boundary loops are those of the mesh.
    ///
    /// Parameters
    /// ----------
    /// sites : int
    ///     The number of vertices to make. There can be more: on a boundary, or where the dual
    ///     would be no triangulation.
    /// lloyd : int
    ///     Steps of Lloyd's algorithm, each of which moves the points to the centres of their
    ///     cells.
    /// seed : int
    ///     Draws the first point.
    ///
    /// Returns
    /// -------
    /// Mesh
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     There are fewer vertices than `sites`, the mesh has no positions, or so few points make
    ///     no triangulation of the surface.
    #[pyo3(signature = (sites, *, lloyd = 5, seed = 0))]
    fn remesh(&self, py: Python<'_>, sites: usize, lloyd: usize, seed: u64) -> PyResult<Self> {
        let mesh = self.mesh.clone();
        let options = RemeshOptions { sites, lloyd, seed };
        let work = move || geodesic::remesh(&mesh, &options);
        let made = interrupt::long(py, &Stop::default(), work)?;
        let made = made.map_err(|error| PyValueError::new_err(error.to_string()))?;
        Self::new(py, made.soup(), self.name.clone(), "the new mesh")
    }

    /// Writes the mesh to an OBJ or a PLY file, by its ending, compressed if that is `.gz`.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        if self.mesh.positions().is_empty() {
            return Err(PyValueError::new_err("the mesh has no positions to write"));
        }
        let corners = |face| self.mesh.face_vertices(face).map(VertexId::raw);
        let soup = TriangleSoup::new(
            self.mesh.positions().to_vec(),
            self.mesh.faces().map(corners).collect(),
        );
        py.detach(|| io::write(&path, &soup))
            .map_err(|error| unreadable(py, &error))
    }

    fn __repr__(&self) -> String {
        format!(
            "<geobench.Mesh {:?}: {} vertices, {} faces>",
            self.name,
            self.mesh.vertex_count(),
            self.mesh.face_count()
        )
    }
}

/// A face, the barycentric coordinates there, the position and the distance from where it was
/// looked for.
type Located = (i64, (f64, f64, f64), Option<(f64, f64, f64)>, f64);

/// Reads an OBJ, PLY (text and binary), OFF or STL file, compressed with gzip or not.
///
/// Raises
/// ------
/// OSError
///     The file cannot be read.
/// MeshError
///     It holds no mesh that can be used. The message names the line or the elements.
#[pyfunction]
pub(crate) fn read(py: Python<'_>, path: PathBuf) -> PyResult<PyMesh> {
    let soup = py
        .detach(|| io::read(&path))
        .map_err(|error| unreadable(py, &error))?;
    PyMesh::new(py, soup, stem(&path), &path.display().to_string())
}

/// The name of a file without its endings.
fn stem(path: &Path) -> String {
    let name = path
        .file_name()
        .map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    name.rsplit_once('.')
        .map_or(name, |(stem, _)| stem)
        .to_owned()
}

/// Makes a model, such as `"torus,faces=5000"`, `"sphere,subdiv=4"` or `"terrain,n=100,seed=1"`.
#[pyfunction]
#[pyo3(name = "generate")]
pub(crate) fn generated(py: Python<'_>, spec: &str) -> PyResult<PyMesh> {
    let wrong = |error: generate::GenerateError| PyValueError::new_err(format!("spec: {error}"));
    let parsed: generate::Spec = spec.parse().map_err(wrong)?;
    let soup = py.detach(|| generate::generate(&parsed)).map_err(wrong)?;
    let name = spec.strip_prefix("gen:").unwrap_or(spec);
    PyMesh::new(py, soup, name.to_owned(), spec)
}
