"""Error messages name the argument, the vertex or the face."""

import pickle
import sys
import types

import numpy as np
import pytest

import geodesics as gd

V = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
F = np.array([[0, 1, 2], [0, 2, 3]])


def nan_at(vertex):
    positions = V.copy()
    positions[vertex, 1] = np.nan
    return positions


@pytest.mark.parametrize(
    ("vertices", "faces", "error", "text"),
    [
        (V[:, :2], F, ValueError, r"vertices: the shape is \(4, 2\), but \(n, 3\)"),
        (V.ravel(), F, ValueError, r"vertices: the shape is \(12,\)"),
        (V, F.ravel(), ValueError, r"faces: the shape is \(6,\)"),
        (V, np.zeros((2, 4), int), gd.MeshError, "faces"),
        (V.astype(complex), F, TypeError, "vertices: the type is complex128"),
        (V.astype(str), F, TypeError, "vertices: the type is"),
        (V, F.astype(float), TypeError, "faces: the type is float64, but integers"),
        (V, F.astype(bool), TypeError, "faces: the type is bool"),
        ("mesh.obj", F, ValueError, "vertices: "),
        (V, [[0, 1, 2], [0, 2, -3]], gd.MeshError, "face 1 names vertex -3"),
        (V, [[0, 1, 2], [0, 2, 9]], gd.MeshError, "face 1.*vertex 9"),
        (V, [[0, 1, 2], [0, 2, 2**40]], gd.MeshError, f"face 1 names vertex {2**40}"),
        (V, [[0, 1, 1], [2, 3, 3]], gd.MeshError, "it has no faces.*face 0.*vertex 1"),
        (nan_at(2), F, gd.MeshError, "vertex 2"),
        (np.zeros((0, 3)), np.zeros((0, 3), int), gd.MeshError, "vert"),
        (V, [], gd.MeshError, "face"),
    ],
)
def test_meshes(vertices, faces, error, text):
    with pytest.raises(error, match=text):
        gd.Mesh(vertices, faces)


def test_algorithms_that_cross_no_edges_of_many_faces_are_refused():
    mesh = gd.Mesh(np.vstack([V, V[:1] + 3]), [[0, 1, 2], [0, 2, 3], [2, 0, 4]])
    assert "more than two faces" in mesh.defects[0]
    assert np.array_equal(mesh.distance(1), mesh.distance(1, algorithm="mmp"))
    assert gd.Solver(mesh).algorithm == "mmp-fast"
    with pytest.raises(ValueError, match="edges with more than two faces: use mmp-fast"):
        mesh.distance(1, algorithm="vtp")
    with pytest.raises(ValueError, match="edges with more than two faces"):
        mesh.voronoi([1, 3])


def test_defects_are_listed():
    with pytest.raises(gd.MeshError) as caught:
        gd.Mesh(nan_at(1), [[0, 1, 2], [0, 2, 9]])
    assert any("face 1 names vertex 9" in defect for defect in caught.value.defects)
    assert any("vertex 1" in defect for defect in caught.value.defects)
    assert pickle.loads(pickle.dumps(caught.value)).defects == caught.value.defects
    assert isinstance(caught.value, ValueError)
    assert "turned" in gd.Mesh(V, [[0, 1, 2], [0, 3, 2]]).defects[0]
    assert "face 0: vertex 1" in gd.Mesh(V, [[0, 1, 1], [0, 2, 3]]).defects[0]
    folded = gd.Mesh(V[[0, 1, 2, 0]], [[0, 1, 2], [0, 2, 3]])
    assert any("vertices 0 and 3 in face 1" in defect for defect in folded.defects)


