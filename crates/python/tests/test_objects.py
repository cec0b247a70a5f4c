"""Pickling, copies, weak references, representations, iteration, meshes of other packages."""

import copy
import multiprocessing
import pickle
import re
import warnings
import weakref

import numpy as np
import pytest

import geodesics as gd

POINT = gd.face(3, 0.2, 0.3, 0.5)
V = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])


def objects(torus):
    return [
        torus,
        POINT,
        gd.at(1, 2, 3, far=True),
        gd.Solver(torus, "fwp-mmp{kmax=50}", simd="scalar"),
        torus.field([POINT, 7]),
        torus.path(POINT, 17),
        torus.voronoi([POINT, 900]),
        gd.certify(torus, 0, torus.distance(0) * 2),
    ]


def test_objects_are_pickled_copied_and_referenced(torus):
    for thing in objects(torus):
        again = pickle.loads(pickle.dumps(thing))
        assert repr(again) == repr(thing) and type(again) is type(thing)
        assert repr(copy.copy(thing)) == repr(copy.deepcopy(thing)) == repr(thing)
        assert weakref.ref(thing)() is thing
    again = pickle.loads(pickle.dumps(torus))
    assert (again.vertices == torus.vertices).all() and (again.faces == torus.faces).all()
    assert (again.distance(0) == torus.distance(0)).all()


def test_pickled_meshes_keep_their_numbers():
    # Copies of vertices, and a face that is left out.
    twice = gd.Mesh(V[[0, 1, 2, 0, 2, 3]], [[0, 1, 1], [0, 1, 2], [3, 4, 5]], weld=True)
    lengths = gd.Mesh.from_lengths(3, [[0, 1, 2]], [[3, 4, 5]])
    for mesh in (twice, lengths):
        again = pickle.loads(pickle.dumps(mesh))
        assert (again.distance(0) == mesh.distance(0)).all()
        assert again.defects == mesh.defects and again.name == mesh.name
    point = gd.face(2, 0.2, 0.3, 0.5)
    assert pickle.loads(pickle.dumps(twice)).locate(point) == twice.locate(point)


def work(solver):
    return solver.distance(POINT).max()


def test_spawned_processes_and_joblib(torus):
    solver = gd.Solver(torus)
    expected = work(solver)
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.map(work, [solver]) == [expected]
    joblib = pytest.importorskip("joblib")
    assert joblib.Parallel(n_jobs=2)(joblib.delayed(work)(solver) for _ in range(2)) == [expected] * 2


def test_iteration_and_arrays(torus):
    path = torus.path(0, 17)
    assert (np.asarray(path) == path.points).all() and len(list(path)) == len(path)
    assert np.asarray(path, dtype=np.float32).dtype == np.float32
    diagram = torus.voronoi([3, 900])
    assert len(diagram) == 2 and [cell.source for cell in diagram] == [0, 1]
    (isoline,) = torus.isolines(0, levels=[0.3])
    assert len(isoline) == len(list(isoline)) == len(isoline.lines)
    assert isoline.lines[0].faces.dtype == np.int64
    assert torus.faces.dtype == np.int64
    names = torus.voronoi([3, 900, 1200, 40]).vertices
    assert names and repr(names[0]).startswith("<geodesics.VoronoiVertex of cells [")


def test_results_have_names(torus):
    solver = gd.Solver(torus, "mmp")
    assert solver.count(0).counters["propagated"] > 0
    assert set(solver.profile(0).seconds) == {"propagation", "pruning", "management"}
    failure = gd.certify(torus, 0, torus.distance(0) * 2).failures[0]
    assert (failure.kind, failure.number >= 0) == ("vertex", True) and failure.amount > 0


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda m: m.remesh(-1), "sites: -1, but at least 1"),
        (lambda m: m.remesh(10, lloyd=-2), "lloyd: -2"),
        (lambda m: m.distances([0], threads=-1), "threads: -1"),
        (lambda m: gd.Mesh.from_lengths(-1, [[0, 1, 2]], [[3, 4, 5]]), "n: -1"),
        (lambda m: m.voronoi([3, 900]).arcs[0].points(-3), "parts: -3"),
        (lambda m: gd.run("mmp", m, repeat=-1), "repeat: -1"),
        (lambda m: gd.run("mmp", m, warmup=-1), "warmup: -1"),
        (lambda m: gd.certify(m, 0, threads=-1), "threads: -1"),
    ],
)
def test_negative_counts_name_the_argument(torus, call, text):
    with pytest.raises(ValueError, match=re.escape(text)):
        call(torus)


def test_one_is_no_plural():
    mesh = gd.Mesh(V[:3], [[0, 1, 2]])
    assert repr(mesh).endswith(": 3 vertices, 1 face>")
    assert repr(mesh.voronoi([0])).startswith("<geodesics.Voronoi: 1 cell, ")


