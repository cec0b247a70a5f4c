//! Geodesic Voronoi diagrams.

use std::collections::HashSet;
use std::sync::Arc as Shared;

use geobench_harness::exec::point::PointSpec;
use geobench_harness::measure::number::counted;
use geodesics::voronoi::NO_SOURCE;
use geodesics::{Diagram, FieldSolver, Mesh, Refined, Stop, VertexId, WindowVtp};
use numpy::{PyArray1, PyArray2};
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays;
use crate::errors::solve_error;
use crate::interrupt;
use crate::mesh::PyMesh;
use crate::path::tuples;
use crate::points::{PyPoint, ResolvedPoints, core, together};

/// A geodesic Voronoi diagram. Its cells are the regions of a surface with the same nearest source.
/// Iteration gives the cells.
///
/// Examples
/// --------
/// >>> import geodesics as gd
/// >>> diagram = gd.generate("grid,n=4").voronoi([0, 24])
/// >>> [round(cell.area, 12) for cell in diagram]
/// [8.0, 8.0]
#[pyclass(frozen, weakref, module = "geodesics", name = "Voronoi")]
pub(crate) struct PyVoronoi {
    diagram: Shared<Diagram>,
    surface: Shared<RefinedSurface>,
    /// (n,) int64: for each vertex the index of its nearest source; -1 if it is unreachable.
    #[pyo3(get)]
    labels: Py<PyArray1<i64>>,
    /// (n,) float64: for each vertex the distance from its nearest source, in units of the mesh;
    /// `inf` if it is unreachable.
    #[pyo3(get)]
    distances: Py<PyArray1<f64>>,
}

/// A mesh, its sources, and the refined mesh on which these are vertices.
struct RefinedSurface {
    mesh: Mesh,
    refined: Refined,
    /// The sources as vertices of `refined`.
    sources: Vec<VertexId>,
    /// The sources as the caller gave them.
    specs: Vec<PointSpec>,
    of_python: Py<PyMesh>,
}

impl RefinedSurface {
    /// The number of the vertex at a source; `None` if the source is not a vertex of `mesh`.
    fn vertex(&self, source: usize) -> Option<u32> {
        let vertex = self.sources[source];
        (vertex.index() < self.mesh.vertex_count()).then(|| vertex.raw())
    }
}

/// The region of a surface that is nearer to one source than to any other.
///
/// Examples
/// --------
/// >>> import geodesics as gd
/// >>> gd.generate("grid,n=4").voronoi([0, 24]).cells[0].neighbours
/// [1]
#[pyclass(frozen, get_all, weakref, module = "geodesics", name = "Cell")]
pub(crate) struct PyCell {
    /// int: index of its source.
    source: usize,
    /// int or None: the number of the vertex at its source; `None` if its source is not a vertex.
    vertex: Option<u32>,
    /// float: its area, in square units of the mesh.
    area: f64,
    /// float: the length of its border, including the boundary of the surface, in units of the
    /// mesh.
    perimeter: f64,
    /// list of int: the indices of the cells with which it shares a border, in ascending order.
    neighbours: Vec<u32>,
    /// bool: whether it is a disc: connected and without holes.
    is_disc: bool,
    /// int: the Euler characteristic of its interior, 1 for a disc.
    euler: i64,
}

#[pymethods]
impl PyCell {
    fn __repr__(&self) -> String {
        let source = match self.vertex {
            Some(vertex) => format!("vertex {vertex}"),
            None => format!("source {}", self.source),
        };
        format!(
            "<geodesics.Cell of {source}: area {}, {}>",
            self.area,
            counted(self.neighbours.len(), "neighbour")
        )
    }
}

/// A piece of the border between two cells, inside one face.
///
/// Examples
/// --------
/// >>> import geodesics as gd
/// >>> gd.generate("grid,n=4").voronoi([0, 24]).arcs[0].kind
/// 'line'
#[pyclass(frozen, weakref, module = "geodesics", name = "Arc")]
pub(crate) struct PyArc {
    diagram: Shared<Diagram>,
    surface: Shared<RefinedSurface>,
    place: usize,
}

impl PyArc {
    fn arc(&self) -> &geodesics::voronoi::BorderArc {
        &self.diagram.arcs()[self.place]
    }
}

#[pymethods]
impl PyArc {
    /// int: the number of the face that contains it.
    #[getter]
    fn face(&self) -> u32 {
        let refined = &self.surface.refined;
        refined
            .original()
            .file_triangle(refined.parent(self.arc().face))
    }

    /// tuple of two ints: the indices of the cells on its left and on its right.
    #[getter]
    fn sources(&self) -> (u32, u32) {
        self.arc().sources.into()
    }

    /// tuple of two ints: the numbers of its start node and its end node. Arcs that meet at a point
    /// have the same node there.
    #[getter]
    fn nodes(&self) -> (u32, u32) {
        self.arc().nodes.into()
    }

