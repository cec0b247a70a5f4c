"""Paths, isolines, remeshing and Voronoi diagrams."""

import numpy as np
import pytest

import geodesics as gd


def test_a_path_has_the_length_of_the_distance(torus):
    d = torus.distance(0)
    for target in [17, 500, 1200]:
        path = torus.path(0, target)
        steps = np.linalg.norm(np.diff(path.points, axis=0), axis=1)
        assert path.length == pytest.approx(d[target], rel=1e-12)
        assert steps.sum() == pytest.approx(path.length, rel=1e-12)
        assert (path.points[0] == torus.vertices[0]).all()
        assert (path.points[-1] == torus.vertices[target]).all()
        assert path.vertices[0] == 0 and path.vertices[-1] == target
        assert len(path) == len(path.points) == len(path.faces) == len(path.vertices)
        corners = torus.vertices[torus.faces[path.faces]]
        there = np.einsum("ki,kij->kj", path.barycentric, corners)
        np.testing.assert_allclose(there, path.points, atol=1e-12)


def test_paths_between_points_inside_faces(torus):
    source, target = gd.face(3, 0.2, 0.3, 0.5), gd.edge(*map(int, torus.faces[700][:2]), 0.25)
    path = torus.path(source, target)
    assert path.faces[0] == 3
    np.testing.assert_allclose(path.barycentric[0], [0.2, 0.3, 0.5], atol=1e-15)
    assert path.length == pytest.approx(torus.distance(source, targets=target)[0], rel=1e-12)


def test_many_paths_of_one_search(torus):
    solver = gd.Solver(torus)
    targets = [5, 17, 900]
    for path, target in zip(solver.paths([0, 40], targets), targets):
        assert path.vertices[-1] == target and path.vertices[0] in (0, 40)
    assert solver.path(0, 17).length == torus.path(0, 17).length


def test_no_path_is_none(square):
    assert square.path(0, 4) is None
    assert [path is None for path in square.paths(0, [4, 2])] == [True, False]


def test_isolines_are_at_their_distance(torus):
    d = torus.distance(0)
    isolines = torus.isolines(0, every=0.5)
    assert [line.distance for line in isolines] == [0.5 * k for k in range(1, len(isolines) + 1)]
    assert len(isolines) >= int(d.max() / 0.5)
    for isoline in isolines[:3]:
        assert isoline.length == pytest.approx(sum(line.length for line in isoline.lines))
        for line in isoline.lines:
            points = line.points()
            assert line.closed and (points[0] == points[-1]).all()
            targets = [gd.at(*p) for p in points[:40]]
            # Chords deviate from the arcs by at most a thousandth of the distance.
            found = torus.distance(0, targets=targets)
            np.testing.assert_allclose(found, isoline.distance, rtol=2e-3)
            short = np.linalg.norm(np.diff(line.points(1e-6), axis=0), axis=1).sum()
            assert short == pytest.approx(line.length, rel=1e-4)
    (one,) = torus.isolines([0, gd.face(700, 0.2, 0.3, 0.5)], levels=[0.25])
    assert len(one.lines) == 2


def test_a_circle_has_its_length():
    mesh = gd.generate("grid,n=8")
    middle = gd.at(*mesh.vertices.mean(axis=0))
    (isoline,) = mesh.isolines(middle, levels=[1.5])
    assert isoline.length == pytest.approx(3 * np.pi, rel=1e-12)


def test_remesh_keeps_the_surface(torus):
    even = torus.remesh(100, lloyd=2)
    assert even.n_vertices == 100
    # On a torus, F = 2 V.
    assert even.n_faces == 200
    assert even.remesh(50, lloyd=0, rng=3).n_vertices >= 50
    with pytest.raises(ValueError, match="sites are asked for"):
        torus.remesh(10**6)
    # A single cell of a torus is no disc, so sites are added.
    assert torus.remesh(1, lloyd=0).n_vertices > 3


