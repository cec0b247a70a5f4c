"""Points anywhere, in every form, and what is asked for many of them."""

import numpy as np
import pytest

import geodesics as gd

POINT = gd.face(3, 0.2, 0.3, 0.5)


@pytest.mark.parametrize("algorithm", ["vtp-fast", "mmp-fast", "mmp", "vtp", "ich", "pvtp", "fmm"])
def test_points_inside_faces_are_those_of_a_new_solver(torus, algorithm):
    solver = gd.Solver(torus, algorithm)
    before = solver.distance(0)
    targets = [gd.face(900, 0.6, 0.1, 0.3), gd.edge(*map(int, torus.faces[700][:2]), 0.25), 17]
    for source in (POINT, [gd.face(900, 0.1, 0.8, 0.1), 5]):
        found = solver.distance(source, targets=targets)
        np.testing.assert_allclose(found, torus.distance(source, targets=targets), rtol=0.2)
        if solver.exact:
            np.testing.assert_allclose(found, torus.distance(source, targets=targets), rtol=1e-12)
            np.testing.assert_allclose(solver.distance(source), torus.distance(source), rtol=1e-12)
            lengths = [path.length for path in solver.paths(source, targets)]
            np.testing.assert_allclose(lengths, found, rtol=1e-12)
    np.testing.assert_allclose(solver.distance(0), before, rtol=1e-13)


def test_arrays_are_points(torus):
    solver = gd.Solver(torus)
    positions = torus.vertices[[5, 9]]
    expected = solver.distance([5, 9])
    np.testing.assert_array_equal(solver.distance(positions), expected)
    mask = np.zeros(torus.n_vertices, bool)
    mask[[5, 9]] = True
    np.testing.assert_array_equal(solver.distance(mask), expected)
    faces, weights = np.array([3, 40]), np.array([[0.2, 0.3, 0.5], [0.6, 0.2, 0.2]])
    given = solver.distance([gd.face(3, 0.2, 0.3, 0.5), gd.face(40, 0.6, 0.2, 0.2)])
    np.testing.assert_array_equal(solver.distance((faces, weights)), given)
    # Single precision does not sum to 1.
    single = np.float32([[0.1, 0.3, 0.6]])
    assert np.isfinite(solver.distance((faces[:1], single))).all()
    with pytest.raises(ValueError, match="source: a mask has a truth value for each"):
        solver.distance(mask[:-1])
    with pytest.raises(ValueError, match="source: the shape of the faces is"):
        solver.distance((faces, weights[:1]))
    with pytest.raises(ValueError, match="source: NaN is not a coordinate"):
        solver.distance(np.full((1, 3), np.nan))


def test_location_of_arrays(torus):
    found = torus.locate(torus.vertices[:10] * 1.0)
    assert found.face.shape == (10,) and found.face.dtype == np.int64
    np.testing.assert_allclose(found.position, torus.vertices[:10], atol=1e-12)
    one = torus.locate(POINT)
    assert one.face == 3 and one.distance == 0 and tuple(one)[0] == 3
    near = torus.nearest_vertices(torus.vertices + 1e-6)
    assert (near == np.arange(torus.n_vertices)).all()
    assert torus.nearest_vertex(*torus.vertices[7]) == 7
    with pytest.raises(ValueError, match=r"points: the shape is \(3,\), but \(k, 3\) is needed; at\(x"):
        torus.locate(np.array([1.0, 2.0, 3.0]))
    with pytest.raises(ValueError, match="positions: the shape"):
        torus.nearest_vertices([1.0, 2.0, 3.0])
    rng = np.random.default_rng(1)
    for at in rng.normal(size=(20, 3)):
        nearest = np.linalg.norm(torus.vertices - at, axis=1).argmin()
        assert torus.nearest_vertices([at])[0] == nearest


def test_a_distance_matrix_is_symmetric_and_scipy_takes_it(torus):
    scipy = pytest.importorskip("scipy.spatial.distance")
    points = [5, POINT, 900, gd.at(1, 0, 0), 40]
    for threads in (None, 3):
        D = torus.distance_matrix(points, threads=threads)
        assert (D == D.T).all() and (np.diag(D) == 0).all()
        assert scipy.squareform(D).shape == (10,)
        np.testing.assert_allclose(D, torus.distances(points, targets=points), rtol=1e-12)
    np.testing.assert_array_equal(torus.distance_matrix([7]), [[0.0]])


def test_pairs(torus):
    P, Q = [5, 5, POINT, 900], [900, POINT, 3, 5]
    found = torus.pairs(P, Q, threads=2)
    each = [torus.distance(p, targets=q)[0] for p, q in zip(P, Q)]
    np.testing.assert_allclose(found, each, rtol=1e-12)
    with pytest.raises(ValueError, match="targets: 1 point, but 2 sources"):
        torus.pairs([1, 2], [3])


def test_sparse_rows(torus):
    sparse = pytest.importorskip("scipy.sparse")
    rows = torus.distances([5, POINT], radius=0.5, sparse=True, threads=2)
    assert sparse.issparse(rows) and rows.format == "csr"
    full = torus.distances([5, POINT], radius=0.5)
    finite = np.isfinite(full)
    assert rows.nnz == finite.sum() and rows.shape == full.shape
    np.testing.assert_array_equal(rows.toarray(), np.where(finite, full, 0))


@pytest.mark.parametrize("algorithm", ["vtp-fast", "mmp", "ich", "window-vtp", "dijkstra", "fmm"])
def test_the_nearest_source(torus, algorithm):
    sources = [3, 900, POINT]
    solver = gd.Solver(torus, algorithm)
    found = solver.distance(sources, nearest=True)
    rows = solver.distances(sources)
    assert found.sources.dtype == np.int64
    chosen = rows[found.sources, np.arange(torus.n_vertices)]
    slack = 1e-9 if solver.exact else 0.2
    np.testing.assert_allclose(chosen, rows.min(axis=0), rtol=slack, atol=1e-12)
    near = solver.distance(sources, targets=[4, 901], nearest=True)
    assert near.sources.tolist() == found.sources[[4, 901]].tolist()


def test_unreachable_has_no_nearest_source(square):
    assert square.distance([0], nearest=True).sources.tolist() == [0, 0, 0, 0, -1]


def test_a_field_answers_everywhere(torus):
    field = gd.Solver(torus).field([POINT, 900])
    np.testing.assert_allclose(field.distances, torus.distance([POINT, 900]), rtol=1e-12)
    points = [gd.face(f, 0.3, 0.3, 0.4) for f in range(0, torus.n_faces, 97)]
    d = field.distance(points)
    np.testing.assert_allclose(d, torus.distance([POINT, 900], targets=points), rtol=1e-12)
    assert field.distance(17) == field.distances[17]
    np.testing.assert_allclose([p.length for p in field.paths(points)], d, rtol=1e-11)
    gradient = field.gradient(points)
    np.testing.assert_allclose(np.linalg.norm(gradient, axis=1), 1, rtol=1e-9)
    # Along the gradient the distance grows as the step.
    at = torus.locate(points).position
    step = 1e-4
    there = field.distance(at + step * gradient)
    np.testing.assert_allclose(there - d, step, rtol=0.05)
    assert np.isnan(field.gradient(900)).all()
    assert np.isfinite(torus.field(0).gradient(np.arange(1, torus.n_vertices))).all()
    lines = [isoline.distance for isoline in field.isolines(every=0.5)]
    assert lines == [line.distance for line in torus.isolines([POINT, 900], every=0.5)]
    with pytest.raises(IndexError, match="points vertex 99999"):
        field.distance(99999)