@pytest.mark.parametrize(
    ("source", "error", "text"),
    [
        (99, IndexError, "source vertex 99 does not exist: the mesh has 5 vertices"),
        (-1, IndexError, "source vertex -1 does not exist"),
        (gd.at(0, 0, 9), ValueError, "source: at:0,0,9 is 8.1.* from the surface, whose size is 1.4"),
        ([0, 99], IndexError, "source vertex 99"),
        (1.5, TypeError, "source: 1.5 is no point"),
        (True, TypeError, "source: True is no point"),
        ("0", TypeError, "source: '0' is no point"),
        (None, TypeError, "source: None is no point"),
        ([], ValueError, "source: empty"),
        ([[0, 1]], TypeError, r"source: \[0, 1\] is no point"),
        (b"\x00\x01", TypeError, r"source: b'\\x00\\x01' is no point"),
        (bytearray(b"\x01"), TypeError, "source: bytearray"),
        (memoryview(b"\x01"), TypeError, "source: <memory"),
        ({0: 1}, TypeError, "source: {0: 1} is no point"),
        ([0, b"\x01"], TypeError, r"source: b'\\x01' is no point"),
        (types.MappingProxyType({0: 1}), TypeError, "source: mappingproxy"),
        (np.ma.masked_array([0, 1], [False, True]), TypeError, "source: a masked array"),
        ([np.timedelta64(1)], TypeError, "source: "),
        (np.array([0.5]), TypeError, "source: "),
        (gd.face(9, 0.2, 0.3, 0.5), IndexError, "source: face:9,0.2,0.3,0.5: face 9 does not"),
        (gd.face(0, 0.2, 0.3, 0.6), ValueError, "have the sum 1.1"),
        (gd.edge(1, 3, 0.5), ValueError, "no edge joins the vertices 1 and 3"),
    ],
)
def test_sources(square, source, error, text):
    for call in (square.distance, gd.Solver(square).distance):
        with pytest.raises(error, match=text):
            call(source)


@pytest.mark.parametrize(
    ("arguments", "error", "text"),
    [
        ({"radius": -1.0}, ValueError, "radius: -1"),
        ({"radius": np.nan}, ValueError, "radius: NaN"),
        ({"targets": []}, ValueError, "targets: empty"),
        ({"targets": [99]}, IndexError, "targets vertex 99 does not exist"),
        ({"algorithm": "vpt"}, ValueError, "algorithm: there is no algorithm `vpt` .did you mean `vtp`"),
        ({"algorithm": "exact"}, ValueError, "asks for"),
        ({"algorithm": "fwp-mmp{kmax=0}"}, ValueError, "kmax"),
    ],
)
def test_options(square, arguments, error, text):
    with pytest.raises(error, match=text):
        square.distance(0, **arguments)


def test_texts_bytes_and_mappings_are_no_lists(square):
    def fails(text, call, *arguments, **named):
        with pytest.raises((TypeError, ValueError), match=text):
            call(*arguments, **named)

    for hostile in (b"\x00\x01\x02", {0: 0, 1: 1, 2: 2}, "012"):
        solver, field = gd.Solver(square), square.field(0)
        fails("targets: ", square.distance, 0, targets=hostile)
        fails("sources: ", square.distances, hostile)
        fails("points: ", square.distance_matrix, hostile)
        fails("sources: ", square.pairs, hostile, [0])
        fails("targets: ", solver.pairs, [0], hostile)
        fails("target: ", square.path, 0, hostile)
        fails("source: ", square.path, hostile, 0)
        fails("targets: ", square.paths, 0, hostile)
        fails("point: ", square.trace, hostile, [1, 0, 0], 1)
        fails("direction: ", square.trace, 0, hostile, 1)
        fails("sources: ", square.voronoi, hostile)
        fails("points: ", square.locate, hostile)
        fails("positions: ", square.nearest_vertices, [hostile])
        fails("points: ", field.distance, hostile)
        fails("points: ", field.gradient, hostile)
        fails("point: ", field.path, hostile)
        fails("levels: ", field.isolines, levels=[hostile])
        fails("source: ", gd.certify, square, hostile)
        fails("weld: ", gd.Mesh, V, F, weld=hostile)
        fails("faces: ", gd.Mesh, V, [[0, 1, 2], hostile])
        fails("faces: ", gd.Mesh, V, [[0, 1, 2, 3], hostile])
        fails("faces: ", gd.Mesh, V, [hostile, [0, 1, 2, 3]])
        if not isinstance(hostile, str):
            fails("sources: ", gd.run, "mmp", square, sources=hostile)
            fails("algorithms: ", gd.run, hostile, square)
            fails("models: ", gd.run, "mmp", hostile)
    fails("levels: ", field.isolines, levels=b"\x01\x02")
    fails("levels: ", square.isolines, 0, levels={1.0: 2})
    fails("faces: face 1", gd.Mesh, V, [[0, 1, 2, 3], [False, True, True]])