def test_voronoi_cells_share_the_surface(torus):
    sources = [3, 99, 1024, 700, 1300]
    diagram = torus.voronoi(sources)
    rows = torus.distances(sources)
    nearest = rows.min(axis=0)
    assert not torus.wrong_distances(diagram.distances, nearest).size
    chosen = rows[diagram.labels, np.arange(torus.n_vertices)]
    assert not torus.wrong_distances(chosen, nearest).size
    assert sum(cell.area for cell in diagram.cells) == pytest.approx(torus.info()["area"])
    for cell in diagram.cells:
        assert diagram.sources[cell.source] == cell.vertex
        for other in cell.neighbours:
            assert cell.source in diagram.cells[other].neighbours
    border = sum(arc.length for arc in diagram.arcs)
    assert sum(cell.perimeter for cell in diagram.cells) == pytest.approx(2 * border)
    for arc in diagram.arcs[:50]:
        points = arc.points()
        assert points.shape == (2 if arc.kind == "line" else 9, 3)
        assert len(set(arc.sources)) == 2
    for vertex in diagram.vertices:
        assert len(vertex.sources) >= 3 and vertex.distance > 0


def test_voronoi_takes_points_anywhere(torus):
    points = [gd.face(12, 0.2, 0.3, 0.5), 99, gd.at(1, 0, 0), 700]
    diagram = torus.voronoi(points)
    rows = torus.distances(points)
    nearest = rows.min(axis=0)
    assert diagram.labels.shape == diagram.distances.shape == (torus.n_vertices,)
    assert not torus.wrong_distances(diagram.distances, nearest).size
    chosen = rows[diagram.labels, np.arange(torus.n_vertices)]
    assert not torus.wrong_distances(chosen, nearest).size
    assert sum(cell.area for cell in diagram.cells) == pytest.approx(torus.info()["area"])
    assert diagram.sources[0] == points[0] and diagram.sources[1] == 99
    assert diagram.cells[0].vertex is None and diagram.cells[1].vertex == 99
    corners = torus.vertices[torus.faces]
    assert all(arc.face < torus.n_faces for arc in diagram.arcs)
    for vertex in diagram.vertices:
        position = np.array(vertex.barycentric) @ corners[vertex.face]
        np.testing.assert_allclose(position, vertex.position, atol=1e-12)


def test_the_dual_is_a_mesh():
    mesh = gd.generate("sphere,subdiv=4")
    sources = np.random.default_rng(1).choice(mesh.n_vertices, 100, replace=False)
    dual = mesh.voronoi(sources).dual()
    assert dual.n_vertices == 100
    assert dual.info()["euler_characteristic"] == 2
    assert (dual.vertices == mesh.vertices[sources]).all()


def test_a_dual_that_is_no_mesh_names_the_cell(torus):
    with pytest.raises(ValueError, match="cell 0 is no disc"):
        torus.voronoi([0]).dual()


def test_labels_of_unreachable_vertices(square):
    assert square.voronoi([0, 2]).labels.tolist()[4] == -1


def test_a_path_through_way_points(torus):
    ways = [5, gd.face(900, 0.2, 0.3, 0.5), 17]
    solver = gd.Solver(torus)
    pieces = [torus.path(a, b) for a, b in zip(ways, ways[1:] + ways[:1])]
    for closed, count in [(False, 2), (True, 3)]:
        path = torus.path(ways, closed=closed)
        assert path.length == pytest.approx(sum(p.length for p in pieces[:count]), rel=1e-14)
        points = np.concatenate([pieces[0].points] + [p.points[1:] for p in pieces[1:count]])
        np.testing.assert_allclose(path.points, points, atol=1e-12)
        assert solver.path(ways, closed=closed).length == path.length
    assert torus.path([3, 3]).length == 0
    for arguments, error in [((5,), "two or more points"), (([5, 6], 7, True), "closed")]:
        with pytest.raises(ValueError, match=error):
            solver.path(*arguments[:2], closed=len(arguments) > 2)


def test_a_path_freed_from_its_way_points(torus):
    ways = [5, gd.face(900, 0.2, 0.3, 0.5), gd.face(333, 0.2, 0.3, 0.5), 17]
    solver = gd.Solver(torus)
    long, short = torus.path(ways), torus.path(ways, shorten=True)
    assert torus.path(5, 17).length <= short.length * (1 + 1e-12)
    assert short.length < long.length
    assert solver.path(ways, shorten=True).length == short.length
    np.testing.assert_array_equal(short.points[[0, -1]], long.points[[0, -1]])
    steps = np.linalg.norm(np.diff(short.points, axis=0), axis=1)
    assert steps.sum() == pytest.approx(short.length, rel=1e-12)
    # A small loop contracts to a point.
    point = torus.path([5, gd.face(900, 0.2, 0.3, 0.5), 5], closed=True, shorten=True)
    assert point.length == 0 and len(point.points) == 1
    with pytest.raises(ValueError, match="shorten: a path to a target"):
        torus.path(5, 17, shorten=True)