def test_a_seed_is_that_of_a_generator():
    sphere = gd.generate("sphere,subdiv=3")
    of_seed, of_generator = (
        sphere.remesh(50, lloyd=1, rng=rng).vertices for rng in (1, np.random.default_rng(1))
    )
    np.testing.assert_array_equal(of_seed, of_generator)


def test_rng(torus):
    sphere = gd.generate("sphere,subdiv=3")
    same = [sphere.remesh(50, lloyd=1, rng=rng).vertices for rng in (7, 7, np.random.default_rng(1))]
    assert (same[0] == same[1]).all() and same[2].shape[1] == 3
    with pytest.raises(TypeError, match="rng: "):
        sphere.remesh(50, rng="seven")


def test_masked_arrays_are_refused():
    masked = np.ma.masked_array(V, mask=V > 0)
    with pytest.raises(TypeError, match="vertices: a masked array"):
        gd.Mesh(masked, [[0, 1, 2]])


def test_vertices_at_one_place_are_told():
    seam, faces = V[[0, 1, 2, 0, 2, 3]], [[0, 1, 2], [3, 4, 5]]
    with pytest.warns(UserWarning, match="vertices: .*weld=True"):
        gd.Mesh(seam, faces)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        gd.Mesh(seam, faces, weld=False)
        gd.Mesh(seam, faces, weld=True)


def test_repairs_may_be_refused():
    with pytest.raises(gd.MeshError, match="repair is needed") as caught:
        gd.Mesh(V, [[0, 1, 2], [0, 3, 2]], repair=False)
    assert "turned" in caught.value.defects[0]
    assert gd.Mesh(V, [[0, 1, 2], [0, 2, 3]], repair=False).n_faces == 2
    for faces in (
        [[0, 1, 2], [0, 2, 3], [0, 1, 1]],
        [[0, 1, 2, 3], [0, 1, 1, 1]],
        [[0, 1, 2, 2], [0, 2, 3]],
        [[0, 1, 2, 0], [0, 2, 3]],
        [[0, 1, 2, 3], [0, 1]],
        [[0, 1, 2], [0, 2, 3], [2, 1, 0]],
    ):
        with pytest.raises(gd.MeshError, match="repair is needed: .*face "):
            gd.Mesh(V, faces, repair=False)
        assert gd.Mesh(V, faces).n_faces == 2
    with pytest.raises(gd.MeshError, match="repair is needed"):
        gd.Mesh(np.vstack([V, V[:1]]), [[0, 1, 2], [0, 2, 3], [0, 4, 1]], weld=True, repair=False)


def test_polygons(torus):
    pentagon = np.array([[0.0, 0, 0], [1, 0, 0], [1.5, 1, 0], [0.5, 2, 0], [-0.5, 1, 0]])
    assert gd.Mesh(pentagon, [[0, 1, 2, 3, 4]]).n_faces == 3
    assert gd.Mesh(V, np.array([[0, 1, 2, 3]])).n_faces == 2
    mixed = np.vstack([V, [[2, 0, 0]]])
    assert gd.Mesh(mixed, [[0, 1, 2, 3], [1, 4, 2]]).n_faces == 3
    with pytest.raises(gd.MeshError, match="face 0 names vertex -1"):
        gd.Mesh(V, [[0, 1, 2, -1]])


def test_meshes_of_other_packages(torus):
    expected = torus.distance(0)
    meshio = pytest.importorskip("meshio")
    given = meshio.Mesh(torus.vertices, [("triangle", torus.faces)])
    np.testing.assert_array_equal(gd.Mesh(given).distance(0), expected)
    trimesh = pytest.importorskip("trimesh")
    given = trimesh.Trimesh(torus.vertices, torus.faces, process=False)
    np.testing.assert_array_equal(gd.Mesh(given).distance(0), expected)
    pyvista = pytest.importorskip("pyvista")
    given = pyvista.PolyData.from_regular_faces(torus.vertices, torus.faces)
    np.testing.assert_allclose(gd.Mesh(given).distance(0), expected, rtol=1e-12)
    with pytest.raises(TypeError, match="faces: missing"):
        gd.Mesh(V)


def test_generators_are_documented():
    for family in ("torus", "terrain", "uvsphere", "anisotropic", "parts=K"):
        assert family in gd.generate.__doc__


def test_algorithms_are_in_the_stubs():
    from pathlib import Path

    text = (Path(gd.__file__).parent / "_core.pyi").read_text()
    listed = re.search(r"Literal\[\n(.*?)\n    \],", text, re.DOTALL).group(1)
    names = re.findall(r'"(.*?)"', listed)
    assert sorted(names) == sorted(row["name"] for row in gd.algorithms())

