"""Files of the command line, read by meshio and PyVista."""

import meshio
import numpy as np
import pytest
import pyvista

import geobench as gb

MODEL = "gen:holes"


@pytest.fixture(scope="module", params=["reachable", "unreachable"])
def field(request, command, tmp_path_factory):
    """A distance field in every file format, with or without an unreachable vertex."""
    folder = tmp_path_factory.mktemp("files")
    model = MODEL
    if request.param == "unreachable":
        model = "two.obj"
        (folder / model).write_text("v 0 0 0\nv 3 0 0\nv 0 4 0\nv 9 9 9\nf 1 2 3\n")
    for ending in ["vtk", "ply", "npy", "csv"]:
        command("distance", model, "--source", "0", "-o", f"d.{ending}", cwd=folder)
    mesh = gb.generate(model) if model == MODEL else gb.read(folder / model)
    d = mesh.distance(0)
    return folder, mesh, d


def test_npy(field):
    folder, _, d = field
    np.testing.assert_array_equal(np.load(folder / "d.npy"), d)


def test_csv(field):
    folder, _, d = field
    rows = np.genfromtxt(folder / "d.csv", delimiter=",", names=True)
    np.testing.assert_array_equal(rows["distance"], d)


def test_vtk_in_meshio(field, tmp_path):
    folder, mesh, d = field
    read = meshio.read(folder / "d.vtk")
    np.testing.assert_array_equal(read.points, mesh.vertices)
    np.testing.assert_array_equal(read.cells_dict["triangle"], mesh.faces)
    np.testing.assert_array_equal(read.point_data["distance"].ravel(), d)
    np.testing.assert_array_equal(read.point_data["reached"].ravel(), np.isfinite(d))
    # A file that meshio writes has the same field.
    read.write(tmp_path / "again.vtu")
    again = meshio.read(tmp_path / "again.vtu")
    np.testing.assert_array_equal(again.point_data["distance"].ravel(), d)


def test_vtk_in_pyvista(field, tmp_path):
    folder, mesh, d = field
    read = pyvista.read(folder / "d.vtk")
    assert isinstance(read, pyvista.UnstructuredGrid)
    np.testing.assert_array_equal(read.points, mesh.vertices)
    np.testing.assert_array_equal(read.cells_dict[pyvista.CellType.TRIANGLE], mesh.faces)
    np.testing.assert_array_equal(read["distance"], d)
    read.save(tmp_path / "again.vtu")
    np.testing.assert_array_equal(pyvista.read(tmp_path / "again.vtu")["distance"], d)


def test_ply_in_meshio(field):
    folder, mesh, d = field
    read = meshio.read(folder / "d.ply")
    np.testing.assert_array_equal(read.points, mesh.vertices)
    np.testing.assert_array_equal(read.cells_dict["triangle"], mesh.faces)
    np.testing.assert_array_equal(read.point_data["quality"], d)


def test_ply_in_pyvista(field):
    folder, mesh, d = field
    # From PLY, VTK reads texture coordinates in single precision and no other scalars.
    read = pyvista.read(folder / "d.ply")
    assert read.n_cells == mesh.n_faces
    np.testing.assert_array_equal(read.active_texture_coordinates[:, 0], d.astype(np.float32))
    whole = pyvista.read_meshio(folder / "d.ply")
    np.testing.assert_array_equal(whole["quality"], d)


@pytest.mark.parametrize("ending", ["obj", "ply", "off", "obj.gz"])
def test_meshes_are_written_and_read(torus, tmp_path, ending):
    path = tmp_path / f"mesh.{ending}"
    torus.write(path)
    again = gb.read(path)
    assert again.name == "mesh"
    np.testing.assert_array_equal(again.vertices, torus.vertices)
    np.testing.assert_array_equal(again.faces, torus.faces)
    if not ending.endswith("gz"):
        np.testing.assert_array_equal(meshio.read(path).points, torus.vertices)
    with pytest.raises(ValueError, match="use .obj, .ply, .off or .stl"):
        torus.write(tmp_path / "mesh.gts")


def test_meshes_of_meshio_and_pyvista():
    source = pyvista.Sphere()
    triangles = source.faces.reshape(-1, 4)[:, 1:]
    mesh = gb.Mesh(source.points, triangles)
    source["distance"] = mesh.distance(0)
    assert mesh.n_faces == source.n_cells