def test_a_way_point_out_of_reach(square):
    assert square.path([0, 2, 4]) is None
    assert square.path([0, 2, 4], shorten=True) is None


def test_lines_follow_shortest_paths(torus):
    followed = 0
    for target in range(1, torus.n_vertices, 101):
        path = torus.path(gd.face(3, 0.2, 0.3, 0.5), target)
        if (path.vertices[:-1] < 0).all():
            line = torus.trace(gd.face(3, 0.2, 0.3, 0.5), path.start_direction, path.length)
            np.testing.assert_allclose(line.points[-1], path.points[-1], atol=1e-9)
            followed += 1
    assert followed > 3
    assert torus.path(3, 3).start_direction is None


def test_lines_on_a_plane_and_a_cube():
    grid = gd.generate("grid,n=8,jitter=0.2,seed=1")
    line = grid.trace(gd.at(1.3, 2.2, 0), np.array([2, 1, 7]), 3)
    np.testing.assert_allclose(line.points[-1] - line.points[0], 3 * np.array([2, 1, 0]) / 5**0.5)
    border = grid.trace(gd.at(1.3, 2.2, 0), [-1, 0, 0], 99)
    assert border.length == pytest.approx(1.3) and border.points[-1][0] == pytest.approx(0)
    cube = gd.generate("cube,n=3,side=3")
    around = cube.trace(gd.at(1.2, 0.4, 3), [0, 1, 0], 12)
    np.testing.assert_allclose(around.points[-1], around.points[0], atol=1e-12)
    # A corner of the cube has three right angles. From the diagonal of one of its faces the line
    # goes on along the opposite edge.
    through = cube.trace(gd.at(2, 2, 3), [1, 1, 0], 2 * 2**0.5)
    passed = [cube.nearest_vertex(3, 3, z) for z in (3, 2)]
    assert through.vertices[1:-1].tolist() == passed
    np.testing.assert_allclose(through.points[-1], [3, 3, 3 - 2**0.5], atol=1e-12)


@pytest.mark.parametrize(
    ("direction", "length", "message"),
    [
        ([0, 0, 1], 1, "along the surface"),
        ([1, 0], 1, "direction"),
        ([1, 0, 0], -1, "no length"),
        ([1, 0, 0], float("nan"), "no length"),
    ],
)
def test_invalid_directions_and_lengths_are_errors(direction, length, message):
    with pytest.raises(ValueError, match=message):
        gd.generate("grid,n=2").trace(gd.face(0, 0.2, 0.3, 0.5), direction, length)


@pytest.mark.parametrize("source", [7, gd.edge(0, 1, 0.3), gd.face(9, 0.2, 0.5, 0.3)])
def test_the_log_map_of_a_plane_is_a_motion(source):
    grid = gd.generate("grid,n=6,jitter=0.2,seed=2")
    solver = gd.Solver(grid)
    places = solver.log_map(source)
    assert places.shape == (grid.n_vertices, 2)
    np.testing.assert_allclose(np.hypot(*places.T), solver.distance(source), rtol=1e-12)
    plane = grid.vertices[:, :2]
    apart = np.linalg.norm(plane[:, None] - plane, axis=2)
    np.testing.assert_allclose(np.linalg.norm(places[:, None] - places, axis=2), apart, atol=1e-9)
    np.testing.assert_array_equal(grid.log_map(source), places)


def test_a_log_map_has_one_source_and_an_algorithm_with_paths():
    grid = gd.generate("grid,n=4")
    with pytest.raises(TypeError, match="source: "):
        grid.log_map([0, 1])
    with pytest.raises(ValueError, match="traces no paths"):
        grid.log_map(0, algorithm="heat")
    apart = gd.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [9, 9, 9]], [[0, 1, 2]])
    assert np.isnan(apart.log_map(0)[3]).all() and (apart.log_map(0)[0] == 0).all()
