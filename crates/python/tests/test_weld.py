"""Vertices at one place."""

import warnings

import numpy as np
import pytest

import geodesics as gd

# A unit square as two triangles that share no vertex. Vertex 3 lies at 0, and 4 at 2.
VERTICES = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float
)
FACES = np.array([[0, 1, 2], [3, 4, 5]])
EXPECTED = [1, 0, 1, 1, 1, 2**0.5]


def test_copies_have_the_distance_of_the_first():
    apart = gd.Mesh(VERTICES, FACES, weld=False)
    assert np.isinf(apart.distance(1)[3:]).all()
    assert any("lie at the place of another" in defect for defect in apart.defects)
    for weld in [True, 0, 1e-6]:
        mesh = gd.Mesh(VERTICES, FACES, weld=weld)
        np.testing.assert_allclose(mesh.distance(1), EXPECTED, rtol=1e-12)
        np.testing.assert_array_equal(mesh.distance(4), mesh.distance(2))
        assert mesh.path(1, 5).length == pytest.approx(2**0.5)
        labels = mesh.voronoi([1, 5]).labels
        assert labels[3] == labels[0] and labels[4] == labels[2]
    assert np.isinf(gd.Mesh(VERTICES, FACES, weld=False).distance(1)[5])


def test_a_tolerance_is_a_fraction_of_the_size(tmp_path):
    moved = VERTICES + np.array([[0, 0, 0]] * 3 + [[0, 0, 1e-7]] * 3)
    assert np.isinf(gd.Mesh(moved, FACES, weld=True).distance(1)[5])
    np.testing.assert_allclose(gd.Mesh(moved, FACES, weld=1e-6).distance(1), EXPECTED)
    for wrong in [-1, 0.5, float("nan")]:
        with pytest.raises(ValueError, match="weld"):
            gd.Mesh(moved, FACES, weld=wrong)
    path = tmp_path / "moved.obj"
    with pytest.warns(UserWarning, match="vertices: .*; weld=1e-[67] makes them one"):
        gd.Mesh(moved, FACES).write(path)
    with pytest.warns(UserWarning, match="moved.obj: .*; weld=1e-[67] makes them one"):
        gd.read(path)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert np.isinf(gd.read(path, weld=False).distance(1)[5])
        np.testing.assert_allclose(gd.read(path, weld=1e-6).distance(1), EXPECTED)


def test_numbers_of_faces_are_those_of_the_array():
    faces = [[0, 1, 2], [1, 1, 2], [1, 2, 0], [0, 2, 5]]
    mesh = gd.Mesh(VERTICES, faces)
    assert mesh.n_faces == 2
    np.testing.assert_array_equal(mesh.faces, faces)
    inside = mesh.distance(gd.face(2, 0.2, 0.3, 0.5))
    np.testing.assert_array_equal(inside, mesh.distance(gd.face(0, 0.5, 0.2, 0.3)))
    assert mesh.locate(gd.face(3, 0.2, 0.3, 0.5))[0] == 3


def test_the_coordinates_of_paths_are_those_of_the_faces_that_are_given():
    # The first face is left out, and one of the others is turned over.
    faces = [[1, 1, 2], [0, 1, 2], [0, 3, 2]]
    positions = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    for given in (faces, [[1, 1, 2], [0, 1, 2], [0, 2, 3]], [[0, 1, 2], [2, 1, 0], [0, 3, 2]]):
        mesh = gd.Mesh(positions, given)
        np.testing.assert_array_equal(mesh.faces, given)
        path = mesh.path(gd.at(0.7, 0.2, 0), gd.at(0.1, 0.8, 0))
        corners = mesh.vertices[mesh.faces[path.faces]]
        np.testing.assert_allclose(
            np.einsum("ki,kij->kj", path.barycentric, corners), path.points, atol=1e-15
        )
