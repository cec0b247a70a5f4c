"""Threads that share a solver, and interpreters without a lock."""

import sys
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import geodesics as gd


def test_importing_leaves_the_lock_off():
    if getattr(sys, "_is_gil_enabled", lambda: True)():
        pytest.skip("this interpreter has a lock")
    assert not sys._is_gil_enabled()


def test_threads_share_everything():
    mesh = gd.generate("torus,faces=2000,bump=0.2,seed=3")
    solver, points = gd.Solver(mesh), [3, gd.face(7, 0.2, 0.3, 0.5), gd.at(1, 0, 0.3)]
    expected = [(solver.distance(p), solver.path(p, 40).length) for p in points]
    field = mesh.field(points[1])
    at_once = threading.Barrier(8)

    def work(thread):
        at_once.wait()
        for i in range(12):
            k = (thread + i) % len(points)
            np.testing.assert_array_equal(solver.distance(points[k]), expected[k][0])
            assert solver.path(points[k], 40).length == expected[k][1]
            assert mesh.locate(gd.at(0, 1, thread / 8)).distance >= 0
            assert field.distance(40) == pytest.approx(expected[1][0][40], rel=1e-12)
        return True

    with ThreadPoolExecutor(8) as threads:
        assert all(threads.map(work, range(8)))
