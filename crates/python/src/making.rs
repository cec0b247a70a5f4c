//! Meshes from files and from generators, and pickled ones.

use std::path::PathBuf;

use geobench_harness::exec::expected::stem;
use geodesics::io::ReadOptions;
use geodesics::mesh::FaceId;
use geodesics::{Mesh, Stop, TriangleSoup, VertexId, generate};
use numpy::PyArray2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays;
use crate::errors::{invalid, unreadable};
use crate::from_arrays::weld_of;
use crate::interrupt;
use crate::mesh::PyMesh;
use crate::path::tuples;
use crate::points::SharedMesh;

/// The state of a pickled mesh: the positions, the triangles of the file, the copies of welded
/// vertices, the number of vertices and the lengths of a mesh without positions, the name and the
/// defects.
pub(crate) type MeshState = (
    Py<PyArray2<f64>>,
    Py<PyArray2<u32>>,
    Vec<[u32; 2]>,
    Option<(usize, Vec<[f64; 3]>)>,
    String,
    Vec<String>,
);

impl PyMesh {
    /// The arguments of [`_mesh`] for this mesh.
    pub(crate) fn state(&self, py: Python<'_>) -> PyResult<MeshState> {
        let mesh = self.mesh();
        let copies = mesh.copies().map(|copy| copy.map(VertexId::raw)).collect();
        let length_of = |f: FaceId| mesh.side_lengths(f);
        let lengths = mesh
            .positions()
            .is_empty()
            .then(|| (mesh.vertex_count(), mesh.faces().map(length_of).collect()));
        let corners = |face| mesh.face_vertices(face).map(VertexId::raw);
        let triangles = if lengths.is_some() {
            mesh.faces().map(corners).collect()
        } else {
            mesh.file_triangles()
        };
        Ok((
            tuples(py, mesh.positions())?,
            tuples(py, &triangles)?,
            copies,
            lengths,
            self.name.clone(),
            self.defects.clone(),
        ))
    }
}

/// A pickled mesh, made anew from its [state](MeshState).
#[pyfunction]
pub(crate) fn _mesh(
    py: Python<'_>,
    positions: &Bound<'_, PyAny>,
    triangles: &Bound<'_, PyAny>,
    copies: Vec<[u32; 2]>,
    lengths: Option<(usize, Vec<[f64; 3]>)>,
    name: String,
    defects: Vec<String>,
) -> PyResult<PyMesh> {
    let triangles = arrays::triangles(triangles, "triangles")?;
    let made = if let Some((n, lengths)) = lengths {
        interrupt::call(py, triangles.len(), &Stop::default(), move || {
            Mesh::from_lengths(n, &triangles, &lengths)
        })
    } else {
        let soup = TriangleSoup {
            copies,
            ..TriangleSoup::new(arrays::positions(positions, "positions")?, triangles)
        };
        interrupt::call(py, soup.triangles.len(), &Stop::default(), move || {
            Mesh::from_soup(soup)
        })
    };
    let (mesh, _) = made?.map_err(|error| invalid(py, &error, ""))?;
    Ok(PyMesh {
        surface: SharedMesh::new(mesh),
        name,
        defects,
    })
}

/// Reads a mesh from a file in OBJ, PLY, OFF, STL, VTK (`.vtk`, `.vtp`, `.vtu`), glTF, 3MF,
/// COLLADA, GIFTI or FreeSurfer format, with or without gzip compression. `weld` is that of `Mesh`,
/// with its warning; STL files have no vertex numbers, so that their coincident vertices always are
/// one.
///
/// Raises
/// ------
/// OSError
///     The file cannot be read.
/// MeshError
///     The file holds no usable mesh. The message names the line or the elements.
///
/// Examples
/// --------
/// >>> import geodesics as gd
/// >>> import tempfile, pathlib
/// >>> with tempfile.TemporaryDirectory() as folder:
/// ...     path = pathlib.Path(folder, "cube.obj")
/// ...     gd.generate("cube,n=2").write(path)
/// ...     gd.read(path)
/// <geodesics.Mesh "cube": 26 vertices, 48 faces>
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
    let file = path.clone();
    let soup = interrupt::long(py, &Stop::default(), move || options.read(&file))?
        .map_err(|error| unreadable(py, &error))?;
    let place = path.display().to_string();
    PyMesh::new(py, soup, stem(&path), &place, weld.is_none())
}

/// Generates a mesh from a description: a family, and its keys with their values. The same
/// description gives the same mesh on every machine.
///
/// ==================================== =====================================================
/// family                               keys, with defaults
/// ==================================== =====================================================
/// grid                                 n, nx=40, ny=40, diagonal=one|alternating, jitter=0
/// holes                                holes=4, width=6, height=3, wall=5, diagonal, jitter=0
/// strip                                n=3000, aspect=100
/// corridor                             levels=8, holes=0
/// terrain                              n=50, roughness=0.6, height=0.3
/// tetrahedron                          subdiv=5
/// octahedron, icosahedron, sphere      subdiv=4
/// cube                                 n=20, side=1
/// box                                  a=3, b=2, c=1, n, nx=30, ny=20, nz=10
/// uvsphere                             slices=64, stacks=32
/// cylinder                             slices=64, stacks=24, height=2, ends=open|capped
/// cone                                 angle=180, slices=48, stacks=32, ends
/// torus                                faces=5000, r=0.4, bump=0
/// knot                                 faces=6000, r=0.4
/// anisotropic                          g=4, faces=5000
/// file                                 path
/// ==================================== =====================================================
///
/// All take `parts=K` (every edge in K parts), `subdivide=N` (each face in four, N times),
/// `noise=X` (along the normals, in mean edge lengths), `scale=X` and `seed=N`.
///
/// Parameters
/// ----------
/// spec : str
///
/// Returns
/// -------
/// Mesh
///
/// Examples
/// --------
/// >>> import geodesics as gd
/// >>> gd.generate("sphere,subdiv=2")
/// <geodesics.Mesh "sphere,subdiv=2": 162 vertices, 320 faces>
#[pyfunction]
#[pyo3(name = "generate")]
pub(crate) fn generated(py: Python<'_>, spec: &str) -> PyResult<PyMesh> {
    let wrong = |error: generate::GenerateError| PyValueError::new_err(format!("spec: {error}"));
    let parsed: generate::Spec = spec.parse().map_err(wrong)?;
    let soup = interrupt::long(py, &Stop::default(), move || generate::generate(&parsed))?;
    let soup = soup.map_err(wrong)?;
    let name = spec.strip_prefix("gen:").unwrap_or(spec);
    PyMesh::new(py, soup, name.to_owned(), spec, false)
}
