"""Files of the command line, read by other programs, and files of theirs."""

import json

import meshio
import nibabel
import numpy as np
import pymeshlab
import pytest
import pyvista
import trimesh
import vtk
from vtk.util.numpy_support import vtk_to_numpy

import geodesics as gd

MODEL = "gen:holes"


@pytest.fixture(scope="module", params=["reachable", "unreachable"])
def field(request, command, tmp_path_factory):
    """A distance field in every file format, with or without an unreachable vertex."""
    folder = tmp_path_factory.mktemp("files")
    model = MODEL
    if request.param == "unreachable":
        model = "two.obj"
        (folder / model).write_text("v 0 0 0\nv 3 0 0\nv 0 4 0\nv 9 9 9\nf 1 2 3\n")
    for ending in ["vtp", "vtk", "ply", "npy", "csv"]:
        command("distance", model, "--source", "0", "-o", f"d.{ending}", cwd=folder)
    mesh = gd.generate(model) if model == MODEL else gd.read(folder / model)
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


def test_vtp_in_pyvista(field):
    folder, mesh, d = field
    read = pyvista.read(folder / "d.vtp")
    assert isinstance(read, pyvista.PolyData)
    np.testing.assert_array_equal(read.points, mesh.vertices)
    np.testing.assert_array_equal(read.regular_faces, mesh.faces)
    np.testing.assert_array_equal(read["distance"], d)
    np.testing.assert_array_equal(read["reached"], np.isfinite(d))


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
    again = gd.read(path)
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
    mesh = gd.Mesh(source.points, triangles)
    source["distance"] = mesh.distance(0)
    assert mesh.n_faces == source.n_cells
    np.testing.assert_array_equal(gd.Mesh(source).faces, triangles)
    grid = gd.Mesh(source.cast_to_unstructured_grid())
    np.testing.assert_array_equal(grid.faces, triangles)


def test_curved_cells_of_meshio_have_corners_alone():
    corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    middles = [[0.5, 0, 0], [1, 0.5, 0], [0.5, 0.5, 0], [0.5, 1, 0], [0, 0.5, 0]]
    points = np.array(corners + middles)
    cells = [("triangle6", np.array([[0, 1, 2, 4, 5, 6], [0, 2, 3, 6, 7, 8]]))]
    mesh = gd.Mesh(meshio.Mesh(points, cells))
    np.testing.assert_array_equal(mesh.faces, [[0, 1, 2], [0, 2, 3]])
    mesh = gd.Mesh(meshio.Mesh(points, [("quad8", np.array([[0, 1, 2, 3, 4, 5, 7, 8]]))]))
    assert mesh.n_faces == 2
    assert mesh.distance(0)[2] == pytest.approx(2**0.5)


SPHERE = "gen:sphere,subdiv=3"

# Commands that write lines, and an array that their lines have.
LINES = {
    "path": (["path", SPHERE, "--source", "0", "--target", "7,300,500"], "length"),
    "isolines": (["isolines", SPHERE, "--source", "0", "--levels", "0.5,1,1.5"], "distance"),
    "borders": (["voronoi", SPHERE, "--source", "0,7,300", "-o", "v.json"], "left"),
}


@pytest.fixture(scope="module", params=LINES)
def lines(request, command, tmp_path_factory):
    """Lines in every format of lines, and the name of an array of theirs."""
    folder = tmp_path_factory.mktemp("lines")
    arguments, array = LINES[request.param]
    option = "--borders" if request.param == "borders" else "-o"
    for ending in ["vtp", "vtk", "obj", "ply"]:
        command(*arguments, option, f"l.{ending}", cwd=folder)
    return folder, array


def vtk_read(reader, path):
    """The output of a reader of VTK, of which ParaView's are made."""
    reader.SetFileName(str(path))
    reader.Update()
    assert reader.GetErrorCode() == 0
    return reader.GetOutput()


def segments_of(poly):
    """The segments of the lines of a vtkPolyData, and the line of each."""
    ends = vtk_to_numpy(poly.GetLines().GetOffsetsArray())
    points = vtk_to_numpy(poly.GetLines().GetConnectivityArray())
    pairs = [(a, b) for i, j in zip(ends, ends[1:]) for a, b in zip(points[i:j], points[i + 1 : j])]
    return np.array(pairs), np.repeat(np.arange(len(ends) - 1), np.diff(ends) - 1)


