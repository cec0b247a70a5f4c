//! The class `Mesh`, and the functions that read and generate meshes.

use std::path::PathBuf;

use geobench_harness::exec::expected::stem;
use geodesics::io::ReadOptions;
use geodesics::mesh::{MeshMeasures, Report, Severity, Tolerance};
use geodesics::{Mesh, Place, RemeshOptions, Stop, TriangleSoup, VertexId, Weld, generate, io};
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
use crate::solver::{MeshAlgorithm, one_path, selection};
use crate::voronoi::PyVoronoi;

/// An immutable triangle mesh, validated when it is made. Vertices keep their numbers. Faces without
/// three different vertices and second copies are left out of `faces`; numbers of faces are those
/// of the array or file.
///
/// Surfaces need not be closed, connected, manifold or orientable. Algorithms that do not cross edges
/// with more than two faces, or surfaces that cannot be oriented, raise `ValueError`.
///
/// Parameters
/// ----------
/// vertices : array_like, shape (n, 3), real
///     Positions. Their unit is the unit of all distances.
/// faces : array_like, shape (m, 3), integer
///     The vertex numbers of the corners of each triangle, counted from 0.
/// name : str, optional
///     The name of the mesh in the tables of `run`.
/// weld : bool or float, optional
///     `True` makes vertices at exactly one place one vertex; a number those within this fraction of
///     the diagonal of the bounding box. Vertices keep their numbers, and copies get the distance of
///     the vertex that stands for them.
///
/// Raises
/// ------
/// MeshError
///     The mesh cannot be used. The message names the vertices and faces.
/// ValueError, TypeError
///     An array has another shape or type.
#[pyclass(frozen, module = "geodesics", name = "Mesh")]
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

    fn algorithm(&self, name: Option<&str>) -> PyResult<MeshAlgorithm> {
        let selection = selection(&self.mesh, name, None, "auto")?;
        Ok(MeshAlgorithm::new(&self.mesh, &selection))
    }
}

#[pymethods]
impl PyMesh {
    #[new]
    #[pyo3(signature = (vertices, faces, *, name = "mesh", weld = None))]
    fn py_new(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        name: &str,
        weld: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let positions = arrays::positions(vertices, "vertices")?;
        let triangles = arrays::triangles(faces, "faces")?;
        let mut soup = TriangleSoup::new(positions, triangles);
        if let Some(weld) = weld_of(weld)? {
            py.detach(|| soup.weld(weld));
        }
        Self::new(py, soup, name.to_owned(), "")
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

    /// (n, 3) float64: a copy of the positions of the vertices; shape (0, 3) if the mesh was made
    /// from lengths.
    #[getter]
    fn vertices(&self, py: Python<'_>) -> PyResult<Py<PyArray2<f64>>> {
        triples(py, self.mesh.positions())
    }

    /// (m, 3) uint32: a copy of the corners of the faces. Faces whose orientation was repaired have
    /// the new orientation.
    #[getter]
    fn faces(&self, py: Python<'_>) -> PyResult<Py<PyArray2<u32>>> {
        let corners = |face| self.mesh.face_vertices(face).map(VertexId::raw);
        let rows: Vec<[u32; 3]> = self.mesh.faces().map(corners).collect();
        triples(py, &rows)
    }

    /// int: number of vertices, including isolated ones.
    #[getter]
    fn n_vertices(&self) -> usize {
        self.mesh.vertex_count()
    }

    /// int: number of faces.
    #[getter]
    fn n_faces(&self) -> usize {
        self.mesh.face_count()
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
    /// `tolerance` * d + 1e-13 * m. The scale m of a component is the lesser of its greatest distance
    /// and 100 times the median of its finite distances in the reference. Infinite distances are
    /// right where the reference is infinite.
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
    /// (k,) uint32
    ///     Vertex numbers, in ascending order.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     An array has another shape, or holds NaN or a negative number.
    #[pyo3(signature = (found, reference, *, tolerance = 1e-9))]
    fn wrong_distances<'py>(
        &self,
        py: Python<'py>,
        found: &Bound<'py, PyAny>,
        reference: &Bound<'py, PyAny>,
        tolerance: f64,
    ) -> PyResult<Bound<'py, PyArray1<u32>>> {
        let vertices = self.mesh.vertex_count();
        let found = arrays::distances(found, "found", vertices)?;
        let reference = arrays::distances(reference, "reference", vertices)?;
        let rule = Tolerance::on(&self.mesh, &reference).with_relative(tolerance);
        let wrong = rule.wrong(&found, &reference).map(|v| v as u32);
        Ok(PyArray1::from_vec(py, wrong.collect()))
    }