    /// str: its shape, "line" or "hyperbola".
    #[getter]
    fn kind(&self) -> &'static str {
        if self.arc().is_line() {
            "line"
        } else {
            "hyperbola"
        }
    }

    /// float: its length, in units of the mesh.
    #[getter]
    fn length(&self) -> f64 {
        self.arc().length()
    }

    /// Positions along the arc from its start to its end.
    ///
    /// Parameters
    /// ----------
    /// parts : int
    ///     The number of chords that approximate a hyperbola.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (k, 3), float64
    ///     Two positions of a line, `parts + 1` of a hyperbola, in units of the mesh.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     The mesh has no positions.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> gd.generate("grid,n=4").voronoi([0, 24]).arcs[0].points().shape
    /// (2, 3)
    #[pyo3(signature = (parts = 8))]
    fn points(&self, py: Python<'_>, parts: i64) -> PyResult<Py<PyArray2<f64>>> {
        let arc = self.arc();
        let parts = arrays::count(parts, "parts", 1)?;
        let parts = if arc.is_line() { 1 } else { parts };
        let place = |i: usize| match i {
            0 => arc.ends[0],
            i if i == parts => arc.ends[1],
            i => arc.point(i as f64 / parts as f64),
        };
        let position = |i| self.diagram.position(arc.face, place(i));
        let points: Option<Vec<[f64; 3]>> = (0..=parts).map(position).collect();
        let points = points.ok_or_else(|| PyValueError::new_err("the mesh has no positions"))?;
        tuples(py, &points)
    }

    fn __repr__(&self) -> String {
        let [a, b] = self.arc().sources;
        format!(
            "<geodesics.Arc between cells {a} and {b} in face {}>",
            self.face()
        )
    }
}

/// A point at which three cells or more meet.
///
/// Examples
/// --------
/// >>> import geodesics as gd
/// >>> diagram = gd.generate("sphere,subdiv=2").voronoi([0, 40, 80, 120])
/// >>> len(diagram.vertices[0].sources) >= 3
/// True
#[pyclass(frozen, get_all, weakref, module = "geodesics", name = "VoronoiVertex")]
pub(crate) struct PyVoronoiVertex {
    /// tuple of three floats or None: its position; `None` if the mesh has no positions.
    position: Option<(f64, f64, f64)>,
    /// int: the number of a face that contains it.
    face: u32,
    /// tuple of three floats: its barycentric coordinates in that face.
    barycentric: (f64, f64, f64),
    /// list of int: the indices of the cells around it, counter-clockwise.
    sources: Vec<u32>,
    /// float: its distance from the sources of these cells, in units of the mesh.
    distance: f64,
}

#[pymethods]
impl PyVoronoiVertex {
    fn __repr__(&self) -> String {
        format!(
            "<geodesics.VoronoiVertex of cells {:?} in face {}>",
            self.sources, self.face
        )
    }
}

/// A pickled diagram: computed again.
#[pyfunction]
pub(crate) fn _voronoi(
    mesh: &Bound<'_, PyMesh>,
    sources: &Bound<'_, PyAny>,
) -> PyResult<PyVoronoi> {
    PyVoronoi::new(mesh.py(), mesh, sources)
}

impl PyVoronoi {
    pub(crate) fn new(
        py: Python<'_>,
        python_mesh: &Bound<'_, PyMesh>,
        sources: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let surface = &python_mesh.get().surface;
        let mesh = &surface.mesh;
        let specs = together(sources, "sources", mesh.vertex_count())?;
        let points = ResolvedPoints::new(py, surface, specs.clone(), "sources", None)?;
        let (refined, sources) = points.refine();
        let mut seen = HashSet::new();
        for (i, v) in sources.iter().enumerate() {
            if !seen.insert(v) {
                let name = match specs[i] {
                    PointSpec::Vertex(v) => format!("vertex {v}"),
                    spec => spec.to_string(),
                };
                return Err(PyValueError::new_err(format!(
                    "sources: {name} occurs twice"
                )));
            }
        }
        let faces = mesh.face_count();
        let surface = Shared::new(RefinedSurface {
            mesh: mesh.clone(),
            refined,
            sources,
            specs,
            of_python: python_mesh.clone().unbind(),
        });
        let asked = Shared::clone(&surface);
        let work = move || {
            let mut solver = WindowVtp::new(&asked.refined.mesh);
            let field = solver.field(&asked.sources)?;
            let diagram = Diagram::new(&field, asked.sources.len());
            Ok((diagram, field.distances().to_vec()))
        };
        let made = interrupt::call(py, faces, &Stop::default(), work)?;
        let (diagram, mut distances) = made.map_err(solve_error)?;
        // Drop the distances of vertices that were inserted for sources.
        let vertices = mesh.vertex_count();
        distances.truncate(vertices);
        let label = |&label: &u32| {
            if label == NO_SOURCE {
                -1
            } else {
                i64::from(label)
            }
        };
        Ok(Self {
            surface,
            labels: PyArray1::from_iter(py, diagram.labels()[..vertices].iter().map(label))
                .unbind(),
            distances: PyArray1::from_vec(py, distances).unbind(),
            diagram: Shared::new(diagram),
        })
    }
}

