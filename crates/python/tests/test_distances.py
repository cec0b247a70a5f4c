"""Distances: shapes, options, and agreement with other programs."""

import numpy as np
import potpourri3d as pp3d
import pygeodesic.geodesic
import pytest

import geodesics as gd
from conftest import model

GENERATED = [
    "torus,faces=3000,bump=0.1,seed=7",
    "sphere,subdiv=4",
    "knot,faces=2000",
    "holes",
    "anisotropic,faces=2000,g=4",
]


def same(a, b, tolerance=1e-9):
    np.testing.assert_allclose(a, b, rtol=tolerance, atol=0)


@pytest.mark.parametrize("spec", GENERATED)
def test_distances_are_those_of_pygeodesic(spec):
    check_with_pygeodesic(gd.generate(spec))


@pytest.mark.parametrize("spec", ["torus,faces=3000,bump=0.1,seed=7", "sphere,subdiv=4", "terrain,n=24,seed=1"])
@pytest.mark.parametrize("t", [0.5, 1.0, 4.0])
def test_heat_is_that_of_potpourri3d(spec, t):
    """Both use the edges of the mesh and Neumann boundary conditions, and add 1e-6 to the Laplace matrix."""
    mesh = gd.generate(spec)
    solver = gd.Solver(mesh, f"heat{{t={t},boundary=neumann,shift=1e-6,delaunay=off}}")
    other = pp3d.MeshHeatMethodDistanceSolver(
        mesh.vertices, mesh.faces.astype(np.int64), t_coef=t, use_robust=False
    )
    assert not solver.exact
    for source in [0, 17]:
        expected = np.maximum(other.compute_distance(source), 0)
        found = solver.distance(source)
        np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-9 * expected.max())


@pytest.mark.parametrize("name", ["suzanne.obj", "spot.obj"])
def test_distances_of_shared_models_are_those_of_pygeodesic(name):
    check_with_pygeodesic(gd.read(model(name)))


def check_with_pygeodesic(mesh):
    other = pygeodesic.geodesic.PyGeodesicAlgorithmExact(
        mesh.vertices, mesh.faces.astype(np.int32)
    )
    source = mesh.n_vertices // 2
    expected, _ = other.geodesicDistances(np.array([source]), None)
    expected[np.isinf(expected) | (expected > 1e90)] = np.inf
    assert not mesh.wrong_distances(mesh.distance(source), expected).size


def test_distances_beyond_the_tolerance_are_wrong():
    square = gd.Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    right = np.array([0, 1, 2**0.5, 1])
    off = right + [1e-13, -9e-10, 2e-9, 0]
    assert square.wrong_distances(right, right).tolist() == []
    assert square.wrong_distances(off, right).tolist() == [2]
    assert square.wrong_distances(off, right, tolerance=1e-10).tolist() == [1, 2]
    off[1] = np.inf
    assert square.wrong_distances(off, right).tolist() == [1, 2]
    with pytest.raises(ValueError, match="found: the shape is"):
        square.wrong_distances(right[:3], right)


@pytest.mark.parametrize("spec", ["torus,faces=3000,bump=0.1,seed=7", "sphere,subdiv=4"])
def test_the_heat_method_is_near(spec):
    mesh = gd.generate(spec)
    d = mesh.distance(0)
    heat = pp3d.MeshHeatMethodDistanceSolver(mesh.vertices, mesh.faces.astype(np.int64))
    error = np.abs(heat.compute_distance(0) - d) / d.max()
    # The heat method is approximate: its mean error is up to 3 % of the greatest distance.
    assert 1e-4 < error.mean() < 0.03, error.mean()


def test_shapes_and_types(torus):
    n = torus.n_vertices
    d = torus.distance(0)
    assert d.shape == (n,) and d.dtype == np.float64 and d[0] == 0
    D = torus.distances([0, 5, 9], threads=2)
    assert D.shape == (3, n) and D.flags.c_contiguous
    same(D[0], d, 0)
    same(torus.distance([0, 5]), np.minimum(D[0], D[1]), 1e-12)
    same(torus.distance(np.array([0, 5])), torus.distance([0, np.int32(5)]), 0)
    assert torus.distances(7).shape == (1, n)


def test_unreachable_is_infinite(square):
    assert square.distance(0).tolist()[4] == np.inf
    assert square.distance(4).tolist() == [np.inf] * 4 + [0]


def test_radius_and_targets_end_early(torus):
    full = torus.distance(3)
    near = torus.distance(3, radius=1.0)
    same(near[full <= 1.0], full[full <= 1.0], 0)
    assert np.isinf(near[full > 1.0]).all() and np.isinf(near).any()
    targets = [7, 700, 3]
    same(torus.distance(3, targets=targets), full[targets], 0)
    assert torus.distances([3, 4], targets=targets, radius=1e-9).tolist() == [
        [np.inf, np.inf, 0.0],
        [np.inf, np.inf, np.inf],
    ]


def test_points_anywhere(square):
    d = square.distance(gd.edge(0, 1, 0.25))
    same(d[:4], [0.25, 0.75, np.hypot(0.75, 1), np.hypot(0.25, 1)], 1e-14)
    d = square.distance(gd.face(0, 0.5, 0.25, 0.25))
    same(d[:3], [np.hypot(0.5, 0.25), np.hypot(0.5, 0.25), np.hypot(0.5, 0.75)], 1e-14)
    same(square.distance(gd.at(0, 0.5, 2, far=True))[0], 0.5, 1e-14)
    same(square.distance(0, targets=[gd.edge(1, 2, 0.5), gd.vertex(2)]), [1.25**0.5, 2**0.5], 1e-14)
    rows = square.distances([gd.at(0.2, 0.1, 0), 1])
    same(rows[1], square.distance(1), 1e-14)