def test_tables_are_their_values(torus):
    pandas = pytest.importorskip("pandas")
    # Iterated, a table yields the names of its columns.
    table = pandas.DataFrame(torus.vertices[[5, 9]])
    np.testing.assert_array_equal(torus.distance(table), torus.distance([5, 9]))
    np.testing.assert_array_equal(torus.distance(pandas.Series([5, 9])), torus.distance([5, 9]))
    near = pandas.Series(torus.distance(0) < 1)
    np.testing.assert_array_equal(torus.distance(near), torus.distance(near.to_numpy()))


@pytest.mark.skipif(sys.version_info < (3, 11), reason="exceptions have no notes")
def test_notes_name_arguments_of_another_type(square):
    for argument, call, arguments, named in [
        ("algorithm", gd.Solver, (V, F), {}),
        ("algorithm", gd.Solver, (square, F), {}),
        ("nearest", square.distance, (0,), {"nearest": "x"}),
        ("path", gd.read, (b"x.obj",), {}),
        ("n", gd.Mesh.from_lengths, ("x", F, V), {}),
    ]:
        with pytest.raises(TypeError) as raised:
            call(*arguments, **named)
        assert f"while processing '{argument}'" in raised.value.__notes__


def test_other_calls(square, tmp_path):
    def fails(error, text, call, *arguments, **named):
        with pytest.raises(error, match=text):
            call(*arguments, **named)

    fails(ValueError, "threads: 0", square.distances, [0], threads=0)
    fails(IndexError, "sources vertex 9", square.distances, [0, 9])
    fails(IndexError, "target vertex 9", square.path, 0, 9)
    fails(TypeError, "target: ", square.path, 0, [1, 2])
    fails(ValueError, "t: 2 is not a place", gd.edge, 0, 1, 2)
    fails(IndexError, "b: there is no number -1", gd.edge, 0, -1, 0.5)
    fails(ValueError, "x: NaN", gd.at, np.nan, 0, 0)
    fails(ValueError, "one of every and levels", square.isolines, 0)
    fails(ValueError, "every: 0", square.isolines, 0, every=0)
    fails(ValueError, "every: a step of 0.00001 asks for", square.isolines, 0, every=1e-5)
    fails(ValueError, "levels: -1", square.isolines, 0, levels=[1, -1])
    fails(TypeError, "mesh: a geodesics.Mesh is needed, not str", gd.Solver, "mesh.obj")
    fails(ValueError, r"direction: the shape is \(2,\), but \(3,\)", square.trace, 0, [0, 0], 1)
    fails(ValueError, "simd", gd.Solver, square, simd="sse9")
    fails(ValueError, r"distances: the shape is \(4,\), but \(5,\)", gd.certify, square, 0, V[:, 0])
    d = square.distance(0)
    d[2] = np.nan
    fails(ValueError, "distances: the distance of vertex 2 is not a number", gd.certify, square, 0, d)
    fails(FileNotFoundError, "none.obj", gd.read, tmp_path / "none.obj")
    fails(IsADirectoryError, "directory", gd.read, tmp_path)
    bad = tmp_path / "bad.obj"
    bad.write_text("v 0 0 0\nv 1 0 x\n")
    fails(gd.MeshError, "line 2", gd.read, bad)
    fails(ValueError, "spec: ", gd.generate, "tours,faces=5")
    fails(ValueError, "models: ", gd.run, "mmp", "gen:tours")
    fails(TypeError, "models: 3 is no model", gd.run, "mmp", [3])
    fails(ValueError, "algorithms: there is no algorithm", gd.run, "mpm", square)
    fails(ValueError, "repeat: 0", gd.run, "mmp", square, repeat=0)
    fails(ValueError, "sources: ", gd.run, "mmp", square, sources="x")
