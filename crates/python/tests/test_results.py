"""Benchmarks with their rows and frames, and certificates."""

import numpy as np
import pytest

import geodesics as gd


@pytest.fixture(scope="module")
def table(torus):
    return gd.run(algorithms=["vtp", "mmp"], models=[torus, "gen:sphere,subdiv=2"], repeat=5)


def test_rows_are_dictionaries(table, torus):
    assert len(table) == 4
    assert [row["model"] for row in table] == [torus.name] * 2 + ["sphere,subdiv=2"] * 2
    for row in table:
        assert row["status"] == "ok" and row["time_median"] > 0
        assert len(row["time_samples"]) == 5
        assert row["counters_propagated"] > 0 and row["memory_heap_peak_bytes"] > 0
        assert row["check_max_rel"] < 1e-9
    assert table[0]["vertices"] == torus.n_vertices
    assert "vtp" in repr(table)


def test_frames(table):
    frame = table.to_pandas()
    assert len(frame) == 4 and "time_samples" not in frame
    assert {"time_median", "vertices", "genus", "counters_propagated"} <= set(frame.columns)
    samples = table.to_pandas(samples=True)
    assert len(samples) == 20
    medians = samples.groupby(["model", "algorithm"])["seconds"].median()
    for row in table:
        assert medians[row["model"], row["algorithm"]] == row["time_median"]


def test_results_are_written_and_read(table, tmp_path):
    path = tmp_path / "r.json"
    table.write(path)
    frame = gd.read_results(path)
    assert frame.equals(table.to_pandas())
    assert gd.read_results(path, samples=True).equals(table.to_pandas(samples=True))


def test_the_command_line_reads_them(table, command, tmp_path):
    table.write(tmp_path / "r.json")
    command("compare", "r.json", "r.json", cwd=tmp_path)
    command("run", "--algo", "vtp", "--repeat", "2", "gen:torus,faces=500", "-o", "s.json", cwd=tmp_path)
    frame = gd.read_results(tmp_path / "s.json")
    assert frame["algorithm"].tolist() == ["vtp"] and frame["faces"].tolist() == [500]
    # The frame has all columns of the CSV format, except lists and the machine.
    command("run", "--algo", "vtp", "--repeat", "2", "gen:torus,faces=500", "-o", "s.csv", cwd=tmp_path)
    columns = (tmp_path / "s.csv").read_text().splitlines()[0].split(",")
    missing = set(columns) - set(frame.columns) - {"time_samples", "time_places", "time_solves", "machine"}
    assert not missing, missing


def test_sources_and_options(torus):
    table = gd.run("vtp-fast", torus, sources=[3, gd.face(0, 0.2, 0.3, 0.5)], repeat=1, warmup=0)
    assert [row["source"] for row in table] == [3, "face:0,0.2,0.3,0.5"]
    table = gd.run("pvtp", torus, sources="random:2", repeat=1, threads=2, check="mmp")
    assert len(table) == 2 and {row["threads"] for row in table} == {2}
    assert table[0]["check_reference"] == "mmp"


def test_a_model_that_cannot_be_used_is_a_row(tmp_path):
    path = tmp_path / "bad.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")
    row = gd.run("mmp", path, repeat=1)[0]
    assert row["status"] == "refused" and "vertex 8" in row["message"]


def test_other_files_are_refused(tmp_path):
    path = tmp_path / "r.json"
    path.write_text("{}")
    with pytest.raises(ValueError, match="not a result file"):
        gd.read_results(path)


def test_right_distances_are_certified(torus):
    d = torus.distance(0)
    proof = gd.certify(torus, 0, d)
    assert proof and proof.certified and proof.relative < 1e-9 and not proof.failures
    np.testing.assert_allclose(proof.distances, d, rtol=1e-12)
    d[77] *= 1 + 1e-6
    proof = gd.certify(torus, 0, d)
    assert not proof and ("vertex", 77) == proof.failures[0][:2]
    assert gd.certify(torus, 0, d, tolerance=1e-3)
    for threads in (2, None):
        assert gd.certify(torus, [0, 9], threads=threads)


def test_distances_from_points_of_the_surface_are_certified(torus):
    source = [gd.face(7, 0.2, 0.3, 0.5), gd.at(3, 0, 0)]
    d = torus.distance(source)
    proof = gd.certify(torus, source, d)
    assert proof and len(proof.distances) == torus.n_vertices
    np.testing.assert_allclose(proof.distances, d, rtol=1e-12)
    d[77] *= 1 + 1e-6
    assert ("vertex", 77) == gd.certify(torus, source, d).failures[0][:2]
    with pytest.raises(IndexError, match="face 99999 does not exist"):
        gd.certify(torus, gd.face(99999, 1, 0, 0))