def test_lines_open_alike(lines):
    folder, array = lines
    poly = vtk_read(vtk.vtkXMLPolyDataReader(), folder / "l.vtp")
    points = vtk_to_numpy(poly.GetPoints().GetData())
    segments, line = segments_of(poly)
    values = vtk_to_numpy(poly.GetCellData().GetArray(array))
    assert len(segments) > 3 and len(set(line)) >= 3 and len(values) == poly.GetNumberOfLines()

    same = pyvista.read(folder / "l.vtp")
    assert same.n_lines == poly.GetNumberOfLines()
    np.testing.assert_array_equal(same[array], values)

    grid = vtk_read(vtk.vtkUnstructuredGridReader(), folder / "l.vtk")
    assert grid.GetNumberOfCells() == len(segments)
    read = meshio.read(folder / "l.vtk")
    for grid in [pyvista.read(folder / "l.vtk"), pyvista.from_meshio(read)]:
        np.testing.assert_array_equal(grid.points, points)
        np.testing.assert_array_equal(grid.cells_dict[pyvista.CellType.LINE], segments)
        np.testing.assert_array_equal(np.ravel(grid["line"]), line)
        np.testing.assert_array_equal(np.ravel(grid[array]), values[line])

    drawn = pyvista.read(folder / "l.obj")
    assert drawn.n_lines == len(segments)
    assert len(meshio.read(folder / "l.obj").points) == len(points)
    for ending in ["obj", "ply"]:
        meshes = pymeshlab.MeshSet()
        meshes.load_new_mesh(str(folder / f"l.{ending}"))
        assert meshes.current_mesh().edge_number() == len(segments)


def test_cut_surfaces_have_the_numbers_of_cells(command, tmp_path):
    for ending in ["vtp", "ply", "json"]:
        command("voronoi", SPHERE, "--source", "0,7,300", "-o", f"v.{ending}", cwd=tmp_path)
    surface = pyvista.read(tmp_path / "v.vtp")
    sizes = surface.compute_cell_sizes()
    area = [sizes["Area"][surface["cell"] == cell].sum() for cell in range(3)]
    cells = json.loads((tmp_path / "v.json").read_text())["cells"]
    expected = [cell["area"] for cell in cells]
    # Chords replace the arcs of borders.
    np.testing.assert_allclose(area, expected, rtol=1e-4)
    read = meshio.read(tmp_path / "v.ply")
    np.testing.assert_array_equal(read.points, surface.points)
    of_corners = read.point_data["quality"][read.cells_dict["triangle"]]
    assert (of_corners == surface["cell"][:, None]).mean() > 0.99


def test_surfaces_of_other_programs_are_read(tmp_path):
    sphere = pyvista.Sphere(theta_resolution=12, phi_resolution=9)
    points, faces = np.asarray(sphere.points), sphere.regular_faces
    sphere.save(tmp_path / "a.vtp")
    sphere.save(tmp_path / "b.vtp", binary=False)
    sphere.save(tmp_path / "c.vtk")
    sphere.save(tmp_path / "d.vtk", binary=False)
    sphere.cast_to_unstructured_grid().save(tmp_path / "e.vtu")
    whole = meshio.Mesh(points, [("triangle", faces)])
    whole.write(tmp_path / "f.vtu")
    whole.write(tmp_path / "g.vtk")
    arrays = [
        nibabel.gifti.GiftiDataArray(points.astype("f4"), intent="NIFTI_INTENT_POINTSET"),
        nibabel.gifti.GiftiDataArray(faces.astype("i4"), intent="NIFTI_INTENT_TRIANGLE"),
    ]
    nibabel.save(nibabel.gifti.GiftiImage(darrays=arrays), tmp_path / "lh.h.surf.gii")
    nibabel.freesurfer.write_geometry(tmp_path / "rh.white", points, faces)
    files = sorted(tmp_path.iterdir())
    assert len(files) == 9
    for file in files:
        mesh = gd.read(file)
        # VTK writes six digits as text.
        np.testing.assert_allclose(mesh.vertices, points, atol=1e-6, err_msg=file.name)
        np.testing.assert_array_equal(mesh.faces, faces, err_msg=file.name)


@pytest.mark.parametrize("ending", ["glb", "gltf", "3mf"])
def test_scenes_of_other_programs_are_read(tmp_path, ending):
    box = trimesh.creation.box()
    turned = trimesh.transformations.rotation_matrix(0.5, [1, 2, 3])
    turned[:3, 3] = [4, 5, 6]
    scene = trimesh.Scene()
    scene.add_geometry(box, node_name="a")
    scene.add_geometry(box, node_name="b", transform=turned)
    files = scene.export(file_type=ending)
    if not isinstance(files, dict):
        files = {f"model.{ending}": files}
    for name, content in files.items():
        (tmp_path / name).write_bytes(content)
    mesh = gd.read(tmp_path / f"model.{ending}")
    expected = np.concatenate([box.vertices, trimesh.transform_points(box.vertices, turned)])
    assert mesh.n_faces == 24
    found, wanted = (np.array(sorted(v.round(5).tolist())) for v in [mesh.vertices, expected])
    np.testing.assert_allclose(found, wanted, atol=2e-5)