#[pymethods]
impl PyVoronoi {
    /// list of int or Point: the sources. A source at a vertex is the number of the vertex.
    #[getter]
    fn sources(&self, py: Python<'_>) -> PyResult<Vec<Py<PyAny>>> {
        let specs = self.surface.specs.iter().enumerate();
        specs
            .map(|(i, spec)| match self.surface.vertex(i) {
                Some(vertex) => vertex.into_py_any(py),
                None => PyPoint(*spec).into_py_any(py),
            })
            .collect()
    }

    /// list of Cell: one cell for each source, in the order of the sources.
    #[getter]
    fn cells(&self) -> Vec<PyCell> {
        let cells = self.diagram.cells().iter().enumerate();
        cells
            .map(|(source, cell)| PyCell {
                source,
                vertex: self.surface.vertex(source),
                area: cell.area,
                perimeter: cell.perimeter,
                neighbours: cell.neighbours.clone(),
                is_disc: cell.is_disc(),
                euler: cell.euler,
            })
            .collect()
    }

    /// list of Arc: the pieces of the borders between cells, each inside one face.
    #[getter]
    fn arcs(&self) -> Vec<PyArc> {
        let places = 0..self.diagram.arcs().len();
        places
            .map(|place| PyArc {
                diagram: Shared::clone(&self.diagram),
                surface: Shared::clone(&self.surface),
                place,
            })
            .collect()
    }

    /// list of VoronoiVertex: the points at which three cells or more meet.
    #[getter]
    fn vertices(&self) -> Vec<PyVoronoiVertex> {
        let (diagram, surface) = (&self.diagram, &self.surface);
        let refined = &surface.refined;
        let vertices = diagram.vertices().iter();
        vertices
            .map(|vertex| {
                let node = diagram.nodes()[vertex.node as usize];
                let weights = diagram.barycentric(node.face, node.place);
                let weights = refined.in_parent(node.face, weights);
                let face = refined.parent(node.face);
                let (face, weights) = refined.original().in_file(face, weights);
                PyVoronoiVertex {
                    position: diagram.position(node.face, node.place).map(Into::into),
                    face,
                    barycentric: weights.into(),
                    sources: vertex.cells.clone(),
                    distance: vertex.distance,
                }
            })
            .collect()
    }

    /// The dual of the diagram, the geodesic Delaunay triangulation: a mesh with the sources as
    /// vertices, in their order, and a face for each Voronoi vertex, or several where more than
    /// three cells meet.
    ///
    /// Returns
    /// -------
    /// Mesh
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     The mesh has no positions, or the dual is not a triangulation, for example because a
    ///     cell is no disc or two cells share several borders. The message names the cells. More
    ///     sources there help.
    ///
    /// Examples
    /// --------
    /// >>> import geodesics as gd
    /// >>> mesh = gd.generate("sphere,subdiv=3")
    /// >>> mesh.voronoi(range(0, 640, 10)).dual().n_vertices
    /// 64
    fn dual(&self, py: Python<'_>) -> PyResult<PyMesh> {
        let positions = self.diagram.mesh().positions();
        if positions.is_empty() {
            return Err(PyValueError::new_err("the mesh has no positions"));
        }
        let corners = self
            .surface
            .sources
            .iter()
            .map(|v| positions[v.index()])
            .collect();
        let soup = self.diagram.dual().triangulation(corners);
        let soup = soup.map_err(|error| PyValueError::new_err(error.to_string()))?;
        PyMesh::new(py, soup, "dual".to_owned(), "the dual", false)
    }

    fn __len__(&self) -> usize {
        self.surface.sources.len()
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(self.cells().into_pyobject(py)?.try_iter()?.into_any())
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
    ) -> PyResult<(Bound<'py, PyAny>, (Py<PyMesh>, Vec<PyPoint>))> {
        let sources = self.surface.specs.iter().copied().map(PyPoint).collect();
        let mesh = self.surface.of_python.clone_ref(py);
        Ok((core(py)?.getattr("_voronoi")?, (mesh, sources)))
    }

    fn __repr__(&self) -> String {
        format!(
            "<geodesics.Voronoi: {}, {}>",
            counted(self.surface.sources.len(), "cell"),
            counted(self.diagram.arcs().len(), "arc")
        )
    }
}