    /// Counts and sizes: a dictionary with `vertices`, `faces`, `edges`, `boundary_edges`,
    /// `boundary_loops`, `components`, `genus`, `saddles`, `euler_characteristic`, `area`,
    /// `anisotropy`, `min_edge_length`, `mean_edge_length` and `max_edge_length`. Lengths are in
    /// units of the mesh.
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

    /// Locates a point on the surface.
    ///
    /// Parameters
    /// ----------
    /// point : int or Point
    ///
    /// Returns
    /// -------
    /// face : int
    ///     A face that contains the point; -1 for an isolated vertex.
    /// barycentric : tuple of three floats
    ///     Its barycentric coordinates in that face.
    /// position : tuple of three floats or None
    ///     Its position in space; `None` if the mesh has no positions.
    /// distance : float
    ///     For a point made by `at`, its distance from the position that was given; otherwise 0.
    fn locate(&self, point: &Bound<'_, PyAny>) -> PyResult<Located> {
        let spec = single(point, "point")?;
        let (found, distance) = Finder::new(&self.mesh).find_from(spec, "point")?;
        let (face, weights) = match self.mesh.face_of(&found) {
            Some((face, weights)) => {
                let (triangle, weights) = self.mesh.in_file(face, weights);
                (i64::from(triangle), weights)
            }
            None => (-1, [0.0; 3]),
        };
        let position = self.mesh.position_of(&found);
        Ok((face, weights.into(), position.map(Into::into), distance))
    }

    /// The number of a vertex near the position `(x, y, z)`: the nearest corner of the face that
    /// contains the nearest point of the surface. Another vertex can be nearer to the position.
    fn nearest_vertex(&self, x: f64, y: f64, z: f64) -> PyResult<u32> {
        let spec = crate::points::at(x, y, z, true)?.0;
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

    /// Distances from the nearest source. The algorithm is set up for this call; a `Solver` keeps
    /// its set-up for several calls.
    ///
    /// Parameters
    /// ----------
    /// source : int, Point or sequence of these
    ///     One or several sources: vertices, or points of the surface (`vertex`, `edge`, `face`,
    ///     `at`).
    /// radius : float, optional
    ///     The search ends at this distance, in units of the mesh. Greater distances are `inf`.
    /// targets : int, Point or sequence of these, optional
    ///     Compute only the distances of these points. The search ends when all are reached.
    /// algorithm : str, optional
    ///     A name from `algorithms()`. The default is `"vtp-fast"`, or `"mmp-fast"` on a mesh with
    ///     edges of more than two faces or one that cannot be oriented.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (n,), float64
    ///     The distance of each of the n vertices, or of each target, in units of the mesh; `inf`
    ///     if it is unreachable or beyond the radius.
    ///
    /// Raises
    /// ------
    /// IndexError
    ///     A vertex or face does not exist.
    /// ValueError, TypeError
    ///     An argument is out of range or has the wrong type.
    #[pyo3(signature = (source, *, radius = None, targets = None, algorithm = None))]
    fn distance<'py>(
        &self,
        py: Python<'py>,
        source: &Bound<'py, PyAny>,
        radius: Option<f64>,
        targets: Option<&Bound<'py, PyAny>>,
        algorithm: Option<&str>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.algorithm(algorithm)?
            .distance(py, source, radius, targets)
    }

