"""Curves as sources."""

import copy
import pickle

import numpy as np
import pytest

import geodesics as gd


@pytest.fixture
def grid():
    return gd.generate("grid,n=4")


def test_a_segment_has_the_distances_of_the_plane(grid):
    a, b = np.array([0.3, 0.1]), np.array([0.6, 0.2])
    curve = gd.Curve([gd.at(*a, 0), gd.at(*b, 0)])
    t = np.clip((grid.vertices[:, :2] - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
    expected = np.linalg.norm(a + t[:, None] * (b - a) - grid.vertices[:, :2], axis=1)
    np.testing.assert_allclose(grid.distance(curve), expected, rtol=0, atol=1e-14)
    solver = gd.Solver(grid, "mmp")
    np.testing.assert_array_equal(solver.distance(curve), grid.distance(curve))
    near = grid.distance(curve, radius=1)
    np.testing.assert_array_equal(near, np.where(expected <= 1, grid.distance(curve), np.inf))


def test_samples_converge_from_above(torus):
    path = torus.path(0, 500)
    points = [gd.face(int(f), *map(float, w)) for f, w in zip(path.faces, path.barycentric)]
    exact = torus.distance(gd.Curve(points))
    ends = torus.distance([points[0], points[-1]])
    all_points = torus.distance(points)
    tiny = 1e-12 * exact.max()
    assert (all_points >= exact - tiny).all() and (ends >= all_points - tiny).all()
    assert (all_points > exact + tiny).any()


def test_borders_loops_and_points_are_sources_together(grid):
    borders = grid.borders()
    assert [(len(b), b.closed) for b in borders] == [(16, True)]
    x, y = grid.vertices[:, 0], grid.vertices[:, 1]
    expected = np.minimum.reduce([x, y, 4 - x, 4 - y])
    np.testing.assert_allclose(grid.distance(borders), expected, rtol=0, atol=1e-14)
    together = grid.distance([gd.Curve([0, 1, 2]), 24, gd.vertex(20)])
    parts = [grid.distance(gd.Curve([0, 1, 2])), grid.distance([24, 20])]
    np.testing.assert_allclose(together, np.minimum(*parts), rtol=0, atol=1e-14)
    one_by_one = (source for source in [gd.Curve([0, 1, 2]), 24, 20])
    np.testing.assert_array_equal(grid.distance(one_by_one), together)
    assert gd.generate("sphere,subdiv=1").borders() == []


def test_curves_are_objects_like_others():
    curve = gd.Curve([0, gd.edge(1, 2, 0.5)], closed=True)
    assert repr(curve) == "<geodesics.Curve of 2 points, closed>"
    assert curve.points == [gd.vertex(0), gd.edge(1, 2, 0.5)] and curve.closed
    for same in (pickle.loads(pickle.dumps(curve)), copy.deepcopy(curve)):
        assert same == curve and same != gd.Curve([0, gd.edge(1, 2, 0.5)])


@pytest.mark.parametrize("algorithm", ["vtp-fast", "mmp-fast", "ich", "heat", "mmp{queue=fifo}"])
def test_others_refuse_curves_by_name(grid, algorithm):
    with pytest.raises(ValueError, match="sources of .* are points; mmp starts from curves"):
        grid.distance(gd.Curve([0, 1]), algorithm=algorithm)


def test_curves_are_refused_where_points_are_meant(grid):
    curve = gd.Curve([0, 1])
    for call in (
        lambda: grid.path(curve, 7),
        lambda: grid.distances([curve]),
        lambda: grid.field(curve),
        lambda: gd.certify(grid, curve),
        lambda: grid.distance(0, targets=curve),
    ):
        with pytest.raises(TypeError, match="a curve is no point"):
            call()
    with pytest.raises(ValueError, match="nearest"):
        grid.distance(curve, nearest=True)
    with pytest.raises(ValueError, match="targets: .* is no vertex"):
        grid.distance(curve, targets=gd.face(0, 0.2, 0.3, 0.5))
    with pytest.raises(ValueError, match="curve 0: no face contains the points 1 and 2"):
        grid.distance(gd.Curve([0, 1, 24]))
    with pytest.raises(IndexError, match="vertex 99"):
        grid.distance(gd.Curve([0, 99]))
    with pytest.raises(ValueError, match="NaN is not a coordinate"):
        gd.Curve(np.array([[0, 0, np.nan]]))
    with pytest.raises(TypeError, match="points: a mask has no order; give the points in"):
        gd.Curve(np.ones(grid.n_vertices, bool))
    with pytest.raises(ValueError, match="empty"):
        gd.Curve([])
    with pytest.raises(TypeError):
        gd.Curve(["0"])