def test_solvers_keep_their_set_up(torus):
    expected = torus.distance(5)
    for name in ["vtp-fast", "vtp", "mmp", "ich", "fwp-mmp{kmax=5000}", "vtp-mmp"]:
        solver = gd.Solver(torus, name)
        for _ in range(2):
            same(solver.distance(5), expected, 1e-12)
        assert solver.exact and solver.mesh is torus
    parallel = gd.Solver(torus, "pvtp", threads=2)
    same(parallel.distance(5), expected, 1e-12)
    same(parallel.distances([5, 6], threads=2)[0], expected, 1e-12)


def test_the_example_of_the_page(torus):
    solver = gd.Solver(torus, "vtp-fast")
    source = gd.face(12, 0.2, 0.3, 0.5)
    d = solver.distance(source, radius=1.5, targets=[0, 1, 2])
    assert d.shape == (3,)
    same(d, torus.distance(source)[:3], 1e-12)


def test_every_exact_algorithm_agrees(torus):
    mesh = gd.generate("terrain,n=12,seed=3")
    expected = mesh.distance(7)
    for algorithm in gd.algorithms():
        if algorithm["exact"]:
            same(mesh.distance(7, algorithm=algorithm["name"]), expected, 1e-10)


def test_counts_and_profiles(torus):
    solver = gd.Solver(torus, "vtp")
    d, counters = solver.count(0)
    same(d, solver.distance(0), 0)
    assert counters["propagated"] > torus.n_faces
    d, seconds = solver.profile(0)
    same(d, solver.distance(0), 0)
    assert set(seconds) == {"propagation", "pruning", "management"}


def test_solvers_are_used_from_several_threads(torus):
    from concurrent.futures import ThreadPoolExecutor

    solver = gd.Solver(torus)
    expected = [solver.distance(v) for v in range(8)]
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(solver.distance, range(8)))
    for a, b in zip(expected, found):
        same(a, b, 0)


def test_arrays_of_every_layout():
    mesh = gd.generate("sphere,subdiv=1")
    V, F = mesh.vertices, mesh.faces
    expected = mesh.distance(0)
    wide = np.zeros((len(V), 6))
    wide[:, ::2] = V
    layouts = [
        (np.asfortranarray(V), F.astype(np.int64)),
        (wide[:, ::2], F.astype(np.int32)[::-1][::-1]),
        (V.astype(">f8"), F.astype(np.uint64)),
        (V.tolist(), F.tolist()),
        (V, F.astype(np.int16)),
    ]
    for vertices, faces in layouts:
        same(gd.Mesh(vertices, faces).distance(0), expected, 0)
    single = gd.Mesh(V.astype(np.float32), F).vertices
    assert (single == V.astype(np.float32)).all()


def test_arrays_are_copied_once_and_not_shared():
    V = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    mesh = gd.Mesh(V, [[0, 1, 2]])
    V[1, 0] = 7
    assert mesh.vertices[1, 0] == 1
    d = mesh.distance(0)
    d[1] = 9
    assert mesh.distance(0)[1] == 1


def test_lengths_alone_make_a_surface():
    mesh = gd.Mesh.from_lengths(3, [[0, 1, 2]], [[3.0, 5.0, 4.0]])
    assert mesh.distance(0).tolist() == [0, 3, 4]
    assert mesh.vertices.shape == (0, 3)
    with pytest.raises(gd.MeshError, match="face 0"):
        gd.Mesh.from_lengths(3, [[0, 1, 2]], [[3.0, 9.0, 4.0]])


def test_where_points_are(square):
    face, barycentric, position, distance = square.locate(gd.at(0.75, 0.25, 2, far=True))
    assert (face, position, distance) == (0, (0.75, 0.25, 0.0), 2.0)
    same(barycentric, [0.25, 0.5, 0.25], 1e-14)
    assert square.nearest_vertex(0.9, 0.2, 1) == 1
    assert square.info()["components"] == 1 and square.info()["boundary_edges"] == 4


def test_a_source_named_twice_is_one_source(tmp_path):
    mesh = gd.generate("grid,n=4")
    point = gd.face(3, 0.25, 0.25, 0.5)
    for ask in [
        lambda sources: mesh.distance(sources),
        lambda sources: mesh.path(sources, 20).length,
        lambda sources: mesh.isolines(sources, levels=[0.5])[0].length,
        lambda sources: mesh.voronoi(sources).distances,
        lambda sources: len(gd.run("vtp", mesh, sources=sources, sources_together=True, repeat=1)),
    ]:
        once = ask([1, 7, point])
        with pytest.warns(UserWarning, match="source vertex 1 is named twice and counts once"):
            twice = ask([1, 7, point, 1])
        np.testing.assert_array_equal(once, twice)
        with pytest.warns(UserWarning, match="face:3,0.25,0.25,0.5 is named twice"):
            ask([1, point, point])
    # One row for each source.
    assert mesh.distances([1, 1]).shape == (2, 25)