    /// Distances from each source separately, one row per source.
    ///
    /// Parameters
    /// ----------
    /// sources : sequence of int or Point
    /// threads : int
    ///     The number of sources that are solved at the same time. If it is at least twice the
    ///     number of sources, a parallel algorithm uses several threads per source.
    /// radius, targets, algorithm
    ///     As for `distance`.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (k, n), float64
    ///     Row i has the distances of the n vertices, or of the targets, from source i, in units of
    ///     the mesh.
    #[pyo3(signature = (sources, *, threads = 1, radius = None, targets = None,
                        algorithm = None))]
    fn distances<'py>(
        &self,
        py: Python<'py>,
        sources: &Bound<'py, PyAny>,
        threads: u32,
        radius: Option<f64>,
        targets: Option<&Bound<'py, PyAny>>,
        algorithm: Option<&str>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let algorithm = self.algorithm(algorithm)?;
        algorithm.distances(py, sources, threads, radius, targets)
    }

    /// The shortest path from the nearest source to `target`.
    ///
    /// Parameters
    /// ----------
    /// source : int, Point or sequence of these
    /// target : int or Point
    /// algorithm : str, optional
    ///     A name from `algorithms()`. The default is `"vtp-fast"`, or `"mmp-fast"` on a mesh with
    ///     edges of more than two faces or one that cannot be oriented.
    ///
    /// Returns
    /// -------
    /// Path or None
    ///     `None` if the target is unreachable.
    #[pyo3(signature = (source, target, *, algorithm = None))]
    fn path(
        &self,
        py: Python<'_>,
        source: &Bound<'_, PyAny>,
        target: &Bound<'_, PyAny>,
        algorithm: Option<&str>,
    ) -> PyResult<Option<PyPath>> {
        one_path(&self.algorithm(algorithm)?, py, source, target)
    }

    /// The shortest paths from the nearest source to each target, from one search: a list with a
    /// `Path` for each target, or `None` if it is unreachable.
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
    fn voronoi(&self, py: Python<'_>, sources: &Bound<'_, PyAny>) -> PyResult<PyVoronoi> {
        PyVoronoi::new(py, &self.mesh, sources)
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
    /// seed : int
    ///     Seed that draws the first site of a surface without boundary.
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
    #[pyo3(signature = (sites, *, lloyd = 5, seed = 0))]
    fn remesh(&self, py: Python<'_>, sites: usize, lloyd: usize, seed: u64) -> PyResult<Self> {
        let mesh = self.mesh.clone();
        let options = RemeshOptions { sites, lloyd, seed };
        let work = move || geodesics::remesh(&mesh, &options);
        let made = interrupt::long(py, &Stop::default(), work)?;
        let made = made.map_err(|error| PyValueError::new_err(error.to_string()))?;
        Self::new(py, made.soup(), self.name.clone(), "the new mesh")
    }

    /// Writes the mesh to a file. Its extension selects the format: `.obj`, `.ply`, `.off` or
    /// `.stl`, each also with `.gz` for compression.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        if self.mesh.positions().is_empty() {
            return Err(PyValueError::new_err("the mesh has no positions to write"));
        }
        let soup = self.mesh.to_soup();
        py.detach(|| io::write(&path, &soup))
            .map_err(|error| unreadable(py, &error))
    }

    fn __repr__(&self) -> String {
        format!(
            "<geodesics.Mesh {:?}: {} vertices, {} faces>",
            self.name,
            self.mesh.vertex_count(),
            self.mesh.face_count()
        )
    }
}

/// A face, barycentric coordinates in it, the position, and the distance from the position that was
/// given.
type Located = (i64, (f64, f64, f64), Option<(f64, f64, f64)>, f64);

/// Reads a mesh from a file in OBJ, PLY, OFF, STL, VTK (`.vtk`, `.vtp`, `.vtu`), glTF, 3MF, COLLADA,
/// GIFTI or FreeSurfer format, with or without gzip compression. `weld` is that of `Mesh`; STL files have no vertex numbers, so that their coincident
/// vertices always are one.
///
/// Raises
/// ------
/// OSError
///     The file cannot be read.
/// MeshError
///     The file holds no usable mesh. The message names the line or the elements.
#[pyfunction]
#[pyo3(signature = (path, *, weld = None))]
pub(crate) fn read(
    py: Python<'_>,
    path: PathBuf,
    weld: Option<&Bound<'_, PyAny>>,
) -> PyResult<PyMesh> {
    let options = ReadOptions {
        weld: weld_of(weld)?,
        ..ReadOptions::default()
    };
    let soup = py
        .detach(|| options.read(&path))
        .map_err(|error| unreadable(py, &error))?;
    PyMesh::new(py, soup, stem(&path), &path.display().to_string())
}

/// Reads the argument `weld`: none, a truth value or a tolerance.
fn weld_of(value: Option<&Bound<'_, PyAny>>) -> PyResult<Option<Weld>> {
    let Some(value) = value else {
        return Ok(None);
    };
    if let Ok(wanted) = value.extract::<bool>() {
        return Ok(wanted.then_some(Weld::COINCIDENT));
    }
    let weld = Weld::within(value.extract()?);
    weld.map(Some)
        .map_err(|error| PyValueError::new_err(format!("weld: {error}")))
}

/// Generates a mesh from a description such as `"torus,faces=5000"`, `"sphere,subdiv=4"` or
/// `"terrain,n=100,seed=1"`.
#[pyfunction]
#[pyo3(name = "generate")]
pub(crate) fn generated(py: Python<'_>, spec: &str) -> PyResult<PyMesh> {
    let wrong = |error: generate::GenerateError| PyValueError::new_err(format!("spec: {error}"));
    let parsed: generate::Spec = spec.parse().map_err(wrong)?;
    let soup = py.detach(|| generate::generate(&parsed)).map_err(wrong)?;
    let name = spec.strip_prefix("gen:").unwrap_or(spec);
    PyMesh::new(py, soup, name.to_owned(), spec)
}
